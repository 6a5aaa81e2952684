//! Directions from uniform numbers: the strategies that lobes are compared with.

use glam::{Vec3, vec3};
use std::f32::consts::PI;

/// Draws a direction uniformly on the sphere; density `1 / (4 pi)`.
#[cfg(test)]
pub fn uniform(u: [f32; 2]) -> Vec3 {
    from_height(1.0 - 2.0 * u[0], u[1])
}

/// Draws a direction uniformly on the upper hemisphere; density `1 / (2 pi)`.
pub fn uniform_hemisphere(u: [f32; 2]) -> Vec3 {
    from_height(u[0], u[1])
}

/// Draws a direction on the upper hemisphere with density `z / pi`.
pub fn cosine(u: [f32; 2]) -> Vec3 {
    // 1 - u lies in (0, 1]: z, and with it the density, is never 0.
    from_height((1.0 - u[0]).sqrt(), u[1])
}

fn from_height(z: f32, turn: f32) -> Vec3 {
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (2.0 * PI * turn).sin_cos();
    vec3(radius * cos, radius * sin, z)
}
