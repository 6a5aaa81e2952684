//! Values in the plane of incidence over the angle of the incident direction, a panel a view: the fit and its data as
//! curves, samples near that plane as points.

use super::{Against, Strip, Subject, WIDTH, y};
use crate::out::panel::{COLOURS, FONT, Failure, RIGHT_MARGIN, draw_legend, range, register_font, tick};
use anyhow::anyhow;
use plotters::coord::Shift;
use plotters::prelude::*;
use srbf_fit::judge::method::Fitted;
use srbf_fit::table::View;

/// Panels in a row, most rows, height of a panel and of the text above them, pixels.
const COLUMNS: usize = 3;
const ROWS: usize = 4;
const PANEL: u32 = 290;
const HEAD: u32 = 36;

/// Outgoing directions that are drawn where no samples name them, degrees from the normal.
const VIEWS: [f64; 6] = [5.0, 25.0, 45.0, 60.0, 70.0, 80.0];

/// Samples up to this angle from the plane of incidence are shown, degrees.
const NEAR: f64 = 10.0;

/// Points of a curve, and the last angle on both sides, degrees.
const POINTS: usize = 400;
const LAST: f64 = 88.0;

/// Values below this share of the largest in a panel are not shown.
const LEAST: f64 = 1e-5;

/// The curve of a view: angle in degrees, mirror side positive, and luminance of `f cos`.
struct Panel {
    degrees: f64,
    samples: Vec<(f64, f64)>,
    against: Vec<(f64, f64)>,
    fit: Vec<(f64, f64)>,
}

/// Draws the panels.
///
/// # Errors
/// As the fit says them; faults of the font.
pub fn draw(subject: &Subject<'_>) -> anyhow::Result<Strip> {
    let against = subject.against.as_ref();
    let panel = |theta: f64, view: Option<&View>| Panel::new(theta, subject.fit, against, view);
    let panels: Vec<Panel> = match against.and_then(|against| against.samples) {
        Some(table) => {
            let every = table.views.len().div_ceil(COLUMNS * ROWS).max(1);
            table
                .views
                .iter()
                .step_by(every)
                .map(|view| panel(view.theta, Some(view)))
                .collect::<anyhow::Result<_>>()?
        }
        None => {
            VIEWS.iter().map(|degrees| panel(degrees.to_radians(), None)).collect::<anyhow::Result<_>>()?
        }
    };
    let names = Names { title: title(subject), against: against.map_or("", |against| against.name) };
    let rows = panels.len().div_ceil(COLUMNS).max(1) as u32;
    let mut block = Strip::white([WIDTH, HEAD + PANEL * rows]);
    draw_panels(&mut block, &names, &panels)
        .map_err(|error| anyhow!("cannot plot {}: {error}", subject.name))?;
    Ok(block)
}

/// Texts of the block.
struct Names<'a> {
    title: String,
    against: &'a str,
}

fn title(subject: &Subject<'_>) -> String {
    let samples = subject.against.as_ref().is_some_and(|against| against.samples.is_some());
    let near = if samples { format!(", samples within {NEAR} degrees of it") } else { String::new() };
    format!("{}: f cos in the plane of incidence{near}", subject.name)
}

impl Panel {
    fn new(
        theta: f64,
        fit: &dyn Fitted,
        against: Option<&Against<'_>>,
        view: Option<&View>,
    ) -> anyhow::Result<Self> {
        let fitted = fit.view(theta)?;
        let (sin, cos) = theta.sin_cos();
        let wo = [-sin, 0.0, cos];
        let angles = (0..=POINTS).map(|n| LAST * (2.0 * n as f64 / POINTS as f64 - 1.0));
        let along = |value: &dyn Fn([f64; 3]) -> [f64; 3]| {
            let at = |degrees: f64| {
                let (sin, cos) = degrees.to_radians().sin_cos();
                (degrees, y(value([sin, 0.0, cos])))
            };
            angles.clone().map(at).collect::<Vec<_>>()
        };
        let samples = view.into_iter().flat_map(|view| &view.samples);
        let near = samples.filter(|s| s.direction[1].asin().to_degrees().abs() <= NEAR);
        let samples = near.map(|s| {
            let [x, _, z] = s.direction;
            (x.atan2(z).to_degrees(), y(s.rgb) * z)
        });
        Ok(Self {
            degrees: theta.to_degrees(),
            samples: samples.collect(),
            against: against
                .map_or_else(Vec::new, |a| along(&|wi| a.brdf.evaluate(wi, wo).map(|f| f * wi[2]))),
            fit: along(&|wi| fitted.f_cos(wi)),
        })
    }
}

fn draw_panels(block: &mut Strip, names: &Names<'_>, panels: &[Panel]) -> Result<(), Failure> {
    register_font()?;
    let root = BitMapBackend::with_buffer(&mut block.rgb, block.size.into()).into_drawing_area();
    let root = root.titled(&names.title, (FONT, 20))?;
    let areas = root.split_evenly((panels.len().div_ceil(COLUMNS).max(1), COLUMNS));
    for (n, (area, panel)) in areas.iter().zip(panels).enumerate() {
        draw_panel(area, panel, (n == 0).then_some(names.against))?;
    }
    root.present()?;
    Ok(())
}

fn draw_panel(
    area: &DrawingArea<BitMapBackend<'_>, Shift>,
    panel: &Panel,
    legend: Option<&str>,
) -> Result<(), Failure> {
    let values = || [&panel.samples, &panel.against, &panel.fit].into_iter().flatten().map(|p| p.1);
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
    let curves = [(legend.unwrap_or_default(), &panel.against, COLOURS[7]), ("fit", &panel.fit, COLOURS[0])];
    for (name, curve, colour) in curves.into_iter().filter(|(_, curve, _)| !curve.is_empty()) {
        let line = colour.stroke_width(2);
        // In pieces: a hidden value is no point of a line.
        let pieces = curve.windows(2).filter(|pair| pair.iter().all(|p| shown(p.1)));
        chart
            .draw_series(pieces.map(|pair| PathElement::new(pair.to_vec(), line)))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], line));
    }
    if !panel.samples.is_empty() {
        let colour = COLOURS[1];
        let points = panel.samples.iter().filter(|p| shown(p.1));
        chart
            .draw_series(points.map(|&point| Circle::new(point, 3, colour.filled())))?
            .label("samples")
            .legend(move |(x, y)| Circle::new((x + 9, y), 3, colour.filled()));
    }
    if legend.is_some() {
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
        let panel =
            |value| Panel { degrees: 30.0, samples: curve(value), against: curve(value), fit: curve(value) };
        let alone = || Panel { samples: vec![], against: vec![], ..panel(1.0) };
        for panels in [vec![], vec![panel(0.0)], vec![panel(0.1), panel(-1.0), panel(0.2), alone()]] {
            let mut block = Strip::white([WIDTH, HEAD + 2 * PANEL]);
            let names = Names { title: "test".into(), against: "data" };
            draw_panels(&mut block, &names, &panels).unwrap();
            assert!(
                block.rgb.iter().filter(|&&p| p < 128).count() > if panels.is_empty() { 50 } else { 1000 },
                "no letters"
            );
        }
    }
}
