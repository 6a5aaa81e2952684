//! Numbers of a text file, one after another, each with its place for the error message.

use crate::ReadError;

/// Reads whitespace-separated numbers; `#` starts a comment to the end of the line.
pub(crate) struct Numbers<'a> {
    words: Box<dyn Iterator<Item = (usize, &'a str)> + 'a>,
    count: usize,
    line: usize,
}

impl<'a> Numbers<'a> {
    pub fn new(bytes: &'a [u8]) -> Result<Self, ReadError> {
        let text = std::str::from_utf8(bytes).map_err(|e| ReadError::NotText { offset: e.valid_up_to() })?;
        let words = text.lines().enumerate().flat_map(|(n, line)| {
            let before_comment = line.split('#').next().unwrap_or_default();
            before_comment.split_whitespace().map(move |word| (n + 1, word))
        });
        Ok(Self { words: Box::new(words), count: 0, line: 1 })
    }

    /// The line of the last number, from 1.
    pub fn line(&self) -> usize {
        self.line
    }

    /// The next number if there is one; `expected` is for the error message.
    pub fn next_if_any(
        &mut self,
        expected: &str,
        valid: impl Fn(f64) -> bool,
    ) -> Result<Option<f64>, ReadError> {
        let Some((line, word)) = self.words.next() else {
            return Ok(None);
        };
        self.line = line;
        self.count += 1;
        match word.parse::<f64>() {
            Ok(v) if v.is_finite() && valid(v) => Ok(Some(v)),
            _ => Err(ReadError::Word {
                line,
                index: self.count,
                found: word.chars().take(40).collect(),
                expected: expected.to_owned(),
            }),
        }
    }

    /// The next number, which has to be there.
    pub fn next(&mut self, expected: &str, valid: impl Fn(f64) -> bool) -> Result<f64, ReadError> {
        let missing =
            ReadError::Truncated { count: self.count, line: self.line, expected: expected.to_owned() };
        self.next_if_any(expected, valid)?.ok_or(missing)
    }
}
