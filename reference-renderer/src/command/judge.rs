//! `srbf judge`: a fitted material beside the table that it stands for.

use super::view_table;
use crate::out::print::shown;
use crate::truth::stored::StoredMaterial;
use anyhow::bail;
use srbf_core::Material;
use srbf_fit::complete::Gaps;
use srbf_fit::judge::appearance::Appearance;
use srbf_fit::judge::reciprocity::reciprocity;
use srbf_fit::judge::report::{Report, ViewReport};
use srbf_fit::judge::verdict::Verdict;
use srbf_fit::judge_at;
use srbf_fit::read::{Content, read};
use srbf_fit::table::{Symmetry, evaluation_views};
use std::f64::consts::TAU;
use std::path::PathBuf;

/// Azimuths of the outgoing direction at which an anisotropic surface is judged.
const AZIMUTHS: usize = 8;

/// Prints the errors of a fitted material against a table, at the peak and away from it, and a verdict.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The fitted material: a preset or a .srbf file
    #[arg(value_name = "FILE|PRESET")]
    material: String,
    /// The measured file, or `model:...`, that it is to be like
    #[arg(long, value_name = "TABLE")]
    against: PathBuf,
    /// Angles of the outgoing directions from the normal, degrees, 0 to below 90; separated by spaces or commas
    #[arg(long, num_args = 1.., value_delimiter = ',', value_parser = angle, default_values_t = [0.0, 5.0, 30.0, 60.0, 75.0])]
    angles: Vec<f64>,
}

/// Parses an angle.
fn angle(text: &str) -> Result<f64, String> {
    let value = text.parse().ok().filter(|v| (0.0..90.0).contains(v));
    value.ok_or_else(|| "expected degrees, from 0 to below 90".to_owned())
}

/// Runs the command.
pub fn run(args: Args) -> anyhow::Result<()> {
    let stored = StoredMaterial::load(&args.material)?;
    let material = Material::from_bytes(stored.material.bytes())?;
    let Content::Evaluable(brdf) = read(&args.against)?.content else {
        bail!("{}: scattered samples have no value in between", shown(&args.against))
    };
    let thetas: Vec<f64> = args.angles.iter().map(|a| a.to_radians()).collect();
    if !material.is_isotropic() || brdf.symmetry() != Symmetry::Isotropic {
        let azimuth = |n: usize| (n as f64 + 0.5) * TAU / AZIMUTHS as f64;
        let directions = thetas.iter().flat_map(|theta| (0..AZIMUTHS).map(move |n| (*theta, azimuth(n))));
        let directions: Vec<(f64, f64)> = directions.collect();
        let held_out = judge_at(stored.material.bytes(), brdf.as_ref(), &directions)?;
        return print(&Report { held_out, ..Report::default() }, &material);
    }
    let table = evaluation_views::judging_table(brdf.as_ref(), &thetas)?;
    let judged = table.views.iter().map(|view| ViewReport::judge(&material, view));
    // None of them need be a view of the material.
    let appearance = Some(Appearance::new(brdf.as_ref(), &material)?);
    let gaps = Some(Gaps::of_table(brdf.as_ref()));
    let report =
        Report { held_out: judged.collect::<Result<_, _>>()?, appearance, gaps, ..Report::default() };
    print(&report, &material)
}

/// Prints a report.
fn print(report: &Report, material: &Material<&[u8]>) -> anyhow::Result<()> {
    println!("{}", view_table::LEGEND);
    view_table::print_views(&report.held_out, view_table::is_isotropic(report));
    let reciprocity = reciprocity(material)?;
    view_table::print_whole(report, &reciprocity, Some(material));
    let verdict = Verdict::of_material(report, &reciprocity);
    view_table::words(report, &verdict).iter().for_each(|line| println!("{line}"));
    Ok(())
}
