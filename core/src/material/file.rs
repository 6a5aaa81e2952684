//! Reading a `.srbf` file, no further than it says itself that it goes. The one place of this crate that
//! allocates.

extern crate std;

use super::format_error::FormatError;
use super::layout::SMALLEST;
use super::validate::announced_len;
use core::fmt;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use std::vec::Vec;

/// Why a `.srbf` file was not read.
#[derive(Debug)]
#[non_exhaustive]
pub enum FileError {
    /// The system refused to open it or to read from it.
    Io(io::Error),
    /// It does not start like a material.
    Format(FormatError),
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(error) => error.fmt(f),
            Self::Format(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for FileError {}

impl From<io::Error> for FileError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl From<FormatError> for FileError {
    fn from(error: FormatError) -> Self {
        Self::Format(error)
    }
}

/// Reads the bytes of a `.srbf` file, for [`Material::from_bytes`](crate::Material::from_bytes), which checks
/// them.
///
/// The head is looked at first, so that of a large file that is no material 52 bytes are read. Of a file that is longer than its head announces, one byte more than that is read: it
/// is refused by its length.
///
/// # Errors
/// [`FileError::Io`], also where memory does not suffice, and for a folder or a pipe, which might never end;
/// [`FileError::Format`] for a file that does not start like a material.
pub fn read_file(path: &Path) -> Result<Vec<u8>, FileError> {
    // Before it is opened: to open a pipe waits for one who writes.
    if !std::fs::metadata(path)?.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "not a regular file").into());
    }
    read(File::open(path)?)
}

fn read(mut source: impl Read) -> Result<Vec<u8>, FileError> {
    let mut bytes = Vec::new();
    source.by_ref().take(SMALLEST as u64).read_to_end(&mut bytes)?;
    let rest = announced_len(&bytes)?.saturating_sub(bytes.len());
    source.take(rest as u64 + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Line, Material, PlaneLobe, View};
    use std::vec;

    fn material() -> Vec<u8> {
        let color_differences = [0.0; 2];
        let lobe = PlaneLobe {
            angle: 0.0,
            off_plane: 0.0,
            log2_sharpness: 3.0,
            log2_luminance: -3.0,
            color_differences,
        };
        let view = View {
            theta: 0.0,
            log2_squeeze: 0.0,
            log2_diffuse: -2.0,
            diffuse_color_differences: color_differences,
            lobes: &[lobe],
        };
        let line = Line { views: &[view], squeezed: 0, mirrored: 0, factors: None };
        let mut bytes = vec![0; line.encoded_len("test")];
        line.encode("test", &mut bytes).unwrap();
        bytes
    }

    /// Counts the bytes that are taken from an endless file that starts with some bytes.
    struct Endless<'a> {
        start: &'a [u8],
        taken: usize,
    }

    impl Read for Endless<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            for (i, byte) in buffer.iter_mut().enumerate() {
                *byte = self.start.get(self.taken + i).copied().unwrap_or(0);
            }
            self.taken += buffer.len();
            Ok(buffer.len())
        }
    }

    #[test]
    fn a_file_comes_back_whole_and_a_cut_one_as_it_is() {
        let bytes = material();
        for cut in SMALLEST..=bytes.len() {
            assert_eq!(read(&bytes[..cut]).unwrap(), bytes[..cut]);
        }
        for cut in 0..SMALLEST {
            let error = read(&bytes[..cut]).unwrap_err();
            assert!(
                matches!(error, FileError::Format(f) if f == Material::from_bytes(&bytes[..cut]).unwrap_err())
            );
        }
    }

    #[test]
    fn an_endless_file_is_read_no_further_than_it_announces() {
        let bytes = material();
        let mut endless = Endless { start: &bytes, taken: 0 };
        let read_bytes = read(&mut endless).unwrap();
        assert_eq!((read_bytes.len(), endless.taken), (bytes.len() + 1, bytes.len() + 1));
        assert!(matches!(Material::from_bytes(&read_bytes), Err(FormatError::Length { .. })));

        let mut zeros = Endless { start: &[], taken: 0 };
        assert!(matches!(read(&mut zeros), Err(FileError::Format(FormatError::Magic))));
        assert_eq!(zeros.taken, SMALLEST);
    }

    #[test]
    fn a_file_that_is_not_there_gives_the_reason_of_the_system() {
        let error = read_file(Path::new("/no/such/file.srbf")).unwrap_err();
        assert!(matches!(error, FileError::Io(ref e) if e.kind() == io::ErrorKind::NotFound));
    }

    /// A pipe that nobody writes to would hold whoever opens it.
    #[cfg(unix)]
    #[test]
    fn only_regular_files_are_opened() {
        let pipe = std::env::temp_dir().join(std::format!("srbf-pipe-{}", std::process::id()));
        let _ = std::fs::remove_file(&pipe);
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        for path in [pipe.as_path(), Path::new("/dev/zero"), Path::new("/")] {
            let error = read_file(path).unwrap_err();
            assert!(
                matches!(error, FileError::Io(ref e) if e.kind() == io::ErrorKind::InvalidInput),
                "{error}"
            );
        }
        std::fs::remove_file(&pipe).unwrap();
    }
}
