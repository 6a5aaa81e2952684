//! `srbf-lab lobes-table`: cost and gain of more lobes.
//!
//! The costs of one call are measured for all numbers of lobes in turn, many times over, and the least of each is
//! kept: what disturbs the machine disturbs all of them, and only ever adds.

pub mod plot;

use anyhow::ensure;
use srbf_core::{MAX_LOBES, Material, Mixture, Vec3};
use srbf_fit::fit_content;
use srbf_fit::judge::report::mean_error;
use srbf_fit::read::read;
use srbf_reference_renderer::command::fit::{SettingArgs, names};
use srbf_reference_renderer::out::output;
use std::fmt::Write;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Numbers of lobes in the table.
const COUNTS: [usize; 7] = [2, 4, 8, 12, 16, 24, 32];

/// The one that the others are compared with.
const USUAL: usize = 12;

/// Rounds over all counts, and calls that are timed together.
const ROUNDS: usize = 60;
const CALLS: usize = 400;

/// One row: a number of lobes.
#[derive(Clone, Debug, Default)]
pub struct LobesRow {
    pub lobes: usize,
    /// Mean relative L2 error over the views of the table.
    pub error: f64,
    /// The same over held-out views, where there are any.
    pub held_out: Option<f64>,
    pub bytes: usize,
    pub fit_seconds: f64,
    /// Nanoseconds of one call: prepare, evaluate one direction with density, sample one with its weight.
    pub nanoseconds: [f64; 3],
}

/// Error, bytes and run time against the number of lobes: a table and a plot.
///
/// Writes out/NAME-lobes.csv and .png.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The measured BRDF or the model, as `srbf fit` reads it
    #[arg(value_name = "FILE|MODEL")]
    file: PathBuf,
    #[command(flatten)]
    settings: SettingArgs,
}

/// Fits a measurement with each number of lobes, prints the table, and writes it.
pub fn run(args: Args) -> anyhow::Result<()> {
    println!("processor: {}", srbf_core::Processor::this());
    let settings = args.settings.settings();
    ensure!(args.settings.has_free_lobes(), "--lobes, --error: this table has numbers of lobes of its own");
    let source = read(&args.file)?;
    let name = names::stem(&args.file, None)?.to_string_lossy().into_owned();
    let mut rows = Vec::new();
    let mut fitted = Vec::new();
    for lobes in COUNTS {
        let fit = fit_content(&source.content, &settings.with_lobes(lobes), |_| {})?;
        let report = &fit.report;
        rows.push(LobesRow {
            lobes,
            error: report.mean_error(),
            held_out: (!report.held_out.is_empty()).then(|| mean_error(&report.held_out)),
            bytes: fit.bytes.len(),
            fit_seconds: report.seconds,
            nanoseconds: [f64::INFINITY; 3],
        });
        fitted.push(fit.bytes);
    }
    for _ in 0..ROUNDS {
        for (row, bytes) in rows.iter_mut().zip(&fitted) {
            let timed = time(&Material::from_bytes(bytes)?)?;
            row.nanoseconds.iter_mut().zip(timed).for_each(|(least, new)| *least = least.min(new));
        }
    }

    print(&rows);
    let out = Path::new("out").join(format!("{name}-lobes.csv"));
    output::write(&out, csv(&rows).as_bytes())?;
    let picture = out.with_extension("png");
    let point = |row: &LobesRow| {
        let error = row.held_out.unwrap_or(row.error);
        plot::Point { error, bytes: row.bytes, nanoseconds: row.nanoseconds }
    };
    let points: Vec<_> = rows.iter().map(point).collect();
    let calls = ["prepare", "evaluate with density", "sample with weight"];
    plot::write(&picture, &format!("{}: 2 to 32 lobes", source.name), calls, &points)?;
    println!("{}, {}", out.display(), picture.display());
    Ok(())
}

/// Nanoseconds of prepare, of value and density of one direction, and of one sample with its weight.
fn time(material: &Material<impl AsRef<[u8]>>) -> anyhow::Result<[f64; 3]> {
    let place = |n: usize| (n as f32 * 0.618_034).fract();
    let direction = |n: usize| {
        let (z, azimuth) = (0.05 + 0.9 * place(n), std::f32::consts::TAU * place(3 * n + 1));
        let across = (1.0 - z * z).sqrt();
        Vec3::new(across * azimuth.cos(), across * azimuth.sin(), z)
    };
    let directions: Vec<Vec3> = (0..CALLS).map(direction).collect();
    let numbers: Vec<[f32; 3]> =
        (0..CALLS).map(|n| [place(n), place(7 * n + 2), place(11 * n + 5)]).collect();
    let mut mixture = Mixture::<MAX_LOBES>::empty();
    let per_call = |start: Instant| start.elapsed().as_secs_f64() * 1e9 / CALLS as f64;

    let start = Instant::now();
    for d in &directions {
        material.prepare(*d, &mut mixture)?;
        black_box(&mixture);
    }
    let prepare = per_call(start);
    material.prepare(directions[3], &mut mixture)?;
    let start = Instant::now();
    for d in &directions {
        black_box(mixture.evaluate_and_pdf(*d));
    }
    let evaluate = per_call(start);
    let start = Instant::now();
    for u in &numbers {
        black_box(mixture.sample(*u).map(|sample| sample.weight));
    }
    Ok([prepare, evaluate, per_call(start)])
}

/// Costs over those of the usual number of lobes.
fn ratios(rows: &[LobesRow], row: &LobesRow) -> [f64; 3] {
    let usual = rows.iter().find(|r| r.lobes == USUAL).unwrap_or(row);
    [0, 1, 2].map(|i| row.nanoseconds[i] / usual.nanoseconds[i])
}

fn print(rows: &[LobesRow]) {
    println!(
        "lobes | relative L2 % | held out % | bytes | prepare ns | evaluate ns | sample ns | over {USUAL} lobes"
    );
    for row in rows {
        let [prepare, evaluate, sample] = row.nanoseconds;
        let held_out = row.held_out.map_or("-".into(), |e| format!("{:.2}", 100.0 * e));
        println!(
            "{:5} | {:13.2} | {held_out:>10} | {:5} | {prepare:10.1} | {evaluate:11.1} | {sample:9.1} | {}",
            row.lobes,
            100.0 * row.error,
            row.bytes,
            ratios(rows, row).map(|r| format!("{r:.2}")).join(" ")
        );
    }
}

fn csv(rows: &[LobesRow]) -> String {
    let mut text =
        "lobes,relative_l2,relative_l2_held_out,bytes,fit_seconds,prepare_ns,evaluate_ns,sample_ns,\
                    prepare_ratio,evaluate_ratio,sample_ratio\n"
            .to_owned();
    for row in rows {
        let held_out = row.held_out.map_or(String::new(), |e| format!("{e:.6}"));
        let costs = row.nanoseconds.iter().map(|v| format!("{v:.2}"));
        let ratios = ratios(rows, row).into_iter().map(|v| format!("{v:.3}"));
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{},{:.6},{held_out},{},{:.3},{}",
            row.lobes,
            row.error,
            row.bytes,
            row.fit_seconds,
            costs.chain(ratios).collect::<Vec<_>>().join(",")
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_csv_has_a_number_or_nothing_in_every_column() {
        let row = LobesRow {
            lobes: 12,
            error: 0.01,
            bytes: 3000,
            nanoseconds: [10.0, 20.0, 30.0],
            ..LobesRow::default()
        };
        let double = LobesRow { lobes: 24, nanoseconds: [20.0; 3], held_out: Some(0.02), ..row.clone() };
        let text = csv(&[row, double]);
        let columns: Vec<usize> = text.lines().map(|l| l.split(',').count()).collect();
        assert_eq!(columns, [11, 11, 11]);
        assert!(text.lines().nth(2).unwrap().ends_with("2.000,1.000,0.667"), "{text}");
    }
}
