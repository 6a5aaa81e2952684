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
        _ => match (ending, check_head(path, size)) {
            (_, Ok(())) => Ok(()),
            ("bsdf", Err(ReadError::NotText { .. })) => super::rgl::check_size(size),
            (_, fault) => fault,
        },
    }
}

/// Refuses a file by its beginning: one of another program, and one with a byte that no text has. Formats that are known by their first
/// bytes are not asked.
fn check_head(path: &Path, size: u64) -> Result<(), ReadError> {
    let mut found = Vec::new();
    // What cannot be read is said by who reads it.
    let Ok(file) = std::fs::File::open(path) else { return Ok(()) };
    if file.take(4096).read_to_end(&mut found).is_err() || super::format::is_known_binary(&found, size) {
        return Ok(());
    }
    if let Some(fault) = super::format::foreign(&found) {
        return Err(fault);
    }
    match decode(&found) {
        Err(ReadError::NotText { offset }) if found[offset] == 0 => Err(ReadError::NotText { offset }),
        _ => Ok(()),
    }
}
