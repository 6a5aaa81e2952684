//! `srbf-lab stability`.

mod measure;

use anyhow::anyhow;
use measure::{Decade, Operation};
use plotters::prelude::*;
use srbf_reference_renderer::out::output;
use srbf_reference_renderer::out::panel;
use srbf_reference_renderer::out::picture_file;
use std::fmt::Write;
use std::path::PathBuf;

/// Measures the rounding errors of every operation, ours and the textbook's, from sharpness 1e-8 to 1e8.
///
/// For each operation and decade of sharpness: the worst relative error over many inputs, against f64, of what the library
/// computes in f32 and of the plain formula in f32. Prints a table and writes a plot.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Inputs for each operation and decade
    #[arg(long, default_value_t = 20_000, value_parser = clap::value_parser!(u32).range(1..=100_000_000), value_name = "N")]
    inputs: u32,
    /// Seed of the inputs
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// The plot to write, .png; the numbers go beside it as .csv
    #[arg(short, long, default_value = "out/stability.png", value_name = "FILE")]
    output: PathBuf,
}

/// Panels of the plot side by side.
const COLUMNS: usize = 3;
const PANEL: [u32; 2] = [520, 330];
/// Smallest error that the plot shows; what is exact lies on it.
const SMALLEST: f64 = 1e-8;
/// Largest error that the plot shows: no digit is right.
const LARGEST: f64 = 10.0;

/// Runs the command.
pub fn run(args: Args) -> anyhow::Result<()> {
    output::check_extension(&args.output, "png")?;
    output::check_places(&[&args.output, &args.output.with_extension("csv")])?;
    let operations = measure::measure(args.inputs, args.seed);
    println!(
        "Worst relative error, ours / plain formula, by sharpness. Exponents up to 10; f32 rounds to 6e-8.\n"
    );
    let mut csv = String::from("operation,plain_formula,sharpness,worst_error,worst_error_plain\n");
    for operation in &operations {
        println!("{}: {}", operation.name, operation.meaning);
        println!("  plain formula: {}", operation.plain);
        println!("  sharpness       ours      plain");
        for row in &operation.rows {
            let lost = if row.plain > 1e-2 { "  <- no usable digits" } else { "" };
            println!("  {:9.0e}  {:9.1e}  {:9.1e}{lost}", row.sharpness, row.ours, row.plain);
            let _ = writeln!(
                csv,
                "{},\"{}\",{:e},{:.3e},{:.3e}",
                operation.name, operation.plain, row.sharpness, row.ours, row.plain
            );
        }
        println!();
    }
    let lines = operations.len().div_ceil(COLUMNS);
    let size = [PANEL[0] * COLUMNS as u32, PANEL[1] * lines as u32];
    let mut pixels = vec![255; 3 * (size[0] * size[1]) as usize];
    figure(&mut pixels, size, &operations)
        .map_err(|error| anyhow!("cannot draw {}: {error}", args.output.display()))?;
    picture_file::write_png(&args.output, size, &pixels)?;
    let table = args.output.with_extension("csv");
    output::write(&table, csv.as_bytes())?;
    println!("wrote {} and {}", args.output.display(), table.display());
    Ok(())
}

fn figure(
    pixels: &mut [u8],
    size: [u32; 2],
    operations: &[Operation],
) -> Result<(), Box<dyn std::error::Error>> {
    panel::register_font()?;
    let root = BitMapBackend::with_buffer(pixels, size.into()).into_drawing_area();
    root.fill(&WHITE)?;
    let lines = operations.len().div_ceil(COLUMNS);
    for (cell, operation) in root.split_evenly((lines, COLUMNS)).iter().zip(operations) {
        let rows = &operation.rows;
        let (first, last) = (rows[0].sharpness, rows[rows.len() - 1].sharpness);
        let mut chart = ChartBuilder::on(cell)
            .margin(10)
            .caption(operation.name, (panel::FONT, 18))
            .x_label_area_size(40)
            .y_label_area_size(64)
            .build_cartesian_2d((first..last).log_scale(), (SMALLEST..1e3 * LARGEST).log_scale())?;
        chart
            .configure_mesh()
            .x_desc("sharpness")
            .y_desc("worst relative error")
            .label_style((panel::FONT, 12))
            .axis_desc_style((panel::FONT, 14))
            .x_labels(5)
            .y_labels(12)
            .x_label_formatter(&|x| format!("{x:.0e}"))
            .y_label_formatter(&|y| format!("{y:.0e}"))
            .light_line_style(RGBColor(240, 240, 240))
            .draw()?;
        let [blue, orange] = [RGBColor(0, 114, 178), RGBColor(213, 94, 0)];
        let shown = |error: f64| if error.is_nan() { LARGEST } else { error.clamp(SMALLEST, LARGEST) };
        for (name, colour, error) in [
            ("plain formula", orange, (|row: &Decade| row.plain) as fn(&Decade) -> f64),
            ("srbf", blue, |row| row.ours),
        ] {
            let points = rows.iter().map(|row| (row.sharpness, shown(error(row))));
            chart
                .draw_series(LineSeries::new(points, colour.stroke_width(2)).point_size(3))?
                .label(name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], colour.stroke_width(2)));
        }
        panel::draw_legend(&mut chart, SeriesLabelPosition::UpperMiddle, 13)?;
    }
    root.present()?;
    Ok(())
}
