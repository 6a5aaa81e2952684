//! Every word that `look` and `fit` say of files, as a table.

use anyhow::Context;
use srbf_core::Material;
use srbf_fit::judge::reciprocity::reciprocity;
use srbf_fit::judge::verdict::Verdict;
use srbf_fit::look::{Finding, Look};
use srbf_fit::read::{Content, read};
use srbf_fit::table::Symmetry;
use srbf_fit::{FitError, Settings, fit_source};
use srbf_reference_renderer::command::look::looked_at;
use std::path::{Path, PathBuf};

/// Endings of files that are no inputs: programs that make some, and texts about them.
const OTHERS: [&str; 2] = ["py", "md"];

/// A word about a file: its name, who says it, its mark and its text.
type Word = [String; 4];

/// Writes the words about files, and about all files of folders, as CSV: input, command, mark, words. The fits are short ones; criteria
/// that are good are left out.
pub fn write(output: &Path, inputs: &[PathBuf]) -> anyhow::Result<()> {
    let mut files = Vec::new();
    for input in inputs {
        add(input, &mut files)?;
    }
    let mut writer = csv::Writer::from_path(output).with_context(|| output.display().to_string())?;
    writer.write_record(["input", "said by", "mark", "words"])?;
    for file in &files {
        println!("{}", file.display());
        for word in of(file) {
            writer.write_record(&word)?;
        }
    }
    writer.flush()?;
    Ok(())
}

/// A file, or those of a folder and its folders, in order.
fn add(path: &Path, files: &mut Vec<PathBuf>) -> anyhow::Result<()> {
    if !path.is_dir() {
        files.push(path.to_path_buf());
        return Ok(());
    }
    let entries = std::fs::read_dir(path).with_context(|| path.display().to_string())?;
    let mut entries: Vec<PathBuf> = entries.map(|e| Ok(e?.path())).collect::<std::io::Result<_>>()?;
    entries.retain(|entry| !entry.extension().is_some_and(|end| OTHERS.iter().any(|other| end == *other)));
    entries.sort();
    entries.iter().try_for_each(|entry| add(entry, files))
}

/// All words about a file.
fn of(file: &Path) -> Vec<Word> {
    let parts: Vec<String> =
        file.iter().rev().take(2).map(|part| part.to_string_lossy().into_owned()).collect();
    let name = parts.into_iter().rev().collect::<Vec<_>>().join("/");
    let word = |by: &str, mark: &str, text: &str| [&name, by, mark, text].map(str::to_owned);
    let folder = file.parent().unwrap_or(file).display().to_string() + "/";
    let refused = |by: &str, error: &FitError| {
        let all = std::iter::successors(Some(error as &dyn std::error::Error), |error| error.source());
        let text = all.map(|error| error.to_string()).collect::<Vec<_>>().join(": ");
        vec![word(by, "refused", &text.replace(&folder, ""))]
    };
    let finding = |f: &Finding| {
        let option = f.option.map_or_else(String::new, |option| format!(" ({option})"));
        word("look", if f.is_off { "check" } else { "note" }, &format!("{}{option}", f.text))
    };
    let said = |look: &Look| {
        let data = word("look", "data", &look.summary());
        std::iter::once(data).chain(look.findings.iter().map(finding)).collect::<Vec<Word>>()
    };
    let source = match read(file) {
        Ok(source) => source,
        Err(error) => return refused("look", &error),
    };
    // Few steps of one start: the words are of the data, and of the fit as it then is.
    let settings = Settings { starts: 2, steps: 20, exchanges: 2, ..Settings::default() };
    let is_isotropic =
        !matches!(&source.content, Content::Evaluable(brdf) if brdf.symmetry() != Symmetry::Isotropic);
    let mut words = Vec::new();
    match fit_source(&source, &settings, |_| {}) {
        Ok(fit) => {
            let judged =
                Material::from_bytes(fit.bytes.as_slice()).map_err(FitError::from).and_then(|material| {
                    let verdict = Verdict::of_material(&fit.report, &reciprocity(&material)?);
                    let notes = fit.report.notes().into_iter().map(|note| format!("note {note}"));
                    Ok(notes.chain(verdict.lines()).collect::<Vec<_>>())
                });
            if let Some(look) = &fit.report.look {
                words.extend(said(look));
            }
            match judged {
                Ok(lines) => {
                    words.extend(lines.iter().filter(|line| !line.starts_with("good ")).map(|line| {
                        let marks = ["note", "fair", "off", "try"];
                        let mark = marks.iter().find(|mark| line.starts_with(&format!("{mark} ")));
                        let text = mark.map_or(line.as_str(), |mark| line[mark.len()..].trim_start());
                        word("fit", mark.unwrap_or(&"verdict"), text)
                    }))
                }
                Err(error) => words.extend(refused("fit", &error)),
            }
        }
        Err(error) => words.extend(refused("fit", &error)),
    }
    // Of a file with a value for every pair of directions, `look --table` looks at samples.
    if source.intake.is_none() && is_isotropic {
        match looked_at(source) {
            Ok(look) => words.extend(
                said(&look)
                    .into_iter()
                    .map(|[name, _, mark, text]| [name, "look --table".to_owned(), mark, text]),
            ),
            Err(error) => words.push(word("look --table", "refused", &format!("{error:#}"))),
        }
    }
    words
}
