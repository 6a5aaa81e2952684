//! The question that one hit asks a material, and its answer.

use crate::material::borrowed::MaterialRef;
use crate::mixture::rows::Sample;
use glam::Vec3;

/// The answer of a material.
#[derive(Clone, Copy)]
pub(crate) struct Answer {
    pub sample: Option<Sample>,
    /// Towards the other direction.
    pub value: Vec3,
    pub pdf: f32,
    /// Luminance of the albedo, without factors.
    #[cfg(feature = "simd")]
    pub power: f32,
}

impl Answer {
    pub const NOTHING: Self = Self {
        sample: None,
        value: Vec3::ZERO,
        pdf: 0.0,
        #[cfg(feature = "simd")]
        power: 0.0,
    };
}

/// The kind of a question, without its numbers.
#[derive(Clone, Copy)]
pub(super) struct Which {
    pub draws: bool,
    pub evaluates: bool,
    pub colors: bool,
}

/// Inputs of a hit beside the outgoing direction; inputs of outputs that are not wanted are anything.
pub(super) struct Hit<'a> {
    pub material: MaterialRef<'a>,
    pub u: [f32; 3],
    pub wi: [f32; 3],
    pub which: Which,
    /// Room for the lobes.
    #[cfg(feature = "simd")]
    pub groups: &'a mut [crate::mixture::row::Group],
    /// Of an anisotropic material, whose lobes are in that room.
    #[cfg(feature = "simd")]
    pub frame: Option<&'a crate::kernel::among_rings::Frame>,
}
