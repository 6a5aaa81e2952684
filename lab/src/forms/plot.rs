//! A table of forms as a picture: error against bytes, and against the cost of a call.

use anyhow::anyhow;
use plotters::coord::Shift;
use plotters::prelude::*;
use srbf_reference_renderer::out::panel::{
    COLOURS, FONT, Failure, add_curve, axes, draw_legend, range, register_font,
};
use srbf_reference_renderer::out::picture_file;
use std::path::Path;

const SIZE: [u32; 2] = [1200, 520];

/// A form of a material: its costs and its error.
#[derive(Clone, Debug)]
pub struct Point {
    /// Mean relative L2 error.
    pub error: f64,
    pub bytes: usize,
    /// Nanoseconds of one call of each kind.
    pub nanoseconds: [f64; 3],
}

/// The abscissa of a panel for a form.
type Abscissa = fn(&Point) -> f64;

/// Writes the picture.
///
/// # Errors
/// Names the file.
pub fn write(path: &Path, title: &str, calls: [&str; 3], points: &[Point]) -> anyhow::Result<()> {
    let mut pixels = vec![255; 3 * (SIZE[0] * SIZE[1]) as usize];
    draw(&mut pixels, title, calls, points)
        .map_err(|error| anyhow!("cannot plot {}: {error}", path.display()))?;
    picture_file::write_png(path, SIZE, &pixels)
}

fn draw(pixels: &mut [u8], title: &str, calls: [&str; 3], rows: &[Point]) -> Result<(), Failure> {
    register_font()?;
    let root = BitMapBackend::with_buffer(pixels, SIZE.into()).into_drawing_area();
    root.fill(&WHITE)?;
    let titled = root.titled(title, (FONT, 20))?;
    let panels = titled.split_evenly((1, 2));
    panel(&panels[0], rows, "bytes", &[("material", |r| r.bytes as f64)])?;
    let costs: [(&str, Abscissa); 3] = [
        (calls[0], |r| r.nanoseconds[0]),
        (calls[1], |r| r.nanoseconds[1]),
        (calls[2], |r| r.nanoseconds[2]),
    ];
    panel(&panels[1], rows, "nanoseconds a call", &costs)?;
    root.present()?;
    Ok(())
}

fn panel(
    area: &DrawingArea<BitMapBackend<'_>, Shift>,
    rows: &[Point],
    label: &str,
    curves: &[(&str, Abscissa)],
) -> Result<(), Failure> {
    let error = |r: &Point| 100.0 * r.error;
    let x = range(curves.iter().flat_map(|(_, abscissa)| rows.iter().map(abscissa)));
    let y = range(rows.iter().map(error));
    let mut chart = axes(area, [label, "relative L2 error, %"], x, y)?;
    for ((name, abscissa), &colour) in curves.iter().zip(&COLOURS) {
        let places: Vec<(f64, f64)> = rows.iter().map(|r| (abscissa(r), error(r))).collect();
        add_curve(&mut chart, (*name).to_owned(), colour, &places)?;
    }
    draw_legend(&mut chart, SeriesLabelPosition::UpperRight, 15)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_of_one_row_and_of_none_is_drawn() {
        let row = Point { error: 0.1, bytes: 900, nanoseconds: [5.0, 6.0, 7.0] };
        for rows in [vec![], vec![row]] {
            let mut pixels = vec![255; 3 * (SIZE[0] * SIZE[1]) as usize];
            draw(&mut pixels, "test", ["a", "b", "c"], &rows).unwrap();
            assert!(pixels.iter().filter(|&&p| p < 128).count() > 1000, "no letters");
        }
    }
}
