//! Takes the Rust blocks of the documentation, each as a function of the test `documents`: cargo compiles them with it.

use std::fmt::Write;
use std::path::PathBuf;

include!("src/documents.rs");

fn main() {
    let root = PathBuf::from(std::env::var("CARGO_MANIFEST_DIR").expect("cargo sets it")).join("..");
    let mut source = String::new();
    let mut names = String::new();
    for document in DOCUMENTS {
        let path = root.join(document);
        println!("cargo::rerun-if-changed={}", path.display());
        let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{document}: {error}"));
        for block in blocks(&text, "rust") {
            let name =
                format!("line_{}_of_{}", block.line, document.replace(['/', '.', '-'], "_").to_lowercase());
            let _ = writeln!(
                source,
                "fn {name}() -> Result<(), Box<dyn std::error::Error>> {{\n{}\nOk(())\n}}",
                block.code
            );
            let _ = write!(names, "({document:?}, {}, {name}), ", block.line);
        }
    }
    let _ = writeln!(
        source,
        "type Example = (&'static str, usize, fn() -> Result<(), Box<dyn std::error::Error>>);"
    );
    let _ = writeln!(source, "const EXAMPLES: &[Example] = &[{names}];");
    let out = PathBuf::from(std::env::var("OUT_DIR").expect("cargo sets it"));
    std::fs::write(out.join("documents.rs"), source).expect("the folder of the build can be written");
}
