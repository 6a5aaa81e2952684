//! What light travels through: triangles, rays that meet them, maps of light.
//!
//! May import: `numbers`, `out`.

pub mod environment;
pub mod illuminant;
pub mod intersect;
pub mod mesh;
pub mod ray;
#[cfg(test)]
pub mod sphere_sampling;
pub mod teapot;
