//! `srbf-lab stability`.

mod light;
mod measure;
pub mod solver;
mod whole;

use anyhow::anyhow;
use measure::Operation;
use plotters::prelude::*;
use srbf_reference_renderer::out::output;
use srbf_reference_renderer::out::panel;
use srbf_reference_renderer::out::picture_file;
use std::fmt::Write;
use std::path::PathBuf;

/// Measures the rounding errors of every operation, ours and the textbook's, and of the whole way from material to sample.
///
/// For each operation and decade of sharpness, 1e-8 to 1e8: the worst relative error over many inputs, against f64, of the
/// library's result in f32 and of the plain formula in f32. Light goes from 1e-30 to 1e30. Prints tables and writes a plot. Last
/// comes the solver of the fit, a minute on two processors.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Inputs for each operation and decade
    #[arg(long, default_value_t = 20_000, value_parser = clap::value_parser!(u32).range(1..=100_000_000), value_name = "N")]
    inputs: u32,
    /// Leaves the solver of the fit away
    #[arg(long)]
    no_solver: bool,
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
/// Smallest error that the plot shows; exact results lie on it.
const SMALLEST: f64 = 1e-8;
/// Largest error that the plot shows: no digit is right.
const LARGEST: f64 = 10.0;

/// Runs the command.
pub fn run(args: Args) -> anyhow::Result<()> {
    output::check_extension(&args.output, "png")?;
    output::check_places(&[&args.output, &args.output.with_extension("csv")])?;
    let operations = operations(args.inputs, args.seed);
    println!("Worst relative error, ours / plain formula. Exponents up to 10; f32 rounds to 6e-8.\n");
    let mut csv = String::from("operation,plain_formula,along,at,worst_error,worst_error_plain\n");
    for operation in &operations {
        println!("{}: {}", operation.name, operation.meaning);
        println!("  plain formula: {}", operation.plain);
        println!("  {:>9}       ours      plain", operation.along);
        for row in &operation.rows {
            let lost = if row.plain.is_some_and(is_lost) { "  <- no usable digits" } else { "" };
            let plain = row.plain.map_or_else(|| "-".to_owned(), |plain| format!("{plain:.1e}"));
            println!("  {:9.0e}  {:9.1e}  {plain:>9}{lost}", row.at, row.ours);
            let plain = row.plain.map_or_else(String::new, |plain| format!("{plain:.3e}"));
            let _ = writeln!(
                csv,
                "{},\"{}\",{},{:e},{:.3e},{plain}",
                operation.name, operation.plain, operation.along, row.at, row.ours,
            );
        }
        println!();
    }
    print_worst(&operations);
    let lines = operations.len().div_ceil(COLUMNS);
    let size = [PANEL[0] * COLUMNS as u32, PANEL[1] * lines as u32];
    let mut pixels = vec![255; 3 * (size[0] * size[1]) as usize];
    figure(&mut pixels, size, &operations)
        .map_err(|error| anyhow!("cannot draw {}: {error}", args.output.display()))?;
    picture_file::write_png(&args.output, size, &pixels)?;
    let table = args.output.with_extension("csv");
    output::write(&table, csv.as_bytes())?;
    println!("wrote {} and {}", args.output.display(), table.display());
    if !args.no_solver {
        print_solver()?;
    }
    Ok(())
}

/// Draws of the whole way for each input of an operation: they cost a hundred times as much.
const WHOLE: u32 = 10;

/// All operations, with this number of inputs a decade.
pub fn operations(inputs: u32, seed: u64) -> Vec<Operation> {
    let mut operations = measure::measure(inputs, seed);
    operations.extend(whole::measure(inputs.div_ceil(WHOLE), seed));
    operations.extend(light::measure(inputs.div_ceil(WHOLE), seed));
    operations
}

/// Whether an error leaves no digit that is of use.
fn is_lost(error: f64) -> bool {
    error.is_nan() || error > 1e-2
}

/// The worst of each operation, in a table of Markdown.
fn print_worst(operations: &[Operation]) {
    println!("| operation | worst error | at | no usable digit of the plain formula |\n|---|---|---|---|");
    for operation in operations {
        let Some(worst) = operation.worst() else { continue };
        let lost: Vec<f64> =
            operation.rows.iter().filter(|row| row.plain.is_some_and(is_lost)).map(|row| row.at).collect();
        let lost = match (lost.first(), lost.last()) {
            (Some(first), Some(last)) if first < last => format!("{first:.0e} to {last:.0e}"),
            (Some(only), _) => format!("{only:.0e}"),
            _ => "-".to_owned(),
        };
        let along = operation.along;
        println!("| {} | {:.1e} | {along} {:.0e} | {lost} |", operation.name, worst.ours, worst.at);
    }
    println!();
}

fn print_solver() -> anyhow::Result<()> {
    println!("\nThe solver of the fit: four lobes, tables of peaks of a Gaussian over a diffuse term.\n");
    println!(
        "| table | relative L2, between the views, % | heights over the true ones | evaluations | ended: it | condition |\n\
         |---|---|---|---|---|---|"
    );
    for case in &solver::CASES {
        let solved = case.solve()?;
        let [at, between] = solved.error.map(|error| 100.0 * error);
        let [first, second] = solved.heights;
        println!(
            "| {} | {at:.2}, {between:.2} | {first:.3}, {second:.3} | {} | {} | {:.0e} |",
            solved.name, solved.evaluations, solved.ending, solved.condition
        );
    }
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
        let (first, last) = (rows[0].at, rows[rows.len() - 1].at);
        let mut chart = ChartBuilder::on(cell)
            .margin(10)
            .caption(operation.name, (panel::FONT, 18))
            .x_label_area_size(40)
            .y_label_area_size(64)
            .build_cartesian_2d((first..last).log_scale(), (SMALLEST..1e3 * LARGEST).log_scale())?;
        chart
            .configure_mesh()
            .x_desc(operation.along)
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
        // Where the plain formula leaves the axis: crosses on its edge.
        let plain: Vec<(f64, f64)> = rows.iter().filter_map(|row| Some((row.at, row.plain?))).collect();
        let is_off = |error: f64| error.is_nan() || error >= LARGEST;
        chart.draw_series(
            plain
                .iter()
                .filter(|(_, e)| is_off(*e))
                .map(|(at, _)| Cross::new((*at, LARGEST), 5, orange.stroke_width(2))),
        )?;
        let ours: Vec<(f64, f64)> = rows.iter().map(|row| (row.at, row.ours)).collect();
        for (name, colour, points) in
            [("plain formula; crosses: off the axis", orange, plain), ("srbf", blue, ours)]
        {
            if points.is_empty() {
                continue;
            }
            let inside = points.into_iter().map(|(at, error)| (at, shown(error)));
            chart
                .draw_series(LineSeries::new(inside, colour.stroke_width(2)).point_size(3))?
                .label(name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], colour.stroke_width(2)));
        }
        panel::draw_legend(&mut chart, SeriesLabelPosition::UpperMiddle, 13)?;
    }
    root.present()?;
    Ok(())
}
