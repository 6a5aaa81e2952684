//! Generates `include/srbf.h` from the source of the C interface.

use crate::native::root;
use std::path::PathBuf;

/// Where the generated header is kept.
pub fn path() -> PathBuf {
    root().join("include/srbf.h")
}

/// The files of `capi/src` that export something, in the order in which the header shows them.
pub const SOURCES: [&str; 3] = ["version", "status", "message"];

/// Generates the header.
///
/// # Panics
/// If the source of the C interface does not parse.
pub fn generate() -> String {
    let capi = root().join("capi");
    let mut config =
        cbindgen::Config::from_file(capi.join("cbindgen.toml")).expect("capi/cbindgen.toml is valid");
    config.header = Some(include_str!("../../capi/header.txt").trim_end().to_owned());
    let mut builder = cbindgen::Builder::new().with_config(config);
    for source in SOURCES {
        builder = builder.with_src(capi.join(format!("src/{source}.rs")));
    }
    let mut bytes = Vec::new();
    builder.generate().expect("the C interface parses").write(&mut bytes);
    String::from_utf8(bytes).expect("the header is UTF-8")
}
