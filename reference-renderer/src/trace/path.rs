//! A path on its way: the scene, the settings, its numbers.

use crate::numbers::points::Points;
use crate::trace::carried::Rgb;
use crate::trace::scene::Scene;
use crate::trace::settings::RenderSettings;

/// A path on its way.
pub struct Path<'p, 'a, C = Rgb> {
    pub scene: &'p Scene<'a>,
    pub settings: &'p RenderSettings,
    pub points: Points,
    /// Colours, or the wavelengths of values.
    pub carried: C,
}
