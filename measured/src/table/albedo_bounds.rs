//! The bounds that a surface sets to the albedo: values in other units than 1/sr break them.

use super::{BLACK, luminance};
use std::f64::consts::PI;

/// Outgoing directions beyond this, radians, are left out: sums over few samples are coarse there.
const GRAZING: f64 = 75.0 * PI / 180.0;

/// Most that a quadrature makes of a surface that reflects everything.
pub const MOST: f64 = 1.1;

/// Less than surfaces reflect but for light traps and the blackest coatings: soot has 0.01.
pub const LEAST: f64 = 1e-3;

/// Albedo of a surface of which nothing was measured to be brighter than 0, at most: it tells no unit.
pub const NOTHING: f64 = 1.1 * PI * BLACK;

/// Luminances of albedos at angles, radians, that are not grazing.
pub fn albedos(at: impl IntoIterator<Item = (f64, [f64; 3])>) -> Vec<f64> {
    at.into_iter().filter(|(theta, _)| *theta <= GRAZING).map(|(_, albedo)| luminance(albedo)).collect()
}

/// Whether hardly a surface has a largest albedo such as this.
pub fn is_off(most: f64) -> bool {
    !(LEAST..=MOST).contains(&most)
}
