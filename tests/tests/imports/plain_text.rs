//! The documents are short and plain: pages have a length, sentences too.

use std::path::{Path, PathBuf};

/// Most lines of a page.
const LINES: &[(&str, usize)] =
    &[("README.md", 120), ("ARCHITECTURE.md", 150), ("docs/kernels.md", 90), ("CHANGELOG.md", 40)];

/// Most words of a sentence, where CONTRIBUTING.md asks for 25. A semicolon and a colon end one too.
const WORDS: usize = 30;

/// Words for something that has a name, and words about the past of the code.
const AVOIDED: &[&str] = &["what is seen", "one that is none", "no longer", "used to be", "up to now"];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The pages that are written by hand.
fn pages() -> Vec<(String, String)> {
    let mut names: Vec<String> = ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"].map(String::from).into();
    for entry in root().join("docs").read_dir().expect("docs") {
        let name = entry.expect("an entry").file_name().to_string_lossy().into_owned();
        if name.ends_with(".md") {
            names.push(format!("docs/{name}"));
        }
    }
    let text = |name: &str| std::fs::read_to_string(root().join(name)).expect("a page");
    names.into_iter().map(|name| (text(&name), name)).map(|(text, name)| (name, text)).collect()
}

/// A text without what a pair of marks encloses; code is one word.
fn without(text: &str, open: char, close: char, word: &str) -> String {
    let (mut kept, mut inside) = (String::new(), false);
    for c in text.chars() {
        if !inside && c == open {
            inside = true;
            kept.push_str(word);
        } else if inside && c == close {
            inside = false;
        } else if !inside {
            kept.push(c);
        }
    }
    kept
}

/// The sentences of the prose of a page: no blocks of code; cells of tables and items of lists are texts of their own.
fn sentences(page: &str) -> Vec<String> {
    let (mut texts, mut text, mut is_code) = (Vec::new(), String::new(), false);
    for line in page.lines() {
        is_code ^= line.starts_with("```");
        let item = line.trim_start();
        let starts = item.starts_with("* ")
            || item.starts_with("- ")
            || item
                .split_once(". ")
                .is_some_and(|(n, _)| !n.is_empty() && n.chars().all(|c| c.is_ascii_digit()));
        let is_block = is_code || line.starts_with("```") || line.starts_with("    ") && text.is_empty();
        let is_row = line.starts_with('|');
        if is_block || line.is_empty() || starts || is_row {
            texts.push(std::mem::take(&mut text));
        }
        if is_row {
            texts.extend(line.split('|').map(str::to_owned));
        } else if !is_block {
            text = text + " " + line.trim();
            text.truncate(text.trim_end().len());
        }
    }
    texts.push(text);
    let plain = |text: String| without(&without(&text, '`', '`', "code"), '(', ')', "");
    let ends = |c: char| ".;:!?".contains(c);
    let of_text = |text: String| {
        // A mark within a word or number ends nothing.
        let marked: Vec<String> = plain(text).split_whitespace().map(str::to_owned).collect();
        let parts = marked.split_inclusive(|word| word.ends_with(ends)).map(|words| words.join(" "));
        parts.collect::<Vec<_>>()
    };
    texts.into_iter().flat_map(of_text).collect()
}

#[test]
fn pages_and_sentences_are_short_and_name_things() {
    let mut failures = Vec::new();
    for (name, most) in LINES {
        let lines = std::fs::read_to_string(root().join(name)).expect("a page").lines().count();
        if lines > *most {
            failures.push(format!("{name}: {lines} lines, at most {most}"));
        }
    }
    for (name, page) in pages() {
        for sentence in sentences(&page) {
            let words = sentence.split(' ').filter(|word| word.contains(char::is_alphabetic)).count();
            if words > WORDS {
                failures.push(format!("{name}: {words} words: {sentence}"));
            }
            if let Some(avoided) = AVOIDED.iter().find(|avoided| sentence.contains(*avoided)) {
                failures.push(format!("{name}: \"{avoided}\" in: {sentence}"));
            }
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

#[test]
fn a_planted_sentence_is_found() {
    let long = format!("Short. {}end.\n\n    code {}\n", "word ".repeat(31), "word ".repeat(40));
    let counts: Vec<usize> = sentences(&long).iter().map(|s| s.split(' ').count()).collect();
    assert_eq!(counts, [1, 32]);
    assert_eq!(
        sentences("* one `a b c` (d e)\n  two\n* three 1.5 four"),
        ["one code two", "three 1.5 four"].map(|s| format!("* {s}"))
    );
}
