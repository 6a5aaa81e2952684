//! Errors between a file and a material. The reason is the `source` of an error, not part of its own text.
//!
//! Names of files and words from files stand in them as they are; the texts show them through [`printable`].

use srbf_core::printable;
use std::error::Error as Any;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// An error and its reasons, such as the name of a file, and why the system refuses it.
#[doc(hidden)]
pub fn with_reasons(error: &dyn Any) -> String {
    let (mut text, mut source) = (error.to_string(), error.source());
    while let Some(reason) = source {
        text += &format!(": {reason}");
        source = reason.source();
    }
    text
}

/// A fault in the content of a measured file, with the place.
#[derive(Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum ReadError {
    /// A text format with bytes that are not text.
    #[error("byte {offset} is not UTF-8 text: a binary file of a kind that is not known, or a damaged text")]
    NotText {
        /// Offset of the first such byte.
        offset: usize,
    },
    /// A word of a text format that is not what belongs there.
    #[error("line {line}, number {index}: `{}` where {expected} was expected", printable(.found))]
    Word {
        /// Line, from 1.
        line: usize,
        /// Number in the file, comments not counted, from 1.
        index: usize,
        /// The word, cut after 40 characters.
        found: String,
        /// What belongs there.
        expected: String,
    },
    /// The file ends too early.
    #[error("ends after number {count}, line {line}, where {expected} was expected")]
    Truncated {
        /// Numbers before the end.
        count: usize,
        /// Last line.
        line: usize,
        /// The missing thing.
        expected: String,
    },
    /// No row is a sample; the text says why.
    #[error("{}", printable(.0))]
    NoSamples(String),
    /// Something other than a number is wrong; the text says what and where.
    #[error("{}", printable(.0))]
    Content(String),
}

/// An error between a file and a material.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FitError {
    /// A file could not be read or written.
    #[error("{}", printable(&.path.to_string_lossy()))]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// A file that was read has a fault.
    #[error("{}", printable(&.path.to_string_lossy()))]
    Read {
        /// The file.
        path: PathBuf,
        /// The fault.
        source: ReadError,
    },
    /// A table that nothing can be fitted to.
    #[error("the table cannot be fitted: {}", printable(.0))]
    Table(String),
    /// A setting out of its range.
    #[error("setting {name}: {}", printable(.reason))]
    Setting {
        /// The setting.
        name: &'static str,
        /// Its range.
        reason: String,
    },
    /// There is less memory than the fit takes.
    #[error("there is too little memory for the fit")]
    Memory(#[source] io::Error),
    /// There are no threads to work on; the text says why.
    #[error("{0}")]
    Threads(String),
    /// The fitted lobes have no place in a material.
    #[error("the fit is no material")]
    Format(#[from] srbf_core::FormatError),
    /// The material cannot be evaluated.
    #[error("the fit cannot be evaluated")]
    Core(#[from] srbf_core::Error),
}

impl FitError {
    /// Names the file of a system error.
    #[doc(hidden)]
    pub fn io(path: &Path) -> impl FnOnce(io::Error) -> Self + '_ {
        move |source| Self::Io { path: path.to_path_buf(), source }
    }
}
