//! Rows of comma-separated numbers, each with its place for the error message.

use crate::ReadError;

/// The text of a file.
pub(crate) fn text(bytes: &[u8]) -> Result<&str, ReadError> {
    std::str::from_utf8(bytes).map_err(|e| ReadError::NotText { offset: e.valid_up_to() })
}

/// Parses a row into exactly `out.len()` finite numbers; `line` counts from 1.
pub(crate) fn row(line: usize, text: &str, out: &mut [f64]) -> Result<(), ReadError> {
    let words = text.split(',').count();
    if words != out.len() {
        return Err(ReadError::Content(format!(
            "line {line}: {words} columns where {} were expected",
            out.len()
        )));
    }
    for (index, (word, out)) in text.split(',').map(str::trim).zip(out).enumerate() {
        *out = word.parse().ok().filter(|v: &f64| v.is_finite() && v.abs() <= 1e9).ok_or_else(|| {
            ReadError::Word {
                line,
                index: index + 1,
                found: word.chars().take(40).collect(),
                expected: "a number, at most 1e9 in size,".to_owned(),
            }
        })?;
    }
    Ok(())
}
