//! `srbf-lab thesis-table`: Table 5.1 of the thesis, with our fit beside its two, and the error of each on left-out data.

use anyhow::{Context, bail};
use srbf_fit::judge::compare::{Score, score};
use srbf_fit::judge::cross::CrossValidation;
use srbf_fit::judge::method::Method;
use srbf_fit::read::{Content, read};
use srbf_fit::table::Brdf;
use srbf_fit::table::Table;
use srbf_fit::{Settings, Tracked};
use srbf_reference_renderer::command::argument;
use srbf_reference_renderer::out::output;
use srbf_reference_renderer::out::progress::Progress;
use srbf_thesis::lafortune;
use srbf_thesis::thesis;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Makes Table 5.1 of the thesis: the best Lafortune fit of 100 starts, the thesis's method, and ours.
///
/// For garnet red, krylon blue and cayman as Cornell measured them, and blue paint through its published Lafortune fit, which
/// stands for the measurement (so that a Lafortune fit of it has no error). SRBF_DATA_DIR names the folder of the data.
/// Errors are relative L2 over samples and channels by solid angle: of f cos, mean over the views, which all three are judged by;
/// the same of f alone, which the thesis's method makes small; of f cos over all views as one; over samples left out of the fit, a
/// fifth at a time; and over inner views left out whole.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Lobes of our fit and of the thesis's.
    #[arg(long, default_value_t = 12, value_parser = clap::value_parser!(u32).range(1..=64))]
    lobes: u32,
    /// Only the materials whose names contain this.
    #[arg(long, value_name = "NAME")]
    only: Option<String>,
    /// Without the errors on left-out data: a twelfth of the time.
    #[arg(long)]
    no_held_out: bool,
    /// The table to write, .md; the numbers go beside it as .csv.
    #[arg(short, long, default_value = "out/thesis-table.md", value_name = "FILE")]
    output: PathBuf,
}

impl Args {
    /// All materials or one, without the errors on left-out data.
    pub fn new(only: Option<String>, output: PathBuf) -> Self {
        Self { lobes: 12, only, no_held_out: true, output }
    }
}

/// Name, and the thesis's own figures in percent: Lafortune, its method.
const MATERIALS: [(&str, [f64; 2]); 4] = [
    ("garnet_red", [7.6, 4.0]),
    ("krylon_blue", [10.0, 5.9]),
    ("cayman", [19.0, 5.9]),
    ("blue_paint", [32.0, 14.0]),
];

/// Angles at which Cornell measured blue paint, degrees.
const BLUE_PAINT_VIEWS: [f64; 7] = [0.0, 20.0, 35.0, 55.0, 65.0, 75.0, 85.0];

/// Runs the command.
pub fn run(args: Args) -> anyhow::Result<()> {
    output::check_extension(&args.output, "md")?;
    output::check_places(&[&args.output, &args.output.with_extension("csv")])?;
    let data = argument::data_folder()?;
    let methods = Methods::new(args.lobes as usize);
    let methods = methods.all();
    let chosen: Vec<_> =
        MATERIALS.iter().filter(|m| args.only.as_ref().is_none_or(|only| m.0.contains(only))).collect();
    if chosen.is_empty() {
        bail!("no material whose name contains `{}`", args.only.unwrap_or_default());
    }

    let mut markdown = String::from(
        "| material | method | lobes | f cos % | f % | f cos, whole % | 5 folds % | view left out % | s | the thesis says % |\n\
         |---|---|---|---|---|---|---|---|---|---|\n",
    );
    let mut csv = String::from(
        "material,method,lobes,f_cos,f,f_cos_whole,held_out_samples,held_out_views,seconds,thesis_says\n",
    );
    println!("processor: {}", srbf_core::Processor::this());
    print!("{markdown}");
    let progress = Progress::new("Table 5.1", (chosen.len() * methods.len()) as u64);
    for (material, said) in chosen {
        let table = table(&data, material)?;
        for (column, (method, lobes, run)) in methods.iter().enumerate() {
            let found = score(&table, run.as_ref(), !args.no_held_out)
                .with_context(|| format!("material {material}, method {method}"))?;
            let said = said.get(column).copied();
            let line = row(material, method, *lobes, &found, said);
            println!("{line}");
            writeln!(markdown, "{line}")?;
            writeln!(csv, "{}", csv_row(material, method, *lobes, &found, said))?;
            // After every row, so that a run that is stopped leaves its results.
            output::write(&args.output, markdown.as_bytes())?;
            output::write(&args.output.with_extension("csv"), csv.as_bytes())?;
            progress.advance(1);
        }
    }
    println!("{}", args.output.display());
    Ok(())
}

/// The three methods with their settings.
struct Methods {
    ours: Settings,
    thesis: thesis::ThesisSettings,
    lafortune: lafortune::LafortuneSettings,
}

/// A method and how many lobes it has; ours is made with its settings.
type Column<'a> = (&'static str, usize, Box<dyn Method + 'a>);

impl Methods {
    fn new(lobes: usize) -> Self {
        Self {
            ours: Settings { lobes, ..Settings::default() },
            thesis: thesis::ThesisSettings { lobes, ..thesis::ThesisSettings::default() },
            lafortune: lafortune::LafortuneSettings::default(),
        }
    }

    fn all(&self) -> [Column<'_>; 3] {
        [
            ("Lafortune", self.lafortune.lobes, Box::new(self.lafortune)),
            ("thesis", self.thesis.lobes, Box::new(self.thesis)),
            ("ours", self.ours.lobes, Box::new(Tracked(&self.ours))),
        ]
    }
}

/// Material, method, and errors of fits to all samples, without those of left-out ones: the whole table, with 12 lobes.
///
/// # Errors
/// Data that cannot be read.
pub fn scores(data: &Path) -> anyhow::Result<Vec<(&'static str, &'static str, Score)>> {
    let methods = Methods::new(12);
    let mut scores = Vec::new();
    for (material, _) in MATERIALS {
        let table = table(data, material)?;
        for (name, _, method) in methods.all() {
            scores.push((material, name, score(&table, method.as_ref(), false)?));
        }
    }
    Ok(scores)
}

/// Means of the held-out errors over the views, of samples and of views.
fn held_out(found: &Score) -> [Option<f64>; 2] {
    found.held_out.as_ref().map_or([None; 2], CrossValidation::means)
}

fn row(material: &str, method: &str, lobes: usize, found: &Score, said: Option<f64>) -> String {
    let percent = |v: Option<f64>| v.map_or_else(|| "-".to_owned(), |v| format!("{:.2}", 100.0 * v));
    let [samples, views] = held_out(found);
    let said = said.map_or_else(|| "-".to_owned(), |v| v.to_string());
    format!(
        "| {material} | {method} | {lobes} | {} | {} | {} | {} | {} | {:.1} | {said} |",
        percent(Some(found.mean)),
        percent(Some(found.mean_of_f)),
        percent(Some(found.whole)),
        percent(samples),
        percent(views),
        found.seconds
    )
}

fn csv_row(material: &str, method: &str, lobes: usize, found: &Score, said: Option<f64>) -> String {
    let number = |v: Option<f64>| v.map_or_else(String::new, |v| format!("{v:.6}"));
    let [samples, views] = held_out(found);
    format!(
        "{material},{method},{lobes},{:.6},{:.6},{:.6},{},{},{:.3},{}",
        found.mean,
        found.mean_of_f,
        found.whole,
        number(samples),
        number(views),
        found.seconds,
        number(said.map(|v| v / 100.0))
    )
}

/// The samples of a material.
fn table(data: &Path, material: &str) -> anyhow::Result<Table> {
    if material != "blue_paint" {
        let path = data.join("cornell").join(material).with_extension("brdf");
        let Content::Samples(table) = read(&path)?.content else { bail!("{}: no samples", path.display()) };
        return Ok(table);
    }
    let path = data.join("cornell/lafortune_fits.csv");
    let Content::Evaluable(model) = lafortune::read(&path, "bluepaint")?.content else {
        bail!("{}: no model", path.display())
    };
    Ok(as_measured(model.as_ref())?)
}

/// Samples where Cornell measured blue paint: 7 outgoing directions, 19 by 73 incident ones, of which half mirror the others.
fn as_measured(model: &dyn Brdf) -> Result<Table, srbf_fit::FitError> {
    let view = |degrees: f64| {
        let theta = degrees.to_radians();
        let wo = [-theta.sin(), 0.0, theta.cos()];
        let mut samples = Vec::new();
        for t in 0..18 {
            // At the normal all azimuths are one direction.
            for p in 0..if t == 0 { 1 } else { 37 } {
                let (theta, phi) = (f64::from(5 * t).to_radians(), f64::from(5 * p).to_radians());
                let wi = [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()];
                samples.push((wi, model.evaluate(wi, wo)));
            }
        }
        (theta, samples)
    };
    Table::from_scattered(BLUE_PAINT_VIEWS.map(view).to_vec())
}
