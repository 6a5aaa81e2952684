//! The words of a text format, one after another, each with its line for the error message.

use crate::ReadError;
use crate::file::decode::shortened;

/// Words that are separated by white space; a line that begins with a mark is a comment.
pub(super) struct Words<'a> {
    words: Box<dyn Iterator<Item = (usize, &'a str)> + 'a>,
    line: usize,
    count: usize,
}

impl<'a> Words<'a> {
    pub fn new(text: &'a str, comment: &'static [&'static str]) -> Self {
        let lines = text.lines().enumerate();
        let lines =
            lines.filter(move |(_, line)| !comment.iter().any(|mark| line.trim_start().starts_with(mark)));
        let words: Box<dyn Iterator<Item = (usize, &'a str)> + 'a> =
            Box::new(lines.flat_map(|(n, line)| line.split_whitespace().map(move |word| (n + 1, word))));
        Self { words, line: 1, count: 0 }
    }

    /// Line of the last word.
    pub fn line(&self) -> usize {
        self.line
    }

    pub fn next(&mut self) -> Option<&'a str> {
        let (line, word) = self.words.next()?;
        self.line = line;
        self.count += 1;
        Some(word)
    }

    /// The next word, which has to be there.
    pub fn word(&mut self, expected: &str) -> Result<&'a str, ReadError> {
        let missing = ReadError::Truncated { count: self.count, line: self.line, expected: expected.into() };
        self.next().ok_or(missing)
    }

    /// The next word as a number.
    pub fn number(&mut self, expected: &str) -> Result<f64, ReadError> {
        let word = self.word(expected)?;
        match word.parse::<f64>() {
            Ok(number) if number.is_finite() && number.abs() <= 1e9 => Ok(number),
            _ => Err(self.odd(word, expected)),
        }
    }

    /// The next word as a count up to a limit.
    pub fn count(&mut self, expected: &str, most: usize) -> Result<usize, ReadError> {
        let word = self.word(expected)?;
        match word.parse::<usize>() {
            Ok(number) if number <= most => Ok(number),
            _ => Err(self.odd(word, expected)),
        }
    }

    /// The next numbers.
    pub fn numbers(&mut self, count: usize, expected: &str) -> Result<Vec<f64>, ReadError> {
        (0..count).map(|_| self.number(expected)).collect()
    }

    /// A word that is not what belongs there.
    pub fn odd(&self, word: &str, expected: &str) -> ReadError {
        let found = shortened(word);
        ReadError::Word { line: self.line, index: self.count, found, expected: expected.into() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_has_its_line_and_comments_have_none() {
        let mut words = Words::new("1 2\n! none\n\n3\nodd\n", &["!"]);
        let lines = [(); 3].map(|()| words.number("a number").map(|number| (number, words.line())).unwrap());
        assert_eq!(lines, [(1.0, 1), (2.0, 1), (3.0, 4)]);
        assert!(words.number("a number").unwrap_err().to_string().contains("line 5"));
    }
}
