//! How a text is called, in its language: the comment that it begins with. And names of a text that are a caller's.

use crate::calls::is_of_name;
use crate::language::Language;
use std::fmt::Write;

/// The functions of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// A material.
    Material,
    /// A material and a sheet.
    Sheet,
    /// A material, a sheet and a blend.
    Blend,
}

/// Type, name, expression and remark of each call. `DATA` is where words are, `MORE` where others are.
type Calls = &'static [(&'static str, &'static str, &'static str, &'static str)];

const MATERIAL: Calls = &[
    ("SrbfMaterial", "material", "srbf_material(DATA)", "once"),
    ("SrbfView", "view", "srbf_prepare(material, wo)", "at every hit"),
    (
        "SrbfSample",
        "drawn",
        "srbf_sample(material, view, VEC3(u0, u1, u2))",
        "a random direction: wi, pdf, weight = f cos / pdf",
    ),
    ("SrbfValue", "light", "srbf_evaluate(material, view, wi)", "light from wi: value = f cos, pdf"),
    ("VEC3", "albedo", "srbf_albedo(material, view)", "light from everywhere"),
];

const SHEET: Calls = &[
    ("SrbfSheet", "sheet", "srbf_sheet(DATA)", "once"),
    ("SrbfSheetView", "view", "srbf_sheet_prepare(sheet, wo)", "at every hit, from either side"),
    (
        "SrbfSample",
        "drawn",
        "srbf_sheet_sample(view, VEC3(u0, u1, u2))",
        "a random direction: wi, pdf, weight = f |cos| / pdf",
    ),
    ("SrbfValue", "light", "srbf_sheet_evaluate(view, wi)", "light from wi: value = f |cos|, pdf"),
    ("VEC3", "albedo", "srbf_half_albedo(view.reflected)", "light from everywhere; also of view.transmitted"),
];

const BLEND: Calls = &[
    ("SrbfMaterial", "paint", "srbf_material(DATA)", "once"),
    ("SrbfMaterial", "metal", "srbf_material(MORE)", "once"),
    (
        "SrbfBlend",
        "blend",
        "srbf_blend(paint, VEC3(0.7, 0.7, 0.7), metal, VEC3(0.3, 0.3, 0.3), wo)",
        "at every hit, weights times tints",
    ),
    (
        "SrbfSample",
        "drawn",
        "srbf_blend_sample(blend, VEC3(u0, u1, u2))",
        "a random direction: wi, pdf, weight = f cos / pdf",
    ),
    ("SrbfValue", "light", "srbf_blend_evaluate(blend, wi)", "light from wi: value = f cos, pdf"),
];

/// The comment that a text begins with: its calls, and what its caller defines. `has_words`: the words of a file stand in it.
pub fn usage(language: Language, content: Content, has_words: bool) -> String {
    let (calls, subject) = match content {
        Content::Material => (MATERIAL, "A material"),
        Content::Sheet => (SHEET, "A sheet"),
        Content::Blend => (BLEND, "A blend of materials"),
    };
    let (data, more) = match (language, has_words) {
        (Language::Wgsl, _) => ("0u", "1u"),
        (language, _) if !language.has_pointers() => ("0", "1"),
        (_, true) => ("srbf_data", "more"),
        (Language::Cpp, false) => ("words.data()", "more.data()"),
        (_, false) => ("words", "more"),
    };
    let is_cpp = matches!(language, Language::Cpp | Language::Cuda);
    let in_language = |text: &str| {
        let vector = match language {
            Language::Glsl => "vec3",
            Language::Wgsl => "vec3f",
            Language::Cuda | Language::Cpp => "srbf_device::vec3",
            Language::Hlsl | Language::Slang | Language::Metal => "float3",
        };
        let is_own = is_cpp && (text.starts_with("Srbf") || text.starts_with("srbf_"));
        let text = if is_own { format!("srbf_device::{text}") } else { text.to_owned() };
        text.replace("VEC3", vector).replace("DATA", data).replace("MORE", more)
    };
    let call = |&(kind, name, value, remark): &(&str, &str, &str, &'static str)| {
        let declared = if language == Language::Wgsl { "let".to_owned() } else { in_language(kind) };
        (format!("{declared} {name} = {};", in_language(value)), remark)
    };
    let mut lines: Vec<(String, &str)> = calls.iter().map(call).collect();
    if is_cpp && !has_words {
        let check = if content == Content::Sheet { "srbf_check_sheet" } else { "srbf_check" };
        let given = if language == Language::Cpp { "words.data(), words.size()" } else { "words, count" };
        lines.insert(
            0,
            (format!("if (srbf_device::{check}({given}) != 0) return fail();"), "on the processor"),
        );
        if language == Language::Cpp {
            lines.insert(
                0,
                ("std::vector<uint32_t> words = ...;".to_owned(), "the bytes of a .srbf file, as they are"),
            );
        }
    }
    let wide = lines.iter().map(|line| line.0.len()).max().unwrap_or_default();
    let mut made = format!(
        "// {subject} of srbf in {}. Written by `srbf export`. How it is called:\n//\n",
        language.title()
    );
    for (line, remark) in lines {
        // Writing to a string does not fail.
        let _ = writeln!(made, "//     {line:wide$}  // {remark}");
    }
    made += "//\n// wo and wi are unit vectors towards viewer and light, in the frame of the surface, whose z axis is the normal. u0, u1 and u2 are\n// random numbers from 0 to 1.\n";
    made += match (language, has_words) {
        (_, true) => {
            "// Nothing is yours to define: the words of the file stand below. --name NAME gives all names another beginning than srbf.\n//\n"
        }
        (Language::Cuda | Language::Cpp, false) => "// Nothing is yours to define.\n//\n",
        (Language::Metal, false) => {
            "// Yours to define, if the words are not in `device` memory: the type of a pointer to them, SRBF_DATA.\n\n"
        }
        (Language::Glsl, false) => {
            "// Yours to define above this text: word i of the material at `data`, from a buffer, a texture or constants.\n//\n//     uint srbf_word(int data, int i);\n\n"
        }
        (Language::Hlsl | Language::Slang, false) => {
            "// Yours to define above this text: word i of the material at `data`, from a buffer, a texture or constants.\n//\n//     uint srbf_word(uint data, int i);\n\n"
        }
        (Language::Wgsl, false) => {
            "// Yours to define: word i of the material at `data`, from a buffer, a texture or constants.\n//\n//     fn srbf_word(data: u32, i: i32) -> u32\n\n"
        }
    };
    made
}

/// Most characters of a name.
const MOST_NAME: usize = 32;

/// Whether names of a text may begin with this one in every language: a letter, then letters, digits and single underscores. GLSL keeps `gl`
/// to itself.
pub fn is_name(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.chars().all(is_of_name)
        && name.len() <= MOST_NAME
        && !name.contains("__")
        && !name.ends_with('_')
        && !name.eq_ignore_ascii_case("gl")
}

/// Gives all names of a text another beginning, so that two texts stand in one program: of `paint` they are `paint_material`,
/// `PaintView`, `PAINT_FN`.
pub fn renamed(text: &str, name: &str) -> String {
    let capital = name[..1].to_ascii_uppercase() + &name[1..];
    let upper = name.to_ascii_uppercase();
    let mut made = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find(|c: char| c.is_ascii_alphabetic() || c == '_') {
        let (before, after) = rest.split_at(at);
        let (word, next) = after.split_at(after.find(|c| !is_of_name(c)).unwrap_or(after.len()));
        made.push_str(before);
        let begins = [("srbf_", name), ("Srbf", &capital), ("SRBF_", &upper)];
        match begins.into_iter().find(|(old, _)| word.starts_with(old) && word.len() > old.len()) {
            Some((old, new)) => {
                made.push_str(new);
                made.push_str(&word[old.trim_end_matches('_').len()..]);
            }
            None => made.push_str(word),
        }
        rest = next;
    }
    made + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_names_begin_anew() {
        let text = "SrbfView srbf_prepare(x.srbf_word); // a .srbf of srbf, my_srbf_x, SRBF_FN 1srbf";
        let expected = "PaintView paint_prepare(x.paint_word); // a .srbf of srbf, my_srbf_x, PAINT_FN 1srbf";
        assert_eq!(renamed(text, "paint"), expected);
        assert_eq!(renamed(text, "srbf"), text);
    }

    #[test]
    fn names_are_those_of_every_language() {
        for name in ["paint", "a1", "Red_2"] {
            assert!(is_name(name), "{name}");
        }
        for name in ["", "1a", "_a", "a_", "a__b", "gl", "a b", "a-b", "\u{e4}", &"a".repeat(33)] {
            assert!(!is_name(name), "{name}");
        }
    }
}
