//! Where BRDFs that can be evaluated are fitted and judged: at even angles, and halfway between.

use crate::FitError;
use crate::table::Table;
use crate::table::{Brdf, Density};

/// Angle of the last view, degrees: beyond, files hold noise.
const LAST: f64 = 87.0;

/// Directions of a view that is judged: more than are fitted, and elsewhere.
const FINE: Density = Density { hemisphere: 1000, cap: 300 };

/// Angles from the normal to 87 degrees, radians; at least two.
pub fn even_views(count: usize) -> Vec<f64> {
    let count = count.max(2);
    (0..count).map(|n| LAST.to_radians() * n as f64 / (count - 1) as f64).collect()
}

/// The angles halfway between.
pub fn halfway(thetas: &[f64]) -> Vec<f64> {
    thetas.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect()
}

/// Outgoing directions at which visible errors of a fit are judged, angles in radians: 5, 30, 60 and 75 degrees.
pub fn seen_views() -> [f64; 4] {
    [5.0f64, 30.0, 60.0, 75.0].map(f64::to_radians)
}

/// Tabulates a BRDF to judge fits by.
///
/// # Errors
/// As [`Table::from_brdf`].
pub fn judging_table(brdf: &dyn Brdf, thetas: &[f64]) -> Result<Table, FitError> {
    Table::from_brdf(brdf, thetas, FINE)
}
