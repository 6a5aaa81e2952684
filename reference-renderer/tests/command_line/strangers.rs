//! Text of strangers, in files, names and arguments, reaches neither terminal nor page unchanged.

use crate::{folder, rows, srbf};

/// An escape sequence, a mark that turns the following text, and a line that looks like one of the program's.
const NAME: &str = "a\u{1b}[31m\u{202e}\nforged: all is well\u{7}";

/// Characters that a terminal obeys or that are not seen.
fn is_hidden(c: char) -> bool {
    c.is_control() && c != '\n'
        || matches!(c, '\u{200e}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Nothing hidden, and no line that a stranger has written.
fn check(text: &str, of: &str) {
    assert!(!text.chars().any(is_hidden), "{of}: {text:?}");
    assert!(!text.lines().any(|line| line.trim_start().starts_with("forged")), "{of}: {text}");
}

/// A material whose provenance is a stranger's, with the checksum that fits.
fn material(provenance: &str) -> Vec<u8> {
    use srbf_core::{Line, PlaneLobe, View};
    let grey = [0.0; 2];
    let lobe = PlaneLobe {
        angle: 0.0,
        off_plane: 0.0,
        log2_sharpness: 4.0,
        log2_luminance: -1.0,
        color_differences: grey,
    };
    let view = View {
        theta: 0.0,
        log2_squeeze: 0.0,
        log2_diffuse: -3.0,
        diffuse_color_differences: grey,
        lobes: &[lobe],
    };
    let line = Line { views: &[view], squeezed: 0, mirrored: 0, factors: None };
    let mut bytes = vec![0; line.encoded_len(provenance)];
    line.encode(provenance, &mut bytes).unwrap();
    bytes
}

#[test]
fn no_text_of_a_stranger_passes_as_it_is() {
    let place = folder("strangers");
    let name = |ending: &str| format!("{NAME}.{ending}");
    std::fs::write(place.join(name("srbf")), material(NAME)).unwrap();
    std::fs::write(place.join(name("csv")), rows()).unwrap();
    std::fs::write(place.join("word.csv"), format!("theta_i,phi_i,theta_o,phi_o,value\n1,0,2,0,{NAME}\n"))
        .unwrap();
    std::fs::write(
        place.join("column.csv"),
        format!("theta_i,phi_i,theta_o,{}\n1,2\n", NAME.replace('\n', "")),
    )
    .unwrap();
    for ending in ["brdf", "astm", "binary", "bsdf", "hdr", "exr", "obj", "ply", "xyz", "json"] {
        std::fs::write(place.join(name(ending)), NAME).unwrap();
    }
    let [srbf_file, csv, hdr, obj, missing, out] = ["srbf", "csv", "hdr", "obj", "missing", "exr"].map(&name);
    let (out, model) = (format!("new-{out}"), format!("model:lambert:{NAME}=1"));
    let small = ["--size", "4x4", "--spp", "1"];
    let mut calls: Vec<Vec<&str>> = vec![
        vec![NAME],
        vec!["inspect", &srbf_file],
        vec!["inspect", "--lobes", &srbf_file],
        vec!["inspect", NAME],
        vec!["judge", &srbf_file, "--against", NAME],
        vec!["judge", &srbf_file, "--against", "model:lambert:albedo=0.5"],
        vec!["plot", &srbf_file, "--html", "-o", "plot.png"],
        vec!["plot", &srbf_file, "--env", &hdr],
        vec!["ball", &srbf_file, "--env", NAME],
        vec!["convert", &csv, "-o", "converted.csv"],
        vec!["convert", &csv, "-o", NAME],
        vec!["fit", "word.csv", "column.csv"],
        vec!["fit", &model, "-o", "m.srbf"],
        vec!["compare", "--materials", NAME],
        vec!["compare", "--env", NAME],
        vec!["completions", NAME],
        [&["render", "--material", &srbf_file, "-o", &out][..], &small].concat(),
        [&["render", "--material", NAME][..], &small].concat(),
        [&["render", "--env", &hdr][..], &small].concat(),
        [&["render", "--scene", "teapot", "--mesh", &obj][..], &small].concat(),
        [&["render", "--scene", NAME][..], &small].concat(),
        [&["render", "--sampler", NAME][..], &small].concat(),
        vec!["fit", &missing, "-o", NAME],
    ];
    let files: Vec<String> = ["brdf", "astm", "binary", "bsdf", "xyz"].map(name).to_vec();
    for file in &files {
        calls.push(vec!["fit", file, "-o", "x.srbf"]);
        calls.push(vec!["convert", file, "-o", "x.csv"]);
    }
    for call in &calls {
        let output = srbf(&place, call);
        let [out, error] =
            [&output.stdout, &output.stderr].map(|text| String::from_utf8(text.clone()).unwrap());
        check(&out, &format!("{call:?}"));
        check(&error, &format!("{call:?}"));
        assert!(matches!(output.status.code(), Some(0 | 2)), "{call:?}: {error}");
    }
    let html = std::fs::read_to_string(place.join("plot.html")).unwrap();
    assert!(!html.chars().any(is_hidden), "a page");
}

#[test]
fn a_report_holds_no_text_of_a_stranger_as_it_is() {
    let place = folder("strangers-report");
    let csv = format!("{NAME}.csv");
    std::fs::write(place.join(&csv), rows()).unwrap();
    let output = srbf(&place, &["fit", &csv, "--lobes", "1", "--no-picture", "-o", "a.srbf"]);
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{error}");
    check(&error, "standard error");
    check(&String::from_utf8(output.stdout).unwrap(), "standard output");
    let json = std::fs::read_to_string(place.join("a.json")).unwrap();
    assert!(json.contains("\\\\u{1b}[31m\\\\u{202e}\\\\u{a}forged"), "{json}");
    check(&json, "the report");
    let bytes = std::fs::read(place.join("a.srbf")).unwrap();
    assert!(!bytes.windows(2).any(|pair| pair == b"\x1b["), "the material holds the name as it was");
}
