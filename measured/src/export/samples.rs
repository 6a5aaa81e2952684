//! Writers of samples as text: our own `.csv`, and Cornell's `.astm` with three channels.

use crate::read::Spectra;
use crate::row::Row;
use crate::table::{Sample, Table};
use std::fmt::Write;

/// All samples with the angle of their outgoing direction.
fn rows(table: &Table) -> impl Iterator<Item = (f64, &Sample)> {
    table.views.iter().flat_map(|view| view.samples.iter().map(|sample| (view.theta, sample)))
}

/// Writes samples as our own CSV: both directions as unit vectors, f in linear sRGB, 1/sr; with `spectra`, f at each of their
/// wavelengths in place of the colour, which they follow from.
///
/// All digits are written, so that the same numbers are read.
pub fn csv(table: &Table, spectra: Option<&Spectra>) -> String {
    let mut text = csv_head(spectra);
    for (theta, Sample { direction, rgb, .. }) in rows(table) {
        let (sin, cos) = libm::sincos(theta);
        let pair = [*direction, [-sin, 0.0, cos]];
        match spectra {
            Some(spectra) => csv_row(&mut text, pair, spectra.of(*rgb)),
            None => csv_row(&mut text, pair, rgb.iter().copied()),
        }
    }
    text
}

/// Writes the samples of spectra as our own CSV, with the values that were read.
pub fn csv_of_spectra(spectra: &Spectra) -> String {
    let mut text = csv_head(Some(spectra));
    for sample in &spectra.samples {
        csv_row(&mut text, [sample.wi, sample.wo], sample.values.iter().copied());
    }
    text
}

/// Writes samples of a surface that a turn changes as our own CSV: as they were read, in the frame of the surface.
pub fn csv_of_rows(rows: &[Row]) -> String {
    let mut text = csv_head(None);
    rows.iter().for_each(|row| csv_row(&mut text, [row.wi, row.wo], row.rgb.iter().copied()));
    text
}

fn csv_head(spectra: Option<&Spectra>) -> String {
    let values = spectra.map_or_else(
        || "r,g,b".to_owned(),
        |spectra| spectra.wavelengths.iter().map(|nm| format!("{nm}nm")).collect::<Vec<_>>().join(","),
    );
    format!("# written by srbf\nwi_x,wi_y,wi_z,wo_x,wo_y,wo_z,{values}\n")
}

fn csv_row(text: &mut String, [[x, y, z], [a, b, c]]: [[f64; 3]; 2], values: impl Iterator<Item = f64>) {
    // Writing to a String cannot fail.
    let _ = write!(text, "{x},{y},{z},{a},{b},{c}");
    values.for_each(|value| {
        let _ = write!(text, ",{value}");
    });
    text.push('\n');
}

/// Writes samples as an `.astm` file: angles in radians, f in linear sRGB, 1/sr. The outgoing direction stands as the incident one, as in
/// Cornell's own.
pub fn astm(table: &Table) -> String {
    let mut text = format!(
        "LAB_NAME srbf\nLAB_COMMENTS linear sRGB, 1/sr, not multiplied by the cosine\nNUM_POINTS {}\nVARS theta_i,phi_i,theta_s,phi_s,R,G,B\n",
        rows(table).count()
    );
    for (theta, Sample { direction: [x, y, z], rgb: [r, g, b], .. }) in rows(table) {
        // Azimuths count from the outgoing direction, which is at -x; at the normal it has none, and they count from x.
        let sign = if theta == 0.0 { 1.0 } else { -1.0 };
        let (theta_s, phi_s) = (libm::atan2(libm::hypot(*x, *y), *z), libm::atan2(sign * y, sign * x));
        let _ = writeln!(text, "{theta},0,{theta_s},{phi_s},{r},{g},{b}");
    }
    text
}
