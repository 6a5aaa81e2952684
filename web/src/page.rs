//! The files of the page. No file is fetched by a script, so that the page works from a folder too, without a server.

use crate::open::{Opened, open};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};
use srbf_evaluator::{Content, Language, functions, usage};

/// A material that the page has.
pub struct Preset<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its `.srbf` bytes.
    pub bytes: &'a [u8],
}

/// The triangles of the teapot.
pub struct Teapot<'a> {
    /// Places of the vertices.
    pub positions: &'a [[f32; 3]],
    /// Unit normals, one a vertex.
    pub normals: &'a [[f32; 3]],
    /// Vertices of the triangles.
    pub triangles: &'a [[u32; 3]],
}

/// The scripts, each after those that it imports.
const SCRIPTS: [&str; 9] = [
    include_str!("../page/words.js"),
    include_str!("../page/radiance.js"),
    include_str!("../page/exr.js"),
    include_str!("../page/tree.js"),
    include_str!("../page/tracer.js"),
    include_str!("../page/plot.js"),
    include_str!("../page/opener.js"),
    include_str!("../page/palette.js"),
    include_str!("../page/page.js"),
];

/// The files of the page by name, without the fitter: that is `fitter.js`, see [`fitter_script`].
///
/// `opened`: a material that the page begins with.
///
/// # Errors
/// In words, for bytes of a preset that are no material.
pub fn files(
    presets: &[Preset<'_>],
    teapot: &Teapot<'_>,
    opened: Option<&Opened>,
) -> Result<Vec<(&'static str, Vec<u8>)>, String> {
    let mut script = String::from("\"use strict\";\n(() => {\n");
    SCRIPTS.iter().for_each(|text| script.push_str(&bundled(text)));
    script.push_str("})();\n");
    Ok(vec![
        ("index.html", include_bytes!("../page/index.html").to_vec()),
        ("style.css", include_bytes!("../page/style.css").to_vec()),
        ("data.js", data(presets, teapot, opened)?.into_bytes()),
        ("page.js", script.into_bytes()),
    ])
}

/// The page as one file, with a material that it begins with, and without the fitter.
///
/// # Errors
/// As [`files`].
pub fn one_file(presets: &[Preset<'_>], teapot: &Teapot<'_>, opened: &Opened) -> Result<String, String> {
    let mut page = String::new();
    for (name, bytes) in files(presets, teapot, Some(opened))? {
        let text = String::from_utf8_lossy(&bytes);
        let (tag, held) = match name {
            "style.css" => (STYLE, format!("<style>\n{text}</style>")),
            "data.js" => (DATA, format!("<script>\n{text}</script>")),
            "page.js" => (SCRIPT, format!("<script>\n{text}</script>")),
            _ => {
                page = text.replace(FITTER, "");
                continue;
            }
        };
        page = page.replacen(tag, &held, 1);
    }
    Ok(page)
}

/// The elements by which the page names its other files.
const STYLE: &str = "<link rel=\"stylesheet\" href=\"style.css\">";
const DATA: &str = "<script src=\"data.js\"></script>";
const FITTER: &str = "<script src=\"fitter.js\"></script>\n";
const SCRIPT: &str = "<script src=\"page.js\"></script>";

/// The module of the fitter for WebAssembly as a script.
pub fn fitter_script(module: &[u8]) -> Vec<u8> {
    format!("self.srbfFitter = \"{}\";\n", BASE64_STANDARD.encode(module)).into_bytes()
}

/// A module of a script without its imports, and with its exports as plain definitions: all are put together.
fn bundled(text: &str) -> String {
    let lines = text.lines().filter(|line| !line.starts_with("import "));
    lines.map(|line| format!("{}\n", line.strip_prefix("export ").unwrap_or(line))).collect()
}

/// The material, the text of the evaluator and the teapot, as a script.
fn data(presets: &[Preset<'_>], teapot: &Teapot<'_>, opened: Option<&Opened>) -> Result<String, String> {
    let floats = |rows: &[[f32; 3]]| -> String {
        BASE64_STANDARD.encode(rows.iter().flatten().flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>())
    };
    let indices: Vec<u8> = teapot.triangles.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    let material = |of: &Opened| json!({"bytes": BASE64_STANDARD.encode(&of.bytes), "json": of.json});
    let preset = |preset: &Preset<'_>| open(&format!("{}.srbf", preset.name), preset.bytes, |_| {});
    let presets: Vec<Opened> = presets.iter().map(preset).collect::<Result<_, _>>()?;
    let presets: Vec<Value> = presets.iter().map(material).collect();
    let evaluator = functions(Language::Glsl, Content::Material);
    // Text that a shader of a sheet has behind it.
    let sheet = functions(Language::Glsl, Content::Sheet).split_off(evaluator.len());
    let calls = [Content::Material, Content::Sheet].map(|content| usage(Language::Glsl, content, true));
    let data = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "presets": presets,
        "evaluator": evaluator,
        "sheet": sheet,
        "calls": calls,
        "teapot": {
            "positions": floats(teapot.positions),
            "normals": floats(teapot.normals),
            "triangles": BASE64_STANDARD.encode(indices),
        },
        "opened": opened.map(material),
    });
    // A name of a file stands in the JSON: its text may not end the script's element, where a page has it inside.
    Ok(format!("self.srbfData = {};\n", data.to_string().replace('<', "\\u003c")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scripts_are_put_together_without_imports() {
        let text = "import { a } from \"./a.js\";\nexport function b() {\n    return a; // import of a\n}\n";
        assert_eq!(bundled(text), "function b() {\n    return a; // import of a\n}\n");
        for text in SCRIPTS {
            assert!(
                bundled(text).lines().all(|line| !line.starts_with("import") && !line.starts_with("export"))
            );
        }
    }

    #[test]
    fn no_two_scripts_define_one_name() {
        let mut names = std::collections::BTreeSet::new();
        for line in SCRIPTS.iter().flat_map(|text| text.lines()) {
            let line = line.strip_prefix("export ").unwrap_or(line);
            let line = line.strip_prefix("async ").unwrap_or(line);
            let kinds = ["const ", "let ", "function ", "class "];
            let Some(rest) = kinds.iter().find_map(|kind| line.strip_prefix(kind)) else { continue };
            let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
            // Shaders within a script have names of their own.
            if !["float", "int", "vec2", "vec3"].contains(&&rest[..end]) {
                assert!(names.insert(&rest[..end]), "{} is defined twice", &rest[..end]);
            }
        }
        assert!(names.len() > 40, "{names:?}");
    }

    #[test]
    fn one_file_names_no_other() {
        let teapot = Teapot { positions: &[], normals: &[], triangles: &[] };
        let opened =
            Opened { bytes: Vec::new(), json: json!({"name": "a <script src=\"page.js\"></script>"}) };
        let page = one_file(&[], &teapot, &opened).unwrap();
        assert!(!page.contains(" src=\"") && !page.contains("stylesheet"), "{page}");
        assert_eq!((page.matches("<style>").count(), page.matches("<script>").count()), (1, 2));
        assert_eq!(page.matches("</script>").count(), 2);
        assert!(
            page.contains("--accent: #a3142e")
                && page.contains("self.srbfData = {")
                && page.contains("begin();")
        );
    }

    #[test]
    fn texts_of_others_do_not_end_the_script() {
        let teapot = Teapot { positions: &[], normals: &[], triangles: &[] };
        let opened = Opened { bytes: Vec::new(), json: json!({"name": "</script><b>"}) };
        let files = files(&[], &teapot, Some(&opened)).unwrap();
        let data = files.iter().find(|file| file.0 == "data.js").unwrap();
        assert!(!data.1.contains(&b'<'), "{}", String::from_utf8_lossy(&data.1));
    }
}
