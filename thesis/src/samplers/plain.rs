//! Directions that depend on no material.

use glam::DVec3;
use std::f64::consts::{FRAC_1_PI, TAU};

/// Draws a direction on the upper hemisphere with density `z / pi`.
#[inline]
pub fn cosine(u: f64, v: f64) -> DVec3 {
    // 1 - v lies in (0, 1]: z, and with it the density, is never 0.
    from_height((1.0 - v).sqrt(), u)
}

/// Density of [`cosine`]; 1/sr.
#[inline]
pub fn cosine_density(wi: DVec3) -> f64 {
    wi.z.max(0.0) * FRAC_1_PI
}

/// Draws a direction uniformly on the upper hemisphere.
#[inline]
pub fn uniform(u: f64, v: f64) -> DVec3 {
    from_height(1.0 - v, u)
}

/// Density of [`uniform`]; 1/sr.
pub const UNIFORM_DENSITY: f64 = 1.0 / TAU;

/// A direction about an axis, from 1 - cos of the angle between them, and turns round the axis.
#[inline]
pub fn around(axis: DVec3, one_minus_cos: f64, turns: f64) -> DVec3 {
    let (tangent, bitangent) = axis.any_orthonormal_pair();
    let (sin, cos) = (TAU * turns).sin_cos();
    let across = (one_minus_cos * (2.0 - one_minus_cos)).max(0.0).sqrt();
    (axis * (1.0 - one_minus_cos) + (tangent * cos + bitangent * sin) * across).normalize()
}

/// The direction mirrored at a normal.
#[inline]
pub fn mirrored(wo: DVec3, normal: DVec3) -> DVec3 {
    (2.0 * wo.dot(normal) * normal - wo).normalize()
}

fn from_height(z: f64, turns: f64) -> DVec3 {
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (TAU * turns).sin_cos();
    DVec3::new(radius * cos, radius * sin, z)
}
