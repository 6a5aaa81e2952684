//! `srbf-lab bench-report`: what criterion measured, as ratios.

use anyhow::{Context, bail, ensure};
use plotters::prelude::*;
use srbf_reference_renderer::out::output;
use srbf_reference_renderer::out::panel;
use srbf_reference_renderer::out::picture_file;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};

/// Prints the ratios of what `cargo bench` measured, and writes them as CSV and as a plot.
///
/// Run `cargo bench` first: all figures of one report come from one run.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Folder that criterion wrote to.
    #[arg(long, default_value = "target/criterion")]
    measured: PathBuf,
    /// Folder for `bench.csv` and `bench.png`.
    #[arg(long, default_value = "out")]
    out: PathBuf,
}

/// Times an element that are believed; others would leave a plot without an axis.
const NANOSECONDS: std::ops::RangeInclusive<f64> = 1e-6..=1e15;

/// Largest file that is read, bytes; criterion's are a few hundred.
const MAX_FILE: u64 = 1 << 20;

/// One bench: `operation.level/lobes/directions`.
#[derive(Clone, Debug, PartialEq)]
struct Measurement {
    operation: String,
    level: String,
    lobes: String,
    directions: u64,
    /// Nanoseconds for a direction and, for evaluate and pdf, a lobe; the median of the run.
    nanoseconds: f64,
}

/// The baseline of each operation, measured in the same run; a single direction has no C loop to compare with.
fn baseline_of(operation: &str) -> &'static str {
    match operation {
        "evaluate" | "pdf" => "c-expf",
        "sample" | "one-evaluate" | "one-sample" | "one-sample-pdf" | "one-sample-value" => "rust-libm",
        _ => "scalar",
    }
}

/// Runs the command.
pub fn run(args: Args) -> anyhow::Result<()> {
    let measurements = read_all(&args.measured)?;
    let rows: Vec<(Measurement, Option<f64>)> = measurements
        .iter()
        .map(|m| (m.clone(), baseline(&measurements, m).map(|b| b.nanoseconds / m.nanoseconds)))
        .collect();
    print(&rows);
    let csv = args.out.join("bench.csv");
    output::write(&csv, csv_text(&rows).as_bytes())?;
    let png = args.out.join("bench.png");
    draw(&png, &measurements)?;
    println!("{}, {}", csv.display(), png.display());
    Ok(())
}

/// The baseline of a measurement: the baseline of its operation at as many lobes and directions, else at 12 lobes
/// (the preset) and any number of directions.
fn baseline<'a>(all: &'a [Measurement], m: &Measurement) -> Option<&'a Measurement> {
    // The density alone is compared with the C loop for values: it is the same sum, one channel of it.
    let operation = match m.operation.as_str() {
        "pdf" => "evaluate",
        "one-sample" | "one-sample-value" => "one-sample-pdf",
        other => other,
    };
    let wanted = baseline_of(&m.operation);
    let same = all.iter().filter(|b| b.operation == operation && b.level == wanted);
    let exact = same.clone().find(|b| b.lobes == m.lobes && b.directions == m.directions);
    exact.or_else(|| {
        same.clone()
            .find(|b| b.lobes == "12" && m.lobes.parse::<u32>().is_err() && b.directions == m.directions)
    })
}

fn read_all(folder: &Path) -> anyhow::Result<Vec<Measurement>> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(folder) = folders.pop() {
        let entries = std::fs::read_dir(&folder)
            .with_context(|| format!("cannot read {}: run `cargo bench` first", folder.display()))?;
        for entry in entries {
            let entry = entry.with_context(|| format!("cannot read {}", folder.display()))?;
            let path = entry.path();
            // Of the entry itself, not of the target of a link: links may make a ring.
            let kind = entry.file_type().with_context(|| format!("cannot read {}", path.display()))?;
            if kind.is_dir() && path.file_name().is_some_and(|name| name == "new") {
                found.extend(read(&path)?);
            } else if kind.is_dir() {
                folders.push(path);
            }
        }
    }
    if found.is_empty() {
        bail!("no measurement of ours in {}: run `cargo bench` first", folder.display());
    }
    let key = |m: &Measurement| {
        (m.operation.clone(), m.lobes.parse::<u32>().unwrap_or(u32::MAX), m.directions, m.level.clone())
    };
    found.sort_by_key(key);
    Ok(found)
}

/// One bench of criterion's; `None` for one that is not named as ours are.
fn read(folder: &Path) -> anyhow::Result<Option<Measurement>> {
    let json = |name: &str| -> anyhow::Result<serde_json::Value> {
        let path = folder.join(name);
        let text = srbf_fit::read_at_most(&path, MAX_FILE)
            .with_context(|| format!("cannot read {}", path.display()))?;
        serde_json::from_slice(&text).with_context(|| format!("{} is not JSON", path.display()))
    };
    let id = json("benchmark.json")?;
    let text = |field: &str| id[field].as_str().map(str::to_owned);
    let (Some(group), Some(lobes), Some(directions)) =
        (text("group_id"), text("function_id"), text("value_str"))
    else {
        return Ok(None);
    };
    let (Some((operation, level)), Ok(directions)) = (group.split_once('.'), directions.parse()) else {
        return Ok(None);
    };
    let elements = id["throughput"]["Elements"].as_f64().unwrap_or(1.0);
    let median = json("estimates.json")?["median"]["point_estimate"].as_f64();
    let nanoseconds = median.unwrap_or(f64::NAN) / elements;
    ensure!(
        NANOSECONDS.contains(&nanoseconds) && directions > 0,
        "{}: a median of {median:?} ns for {elements} elements and {directions} directions, expected a time within \
         1e-6 to 1e15 ns an element, and a direction at least",
        folder.display()
    );
    Ok(Some(Measurement { operation: operation.into(), level: level.into(), lobes, directions, nanoseconds }))
}

fn print(rows: &[(Measurement, Option<f64>)]) {
    println!(
        "ns: for a direction and a lobe (evaluate, pdf) or for a direction; ratio: times as fast as the baseline"
    );
    println!(
        "{:16} {:>6} {:>10}   {:16} {:>9} {:>8}",
        "operation", "lobes", "directions", "level", "ns", "ratio"
    );
    for (m, ratio) in rows {
        let ratio = ratio.map_or_else(|| "-".into(), |r| format!("{r:.2}"));
        println!(
            "{:16} {:>6} {:>10}   {:16} {:>9.3} {:>8}",
            m.operation, m.lobes, m.directions, m.level, m.nanoseconds, ratio
        );
    }
}

fn csv_text(rows: &[(Measurement, Option<f64>)]) -> String {
    let mut text = String::from("operation,level,lobes,directions,nanoseconds,baseline,times_as_fast\n");
    for (m, ratio) in rows {
        let ratio = ratio.map_or_else(String::new, |r| format!("{r:.4}"));
        let (operation, baseline) = (&m.operation, baseline_of(&m.operation));
        let _ = writeln!(
            text,
            "{operation},{},{},{},{:.4},{baseline},{ratio}",
            m.level, m.lobes, m.directions, m.nanoseconds
        );
    }
    text
}

/// Throughput of `evaluate` against lobes at 1024 directions, and against the batch at 12 lobes.
fn draw(path: &Path, measurements: &[Measurement]) -> anyhow::Result<()> {
    const SIZE: [u32; 2] = [1200, 520];
    let mut pixels = vec![255; 3 * (SIZE[0] * SIZE[1]) as usize];
    draw_panels(&mut pixels, SIZE, measurements)
        .map_err(|error| anyhow::anyhow!("cannot plot {}: {error}", path.display()))?;
    picture_file::write_png(path, SIZE, &pixels)
}

fn draw_panels(
    pixels: &mut [u8],
    size: [u32; 2],
    measurements: &[Measurement],
) -> Result<(), Box<dyn std::error::Error>> {
    panel::register_font()?;
    let root = BitMapBackend::with_buffer(pixels, size.into()).into_drawing_area();
    root.fill(&WHITE)?;
    let panels = root.split_evenly((1, 2));
    let evaluate =
        || measurements.iter().filter(|m| m.operation == "evaluate" && m.lobes.parse::<NonZeroU32>().is_ok());
    let by_lobes = evaluate().filter(|m| m.directions == 1024);
    let by_batch = evaluate().filter(|m| m.lobes == "12");
    let lobes = |m: &&Measurement| (m.level.clone(), m.lobes.parse().unwrap_or(1.0), 1.0 / m.nanoseconds);
    let batch = |m: &&Measurement| (m.level.clone(), m.directions as f64, 1.0 / m.nanoseconds);
    for (panel, label, points) in [
        (&panels[0], "lobes, 1024 directions", by_lobes.map(|m| lobes(&m)).collect::<Vec<_>>()),
        (&panels[1], "directions, 12 lobes", by_batch.map(|m| batch(&m)).collect()),
    ] {
        let mut curves: BTreeMap<String, Vec<(f64, f64)>> = BTreeMap::new();
        for (level, x, y) in points {
            curves.entry(level).or_default().push((x, y));
        }
        let largest = |pick: fn(&(f64, f64)) -> f64| curves.values().flatten().map(pick).fold(1.0, f64::max);
        let mut chart = ChartBuilder::on(panel)
            .margin(12)
            .x_label_area_size(46)
            .y_label_area_size(70)
            .build_cartesian_2d(
                (1.0..largest(|p| p.0) * 1.1).log_scale(),
                (0.001..largest(|p| p.1) * 2.0).log_scale(),
            )?;
        chart
            .configure_mesh()
            .x_desc(label)
            .x_labels(5)
            .y_desc("lobes evaluated, 1e9 / s")
            .label_style((panel::FONT, 14))
            .axis_desc_style((panel::FONT, 16))
            .light_line_style(RGBColor(235, 235, 235))
            .draw()?;
        for (index, (level, mut curve)) in curves.into_iter().enumerate() {
            curve.sort_by(|a, b| a.0.total_cmp(&b.0));
            let colour = panel::COLOURS[index % panel::COLOURS.len()];
            chart
                .draw_series(LineSeries::new(curve, colour.stroke_width(2)).point_size(3))?
                .label(level)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 22, y)], colour.stroke_width(2)));
        }
        panel::draw_legend(&mut chart, SeriesLabelPosition::LowerRight, 14)?;
    }
    root.present()?;
    Ok(())
}
