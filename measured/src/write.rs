//! Writing files so that none is ever there half, and of several that belong together none without the others.

mod destination;
mod temporary;

use crate::FitError;
use destination::Destination;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use temporary::{Temporary, remove_leftovers};

/// Writes bytes under a temporary name in the same folder, which is made if need be, and renames the file.
///
/// A symbolic link stays, and its target is replaced. A file that is there gives its permissions to the new one. Of several
/// threads or processes that write one path at once, one is the last, and its bytes are there, whole. The bytes are on the disk before
/// the file is renamed. Leftovers of a killed process in the folder are removed.
///
/// # Errors
/// [`FitError::Io`] with the path: also where a folder, a device, a pipe or a socket is there. The temporary file is removed then.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), FitError> {
    let mut outputs = Outputs::default();
    outputs.add(path, bytes)?;
    outputs.commit()
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
    Temporary::beside(&above.join("probe")).map(drop).map_err(FitError::io(path))
}

/// Files that belong together: all of them are written, or none.
///
/// Each is written as by [`write_atomically`], but gets its name only with all others. Where one cannot be renamed, the content that the
/// others have replaced is put back. Only a process that is killed between two renames, which takes microseconds, leaves some
/// files old and some new, each whole.
///
/// # Examples
/// ```
/// use srbf_measured::Outputs;
///
/// let folder = std::env::temp_dir().join("srbf-outputs-example");
/// let mut outputs = Outputs::default();
/// outputs.add(&folder.join("a.txt"), b"one")?;
/// outputs.add(&folder.join("b.txt"), b"two")?;
/// assert!(!folder.join("a.txt").exists());
/// outputs.commit()?;
/// assert!(folder.join("a.txt").exists() && folder.join("b.txt").exists());
/// # std::fs::remove_dir_all(folder).unwrap();
/// # Ok::<(), srbf_measured::FitError>(())
/// ```
#[derive(Default)]
pub struct Outputs {
    files: Vec<Output>,
}

/// One of them.
struct Output {
    /// As the caller names it.
    path: PathBuf,
    place: Destination,
    bytes: Temporary,
}

impl Outputs {
    /// Writes a file under a temporary name; folders that are missing are made.
    ///
    /// # Errors
    /// As [`write_atomically`].
    pub fn add(&mut self, path: &Path, bytes: &[u8]) -> Result<(), FitError> {
        let place = Destination::of(path)?;
        place.make_folder()?;
        remove_leftovers(&place.file);
        let mut temporary = Temporary::beside(&place.file).map_err(FitError::io(path))?;
        temporary.fill(bytes, place.permissions.as_ref()).map_err(FitError::io(path))?;
        self.files.push(Output { path: path.to_path_buf(), place, bytes: temporary });
        Ok(())
    }

    /// Where the bytes of a file lie until then, by the path that it was added with.
    pub fn staged(&self, path: &Path) -> Option<&Path> {
        self.files.iter().rev().find(|output| output.path == path).map(|output| output.bytes.path.as_path())
    }

    /// Gives all files their names.
    ///
    /// # Errors
    /// [`FitError::Io`] with the file that could not be renamed; all others are as they were then.
    pub fn commit(mut self) -> Result<(), FitError> {
        let is_alone = self.files.len() == 1;
        let mut replaced = Vec::new();
        for Output { path, place, bytes } in &mut self.files {
            let old = Replaced::of(place, is_alone);
            if let Err(error) = bytes.rename(&place.file) {
                replaced.into_iter().rev().for_each(Replaced::put_back);
                return Err(FitError::io(path)(error));
            }
            replaced.push(old);
        }
        drop(replaced);
        // So that the names too are there after a loss of power; where folders cannot be synced, that is as good as it gets.
        for output in &self.files {
            let folder = output.place.file.parent().filter(|folder| !folder.as_os_str().is_empty());
            let _ = File::open(folder.unwrap_or(Path::new("."))).and_then(|folder| folder.sync_all());
        }
        Ok(())
    }
}

/// The previous content at the place of a file.
struct Replaced<'a> {
    place: &'a Path,
    /// `None` where there was nothing, or where the file system gives no second names.
    old: Option<Temporary>,
    was_there: bool,
}

impl<'a> Replaced<'a> {
    /// Keeps the previous content under a second name, if there may be a need to put it back.
    fn of(place: &'a Destination, is_alone: bool) -> Self {
        let was_there = place.permissions.is_some();
        let old = if was_there && !is_alone { Temporary::second_name(&place.file).ok() } else { None };
        Self { place: &place.file, old, was_there }
    }

    fn put_back(self) {
        // The reason of the failure that led here is the one to report.
        let _: io::Result<()> = match self.old {
            Some(mut old) => old.rename(self.place),
            None if self.was_there => Ok(()),
            None => std::fs::remove_file(self.place),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    #[cfg(unix)]
    use std::fs::Permissions;

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

    #[test]
    fn leftovers_of_killed_processes_go_with_the_next_file() {
        let folder = folder("leftovers");
        std::fs::create_dir_all(&folder).unwrap();
        // Nobody has locked it.
        std::fs::write(folder.join(".srbf-1-0.part"), b"half").unwrap();
        write_atomically(&folder.join("whole"), b"bytes").unwrap();
        let names = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name());
        assert_eq!(names.collect::<Vec<_>>(), ["whole"]);
        std::fs::remove_dir_all(folder).unwrap();
    }

    /// A folder or a device stays, whether it is there under its name or behind a link.
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
    fn of_files_that_belong_together_all_are_written_or_none() {
        let folder = folder("set");
        std::fs::create_dir_all(&folder).unwrap();
        let [old, new, taken] = ["old.srbf", "new.json", "taken.png"].map(|name| folder.join(name));
        std::fs::write(&old, b"before").unwrap();
        let mut outputs = Outputs::default();
        for path in [&old, &new, &taken] {
            outputs.add(path, b"after").unwrap();
        }
        assert_eq!(std::fs::read(&old).unwrap(), b"before");
        // Where it was free before, there is a folder in the end.
        std::fs::create_dir_all(taken.join("inside")).unwrap();
        let error = outputs.commit().unwrap_err();
        assert!(matches!(error, FitError::Io { path: ref named, .. } if *named == taken), "{error:?}");
        assert!(std::fs::read(&old).unwrap() == b"before" && !new.exists(), "some are written");
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 2, "something is left behind");

        std::fs::remove_dir_all(&taken).unwrap();
        let mut outputs = Outputs::default();
        for path in [&old, &new, &taken] {
            outputs.add(path, b"after").unwrap();
        }
        outputs.commit().unwrap();
        assert!([&old, &new, &taken].iter().all(|path| std::fs::read(path).unwrap() == b"after"));
        // One that is dropped without a commit leaves nothing.
        let mut outputs = Outputs::default();
        outputs.add(&old, b"never").unwrap();
        drop(outputs);
        assert_eq!(std::fs::read(&old).unwrap(), b"after");
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 3, "something is left behind");
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
