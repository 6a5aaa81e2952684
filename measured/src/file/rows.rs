//! Rows of numbers, each with its place for the error message.

use super::decode::shortened;
use crate::ReadError;

/// The text of a file.
pub fn text(bytes: &[u8]) -> Result<&str, ReadError> {
    std::str::from_utf8(bytes).map_err(|e| ReadError::NotText { offset: e.valid_up_to() })
}

/// Parses a comma-separated row into exactly `out.len()` finite numbers; `line` counts from 1.
pub fn row(line: usize, text: &str, out: &mut [f64]) -> Result<(), ReadError> {
    let words = text.split(',').count();
    if words != out.len() {
        return Err(ReadError::Content(format!(
            "line {line}: {words} columns where {} were expected",
            out.len()
        )));
    }
    fill(line, text.split(',').map(str::trim), out)
}

/// Parses a row of words into `out.len()` finite numbers; more words may follow.
pub(crate) fn numbers(line: usize, text: &str, out: &mut [f64]) -> Result<(), ReadError> {
    let words = text.split_whitespace().count();
    if words < out.len() {
        return Err(ReadError::Content(format!(
            "line {line}: {words} numbers where {} were expected",
            out.len()
        )));
    }
    fill(line, text.split_whitespace(), out)
}

/// Parses words into `out.len()` finite numbers; `line` counts from 1.
pub(crate) fn fill<'a>(
    line: usize,
    words: impl Iterator<Item = &'a str>,
    out: &mut [f64],
) -> Result<(), ReadError> {
    for (index, (word, out)) in words.zip(out).enumerate() {
        *out = word.parse().ok().filter(|v: &f64| v.is_finite() && v.abs() <= 1e9).ok_or_else(|| {
            ReadError::Word {
                line,
                index: index + 1,
                found: shortened(word),
                expected: "a number, at most 1e9 in size,".to_owned(),
            }
        })?;
    }
    Ok(())
}
