//! A fit as one page of HTML: that of `srbf view`, with the material in it.

use crate::command::view;
use crate::out::output;
use anyhow::anyhow;
use srbf_fit::judge::report::Report;
use srbf_fit::read::Content;
use srbf_web::{Opened, of_fit};
use std::path::Path;

/// The content of a page: a material, its report and its measurement.
///
/// # Errors
/// Bytes that are no material.
pub fn opened(
    name: &str,
    bytes: &[u8],
    report: Option<&Report>,
    content: Option<&Content>,
) -> anyhow::Result<Opened> {
    of_fit(name, bytes, report, content).map_err(|text| anyhow!(text))
}

/// Writes the page with the lines of a verdict.
///
/// # Errors
/// Names the file that cannot be written.
pub fn write(path: &Path, opened: Opened, words: &[String]) -> anyhow::Result<()> {
    output::write(path, view::one_file(&opened.judged(words))?.as_bytes())
}
