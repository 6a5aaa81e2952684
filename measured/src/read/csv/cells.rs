//! A number in any usual writing.

/// The content of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cell {
    Number(f64),
    /// Nothing, or a word that stands for nothing.
    Nothing,
    /// Anything else.
    Odd,
}

/// Words that stand for nothing measured.
const NOTHING: [&str; 18] = [
    "",
    "-",
    "--",
    "na",
    "n/a",
    "#n/a",
    "nan",
    "-nan",
    "nan(ind)",
    "-nan(ind)",
    "null",
    "none",
    "nil",
    "missing",
    "#div/0!",
    "#value!",
    "#num!",
    "inf",
];

/// Units of values and angles that may stand behind a number.
const UNITS: [&str; 8] = ["sr^-1", "sr^{-1}", "sr-1", "sr\u{207b}\u{b9}", "1/sr", "/sr", "degrees", "deg"];

/// Least signs that stand for a number which is too wide: fewer begin a comment.
const WIDE: usize = 4;

/// What begins a comment behind a number.
const COMMENTS: [&str; 4] = [" #", " //", " %", " !"];

/// Numbers that programs write for nothing are as large as this.
const FILL: f64 = 1e20;

/// Largest number that is believed.
pub(super) const LARGEST: f64 = 1e9;

impl Cell {
    pub fn of(text: &str) -> Self {
        let word = text.trim().trim_matches('"').trim();
        if let Some(number) = number(word) {
            return match number.abs() {
                size if size >= FILL => Self::Nothing,
                size if size > LARGEST => Self::Odd,
                _ => Self::Number(number),
            };
        }
        let lower = word.to_lowercase();
        // What Fortran and spreadsheets write where a number does not fit.
        let is_too_wide =
            word.len() >= WIDE && ['*', '#'].iter().any(|mark| word.chars().all(|c| c == *mark));
        if is_too_wide {
            return Self::Nothing;
        }
        if let Some((before, _)) = COMMENTS.iter().find_map(|mark| word.split_once(mark)) {
            return Self::of(before);
        }
        let is_nothing = NOTHING.contains(&lower.as_str()) || lower.ends_with("inf") || lower == "infinity";
        if is_nothing { Self::Nothing } else { Self::Odd }
    }
}

/// A finite number: with a decimal point or comma, an exponent by `e` or `d`, the minus sign of type setters, and a unit of angles or values.
pub(super) fn number(text: &str) -> Option<f64> {
    let bare = text.trim().trim_matches('"').trim_end_matches(['\u{b0}', '%']).trim();
    if let Ok(number) = bare.parse::<f64>() {
        return Some(number).filter(|v| v.is_finite());
    }
    let bare =
        UNITS.iter().find_map(|unit| bare.strip_suffix(unit)).unwrap_or(bare).trim_end_matches('\u{b0}');
    let mut plain: String =
        bare.chars().filter(|c| !c.is_whitespace() && *c != '\'' && *c != '\u{2019}').collect();
    plain = plain.replace(['\u{2212}', '\u{2013}'], "-").replace(['d', 'D'], "e");
    match (plain.rfind(','), plain.rfind('.')) {
        (Some(comma), Some(point)) if comma > point => plain = plain.replace('.', "").replace(',', "."),
        (Some(_), Some(_)) => plain = plain.replace(',', ""),
        (Some(_), None) if plain.matches(',').count() == 1 => plain = plain.replace(',', "."),
        _ => {}
    }
    let is_number = plain.chars().all(|c| c.is_ascii_digit() || "+-.eE".contains(c));
    plain.parse::<f64>().ok().filter(|v| is_number && v.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_all_locales_are_numbers() {
        for (text, value) in [
            ("0.125", 0.125),
            ("0,125", 0.125),
            ("\"0,125\"", 0.125),
            ("1.234,5", 1234.5),
            ("1,234.5", 1234.5),
            ("1 234,5", 1234.5),
            ("\u{2212}3,5E-02", -0.035),
            ("1.0D-03", 1e-3),
            ("30\u{b0}", 30.0),
            ("-.5", -0.5),
            ("0,125 sr^-1", 0.125),
            ("30 deg", 30.0),
            ("0.125 % lamp flickered", 0.125),
            ("0.125 # 3", 0.125),
        ] {
            assert_eq!(Cell::of(text), Cell::Number(value), "{text}");
        }
        for text in ["", " ", "NaN", "-nan(ind)", "#DIV/0!", "n/a", "1e30", "-inf", "--", "*****", "####"] {
            assert_eq!(Cell::of(text), Cell::Nothing, "{text}");
        }
        for text in ["x", "1,2,3", "12:30", "1e10", "0x10", "de", "e", "1 m", "sr^-1", "# 3"] {
            assert_eq!(Cell::of(text), Cell::Odd, "{text}");
        }
    }
}
