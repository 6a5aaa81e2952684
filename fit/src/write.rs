//! Writing a file so that it is never there half.

use crate::FitError;
use std::fs::{File, FileType, Permissions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Links that may follow one another: as many as Linux follows.
const MOST_LINKS: usize = 40;

/// Writes bytes under a temporary name in the same folder, which is made if need be, and renames the file.
///
/// A symbolic link stays, and what it points to is replaced. A file that is there gives its permissions to the new one. Of several
/// threads or processes that write one path at once, one is the last, and its bytes are there, whole.
///
/// # Errors
/// [`FitError::Io`] with the path: also where a folder, a device, a pipe or a socket is there. The temporary file is removed then.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), FitError> {
    let place = Destination::of(path)?;
    place.make_folder()?;
    let (file, temporary) = create_beside(&place.file).map_err(FitError::io(path))?;
    let written = place.fill(file, bytes).and_then(|()| std::fs::rename(&temporary, &place.file));
    if written.is_err() {
        // The reason of the failure is the one to report.
        let _ = std::fs::remove_file(&temporary);
    }
    written.map_err(FitError::io(path))
}

/// Finds out, before a long work, whether [`write_atomically`] can write a file there; leaves nothing behind.
///
/// # Errors
/// As `write_atomically`.
pub fn check_output(path: &Path) -> Result<(), FitError> {
    let file = Destination::of(path)?.file;
    // Folders that are missing will be made; what counts is where the first of them would lie.
    let is_there = |folder: &&Path| folder.as_os_str().is_empty() || folder.exists();
    let above = file.ancestors().skip(1).find(is_there).unwrap_or(Path::new(""));
    let probe = create_beside(&above.join("probe"));
    probe.and_then(|(_, probe)| std::fs::remove_file(probe)).map_err(FitError::io(path))
}

/// Where a file is written to.
struct Destination {
    /// The file itself: no link, and there a regular file or nothing.
    file: PathBuf,
    /// Those of the file that is there.
    permissions: Option<Permissions>,
}

impl Destination {
    fn of(path: &Path) -> Result<Self, FitError> {
        Self::follow(path).map_err(FitError::io(path))
    }

    fn follow(path: &Path) -> io::Result<Self> {
        let mut file = path.to_path_buf();
        for _ in 0..MOST_LINKS {
            let is_folder = file.as_os_str().to_string_lossy().ends_with(std::path::is_separator);
            if file.file_name().is_none() || is_folder {
                return Err(io::Error::other("the name of a file is expected"));
            }
            let kind = match std::fs::symlink_metadata(&file) {
                Err(error) if error.kind() == ErrorKind::NotFound => {
                    return Ok(Self { file, permissions: None });
                }
                found => found?,
            };
            if !kind.is_symlink() {
                check_regular(kind.file_type())?;
                return Ok(Self { file, permissions: Some(kind.permissions()) });
            }
            // A link without a folder of its own is relative to the folder that it lies in.
            file = file.with_file_name("").join(std::fs::read_link(&file)?);
        }
        Err(io::Error::other("too many symbolic links"))
    }

    fn make_folder(&self) -> Result<(), FitError> {
        match self.file.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            Some(folder) => std::fs::create_dir_all(folder).map_err(FitError::io(folder)),
            None => Ok(()),
        }
    }

    /// Nobody who may not read the old bytes sees the new ones.
    fn fill(&self, mut file: File, bytes: &[u8]) -> io::Result<()> {
        if let Some(permissions) = &self.permissions {
            file.set_permissions(permissions.clone())?;
        }
        file.write_all(bytes)
    }
}

/// Anything else cannot be replaced by a file, or must not: to rename over a device would remove it.
fn check_regular(kind: FileType) -> io::Result<()> {
    let reason = if kind.is_file() {
        return Ok(());
    } else if kind.is_dir() {
        "a regular file is expected, and this is a folder"
    } else {
        "a regular file is expected, and this is a device, a pipe or a socket"
    };
    Err(io::Error::other(reason))
}

/// Creates a file in the same folder, under a name that nobody else has, short whatever the file is called.
fn create_beside(path: &Path) -> io::Result<(File, PathBuf)> {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    loop {
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let temporary = path.with_file_name(format!(".srbf-{}-{number}.part", std::process::id()));
        match File::create_new(&temporary) {
            // What a process of this number has left behind stays.
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            created => return created.map(|file| (file, temporary)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("srbf-write-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        folder
    }

    #[test]
    fn threads_that_write_one_path_leave_one_whole_file() {
        let folder = folder("threads");
        let path = folder.join("made/a.srbf");
        std::thread::scope(|scope| {
            for byte in 0..8u8 {
                let path = &path;
                scope.spawn(move || {
                    for round in 0..50 {
                        // Of different lengths, so that a mixture of two would show.
                        write_atomically(path, &vec![byte; 1000 + 100 * usize::from(byte) + round]).unwrap();
                        let read = std::fs::read(path).unwrap();
                        assert!(read.iter().all(|b| *b == read[0]), "two files in one");
                        let rounds = 1000 + 100 * usize::from(read[0]);
                        assert!((rounds..rounds + 50).contains(&read.len()), "{} bytes", read.len());
                    }
                });
            }
        });
        assert_eq!(std::fs::read_dir(path.parent().unwrap()).unwrap().count(), 1, "temporary files are left");
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn a_failure_leaves_nothing_behind() {
        let folder = folder("failure");
        // A folder cannot be replaced by a file.
        let path = folder.join("taken");
        std::fs::create_dir_all(path.join("inside")).unwrap();
        let error = write_atomically(&path, b"bytes").unwrap_err();
        assert!(matches!(error, FitError::Io { path: ref named, .. } if *named == path), "{error:?}");
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
        std::fs::remove_dir_all(folder).unwrap();
    }

    /// What is no file stays what it is, whether it is there under its name or behind a link.
    #[cfg(unix)]
    #[test]
    fn what_is_no_file_is_refused_and_stays() {
        use std::os::unix::fs::{FileTypeExt, symlink};
        let folder = folder("kinds");
        std::fs::create_dir_all(folder.join("folder")).unwrap();
        let made = std::process::Command::new("mkfifo").arg(folder.join("pipe")).status().unwrap();
        assert!(made.success());
        let _socket = std::os::unix::net::UnixListener::bind(folder.join("socket")).unwrap();
        symlink("/dev/null", folder.join("null")).unwrap();
        symlink("pipe", folder.join("to-pipe")).unwrap();
        symlink("to-itself", folder.join("to-itself")).unwrap();
        let names = ["folder", "pipe", "socket", "null", "to-pipe", "to-itself", "new/", "folder/..", ""];
        let before = std::fs::read_dir(&folder).unwrap().count();
        for name in names {
            let path = if name.is_empty() { PathBuf::new() } else { folder.join(name) };
            let wanted = match name {
                "folder" => "this is a folder",
                "to-itself" => "symbolic links",
                "new/" | "folder/.." | "" => "the name of a file",
                _ => "a device, a pipe or a socket",
            };
            for refused in [check_output(&path), write_atomically(&path, b"bytes")] {
                let Err(FitError::Io { path: named, source }) = refused else {
                    panic!("{name}: {refused:?}")
                };
                assert!(named == path && source.to_string().contains(wanted), "{name}: {source}");
            }
        }
        assert!(std::fs::metadata(folder.join("pipe")).unwrap().file_type().is_fifo());
        assert!(std::fs::metadata("/dev/null").unwrap().file_type().is_char_device());
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), before, "something is left behind");
        std::fs::remove_dir_all(folder).unwrap();
    }

    /// Through links to a file, to nothing yet, and to a link in another folder.
    #[cfg(unix)]
    #[test]
    fn links_stay_and_their_targets_are_written() {
        use std::os::unix::fs::symlink;
        let folder = folder("links");
        std::fs::create_dir_all(folder.join("other")).unwrap();
        std::fs::write(folder.join("other/there"), b"old").unwrap();
        symlink("other/there", folder.join("to-there")).unwrap();
        symlink("other/made/new", folder.join("to-new")).unwrap();
        symlink("../to-there", folder.join("other/back")).unwrap();
        for (name, target) in
            [("to-there", "other/there"), ("to-new", "other/made/new"), ("other/back", "other/there")]
        {
            check_output(&folder.join(name)).unwrap();
            write_atomically(&folder.join(name), name.as_bytes()).unwrap();
            assert!(folder.join(name).is_symlink() && !folder.join(target).is_symlink());
            assert_eq!(std::fs::read(folder.join(target)).unwrap(), name.as_bytes());
        }
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn a_file_keeps_its_mode_and_any_name_that_fits_is_written() {
        use std::os::unix::fs::PermissionsExt;
        let folder = folder("mode");
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join("n".repeat(255));
        write_atomically(&path, b"first").unwrap();
        for mode in [0o600, 0o640, 0o755, 0o444] {
            std::fs::set_permissions(&path, Permissions::from_mode(mode)).unwrap();
            write_atomically(&path, b"second").unwrap();
            let kept = std::fs::metadata(&path).unwrap().permissions().mode() & 0o7777;
            assert_eq!(kept, mode, "{kept:o} for {mode:o}");
        }
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn places_are_checked_without_a_trace() {
        let folder = folder("places");
        std::fs::create_dir(&folder).unwrap();
        check_output(&folder.join("a.png")).unwrap();
        check_output(&folder.join("not/yet/there/a.png")).unwrap();
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 0);
        std::fs::write(folder.join("file"), "").unwrap();
        assert!(check_output(&folder.join("file/a.png")).is_err());
        std::fs::remove_dir_all(folder).unwrap();
    }
}
