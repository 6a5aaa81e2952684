//! C programs against the C library, as its users compile them.

use crate::material;
use srbf_tests::native::{
    Compiler, Language, Link, compilers, library, library_with_planted_panic, root, run_program,
};
use std::path::Path;

/// How programs are compiled: the first compiler links statically and the last with the shared library; a single one does both. Links take most of the
/// time of these tests, so that `normal.c` alone is linked in every way by every compiler.
fn ways(language: Language) -> [(Compiler, Link); 2] {
    let compilers = compilers(language);
    let ends = [compilers.first(), compilers.last()].map(|c| c.expect("a compiler").clone());
    let [first, last] = ends;
    [(first, Link::Static), (last, Link::Shared)]
}

/// Compiles a program in two ways, and runs it with each list of arguments.
fn run_with(source: &str, runs: &[&[&Path]], expected: &str) {
    for (compiler, link) in ways(Language::C) {
        let program = compiler.program(source, library(), link, &[]);
        for arguments in runs {
            let arguments: Vec<_> = arguments.iter().map(|path| path.as_os_str()).collect();
            let output = run_program(&program, &arguments);
            assert!(output.contains(expected), "{compiler:?} {link:?}: {output}");
        }
    }
}

/// The same on the test material.
fn run_everywhere(source: &str, expected: &str) {
    run_with(source, &[&[&material::file()]], expected);
}

#[test]
fn a_program_links_and_finds_its_version() {
    run_everywhere("version.c", concat!("srbf ", env!("CARGO_PKG_VERSION")));
}

#[test]
fn normal_use() {
    for compiler in compilers(Language::C) {
        for link in [Link::Static, Link::Shared] {
            let program = compiler.program("normal.c", library(), link, &[]);
            let output = run_program(&program, &[material::file().as_os_str()]);
            assert!(output.contains("normal use: passed"), "{compiler:?} {link:?}: {output}");
        }
    }
}

#[test]
fn abusive_use() {
    run_everywhere("abuse.c", "abusive use: passed");
}

#[test]
fn anisotropic_material() {
    let [plain, in_codes] = [material::anisotropic_file(), material::packed_anisotropic_file()];
    run_with("anisotropic.c", &[&[&plain], &[&in_codes]], "anisotropic: passed");
}

#[test]
fn material_with_factors() {
    run_with("factors.c", &[&[&material::factored_file()]], "factors: passed");
}

#[test]
fn spectra_of_colours() {
    let [colours, spectra, lidar] = [material::file(), material::spectral_file(), material::lidar_file()];
    run_with("spectrum.c", &[&[&colours], &[&spectra], &[&lidar]], "spectrum: passed");
}

#[test]
fn environments_are_made_and_sampled() {
    run_everywhere("environment.c", "environment: passed");
}

#[test]
fn light_of_any_kind() {
    run_everywhere("light.c", "light: passed");
}

#[test]
fn expanded_material() {
    run_everywhere("expanded.c", "expanded: passed");
}

#[test]
fn sheets_are_asked_on_both_sides() {
    let sheet = root().join("presets/sheets/ground_glass.srbf");
    run_with("sheet.c", &[&[&sheet, &material::file()]], "sheet: passed");
}

#[test]
fn blends_are_refused_and_asked() {
    let other = root().join("presets/cayman.srbf");
    run_with("blend.c", &[&[&material::file(), &other]], "blend: passed");
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
    let [plain, factored] = [material::file(), material::factored_file()];
    let [turned, in_codes] = [material::anisotropic_file(), material::packed_anisotropic_file()];
    run_with("shared.c", &[&[&plain], &[&factored], &[&turned], &[&in_codes]], "shared: passed");
}

#[test]
fn structures_have_the_layout_that_rust_has() {
    run_everywhere("layout.c", "layout: passed");
}

#[test]
fn a_panic_comes_back_as_a_status() {
    for (compiler, link) in ways(Language::C) {
        let program =
            compiler.program("panic.c", library_with_planted_panic(), link, &["-DSRBF_PLANTED_PANIC"]);
        assert!(run_program(&program, &[]).contains("panic: passed"));
    }
}

#[test]
fn the_example_of_the_documentation_runs() {
    run_everywhere("example.c", "12 lobes at 8 views");
}

#[test]
fn the_cpp_wrapper_works() {
    for (compiler, link) in ways(Language::Cpp) {
        for standard in ["-std=c++17", "-std=c++20", "-std=c++2b"].into_iter().filter(|s| compiler.takes(s)) {
            let options = [standard, "-Wconversion", "-Wshadow"];
            let program = compiler.program("wrapper.cpp", library(), link, &options);
            let (material, sheet) = (material::file(), root().join("presets/sheets/ground_glass.srbf"));
            let output = run_program(&program, &[material.as_os_str(), sheet.as_os_str()]);
            assert!(output.contains("wrapper: passed"), "{output}");
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
