//! `srbf-lab stated`: the figures that documents state, beside those of the present code.
//!
//! | file | holds |
//! |---|---|
//! | `list` | the sentences of the documents |
//! | `sentence` | where a sentence stands, and its numbers |
//! | `figure` | a figure as text, and whether two are the same |
//! | `measure` | the figures of the present code |
//! | `times` | passages that state times |

mod figure;
mod list;
mod measure;
mod sentence;
mod times;

use anyhow::{Context, bail, ensure};
use figure::Figure;
use list::SENTENCES;
use measure::{GROUPS, Group, Needs};
use srbf_reference_renderer::out::output;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Prints every deterministic figure that the documents state, as the present code gives it.
///
/// docs/figures.csv holds them all, each with the command that prints it. Half a minute on two processors. What needs data or minutes
/// stays as it is without them; documents still have to state what docs/figures.csv says.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Fails where a document or docs/figures.csv states something else, or states a time without commit and processor
    #[arg(long, conflicts_with = "write")]
    check: bool,
    /// Writes the figures into the documents and docs/figures.csv
    #[arg(long)]
    write: bool,
    /// Also makes the figures that take minutes
    #[arg(long)]
    slow: bool,
    /// Lists the passages that state times, each with its commits and how far they are behind
    #[arg(long, conflicts_with_all = ["check", "write", "only"])]
    times: bool,
    /// Only the figures whose first word this is
    #[arg(long, value_name = "GROUP")]
    only: Option<String>,
    /// The root of the repository
    #[arg(long, default_value = ".", value_name = "DIR")]
    root: PathBuf,
}

/// The one place of all figures.
const TABLE: &str = "docs/figures.csv";

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<()> {
    if args.times {
        return list_times(&args.root);
    }
    let groups = chosen(args)?;
    let mut pages = Pages::read(&args.root)?;
    let mut made = Vec::new();
    for group in &groups {
        for figure in (group.make)().with_context(|| format!("figures of {}", group.name))? {
            println!("{}: {}", figure.name, figure.value);
            made.push(figure);
        }
    }
    let mut stale = pages.compare(&made)?;
    let table = table(&pages.table, &groups, &made)?;
    if args.write {
        for (name, text) in &pages.documents {
            output::write(&args.root.join(name), text.as_bytes())?;
        }
        output::write(&args.root.join(TABLE), table.as_bytes())?;
        stale.iter().for_each(|line| println!("written: {line}"));
    }
    if args.check {
        stale.extend(stale_rows(&pages.table, &made));
        stale.extend(pages.beside_the_table(&made)?);
        stale.extend(untold_times(&args.root)?);
        ensure!(
            stale.is_empty(),
            "{}\n`cargo lab stated --write` writes figures into the documents",
            stale.join("\n")
        );
        println!("{} figures, all as the documents say", made.len());
    }
    Ok(())
}

/// The groups of that name, or all; without those that cannot be made here.
fn chosen(args: &Args) -> anyhow::Result<Vec<&'static Group>> {
    let is_named = |group: &&Group| args.only.as_ref().is_none_or(|name| group.name == name);
    let named: Vec<&Group> = GROUPS.iter().filter(is_named).collect();
    if named.is_empty() {
        let names: Vec<&str> = GROUPS.iter().map(|group| group.name).collect();
        bail!("--only {}: one of {} is expected", args.only.clone().unwrap_or_default(), names.join(", "));
    }
    let has_data = std::env::var_os("SRBF_DATA_DIR").is_some_and(|data| Path::new(&data).is_dir());
    let is_possible = |group: &&Group| {
        let missing = match group.needs {
            Needs::Nothing => None,
            Needs::Data | Needs::Minutes if !has_data => Some("SRBF_DATA_DIR, the folder of the data"),
            Needs::Minutes if !args.slow => Some("--slow"),
            Needs::Data | Needs::Minutes => None,
        };
        if let Some(missing) = missing {
            println!("{}: not made without {missing}", group.name);
        }
        missing.is_none()
    };
    Ok(named.into_iter().filter(is_possible).collect())
}

/// The documents that state figures, and the table of them.
struct Pages {
    documents: Vec<(&'static str, String)>,
    table: String,
}

impl Pages {
    fn read(root: &Path) -> anyhow::Result<Self> {
        let text = |name: &str| {
            std::fs::read_to_string(root.join(name)).with_context(|| root.join(name).display().to_string())
        };
        let mut documents: Vec<(&str, String)> = Vec::new();
        for sentence in SENTENCES {
            if documents.iter().all(|page| page.0 != sentence.document) {
                documents.push((sentence.document, text(sentence.document)?));
            }
        }
        Ok(Self { documents, table: text(TABLE)? })
    }

    /// Puts figures into the documents where they are stale, and says where that was.
    fn compare(&mut self, made: &[Figure]) -> anyhow::Result<Vec<String>> {
        let mut stale = Vec::new();
        for sentence in SENTENCES {
            let page = self.documents.iter_mut().find(|page| page.0 == sentence.document);
            let (name, text) = page.with_context(|| sentence.document.to_owned())?;
            let places = sentence::find(text, sentence.text).with_context(|| (*name).to_owned())?;
            // From the end, so that places before it stay where they are.
            for place in places.iter().rev() {
                let Some(figure) = made.iter().find(|figure| figure.name == place.figure) else { continue };
                let stated = &text[place.range.clone()];
                if !figure.is(stated) {
                    let line = 1 + text[..place.range.start].matches('\n').count();
                    stale.push(format!(
                        "{name}:{line}: {} is stated as {stated}, the code gives {}",
                        figure.name, figure.value
                    ));
                    text.replace_range(place.range.clone(), &figure.value);
                }
            }
        }
        Ok(stale)
    }
}

impl Pages {
    /// Where documents and the table state different numbers for figures that were not made.
    fn beside_the_table(&self, made: &[Figure]) -> anyhow::Result<Vec<String>> {
        let mut stale = Vec::new();
        for sentence in SENTENCES {
            let page = self.documents.iter().find(|page| page.0 == sentence.document);
            let (name, text) = page.with_context(|| sentence.document.to_owned())?;
            for place in sentence::find(text, sentence.text).with_context(|| (*name).to_owned())? {
                let stated = &text[place.range.clone()];
                if made.iter().any(|figure| figure.name == place.figure) {
                    continue;
                }
                let kept = row(&self.table, &place.figure);
                if kept.is_none_or(|kept| !Figure::kept(&place.figure, kept).is(stated)) {
                    let kept = kept.unwrap_or("nothing");
                    stale.push(format!("{name}: {} is stated as {stated}, {TABLE} has {kept}", place.figure));
                }
            }
        }
        Ok(stale)
    }
}

/// Head of the table of figures.
const HEAD: &str = "figure,value,command";

/// Value of a figure in the table.
fn row<'a>(table: &'a str, name: &str) -> Option<&'a str> {
    table.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(',')?.split(',').next())
}

/// Figures whose row of the table is stale or missing.
fn stale_rows(table: &str, made: &[Figure]) -> Vec<String> {
    let stale = made.iter().filter(|figure| row(table, &figure.name).is_none_or(|stated| !figure.is(stated)));
    stale.map(|f| format!("{TABLE}: {} is not {}", f.name, f.value)).collect()
}

/// The table with the figures that were made; rows of other groups stay. A figure that differs by rounding alone keeps its digits.
fn table(before: &str, groups: &[&Group], made: &[Figure]) -> anyhow::Result<String> {
    let mut text = format!("{HEAD}\n");
    for group in GROUPS {
        let prefix = format!("{} ", group.name);
        if groups.iter().all(|chosen| chosen.name != group.name) {
            for line in before.lines().filter(|line| line.starts_with(&prefix)) {
                writeln!(text, "{line}")?;
            }
            continue;
        }
        for figure in made.iter().filter(|figure| figure.name.starts_with(&prefix)) {
            let kept = row(before, &figure.name).filter(|stated| figure.is(stated));
            writeln!(text, "{},{},\"{}\"", figure.name, kept.unwrap_or(&figure.value), group.command)?;
        }
    }
    Ok(text)
}

/// The pages that may state times.
fn pages_of_times(root: &Path) -> anyhow::Result<Vec<(String, String)>> {
    let docs = root.join("docs");
    let mut names = vec!["README.md".to_owned()];
    for entry in docs.read_dir().with_context(|| docs.display().to_string())? {
        let name = entry?.file_name().to_string_lossy().into_owned();
        if name.ends_with(".md") {
            names.push(format!("docs/{name}"));
        }
    }
    names.sort();
    let page = |name: String| {
        let text = std::fs::read_to_string(root.join(&name)).with_context(|| name.clone())?;
        Ok((name, text))
    };
    names.into_iter().map(page).collect()
}

/// Passages that state times, and not their processor and commit.
fn untold_times(root: &Path) -> anyhow::Result<Vec<String>> {
    let mut untold = Vec::new();
    for (name, text) in pages_of_times(root)? {
        for passage in times::passages(&text) {
            let missing = match (passage.commits.is_empty(), passage.has_processor) {
                (false, true) => continue,
                (true, true) => "the commit",
                (false, false) => "the processor by family and model",
                (true, false) => "commit and processor",
            };
            untold.push(format!(
                "{name}:{}: `{}` states times without {missing}",
                passage.line, passage.begins
            ));
        }
    }
    Ok(untold)
}

fn list_times(root: &Path) -> anyhow::Result<()> {
    let (mut count, mut old) = (0, 0);
    for (name, text) in pages_of_times(root)? {
        for passage in times::passages(&text) {
            let told = |commit: &String| match times::behind(root, commit) {
                None => format!("{commit}, which git does not know"),
                Some(behind) => format!("{commit}, {behind} behind"),
            };
            let is_old = |commit: &String| times::behind(root, commit).is_none_or(|n| n > times::MOST_BEHIND);
            let is_stale = passage.commits.is_empty() || passage.commits.iter().any(is_old);
            let commits: Vec<String> = passage.commits.iter().map(told).collect();
            let mark = if is_stale { "OLD" } else { "   " };
            println!("{mark} {name}:{}: `{}`: {}", passage.line, passage.begins, commits.join("; "));
            count += 1;
            old += u32::from(is_stale);
        }
    }
    println!("{old} of {count} passages are more than {} commits behind, or name none", times::MOST_BEHIND);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stated_figure_is_of_a_group() {
        for sentence in SENTENCES {
            for name in sentence::figures(sentence.text) {
                let group = name.split(' ').next().unwrap_or_default();
                assert!(GROUPS.iter().any(|known| known.name == group), "{}: {name}", sentence.document);
            }
        }
    }

    #[test]
    fn rows_of_other_groups_stay() {
        let before = format!("{HEAD}\nbytes old,1,\"x\"\nfurnace red,0.5,\"y\"\n");
        let text = table(&before, &[&GROUPS[0]], &[Figure::count("bytes new", 7)]).unwrap();
        assert!(text.contains("bytes new,7,") && text.contains("furnace red,0.5,\"y\""), "{text}");
        assert!(!text.contains("bytes old"), "{text}");
        assert_eq!(stale_rows(&text, &[Figure::count("bytes new", 8)]).len(), 1);
    }
}
