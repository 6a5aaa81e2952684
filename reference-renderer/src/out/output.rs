//! Files that are written: their places are checked before a long work, and they are whole or absent.

use anyhow::{Context, ensure};
use std::path::Path;

/// Writes a file, with the folders above it; replaces what was there in one step.
///
/// # Errors
/// Names the file.
pub fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    srbf_fit::write_atomically(path, bytes).context("cannot write")
}

/// Refuses a name that ends in another extension: what is written beside the file has its name with another ending.
///
/// # Errors
/// Names the file and the extension.
pub fn check_extension(path: &Path, extension: &str) -> anyhow::Result<()> {
    let fits = path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension));
    ensure!(fits, "output {}: a name that ends in .{extension} is expected", path.display());
    Ok(())
}

/// [`check_place`] of several files.
///
/// # Errors
/// Names the first that cannot be written.
pub fn check_places(paths: &[&Path]) -> anyhow::Result<()> {
    paths.iter().try_for_each(|path| check_place(path))
}

/// Finds out, before a long work, whether a file can be written; leaves nothing behind.
///
/// # Errors
/// Names the file.
pub fn check_place(path: &Path) -> anyhow::Result<()> {
    srbf_fit::check_output(path).context("cannot write")
}
