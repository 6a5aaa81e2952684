//! Exports of the shared library are declared, documented and tested, and nothing else is.

use srbf_tests::native::{library, root, run};
use std::collections::BTreeSet;
use std::process::Command;

/// The functions that the shared library exports.
fn exported() -> BTreeSet<String> {
    let mut nm = Command::new("nm");
    nm.args(["--dynamic", "--defined-only", "--format=posix"]).arg(library().join("libsrbf_fit.so"));
    run(&mut nm).lines().filter_map(|line| line.split(' ').next()).map(str::to_owned).collect()
}

/// The functions that the header declares, each with whether its comment stands right before it.
fn declared(header: &str) -> Vec<(String, bool)> {
    let mut functions = Vec::new();
    let (mut in_comment, mut documented) = (false, false);
    for line in header.lines() {
        let trimmed = line.trim_start();
        if trimmed.starts_with("///") {
            documented = true;
            continue;
        }
        if trimmed.starts_with("/*") || in_comment {
            in_comment = !trimmed.ends_with("*/");
            documented = !in_comment;
            continue;
        }
        // A declaration starts in the first column with its type; further lines of it are indented.
        let name = line.split_once('(').and_then(|(before, _)| before.rsplit([' ', '*']).next());
        if let Some(name) = name.filter(|name| name.starts_with("srbf_") && !line.starts_with([' ', '#'])) {
            functions.push((name.to_owned(), documented));
        }
        documented = false;
    }
    functions
}

#[test]
fn are_declared_documented_and_tested() {
    let header = std::fs::read_to_string(root().join("include/srbf.h")).expect("the header is there");
    let declared = declared(&header);
    let mut names: BTreeSet<String> = declared.iter().map(|(name, _)| name.clone()).collect();
    assert!(names.remove("srbf_status_panic"), "the parser has missed a declaration");
    assert_eq!(exported(), names, "left: exported by the shared library; right: declared in the header");

    let undocumented: Vec<_> = declared.iter().filter(|(_, documented)| !documented).collect();
    assert!(undocumented.is_empty(), "no comment right before: {undocumented:?}");

    for (program, others) in [
        (
            "normal.c",
            &[
                "fit.c",
                "factors.c",
                "spectrum.c",
                "expanded.c",
                "environment.c",
                "light.c",
                "verbs.c",
                "sheet.c",
                "blend.c",
            ][..],
        ),
        ("abuse.c", &["fit.c", "expanded.c", "environment.c", "light.c", "verbs.c", "sheet.c", "blend.c"]),
    ] {
        // Fitting, expanded materials, sheets, blends and light have programs of their own for both, normal use of factors one as well.
        let read = |name: &str| {
            std::fs::read_to_string(root().join("tests/c").join(name)).expect("the program is there")
        };
        let source = others.iter().fold(read(program), |source, other| source + &read(other));
        // Where nothing can be abused, normal use is all.
        let harmless = ["srbf_version", "srbf_simd_level", "srbf_simd_set_level"];
        let untested: Vec<_> = names
            .iter()
            .filter(|name| !source.contains(&format!("{name}(")))
            .filter(|name| program == "normal.c" || !harmless.contains(&name.as_str()))
            .collect();
        assert!(untested.is_empty(), "not called in tests/c/{program}: {untested:?}");
    }
}

/// Another library of a program may have any name that is plain: neither mangled nor of the compiler, which begin with `_` or have a dot.
#[test]
fn the_static_library_has_no_plain_names_but_ours() {
    let mut nm = Command::new("nm");
    nm.args(["--extern-only", "--defined-only", "--format=posix"]).arg(library().join("libsrbf_fit.a"));
    let output = run(&mut nm);
    let symbols = output.lines().filter_map(|line| line.split_once(' '));
    let names = symbols.filter(|(_, rest)| rest.split(' ').next().is_some_and(|kind| kind.len() == 1));
    let plain: Vec<&str> =
        names.map(|(name, _)| name).filter(|name| !name.starts_with('_') && !name.contains('.')).collect();
    let (ours, others): (Vec<&str>, Vec<&str>) = plain.iter().partition(|name| name.starts_with("srbf_"));
    assert!(ours.len() > 50 && others.is_empty(), "{} of ours, and {others:?}", ours.len());
}

#[test]
fn statuses_have_numbers_of_their_own() {
    let header = std::fs::read_to_string(root().join("include/srbf.h")).expect("the header is there");
    let numbers: Vec<&str> = header
        .lines()
        .filter_map(|line| line.strip_prefix("#define SRBF_STATUS_"))
        .filter_map(|rest| rest.split(' ').nth(1))
        .collect();
    assert!(numbers.len() > 20, "{numbers:?}");
    assert_eq!(numbers.iter().collect::<BTreeSet<_>>().len(), numbers.len(), "{numbers:?}");
}
