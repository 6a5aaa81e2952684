//! `srbf fit`.

mod lobes_table;
mod method;
mod names;
mod picture;
mod survey;

use super::view_table;
use crate::output;
use anyhow::{Context, bail};
use indicatif::{ProgressBar, ProgressStyle};
use method::MethodName;
use srbf_core::Material;
use srbf_fit::judge::cross::CrossValidation;
use srbf_fit::judge::method::Fitted;
use srbf_fit::judge::reciprocity::reciprocity;
use srbf_fit::judge::report::{Input, Report, mean_error};
use srbf_fit::read::{Content, Source};
use srbf_fit::table::Symmetry;
use srbf_fit::{FactorNodes, Fit, Settings};
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
    /// The file to write; by default the name of the input, a model's with its parameters, with .srbf, in out/. Methods other
    /// than ours write JSON only, NAME-METHOD.json if -o does not end in .json: a .srbf file holds tracked lobes.
    #[arg(short, long, conflicts_with = "survey")]
    output: Option<PathBuf>,
    /// The way of fitting.
    #[arg(long, value_enum, default_value_t, conflicts_with = "survey")]
    method: MethodName,
    /// The file holds published Lafortune fits (lafortune_fits.csv); this is the one that is taken as the measurement.
    #[arg(long, value_name = "NAME", conflicts_with = "survey")]
    material: Option<String>,
    /// Also fits without parts of the samples and without whole views, prints the error over what was left out, and puts it
    /// into the report.
    #[arg(long, conflicts_with = "survey")]
    cross_validate: bool,
    /// Instead of a material, writes a table and a plot: error, bytes and run time against the number of lobes.
    #[arg(long, conflicts_with_all = ["survey", "cross_validate", "error", "lobes", "method", "output"])]
    lobes_table: bool,
    #[command(flatten)]
    picture: picture::Args,
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
    /// Most times that a lobe is exchanged, in each of the stages that do so.
    #[arg(long)]
    exchanges: Option<usize>,
    /// Views of the material, placed where it changes. By default 15, with
    /// 6 to 11 lobes as many more as take the bytes of 12. With lobes in mirrored pairs, as many more as take the same bytes.
    #[arg(long)]
    views: Option<usize>,
    /// The table of factors over half angle and difference angle that the lobes are multiplied by, `24x10` for example: `none`, or
    /// by default what it gains decides.
    #[arg(long, value_name = "NODES", value_parser = factor_nodes)]
    factors: Option<FactorNodes>,
}

/// Reads `none`, `chosen` or two numbers of nodes.
fn factor_nodes(text: &str) -> Result<FactorNodes, String> {
    let given = || {
        let (half, difference) = text.split_once('x')?;
        Some(FactorNodes::Given([half.parse().ok()?, difference.parse().ok()?]))
    };
    match text {
        "none" => Ok(FactorNodes::None),
        "chosen" => Ok(FactorNodes::Chosen),
        _ => given().ok_or_else(|| "expected `none`, `chosen`, or numbers of nodes as in 24x10".into()),
    }
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
            views: self.views,
            factors: self.factors.unwrap_or(default.factors),
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
    check_options(&file, &source.content, &args.settings)?;
    let name = names::stem(&file, args.material.as_deref())?;
    if args.lobes_table {
        return lobes_table::run(&source, &name.to_string_lossy(), &args.settings.settings());
    }
    let is_model = file.to_string_lossy().starts_with(srbf_fit::analytic::PREFIX);
    let named = if is_model { file.display().to_string() } else { source.name.clone() };
    let input = Input { name: named, sha256: source.sha256.clone() };
    if args.method != MethodName::Tracked {
        args.picture.check(&file, args.method)?;
        let path = names::baseline(args.output, &name, args.method);
        output::check_place(&path)?;
        let left_out = left_out(args.cross_validate, &file, &source.content, args.method, &args.settings)?;
        let fit = method::fit(&source, &input, args.method, &args.settings, left_out)?;
        srbf_fit::write_atomically(&path, fit.json.as_bytes())?;
        println!("{} in {:.2} s", path.display(), fit.report.seconds);
        print_report(&fit.report, fit.fitted.as_ref(), None)?;
        return Ok(());
    }
    let output = names::material(args.output, &name)?;
    output::check_places(&[&output, &names::report(&output)])?;
    let picture = args.picture.check(&output, args.method)?;
    let settings = args.settings.settings();
    let left_out = left_out(args.cross_validate, &file, &source.content, args.method, &args.settings)?;
    let mut fit = fit_source(&source, settings.clone(), "")?;
    fit.report.cross_validation = left_out;
    srbf_fit::write_atomically(&output, &fit.bytes)?;
    let material = Material::from_bytes(fit.bytes.as_slice())?;
    let json = fit.report.to_json(&material, &input, &settings)?;
    srbf_fit::write_atomically(&names::report(&output), json.as_bytes())?;
    println!(
        "{}: {} bytes in {:.2} s, {} evaluations",
        output.display(),
        fit.bytes.len(),
        fit.report.seconds,
        fit.report.evaluations
    );
    let verdict = print_report(&fit.report, &material, Some(&material))?;
    picture.map_or(Ok(()), |picture| picture.write(&output, fit.bytes, source, &verdict))
}

/// Refuses options that the fit of such a content would ignore.
fn check_options(file: &Path, content: &Content, settings: &SettingArgs) -> anyhow::Result<()> {
    match content {
        Content::Evaluable(brdf) if brdf.symmetry() != Symmetry::Isotropic => {
            let given = [
                ("--views", settings.views.is_some()),
                ("--exchanges", settings.exchanges.is_some()),
                ("--mirrored", settings.mirrored.is_some()),
                ("--factors", settings.factors.is_some()),
            ];
            if let Some((option, _)) = given.iter().find(|option| option.1) {
                bail!("{}: {option} is for isotropic surfaces; this one is anisotropic", file.display());
            }
        }
        Content::Samples(_) | Content::Evaluable(_) => {}
    }
    Ok(())
}

/// Errors over what is left out of the fit, if they are asked for.
fn left_out(
    is_asked_for: bool,
    file: &Path,
    content: &Content,
    method: MethodName,
    settings: &SettingArgs,
) -> anyhow::Result<Option<CrossValidation>> {
    match content {
        _ if !is_asked_for => Ok(None),
        Content::Samples(table) => {
            Ok(Some(method.with(settings, |method| srbf_fit::judge::cross::cross_validate(table, method))??))
        }
        Content::Evaluable(_) => bail!(
            "{}: --cross-validate is for samples; fits of what can be evaluated anywhere report held-out views as they are",
            file.display()
        ),
    }
}

/// Reads and fits one file, with a progress bar; `source` says in the provenance where it comes from.
pub fn fit_file(file: &Path, settings: Settings, source: &str) -> anyhow::Result<Fit> {
    fit_source(&srbf_fit::read::read(file)?, settings, source)
}

fn fit_source(read: &Source, mut settings: Settings, source: &str) -> anyhow::Result<Fit> {
    settings.provenance = format!("{source}{}, SHA-256 {}\n", read.name, read.sha256);

    // indicatif draws nothing where standard error is not a terminal.
    let bar = ProgressBar::new(1000).with_message(read.name.clone());
    bar.set_style(ProgressStyle::with_template("{msg} [{bar:40}] {percent} %")?);
    let fit =
        srbf_fit::fit_content(&read.content, &settings, |share| bar.set_position((1000.0 * share) as u64));
    bar.finish_and_clear();
    Ok(fit?)
}

/// Prints a report, a line a view, with the verdict last, and gives the lines of that; `material`: the material, if the method makes one.
fn print_report(
    report: &Report,
    fitted: &dyn Fitted,
    material: Option<&Material<&[u8]>>,
) -> anyhow::Result<Vec<String>> {
    let isotropic = view_table::is_isotropic(report);
    println!("{}", view_table::LEGEND);
    view_table::print_views(&report.views, isotropic);
    println!("mean relative L2 {:.2} %", 100.0 * report.mean_error());
    if !report.held_out.is_empty() {
        let of =
            if report.completion.is_some() { ", against what the samples were completed to" } else { "" };
        println!("held out, between the knots{of}:");
        view_table::print_views(&report.held_out, isotropic);
        println!("mean relative L2 held out {:.2} %", 100.0 * mean_error(&report.held_out));
    }
    if let Some(completion) = &report.completion {
        view_table::print_completion(completion);
    }
    if let Some(found) = &report.cross_validation {
        print_left_out(found);
    }
    Ok(view_table::print_verdict(report, &reciprocity(fitted)?, material))
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
