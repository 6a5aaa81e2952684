//! Words with one meaning each: docs/glossary.md, and the types of the packages.

use crate::PACKAGES;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Names that several private types have, and how many at most: one more fails.
const SEVERAL: &[(&str, usize)] = &[("Block", 4), ("Place", 4), ("Proposal", 1), ("Row", 5)];

/// Where types are defined: the files of each name.
fn definitions() -> BTreeMap<String, BTreeSet<String>> {
    let mut found: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for package in PACKAGES {
        for file in package.files() {
            // A file that another package shares is that package's.
            for name in file.types().filter(|_| !file.place.starts_with("..")) {
                found
                    .entry(name.clone())
                    .or_default()
                    .insert(format!("{}/src/{}", package.folder, file.place));
            }
        }
    }
    found
}

/// The cells of the rows of the glossary.
fn rows() -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/glossary.md"));
    let text = text.expect("the glossary").replace("\\|", "/");
    let rows = text.lines().filter(|line| line.starts_with("| ") && !line.starts_with("| word |"));
    rows.map(|row| row.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()).collect()
}

#[test]
fn every_word_of_the_glossary_has_one_meaning() {
    let (rows, definitions) = (rows(), definitions());
    assert!(rows.len() >= 40, "{} words", rows.len());
    let mut words = BTreeSet::new();
    let mut listed: BTreeMap<&str, BTreeSet<String>> = BTreeMap::new();
    let mut failures = Vec::new();
    for row in &rows {
        assert_eq!(row.len(), 3, "{row:?}");
        for word in row[0].split(", ") {
            if !words.insert(word) {
                failures.push(format!("{word} stands twice"));
            }
        }
        // `Name` in `file`, for each meaning of the name.
        let spans: Vec<&str> = row[2].split('`').skip(1).step_by(2).collect();
        for pair in spans.chunks_exact(2) {
            listed.entry(pair[0]).or_default().insert(pair[1].to_owned());
        }
    }
    for (name, files) in listed {
        let defined = definitions.get(name).cloned().unwrap_or_default();
        if files != defined {
            failures.push(format!("{name} is listed in {files:?}, defined in {defined:?}"));
        }
    }
    for (name, count) in SEVERAL {
        let defined = definitions.get(*name).cloned().unwrap_or_default();
        if defined.len() > *count {
            failures.push(format!("{name}: at most {count} types, there are {}: {defined:?}", defined.len()));
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}
