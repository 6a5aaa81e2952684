//! Generates `include/srbf.h` from the source of the C interface.
//!
//! `cargo run --release -p srbf-tests --bin header` writes it; with `--check` it compares instead.

use srbf_tests::native::root;
use std::process::ExitCode;

/// The files of `capi/src` that export something, in the order in which the header shows them.
const SOURCES: &[&str] = &[
    "version",
    "status",
    "planted",
    "message",
    "simd",
    "lobe",
    "product",
    "storage",
    "mixture",
    "material",
    "factors",
    "spectrum",
    "heap",
    "streams",
    "single",
    "hit",
    "defensive",
    "expanded",
    "request",
    "ask",
    "sheet",
    "blend",
    "environment",
    "reflect",
    "light",
    "fit",
];

fn main() -> ExitCode {
    let path = root().join("include/srbf.h");
    let generated = generate();
    if std::env::args().nth(1).as_deref() != Some("--check") {
        std::fs::write(&path, generated).expect("include/srbf.h can be written");
        println!("wrote {}", path.display());
        return ExitCode::SUCCESS;
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    if committed == generated {
        return ExitCode::SUCCESS;
    }
    let same = committed.lines().zip(generated.lines()).take_while(|(old, new)| old == new).count();
    eprintln!(
        "include/srbf.h is stale from line {} on: run `cargo run --release -p srbf-tests --bin header`",
        same + 1
    );
    ExitCode::FAILURE
}

fn generate() -> String {
    let capi = root().join("capi");
    let mut config =
        cbindgen::Config::from_file(capi.join("cbindgen.toml")).expect("capi/cbindgen.toml is valid");
    let header = std::fs::read_to_string(capi.join("header.txt")).expect("capi/header.txt is there");
    config.header = Some(header.trim_end().to_owned());
    let mut builder = cbindgen::Builder::new().with_config(config);
    for source in SOURCES {
        builder = builder.with_src(capi.join(format!("src/{source}.rs")));
    }
    let mut bytes = Vec::new();
    builder.generate().expect("the C interface parses").write(&mut bytes);
    String::from_utf8(bytes).expect("the header is UTF-8")
}
