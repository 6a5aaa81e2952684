//! Plots of comparisons: two panels with logarithmic axes, as a PNG. Letters come from an embedded font.

use crate::out::output;
use crate::out::panel::{FONT, Failure, axes, colour, marker, range, register_font};
use crate::out::picture_file;
use crate::out::print::shown;
use crate::study::comparison::{Comparison, Curve, Estimate, Point};
use anyhow::{Context, anyhow};
use plotters::coord::Shift;
use plotters::prelude::*;
use std::path::Path;

const WIDTH: u32 = 1240;
/// What of it the names of the curves take, on the right.
const NAMES_WIDTH: u32 = 220;
/// Height of the panels of one comparison.
const HEIGHT: u32 = 500;
/// Of the line of slope -1/2.
const GREY: RGBColor = RGBColor(120, 120, 120);

/// Writes one row of two panels for each comparison: error against run time, and error against samples.
///
/// # Errors
/// Names the file.
pub fn write_png(path: &Path, comparisons: &[Comparison]) -> anyhow::Result<()> {
    let all: Vec<&Comparison> = comparisons.iter().collect();
    let png = png(&all).with_context(|| format!("cannot plot {}", shown(path)))?;
    output::write(path, &png)
}

/// The bytes of the PNG file that [`write_png`] writes.
///
/// # Errors
/// What plotters reports.
pub fn png(comparisons: &[&Comparison]) -> anyhow::Result<Vec<u8>> {
    let rows = comparisons.len().max(1) as u32;
    let size = [WIDTH, HEIGHT * rows];
    let mut pixels = vec![255; 3 * (size[0] * size[1]) as usize];
    draw(&mut pixels, size, comparisons).map_err(|error| anyhow!("cannot plot: {error}"))?;
    picture_file::encode_png(size, &pixels)
}

fn draw(pixels: &mut [u8], size: [u32; 2], comparisons: &[&Comparison]) -> Result<(), Failure> {
    register_font()?;
    let root = BitMapBackend::with_buffer(pixels, size.into()).into_drawing_area();
    root.fill(&WHITE)?;
    for (row, comparison) in root.split_evenly((comparisons.len().max(1), 1)).iter().zip(comparisons) {
        let row = row.titled(&comparison.title(), (FONT, 20))?;
        let (panels, names) = row.split_horizontally(WIDTH - NAMES_WIDTH);
        let panels = panels.split_evenly((1, 2));
        panel(&panels[0], comparison, "run time of processors, seconds", |p| p.seconds)?;
        panel(&panels[1], comparison, "samples per pixel", |p| f64::from(p.samples))?;
        name_curves(&names, comparison)?;
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
    let [x_range, y_range] = [range(points().map(abscissa)), range(points().map(Point::rmse))];
    let mut chart = axes(area, [label, "relative RMS error"], x_range, y_range)?;
    if let Some(first) = points().next() {
        chart.draw_series(half_line([abscissa(first), first.rmse()], x_range, y_range))?;
    }
    for (n, curve) in comparison.curves.iter().enumerate() {
        let (colour, line) = (colour(n), colour(n).stroke_width(2));
        let places: Vec<(f64, f64)> = curve.known().map(|p| (abscissa(p), p.rmse())).collect();
        // Piece by piece: where a curve turns back, the mitre between two pieces would be a stroke of its own.
        chart.draw_series(places.windows(2).map(|pair| PathElement::new(pair.to_vec(), line)))?;
        chart.draw_series(curve.known().filter_map(|p| {
            let (low, high) = bar(p)?;
            let ends = vec![(abscissa(p), low.max(y_range[0])), (abscissa(p), high.min(y_range[1]))];
            Some(PathElement::new(ends, colour))
        }))?;
        chart.draw_series(places.iter().map(|&place| EmptyElement::at(place) + marker(n, (0, 0))))?;
    }
    Ok(())
}

/// Dashes that fall by the square root from a point on: what independent samples do.
fn half_line([x, y]: [f64; 2], x_range: [f64; 2], y_range: [f64; 2]) -> Vec<PathElement<(f64, f64)>> {
    let dashes = 40;
    let end = x_range[1].min(x * (y / y_range[0]).powi(2));
    let at = |share: f64| {
        let here = x * (end / x).powf(share);
        (here, y * (x / here).sqrt())
    };
    let dash =
        |i: i32| vec![at(f64::from(i) / f64::from(dashes)), at((f64::from(i) + 0.5) / f64::from(dashes))];
    (0..dashes).map(|i| PathElement::new(dash(i), GREY)).collect()
}

/// Root mean squared errors one standard error below and above; none where it is as large as the error.
fn bar(point: &Point) -> Option<(f64, f64)> {
    let Estimate { mean, error } = point.mse;
    (error > 0.0 && error < mean).then(|| ((mean - error).sqrt(), (mean + error).sqrt()))
}

/// The names of the curves, one below the other, beside the panels.
fn name_curves(area: &DrawingArea<BitMapBackend<'_>, Shift>, comparison: &Comparison) -> Result<(), Failure> {
    let step = ((HEIGHT - 90) / (comparison.curves.len() as u32 + 2).max(1)).min(24) as i32;
    let style = (FONT, (step - 4).clamp(9, 15)).into_font().color(&BLACK);
    let line = |row: usize| 20 + step * (row as i32 + 1);
    area.draw(&Text::new("method, slope", (0, 20 - step / 3), style.clone()))?;
    for (n, curve) in comparison.curves.iter().enumerate() {
        let y = line(n);
        area.draw(&PathElement::new([(0, y), (24, y)], colour(n).stroke_width(2)))?;
        area.draw(&(EmptyElement::at((12, y)) + marker(n, (0, 0))))?;
        let slope = curve.slope().map_or_else(|| "-".to_owned(), |slope| format!("{slope:.2}"));
        area.draw(&Text::new(format!("{}, {slope}", curve.method), (32, y - step / 3), style.clone()))?;
    }
    let y = line(comparison.curves.len());
    for dash in 0..3 {
        area.draw(&PathElement::new([(9 * dash, y), (9 * dash + 5, y)], GREY))?;
    }
    area.draw(&Text::new("slope -1/2", (32, y - step / 3), style))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::comparison::ReferenceReport;
    use crate::study::comparison::curve::tests::{curve, point};

    #[test]
    fn plots_without_fonts_of_the_system_and_without_points() {
        for points in [vec![], vec![point(1, 1e-3, 0.1)], vec![point(1, 1e-3, 0.1), point(4096, 4.0, 0.1)]] {
            let comparison = Comparison {
                scene: "sphere",
                material: "test".into(),
                environment: "sky".into(),
                size: [1, 1],
                curves: vec![curve(points); 20],
                reference: ReferenceReport::default(),
            };
            let mut pixels = vec![255; 3 * (WIDTH * HEIGHT) as usize];
            draw(&mut pixels, [WIDTH, HEIGHT], &[&comparison]).unwrap();
            assert!(pixels.iter().filter(|&&p| p < 128).count() > 1000, "no letters");
        }
    }
}
