//! Links of the pages lead to files and headings that are there, and the book has every page of `docs/`.

use super::plain_text::root;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Folders without pages of ours.
const LEFT_OUT: &[&str] = &["target", "out", "build", "node_modules", "corpus", "artifacts"];

/// The pages below a folder.
fn pages(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in folder.read_dir().expect("a folder") {
        let entry = entry.expect("an entry");
        let path = entry.path();
        let name = entry.file_name().to_string_lossy().into_owned();
        // README stands in the packages too, by links of the file system.
        if entry.file_type().expect("a type").is_symlink() {
            continue;
        }
        if path.is_dir() && !name.starts_with('.') && !LEFT_OUT.contains(&name.as_str()) {
            pages(&path, found);
        } else if name.ends_with(".md") {
            found.push(path);
        }
    }
}

/// The lines of a page outside of blocks of code.
fn prose(page: &str) -> impl Iterator<Item = &str> {
    let mut is_code = false;
    page.lines().filter(move |line| {
        let is_mark = line.trim_start().starts_with("```");
        is_code ^= is_mark;
        !is_code && !is_mark && !line.starts_with("    ")
    })
}

/// The targets of the links and pictures of a page, without those of the web.
fn targets(page: &str) -> Vec<String> {
    let mut found = Vec::new();
    for line in prose(page) {
        for part in line.split("](").skip(1) {
            let target = part.split([')', ' ']).next().unwrap_or_default();
            if !target.contains("://") && !target.starts_with("mailto:") {
                found.push(target.to_owned());
            }
        }
    }
    found
}

/// The anchor of a heading, as GitHub and mdBook make it.
fn anchor(heading: &str) -> String {
    let kept = |c: &char| c.is_alphanumeric() || [' ', '-', '_'].contains(c);
    heading.trim().to_lowercase().chars().filter(kept).map(|c| if c == ' ' { '-' } else { c }).collect()
}

fn anchors(page: &str) -> BTreeSet<String> {
    let headings = prose(page).filter(|line| line.starts_with('#'));
    headings.map(|line| anchor(line.trim_start_matches('#'))).collect()
}

/// The fault of a link, if it has one.
fn fault(page: &Path, text: &str, target: &str) -> Option<String> {
    let (path, heading) = target.split_once('#').map_or((target, None), |(path, h)| (path, Some(h)));
    let file = if path.is_empty() { page.to_owned() } else { page.parent()?.join(path) };
    if !file.exists() {
        return Some(format!("no such file: {target}"));
    }
    let heading = heading?;
    let other = std::fs::read_to_string(&file).ok();
    let known = anchors(if path.is_empty() { text } else { other.as_deref()? });
    (!known.contains(heading)).then(|| format!("no such heading: {target}"))
}

#[test]
fn links_lead_somewhere() {
    let (mut all, mut faults, mut count) = (Vec::new(), Vec::new(), 0);
    pages(&root(), &mut all);
    assert!(all.len() > 40, "{} pages", all.len());
    for page in all {
        let text = std::fs::read_to_string(&page).expect("a page");
        for target in targets(&text) {
            count += 1;
            faults.extend(fault(&page, &text, &target).map(|fault| format!("{}: {fault}", page.display())));
        }
    }
    assert!(count > 200, "{count} links");
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn the_book_has_every_page() {
    let docs = root().join("docs");
    let summary = std::fs::read_to_string(docs.join("SUMMARY.md")).expect("the contents of the book");
    let listed: BTreeSet<String> = targets(&summary).into_iter().collect();
    let names = docs.read_dir().expect("docs").map(|entry| entry.expect("an entry").file_name());
    let missing: Vec<String> = names
        .map(|name| name.to_string_lossy().into_owned())
        .filter(|name| name.ends_with(".md") && name != "SUMMARY.md" && !listed.contains(name))
        .collect();
    assert!(missing.is_empty(), "not in docs/SUMMARY.md: {missing:?}");
    let readme = std::fs::read_to_string(root().join("README.md")).expect("README");
    assert!(targets(&readme).contains(&"docs/SUMMARY.md".to_owned()));
}

#[test]
fn a_planted_dead_link_is_found() {
    let page = root().join("docs/fit.md");
    let text = "# Here it is, `x` twice\n\n[a](missing.md) ![b](fit.md#where-the-time-goes) [c](#nowhere)\n[d](#here-it-is-x-twice) <https://x>\n\n```\n[e](gone.md)\n```\n";
    let faults: Vec<String> = targets(text).iter().filter_map(|target| fault(&page, text, target)).collect();
    assert_eq!(faults, ["no such file: missing.md", "no such heading: #nowhere"]);
}
