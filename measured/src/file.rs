//! Files whose size has a limit, whatever they are, and their text.
//!
//! May import: `error`.

pub(crate) mod decode;
pub mod rows;
pub(crate) mod spectrum;

use crate::{FitError, ReadError};
use std::io::{self, Read};
use std::path::Path;

/// Largest file that is read, bytes: the largest measured files are a tenth of it.
pub const MAX_FILE: u64 = 1 << 30;

/// Reads a regular file of at most `most` bytes: a pipe may never end, and a device tells no size.
///
/// Nothing is read of a file that is larger, nor where there is no memory for it.
///
/// # Errors
/// Does not name the file: the caller does.
pub fn read_at_most(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    read_if(path, most, |_| Ok(()))
}

/// [`read_at_most`] of a file whose size is looked at first: `fits` refuses one that no file of its format has.
///
/// # Errors
/// As `read_at_most`; the fault that `fits` found as its source.
pub fn read_if(
    path: &Path,
    most: u64,
    fits: impl FnOnce(u64) -> Result<(), ReadError>,
) -> io::Result<Vec<u8>> {
    let found = std::fs::metadata(path)?;
    // Before it is opened: to open a pipe waits for one who writes.
    if !found.is_file() {
        return Err(io::Error::other("a regular file is expected"));
    }
    let too_large = || io::Error::other(format!("a file of at most {most} bytes is expected"));
    if found.len() > most {
        return Err(too_large());
    }
    fits(found.len()).map_err(|fault| io::Error::new(io::ErrorKind::InvalidData, fault))?;
    check_memory(found.len())?;
    let mut bytes = Vec::with_capacity(found.len() as usize);
    // The size may change between a look at it and the reading, so the bytes that were read count.
    std::fs::File::open(path)?.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return Err(too_large());
    }
    Ok(bytes)
}

/// Finds out whether a number of bytes of memory is there: an allocation that fails in the middle of work ends the process.
///
/// # Errors
/// [`io::ErrorKind::OutOfMemory`] with the bytes.
pub fn check_memory(bytes: u64) -> io::Result<()> {
    let is_there =
        usize::try_from(bytes).is_ok_and(|bytes| Vec::<u8>::new().try_reserve_exact(bytes).is_ok());
    let reason = || format!("{} MB of memory are needed, and not there", bytes.div_ceil(1_000_000));
    if is_there { Ok(()) } else { Err(io::Error::new(io::ErrorKind::OutOfMemory, reason())) }
}

/// The bytes of a file whose size is within a limit and fits its format.
pub fn read_bytes(
    path: &Path,
    most: u64,
    fits: impl FnOnce(u64) -> Result<(), ReadError>,
) -> Result<Vec<u8>, FitError> {
    read_if(path, most, fits).map_err(|error| match error.downcast() {
        Ok(source) => FitError::Read { path: path.to_path_buf(), source },
        Err(error) => FitError::io(path)(error),
    })
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
        // The size that is told is that of a file of holes, of which nothing is read.
        std::fs::File::create(&path).unwrap().set_len(1 << 40).unwrap();
        assert!(read_at_most(&path, 1 << 30).unwrap_err().to_string().contains("at most"));
        let error = check_memory(1 << 63).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::OutOfMemory, "{error}");
        assert!(error.to_string().contains("9223372036855 MB of memory"), "{error}");
        let odd = |bytes| Err(ReadError::Content(format!("{bytes} bytes")));
        assert!(read_if(&path, u64::MAX, odd).unwrap_err().to_string().contains("1099511627776 bytes"));
        std::fs::remove_file(&path).unwrap();
        assert!(read_at_most(&path, 9).is_err());
        assert!(read_at_most(&std::env::temp_dir(), 9).unwrap_err().to_string().contains("regular file"));
        #[cfg(unix)]
        assert!(read_at_most(Path::new("/dev/zero"), 9).unwrap_err().to_string().contains("regular file"));
    }
}
