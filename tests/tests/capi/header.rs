//! `include/srbf.h` agrees with the source of the C interface.

use srbf_fit::Settings;
use srbf_tests::native::{root, run};
use std::process::Command;

#[test]
fn is_fresh() {
    run(Command::new(env!("CARGO_BIN_EXE_header")).arg("--check"));
}

/// Versions that the header defines, and defaults that it documents, are those of the crates.
#[test]
fn says_what_the_crates_say() {
    let header = std::fs::read_to_string(root().join("include/srbf.h")).unwrap();
    let defined = |name: &str| {
        let value = header.lines().find_map(|line| line.strip_prefix("#define ")?.strip_prefix(name));
        value.unwrap_or_else(|| panic!("no {name} in srbf.h")).trim().parse::<u32>().unwrap()
    };
    let version =
        [env!("CARGO_PKG_VERSION_MAJOR"), env!("CARGO_PKG_VERSION_MINOR"), env!("CARGO_PKG_VERSION_PATCH")];
    let [major, minor, patch] = version.map(|part| part.parse::<u32>().unwrap());
    assert_eq!(defined("SRBF_VERSION "), major * 10000 + minor * 100 + patch);
    assert_eq!(defined("SRBF_FORMAT_VERSION "), srbf_core::FORMAT_VERSION);

    // The last sentence of the comment before a field.
    let (_, fields) = header.split_once("struct srbf_fit_settings {").expect("the settings are in srbf.h");
    let default_of = |field: &str| {
        let (before, _) = fields.split_once(&format!(" {field};")).expect("the settings have the field");
        let (_, after) = before.rsplit_once("Default: ").expect("a comment names a default");
        after.lines().next().unwrap_or_default()
    };
    let settings = Settings::default();
    assert_eq!(default_of("lobes"), format!("{}.", settings.lobes));
    assert_eq!(default_of("bytes"), format!("{}.", settings.bytes));
    assert_eq!(default_of("starts"), format!("{}.", settings.starts));
    assert_eq!(default_of("steps"), format!("{}.", settings.steps));
    assert_eq!(default_of("exchanges"), format!("{}.", settings.exchanges));
    assert_eq!(default_of("smoothness"), format!("{:e}.", settings.smoothness));
}

/// The functions that the head of the header names as enough are there, and are as many as it says.
#[test]
fn names_fifteen_functions_that_are_enough() {
    let header = std::fs::read_to_string(root().join("include/srbf.h")).unwrap();
    let (_, after) = header.split_once("Fifteen functions").expect("the head lists them");
    let (list, declarations) = after.split_once("* Words").expect("the words come next");
    let names: Vec<&str> = list
        .split(|c: char| !(c.is_alphanumeric() || c == '_'))
        .filter(|word| word.starts_with("srbf_"))
        .collect();
    assert_eq!(names.len(), 15);
    for name in names {
        assert!(
            declarations.contains(&format!(" {name}(")) || declarations.contains(&format!("*{name}(")),
            "{name}"
        );
    }
}

/// A share of 0 or 1 is no error: whoever sets it is told of its weights.
#[test]
fn says_that_a_share_of_one_kind_has_weights_without_a_bound() {
    let header = std::fs::read_to_string(root().join("include/srbf.h")).unwrap();
    let (before, _) = header.split_once(" lobe_share;").expect("the settings have the field");
    let (_, comment) = before.rsplit_once(" candidates;").expect("another stands before it");
    assert!(comment.contains("a weight has no bound"), "{comment}");
}
