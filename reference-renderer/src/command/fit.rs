//! `srbf fit`.

mod lobes_table;
mod method;
mod survey;

use anyhow::{Context, ensure};
use indicatif::{ProgressBar, ProgressStyle};
use method::MethodName;
use srbf_core::Material;
use srbf_fit::reciprocity::reciprocity;
use srbf_fit::report::{Input, Report, ViewReport, mean_error};
use srbf_fit::table::{Content, Source};
use srbf_fit::{Fit, Settings, TrackedLobes};
use std::path::{Path, PathBuf};

/// Fits a measured BRDF file and writes a .srbf material, with a report in JSON beside it.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The measured BRDF: .brdf or .astm (Cornell), .binary (MERL), .bsdf (RGL), or our own .csv; or an analytic model.
    ///
    /// Models are named model:NAME:KEY=VALUE,KEY=VALUE: model:lambert:albedo=0.6/0.2/0.1,
    /// model:phong:diffuse=0.3,specular=0.3,exponent=50, model:ward:diffuse=0.2,specular=0.3,alpha_x=0.1,alpha_y=0.4,
    /// model:ggx:alpha=0.2,ior=1.5 (or f0=0.9; alpha_x and alpha_y; diffuse), and the fits of MERL materials
    /// model:sgd:name=gold-metallic-paint and model:abc:name=..., from file=PATH or the folder that SRBF_DATA_DIR names.
    #[arg(required_unless_present = "survey", value_name = "FILE|MODEL", verbatim_doc_comment)]
    file: Option<PathBuf>,
    /// The file to write; by default the name of the input, with .srbf, in out/. Methods other than ours write JSON only: a
    /// .srbf file holds tracked lobes.
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// The way of fitting.
    #[arg(long, value_enum, default_value_t)]
    method: MethodName,
    /// The file holds published Lafortune fits (lafortune_fits.csv); this is the one that is taken as the measurement.
    #[arg(long, value_name = "NAME")]
    material: Option<String>,
    /// Writes nothing, and prints the error over samples and over views that were left out of the fit.
    #[arg(long, conflicts_with_all = ["survey", "output"])]
    cross_validate: bool,
    /// Instead of a material, writes a table and a plot: error, bytes and run time against the number of lobes.
    #[arg(long, conflicts_with_all = ["survey", "cross_validate", "error", "lobes"])]
    lobes_table: bool,
    #[command(flatten)]
    settings: SettingArgs,
    #[command(flatten)]
    survey: survey::Args,
}

/// Lobes that `--error` may use.
const MOST_LOBES: usize = 32;

/// Settings of a fit on the command line.
#[derive(Debug, clap::Args)]
pub struct SettingArgs {
    /// Lobes of every view, 1 to 64.
    #[arg(long)]
    lobes: Option<usize>,
    /// Mean relative L2 error in per cent that is asked for: the fewest lobes that reach it are used, at most --lobes or 32.
    #[arg(long, value_name = "PER_CENT")]
    error: Option<f64>,
    /// How many of the lobes are squeezed across the plane of incidence.
    #[arg(long)]
    squeezed: Option<usize>,
    /// How many pairs of the lobes are mirrored in the plane of incidence.
    #[arg(long, value_name = "PAIRS")]
    mirrored: Option<usize>,
    /// Weight of the smoothness from view to view.
    #[arg(long)]
    smoothness: Option<f64>,
    /// Starting points that are tried.
    #[arg(long)]
    starts: Option<usize>,
    /// Most steps of the solver in the refinement.
    #[arg(long)]
    steps: Option<usize>,
    /// Most times that a lobe is exchanged, in all stages.
    #[arg(long)]
    exchanges: Option<usize>,
    /// Views of the material, placed where it changes; for files that have a value for every pair of directions. With lobes in
    /// mirrored pairs, as many more as take the same bytes.
    #[arg(long)]
    views: Option<usize>,
}

impl SettingArgs {
    fn settings(&self) -> Settings {
        let default = Settings::default();
        let lobes = self.lobes.unwrap_or(if self.error.is_some() { MOST_LOBES } else { default.lobes });
        Settings {
            lobes,
            error: self.error.map(|per_cent| per_cent / 100.0),
            squeezed: self.squeezed,
            mirrored: self.mirrored,
            smoothness: self.smoothness.unwrap_or(default.smoothness),
            starts: self.starts.unwrap_or(default.starts),
            steps: self.steps.unwrap_or(default.steps),
            exchanges: self.exchanges.unwrap_or(default.exchanges),
            views: self.views.unwrap_or(default.views),
            ..default
        }
    }
}

/// Runs the command.
pub fn run(args: Args) -> anyhow::Result<()> {
    if args.survey.is_asked_for() {
        return survey::run(&args.settings, &args.survey);
    }
    let file = args.file.context("a file is needed")?;
    let source = method::read(&file, args.material.as_deref())?;
    let scattered = matches!(source.content, Content::Samples(_));
    ensure!(
        !(scattered && args.settings.views.is_some()),
        "{}: --views is for what can be evaluated anywhere; these samples have views of their own",
        file.display()
    );
    if args.cross_validate {
        return cross_validate(&file, &source.content, args.method, &args.settings);
    }
    if args.lobes_table {
        return lobes_table::run(&file, &args.settings.settings());
    }
    let name = match &args.material {
        Some(name) => name.into(),
        None if file.to_string_lossy().starts_with(srbf_fit::table::model::PREFIX) => {
            source.name.clone().into()
        }
        None => file.file_stem().context("the file has no name")?.to_owned(),
    };
    let output = args.output.unwrap_or_else(|| Path::new("out").join(name).with_extension("srbf"));
    let beside = output.with_extension("json");
    if args.method != MethodName::Tracked {
        let fit = method::fit(&source, args.method, &args.settings)?;
        srbf_fit::write_atomically(&beside, fit.json.as_bytes())?;
        print_report(&fit.report);
        println!("{} in {:.2} s", beside.display(), fit.report.seconds);
        return Ok(());
    }
    let input = Input { name: source.name.clone(), sha256: source.sha256.clone() };
    let fit = fit_source(source, args.settings.settings(), "")?;
    srbf_fit::write_atomically(&output, &fit.bytes)?;
    let json = fit.report.to_json(&Material::from_bytes(&fit.bytes)?, &input)?;
    srbf_fit::write_atomically(&beside, json.as_bytes())?;
    print_report(&fit.report);
    let found = reciprocity(&TrackedLobes { bytes: fit.bytes.clone() })?;
    println!(
        "reciprocity error |ln f(a, b) / f(b, a)|: median {:.3}, worst {:.3}, {} pairs; {} evaluations",
        found.median, found.worst, found.pairs, fit.report.evaluations
    );
    println!("{}: {} bytes in {:.2} s", output.display(), fit.bytes.len(), fit.report.seconds);
    Ok(())
}

fn cross_validate(
    file: &Path,
    content: &Content,
    method: MethodName,
    settings: &SettingArgs,
) -> anyhow::Result<()> {
    let Content::Samples(table) = content else {
        anyhow::bail!(
            "{}: fits of what can be evaluated anywhere report held-out views as they are",
            file.display()
        );
    };
    let found = method.with(settings, |method| srbf_fit::cross::cross_validate(table, method))??;
    let mean = |errors: &[f64]| 100.0 * errors.iter().sum::<f64>() / errors.len().max(1) as f64;
    let list =
        |errors: &[f64]| errors.iter().map(|e| format!("{:.1}", 100.0 * e)).collect::<Vec<_>>().join(" ");
    let left_out: Vec<f64> = found.left_out.iter().map(|v| v.1).collect();
    println!(
        "relative L2 over samples left out, 5 folds: mean {:.2} %; views: {}",
        mean(&found.folds),
        list(&found.folds)
    );
    println!(
        "relative L2 of views left out: mean {:.2} %; inner views: {}",
        mean(&left_out),
        list(&left_out)
    );
    Ok(())
}

/// Reads and fits one file, with a progress bar; `source` says in the provenance where it comes from.
pub fn fit_file(file: &Path, settings: Settings, source: &str) -> anyhow::Result<Fit> {
    fit_source(srbf_fit::table::read(file)?, settings, source)
}

fn fit_source(read: Source, mut settings: Settings, source: &str) -> anyhow::Result<Fit> {
    settings.provenance = format!("{source}{}, SHA-256 {}\n", read.name, read.sha256);

    // indicatif draws nothing where standard error is not a terminal.
    let bar = ProgressBar::new(1000).with_message(read.name);
    bar.set_style(ProgressStyle::with_template("{msg} [{bar:40}] {percent} %")?);
    let fit =
        srbf_fit::fit_content(&read.content, &settings, |share| bar.set_position((1000.0 * share) as u64));
    bar.finish_and_clear();
    Ok(fit?)
}

/// Prints a report, a line a view.
pub fn print_report(report: &Report) {
    let isotropic = report.views.iter().all(|v| v.azimuth == 0.0);
    let azimuth = if isotropic { "" } else { "azimuth | " };
    println!("view deg | {azimuth}relative L2 % | variance | largest weight | albedo r g b, fit (data)");
    // A method that does not sample has no variance, and no weight.
    let number = |v: f64, width: usize, digits: usize| {
        if v.is_nan() { format!("{:>width$}", "-") } else { format!("{v:width$.digits$}") }
    };
    let print = |v: &ViewReport| {
        let albedo = [0, 1, 2].map(|c| format!("{:.3} ({:.3})", v.albedo[c], v.data_albedo[c]));
        let azimuth = match isotropic {
            true => String::new(),
            false => format!("{:7.1} | ", v.azimuth.to_degrees()),
        };
        println!(
            "{:8.1} | {azimuth}{:13.2} | {} | {} | {}",
            v.theta.to_degrees(),
            100.0 * v.error,
            number(v.variance, 8, 3),
            number(v.largest_weight, 14, 2),
            albedo.join("  ")
        );
    };
    report.views.iter().for_each(print);
    if !report.held_out.is_empty() {
        println!("held out, between the knots:");
        report.held_out.iter().for_each(print);
        println!("mean relative L2 held out {:.2} %", 100.0 * mean_error(&report.held_out));
    }
    println!("mean relative L2 {:.2} %", 100.0 * report.mean_error());
}
