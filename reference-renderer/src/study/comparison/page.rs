//! Comparisons as one page of HTML: ratios of all, and of each the plot, its tables, pictures side by side and errors in false colours.

use super::{Comparison, Curve, Estimate};
use crate::out::page::{Cell, Figure, Page, Table};
use crate::out::picture_file;
use crate::study::comparison::plot;
use crate::study::comparison::report::{bias, or_dash, reference, short};
use glam::Vec3;
use plotters::style::RGBColor;
use plotters::style::colors::colormaps::{ColorMap, ViridisRGB};

/// Widest that a picture of a row is shown, pixels: six of them side by side.
const SHOWN_WIDTH: u32 = 192;

/// Relative errors from which to which the false colours run, evenly in the logarithm.
const SHOWN_ERRORS: [f32; 2] = [0.01, 1.0];

/// Adds all comparisons to a page.
///
/// # Errors
/// A picture that cannot be encoded.
pub fn add(page: &mut Page, comparisons: &[Comparison]) -> anyhow::Result<()> {
    if comparisons.len() > 1 {
        page.heading("All at once");
        page.table(&overview(comparisons));
    }
    for comparison in comparisons {
        add_one(page, comparison)?;
    }
    Ok(())
}

/// The measurement, in words, for the head of a page.
pub const WORDS: &str = "Relative MSE: the mean over the pixels of the squared difference from the reference over the square of the pixel's brightness \
    (and of a tenth of the picture's), without the 0.1 % of the pixels that are worst. Seconds are those of the processors that worked on the \
    picture; fitting samplers and building scenes is not counted. After ± stands the standard error over the repeats.";

/// Relative MSE after the same time, as multiples of the first method's, of all comparisons.
fn overview(comparisons: &[Comparison]) -> Table {
    let mut methods: Vec<String> = Vec::new();
    for curve in comparisons.iter().flat_map(|c| &c.curves) {
        let name = curve.method.to_string();
        if !methods.contains(&name) {
            methods.push(name);
        }
    }
    let row = |comparison: &Comparison| {
        let cell = |name: &String| {
            let found = comparison.curves.iter().find(|c| c.method.to_string() == *name);
            ratio(found.and_then(|curve| comparison.ratios(curve).equal_time), false)
        };
        let case = [&comparison.material, comparison.scene, comparison.environment.as_str()];
        case.iter().map(|text| Cell::text(*text)).chain(methods.iter().map(cell)).collect()
    };
    let head = ["material", "scene", "light"].map(Cell::text).into_iter();
    Table {
        caption:
            "Relative MSE after the same time, as a multiple of the first method's; bold where it is less"
                .into(),
        head: head.chain(methods.iter().map(Cell::number)).collect(),
        rows: comparisons.iter().map(row).collect(),
    }
}

/// A ratio, bold where it is certainly below 1.
fn ratio(ratio: Option<Estimate>, with_error: bool) -> Cell {
    let Some(Estimate { mean, error }) = ratio else { return Cell::number("-") };
    let text =
        if with_error && error > 0.0 { format!("{} ± {}", short(mean), short(error)) } else { short(mean) };
    Cell::number(text).bold_if(mean + 2.0 * error < 1.0)
}

fn add_one(page: &mut Page, comparison: &Comparison) -> anyhow::Result<()> {
    page.heading(&comparison.title());
    page.paragraph(&format!("{}.", reference(comparison)));
    page.row(&[Figure::new(plot::png(&[comparison])?, "")]);
    page.table(&summary(comparison));
    page.subheading("Pictures at the last measurement, and their relative errors");
    add_pictures(page, comparison)?;
    page.folded("All measurements", &measurements(comparison));
    Ok(())
}

fn summary(comparison: &Comparison) -> Table {
    let head = [
        Cell::text("method"),
        Cell::text("draws"),
        Cell::number("slope"),
        Cell::number("time of a sample"),
        Cell::number(format!("MSE at {:.3} s", comparison.common_seconds())),
        Cell::number("after the same time"),
        Cell::number("after the same samples"),
        Cell::number("bias"),
        Cell::number("variance"),
    ];
    let row = |curve: &Curve| {
        let ratios = comparison.ratios(curve);
        let mse = curve.mse_at(comparison.common_seconds());
        vec![
            Cell::text(curve.method.to_string()),
            Cell::text(&curve.title),
            Cell::number(or_dash(curve.slope(), 3)),
            Cell::number(or_dash(ratios.time_of_sample, 2)),
            Cell::number(mse.map_or_else(|| "-".to_owned(), plus_minus)),
            ratio(ratios.equal_time, true),
            ratio(ratios.equal_samples, true),
            Cell::number(bias(curve)),
            Cell::number(curve.bias.map_or_else(|| "-".to_owned(), |bias| format!("{:.2e}", bias.variance))),
        ]
    };
    Table {
        caption: "Times and errors as multiples of the first method's. Bias: root of what of the error stays however many samples there are; \
            variance: what falls with them, at the last measurement"
            .into(),
        head: head.to_vec(),
        rows: comparison.curves.iter().map(row).collect(),
    }
}

fn measurements(comparison: &Comparison) -> Table {
    let head = [
        Cell::text("method"),
        Cell::number("samples a pixel"),
        Cell::number("seconds"),
        Cell::number("relative MSE"),
        Cell::number("with the worst pixels"),
        Cell::text(""),
    ];
    let points =
        comparison.curves.iter().flat_map(|curve| curve.points.iter().map(move |point| (curve, point)));
    let rows = points.map(|(curve, point)| {
        vec![
            Cell::text(curve.method.to_string()),
            Cell::number(point.samples.to_string()),
            Cell::number(format!("{:.4}", point.seconds)),
            Cell::number(plus_minus(point.mse)),
            Cell::number(plus_minus(point.whole_mse)),
            Cell::text(if point.known().is_none() { "below the reference's own" } else { "" }),
        ]
    });
    Table { caption: String::new(), head: head.to_vec(), rows: rows.collect() }
}

fn plus_minus(e: Estimate) -> String {
    format!("{:.3e} ± {:.0e}", e.mean, e.error)
}

/// The reference, and of each method its picture above its errors.
fn add_pictures(page: &mut Page, comparison: &Comparison) -> anyhow::Result<()> {
    let size = comparison.size;
    let exposure = picture_file::automatic_exposure(&comparison.reference.picture);
    let shown =
        |pixels: &[Vec3]| picture_file::encode_png(size, &picture_file::tone_mapped(pixels, exposure));
    let reference = shown(&comparison.reference.picture)?;
    let [low, high] = SHOWN_ERRORS.map(|error| 100.0 * error);
    let caption =
        format!("reference; colours of errors: {low} % of the brightness (left) to {high} % (right)");
    let mut row = vec![figure(reference, size, caption).above(colour_bar(size[0])?)];
    for Curve { method, shown: last, .. } in &comparison.curves {
        let errors: Vec<u8> = last.errors.iter().flat_map(|&error| false_colour(error)).collect();
        let caption = format!("{method}: {} samples, {:.2}\u{a0}s", last.samples, last.seconds);
        let errors = picture_file::encode_png(size, &errors)?;
        row.push(figure(shown(&last.picture)?, size, caption).above(errors));
    }
    page.row(&row);
    Ok(())
}

fn figure(png: Vec<u8>, size: [u32; 2], caption: String) -> Figure {
    // A small picture in whole multiples of its pixels.
    let width =
        if size[0] < SHOWN_WIDTH { size[0] * (SHOWN_WIDTH / size[0]) } else { size[0].min(2 * SHOWN_WIDTH) };
    Figure::new(png, caption).wide(width)
}

/// The colour of a relative error, black where none is taken.
fn false_colour(error: f32) -> [u8; 3] {
    if error == 0.0 {
        return [0; 3];
    }
    let [low, high] = SHOWN_ERRORS;
    // NaN counts as the worst.
    let share = ((error / low).ln() / (high / low).ln()).max(0.0);
    let share = if share < 1.0 { share } else { 1.0 };
    let RGBColor(r, g, b) = ViridisRGB.get_color(share);
    [r, g, b]
}

/// The legend of the colours, as wide as a picture.
fn colour_bar(width: u32) -> anyhow::Result<Vec<u8>> {
    let size = [width, width.div_ceil(8)];
    let [low, high] = SHOWN_ERRORS;
    let error = |x: u32| low * (high / low).powf((x as f32 + 0.5) / width as f32);
    let bytes: Vec<u8> = (0..size[1]).flat_map(|_| (0..width).flat_map(|x| false_colour(error(x)))).collect();
    picture_file::encode_png(size, &bytes)
}

#[cfg(test)]
mod tests {
    use super::super::curve::tests::{curve, point};
    use super::super::{ReferenceReport, Shown};
    use super::*;
    use crate::out::page::asked_of_a_network;

    #[test]
    fn a_page_has_all_parts_and_asks_nothing_of_a_network() {
        let shown = Shown {
            samples: 4,
            seconds: 0.1,
            picture: vec![Vec3::ONE; 6],
            errors: vec![0.0, 0.1, 0.2, 0.01, 5.0, f32::NAN],
        };
        let one =
            curve([1u32, 4, 16].map(|n| point(n, 0.1 * f64::from(n), 1.0 / f64::from(n).sqrt())).to_vec());
        let comparison = |material: &str| Comparison {
            scene: "sphere",
            material: material.into(),
            environment: "http://light".into(),
            size: [3, 2],
            curves: vec![super::Curve { shown: shown.clone(), ..one.clone() }; 2],
            reference: ReferenceReport { picture: vec![Vec3::ONE; 6], ..ReferenceReport::default() },
        };
        let mut page = Page::new("comparison");
        add(&mut page, &[comparison("<one>"), comparison("two")]).unwrap();
        let html = page.to_html();
        assert_eq!(html.matches("<img").count(), 2 * (1 + 2 * 3));
        assert!(html.contains("&lt;one&gt;, sphere under"));
        // The name of the light is text and no address that is followed.
        assert_eq!(asked_of_a_network(&html), ["http://"]);
    }

    #[test]
    fn colours_of_errors_run_from_dark_to_bright() {
        let bright = |error: f32| false_colour(error).iter().map(|&v| u32::from(v)).sum::<u32>();
        assert_eq!(bright(0.0), 0);
        assert!(bright(1e-3) == bright(1e-2) && bright(1e-2) < bright(1e-1) && bright(1e-1) < bright(1.0));
        assert_eq!(bright(1.0), bright(1e9));
    }
}
