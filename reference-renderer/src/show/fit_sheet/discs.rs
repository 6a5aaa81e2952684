//! The hemisphere of incident directions as discs, seen from above, for three outgoing directions: the ratio of the fit and its data, or the
//! fit alone.

use super::{INK, LETTERS, MARGIN, PAPER, QUIET, Strip, Subject, WIDTH, text, y};
use plotters::prelude::*;

/// Outgoing directions, degrees from the normal. They come from the left.
const VIEWS: [f64; 3] = [5.0, 40.0, 70.0];

/// Side of a disc's square, and height of the text above and below, pixels.
const SIDE: u32 = 240;
const HEAD: u32 = 44;
const BELOW: u32 = 76;

/// Powers of ten below the largest value that are told apart.
const DECADES: f64 = 4.0;

/// The logarithm of a ratio that has the deepest colour.
const APART: f64 = 0.5;

/// From too dark to too bright; white is right.
const RATIOS: [RGBColor; 3] = [RGBColor(33, 102, 172), WHITE, RGBColor(178, 24, 43)];

/// Draws a disc a view.
///
/// # Errors
/// As the fit says them; faults of the font.
pub fn draw(subject: &Subject<'_>) -> anyhow::Result<Strip> {
    let mut block = Strip::paper([WIDTH, HEAD + SIDE + BELOW]);
    let ratios = DerivedColorMap::new(&RATIOS);
    let place = |n: usize| MARGIN + n as u32 * (WIDTH - 2 * MARGIN - SIDE) / 2;
    for (n, degrees) in VIEWS.into_iter().enumerate() {
        let theta = degrees.to_radians();
        let view = subject.fit.view(theta)?;
        let wo = [-theta.sin(), 0.0, theta.cos()];
        let fit = values(|wi| view.f_cos(wi));
        let data = subject.against.as_ref().map(|a| values(|wi| a.brdf.evaluate(wi, wo).map(|f| f * wi[2])));
        let most = fit.iter().chain(data.iter().flatten()).flatten().fold(0.0, |most: f64, v| most.max(*v));
        let colours: Vec<Option<RGBColor>> = match data {
            Some(data) => {
                let ratio = |(fit, data): (&Option<f64>, Option<f64>)| {
                    let (fit, data) = (fit.as_ref()?, data?);
                    // Values far below the shown range count as equal.
                    let floor = most * 10f64.powf(-DECADES);
                    let apart = ((fit.max(0.0) + floor) / (data.max(0.0) + floor)).ln() / APART;
                    Some(ratios.get_color(0.5 + 0.5 * apart.clamp(-1.0, 1.0)))
                };
                fit.iter().zip(data).map(ratio).collect()
            }
            None => {
                let level = |v: &f64| 1.0 + (v / most).max(1e-30).log10() / DECADES;
                let shown = |v: &Option<f64>| v.map(|v| ViridisRGB.get_color(level(&v).clamp(0.0, 1.0)));
                fit.iter().map(shown).collect()
            }
        };
        let rgb = colours.iter().flat_map(|colour| {
            let RGBColor(r, g, b) = colour.unwrap_or(PAPER);
            [r, g, b]
        });
        block.put(&rgb.collect::<Vec<u8>>(), SIDE, [place(n), HEAD]);
    }
    let explained = if subject.against.is_some() {
        let most = format!("fit over data, seen from above: red is {:.0} % too", 100.0 * APART.exp_m1());
        [most, "bright, blue too dark; the viewer is on the left".to_owned()]
    } else {
        [
            format!("f cos seen from above, yellow to blue over {DECADES} powers"),
            "of ten; the viewer is on the left".to_owned(),
        ]
    };
    block.draw(|root| {
        for (n, degrees) in VIEWS.into_iter().enumerate() {
            text(root, &format!("seen at {degrees}\u{b0}"), INK, [place(n), 12])?;
        }
        for (n, line) in (0..).zip(&explained) {
            text(root, line, QUIET, [MARGIN, HEAD + SIDE + 12 + n * (LETTERS + 7)])?;
        }
        Ok(())
    })?;
    Ok(block)
}

/// Luminances over the square round a disc, rows from the top; none outside of it.
fn values(value: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<Option<f64>> {
    let half = 0.5 * f64::from(SIDE);
    let place = |n: u32| (f64::from(n) + 0.5 - half) / (half - 2.0);
    let at = |x: f64, up: f64| {
        let z = 1.0 - x * x - up * up;
        (z > 0.0).then(|| y(value([x, up, z.sqrt()])))
    };
    (0..SIDE)
        .flat_map(|row| (0..SIDE).map(move |column| (row, column)))
        .map(|(row, column)| at(place(column), -place(row)))
        .collect()
}
