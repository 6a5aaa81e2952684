//! Files whose size has a limit, whatever they are.

use crate::FitError;
use std::io::{self, Read};
use std::path::Path;

/// Largest file that is read, bytes: the largest measured files are a tenth of it.
pub(crate) const MAX_FILE: u64 = 1 << 30;

/// Reads a regular file of at most `most` bytes: a pipe may never end, and a device tells no size.
///
/// # Errors
/// Does not name the file: the caller says what it stands for.
pub fn read_at_most(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    // Before it is opened: to open a pipe waits for one who writes.
    if !std::fs::metadata(path)?.is_file() {
        return Err(io::Error::other("a regular file is expected"));
    }
    let mut bytes = Vec::new();
    // The size may change between a look at it and the reading, so that what was read is what counts.
    std::fs::File::open(path)?.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return Err(io::Error::other(format!("a file of at most {most} bytes is expected")));
    }
    Ok(bytes)
}

/// The bytes of a file that has at most so many.
pub(crate) fn read_bytes(path: &Path, most: u64) -> Result<Vec<u8>, FitError> {
    read_at_most(path, most).map_err(FitError::io(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_limit_is_a_limit_and_only_files_are_read() {
        let path = std::env::temp_dir().join(format!("srbf-input-{}", std::process::id()));
        std::fs::write(&path, [7; 10]).unwrap();
        assert_eq!(read_at_most(&path, 10).unwrap(), [7; 10]);
        assert!(read_at_most(&path, 9).unwrap_err().to_string().contains("at most 9"));
        std::fs::remove_file(&path).unwrap();
        assert!(read_at_most(&path, 9).is_err());
        assert!(read_at_most(&std::env::temp_dir(), 9).unwrap_err().to_string().contains("regular file"));
        #[cfg(unix)]
        assert!(read_at_most(Path::new("/dev/zero"), 9).unwrap_err().to_string().contains("regular file"));
    }
}
