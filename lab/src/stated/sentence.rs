//! A sentence of a document with figures in it: where it stands, and its numbers.

use std::ops::Range;

/// A number of a document.
#[derive(Clone, Debug, PartialEq)]
pub struct Stated {
    /// The name of the figure.
    pub figure: String,
    /// Its bytes in the document.
    pub range: Range<usize>,
}

/// A part of a sentence.
enum Piece<'a> {
    /// Text as it is; any white space stands for any other.
    Text(&'a str),
    /// A number, by the name of its figure.
    Number(&'a str),
}

/// The parts of a sentence; the names of figures stand in braces.
fn pieces(sentence: &str) -> Vec<Piece<'_>> {
    let mut pieces = Vec::new();
    let mut rest = sentence;
    while let Some((text, after)) = rest.split_once('{') {
        let (name, behind) = after.split_once('}').unwrap_or((after, ""));
        pieces.extend([Piece::Text(text), Piece::Number(name)]);
        rest = behind;
    }
    pieces.push(Piece::Text(rest));
    pieces
}

/// The names of the figures of a sentence.
#[cfg(test)]
pub fn figures(sentence: &str) -> impl Iterator<Item = &str> {
    pieces(sentence).into_iter().filter_map(|piece| match piece {
        Piece::Number(name) => Some(name),
        Piece::Text(_) => None,
    })
}

/// The numbers of a sentence in a document.
///
/// # Errors
/// Says so where the document does not hold the sentence exactly once.
pub fn find(document: &str, sentence: &str) -> anyhow::Result<Vec<Stated>> {
    let pieces = pieces(sentence);
    let starts = document.char_indices().map(|(at, _)| at);
    let found: Vec<Vec<Stated>> = starts.filter_map(|at| matched(document, at, &pieces)).collect();
    match <[_; 1]>::try_from(found) {
        Ok([places]) => Ok(places),
        Err(found) => {
            anyhow::bail!(
                "the sentence `{sentence}` stands there {} times, once is expected: change `lab/src/stated/list.rs` \
                 with the words of a document",
                found.len()
            )
        }
    }
}

/// The numbers, if the pieces stand at a place.
fn matched(document: &str, at: usize, pieces: &[Piece<'_>]) -> Option<Vec<Stated>> {
    let Some((first, rest)) = pieces.split_first() else { return Some(Vec::new()) };
    match first {
        Piece::Text(text) => matched(document, after_text(document, at, text)?, rest),
        Piece::Number(name) => {
            let longest = document[at..].bytes().take_while(|c| b"0123456789.e-+".contains(c)).count();
            // The longest number behind which the rest stands: a point may end the sentence.
            (1..=longest).rev().find_map(|length| {
                let range = at..at + length;
                document[range.clone()].parse::<f64>().ok()?;
                let mut places = matched(document, range.end, rest)?;
                places.insert(0, Stated { figure: (*name).to_owned(), range });
                Some(places)
            })
        }
    }
}

/// Where a text ends that stands at a place.
fn after_text(document: &str, at: usize, text: &str) -> Option<usize> {
    let (mut at, mut rest) = (at, text);
    while let Some(expected) = rest.chars().next() {
        let found = document[at..].chars().next()?;
        if expected.is_whitespace() {
            let spaces = |text: &str| text.len() - text.trim_start().len();
            (at, rest) = (at + Some(spaces(&document[at..])).filter(|n| *n > 0)?, &rest[spaces(rest)..]);
        } else if expected == found {
            (at, rest) = (at + found.len_utf8(), &rest[expected.len_utf8()..]);
        } else {
            return None;
        }
    }
    Some(at)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(document: &str, sentence: &str) -> Vec<(String, String)> {
        let places = find(document, sentence).unwrap();
        places.into_iter().map(|p| (p.figure, document[p.range].to_owned())).collect()
    }

    #[test]
    fn numbers_are_found_whatever_breaks_the_line() {
        let page = "An error\nof 3.9e-6, and ± 12.\nAn error of nothing.";
        let pair = |name: &str, number: &str| (name.to_owned(), number.to_owned());
        assert_eq!(numbers(page, "error of {a b}, and ± {c}."), [pair("a b", "3.9e-6"), pair("c", "12")]);
        assert_eq!(numbers(page, "± {c}"), [pair("c", "12.")].map(|_| pair("c", "12.")));
        assert_eq!(figures("of {a b} and {c}").collect::<Vec<_>>(), ["a b", "c"]);
    }

    #[test]
    fn what_is_not_there_once_is_refused() {
        for (page, sentence) in [("one 1, one 1,", "one {n},"), ("two 2", "one {n}"), ("one -", "one {n}")] {
            let text = find(page, sentence).unwrap_err().to_string();
            assert!(text.contains(sentence), "{text}");
        }
    }
}
