//! `srbf compare`.

use super::argument;
use crate::comparison::{self, Plan};
use crate::environment::Environment;
use crate::material::StoredMaterial;
use crate::progress::Progress;
use crate::sampling::Strategy;
use crate::shader::LoadedMaterial;
use crate::{material, output, plot, report};
use anyhow::ensure;
use std::path::{Path, PathBuf};

/// Compares sampling strategies: error against run time.
///
/// Renders the sphere with one scattering, each sampler with more and more samples, and takes the error against a
/// converged reference. Prints a table for each material and environment, and writes OUT.csv and OUT.png.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Materials, separated by commas: .srbf files, names of presets, tables or models, as `render` takes them [default: all presets]
    #[arg(long, value_delimiter = ',', value_name = "FILE|PRESET|MODEL")]
    materials: Vec<String>,
    /// Lobes that sample tables: a .srbf file for each of the materials, separated by commas
    #[arg(long, value_delimiter = ',', value_name = "FILE|PRESET", requires = "materials")]
    lobes: Vec<String>,
    /// Environments, separated by commas: haze (the sun spread wide), sky, constant:VALUE, or .hdr or .exr files
    #[arg(long, value_delimiter = ',', default_value = "haze", value_name = "ENV")]
    env: Vec<String>,
    /// Samplers, separated by commas, as `render --sampler` takes them; errors are given as multiples of the first one's
    #[arg(long, value_delimiter = ',', default_value = "lobes,cosine")]
    samplers: Vec<Strategy>,
    /// Samples a pixel at which the error is taken, rising, separated by commas
    #[arg(long, value_delimiter = ',', default_value = "1,2,4,8,16,32,64,128,256",
        value_parser = clap::value_parser!(u32).range(1..=1 << 24), value_name = "N")]
    spp: Vec<u32>,
    /// Samples a pixel of the reference
    #[arg(long, default_value_t = 1024, value_parser = clap::value_parser!(u32).range(2..=1 << 24), value_name = "N")]
    reference_spp: u32,
    /// Sides of the square picture in pixels
    #[arg(long, default_value_t = 96, value_parser = clap::value_parser!(u32).range(1..=4096), value_name = "PIXELS")]
    side: u32,
    /// Seed of the random numbers
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Threads; 0 is one a processor
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=1024))]
    threads: u16,
    /// The files to write, OUT.csv and OUT.png; either name will do
    #[arg(short, long, default_value = "out/compare", value_name = "OUT")]
    output: PathBuf,
}

/// Runs the command.
pub fn run(args: Args) -> anyhow::Result<()> {
    ensure!(args.spp.is_sorted_by(|a, b| a < b), "--spp: numbers that rise are expected");
    ensure!(!args.samplers.is_empty() && !args.spp.is_empty(), "--samplers and --spp: at least one each");
    let [csv, png] = outputs(&args.output);
    output::check_places(&[&csv, &png])?;
    let mut names = args.materials;
    if names.is_empty() {
        names = material::PRESETS.iter().map(|preset| preset.0.to_owned()).collect();
    }
    let materials: Vec<LoadedMaterial> =
        names.iter().map(|name| LoadedMaterial::load(name)).collect::<anyhow::Result<_>>()?;
    ensure!(
        args.lobes.is_empty() || args.lobes.len() == materials.len(),
        "--lobes: {} names for {} materials, one each is expected",
        args.lobes.len(),
        materials.len()
    );
    let lobes: Vec<StoredMaterial> =
        args.lobes.iter().map(|name| StoredMaterial::load(name)).collect::<anyhow::Result<_>>()?;
    let environments: Vec<(String, Environment)> = args
        .env
        .iter()
        .map(|text| Ok((environment_name(text), argument::environment(text)?)))
        .collect::<anyhow::Result<_>>()?;
    let plan = Plan {
        strategies: args.samplers,
        side: args.side,
        samples: args.spp,
        reference_samples: args.reference_spp,
        seed: args.seed,
    };

    let mut comparisons = Vec::new();
    for (environment_name, environment) in &environments {
        for (i, material) in materials.iter().enumerate() {
            let progress = Progress::new(material.name(), plan.steps());
            let result = argument::on_threads(args.threads.into(), || {
                comparison::measure(&plan, material, lobes.get(i), environment_name, environment, &progress)
            })?;
            drop(progress);
            report::print(&result);
            println!();
            comparisons.push(result);
        }
    }

    report::write_csv(&csv, &comparisons)?;
    plot::write_png(&png, &comparisons)?;
    println!("wrote {} and {}", csv.display(), png.display());
    Ok(())
}

/// The two files that are written. Only their own extensions are put in place of one another: a name may hold a point.
fn outputs(given: &Path) -> [PathBuf; 2] {
    let is_ours = given.extension().is_some_and(|e| e == "csv" || e == "png");
    let stem = if is_ours { given.with_extension("") } else { given.to_owned() };
    ["csv", "png"].map(|extension| {
        let mut path = stem.clone().into_os_string();
        path.push(format!(".{extension}"));
        PathBuf::from(path)
    })
}

/// What tables call an environment: a file by its name without folder and extension.
fn environment_name(text: &str) -> String {
    if text.starts_with("constant:") {
        return text.to_owned();
    }
    Path::new(text).file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn either_name_of_the_outputs_names_both() {
        for (given, stem) in
            [("a/b", "a/b"), ("b.csv", "b"), ("b.png", "b"), ("b.v1", "b.v1"), ("b.csv/c", "b.csv/c")]
        {
            let expected = [format!("{stem}.csv"), format!("{stem}.png")].map(PathBuf::from);
            assert_eq!(outputs(Path::new(given)), expected, "{given}");
        }
    }
}
