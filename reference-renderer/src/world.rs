//! What light travels through: triangles and balls, rays that meet them, maps of light, a bulb.
//!
//! May import: `numbers`, `out`.

pub mod ball;
pub mod bulb;
pub mod environment;
pub mod illuminant;
pub mod intersect;
pub mod mesh;
pub mod ray;
pub mod skin;
#[cfg(test)]
pub mod sphere_sampling;
pub mod teapot;
