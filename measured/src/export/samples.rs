//! Writers of samples as text: our own `.csv`, and Cornell's `.astm` with three channels.

use crate::table::{Sample, Table};
use std::fmt::Write;

/// All samples with the angle of their outgoing direction.
fn rows(table: &Table) -> impl Iterator<Item = (f64, &Sample)> {
    table.views.iter().flat_map(|view| view.samples.iter().map(|sample| (view.theta, sample)))
}

/// Writes samples as our own CSV: both directions as unit vectors, f in linear sRGB, 1/sr.
///
/// All digits are written, so that the same numbers are read.
pub fn csv(table: &Table) -> String {
    let mut text = "# written by srbf\nwi_x,wi_y,wi_z,wo_x,wo_y,wo_z,r,g,b\n".to_owned();
    for (theta, Sample { direction: [x, y, z], rgb: [r, g, b], .. }) in rows(table) {
        let (sin, cos) = libm::sincos(theta);
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{x},{y},{z},{},0,{cos},{r},{g},{b}", -sin);
    }
    text
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
