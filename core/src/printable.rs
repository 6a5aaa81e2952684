//! The border for text: words of a stranger, in a file, a name or an argument, on its way to a terminal, a page or
//! a message.
//!
//! Such text may hold escape sequences that a terminal obeys and marks that turn the order of the following text. Line ends make
//! one line look like two. None of them passes: each is spelled out, as `\u{1b}`. May import: nothing; nothing else prints a
//! string of a stranger.

use core::fmt::{self, Display, Formatter, Write};

/// Text in which nothing but visible characters and spaces is left, see [`printable`].
#[derive(Clone, Copy, Debug)]
pub struct Printable<'a> {
    text: &'a str,
    /// Whether ends of lines pass.
    of_lines: bool,
}

/// Makes text of a stranger fit to be shown.
///
/// Spelled out, as `\u{1b}` is, are control characters (line ends and tabulators too), the marks and overrides of
/// bidirectional text, line and paragraph separators, characters without width, and tags. Everything else stays as it is,
/// so that names of every script are read as they are written.
///
/// ```
/// use srbf_core::printable;
///
/// assert_eq!(printable("Größe 3, 金").to_string(), "Größe 3, 金");
/// assert_eq!(printable("red\u{1b}[31m\n").to_string(), "red\\u{1b}[31m\\u{a}");
/// assert_eq!(printable("gnp.\u{202e}frbs").to_string(), "gnp.\\u{202e}frbs");
/// ```
pub fn printable(text: &str) -> Printable<'_> {
    Printable { text, of_lines: false }
}

/// The same for text that is of several lines by right: ends of lines pass.
///
/// ```
/// use srbf_core::printable_lines;
///
/// assert_eq!(printable_lines("one\n\u{7}two\n").to_string(), "one\n\\u{7}two\n");
/// ```
pub fn printable_lines(text: &str) -> Printable<'_> {
    Printable { text, of_lines: true }
}

/// Whether a character would be obeyed, or not be seen.
fn is_hidden(c: char) -> bool {
    c.is_control()
        || matches!(c,
            '\u{ad}' // soft hyphen
            | '\u{61c}' | '\u{200e}' | '\u{200f}' // marks of direction
            | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' // embeddings, overrides, isolates
            | '\u{2028}' | '\u{2029}' // ends of lines and paragraphs
            | '\u{180e}' | '\u{200b}'..='\u{200d}' | '\u{2060}'..='\u{2065}' | '\u{206a}'..='\u{206f}' | '\u{feff}' // no width
            | '\u{fff9}'..='\u{fffb}' // annotations
            | '\u{e0000}'..='\u{e0fff}' // tags
        )
}

impl Display for Printable<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let mut rest = self.text;
        let stops = |c| is_hidden(c) && !(self.of_lines && c == '\n');
        while let Some(at) = rest.find(stops) {
            let (before, from) = rest.split_at(at);
            f.write_str(before)?;
            let mut characters = from.chars();
            for escaped in characters.next().into_iter().flat_map(char::escape_unicode) {
                f.write_char(escaped)?;
            }
            rest = characters.as_str();
        }
        f.write_str(rest)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::{String, ToString};

    #[test]
    fn nothing_hidden_passes_and_all_else_does() {
        for c in (0..=0x10_ffff).filter_map(char::from_u32) {
            let text = printable(c.encode_utf8(&mut [0; 4])).to_string();
            let is_written = text.starts_with("\\u{") && text.is_ascii();
            assert!(is_written || text == String::from(c), "{text}");
            assert!(is_written == is_hidden(c), "{text}");
            assert!(!text.chars().any(is_hidden), "{text}");
        }
        // By numbers, whatever the function above says.
        for codes in [
            0..=0x1f,
            0x7f..=0x9f,
            0xad..=0xad,
            0x61c..=0x61c,
            0x180e..=0x180e,
            0x200b..=0x200f,
            0x2028..=0x202e,
            0x2060..=0x206f,
            0xfeff..=0xfeff,
            0xfff9..=0xfffb,
            0xe0000..=0xe0fff,
        ] {
            for c in codes.filter_map(char::from_u32) {
                let spelled = std::format!("a\\u{{{:x}}}b", u32::from(c));
                assert_eq!(printable(&std::format!("a{c}b")).to_string(), spelled);
            }
        }
        assert_eq!(printable("").to_string(), "");
        assert_eq!(printable("\n\n").to_string(), "\\u{a}\\u{a}");
        assert_eq!(printable_lines("a\n\r\nb").to_string(), "a\n\\u{d}\nb");
        assert_eq!(printable("a\0b").to_string(), "a\\u{0}b");
    }
}
