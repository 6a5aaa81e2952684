//! The picture of a fit to samples: for every view the lobes and the completion as curves over the angle of the incident direction in
//! the plane of incidence, the samples near that plane as points.

use crate::picture_file;
use crate::plot::{COLOURS, FONT, Failure, RIGHT_MARGIN, draw_legend, range, register_font, tick};
use anyhow::anyhow;
use plotters::coord::Shift;
use plotters::prelude::*;
use srbf_core::Vec3;
use srbf_fit::complete::Completion;
use srbf_fit::judge::method::Fitted;
use srbf_fit::table::{Brdf, Table, View};
use std::path::Path;

/// Panels in a row, most rows, and pixels of a panel and of what is above them.
const COLUMNS: usize = 3;
const ROWS: usize = 4;
const PANEL: [u32; 2] = [520, 330];
const HEAD: u32 = 36;

/// Samples up to this angle from the plane of incidence are shown, degrees.
const NEAR: f64 = 10.0;

/// Points of a curve, and the last angle on both sides, degrees.
const POINTS: usize = 400;
const LAST: f64 = 88.0;

/// Below this part of what is largest in a panel nothing is shown.
const LEAST: f64 = 1e-5;

/// What is drawn of a view: angle in degrees, mirror side positive, and luminance of `f cos`.
struct Panel {
    degrees: f64,
    samples: Vec<(f64, f64)>,
    completion: Vec<(f64, f64)>,
    lobes: Vec<(f64, f64)>,
}

/// Writes the picture.
///
/// # Errors
/// As the fit says them; names the file that cannot be written.
pub fn write(
    path: &Path,
    name: &str,
    table: &Table,
    completion: &Completion,
    fit: &dyn Fitted,
) -> anyhow::Result<()> {
    let every = table.views.len().div_ceil(COLUMNS * ROWS).max(1);
    let views = table.views.iter().step_by(every);
    let panels = views.map(|view| Panel::new(view, completion, fit)).collect::<anyhow::Result<Vec<_>>>()?;
    let rows = panels.len().div_ceil(COLUMNS) as u32;
    let size = [PANEL[0] * COLUMNS as u32, HEAD + PANEL[1] * rows];
    let mut pixels = vec![255; 3 * (size[0] * size[1]) as usize];
    draw(&mut pixels, size, name, &panels)
        .map_err(|error| anyhow!("cannot plot {}: {error}", path.display()))?;
    picture_file::write_png(path, size, &pixels)
}

fn luminance(rgb: [f64; 3]) -> f64 {
    let [r, g, b] = rgb.map(|v| v as f32);
    f64::from(srbf_core::luminance(Vec3::new(r, g, b)))
}

impl Panel {
    fn new(view: &View, completion: &Completion, fit: &dyn Fitted) -> anyhow::Result<Self> {
        let fitted = fit.view(view.theta)?;
        let (sin, cos) = view.theta.sin_cos();
        let wo = [-sin, 0.0, cos];
        let angles = (0..=POINTS).map(|n| LAST * (2.0 * n as f64 / POINTS as f64 - 1.0));
        let along = |value: &dyn Fn([f64; 3]) -> [f64; 3]| {
            let at = |degrees: f64| {
                let (sin, cos) = degrees.to_radians().sin_cos();
                (degrees, luminance(value([sin, 0.0, cos])))
            };
            angles.clone().map(at).collect::<Vec<_>>()
        };
        let near = view.samples.iter().filter(|s| s.direction[1].asin().to_degrees().abs() <= NEAR);
        let samples = near.map(|s| {
            let [x, _, z] = s.direction;
            (x.atan2(z).to_degrees(), luminance(s.rgb) * z)
        });
        Ok(Self {
            degrees: view.theta.to_degrees(),
            samples: samples.collect(),
            completion: along(&|wi| completion.evaluate(wi, wo).map(|f| f * wi[2])),
            lobes: along(&|wi| fitted.f_cos(wi)),
        })
    }
}

fn draw(pixels: &mut [u8], size: [u32; 2], name: &str, panels: &[Panel]) -> Result<(), Failure> {
    register_font()?;
    let root = BitMapBackend::with_buffer(pixels, size.into()).into_drawing_area();
    root.fill(&WHITE)?;
    let title = format!("{name}: samples within {NEAR} degrees of the plane of incidence, and the fit in it");
    let root = root.titled(&title, (FONT, 20))?;
    let areas = root.split_evenly((panels.len().div_ceil(COLUMNS).max(1), COLUMNS));
    for (n, (area, panel)) in areas.iter().zip(panels).enumerate() {
        draw_panel(area, panel, n == 0)?;
    }
    root.present()?;
    Ok(())
}

fn draw_panel(
    area: &DrawingArea<BitMapBackend<'_>, Shift>,
    panel: &Panel,
    has_legend: bool,
) -> Result<(), Failure> {
    let values = || [&panel.samples, &panel.completion, &panel.lobes].into_iter().flatten().map(|p| p.1);
    let most = values().fold(0.0, f64::max);
    let shown = |v: f64| v > LEAST * most;
    let y = range(values().filter(|v| shown(*v)));
    let mut chart = ChartBuilder::on(area)
        .margin(8)
        .margin_right(RIGHT_MARGIN)
        .x_label_area_size(36)
        .y_label_area_size(66)
        .caption(format!("view at {:.1} degrees", panel.degrees), (FONT, 15))
        .build_cartesian_2d(-90.0..90.0, (y[0]..y[1]).log_scale())?;
    chart
        .configure_mesh()
        .x_desc("wi, degrees; mirror side right")
        .y_desc("f cos, 1/sr")
        .x_labels(7)
        .label_style((FONT, 12))
        .axis_desc_style((FONT, 13))
        .y_label_formatter(&tick)
        .light_line_style(RGBColor(235, 235, 235))
        .draw()?;
    let curves = [("completed samples", &panel.completion, COLOURS[7]), ("lobes", &panel.lobes, COLOURS[0])];
    for (name, curve, colour) in curves {
        let line = colour.stroke_width(2);
        // In pieces: what is not shown is no point of a line.
        let pieces = curve.windows(2).filter(|pair| pair.iter().all(|p| shown(p.1)));
        chart
            .draw_series(pieces.map(|pair| PathElement::new(pair.to_vec(), line)))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], line));
    }
    let colour = COLOURS[1];
    let points = panel.samples.iter().filter(|p| shown(p.1));
    chart
        .draw_series(points.map(|&point| Circle::new(point, 3, colour.filled())))?
        .label("samples")
        .legend(move |(x, y)| Circle::new((x + 9, y), 3, colour.filled()));
    if has_legend {
        draw_legend(&mut chart, SeriesLabelPosition::UpperLeft, 12)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_with_and_without_what_can_be_shown_are_drawn() {
        let curve = |value: f64| vec![(-30.0, value), (0.0, 2.0 * value), (30.0, value)];
        let panel = |value| Panel {
            degrees: 30.0,
            samples: curve(value),
            completion: curve(value),
            lobes: curve(value),
        };
        for panels in [vec![], vec![panel(0.0)], vec![panel(0.1), panel(-1.0), panel(0.2), panel(3.0)]] {
            let size = [PANEL[0] * 3, HEAD + 2 * PANEL[1]];
            let mut pixels = vec![255; 3 * (size[0] * size[1]) as usize];
            draw(&mut pixels, size, "test", &panels).unwrap();
            assert!(pixels.iter().filter(|&&p| p < 128).count() > 1000, "no letters");
        }
    }
}
