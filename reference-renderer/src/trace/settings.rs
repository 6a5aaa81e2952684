//! How a picture is rendered.

use crate::numbers::points::PointsName;
use crate::shade::Light;

/// How to render.
#[derive(Clone, Copy, Debug)]
pub struct RenderSettings {
    /// Whether the light is sampled; the sampler of a material comes with the material.
    pub light: Light,
    /// Directions drawn at the first surface that a ray of the camera meets, at least 1.
    pub split: u32,
    pub max_bounces: u32,
    /// Where the numbers come from.
    pub points: PointsName,
    pub seed: u64,
}
