//! The text of a file, whatever program saved it: UTF-8, UTF-16 with or without a byte order mark, or a Western code page.

use crate::ReadError;
use std::borrow::Cow;

/// Bytes that are looked at to tell UTF-16 without a mark.
const LOOKED_AT: usize = 200;

/// Decodes the bytes of a text.
///
/// # Errors
/// [`ReadError::NotText`] for a byte 0 in a file that is no UTF-16: a binary file.
pub(crate) fn decode(bytes: &[u8]) -> Result<Cow<'_, str>, ReadError> {
    use encoding_rs::{Encoding, UTF_8, UTF_16BE, UTF_16LE, WINDOWS_1252};
    let marked = Encoding::for_bom(bytes).map(|(encoding, _)| encoding);
    let start = &bytes[..bytes.len().min(LOOKED_AT)];
    let zeros = |odd: usize| start.iter().skip(odd).step_by(2).filter(|b| **b == 0).count() * 4 > start.len();
    let encoding = match marked {
        Some(encoding) => encoding,
        None if zeros(1) && !zeros(0) => UTF_16LE,
        None if zeros(0) && !zeros(1) => UTF_16BE,
        None if std::str::from_utf8(bytes).is_ok() => UTF_8,
        None => WINDOWS_1252,
    };
    if encoding != UTF_16LE && encoding != UTF_16BE {
        let is_control = |b: &u8| *b == 0 || (*b < 32 && !b"\t\n\r\x0c\x1a".contains(b));
        if let Some(offset) = bytes.iter().position(is_control) {
            return Err(ReadError::NotText { offset });
        }
    }
    let (text, _, _) = encoding.decode(bytes);
    Ok(text)
}

/// The part of a file that an error shows: at most 60 characters, none that a terminal obeys.
pub(crate) fn shortened(text: &str) -> String {
    text.chars().take(60).map(|c| if c.is_control() { ' ' } else { c }).collect::<String>().trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_of_all_encodings_are_the_same_text() {
        let text = "theta_i,phi_i\n1,2\n";
        let wide = |bytes: fn(u16) -> [u8; 2], mark: bool| -> Vec<u8> {
            let mark = mark.then_some(0xfeffu16);
            mark.into_iter().chain(text.encode_utf16()).flat_map(bytes).collect()
        };
        let with_mark = format!("\u{feff}{text}").into_bytes();
        for bytes in [
            text.as_bytes().to_vec(),
            with_mark,
            wide(u16::to_le_bytes, true),
            wide(u16::to_be_bytes, true),
            wide(u16::to_le_bytes, false),
            wide(u16::to_be_bytes, false),
        ] {
            assert_eq!(decode(&bytes).unwrap(), text, "{bytes:?}");
        }
        assert_eq!(decode(b"theta [\xb0]").unwrap(), "theta [\u{b0}]");
        assert_eq!(decode(b"ab\0cd").unwrap_err(), ReadError::NotText { offset: 2 });
        assert_eq!(shortened("a\u{1b}[31mb\n"), "a [31mb");
    }
}
