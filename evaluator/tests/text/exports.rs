//! Exports of materials whose provenance a stranger wrote to leave its comment: as text, and as C++. `.ci/checks/56-evaluator` compiles them as
//! shaders, from `target/tmp/strangers`.

use crate::driver::compiler;
use srbf_core::{Line, Material, PlaneLobe, View, printable_lines};
use srbf_evaluator::{Content, Language, Surface, export, functions, json};
use std::path::Path;

/// What ends a line somewhere.
const ENDS: [char; 7] = ['\n', '\r', '\u{b}', '\u{c}', '\u{85}', '\u{2028}', '\u{2029}'];

/// Texts by a name; wherever one is code, it stops the compiler.
fn texts() -> Vec<(String, String)> {
    let mut texts: Vec<(String, String)> = (ENDS.iter())
        .map(|end| {
            (format!("end-{:x}", u32::from(*end)), format!("a{end}#error evil\n{end}#error evil{end}"))
        })
        .collect();
    texts.extend(
        [
            ("none", ""),
            ("both", "a\r\n#error evil\r\n"),
            ("backslash", "evil \\"),
            ("backslashes", "evil \\\\ \t\n\\\n\\ \u{a0}"),
            ("trigraph", "evil ??/"),
            ("trigraph-after", "evil\n??/\n??/ "),
            ("close", "*/ #error evil /*"),
            ("close-overlapping", "/*/ evil */*"),
            ("escape", "\u{1b}[2J\u{1b}]0;evil\u{7}"),
            ("nul", "a\0evil"),
            ("direction", "a\u{202e}evil\u{202c}\u{2066}\u{200b}"),
            ("json", "\", \"evil\": \"\\"),
            ("html", "</script><script>alert('evil')</script>"),
            ("words", "gr\u{fc}n, \u{7eff} evil"),
        ]
        .map(|(name, text)| (name.to_owned(), text.to_owned())),
    );
    texts.push(("long".to_owned(), "evil \u{2028}\n".repeat(200_000)));
    texts
}

/// A material of one lobe.
fn material(provenance: &str) -> Vec<u8> {
    let lobe = PlaneLobe {
        angle: 0.0,
        off_plane: 0.0,
        log2_sharpness: 3.0,
        log2_luminance: -2.0,
        color_differences: [0.0; 2],
    };
    let views = [View {
        theta: 0.0,
        log2_squeeze: 0.0,
        log2_diffuse: -3.0,
        diffuse_color_differences: [0.0; 2],
        lobes: &[lobe],
    }];
    let line = Line { views: &views, squeezed: 0, mirrored: 0, factors: None };
    let mut bytes = vec![0; line.encoded_len(provenance)];
    line.encode(provenance, &mut bytes).expect("the material is valid");
    bytes
}

#[test]
fn no_text_of_a_stranger_leaves_its_comment() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("strangers");
    std::fs::create_dir_all(&folder).expect("the target folder can be written");
    for (name, provenance) in texts() {
        let bytes = material(&provenance);
        // The words of a large file take a compiler minutes.
        if name != "long" {
            std::fs::write(folder.join(format!("{name}.srbf")), &bytes)
                .expect("the target folder can be written");
        }
        let material = Material::from_bytes(bytes).expect("a material");
        for language in Language::ALL {
            let place = format!("{name}, {language:?}");
            let written = export(&material, language);
            let text = functions(language, Content::Material);
            let text = &text[text.find("// A material, evaluated").expect("its first comment")..];
            let (before, after) = written.split_once(text).expect("the text itself is there");
            let comments: Vec<&str> = before.split(ENDS).take_while(|line| line.starts_with("//")).collect();
            assert_eq!(comments.join("\n").contains("evil"), provenance.contains("evil"), "{place}");
            assert!(comments.join("\n").len() < 40_000, "{place}: too long");
            for line in comments {
                assert!(!["*/", "/*", "??/"].iter().any(|end| line.contains(end)), "{place}: {line}");
                assert!(!line.ends_with('\\') && line == line.trim_end(), "{place}: {line}");
            }
            let others = before.split(ENDS).skip_while(|line| line.starts_with("//"));
            assert!(others.chain([after]).all(|line| !line.contains("evil")), "{place}");
            assert!(printable_lines(&written).to_string() == written, "{place}: hidden characters");
        }
        let written = json(&material);
        assert!(written.len() < 20_000 && !written.contains('<'), "{name}: {} bytes", written.len());
        assert!(printable_lines(&written).to_string() == written, "{name}: hidden characters");
        let line = written.lines().find(|line| line.contains("\"provenance\"")).expect("a line of its own");
        // Quotes and backslashes in pairs, and no more strings than two.
        let plain = line.replace("\\\\", "").replace("\\\"", "");
        assert_eq!(plain.matches('"').count(), 4, "{name}: {line}");
    }
}

/// The calls of the comment that an export begins with.
fn calls(export: &str) -> Vec<&str> {
    let comment = export.lines().take_while(|line| line.starts_with("//"));
    comment.filter_map(|line| line.strip_prefix("//     ")).collect()
}

#[test]
fn two_exports_are_called_in_one_program_as_they_say() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("calls");
    std::fs::create_dir_all(&folder).expect("the target folder can be written");
    let bytes = material("a comment of srbf_data");
    let (glass, paint) =
        (std::fs::read(crate::driver::root().join("presets/sheets/ground_glass.srbf")), &bytes);
    let glass = Surface::from_bytes(glass.expect("a preset")).expect("a sheet");
    let paint = Surface::from_bytes(paint.clone()).expect("a material");
    for language in [Language::Cpp, Language::Metal] {
        let vector = if language == Language::Cpp { "NAME_device::vec3" } else { "float3" };
        let mut program = String::new();
        for (surface, name) in [(&paint, "paint"), (&glass, "glass"), (&paint, "srbf")] {
            let text = surface.export_as(language, name);
            assert!(
                name == "srbf"
                    || text.matches("srbf_").count() == text.matches("a comment of srbf_data").count()
            );
            assert!(calls(&text).len() == 5, "{text}");
            let path = folder.join(format!("{name}.{}", language.ending()));
            std::fs::write(&path, &text).expect("the target folder can be written");
            let given =
                format!("{vector} wo, {vector} wi, float u0, float u1, float u2").replace("NAME", name);
            program += &format!(
                "#include \"{}\"\nfloat use_{name}({given}) {{\n{}\nreturn light.pdf + drawn.pdf + albedo.x; }}\n",
                path.display(),
                calls(&text).join("\n")
            );
        }
        let source = folder.join(format!("program.{}", language.ending()));
        std::fs::write(&source, program).expect("the target folder can be written");
        let status = compiler(language).args(["-fsyntax-only", "-x", "c++"]).arg(&source).status();
        assert!(status.expect("g++ is installed").success(), "{} does not compile", source.display());
    }
}

#[test]
fn exports_of_strangers_are_cpp() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("exports");
    std::fs::create_dir_all(&folder).expect("the target folder can be written");
    for language in [Language::Cpp, Language::Metal] {
        for (name, provenance) in texts().into_iter().filter(|(name, _)| name != "long") {
            let material = Material::from_bytes(material(&provenance)).expect("a material");
            let source = folder.join(format!("{name}.{}", language.ending()));
            std::fs::write(&source, export(&material, language)).expect("the target folder can be written");
            let mut compiler = compiler(language);
            compiler
                .args(["-trigraphs", "-fsyntax-only", "-Wno-unused-variable", "-x", "c++", "-include"])
                .arg(&source)
                .arg("-");
            let child = compiler.stdin(std::process::Stdio::null()).status().expect("g++ is installed");
            assert!(child.success(), "{} does not compile", source.display());
        }
    }
}
