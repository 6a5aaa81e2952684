//! `srbf fit`: the printed text. By default a heading, the verdict, the files that were written, and the next step.

use super::method::Baseline;
use super::names::{self, Job};
use crate::command::view_table;
use crate::out::print::{data, shown};
use srbf_core::Material;
use srbf_fit::judge::cross::CrossValidation;
use srbf_fit::judge::method::Fitted;
use srbf_fit::judge::reciprocity::reciprocity;
use srbf_fit::judge::report::{Report, mean_error};
use srbf_fit::judge::verdict::Verdict;
use std::path::Path;

/// How much is printed.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Also prints the errors of every view, and how their summary comes about
    #[arg(long, short, conflicts_with_all = ["json", "quiet"])]
    verbose: bool,
    /// Prints the report alone, as it is written beside the material: a JSON document for each file
    #[arg(long, conflicts_with = "quiet")]
    json: bool,
}

impl Args {
    /// Separates the text on a file from that on the one before.
    pub fn say_next_file(&self) {
        if !self.json {
            println!();
        }
    }

    /// Says how good a fit of ours is; gives the words.
    pub fn say_fit(
        &self,
        place: &Job,
        report: &Report,
        material: &Material<&[u8]>,
        json: &str,
    ) -> anyhow::Result<Vec<String>> {
        let heading = heading(&shown(&place.output), report, material);
        self.say(&heading, report, material, Some(material), json)
    }

    /// Whether the report alone is printed.
    pub fn is_json(&self) -> bool {
        self.json
    }

    /// Says how good the fit of a quarter of a sheet is; gives the words.
    pub fn say_quarter(
        &self,
        name: &str,
        report: &Report,
        material: &Material<&[u8]>,
    ) -> anyhow::Result<Vec<String>> {
        let heading = heading(name, report, material);
        // The report of the sheet is printed as one.
        self.say(&heading, report, material, Some(material), "")
    }

    /// Says how good a fit by another method is.
    pub fn say_baseline(&self, place: &Job, fit: &Baseline) -> anyhow::Result<()> {
        let heading = format!("{}: fitted in {:.1} s", shown(&place.output), fit.report.seconds);
        self.say(&heading, &fit.report, fit.fitted.as_ref(), None, &fit.json)?;
        Ok(())
    }

    fn say(
        &self,
        heading: &str,
        report: &Report,
        fitted: &dyn Fitted,
        material: Option<&Material<&[u8]>>,
        json: &str,
    ) -> anyhow::Result<Vec<String>> {
        let reciprocity = reciprocity(fitted)?;
        let judged = if material.is_some() { Verdict::of_material } else { Verdict::new };
        let words = view_table::words(report, &judged(report, &reciprocity));
        if self.json {
            data(json);
            return Ok(words);
        }
        println!("{heading}");
        if let Some(look) = &report.look {
            crate::command::look::print(look, self.verbose, &words);
        }
        if self.verbose {
            print_tables(report);
            view_table::print_whole(report, &reciprocity, material);
        }
        if let Some(found) = &report.cross_validation {
            print_left_out(found);
        }
        words.iter().for_each(|line| println!("{line}"));
        Ok(words)
    }

    /// Prints the files that were written, and the next step.
    pub fn say_written(&self, place: &Job, pictures: [Option<&Path>; 2], next: &str) {
        if self.json {
            return;
        }
        let (output, report) = (&place.output, names::report(&place.output));
        let paths = [Some(output.as_path()), Some(&report)].into_iter().chain(pictures);
        let paths: Vec<String> = paths.flatten().map(shown).collect();
        println!("wrote {}", paths.join(", "));
        println!("next  {next}");
    }
}

/// The line above the words on a fit.
fn heading(name: &str, report: &Report, material: &Material<&[u8]>) -> String {
    format!(
        "{name}: {} bytes, {} lobes at {} views, fitted in {:.1} s",
        material.bytes().len(),
        material.lobe_count(),
        material.view_count(),
        report.seconds
    )
}

/// What to do with a material next.
pub fn next(material: &Path) -> String {
    let picture = material.with_extension("exr");
    format!("srbf render --scene teapot --material {} -o {}", quoted(material), quoted(&picture))
}

/// What to do with a sheet next.
pub fn inspect(sheet: &Path) -> String {
    format!("srbf inspect {}", quoted(sheet))
}

/// A path as a shell takes it for one word.
fn quoted(path: &Path) -> String {
    let text = shown(path);
    let plain = |c: char| c.is_alphanumeric() || "-_./=,:+".contains(c);
    if text.chars().all(plain) { text } else { format!("'{}'", text.replace('\'', "'\\''")) }
}

/// Prints a report, a line a view.
fn print_tables(report: &Report) {
    let isotropic = view_table::is_isotropic(report);
    println!("{} evaluations", report.evaluations);
    println!("{}", view_table::LEGEND);
    view_table::print_views(&report.views, isotropic);
    println!("mean relative L2 {:.2} %", 100.0 * report.mean_error());
    if !report.held_out.is_empty() {
        let of = if report.completion.is_some() { ", against the completion of the samples" } else { "" };
        println!("held out, between the stored views{of}:");
        view_table::print_views(&report.held_out, isotropic);
        println!("mean relative L2 held out {:.2} %", 100.0 * mean_error(&report.held_out));
    }
    if let Some(completion) = &report.completion {
        view_table::print_completion(completion);
    }
}

fn print_left_out(found: &CrossValidation) {
    let percent = |digits: usize, error: Option<f64>| {
        error.filter(|e| !e.is_nan()).map_or_else(|| "-".into(), |e| format!("{:.digits$}", 100.0 * e))
    };
    let list = |errors: &mut dyn Iterator<Item = f64>| -> String {
        errors.map(|e| percent(1, Some(e))).collect::<Vec<_>>().join(" ")
    };
    let [samples, views] = found.means();
    println!(
        "relative L2 over samples left out, 5 folds: mean {} %; views: {}",
        percent(2, samples),
        list(&mut found.folds.iter().copied())
    );
    println!(
        "relative L2 of views left out: mean {} %; inner views: {}",
        percent(2, views),
        list(&mut found.left_out.iter().map(|view| view.1))
    );
}
