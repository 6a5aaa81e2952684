//! The text, written out in a language.

use crate::calls::{replace_word, rewrite, split, suffix_numbers};
use crate::language::Language;
use crate::wgsl;

/// The text itself.
const TEXT: &str = include_str!("srbf.inc");

/// Writes the text out, with the prelude of the language and without a material.
///
/// In C++ and CUDA a material is a pointer to its words, in Metal one to `device` memory. Elsewhere it is a number of the caller's, by which
/// a function of the caller's, `srbf_word`, finds the words.
pub fn text(language: Language) -> String {
    let body: String = TEXT.lines().filter_map(|line| rewritten(line, language)).collect();
    let body = if language == Language::Wgsl { wgsl::declarations(&body) } else { body };
    format!("{}{body}{}", language.head(), language.tail())
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
            code = code
                .replace("(SrbfMaterial m", "(const SrbfMaterial &m")
                .replace("SrbfView v", "const SrbfView &v");
            // The result is no parameter.
            code = code.replace("FN const SrbfView &v", "FN SrbfView v");
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
    if language.has_pointers() {
        code = suffix_numbers(&code);
    }
    for (token, by) in language.words() {
        code = replace_word(&code, token, by);
    }
    code = code.replace("* data", "*data");
    Some(format!("{}\n", format!("{code}{comment}").trim_end()))
}
