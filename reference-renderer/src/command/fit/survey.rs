//! `srbf fit --survey`: how good fits are over all materials that can be evaluated between the views.

use anyhow::Context;
use srbf_fit::report::{ViewReport, mean_error};
use srbf_fit::table::{Content, neural, read};
use srbf_fit::{Settings, fit_content};
use std::path::{Path, PathBuf};

/// Views up to this angle count for variance and weight, degrees: beyond, little light is reflected in a picture.
const JUDGED: f64 = 80.0;

/// What is measured of a material, in the order of the columns.
const COLUMNS: [&str; 8] = [
    "fit %",
    "held out %",
    "held out / fit",
    "median variance",
    "worst variance",
    "largest weight",
    "worst energy %",
    "seconds",
];

/// Fits every n-th of the materials in rgl/ and of the neural MERL materials in merl/.
pub fn run(settings: &Settings, every: usize) -> anyhow::Result<()> {
    let data =
        std::env::var_os("SRBF_DATA_DIR").context("SRBF_DATA_DIR is not set: it names the data folder")?;
    let data = Path::new(&data);
    println!("{:32} {}", "material", COLUMNS.join(" | "));
    let mut rows: Vec<[f64; 8]> = Vec::new();
    let mut bytes = 0;
    for (name, content) in materials(data)?.into_iter().step_by(every.max(1)) {
        let fit = fit_content(&content?, settings, |_| {}).with_context(|| name.clone())?;
        let report = &fit.report;
        let judged: Vec<&ViewReport> =
            report.held_out.iter().filter(|v| v.theta.to_degrees() <= JUDGED).collect();
        let largest = |f: fn(&ViewReport) -> f64| judged.iter().map(|v| f(v)).fold(0.0, f64::max);
        let energy = |v: &ViewReport| {
            let off = |c: usize| (v.albedo[c] - v.data_albedo[c]).abs() / (v.data_albedo[c] + 1e-3);
            100.0 * off(0).max(off(1)).max(off(2))
        };
        let (seen, unseen) = (100.0 * report.mean_error(), 100.0 * mean_error(&report.held_out));
        let row = [
            seen,
            unseen,
            unseen / seen,
            quantile(judged.iter().map(|v| v.variance).collect(), 0.5),
            largest(|v| v.variance),
            largest(|v| v.largest_weight),
            largest(energy),
            report.seconds,
        ];
        println!("{name:32} {}", show(&row));
        rows.push(row);
        bytes = bytes.max(fit.bytes.len());
    }
    for (name, share) in [("median", 0.5), ("90 %", 0.9), ("worst", 1.0)] {
        let mut row = [0.0; 8];
        for (c, value) in row.iter_mut().enumerate() {
            *value = quantile(rows.iter().map(|r| r[c]).collect(), share);
        }
        println!("{name:32} {}", show(&row));
    }
    println!("{} materials, at most {bytes} bytes", rows.len());
    Ok(())
}

fn show(row: &[f64]) -> String {
    row.iter()
        .zip(COLUMNS)
        .map(|(v, c)| format!("{v:>width$.3}", width = c.len()))
        .collect::<Vec<_>>()
        .join(" | ")
}

fn quantile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let index = (share * values.len().saturating_sub(1) as f64).round() as usize;
    values.get(index).copied().unwrap_or(0.0)
}

type Named = (String, anyhow::Result<Content>);

fn materials(data: &Path) -> anyhow::Result<Vec<Named>> {
    let folder = data.join("rgl");
    let entries = std::fs::read_dir(&folder).with_context(|| folder.display().to_string())?;
    let mut files: Vec<PathBuf> = entries.map(|e| Ok(e?.path())).collect::<std::io::Result<_>>()?;
    files.retain(|f| f.extension().is_some_and(|e| e == "bsdf"));
    files.sort();
    let name = |f: &PathBuf| f.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mut all: Vec<Named> =
        files.iter().map(|f| (name(f), read(f).map(|s| s.content).map_err(Into::into))).collect();

    let path = data.join("merl/nbrdf_merl80.f32le");
    let weights = std::fs::read(&path).with_context(|| path.display().to_string())?;
    let names = std::fs::read_to_string(data.join("merl/nbrdf_merl80_names.txt"))?;
    let networks = neural::parse(&weights)?;
    let evaluable = |n: neural::Neural| Ok(Content::Evaluable(Box::new(n)));
    all.extend(names.split_whitespace().map(str::to_owned).zip(networks.into_iter().map(evaluable)));
    Ok(all)
}
