//! Why bytes are no material.

use core::fmt;

/// Version of the `.srbf` bytes that this library writes; it reads all from version 1 on.
pub const FORMAT_VERSION: u32 = 3;

/// Why bytes are not a `.srbf` material, with the place.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum FormatError {
    /// The first 8 bytes are not the `.srbf` magic.
    Magic,
    /// The version is one that this library does not read.
    Version(u32),
    /// The bytes end early, or more bytes follow than the header announces.
    Length {
        /// Bytes that the header announces (or its own size, if not even that is there).
        expected: usize,
        /// Bytes given.
        actual: usize,
    },
    /// The checksum does not fit the bytes.
    Checksum,
    /// A field holds a value outside its range; the byte offset tells which.
    Field {
        /// The field.
        name: &'static str,
        /// Where it stands, in bytes from the start.
        offset: usize,
    },
    /// The bytes are those of a sheet where a material is expected, or the other way round.
    Kind {
        /// Whether they are those of a sheet.
        is_sheet: bool,
    },
    /// The buffer to encode into is too small.
    Buffer {
        /// Bytes that are needed.
        needed: usize,
        /// Bytes given.
        available: usize,
    },
}

impl FormatError {
    /// The same of bytes that stand at an offset.
    pub(crate) fn moved(self, by: usize) -> Self {
        match self {
            Self::Field { name, offset } => Self::Field { name, offset: offset + by },
            other => other,
        }
    }
}

impl fmt::Display for FormatError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Magic => f.write_str("not a .srbf file: the first 8 bytes must be its magic"),
            Self::Version(v) => {
                write!(f, "version {v} at byte 8, this library reads versions 1 to {}", FORMAT_VERSION)
            }
            Self::Length { expected, actual } => write!(f, "{expected} bytes expected, {actual} found"),
            Self::Checksum => f.write_str("the checksum does not fit: the .srbf bytes are damaged"),
            Self::Field { name, offset } => write!(f, "{name} at byte {offset} is out of range"),
            Self::Kind { is_sheet: true } => {
                f.write_str("a sheet, which has several materials, where one material is expected")
            }
            Self::Kind { is_sheet: false } => f.write_str("a material where a sheet is expected"),
            Self::Buffer { needed, available } => {
                write!(f, "the buffer has {available} bytes, {needed} are needed")
            }
        }
    }
}

impl core::error::Error for FormatError {}
