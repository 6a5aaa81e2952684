//! The documents, comments and messages are short and plain: pages have a length, sentences too.

use std::path::{Path, PathBuf};

/// Most lines of a page.
const LINES: &[(&str, usize)] =
    &[("README.md", 90), ("ARCHITECTURE.md", 150), ("docs/kernels.md", 90), ("CHANGELOG.md", 40)];

/// Most words of a sentence. A semicolon and a colon end one too.
const WORDS: usize = 25;

/// Phrases about the past of the code, and for things that have a name.
const AVOIDED: &[&str] =
    &["one that is none", "so many", "no longer", "used to be", "up to now", "in place of the old"];

/// Words behind "what" in a phrase that stands for a thing that has a name, such as "what is left" for a residual.
const BEHIND_WHAT: &[&str] = &[
    "a", "are", "can", "comes", "could", "did", "do", "does", "follows", "goes", "has", "have", "is", "it",
    "lies", "makes", "may", "one", "remains", "stays", "that", "the", "they", "this", "was", "were", "would",
];

/// The folders whose comments and messages keep to these words too.
const CODE: &[&str] = &[
    ".ci",
    ".github",
    "benches",
    "capi",
    "core",
    "evaluator",
    "fit",
    "fuzz/src",
    "include",
    "lab",
    "measured",
    "packaging",
    "python/src",
    "python/srbf_brdf",
    "reference-renderer",
    "tests",
    "thesis",
    "wasm",
    "web",
];

/// The endings of files with comments behind `//` or between `/*` and `*/`.
const SLASHES: &[&str] = &["rs", "c", "cpp", "h", "hpp", "inc"];

/// The endings of files with comments behind `#`; files of `.ci` and `packaging` without an ending are scripts too.
const NUMBER_SIGNS: &[&str] = &["py", "pyi", "sh", "cmake", "txt", "yml", "toml", ""];

/// The packages whose documentation keeps to the length of a sentence.
const DOCUMENTED: &[&str] = &["core/src", "measured/src", "fit/src", "thesis/src", "capi/src", "web/src"];

/// The first phrase of a text that stands for a thing that has a name. Its words follow each other without a mark between.
fn avoided(text: &str) -> Option<String> {
    let mark = |c: char| !c.is_alphanumeric();
    let tokens: Vec<String> = text.split_whitespace().map(str::to_lowercase).collect();
    // The letters at the end of a token, and those at its beginning.
    let last = |n: usize| tokens[n].rsplit(mark).next().unwrap_or_default();
    let first = |n: usize| tokens[n].trim_start_matches(mark).split(mark).next().unwrap_or_default();
    let is_at = |n: usize, phrase: &str| {
        let words: Vec<&str> = phrase.split(' ').collect();
        n + words.len() <= tokens.len()
            && words.iter().enumerate().all(|(i, word)| {
                if i + 1 < words.len() { last(n + i) == *word } else { first(n + i) == *word }
            })
    };
    let with_what = BEHIND_WHAT.iter().map(|word| format!("what {word}"));
    let phrases: Vec<String> = AVOIDED.iter().map(|phrase| phrase.to_string()).chain(with_what).collect();
    (0..tokens.len()).find_map(|n| phrases.iter().find(|phrase| is_at(n, phrase)).cloned())
}

/// The comments of a file, each as one text, and its lines with messages; with the number of the first line.
fn texts(code: &str, mark: &str) -> Vec<(usize, String)> {
    let mut texts: Vec<(usize, String)> = Vec::new();
    let (mut is_comment, mut is_block) = (false, false);
    for (n, line) in code.lines().enumerate() {
        let line = line.trim();
        let goes_on = is_comment || is_block;
        is_comment = line.starts_with(mark);
        let opens = mark == "//" && line.starts_with("/*");
        if is_block || is_comment || opens {
            let text = line.trim_start_matches(['/', '!', '*', '#']);
            is_block = (is_block || opens) && !line.contains("*/");
            match texts.last_mut().filter(|_| goes_on) {
                Some((_, so_far)) => *so_far = format!("{so_far} {text}"),
                None => texts.push((n + 1, text.to_owned())),
            }
        } else if line.contains('"') || line.contains(mark) || line.contains("/*") {
            texts.push((n + 1, line.to_owned()));
        }
    }
    texts
}

/// The documentation of each item of a file of Rust, with the number of its first line.
fn documentation(code: &str) -> Vec<(usize, String)> {
    let mut texts: Vec<(usize, String)> = Vec::new();
    let mut goes_on = false;
    for (n, line) in code.lines().enumerate() {
        let line = line.trim_start();
        let text = line.strip_prefix("///").or_else(|| line.strip_prefix("//!"));
        if let Some(text) = text.map(|text| text.strip_prefix(' ').unwrap_or(text)) {
            match texts.last_mut().filter(|_| goes_on) {
                Some((_, so_far)) => *so_far = format!("{so_far}\n{text}"),
                None => texts.push((n + 1, text.to_owned())),
            }
        }
        goes_on = text.is_some();
    }
    texts
}

/// The files below a folder, with the mark of their comments.
pub fn files(folder: &Path, found: &mut Vec<(PathBuf, &'static str)>) {
    for entry in folder.read_dir().expect("a folder") {
        let path = entry.expect("an entry").path();
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        if path.is_dir() {
            if !path.ends_with("target") {
                files(&path, found);
            }
        } else if SLASHES.contains(&ending) {
            found.push((path, "//"));
        } else if NUMBER_SIGNS.contains(&ending) {
            found.push((path, "#"));
        }
    }
}

/// Words of a sentence: those with a letter.
fn words(sentence: &str) -> usize {
    sentence.split(' ').filter(|word| word.contains(char::is_alphabetic)).count()
}

pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The pages that are written by hand.
fn pages() -> Vec<(String, String)> {
    let names = ["README.md", "ARCHITECTURE.md", "CHANGELOG.md", "CONTRIBUTING.md", "presets/README.md"];
    let mut names: Vec<String> = names.map(String::from).into();
    for entry in root().join("docs").read_dir().expect("docs") {
        let name = entry.expect("an entry").file_name().to_string_lossy().into_owned();
        if name.ends_with(".md") {
            names.push(format!("docs/{name}"));
        }
    }
    let text = |name: &str| std::fs::read_to_string(root().join(name)).expect("a page");
    names.into_iter().map(|name| (text(&name), name)).map(|(text, name)| (name, text)).collect()
}

/// A text without the parts between a pair of marks; code is one word.
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
            if words(&sentence) > WORDS {
                failures.push(format!("{name}: {} words: {sentence}", words(&sentence)));
            }
            if let Some(avoided) = avoided(&sentence) {
                failures.push(format!("{name}: \"{avoided}\" in: {sentence}"));
            }
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

#[test]
fn comments_and_messages_name_things() {
    let mut all = Vec::new();
    CODE.iter().for_each(|folder| files(&root().join(folder), &mut all));
    // This file has the phrases.
    all.retain(|(path, _)| !path.ends_with("imports/plain_text.rs"));
    assert!(all.len() > 600, "{} files", all.len());
    let mut failures = Vec::new();
    for (file, mark) in all {
        let Ok(code) = std::fs::read_to_string(&file) else { continue };
        for (line, text) in texts(&code, mark) {
            if let Some(avoided) = avoided(&text) {
                failures.push(format!("{}:{line}: \"{avoided}\"", file.display()));
            }
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

#[test]
fn sentences_of_documentation_are_short() {
    let mut all = Vec::new();
    DOCUMENTED.iter().for_each(|folder| files(&root().join(folder), &mut all));
    let mut failures = Vec::new();
    for (file, _) in all {
        let code = std::fs::read_to_string(&file).expect("a file");
        for (line, text) in documentation(&code) {
            let long = sentences(&text).into_iter().filter(|sentence| words(sentence) > WORDS);
            failures.extend(long.map(|s| format!("{}:{line}: {} words: {s}", file.display(), words(&s))));
        }
    }
    assert!(failures.is_empty(), "{}\n{}", failures.len(), failures.join("\n"));
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
    assert_eq!(avoided("It keeps What\n is left."), Some("what is".to_owned()));
    assert_eq!(avoided("after so many samples"), Some("so many".to_owned()));
    assert_eq!(avoided("Whatever is left, and somewhat so; many more. {what} is it"), None);
    let code = "/// Keeps what\n/// is left.\nlet x = 1;\nprint(\"so many\");\n/* One, what\n * has two. */ int x;\n// what it";
    let found: Vec<_> = texts(code, "//").iter().map(|(line, text)| (*line, avoided(text))).collect();
    let found: Vec<_> =
        found.iter().map(|(line, found)| (*line, found.as_deref().unwrap_or_default())).collect();
    assert_eq!(found, [(1, "what is"), (4, "so many"), (5, "what has"), (7, "what it")]);
    assert_eq!(texts("x = 1\n# a\n# b", "#"), [(2, " a  b".to_owned())]);
    let code = "//! One\n//! two.\n\nuse x;\n    /// Three.\n    fn f() {}";
    assert_eq!(documentation(code), [(1, "One\ntwo.".to_owned()), (5, "Three.".to_owned())]);
}
