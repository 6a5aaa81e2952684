//! Where a file is written to: behind links, and only where there is a regular file or nothing.

use crate::FitError;
use std::fs::{FileType, Permissions};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// Links that may follow one another: as many as Linux follows.
const MOST_LINKS: usize = 40;

/// Where a file is written to.
pub(super) struct Destination {
    /// The file itself: no link, and there a regular file or nothing.
    pub file: PathBuf,
    /// Those of the file that is there.
    pub permissions: Option<Permissions>,
}

impl Destination {
    pub fn of(path: &Path) -> Result<Self, FitError> {
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

    pub fn make_folder(&self) -> Result<(), FitError> {
        match self.file.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            Some(folder) => std::fs::create_dir_all(folder).map_err(FitError::io(folder)),
            None => Ok(()),
        }
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
