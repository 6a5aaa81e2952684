//! `cargo lab verdicts`.

use anyhow::Context;
use srbf_core::Material;
use srbf_fit::complete::Gaps;
use srbf_fit::judge::appearance::Appearance;
use srbf_fit::judge::reciprocity::reciprocity;
use srbf_fit::judge::report::{Report, ViewReport};
use srbf_fit::judge::verdict::Verdict;
use srbf_fit::read::merl;
use srbf_fit::read::{Content, Filled, read};
use srbf_fit::table::{Brdf, evaluation_views};
use srbf_fit::{Settings, export, fit_content, view_angles};
use srbf_reference_renderer::command::argument;
use srbf_reference_renderer::numbers::random::Random;
use std::path::{Path, PathBuf};

/// Prints the verdicts of the measured tables of the folder that SRBF_DATA_DIR names, and of three bad tables.
///
/// The bad ones are made here: a MERL file without values beyond a half angle of 30 degrees, noise of 30 % in each of its cells, and a mirror.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Only those whose names contain this
    #[arg(long, value_name = "NAME", default_value = "")]
    only: String,
    /// All lines of each verdict; else its sentence alone
    #[arg(long)]
    all: bool,
    /// A folder of fits of the measured tables that `survey --materials` wrote; else they are fitted
    #[arg(long, value_name = "DIR")]
    materials: Option<PathBuf>,
}

/// The model of the bad tables, and a mirror.
const MODEL: &str = "model:ggx:alpha=0.2,f0=0.9,diffuse=0.1";
const MIRROR: &str = "model:ggx:alpha=0.001,f0=0.9";

/// Cells of a MERL file along the half angle, and of each of those rows; its head; and the bytes of a number.
const ROWS: usize = 90;
const ROW: usize = 90 * 180;
const HEAD: usize = 12;
const NUMBER: usize = 8;

/// The row whose half angle is 30 degrees: they go with the square.
const FAR: usize = 52;

/// Deviation of the noise, over the value.
const NOISE: f64 = 0.3;

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<()> {
    println!("processor: {}", srbf_core::Processor::this());
    for file in crate::survey::rgl_files(&argument::data_folder()?)? {
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let fit = args.materials.as_ref().map(|folder| folder.join(&name).with_extension("srbf"));
        say(args, &name, fit.as_deref(), || Ok(read(&file)?.content))?;
    }
    say(args, "half of it missing", None, || {
        let missing = |bytes: &mut [u8]| {
            for channel in bytes.chunks_exact_mut(NUMBER * ROWS * ROW) {
                let far = &mut channel[NUMBER * ROW * FAR..];
                far.chunks_exact_mut(NUMBER).for_each(|cell| cell.copy_from_slice(&f64::to_le_bytes(-1.0)));
            }
        };
        Ok(Content::Evaluable(Box::new(Filled::new(changed(missing)?)?)))
    })?;
    say(args, "noise of 30 %", None, || {
        let noisy = |bytes: &mut [u8]| {
            let mut random = Random::new(0, 3, 0);
            let mut factors = Vec::with_capacity(ROWS * ROW);
            for _ in 0..ROWS * ROW {
                let (u, v) = (1.0 - f64::from(random.unit()), f64::from(random.unit()));
                let normal = (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos();
                factors.push((NOISE * normal).exp());
            }
            for channel in bytes.chunks_exact_mut(NUMBER * ROWS * ROW) {
                for (cell, factor) in channel.chunks_exact_mut(NUMBER).zip(&factors) {
                    let value = f64::from_le_bytes(cell.try_into().expect("a number"));
                    cell.copy_from_slice(&(factor * value).to_le_bytes());
                }
            }
        };
        Ok(Content::Evaluable(Box::new(changed(noisy)?)))
    })?;
    say(args, "a mirror", None, || Ok(read(Path::new(MIRROR))?.content))
}

/// The model as a MERL file of which the numbers are changed.
fn changed(change: impl Fn(&mut [u8])) -> anyhow::Result<merl::Merl> {
    let Content::Evaluable(model) = read(Path::new(MODEL))?.content else {
        anyhow::bail!("{MODEL} is not a model")
    };
    let model: &(dyn Brdf + Send) = model.as_ref();
    let mut bytes = export::merl(model)?.bytes;
    change(&mut bytes[HEAD..]);
    Ok(merl::parse(&bytes)?)
}

/// Fits a table, or takes its fit from a file, and prints its verdict.
fn say(
    args: &Args,
    name: &str,
    fit: Option<&Path>,
    content: impl Fn() -> anyhow::Result<Content>,
) -> anyhow::Result<()> {
    if !name.contains(&args.only) {
        return Ok(());
    }
    let content = content()?;
    let (bytes, report) = match fit {
        Some(path) => {
            let bytes = std::fs::read(path).with_context(|| path.display().to_string())?;
            let report = judged(&content, &bytes)?;
            (bytes, report)
        }
        None => {
            let fit = fit_content(&content, &Settings::default(), |_| {}).with_context(|| name.to_owned())?;
            (fit.bytes, fit.report)
        }
    };
    let lines =
        Verdict::of_material(&report, &reciprocity(&Material::from_bytes(bytes.as_slice())?)?).lines();
    let shown = if args.all { lines.len() } else { 1 };
    println!("{name}: {}", lines[..shown.min(lines.len())].join("\n  "));
    Ok(())
}

/// The report of a fit at views halfway between its own, as of one that was just made.
fn judged(content: &Content, bytes: &[u8]) -> anyhow::Result<Report> {
    let Content::Evaluable(brdf) = content else { anyhow::bail!("samples are no table") };
    let material = Material::from_bytes(bytes)?;
    let table =
        evaluation_views::judging_table(brdf.as_ref(), &evaluation_views::halfway(&view_angles(&material)))?;
    let held_out = table.views.iter().map(|view| ViewReport::judge(&material, view));
    Ok(Report {
        held_out: held_out.collect::<Result<_, _>>()?,
        appearance: Some(Appearance::new(brdf.as_ref(), &material)?),
        gaps: Some(Gaps::of_table(brdf.as_ref())),
        ..Report::default()
    })
}
