//! Passages of the documents that state times: they name the commit and the processor that they were taken with.

use std::process::Command;

/// How many commits later a time is measured again.
pub const MOST_BEHIND: u32 = 50;

/// A part of a document under a heading, or behind a paragraph that begins in bold.
#[derive(Clone, Debug, PartialEq)]
pub struct Passage {
    pub line: usize,
    /// Its first words.
    pub begins: String,
    /// Commits that it names.
    pub commits: Vec<String>,
    /// Whether it names a processor by family and model.
    pub has_processor: bool,
}

/// The passages of a document that state times.
pub fn passages(document: &str) -> Vec<Passage> {
    let mut found: Vec<(usize, String)> = Vec::new();
    let mut is_code = false;
    for (number, line) in document.lines().enumerate() {
        is_code ^= line.starts_with("```");
        if found.is_empty() || line.starts_with('#') && !is_code || line.starts_with("**") {
            found.push((number + 1, String::new()));
        }
        if let Some((_, text)) = found.last_mut().filter(|_| !is_code && !line.starts_with("    ")) {
            *text = format!("{text}{line}\n");
        }
    }
    let timed = found.into_iter().filter(|(_, text)| states_time(text));
    timed
        .map(|(line, text)| Passage {
            line,
            begins: text.split_whitespace().take(6).collect::<Vec<_>>().join(" "),
            commits: commits(&text),
            has_processor: is_of_a_processor(&text),
        })
        .collect()
}

/// Whether a number of nanoseconds or seconds of processor time stands in a text, or in a table of it.
fn states_time(text: &str) -> bool {
    let words: Vec<&str> =
        text.split(|c: char| !(c.is_alphanumeric() || c == '.')).filter(|w| !w.is_empty()).collect();
    let is_number = |word: &str| word.trim_end_matches('.').parse::<f64>().is_ok();
    let after_number = |unit: &[&str]| {
        words.windows(2).any(|pair| is_number(pair[0]) && unit.contains(&pair[1].trim_end_matches('.')))
    };
    after_number(&["ns", "us"])
        || words.contains(&"ns")
        || words.contains(&"Nanoseconds")
        || text.contains("processor time") && after_number(&["s"])
}

/// Words `commit HASH`.
fn commits(text: &str) -> Vec<String> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let is_hash = |word: &str| word.len() >= 7 && word.chars().all(|c| c.is_ascii_hexdigit());
    let pairs = words.windows(2).filter(|pair| pair[0].to_lowercase().ends_with("commit"));
    let hashes = pairs.map(|pair| pair[1].trim_matches(|c: char| !c.is_ascii_alphanumeric()));
    hashes.filter(|word| is_hash(word)).map(str::to_owned).collect()
}

/// Whether `family N, model N` stands there.
fn is_of_a_processor(text: &str) -> bool {
    let words: Vec<&str> = text.split_whitespace().collect();
    words.windows(4).any(|w| w[0].ends_with("family") && w[2] == "model" && w[1].ends_with(','))
}

/// How many commits of the history are not in that of a commit; `None` where git does not know it.
pub fn behind(root: &std::path::Path, commit: &str) -> Option<u32> {
    let range = format!("{commit}..HEAD");
    let output =
        Command::new("git").arg("-C").arg(root).args(["rev-list", "--count", &range]).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().parse().ok())?
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_without_commit_or_processor_are_found() {
        let page = "# Speed\n\nOne takes 12 ns, commit 0fa598b, AMD (family 26, model 2).\n\n# Bytes\n\n12 bytes at commit abc.\n\n\
                    **Fits** take 7 s of\nprocessor time.\n\n```\n5 ns\n```\n";
        let found = passages(page);
        assert_eq!(found.len(), 2, "{found:?}");
        assert_eq!(
            (found[0].line, &found[0].commits[..], found[0].has_processor),
            (1, &["0fa598b".to_owned()][..], true)
        );
        assert_eq!((found[1].line, found[1].commits.len(), found[1].has_processor), (9, 0, false));
    }
}
