//! `cargo lab presets`.

use anyhow::{Context, bail, ensure};
use srbf_core::{Material, Sheet};
use srbf_fit::{FactorNodes, Settings};
use srbf_reference_renderer::command::argument;
use srbf_reference_renderer::command::fit::fit_file;
use srbf_reference_renderer::out::output;
use std::fmt::Write;
use std::path::PathBuf;

/// Where the measurements of all presets come from.
const SOURCE: &str = "Cornell University Program of Computer Graphics, gonioreflectometer measurements (Lafortune and others)\n";

/// First line of the README.md beside the presets.
const HEADING: &str = "# Presets";

/// Name, file under the data folder, description.
const PRESETS: [(&str, &str, &str); 3] = [
    ("garnet_red", "cornell/garnet_red.brdf", "Dupli-Color T-345 spray lacquer, frosted: medium gloss"),
    ("krylon_blue", "cornell/krylon_blue.brdf", "Krylon enamel 7205 True Blue, frosted: medium gloss"),
    ("cayman", "cornell/cayman.brdf", "Ford Cayman metallic lacquer: high gloss"),
];

/// Materials that the page of the browser begins with: name and model. The paint is one of MERL's, by the fit of Bagher et al. (2012).
const KNOWN: [(&str, &str); 3] = [
    ("gold", "model:ggx:alpha=0.12,f0=1.0/0.766/0.336"),
    ("car_paint", "model:sgd:name=red-metallic-paint"),
    ("velvet", "model:sheen:alpha=0.35,tint=0.5/0.03/0.08"),
];

/// Lobes of each.
const KNOWN_LOBES: usize = 8;

/// The quarters of ground glass: reflection of the rough front, transmission seen from there and from behind. The smooth back reflects as
/// a mirror, which is no lobe.
const GROUND_GLASS: [Option<&str>; 4] = [
    Some("model:ggx:alpha=0.3,ior=1.5"),
    Some("model:ground-glass:alpha=0.3,ior=1.5,behind=0"),
    None,
    Some("model:ground-glass:alpha=0.3,ior=1.5,behind=1"),
];

/// Makes the materials in presets/ again from the measurements.
///
/// SRBF_DATA_DIR names the folder that holds them.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Folder to write to.
    #[arg(long, default_value = "presets")]
    out: PathBuf,
    /// Writes nothing, and fails if a file there differs from the one that would be written.
    #[arg(long)]
    check: bool,
}

/// Runs the command.
pub fn run(args: Args) -> anyhow::Result<()> {
    let data = argument::data_folder()?;
    let about = args.out.join("README.md");
    println!("processor: {}", srbf_core::Processor::this());
    let is_ours = std::fs::read_to_string(&about).map_or(true, |text| text.starts_with(HEADING));
    ensure!(args.check || is_ours, "{}: it is not about presets, name another folder", about.display());
    let mut made = Vec::new();
    let mut rows = String::new();
    for (name, file, what) in PRESETS {
        // Lobes alone, with which the figures of kernels in the documentation are measured.
        let settings = Settings { factors: FactorNodes::None, ..Settings::default() };
        let fit = fit_file(&data.join(file), settings, SOURCE)?;
        let errors: Vec<String> =
            fit.report.views.iter().map(|v| format!("{:.1}", 100.0 * v.error)).collect();
        println!(
            "{name}: {} bytes, mean relative L2 {:.2} %, {:.2} s",
            fit.bytes.len(),
            100.0 * fit.report.mean_error(),
            fit.report.seconds
        );
        writeln!(
            rows,
            "| {name} | {what} | {} | {:.2} | {} |",
            fit.bytes.len(),
            100.0 * fit.report.mean_error(),
            errors.join(" ")
        )?;
        made.push((args.out.join(name).with_extension("srbf"), fit.bytes));
    }
    for (name, model) in KNOWN {
        let settings = Settings { lobes: KNOWN_LOBES, factors: FactorNodes::None, ..Settings::default() };
        let fit = fit_file(model.as_ref(), settings, "")?;
        println!(
            "{name}: {} bytes, mean relative L2 {:.2} %",
            fit.bytes.len(),
            100.0 * fit.report.mean_error()
        );
        made.push((args.out.join("known").join(name).with_extension("srbf"), fit.bytes));
    }
    let (glass, error) = ground_glass()?;
    println!(
        "ground_glass: {} bytes, mean relative L2 {:.2} % at the worst quarter",
        glass.len(),
        100.0 * error
    );
    let row = format!("{} bytes; mean relative L2 error at most {:.2} %", glass.len(), 100.0 * error);
    made.push((args.out.join("sheets/ground_glass.srbf"), glass));
    made.push((about, readme(&rows, &row).into_bytes()));
    for (path, bytes) in &made {
        if !args.check {
            output::write(path, bytes)?;
        } else if std::fs::read(path).with_context(|| path.display().to_string())? != *bytes {
            bail!("{} is not what `cargo lab presets` makes", path.display());
        }
    }
    Ok(())
}

/// Fits the quarters of ground glass, with few lobes; gives the bytes of the sheet, and the largest mean error.
fn ground_glass() -> anyhow::Result<(Vec<u8>, f64)> {
    let settings = Settings {
        lobes: 6,
        views: Some(10),
        starts: 4,
        exchanges: 4,
        factors: FactorNodes::None,
        ..Settings::default()
    };
    let mut fits = Vec::new();
    for model in GROUND_GLASS {
        let fit = model.map(|model| fit_file(model.as_ref(), settings.clone(), "")).transpose()?;
        fits.push(fit);
    }
    let error = fits.iter().flatten().map(|fit| fit.report.mean_error()).fold(0.0, f64::max);
    let materials =
        fits.iter().map(|fit| fit.as_ref().map(|fit| Material::from_bytes(fit.bytes.as_slice())).transpose());
    let materials = materials.collect::<Result<Vec<_>, _>>()?;
    let quarters = [0, 1, 2, 3].map(|n| materials[n].as_ref());
    let provenance = "ground glass, by a model; made by cargo lab presets\n";
    let mut bytes = vec![0; Sheet::encoded_len(quarters, provenance)];
    Sheet::encode(quarters, false, provenance, &mut bytes)?;
    Ok((bytes, error))
}

fn readme(rows: &str, glass: &str) -> String {
    format!(
        "{HEADING}

Materials that are compiled into the `srbf` program. Each is fitted by our own tool from a measurement of the Cornell University
Program of Computer Graphics (E. Lafortune and others; 8 outgoing directions, 10 to 80 degrees, about 180 incident ones each).
The measurements themselves are not in this repository.

| preset | material | bytes | mean relative L2 error, % | at 10, 20 ... 80 degrees, % |
|---|---|---|---|---|
{rows}
Error: of `f cos` over the samples of a view, all three channels, weighted by solid angle. Settings, source file and its
SHA-256 are in the provenance text of each file (`srbf inspect`). Values between the samples, below 10 degrees and
beyond 80 is what `srbf fit` completes them to.

`sheets/ground_glass.srbf` is a sheet, for the examples of [sheets](../docs/sheets.md), and is not in the program: light through a plate that is rough in
front, by a model (Walter et al. 2007); {glass}.

The materials in `known/` are models with 8 lobes, for the page of the browser: gold and velvet by formulas, and `red-metallic-paint`, a
material of MERL, by the published fit of Bagher et al. (2012).

This folder is made by `SRBF_DATA_DIR=... cargo lab presets`; `cargo lab presets --check` compares. The fit uses no function of the
platform's C library, and no order that depends on threads. So the bytes are the same on every machine with IEEE arithmetic.
"
    )
}
