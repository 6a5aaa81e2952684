//! `srbf-lab baselines`: errors away from the peak over bytes, of our fits and of other forms of the same measured tables.

mod network;

use anyhow::{Context, bail};
use rayon::prelude::*;
use srbf_core::{Material, PackOptions};
use srbf_fit::judge::method::Fitted;
use srbf_fit::judge::report::ViewReport;
use srbf_fit::read::{Content, read, rgl};
use srbf_fit::table::{Brdf, Table, evaluation_views};
use srbf_fit::{FactorNodes, Settings, fit_content};
use srbf_reference_renderer::command::argument;
use srbf_reference_renderer::out::output;
use srbf_thesis::evaluated::Evaluated;
use srbf_thesis::microfacets::Microfacets;
use std::path::{Path, PathBuf};

/// Errors away from the peak over bytes, of our fits and of other forms of the same measured tables: a CSV.
///
/// The tables are those of the folder that SRBF_DATA_DIR names. The error is the median error of the luminance, farther than 15 degrees from the
/// mirror direction, as a mean over outgoing directions at 5, 30, 60 and 75 degrees. The other forms are two GGX lobes with a diffuse term;
/// RGL's table with fewer numbers; and a network of 675 weights, trained here as its paper says (Sztrajman et al. 2021).
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The table to write
    #[arg(short, long, default_value = "out/baselines.csv", value_name = "FILE.csv")]
    output: PathBuf,
    /// Only tables whose names contain this
    #[arg(long, value_name = "NAME", default_value = "")]
    only: String,
    /// Batches that a network is trained with
    #[arg(long, value_name = "N", default_value_t = 30_000)]
    batches: usize,
}

/// Bytes that our fits may take; the first has no factors.
const OURS: [usize; 4] = [4600, 6000, 8000, 16_000];
/// Sides of the warps and of the pictures of RGL's table.
const RGL: [(usize, usize); 5] = [(6, 5), (9, 7), (12, 9), (16, 13), (24, 18)];
/// Bytes of a number of RGL's table, a half float; of a network and of GGX, a float.
const HALF: usize = 2;
const FLOAT: usize = 4;
/// Numbers of two GGX lobes: two roughnesses, and five coefficients of three channels.
const GGX_NUMBERS: usize = 17;
/// Views to which they are fitted, the last of which is left out.
const GGX_VIEWS: usize = 12;

/// One form of a table.
struct Form {
    method: &'static str,
    table: String,
    bytes: usize,
    error: f64,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<()> {
    output::check_extension(&args.output, "csv")?;
    output::check_place(&args.output)?;
    println!("processor: {}", srbf_core::Processor::this());
    let mut files = crate::survey::rgl_files(&argument::data_folder()?)?;
    files.retain(|file| name(file).contains(&args.only));
    let forms: Vec<Vec<Form>> =
        files.par_iter().map(|file| forms(file, args.batches)).collect::<anyhow::Result<_>>()?;
    let mut csv = "form,table,bytes,\"luminance away from the peak, %\"\n".to_owned();
    let mut all: Vec<Form> = forms.into_iter().flatten().collect();
    all.sort_by_key(|form| form.method);
    for Form { method, table, bytes, error } in all {
        csv += &format!("{method},{table},{bytes},{error:.1}\n");
    }
    output::write(&args.output, csv.as_bytes())?;
    println!("{}", args.output.display());
    Ok(())
}

fn name(file: &Path) -> String {
    file.file_stem().unwrap_or_default().to_string_lossy().replace("_rgb", "")
}

/// Every form of one table.
fn forms(file: &Path, batches: usize) -> anyhow::Result<Vec<Form>> {
    let table = name(file);
    let source = read(file)?;
    let Content::Evaluable(brdf) = &source.content else { bail!("{table}: samples") };
    let brdf: &(dyn Brdf + Send) = brdf.as_ref();
    let judging = evaluation_views::judging_table(brdf, &evaluation_views::seen_views())?;
    let mut found = Vec::new();
    let mut add = |method, bytes, fit: &dyn Fitted| -> anyhow::Result<()> {
        let error = away_from_the_peak(fit, &judging)?;
        println!("{method}, {table}: {bytes} bytes, {error:.1} %");
        found.push(Form { method, table: table.clone(), bytes, error });
        Ok(())
    };
    for (n, bytes) in OURS.into_iter().enumerate() {
        let factors = if n == 0 { FactorNodes::None } else { FactorNodes::Chosen };
        let settings = Settings { factors, bytes, ..Settings::default() };
        let fit = fit_content(&source.content, &settings, |_| {}).with_context(|| table.clone())?;
        let material = Material::from_bytes(fit.bytes)?;
        add("srbf", material.bytes().len(), &material)?;
        let mut packed = vec![0; material.packed_len(PackOptions::default(), "")];
        material.pack(PackOptions::default(), "", &mut packed)?;
        add("srbf in 8 bits", packed.len(), &Material::from_bytes(packed)?)?;
    }
    let even = evaluation_views::even_views(GGX_VIEWS);
    let even = evaluation_views::judging_table(brdf, &even[..GGX_VIEWS - 1])?;
    add("two GGX lobes", FLOAT * GGX_NUMBERS, &Evaluated(Microfacets::fit(&even)?))?;
    let own = rgl::parse(&std::fs::read(file)?)?;
    for (warp, picture) in RGL {
        if let Some((coarse, numbers)) = own.coarser(warp, picture) {
            add("RGL's table", HALF * numbers, &Evaluated(coarse))?;
        }
    }
    let (network, weights) = network::train(brdf, batches)?;
    add("network", FLOAT * weights, &Evaluated(network))?;
    Ok(found)
}

/// Median error of the luminance away from the peak, percent, a mean over the views.
fn away_from_the_peak(fit: &dyn Fitted, table: &Table) -> anyhow::Result<f64> {
    let errors: Vec<f64> = table
        .views
        .iter()
        .map(|view| Ok(ViewReport::judge(fit, view)?.regions.luminance))
        .collect::<anyhow::Result<_>>()?;
    Ok(100.0 * errors.iter().sum::<f64>() / errors.len() as f64)
}
