//! `srbf fit`.

mod method;
pub mod names;
mod picture;
mod settings;
pub mod sheet;
mod words;

use super::convention_args::ConventionArgs;
use super::fit_page;
use crate::out::output;
use crate::out::print::{is_quiet, shown};
use crate::out::progress::Progress;
use anyhow::{anyhow, bail, ensure};
use method::MethodName;
use names::Job;
pub use settings::SettingArgs;
use srbf_core::Material;
use srbf_fit::complete::complete;
use srbf_fit::judge::cross::{CrossValidation, cross_validate};
use srbf_fit::judge::method::Method;
use srbf_fit::judge::report::Input;
use srbf_fit::read::{Content, Source, sheet_of};
use srbf_fit::table::Symmetry;
use srbf_fit::{Fit, Settings};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Fits measured BRDFs: writes .srbf materials, with a picture and a report in JSON beside each.
///
/// Prints criteria that are good, criteria that are off, advice, and the files that were written. The exit status is 2 if a file could not be fitted;
/// of several files the others are fitted all the same.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Measured BRDFs, or analytic models: tables of text (CSV) in any usual layout, and files of Cornell, MERL, RGL, Zemax,
    /// LightTools, SPEOS, OpenMATERIAL, ALTA, pgII, SSDD, WINDOW (XML, a sheet). See docs/csv.md.
    ///
    /// Models are named model:NAME:KEY=VALUE,KEY=VALUE: model:lambert:albedo=0.6/0.2/0.1,
    /// model:phong:diffuse=0.3,specular=0.3,exponent=50, model:ward:diffuse=0.2,specular=0.3,alpha_x=0.1,alpha_y=0.4,
    /// model:ggx:alpha=0.2,ior=1.5 (or f0=0.9; alpha_x and alpha_y; diffuse), and the fits of MERL materials
    /// model:sgd:name=gold-metallic-paint and model:abc:name=..., from file=PATH or the folder that SRBF_DATA_DIR names.
    #[arg(required = true, value_name = "FILE|MODEL")]
    files: Vec<PathBuf>,
    /// The file to write, or the folder: a name that ends in `/`, and any name if there are several inputs
    /// [default: out/NAME.srbf, NAME being that of the input, of a model with its parameters].
    ///
    /// Methods other than ours write JSON only, NAME-METHOD.json if -o does not end in .json: a .srbf file holds tracked lobes.
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// The way of fitting.
    #[arg(long, value_enum, default_value_t)]
    method: MethodName,
    /// The file holds published Lafortune fits (lafortune_fits.csv); this is the one that is taken as the measurement.
    #[arg(long, value_name = "NAME")]
    material: Option<String>,
    /// Also fits without parts of the samples and without whole views, prints the error there, and puts it
    /// into the report.
    #[arg(long)]
    cross_validate: bool,
    /// Fits all quarters of samples of a sheet: reflection and transmission, in front and behind, whose rows are told apart by their
    /// directions. A file of a window is fitted so without it.
    #[arg(long, conflicts_with = "quarter")]
    sheet: bool,
    #[command(flatten)]
    conventions: ConventionArgs,
    #[command(flatten)]
    picture: picture::Args,
    #[command(flatten)]
    settings: SettingArgs,
    #[command(flatten)]
    words: words::Args,
}

/// Runs the command.
pub fn run(args: Args) -> anyhow::Result<()> {
    let places = names::places(&args.files, args.output.as_deref(), args.material.as_deref(), args.method)?;
    let pictures = args.picture.paths(&places, args.method)?;
    let mut failed = 0;
    for (n, (place, picture)) in places.iter().zip(&pictures).enumerate() {
        if n > 0 {
            args.words.say_next_file();
        }
        let done = fit_one(&args, place, picture.as_deref());
        match done {
            Err(error) if places.len() > 1 => {
                eprintln!("srbf: {}", naming(&place.file, &error));
                failed += 1;
            }
            done => done.map_err(|error| anyhow!(naming(&place.file, &error)))?,
        }
    }
    ensure!(failed == 0, "{failed} of {} files were not fitted", places.len());
    Ok(())
}

/// Fits a file, with the picture and the report that are asked for.
fn fit_one(args: &Args, place: &Job, picture: Option<&Path>) -> anyhow::Result<()> {
    let file = &place.file;
    let conventions = args.conventions.conventions();
    if args.conventions.is_of_all_quarters()
        && let Some(sheet) = sheet_of(file, &conventions, args.sheet)?
    {
        return sheet::fit(args, place, picture, sheet);
    }
    ensure!(!args.sheet, "{}: --sheet: a file is expected; a model has one material", shown(file));
    let source = method::read(file, args.material.as_deref(), &conventions)?;
    check_options(file, &source.content, &args.settings)?;
    // After the file, which is named first where memory is short.
    let light = picture.map(|_| args.picture.light()).transpose()?;
    let is_model = file.to_string_lossy().starts_with(srbf_fit::analytic::PREFIX);
    let named = if is_model { shown(file) } else { source.name.clone() };
    let input = Input { name: named, sha256: source.sha256.clone() };
    let left_out = left_out(args.cross_validate, file, &source.content, args.method, &args.settings)?;
    if args.method != MethodName::Tracked {
        let fit = method::fit(&source, &input, args.method, &args.settings, left_out)?;
        output::write(&place.output, fit.json.as_bytes())?;
        return args.words.say_baseline(place, &fit);
    }
    let settings = args.settings.settings();
    let mut fit = fit_source(&source, settings.clone(), "")?;
    fit.report.cross_validation = left_out;
    let files = output::together();
    output::write(&place.output, &fit.bytes)?;
    let material = Material::from_bytes(fit.bytes.as_slice())?;
    let json = fit.report.to_json(&material, &input, &settings)?;
    output::write(&names::report(&place.output), json.as_bytes())?;

    let words = args.words.say_fit(place, &fit.report, &material, &json)?;
    let page = picture.and_then(|picture| args.picture.page(picture));
    if let Some(path) = &page {
        let name = &place.output.file_stem().unwrap_or_default().to_string_lossy();
        let opened = fit_page::opened(name, &fit.bytes, Some(&fit.report), Some(&source.content))?;
        fit_page::write(path, opened, &words)?;
    }
    if let Some((path, light)) = picture.zip(light) {
        args.picture.write(path, &place.output, &light, (fit.bytes.clone(), source), &words)?;
    }
    files.commit()?;
    args.words.say_written(place, [picture, page.as_deref()], &words::next(&place.output));
    Ok(())
}

/// An error with the file that it is of; most name it themselves.
fn naming(file: &Path, error: &anyhow::Error) -> String {
    let (file, text) = (shown(file), format!("{error:#}"));
    if text.contains(&file) { text } else { format!("{file}: {text}") }
}

/// Refuses options that the fit of such a content would ignore.
fn check_options(file: &Path, content: &Content, settings: &SettingArgs) -> anyhow::Result<()> {
    match content {
        Content::Evaluable(brdf) if brdf.symmetry() != Symmetry::Isotropic => {
            let given =
                [("--exchanges", settings.exchanges.is_some()), ("--mirrored", settings.mirrored.is_some())];
            if let Some((option, _)) = given.iter().find(|option| option.1) {
                bail!("{}: {option} is for isotropic surfaces; this one is anisotropic", shown(file));
            }
        }
        Content::Samples(_) | Content::Evaluable(_) => {}
    }
    Ok(())
}

/// Errors over data that is left out of the fit, if they are asked for. Samples that all others contradict are in no part of it.
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
            let table = complete(table)?.without_outliers(table)?;
            let progress = Progress::of_shares(&format!("left out of {}", shown(file)));
            let (start, is_told) = (Instant::now(), AtomicBool::new(false));
            let ended = |share: f64| {
                progress.set_share(share);
                if !is_told.swap(true, Ordering::Relaxed) {
                    say_time_left(file, share, start.elapsed().as_secs_f64());
                }
            };
            let left_out = |method: &dyn Method| cross_validate(&table, method, ended);
            Ok(Some(method.with(settings, left_out)??))
        }
        Content::Evaluable(_) => bail!(
            "{}: --cross-validate is for samples; fits of a BRDF report held-out views anyway",
            shown(file)
        ),
    }
}

/// After the first of the fits that a cross-validation makes, says how long the others take, unless that is less than `SHORT` seconds. `share`: one
/// over their number.
fn say_time_left(file: &Path, share: f64, seconds: f64) {
    /// Nobody is told about less.
    const SHORT: f64 = 10.0;
    let side_by_side = rayon::current_num_threads() as f64;
    let rounds = (1.0 / (share * side_by_side)).ceil();
    let left = seconds * (rounds - 1.0);
    if left > SHORT && !is_quiet() {
        eprintln!("{}: {:.0} fits of parts of the samples take {left:.0} s more", shown(file), 1.0 / share);
    }
}

/// Reads and fits one file, with a progress bar; `source` says in the provenance where it comes from.
pub fn fit_file(file: &Path, settings: Settings, source: &str) -> anyhow::Result<Fit> {
    fit_source(&srbf_fit::read::read(file)?, settings, source)
}

fn fit_source(read: &Source, mut settings: Settings, source: &str) -> anyhow::Result<Fit> {
    settings.provenance = format!("{source}{}, SHA-256 {}\n", read.name, read.sha256);
    let progress = Progress::of_shares(&read.name);
    Ok(srbf_fit::fit_source(read, &settings, |share| progress.set_share(share))?)
}
