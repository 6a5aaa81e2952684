//! Panels of plots: logarithmic axes, curves, marks, colours and the embedded font.

use plotters::coord::Shift;
use plotters::coord::combinators::LogCoord;
use plotters::prelude::*;

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

/// Whatever plotters reports.
pub type Failure = Box<dyn std::error::Error>;

/// Makes the embedded font known to plotters.
pub fn register_font() -> Result<(), &'static str> {
    plotters::style::register_font(FONT, FontStyle::Normal, epaint_default_fonts::HACK_REGULAR)
        .map_err(|_| "the embedded font is unreadable")
}

/// Colour of a curve.
pub fn colour(n: usize) -> RGBColor {
    COLOURS[n % COLOURS.len()]
}

/// Mark of a curve: another shape where the colours begin again.
pub fn marker<'b>(n: usize, at: (i32, i32)) -> DynElement<'static, BitMapBackend<'b>, (i32, i32)> {
    let style = colour(n).filled();
    match n / COLOURS.len() {
        0 => Circle::new(at, 4, style).into_dyn(),
        1 => TriangleMarker::new(at, 6, style).into_dyn(),
        _ => Cross::new(at, 5, colour(n).stroke_width(2)).into_dyn(),
    }
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

/// Makes a panel with logarithmic axes and their labels.
pub fn axes<'a, 'b>(
    area: &'a DrawingArea<BitMapBackend<'b>, Shift>,
    [x_label, y_label]: [&str; 2],
    x: [f64; 2],
    y: [f64; 2],
) -> Result<Chart<'a, 'b>, Failure> {
    let mut chart = ChartBuilder::on(area)
        .margin(12)
        .margin_right(RIGHT_MARGIN)
        .x_label_area_size(46)
        .y_label_area_size(78)
        .build_cartesian_2d((x[0]..x[1]).log_scale(), (y[0]..y[1]).log_scale())?;
    chart
        .configure_mesh()
        .x_desc(x_label)
        .y_desc(y_label)
        .label_style((FONT, 14))
        .axis_desc_style((FONT, 16))
        .x_label_formatter(&tick)
        .y_label_formatter(&tick)
        .light_line_style(RGBColor(235, 235, 235))
        .draw()?;
    Ok(chart)
}

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

/// The range of positive values, widened to powers of ten; other values have no place on a logarithmic axis.
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

/// Powers of ten and numbers between, without needless zeros.
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

    #[test]
    fn the_ticks_at_both_ends_lie_within_the_range() {
        for (low, high) in [(0.11, 0.9), (1e-3, 0.5), (2.0, 4e4)] {
            let [from, to] = range([low, high].into_iter());
            let ticks = (-9..9).map(|n| 10f64.powi(n)).filter(|t| from < *t && *t < to);
            let ends = ticks.fold([f64::INFINITY, 0.0], |[a, b], t| [f64::min(a, t), f64::max(b, t)]);
            assert!(ends[0] <= low && high <= ends[1], "{from} {to}");
        }
    }
}
