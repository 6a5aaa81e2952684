//! Values in the plane of incidence over the angle of the incident direction, a panel a view: the fit and its data as
//! curves, samples in that plane as points.

use super::{ACCENT, Against, Area, INK, LETTERS, QUIET, RULE, Subject, text, y};
use crate::out::panel::{FONT, Failure};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use srbf_fit::judge::method::Fitted;
use srbf_fit::table::View;

/// Outgoing directions that are drawn where no samples name them, degrees from the normal: beside three balls, and beside one.
const FEW: [f64; 3] = [5.0, 45.0, 75.0];
const VIEWS: [f64; 5] = [5.0, 30.0, 45.0, 60.0, 75.0];

/// Sine of the angle from the plane of incidence up to which a sample counts as in it: of two degrees, as on the page.
const OFF_PLANE: f64 = 0.035;

/// Points of a curve, and the last angle on both sides, degrees.
const POINTS: usize = 400;
const LAST: f64 = 88.0;

/// Powers of ten that are shown below the largest value.
const DECADES: i32 = 4;

/// The curve of a view: angle in degrees, mirror side positive, and luminance of `f cos`.
pub struct Panel {
    degrees: f64,
    samples: Vec<(f64, f64)>,
    against: Vec<(f64, f64)>,
    fit: Vec<(f64, f64)>,
}

/// The panels: of the views with samples in the plane, up to five of them, or of fixed ones. With the balls they are even in number.
///
/// # Errors
/// As the fit says them.
pub fn panels(subject: &Subject<'_>) -> anyhow::Result<Vec<Panel>> {
    let against = subject.against.as_ref();
    let panel = |theta: f64, view: Option<&View>| Panel::new(theta, subject.fit, against, view);
    let views = against.and_then(|against| against.samples).map_or(&[][..], |table| &table.views[..]);
    let seen: Vec<&View> = views.iter().filter(|view| in_plane(view).next().is_some()).collect();
    if seen.is_empty() {
        let fixed = if subject.ball_beside.is_some() { &FEW[..] } else { &VIEWS };
        return fixed.iter().map(|degrees| panel(degrees.to_radians(), None)).collect();
    }
    // From the first to the last.
    let count = seen.len().min(VIEWS.len());
    let places = (0..count).map(|n| n * (seen.len() - 1) / count.saturating_sub(1).max(1));
    let mut panels: Vec<Panel> =
        places.map(|n| panel(seen[n].theta, Some(seen[n]))).collect::<anyhow::Result<_>>()?;
    if count.is_multiple_of(2) {
        panels.push(panel(VIEWS[3].to_radians(), None)?);
    }
    Ok(panels)
}

/// The samples of a view in its plane of incidence: angle in degrees, and luminance of `f cos`.
fn in_plane(view: &View) -> impl Iterator<Item = (f64, f64)> {
    view.samples.iter().filter(|s| s.direction[1].abs() <= OFF_PLANE).map(|s| {
        let [x, _, z] = s.direction;
        (x.atan2(z).to_degrees(), y(s.rgb) * z)
    })
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
        Ok(Self {
            degrees: theta.to_degrees(),
            samples: view.map_or_else(Vec::new, |view| in_plane(view).collect()),
            against: against
                .map_or_else(Vec::new, |a| along(&|wi| a.brdf.evaluate(wi, wo).map(|f| f * wi[2]))),
            fit: along(&|wi| fitted.f_cos(wi)),
        })
    }
}

/// Draws a panel.
///
/// # Errors
/// Faults of the font.
pub fn draw(area: &Area<'_>, panel: &Panel) -> Result<(), Failure> {
    let values = || [&panel.samples, &panel.against, &panel.fit].into_iter().flatten().map(|p| p.1);
    let most = values().fold(1e-9, f64::max);
    let high = 10f64.powi((most.log10() - 0.001).ceil() as i32);
    let low = high * 10f64.powi(-DECADES);
    let shown = |v: f64| v > low;
    text(area, &format!("seen at {}\u{b0}", (10.0 * panel.degrees).round() / 10.0), INK, [84, 10])?;
    let mut chart = ChartBuilder::on(area)
        .margin_top(super::CAPTION)
        .margin_right(20)
        .margin_bottom(6)
        .x_label_area_size(44)
        .y_label_area_size(80)
        .build_cartesian_2d(-90.0..90.0, (low..high * (1.0 + 1e-9)).log_scale())?;
    let label = (FONT, LETTERS).into_font().color(&QUIET);
    chart
        .configure_mesh()
        .disable_x_mesh()
        .x_labels(0)
        .y_labels(DECADES as usize + 1)
        .y_label_formatter(&|value| {
            let power = value.log10().round() as i32;
            if (-3..=3).contains(&power) { format!("{}", 10f64.powi(power)) } else { format!("1e{power}") }
        })
        .label_style(label.clone())
        .axis_style(RULE)
        .bold_line_style(RULE)
        .light_line_style(TRANSPARENT)
        .draw()?;
    let below = label.pos(Pos::new(HPos::Center, VPos::Top));
    for angle in [-60.0, 0.0, 60.0] {
        let line = PathElement::new([(angle, low), (angle, high)], RULE);
        chart.draw_series([line])?;
        let number = Text::new(format!("{angle}\u{b0}"), (0, 8), below.clone());
        chart.draw_series([EmptyElement::at((angle, low)) + number])?;
    }
    // The mirror direction.
    let mirror = (0..40).map(|n| low * (high / low).powf((f64::from(n) + 0.5) / 40.0));
    chart.draw_series(mirror.map(|v| Circle::new((panel.degrees, v), 1, QUIET.filled())))?;
    for (curve, line) in [(&panel.against, QUIET.stroke_width(4)), (&panel.fit, ACCENT.stroke_width(3))] {
        // In pieces: a hidden value is no point of a line.
        let pieces = curve.windows(2).filter(|pair| pair.iter().all(|p| shown(p.1)));
        chart.draw_series(pieces.map(|pair| PathElement::new(pair.to_vec(), line)))?;
    }
    let points = panel.samples.iter().filter(|p| shown(p.1));
    chart.draw_series(points.map(|&point| Circle::new(point, 5, INK.mix(0.8).filled())))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::{Strip, TILE};
    use super::*;
    use srbf_fit::table::Table;

    #[test]
    fn panels_with_and_without_what_can_be_shown_are_drawn() {
        let curve = |value: f64| vec![(-30.0, value), (0.0, 2.0 * value), (30.0, value)];
        let panel =
            |value| Panel { degrees: 30.0, samples: curve(value), against: curve(value), fit: curve(value) };
        let alone = || Panel { samples: vec![], against: vec![], ..panel(1.0) };
        for panel in [panel(0.0), panel(0.1), panel(-1.0), panel(1e12), alone()] {
            let mut block = Strip::paper(TILE);
            block.draw(|root| draw(root, &panel)).unwrap();
            assert!(block.rgb.iter().filter(|&&p| p < 128).count() > 500, "no letters");
        }
    }

    #[test]
    fn samples_out_of_the_plane_are_no_points_beside_its_curve() {
        let at = |azimuth: f64| [0.5 * azimuth.cos(), 0.5 * azimuth.sin(), 0.75f64.sqrt()];
        let samples = [0.0, 0.04, 0.1, 1.5].map(|azimuth| (at(azimuth), [1.0; 3]));
        let table = Table::from_scattered(vec![(0.3, samples.to_vec())]).unwrap();
        let points: Vec<_> = in_plane(&table.views[0]).collect();
        assert_eq!(points.len(), 2, "{points:?}");
        assert!(points.iter().all(|point| (point.0 - 30.0).abs() < 0.1), "{points:?}");
    }
}
