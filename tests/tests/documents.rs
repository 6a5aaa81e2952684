//! The examples of the guides, copied from there, compiled and run.
//!
//! A block of Rust is the body of a function that returns a `Result`. A block of C or C++ that has a `main` is a program; any other is
//! the body of one, after the lines that `docs/integrate.md` states.

use srbf_tests::documents::{CodeBlock, DOCUMENTS, blocks};
use srbf_tests::native::{Language, Link, compilers, library, root, run_program};

include!(concat!(env!("OUT_DIR"), "/documents.rs"));

fn text(document: &str) -> String {
    std::fs::read_to_string(root().join(document)).unwrap()
}

#[test]
fn blocks_of_rust_run() {
    // The blocks name files as from the root of the repository; this is the only test here that minds.
    std::env::set_current_dir(root()).unwrap();
    for (document, line, run) in EXAMPLES {
        run().unwrap_or_else(|error| panic!("{document}, line {line}: {error}"));
    }
    let documents = ["docs/use-from-rust.md", "docs/integrate.md"];
    assert!(documents.iter().all(|d| EXAMPLES.iter().any(|e| e.0 == *d)));
}

/// The whole program that a block stands for.
fn program(block: &CodeBlock, language: Language) -> String {
    let CodeBlock { line, code } = block;
    if code.contains("int main(") {
        return code.clone();
    }
    let prelude = match language {
        Language::C => {
            "#include <srbf.h>\n#include <stdio.h>\n#include <stdlib.h>\n\
             static int fail(const char *text) { fprintf(stderr, \"%s\\n\", text); return 1; }\n\
             int main(void) {\n    (void)fail;"
        }
        Language::Cpp => {
            "#include <srbf.hpp>\n#include <cstdio>\n#include <vector>\n\
             static int fail(const char *text) { std::fprintf(stderr, \"%s\\n\", text); return 1; }\n\
             int main() {\n    (void)fail;"
        }
    };
    format!("{prelude}\n#line {line}\n{code}\n    return 0;\n}}\n")
}

fn run_blocks(language: Language, name: &str, ending: &str) {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("documents");
    std::fs::create_dir_all(&folder).unwrap();
    let mut count = 0;
    for document in DOCUMENTS {
        for block in blocks(&text(document), name) {
            let file = format!("{}-{}.{ending}", document.replace(['/', '.'], "-"), block.line);
            let source = folder.join(&file);
            std::fs::write(&source, program(&block, language)).unwrap();
            let compiler = &compilers(language)[0];
            // An absolute path takes the place of the folder of the C programs.
            let options = ["-Wno-unused-variable", "-Wno-unused-but-set-variable"];
            let built = compiler.program(source.to_str().unwrap(), library(), Link::Static, &options);
            run_program(&built, &[]);
            count += 1;
        }
    }
    assert!(count >= 3, "{count} blocks of {name}");
}

#[test]
fn blocks_of_c_run() {
    run_blocks(Language::C, "c", "c");
}

#[test]
fn blocks_of_cpp_run() {
    run_blocks(Language::Cpp, "cpp", "cpp");
}

#[test]
fn blocks_are_found_by_their_language() {
    let found = blocks("a\n```c\nx;\ny;\n```\n```cpp\nz;\n```\n", "c");
    assert_eq!((found.len(), found[0].line, found[0].code.as_str()), (1, 3, "x;\ny;"));
}
