//! Plots of comparisons: two panels with logarithmic axes, as a PNG. Letters come from an embedded font.

use crate::comparison::{Comparison, Curve, Point};
use crate::picture_file;
use anyhow::anyhow;
use plotters::coord::Shift;
use plotters::coord::combinators::LogCoord;
use plotters::prelude::*;
use std::path::Path;

const WIDTH: u32 = 1200;
/// Height of the panels of one comparison.
const HEIGHT: u32 = 520;
/// Free pixels on the right of a panel: half of the last label of the axis lies there.
pub const RIGHT_MARGIN: u32 = 40;
/// Name of the embedded font.
pub const FONT: &str = "hack";

/// Okabe and Ito 2008: told apart by every kind of colour vision.
pub const COLOURS: [RGBColor; 9] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    BLACK,
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(150, 150, 150),
    RGBColor(240, 228, 66),
];

/// Writes one row of two panels for each comparison: error against run time, and error against samples.
///
/// # Errors
/// Names the file.
pub fn write_png(path: &Path, comparisons: &[Comparison]) -> anyhow::Result<()> {
    let rows = comparisons.len().max(1) as u32;
    let size = [WIDTH, HEIGHT * rows];
    let mut pixels = vec![255; 3 * (size[0] * size[1]) as usize];
    draw(&mut pixels, size, comparisons)
        .map_err(|error| anyhow!("cannot plot {}: {error}", path.display()))?;
    picture_file::write_png(path, size, &pixels)
}

/// Whatever plotters reports.
pub type Failure = Box<dyn std::error::Error>;

/// Makes the embedded font known to plotters.
pub fn register_font() -> Result<(), &'static str> {
    plotters::style::register_font(FONT, FontStyle::Normal, epaint_default_fonts::HACK_REGULAR)
        .map_err(|_| "the embedded font is unreadable")
}

fn draw(pixels: &mut [u8], size: [u32; 2], comparisons: &[Comparison]) -> Result<(), Failure> {
    register_font()?;
    let root = BitMapBackend::with_buffer(pixels, size.into()).into_drawing_area();
    root.fill(&WHITE)?;
    for (row, comparison) in root.split_evenly((comparisons.len().max(1), 1)).iter().zip(comparisons) {
        let title = format!("{}, sphere under {}", comparison.material, comparison.environment);
        let row = row.titled(&title, (FONT, 20))?;
        let panels = row.split_evenly((1, 2));
        panel(&panels[0], comparison, "run time, seconds", |p| p.seconds)?;
        panel(&panels[1], comparison, "samples per pixel", |p| f64::from(p.samples))?;
    }
    root.present()?;
    Ok(())
}

fn panel(
    area: &DrawingArea<BitMapBackend<'_>, Shift>,
    comparison: &Comparison,
    label: &str,
    abscissa: fn(&Point) -> f64,
) -> Result<(), Failure> {
    let points = || comparison.curves.iter().flat_map(Curve::known);
    let [x_range, y_range] = [range(points().map(abscissa)), range(points().map(|p| p.error))];
    let mut chart = ChartBuilder::on(area)
        .margin(12)
        .margin_right(RIGHT_MARGIN)
        .x_label_area_size(46)
        .y_label_area_size(78)
        .build_cartesian_2d((x_range[0]..x_range[1]).log_scale(), (y_range[0]..y_range[1]).log_scale())?;
    chart
        .configure_mesh()
        .x_desc(label)
        .y_desc("relative RMS error")
        .label_style((FONT, 14))
        .axis_desc_style((FONT, 16))
        .x_label_formatter(&tick)
        .y_label_formatter(&tick)
        .light_line_style(RGBColor(235, 235, 235))
        .draw()?;
    for (curve, &colour) in comparison.curves.iter().zip(COLOURS.iter().cycle()) {
        let places: Vec<(f64, f64)> = curve.known().map(|p| (abscissa(p), p.error)).collect();
        let slope = curve.slope().map_or_else(|| "-".to_owned(), |slope| format!("{slope:.2}"));
        add_curve(&mut chart, format!("{}, slope {slope}", curve.sampler.name()), colour, &places)?;
    }
    draw_legend(&mut chart, SeriesLabelPosition::UpperRight, 15)
}

/// Draws the names of the curves in a frame.
pub fn draw_legend<'a, 'b: 'a, C: CoordTranslate>(
    chart: &mut ChartContext<'a, BitMapBackend<'b>, C>,
    position: SeriesLabelPosition,
    size: u32,
) -> Result<(), Failure> {
    chart
        .configure_series_labels()
        .position(position)
        .label_font((FONT, size))
        .background_style(WHITE)
        .border_style(BLACK)
        .draw()?;
    Ok(())
}

/// A chart with two logarithmic axes.
pub type Chart<'a, 'b> = ChartContext<'a, BitMapBackend<'b>, Cartesian2d<LogCoord<f64>, LogCoord<f64>>>;

/// Draws the points of a curve and what joins them, and puts its name into the legend.
pub fn add_curve(
    chart: &mut Chart<'_, '_>,
    name: String,
    colour: RGBColor,
    places: &[(f64, f64)],
) -> Result<(), Failure> {
    let line = colour.stroke_width(2);
    // Piece by piece: where a curve turns back, the mitre between two pieces would be a stroke of its own.
    chart
        .draw_series(places.windows(2).map(|pair| PathElement::new(pair.to_vec(), line)))?
        .label(name)
        .legend(move |(x, y)| PathElement::new([(x, y), (x + 22, y)], line));
    chart.draw_series(places.iter().map(|&place| Circle::new(place, 4, colour.filled())))?;
    Ok(())
}

/// The range of positive values, widened to powers of ten; what is not positive has no place on a logarithmic axis.
pub fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let [low, high] = values
        .filter(|v| *v > 0.0 && v.is_finite())
        .fold([f64::INFINITY, 0.0], |[low, high], v| [f64::min(low, v), f64::max(high, v)]);
    if high == 0.0 {
        return [0.1, 1.0];
    }
    let power = |exponent: f64| 10f64.powi(exponent as i32);
    // A little beyond, or rounding would leave the first tick or the last outside.
    let beyond = 1.0 + 1e-9;
    [power((low / 1.05).log10().floor()) / beyond, power((high * 1.05).log10().ceil()) * beyond]
}

/// Powers of ten and what lies between, without needless zeros.
pub fn tick(value: &f64) -> String {
    if (1e-4..1e6).contains(value) {
        format!("{}", (value * 1e6).round() / 1e6)
    } else {
        format!("{value:.0e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::Sampler;

    #[test]
    fn the_ticks_at_both_ends_lie_within_the_range() {
        for (low, high) in [(0.11, 0.9), (1e-3, 0.5), (2.0, 4e4)] {
            let [from, to] = range([low, high].into_iter());
            let ticks = (-9..9).map(|n| 10f64.powi(n)).filter(|t| from < *t && *t < to);
            let ends = ticks.fold([f64::INFINITY, 0.0], |[a, b], t| [f64::min(a, t), f64::max(b, t)]);
            assert!(ends[0] <= low && high <= ends[1], "{from} {to}");
        }
    }

    #[test]
    fn plots_without_fonts_of_the_system_and_without_points() {
        let point = |samples: u32| Point { samples, seconds: 1e-3 * f64::from(samples), error: 0.1 };
        for points in [vec![], vec![point(1)], vec![point(1), point(4096)]] {
            let comparison = Comparison {
                material: "test".into(),
                environment: "sky".into(),
                curves: vec![Curve { sampler: Sampler::Lobes, points }],
                reference_error: 0.0,
            };
            let mut pixels = vec![255; 3 * (WIDTH * HEIGHT) as usize];
            draw(&mut pixels, [WIDTH, HEIGHT], &[comparison]).unwrap();
            assert!(pixels.iter().filter(|&&p| p < 128).count() > 1000, "no letters");
        }
    }
}
