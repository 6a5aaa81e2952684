//! Words that are said of an input, and those that lack.

use srbf_measured::look::{Finding, Look};

/// The findings of a look, a line each.
pub fn said(look: &Look) -> String {
    let one = |f: &Finding| {
        format!("{} {} ({})", if f.is_off { "check" } else { "note" }, f.text, f.option.unwrap_or(""))
    };
    look.findings.iter().map(one).collect::<Vec<_>>().join("\n")
}

/// A fault for each word that a text lacks.
pub fn lacking(words: &[&str], text: &str) -> Vec<String> {
    words.iter().filter(|word| !text.contains(**word)).map(|word| format!("no `{word}` in {text}")).collect()
}
