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
    let marks = [
        (Encoding::Utf8, &b"\xef\xbb\xbf"[..]),
        (Encoding::Utf16Le, b"\xff\xfe"),
        (Encoding::Utf16Be, b"\xfe\xff"),
    ];
    let marked = marks.into_iter().find(|(_, mark)| bytes.starts_with(mark));
    let start = &bytes[..bytes.len().min(LOOKED_AT)];
    let zeros = |odd: usize| start.iter().skip(odd).step_by(2).filter(|b| **b == 0).count() * 4 > start.len();
    let encoding = match marked {
        Some((encoding, _)) => encoding,
        None if zeros(1) && !zeros(0) => Encoding::Utf16Le,
        None if zeros(0) && !zeros(1) => Encoding::Utf16Be,
        None if std::str::from_utf8(bytes).is_ok() => Encoding::Utf8,
        None => Encoding::Western,
    };
    if !matches!(encoding, Encoding::Utf16Le | Encoding::Utf16Be) {
        let is_control = |b: &u8| *b == 0 || (*b < 32 && !b"\t\n\r\x0c\x1a".contains(b));
        if let Some(offset) = bytes.iter().position(is_control) {
            return Err(ReadError::NotText { offset });
        }
    }
    let text = &bytes[marked.map_or(0, |(_, mark)| mark.len())..];
    let text: Cow<'_, str> = match encoding {
        Encoding::Utf8 => String::from_utf8_lossy(text),
        Encoding::Utf16Le => utf16(text, u16::from_le_bytes).into(),
        Encoding::Utf16Be => utf16(text, u16::from_be_bytes).into(),
        Encoding::Western => text.iter().map(|b| western(*b)).collect::<String>().into(),
    };
    // Old programs end lines by CR alone.
    let is_old = text.contains('\r') && !text.contains('\n');
    Ok(if is_old { text.replace('\r', "\n").into() } else { text })
}

/// How characters are stored.
#[derive(Clone, Copy)]
enum Encoding {
    Utf8,
    Utf16Le,
    Utf16Be,
    /// Windows-1252, which Latin-1 is part of.
    Western,
}

/// Text of 16-bit units; a half pair, and a half unit at the end, become the mark of a replaced character.
fn utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> String {
    let (units, rest) = bytes.as_chunks();
    let characters = char::decode_utf16(units.iter().map(|pair| unit(*pair)));
    let rest = rest.iter().map(|_| char::REPLACEMENT_CHARACTER);
    characters.map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).chain(rest).collect()
}

/// A character of Windows-1252, by the table of the WHATWG encoding standard.
fn western(byte: u8) -> char {
    const FROM_80: [char; 32] = [
        '\u{20ac}', '\u{81}', '\u{201a}', '\u{192}', '\u{201e}', '\u{2026}', '\u{2020}', '\u{2021}',
        '\u{2c6}', '\u{2030}', '\u{160}', '\u{2039}', '\u{152}', '\u{8d}', '\u{17d}', '\u{8f}', '\u{90}',
        '\u{2018}', '\u{2019}', '\u{201c}', '\u{201d}', '\u{2022}', '\u{2013}', '\u{2014}', '\u{2dc}',
        '\u{2122}', '\u{161}', '\u{203a}', '\u{153}', '\u{9d}', '\u{17e}', '\u{178}',
    ];
    match byte {
        0x80..=0x9f => FROM_80[usize::from(byte - 0x80)],
        _ => char::from(byte),
    }
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
