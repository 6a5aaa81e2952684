//! Writing a file so that it is never there half.

use crate::FitError;
use std::ffi::OsString;
use std::fs::File;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Writes bytes under a temporary name in the same folder, which is made if need be, and renames the file.
///
/// Of several threads or processes that write one path at once, one is the last, and its bytes are there, whole.
///
/// # Errors
/// [`FitError::Io`] with the path; the temporary file is removed then.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), FitError> {
    if let Some(folder) = path.parent().filter(|f| !f.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(FitError::io(folder))?;
    }
    let (mut file, temporary) = create_beside(path).map_err(FitError::io(path))?;
    let written = file.write_all(bytes).and_then(|()| std::fs::rename(&temporary, path));
    if written.is_err() {
        // The reason of the failure is the one to report.
        let _ = std::fs::remove_file(&temporary);
    }
    written.map_err(FitError::io(path))
}

/// Creates a file in the same folder, under a name that nobody else has.
fn create_beside(path: &Path) -> io::Result<(File, PathBuf)> {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    loop {
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let mut name: OsString = path.file_name().unwrap_or_default().to_owned();
        name.push(format!(".{}.{number}.part", std::process::id()));
        let temporary = path.with_file_name(name);
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
}
