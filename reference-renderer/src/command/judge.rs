//! `srbf judge`: a fitted material beside the table that it stands for.

use super::view_table;
use crate::out::print::shown;
use anyhow::{Context, bail};
use srbf_core::Material;
use srbf_fit::judge::appearance::Appearance;
use srbf_fit::judge::reciprocity::reciprocity;
use srbf_fit::judge::report::{Report, ViewReport};
use srbf_fit::judge::verdict::Verdict;
use srbf_fit::read::{Content, read};
use srbf_fit::table::evaluation_views;
use std::path::PathBuf;

/// Most bytes of a material that is read.
const MAX_FILE: u64 = 1 << 26;

/// Prints the errors of a fitted material against a table, at the peak and away from it, and a verdict.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The fitted material, `.srbf`
    file: PathBuf,
    /// The measured file, or `model:...`, that it is to be like
    #[arg(long, value_name = "TABLE")]
    against: PathBuf,
    /// Angles of the outgoing directions from the normal, degrees
    #[arg(long, value_delimiter = ',', default_values_t = [0.0, 5.0, 30.0, 60.0, 75.0])]
    angles: Vec<f64>,
}

/// Runs the command.
pub fn run(args: Args) -> anyhow::Result<()> {
    let bytes = srbf_fit::read_at_most(&args.file, MAX_FILE).with_context(|| shown(&args.file))?;
    let material = Material::from_bytes(bytes.as_slice()).with_context(|| shown(&args.file))?;
    let Content::Evaluable(brdf) = read(&args.against)?.content else {
        bail!("{}: scattered samples have no value in between", shown(&args.against))
    };
    if !material.is_isotropic() {
        bail!("{}: anisotropic; only isotropic materials are judged so", shown(&args.file));
    }
    let thetas: Vec<f64> = args.angles.iter().map(|a| a.to_radians()).collect();
    let table = evaluation_views::judging_table(brdf.as_ref(), &thetas)?;
    let judged = table.views.iter().map(|view| ViewReport::judge(&material, view));
    // None of them need be a view of the material.
    let appearance = Some(Appearance::new(brdf.as_ref(), &material)?);
    let report = Report { held_out: judged.collect::<Result<_, _>>()?, appearance, ..Report::default() };
    println!("{}", view_table::LEGEND);
    view_table::print_views(&report.held_out, true);
    let reciprocity = reciprocity(&material)?;
    view_table::print_whole(&report, &reciprocity, Some(&material));
    let verdict = Verdict::of_material(&report, &reciprocity);
    view_table::words(&report, &verdict).iter().for_each(|line| println!("{line}"));
    Ok(())
}
