//! `srbf judge`: a fitted material beside the table that it stands for.

use anyhow::{Context, bail};
use srbf_core::Material;
use srbf_fit::TrackedLobes;
use srbf_fit::judge::report::ViewReport;
use srbf_fit::read::{Content, read};
use srbf_fit::table::evaluation_views;
use std::path::PathBuf;

/// Most bytes of a material that is read.
const MAX_FILE: u64 = 1 << 26;

/// Prints how far a fitted material is from a table, at the peak and away from it, at fixed outgoing directions.
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
    let bytes =
        srbf_fit::read_at_most(&args.file, MAX_FILE).with_context(|| args.file.display().to_string())?;
    let is_isotropic =
        Material::from_bytes(&bytes).with_context(|| args.file.display().to_string())?.is_isotropic();
    let Content::Evaluable(brdf) = read(&args.against)?.content else {
        bail!("{}: scattered samples have no value in between", args.against.display())
    };
    if !is_isotropic {
        bail!("{}: anisotropic; only isotropic materials are judged so", args.file.display());
    }
    let thetas: Vec<f64> = args.angles.iter().map(|a| a.to_radians()).collect();
    let table = evaluation_views::judging_table(brdf.as_ref(), &thetas)?;
    let lobes = TrackedLobes { bytes };
    println!(
        "view deg | L2 % | peak L2 % | off-peak L2 % | luminance % | chroma | variance | weight | albedo r g b, fit (data)"
    );
    for view in &table.views {
        let v = ViewReport::judge(&lobes, view)?;
        let albedo = [0, 1, 2].map(|c| format!("{:.3} ({:.3})", v.albedo[c], v.data_albedo[c]));
        println!(
            "{:8.1} | {:4.1} | {:9.1} | {:13.1} | {:11.1} | {:6.3} | {:8.3} | {:6.2} | {}",
            v.theta.to_degrees(),
            100.0 * v.error,
            100.0 * v.seen.peak,
            100.0 * v.seen.off_peak,
            100.0 * v.seen.luminance,
            v.seen.chroma,
            v.variance,
            v.largest_weight,
            albedo.join("  ")
        );
    }
    Ok(())
}
