//! The text, written out in a language.

use crate::calls::{replace_word, rewrite, split, suffix_numbers};
use crate::language::Language;
use crate::usage::{Content, usage};
use crate::wgsl;

/// The text itself.
const TEXT: &str = include_str!("srbf.inc");

/// What stands behind it for sheets.
const SHEET: &str = include_str!("sheet.inc");

/// What stands behind that for blends.
const BLEND: &str = include_str!("blend.inc");

/// Objects that C++ passes by reference, as parameters of the text.
const OBJECTS: [&str; 8] = [
    "SrbfMaterial m",
    "SrbfView v",
    "SrbfSheet s",
    "SrbfHalf h",
    "SrbfSheetView v",
    "SrbfBlend b",
    "SrbfMaterial first",
    "SrbfMaterial second",
];

/// Writes the text out, with its calls, the prelude of the language and without a material.
///
/// In C++ and CUDA a material is a pointer to its words, in Metal one to `device` memory. Elsewhere it is a number of the caller's, by which
/// a function of the caller's, `srbf_word`, finds the words.
pub fn text(language: Language) -> String {
    usage(language, Content::Material, false) + &functions(language, Content::Material)
}

/// Writes the text out with the functions of a sheet behind those of a material; else as [`text`].
///
/// A quarter lies within the words of its sheet: word `i` of `data + n` has to be word `n + i` of `data`, where `srbf_word` is the caller's.
pub fn sheet_text(language: Language) -> String {
    usage(language, Content::Sheet, false) + &functions(language, Content::Sheet)
}

/// Writes the text out with the functions of a sheet and of a blend; else as [`sheet_text`].
pub fn blend_text(language: Language) -> String {
    usage(language, Content::Blend, false) + &functions(language, Content::Blend)
}

/// A text without its calls. One of more content begins as one of less, but for the end of the language.
pub fn functions(language: Language, content: Content) -> String {
    let more = match content {
        Content::Material => String::new(),
        Content::Sheet => body(SHEET, language) + language.sheet_check(),
        Content::Blend => body(SHEET, language) + &body(BLEND, language) + language.sheet_check(),
    };
    format!("{}{}{more}{}", language.head(), body(TEXT, language), language.tail())
}

/// Lines of a text in a language.
fn body(text: &str, language: Language) -> String {
    let body: String = text.lines().filter_map(|line| rewritten(line, language)).collect();
    if language == Language::Wgsl { wgsl::declarations(&body) } else { body }
}

/// A line of the text, with its end; `None` if the language has no use for it.
fn rewritten(line: &str, language: Language) -> Option<String> {
    let (code, comment) = split(line);
    let is_cpp = matches!(language, Language::Cpp | Language::Cuda);
    let mut code = code.to_owned();
    // What only a processor does: it keeps the lobes of a view.
    if is_cpp {
        code = replace_word(&code, "LOBES", "SRBF_LOBES");
        code = replace_word(&code, "LOBE", "SRBF_LOBE");
        code = replace_word(&code, "KEEP", "SRBF_KEEP");
        if code.starts_with("FN") {
            for object in OBJECTS {
                code = replace_word(&code, object, &format!("const {}", object.replace(' ', " &")));
            }
        }
    } else {
        if code.trim() == "LOBES" || code.trim_start().starts_with("KEEP(") {
            return None;
        }
        code = replace_word(&code, "LOBE", "srbf_lobe");
    }
    let select = |a: &[&str]| match language {
        Language::Wgsl => format!("select({}, {}, {})", a[2], a[1], a[0]),
        _ => format!("({} ? {} : {})", a[0], a[1], a[2]),
    };
    code = rewrite(&code, "SELECT", select);
    let word = |a: &[&str]| match language.has_pointers() {
        true => format!("{}[{}]", a[0], a[1]),
        false => format!("srbf_word({}, {})", a[0], a[1]),
    };
    code = rewrite(&code, "WORD", word);
    let is_signed = language.has_pointers() || language == Language::Glsl;
    let place = |a: &[&str]| match is_signed {
        true => format!("{} + {}", a[0], a[1]),
        false => format!("{} + UINT({})", a[0], a[1]),
    };
    code = rewrite(&code, "PLACE", place);
    if language.has_pointers() {
        code = suffix_numbers(&code);
    }
    for (token, by) in language.words() {
        code = replace_word(&code, token, by);
    }
    code = code.replace("* data", "*data");
    Some(format!("{}\n", format!("{code}{comment}").trim_end()))
}
