//! C and C++ programs against the C library, as its users compile them.

use srbf_tests::native::{Language, Link, compilers, library, run_program};

#[test]
fn a_program_links_and_finds_its_version() {
    for compiler in compilers(Language::C) {
        for link in [Link::Static, Link::Shared] {
            let program = compiler.program("version.c", library(), link, &[]);
            assert!(run_program(&program, &[]).starts_with(concat!("srbf ", env!("CARGO_PKG_VERSION"))));
        }
    }
}
