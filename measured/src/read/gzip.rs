//! Files that gzip compressed.

use crate::file::{MAX_FILE, check_memory};
use flate2::read::MultiGzDecoder;
use std::io::{self, Read};

/// First bytes.
pub(super) const HEAD: &[u8] = b"\x1f\x8b\x08";

/// Largest content: bytes for each of the compressed ones, and beside them.
const MOST_TIMES: u64 = 200;
const LEAST: u64 = 1 << 20;

/// The content of a compressed file.
///
/// # Errors
/// Those of a damaged file, and of one whose content is larger than any measurement.
pub(super) fn unpacked(bytes: &[u8]) -> io::Result<Vec<u8>> {
    let most = MAX_FILE.min(LEAST + MOST_TIMES * bytes.len() as u64);
    // The last four bytes are the size of the content, which may lie.
    let said = bytes.last_chunk().map_or(0, |size| u64::from(u32::from_le_bytes(*size)));
    check_memory(said.min(most))?;
    let mut found = Vec::new();
    MultiGzDecoder::new(bytes).take(most + 1).read_to_end(&mut found)?;
    if found.len() as u64 > most {
        return Err(io::Error::other(format!(
            "at most {most} bytes are expected in a compressed file of this size"
        )));
    }
    Ok(found)
}
