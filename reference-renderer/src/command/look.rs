//! `srbf look`.

use super::convention_args::ConventionArgs;
use crate::out::print::data;
use anyhow::bail;
use srbf_fit::complete::complete;
use srbf_fit::export;
use srbf_fit::look::{Finding, Look, Topic};
use srbf_fit::read::{Content, Conventions, Source, csv, read_with};
use srbf_fit::table::Table;
use std::path::{Path, PathBuf};

/// Looks at measurements without fitting them: content, assumptions, faults, and options that change the reading.
///
/// Of a file of samples: their number, the rows that were left out with their lines, conventions with the option that changes each, whether
/// a turn of the sample matters, units, swapped pairs, left against right, the highlight, and outliers by line. The exit
/// status is 2 if a file cannot be read.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Measured BRDFs, as `srbf fit` reads them
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Does not complete the samples: faster, and without units, outliers and highlight
    #[arg(long)]
    quick: bool,
    /// Prints JSON, a document for each file
    #[arg(long, conflicts_with = "quiet")]
    json: bool,
    /// Prints a line for each file: faults of units, isotropy, outliers, cosines and sides. A file with a value for every pair of
    /// directions is sampled first, at 1500 of them.
    #[arg(long, conflicts_with_all = ["quiet", "json", "quick"])]
    table: bool,
    #[command(flatten)]
    conventions: ConventionArgs,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<()> {
    let mut failed = 0;
    if args.table {
        println!("{:<34} {:>7} {:>6} {:>8}  off", "file", "samples", "angles", "left out");
    }
    for file in &args.files {
        if let Err(error) = look_at(args, file) {
            if args.files.len() == 1 {
                return Err(error);
            }
            eprintln!("srbf: {error:#}");
            failed += 1;
        }
    }
    if failed > 0 {
        bail!("{failed} of {} files cannot be read", args.files.len());
    }
    Ok(())
}

/// Samples that a measurement without samples is looked at by.
const SAMPLED: usize = 1500;

/// Cosine of the directions that are left out there: tables are extrapolated within 5 degrees of the horizon.
const GRAZING: f64 = 0.087;

/// The look at a measurement; one with a value for every pair of directions is sampled first.
///
/// # Errors
/// Names the file. Anisotropic ones have no samples.
pub fn looked_at(source: Source) -> anyhow::Result<Look> {
    let Source { content, name, intake, completion, .. } = source;
    let (intake, table) = match (intake, content) {
        (Some(intake), Content::Samples(table)) => (intake, table),
        (Some(intake), Content::Evaluable(_)) => return Ok(Look::new(&intake, completion.as_ref())),
        (_, Content::Samples(_)) => bail!("{name}: samples without lines"),
        (_, Content::Evaluable(brdf)) => {
            let text = export::csv(&export::sampled(brdf.as_ref())?, None);
            let mut intake = csv::parse(text.as_bytes(), &Conventions::default())?;
            intake.rows.retain(|row| row.wi[2].min(row.wo[2]) > GRAZING);
            let every = intake.rows.len().div_ceil(SAMPLED);
            intake.rows = intake.rows.into_iter().step_by(every).collect();
            let table = Table::from_scattered(intake.views())?;
            (intake, table)
        }
    };
    Ok(Look::new(&intake, Some(&complete(&table)?.report)))
}

/// Prints the line of a table.
fn print_line(source: Source) -> anyhow::Result<()> {
    let name = source.name.clone();
    let is_sampled = matches!(source.content, Content::Evaluable(_));
    let look = looked_at(source)?;
    // A table's own values are all kept, and near a narrow highlight one of a few samples may look wrong.
    let is_of_file = |f: &&Finding| f.is_off && !(is_sampled && f.topic == Topic::Outliers);
    let off: Vec<&str> = look.findings.iter().filter(is_of_file).map(|f| f.text.as_str()).collect();
    let left_out: usize = look.left_out.iter().map(|left| left.count).sum();
    let off = if off.is_empty() { "-".to_owned() } else { off.join(" | ") };
    println!("{name:<34} {:>7} {:>6} {left_out:>8}  {off}", look.samples, look.views.len());
    Ok(())
}

fn look_at(args: &Args, file: &Path) -> anyhow::Result<()> {
    let source = read_with(file, &args.conventions.conventions())?;
    if args.table {
        return print_line(source);
    }
    let Some(intake) = &source.intake else {
        if args.json {
            data(&format!("{}\n", serde_json::json!({"name": source.name, "samples": null})));
        } else {
            println!(
                "{}: a value for every pair of directions; nothing has to be taken for granted",
                source.name
            );
        }
        return Ok(());
    };
    let completion = match &source.content {
        Content::Samples(table) if !args.quick => Some(complete(table)?.report),
        Content::Samples(_) => None,
        Content::Evaluable(_) => source.completion.clone(),
    };
    let look = Look::new(intake, completion.as_ref());
    if args.json {
        data(&format!("{:#}\n", look.to_json()));
    } else {
        println!("{}", file.display());
        print(&look, true, &[]);
    }
    Ok(())
}

/// Prints the findings but for those that a verdict says again; without `all`, no fact that has no bearing on the fit.
pub fn print(look: &Look, all: bool, verdict: &[String]) {
    println!("data  {}", look.summary());
    for finding in &look.findings {
        use Topic::{Isotropy, Reciprocity, Stated};
        if !all && !finding.is_off && matches!(finding.topic, Isotropy | Reciprocity | Stated) {
            continue;
        }
        // The verdict says it again.
        if verdict.iter().any(|line| line.ends_with(&finding.text)) {
            continue;
        }
        let mark = if finding.is_off { "check" } else { "note " };
        let option = finding.option.map_or_else(String::new, |option| format!(" ({option})"));
        println!("{mark} {}{option}", finding.text);
    }
}
