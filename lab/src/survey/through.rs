//! `srbf-lab survey --through FILE`: what fits are like of materials of which only samples are known.
//!
//! Every material is evaluated at the pairs of directions that a file of samples has, fitted from those values alone, and judged
//! against the material in all directions.

use anyhow::{Context, bail};
use srbf_core::Material;
use srbf_fit::judge::method::{Fitted, Method};
use srbf_fit::judge::report::ViewReport;
use srbf_fit::read::{Content, read};
use srbf_fit::table::{Brdf, Scattered, Table, evaluation_views};
use srbf_fit::{Settings, fit};
use srbf_reference_renderer::out::output;
use srbf_thesis::evaluated::Completed;
use std::fmt::Write as _;
use std::path::Path;

/// Angles of the outgoing direction at which fits are judged, degrees.
const JUDGED: [f64; 8] = [5.0, 15.0, 25.0, 35.0, 45.0, 55.0, 65.0, 75.0];

/// Errors of all materials so far, percent.
#[derive(Default)]
struct Errors {
    l2: Vec<f64>,
    luminance: Vec<f64>,
    completed: Vec<f64>,
}

/// Fits the materials through the samples of a file, prints a line for each, and writes the table.
pub fn run(
    file: &Path,
    materials: impl Iterator<Item = (String, anyhow::Result<Content>)>,
    settings: &Settings,
    csv_path: &Path,
) -> anyhow::Result<()> {
    let Content::Samples(pattern) = read(file)?.content else {
        bail!("{}: --through needs a file of samples", file.display())
    };
    println!(
        "relative L2 of f cos in % at outgoing directions of 5, 15, ..., 75 degrees | median luminance error off the peak | L2 of the"
    );
    println!("completion without lobes; from the {} samples of {} alone", count(&pattern), file.display());
    let mut csv = "material,view_degrees,relative_l2,luminance,completion_relative_l2,seconds\n".to_owned();
    let mut all = Errors::default();
    for (name, content) in materials {
        let Content::Evaluable(brdf) = content? else { bail!("{name}: scattered samples") };
        let table = seen_through(brdf.as_ref(), &pattern)?;
        let made = fit(&table, settings, |_| {}).with_context(|| format!("material {name}"))?;
        let truth = evaluation_views::judging_table(brdf.as_ref(), &JUDGED.map(f64::to_radians))?;
        let lobes = judge(&Material::from_bytes(made.bytes)?, &truth)?;
        let completed = judge(Completed.fit(&table)?.as_ref(), &truth)?;
        let list = |reports: &[ViewReport], of: fn(&ViewReport) -> f64| -> Vec<f64> {
            reports.iter().map(|v| 100.0 * of(v)).collect()
        };
        let l2 = list(&lobes, |v| v.error);
        let luminance = list(&lobes, |v| v.regions.luminance);
        let completed = list(&completed, |v| v.error);
        println!(
            "{name:26} {} | {} | {} | {:.1} s",
            line(&l2),
            line(&luminance),
            line(&completed),
            made.report.seconds
        );
        for (i, view) in JUDGED.iter().enumerate() {
            let (l2, luminance, completed) = (l2[i], luminance[i], completed[i]);
            writeln!(csv, "{name},{view},{l2:.3},{luminance:.3},{completed:.3},{:.2}", made.report.seconds)?;
        }
        output::write(csv_path, csv.as_bytes())?;
        all.l2.extend(l2);
        all.luminance.extend(luminance);
        all.completed.extend(completed);
    }
    let median = |values: &[f64]| super::row::quantile(values.to_vec(), 0.5);
    println!(
        "median of all: L2 {:.1} %, luminance {:.1} %, L2 of the completion {:.1} %; {}",
        median(&all.l2),
        median(&all.luminance),
        median(&all.completed),
        csv_path.display()
    );
    Ok(())
}

fn count(table: &Table) -> usize {
    table.views.iter().map(|view| view.samples.len()).sum()
}

fn line(values: &[f64]) -> String {
    values.iter().map(|v| format!("{v:3.0}")).collect::<Vec<_>>().join(" ")
}

/// A material's values at the directions of samples.
fn seen_through(brdf: &dyn Brdf, pattern: &Table) -> anyhow::Result<Table> {
    let view = |theta: f64, directions: Vec<[f64; 3]>| -> (f64, Scattered) {
        let wo = [-theta.sin(), 0.0, theta.cos()];
        (theta, directions.into_iter().map(|d| (d, brdf.evaluate(d, wo))).collect())
    };
    let views = pattern.views.iter();
    Ok(Table::from_scattered(
        views.map(|v| view(v.theta, v.samples.iter().map(|s| s.direction).collect())).collect(),
    )?)
}

fn judge(fit: &dyn Fitted, table: &Table) -> anyhow::Result<Vec<ViewReport>> {
    table.views.iter().map(|view| Ok(ViewReport::judge(fit, view)?)).collect()
}
