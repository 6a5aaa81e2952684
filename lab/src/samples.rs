//! `srbf-lab samples`.

use anyhow::{anyhow, ensure};
use glam::Vec3;
use plotters::prelude::*;
use srbf_core::{Gaussian, Kernel, Metropolis, special};
use srbf_reference_renderer::numbers::random::Random;
use srbf_reference_renderer::out::output;
use srbf_reference_renderer::out::panel;
use srbf_reference_renderer::out::picture_file;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Draws samples of lobes by inversion and by the Metropolis random walk, side by side.
///
/// As figure 5.1 of Weng and Shih 2006: 50, 100, 300 and 600 samples of three lobes, seen from above. Prints how far each
/// set is from the exact distribution (Kolmogorov-Smirnov, over the share of the lobe nearer to its axis, which is
/// uniform in [0, 1] for exact samples), and how the walk's distance falls with its steps.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Steps of the walk for each sample
    #[arg(long, default_value_t = 5, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=100_000))]
    steps: u32,
    /// Smallest value relative to the peak that the walk enters
    #[arg(long, default_value_t = 0.01, value_name = "SHARE")]
    floor: f32,
    /// Seed of the random numbers
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// The picture to write, .png; the numbers go beside it as .csv
    #[arg(short, long, default_value = "out/samples.png", value_name = "FILE")]
    output: PathBuf,
}

impl Args {
    /// The thesis's own figure.
    pub fn new(output: PathBuf) -> Self {
        Self { steps: 5, floor: 0.01, seed: 0, output }
    }
}

/// Numbers of samples in the thesis's figure.
const COUNTS: [usize; 4] = [50, 100, 300, 600];
/// Steps at which the walk is measured.
const STEPS: [u32; 5] = [1, 2, 5, 10, 50];
/// Samples of each of those measurements.
const MEASURED: usize = 100_000;
const SIZE: [u32; 2] = [1000, 2540];

/// A direction, and the share of its lobe that lies nearer to the axis.
struct Drawn {
    direction: Vec3,
    share: f64,
}

/// The three lobes of the figure, with the share of samples of each.
fn lobes() -> [(Gaussian, f32); 3] {
    let lobe = |x: f32, y: f32, sharpness| Gaussian {
        axis: Vec3::new(x, y, (1.0 - x * x - y * y).sqrt()),
        sharpness,
    };
    [(lobe(0.45, 0.0, 60.0), 0.5), (lobe(-0.5, 0.35, 20.0), 0.3), (lobe(-0.1, -0.6, 200.0), 0.2)]
}

/// Samples by inversion, or by the walk.
fn draw(count: usize, walk: Option<Metropolis>, seed: u64) -> Vec<Drawn> {
    let mut random = Random::new(seed, count as u64, u64::from(walk.is_some()));
    let lobes = lobes();
    let ranges = lobes.map(|(g, _)| walk.map_or(0.0, |w| w.range(|x| g.value_at(2.0 * x))));
    (0..count)
        .map(|_| {
            let mut u = random.unit();
            let k = lobes.iter().position(|(_, share)| {
                u -= share;
                u < 0.0
            });
            let k = k.unwrap_or(lobes.len() - 1);
            let g = lobes[k].0;
            let direction = match walk {
                Some(walk) => walk.sample(&g, ranges[k], &mut random),
                None => g.sample([random.unit(), random.unit()]),
            };
            let w = 0.5 * (direction - g.axis).length_squared();
            Drawn { direction, share: f64::from(special::share_within(g.sharpness, w)) }
        })
        .collect()
}

/// Kolmogorov-Smirnov distance of the shares from uniform.
fn distance(drawn: &[Drawn]) -> f64 {
    let mut shares: Vec<f64> = drawn.iter().map(|d| d.share).collect();
    shares.sort_by(f64::total_cmp);
    let n = shares.len() as f64;
    shares
        .iter()
        .enumerate()
        .map(|(i, &x)| (x - i as f64 / n).max((i + 1) as f64 / n - x))
        .fold(0.0, f64::max)
}

/// Runs the command.
pub fn run(args: Args) -> anyhow::Result<()> {
    ensure!((0.0..1.0).contains(&args.floor), "--floor: a number in [0, 1) is expected");
    output::check_extension(&args.output, "png")?;
    output::check_places(&[&args.output, &args.output.with_extension("csv")])?;
    let walk = Metropolis { steps: args.steps, floor: args.floor };
    let mut csv = String::from("method,samples,steps,distance\n");
    let mut rows = Vec::new();
    println!("Distance from the exact distribution; sqrt(n) times it is 0.87 on average for exact samples.");
    println!("  samples   inversion   Metropolis, {} steps, floor {}", args.steps, args.floor);
    for count in COUNTS {
        let pair = [draw(count, None, args.seed), draw(count, Some(walk), args.seed)];
        let [exact, walked] = [distance(&pair[0]), distance(&pair[1])];
        println!("  {count:7}   {exact:9.4}   {walked:10.4}");
        let _ =
            writeln!(csv, "inversion,{count},0,{exact:.6}\nmetropolis,{count},{},{walked:.6}", args.steps);
        rows.push((count, pair));
    }
    println!("The walk with {MEASURED} samples, by steps:");
    let exact = distance(&draw(MEASURED, None, args.seed));
    let _ = writeln!(csv, "inversion,{MEASURED},0,{exact:.6}");
    let mut falls = Vec::new();
    for steps in STEPS {
        let walked = distance(&draw(MEASURED, Some(Metropolis { steps, ..walk }), args.seed));
        println!("  {steps:3} steps   {walked:.4}");
        let _ = writeln!(csv, "metropolis,{MEASURED},{steps},{walked:.6}");
        falls.push((f64::from(steps), walked));
    }
    println!("  inversion   {exact:.4}; the floor alone leaves {:.4}", args.floor);

    let mut pixels = vec![255; 3 * (SIZE[0] * SIZE[1]) as usize];
    figure(&mut pixels, &rows, &falls, exact, walk)
        .map_err(|error| anyhow!("cannot draw {}: {error}", args.output.display()))?;
    picture_file::write_png(&args.output, SIZE, &pixels)?;
    let table: &Path = &args.output.with_extension("csv");
    output::write(table, csv.as_bytes())?;
    println!("wrote {} and {}", args.output.display(), table.display());
    Ok(())
}

fn figure(
    pixels: &mut [u8],
    rows: &[(usize, [Vec<Drawn>; 2])],
    falls: &[(f64, f64)],
    exact: f64,
    walk: Metropolis,
) -> Result<(), Box<dyn std::error::Error>> {
    panel::register_font()?;
    let root = BitMapBackend::with_buffer(pixels, SIZE.into()).into_drawing_area();
    root.fill(&WHITE)?;
    let (figures, below) = root.margin(10, 10, 0, 0).split_vertically(SIZE[1] - 500);
    for (cell, (count, pair)) in figures.split_evenly((rows.len(), 1)).iter().zip(rows) {
        for (i, half) in cell.split_evenly((1, 2)).iter().enumerate() {
            let method = ["inversion".to_owned(), format!("Metropolis, {} steps", walk.steps)][i].clone();
            let title = format!("{method}, {count} samples: distance {:.3}", distance(&pair[i]));
            let half = half.titled(&title, (panel::FONT, 18))?;
            let mut chart = ChartBuilder::on(&half).margin(14).build_cartesian_2d(-1.06..1.06, -1.0..1.0)?;
            // The horizon, and the part of the lobes within half their integral.
            let circle = |radius: f64, axis: Vec3| {
                let (t, b) = axis.any_orthonormal_pair();
                (0..=90).map(move |j| {
                    let (s, c) = (j as f32 / 90.0 * core::f32::consts::TAU).sin_cos();
                    let d = axis * (radius as f32).cos() + (t * c + b * s) * (radius as f32).sin();
                    (f64::from(d.x), f64::from(d.y))
                })
            };
            let grey = RGBColor(170, 170, 170);
            chart.draw_series(LineSeries::new(circle(std::f64::consts::FRAC_PI_2, Vec3::Z), BLACK))?;
            for (g, _) in lobes() {
                let half = f64::from(g.one_minus_cos(0.5));
                chart.draw_series(LineSeries::new(circle((1.0 - half).acos(), g.axis), grey))?;
            }
            let points = pair[i].iter().filter(|d| d.direction.z >= 0.0);
            chart.draw_series(points.map(|d| {
                let place = (f64::from(d.direction.x), f64::from(d.direction.y));
                Circle::new(place, 2, RGBColor(0, 114, 178).filled())
            }))?;
        }
    }
    let least = falls.iter().map(|f| f.1).chain([exact]).fold(f64::INFINITY, f64::min);
    let mut chart = ChartBuilder::on(&below)
        .margin(14)
        .caption("distance of 100 000 samples from the exact distribution", (panel::FONT, 20))
        .x_label_area_size(46)
        .y_label_area_size(78)
        .build_cartesian_2d((0.9..60.0).log_scale(), (least / 2.0..1.0).log_scale())?;
    chart
        .configure_mesh()
        .x_labels(5)
        .x_label_formatter(&|x| format!("{x:.0}"))
        .x_desc("steps of the walk")
        .y_desc("Kolmogorov-Smirnov distance")
        .label_style((panel::FONT, 14))
        .axis_desc_style((panel::FONT, 16))
        .light_line_style(RGBColor(235, 235, 235))
        .draw()?;
    let line = |height: f64| [(0.9, height), (60.0, height)];
    let legend =
        |colour: RGBColor| move |(x, y)| PathElement::new([(x, y), (x + 22, y)], colour.stroke_width(2));
    let [blue, orange, green] = [RGBColor(0, 114, 178), RGBColor(213, 94, 0), RGBColor(0, 158, 115)];
    chart
        .draw_series(LineSeries::new(falls.iter().copied(), orange.stroke_width(2)).point_size(4))?
        .label("Metropolis")
        .legend(legend(orange));
    // A floor of 0 has no place on a logarithmic axis.
    let floor = f64::from(walk.floor);
    if floor > least / 2.0 {
        chart
            .draw_series(LineSeries::new(line(floor), green.stroke_width(2)))?
            .label("share beyond the floor")
            .legend(legend(green));
    }
    chart
        .draw_series(LineSeries::new(line(exact), blue.stroke_width(2)))?
        .label("inversion")
        .legend(legend(blue));
    panel::draw_legend(&mut chart, SeriesLabelPosition::UpperRight, 15)?;
    root.present()?;
    Ok(())
}
