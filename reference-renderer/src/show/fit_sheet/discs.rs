//! The hemisphere of incident directions as discs, seen from above: the fit, its data, and the ratio of both, for three
//! outgoing directions.

use super::{Strip, Subject, WIDTH, y};
use crate::out::panel::{FONT, Failure, register_font};
use anyhow::anyhow;
use plotters::prelude::*;

/// Outgoing directions, degrees from the normal. They come from the left.
const VIEWS: [f64; 3] = [5.0, 40.0, 70.0];

/// Side of a disc's square, height of the text above, and of its letters, pixels.
const SIDE: u32 = 140;
const HEAD: u32 = 24;
const LETTERS: u32 = 13;

/// Powers of ten below the largest value that are told apart.
const DECADES: f64 = 4.0;

/// The logarithm of a ratio that has the deepest colour.
const APART: f64 = 0.5;

/// From too dark to too bright; white is right.
const RATIOS: [RGBColor; 3] = [RGBColor(33, 102, 172), WHITE, RGBColor(178, 24, 43)];

/// Draws three discs a view, or one without anything that the fit is held against.
///
/// # Errors
/// As the fit says them; faults of the font.
pub fn draw(subject: &Subject<'_>) -> anyhow::Result<Strip> {
    let mut block = Strip::white([WIDTH, HEAD + SIDE]);
    let mut texts = Vec::new();
    let ratios = DerivedColorMap::new(&RATIOS);
    let mut left = 0;
    for degrees in VIEWS {
        let theta = degrees.to_radians();
        let view = subject.fit.view(theta)?;
        let wo = [-theta.sin(), 0.0, theta.cos()];
        let fit = values(|wi| view.f_cos(wi));
        let data = subject.against.as_ref().map(|a| values(|wi| a.brdf.evaluate(wi, wo).map(|f| f * wi[2])));
        let most = fit.iter().chain(data.iter().flatten()).flatten().fold(0.0, |most: f64, v| most.max(*v));
        let level = |v: &f64| 1.0 + (v / most).max(1e-30).log10() / DECADES;
        let shown = |v: &Option<f64>| v.map(|v| ViridisRGB.get_color(level(&v).clamp(0.0, 1.0)));
        paint(&mut block, left, fit.iter().map(shown));
        texts.push((format!("fit, {degrees} degrees"), left));
        left += SIDE;
        if let (Some(data), Some(against)) = (&data, &subject.against) {
            paint(&mut block, left, data.iter().map(shown));
            texts.push((against.name.to_owned(), left));
            left += SIDE;
            let ratio = |(fit, data): (&Option<f64>, &Option<f64>)| {
                let (fit, data) = (fit.as_ref()?, data.as_ref()?);
                // Values far below the shown range count as equal.
                let floor = most * 10f64.powf(-DECADES);
                let apart = ((fit.max(0.0) + floor) / (data.max(0.0) + floor)).ln() / APART;
                Some(ratios.get_color(0.5 + 0.5 * apart.clamp(-1.0, 1.0)))
            };
            paint(&mut block, left, fit.iter().zip(data).map(ratio));
            texts.push(("ratio".to_owned(), left));
            left += SIDE;
        }
    }
    write(&mut block, &texts).map_err(|error| anyhow!("cannot write the captions: {error}"))?;
    let mut explained =
        format!("     luminance of f cos over {DECADES} decades, seen from above, the viewer on the left");
    if subject.against.is_some() {
        explained += &format!("; ratio: red is too bright by {:.0} %, blue too dark", 100.0 * APART.exp_m1());
    }
    let below = super::words::draw(&[explained])?;
    Ok(super::stacked(&[block, below]))
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

/// Colours the pixels of a square below the texts; pixels without a colour stay white.
fn paint(block: &mut Strip, left: u32, colours: impl Iterator<Item = Option<RGBColor>>) {
    for (n, colour) in colours.enumerate() {
        let (row, column) = (n as u32 / SIDE, n as u32 % SIDE);
        if let Some(RGBColor(r, g, b)) = colour {
            let at = 3 * ((HEAD + row) * WIDTH + left + column) as usize;
            block.rgb[at..at + 3].copy_from_slice(&[r, g, b]);
        }
    }
}

fn write(block: &mut Strip, texts: &[(String, u32)]) -> Result<(), Failure> {
    register_font()?;
    let root = BitMapBackend::with_buffer(&mut block.rgb, block.size.into()).into_drawing_area();
    let style = TextStyle::from((FONT, LETTERS).into_font()).color(&BLACK);
    for (text, left) in texts {
        root.draw_text(text, &style, (*left as i32 + 6, 6))?;
    }
    root.present()?;
    Ok(())
}
