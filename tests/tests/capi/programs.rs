//! C programs against the C library, as its users compile them.

use crate::material;
use srbf_tests::native::{Language, Link, compilers, library, library_with_planted_panic, root, run_program};
use std::path::Path;

/// Compiles a program with every compiler, linked both ways, and runs it on the test material.
fn run_everywhere(source: &str, expected: &str) {
    run_everywhere_on(&material::file(), source, expected);
}

fn run_everywhere_on(material: &Path, source: &str, expected: &str) {
    for compiler in compilers(Language::C) {
        for link in [Link::Static, Link::Shared] {
            let program = compiler.program(source, library(), link, &[]);
            let output = run_program(&program, &[material.as_os_str()]);
            assert!(output.contains(expected), "{compiler:?} {link:?}: {output}");
        }
    }
}

#[test]
fn a_program_links_and_finds_its_version() {
    run_everywhere("version.c", concat!("srbf ", env!("CARGO_PKG_VERSION")));
}

#[test]
fn normal_use() {
    run_everywhere("normal.c", "normal use: passed");
}

#[test]
fn abusive_use() {
    run_everywhere("abuse.c", "abusive use: passed");
}

#[test]
fn anisotropic_material() {
    run_everywhere_on(&material::anisotropic_file(), "anisotropic.c", "anisotropic: passed");
}

#[test]
fn material_with_factors() {
    run_everywhere_on(&material::factored_file(), "factors.c", "factors: passed");
}

#[test]
fn spectra_of_colours() {
    for file in [material::file(), material::spectral_file(), material::lidar_file()] {
        run_everywhere_on(&file, "spectrum.c", "spectrum: passed");
    }
}

#[test]
fn environments_are_made_and_sampled() {
    run_everywhere("environment.c", "environment: passed");
}

#[test]
fn expanded_material() {
    run_everywhere("expanded.c", "expanded: passed");
}

#[test]
fn sheets_are_asked_on_both_sides() {
    let sheet = root().join("presets/sheets/ground_glass.srbf");
    for compiler in compilers(Language::C) {
        for link in [Link::Static, Link::Shared] {
            let program = compiler.program("sheet.c", library(), link, &[]);
            let output = run_program(&program, &[sheet.as_os_str(), material::file().as_os_str()]);
            assert!(output.contains("sheet: passed"), "{compiler:?} {link:?}: {output}");
        }
    }
}

#[test]
fn every_verb_in_every_shape() {
    run_everywhere("verbs.c", "verbs: passed");
}

#[test]
fn threads_share_a_material() {
    run_everywhere("threads.c", "threads: passed");
}

#[test]
fn threads_share_everything() {
    run_everywhere("shared.c", "shared: passed");
    run_everywhere_on(&material::factored_file(), "shared.c", "shared: passed");
    run_everywhere_on(&material::anisotropic_file(), "shared.c", "shared: passed");
}

#[test]
fn structures_have_the_layout_that_rust_has() {
    run_everywhere("layout.c", "layout: passed");
}

#[test]
fn a_panic_comes_back_as_a_status() {
    for compiler in compilers(Language::C) {
        for link in [Link::Static, Link::Shared] {
            let options = ["-DSRBF_PLANTED_PANIC"];
            let program = compiler.program("panic.c", library_with_planted_panic(), link, &options);
            assert!(run_program(&program, &[]).contains("panic: passed"));
        }
    }
}

#[test]
fn the_example_of_the_documentation_runs() {
    run_everywhere("example.c", "12 lobes at 8 views");
}

#[test]
fn the_cpp_wrapper_works() {
    for compiler in compilers(Language::Cpp) {
        for standard in ["-std=c++17", "-std=c++20", "-std=c++2b"].into_iter().filter(|s| compiler.takes(s)) {
            for link in [Link::Static, Link::Shared] {
                let options = [standard, "-Wconversion", "-Wshadow"];
                let program = compiler.program("wrapper.cpp", library(), link, &options);
                let (material, sheet) = (material::file(), root().join("presets/sheets/ground_glass.srbf"));
                let output = run_program(&program, &[material.as_os_str(), sheet.as_os_str()]);
                assert!(output.contains("wrapper: passed"), "{output}");
            }
        }
    }
}

#[test]
fn both_languages_compile_the_header_with_and_without_an_operating_system() {
    for language in [Language::C, Language::Cpp] {
        for compiler in compilers(language) {
            for options in [&[][..], &["-DSRBF_FREESTANDING", "-ffreestanding"]] {
                let mut command = compiler.strict();
                command.args(options).args(["-fsyntax-only", "-Wshadow", "-Wconversion", "-x"]);
                command.arg(if language == Language::C { "c" } else { "c++" }).arg("include/srbf.h");
                command.current_dir(srbf_tests::native::root());
                srbf_tests::native::run(&mut command);
            }
        }
    }
}

#[test]
fn fits_from_a_table_and_from_a_function() {
    let compiler = &compilers(Language::C)[0];
    let program = compiler.program("fit.c", library(), Link::Static, &[]);
    let output = run_program(&program, &[env!("CARGO_TARGET_TMPDIR").as_ref()]);
    assert!(output.contains("fit: passed"), "{output}");
}
