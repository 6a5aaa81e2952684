//! The ending of a file's name, which tells of some formats what size they have.

use crate::ReadError;
use crate::file::decode::decode;
use std::io::Read;
use std::path::Path;

/// Refuses, before it is read, a file whose name says that it is binary and whose size says that it is not.
pub(super) fn check(ending: &str, path: &Path, size: u64) -> Result<(), ReadError> {
    match ending {
        "binary" => super::merl::check_size(size),
        // Other programs write text with this ending, which is looked at first.
        _ => match (ending, is_binary(path)) {
            (_, None) => Ok(()),
            ("bsdf", Some(_)) => super::rgl::check_size(size),
            (_, Some(offset)) => Err(ReadError::NotText { offset }),
        },
    }
}

/// Where the beginning of a file has a byte that no text has, if it is no text; formats that are known by their first bytes are not asked.
fn is_binary(path: &Path) -> Option<usize> {
    let mut found = Vec::new();
    // What cannot be read is said by who reads it.
    std::fs::File::open(path).ok()?.take(4096).read_to_end(&mut found).ok()?;
    if found.starts_with(b"tensor_file") || found.starts_with(&super::merl::HEAD) {
        return None;
    }
    match decode(&found) {
        Err(ReadError::NotText { offset }) if found[offset] == 0 => Some(offset),
        _ => None,
    }
}
