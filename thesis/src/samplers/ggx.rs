//! Visible normals of the isotropic GGX distribution.
//!
//! Sources: Heitz 2014, "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs"; Dupuy and Benyoub 2023,
//! "Sampling Visible GGX Normals with Spherical Caps".

use super::plain::mirrored;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// The outgoing direction mirrored at a visible normal of roughness `alpha`; it may lie below the horizon.
#[inline]
pub fn reflect(wo: DVec3, alpha: f64, u: f64, v: f64) -> DVec3 {
    let stretched = DVec3::new(alpha * wo.x, alpha * wo.y, wo.z).normalize();
    let (sin, cos) = (TAU * u).sin_cos();
    let z = (1.0 - v) * (1.0 + stretched.z) - stretched.z;
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let h = DVec3::new(radius * cos, radius * sin, z) + stretched;
    mirrored(wo, DVec3::new(alpha * h.x, alpha * h.y, h.z.max(0.0)).normalize_or(DVec3::Z))
}

/// The constant part of the density for an outgoing direction: half of Smith's visible share over the cosine, over `pi alpha^2`.
#[inline]
pub fn scale(wo: DVec3, alpha: f64) -> f64 {
    let across = wo.x * wo.x + wo.y * wo.y;
    1.0 / (2.0 * (wo.z + (wo.z * wo.z + alpha * alpha * across).sqrt()) * PI * alpha * alpha)
}

/// Squares of the half vector's part across the normal and along it.
#[inline]
pub fn half_squared(wo: DVec3, wi: DVec3) -> [f64; 2] {
    let h = wo + wi;
    let squared = h.length_squared().max(f64::MIN_POSITIVE);
    [(h.x * h.x + h.y * h.y) / squared, h.z * h.z / squared]
}

/// Density of [`reflect`] at an incident direction above the horizon; 1/sr.
#[inline]
pub fn density([across, along]: [f64; 2], alpha: f64, scale: f64) -> f64 {
    let q = across / (alpha * alpha) + along;
    scale / (q * q)
}
