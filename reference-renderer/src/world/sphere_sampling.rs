//! Directions that tests are made of.

use glam::{Vec3, vec3};
use std::f32::consts::TAU;

/// Draws a direction uniformly on the sphere; density `1 / (4 pi)`.
pub fn uniform(u: [f32; 2]) -> Vec3 {
    let z = 1.0 - 2.0 * u[0];
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (TAU * u[1]).sin_cos();
    vec3(radius * cos, radius * sin, z)
}
