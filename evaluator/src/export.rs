//! A material with the text that reads it: one file to copy.

use crate::language::Language;
use crate::rewrite::functions;
use crate::usage::{Content, renamed, usage};
use srbf_core::{Material, Quarter, Sheet, printable, printable_lines};
use std::borrow::Cow;
use std::fmt::Write;

/// Words on a line.
const LINE: usize = 8;

/// Most characters of a provenance that an export holds; a fit writes a few hundred.
const MOST_CHARACTERS: usize = 4000;

/// Whether a material can be written out: of format version 2 or 3. The text itself reads plain numbers alone; [`export`] writes a material
/// in codes as such.
pub fn can_read(material: &Material<impl AsRef<[u8]>>) -> bool {
    material.bytes().get(8).is_some_and(|version| *version >= 2)
}

/// The bytes of a material in plain numbers, which the text reads: its own, or those that its codes unpack to.
pub fn plain_bytes(material: &Material<impl AsRef<[u8]>>) -> Cow<'_, [u8]> {
    if material.code_bits().is_none() {
        return material.bytes().into();
    }
    let mut bytes = vec![0; material.unpacked_len()];
    // There is room.
    match material.unpack(&mut bytes) {
        Ok(_) => bytes.into(),
        Err(_) => material.bytes().into(),
    }
}

/// Writes a material and the text that evaluates it: its calls, its provenance, its words as constants, `srbf_data`, and the text.
///
/// In C++, CUDA and Metal `srbf_material(srbf_data)` is the material; elsewhere `srbf_material(0)`, and `srbf_word` is defined.
pub fn export(material: &Material<impl AsRef<[u8]>>, language: Language) -> String {
    export_as(material, language, "srbf")
}

/// As [`export`], with names that begin with another one than `srbf`, as [`renamed`] has them.
pub(crate) fn export_as(material: &Material<impl AsRef<[u8]>>, language: Language, name: &str) -> String {
    written(&plain_bytes(material), material.provenance(), Content::Material, language, name)
}

/// Writes a text with bytes as its constants.
pub(crate) fn written(
    bytes: &[u8],
    provenance: &str,
    content: Content,
    language: Language,
    name: &str,
) -> String {
    let (calls, text) = (usage(language, content, true), functions(language, content));
    let words: Vec<u32> = bytes.chunks(4).map(word).collect();
    let mut list = String::new();
    for line in words.chunks(LINE) {
        let line: Vec<String> = line.iter().map(|word| format!("0x{word:08x}u")).collect();
        // Writing to a string does not fail.
        let _ = writeln!(list, "    {},", line.join(", "));
    }
    let list = list.trim_end().trim_end_matches(',');
    let provenance = comments(provenance);
    let n = words.len();
    let (before, after) = match language {
        Language::Glsl => (
            format!(
                "const uint srbf_data[{n}] = uint[{n}](\n{list}\n);\nuint srbf_word(int data, int i) {{ return srbf_data[data + i]; }}\n\n"
            ),
            String::new(),
        ),
        Language::Hlsl | Language::Slang => (
            format!(
                "static const uint srbf_data[{n}] = {{\n{list}\n}};\nuint srbf_word(uint data, int i) {{ return srbf_data[int(data) + i]; }}\n\n"
            ),
            String::new(),
        ),
        Language::Wgsl => (
            format!(
                "var<private> srbf_data: array<u32, {n}> = array<u32, {n}>(\n{list}\n);\nfn srbf_word(data: u32, i: i32) -> u32 {{ return srbf_data[i32(data) + i]; }}\n\n"
            ),
            String::new(),
        ),
        Language::Metal => (
            "#define SRBF_DATA constant const uint *\n".to_owned(),
            format!("\nconstant uint srbf_data[{n}] = {{\n{list}\n}};\n"),
        ),
        Language::Cpp | Language::Cuda => (
            String::new(),
            format!(
                "\n#ifdef __CUDACC__\n__device__\n#endif\nstatic const uint32_t srbf_data[{n}] = {{\n{list}\n}};\n"
            ),
        ),
    };
    // Precisions of numbers come before the first of them.
    let (head, text) =
        if language == Language::Glsl { text.split_at(language.head().len()) } else { ("", text.as_str()) };
    let before = format!("{head}{before}");
    let [calls, code] = [calls, format!("{before}{text}{after}")].map(|text| renamed(&text, name));
    format!("{calls}{provenance}{code}")
}

/// A text of a stranger, as much of it as an export holds.
fn bounded(text: &str) -> Cow<'_, str> {
    match text.char_indices().nth(MOST_CHARACTERS) {
        Some((end, _)) => format!("{}\n(cut off)", &text[..end]).into(),
        None => text.into(),
    }
}

/// A text of a stranger as lines of comment, its first 4000 characters. In no language does one end before its line, or go on behind it.
pub fn comments(text: &str) -> String {
    let mut made = String::new();
    for line in bounded(text).lines() {
        // LF alone ended lines; `printable` leaves no other end of one.
        let mut line = printable(line.trim_end()).to_string();
        // Ends of comments, where a user's own is round this; and, in C, a backslash or its trigraph takes the end of the line away.
        for (text, by) in [("*/", "*\\u{2f}"), ("/*", "/\\u{2a}"), ("??/", "??\\u{2f}")] {
            line = line.replace(text, by);
        }
        if line.ends_with('\\') {
            line += "u{5c}";
        }
        made += format!("// {line}").trim_end();
        made.push('\n');
    }
    made
}

/// A word, little endian; of the last bytes, as far as they go.
fn word(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |word, byte| word << 8 | u32::from(*byte))
}

/// A material as JSON: the numbers of every view, by name.
///
/// `theta` and `azimuth` in radians; logarithms to the base 2; `color_differences` are `(R - Y) / Y` and `(B - Y) / Y`; of an isotropic
/// lobe `tilt` is the angle of its axis in the plane of incidence and out of it.
pub fn json(material: &Material<impl AsRef<[u8]>>) -> String {
    let numbers = |numbers: &[f32]| {
        let texts: Vec<String> = numbers.iter().map(|n| format!("{n:?}")).collect();
        format!("[{}]", texts.join(", "))
    };
    let lobe = |view: usize, k: usize| {
        let (tilt, sharpness, luminance, differences) = match material.view_lobe(view, k) {
            Some(l) => ([l.angle, l.off_plane], l.log2_sharpness, l.log2_luminance, l.color_differences),
            None => material.view_tilted_lobe(view, k).map_or(([0.0; 2], 0.0, -126.0, [0.0; 2]), |l| {
                (l.tilt, l.log2_sharpness, l.log2_luminance, l.color_differences)
            }),
        };
        format!(
            "        {{\"tilt\": {}, \"log2_sharpness\": {sharpness:?}, \"log2_luminance\": {luminance:?}, \"color_differences\": {}}}",
            numbers(&tilt),
            numbers(&differences)
        )
    };
    let view = |v: usize| {
        let lobes: Vec<String> = (0..material.view_lobe_count()).map(|k| lobe(v, k)).collect();
        let squeeze = match (material.view_log2_squeeze(v), material.view_log2_squeeze_matrix(v)) {
            (Some(one), _) => format!("{one:?}"),
            (_, matrix) => numbers(&matrix.unwrap_or_default()),
        };
        let albedo = material
            .view_albedo_difference(v)
            .map_or(String::new(), |d| format!("\"albedo_difference\": {}, ", numbers(&d)));
        format!(
            "    {{\"theta\": {:?}, \"azimuth\": {:?}, \"log2_squeeze\": {squeeze}, \"log2_diffuse\": {:?}, \"diffuse_color_differences\": {}, {albedo}\"lobes\": [\n{}\n    ]}}",
            material.view_theta(v).unwrap_or_default(),
            material.view_azimuth(v).unwrap_or_default(),
            material.view_log2_diffuse(v).unwrap_or_default(),
            numbers(&material.view_diffuse_color_differences(v).unwrap_or_default()),
            lobes.join(",\n")
        )
    };
    let views: Vec<String> = (0..material.view_count()).map(view).collect();
    let [half, difference, azimuth] = material.factor_nodes().unwrap_or_default();
    let nodes: Vec<String> = (0..azimuth * half * difference)
        .filter_map(|i| material.factor_node(i / difference % half, i % difference, i / difference / half))
        .map(|node| numbers(&node))
        .collect();
    format!(
        "{{\n  \"by\": \"srbf {}\",\n  \"is_isotropic\": {},\n  \"squeezed\": {},\n  \"mirrored\": {},\n  \"provenance\": {},\n  \"factor_nodes\": [{half}, {difference}, {azimuth}],\n  \"has_signed_factors\": {},\n  \"factors\": [{}],\n  \"views\": [\n{}\n  ]\n}}\n",
        // Near its start, where `srbf` looks for the maker of a file.
        env!("CARGO_PKG_VERSION"),
        material.is_isotropic(),
        material.squeezed_count(),
        material.mirrored_count(),
        quoted(&printable_lines(&bounded(material.provenance())).to_string()),
        material.has_signed_factors(),
        nodes.join(", "),
        views.join(",\n")
    )
}

/// A sheet as JSON: its quarters by name.
pub(crate) fn json_of_sheet(sheet: &Sheet<impl AsRef<[u8]>>, names: [&str; 4]) -> String {
    let shares = [1.0, -1.0].map(|side| {
        let share = |n: u8| {
            let height = f32::from(n) / 15.0;
            format!("{:?}", sheet.reflected_share([(1.0 - height * height).sqrt(), 0.0, side * height]))
        };
        (0..16).map(share).collect::<Vec<_>>().join(", ")
    });
    let quarters = Quarter::ALL.map(|quarter| {
        let own = sheet.quarter(quarter).map_or_else(|| "null".to_owned(), |material| json(&material));
        format!("  \"{}\": {}", names[quarter as usize], own.trim_end())
    });
    format!(
        "{{\n  \"by\": \"srbf {}\",\n  \"is_symmetric\": {},\n  \"provenance\": {},\n  \"reflected_shares\": [[{}], [{}]],\n{}\n}}\n",
        env!("CARGO_PKG_VERSION"),
        sheet.is_symmetric(),
        quoted(&printable_lines(&bounded(sheet.provenance())).to_string()),
        shares[0],
        shares[1],
        quarters.join(",\n")
    )
}

/// A text as JSON has it. A page may hold it too: no mark of HTML stands in it.
fn quoted(text: &str) -> String {
    let mut made = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => made.extend(['\\', c]),
            c if u32::from(c) < 32 || c == '<' => {
                let _ = write!(made, "\\u{:04x}", u32::from(c));
            }
            c => made.push(c),
        }
    }
    made + "\""
}
