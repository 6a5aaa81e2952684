//! The parts of a blend.

use super::coat::through;
use crate::color::luminance;
use crate::kernel::request::{Draws, Request, Towards, at};
use crate::kernel::streamed::one::{Asked, ask_mixture, ask_one};
use crate::kernel::streamed::question::Answer;
use crate::material::borrowed::{Material, MaterialRef};
use crate::mixture::rows::AnyMixture;
#[cfg(feature = "simd")]
use crate::simd::lanes::WIDEST;
use glam::Vec3;

/// Largest weight, and largest channel of a tint.
const LARGEST: f32 = 1e3;
/// Largest index of a coat.
const LARGEST_INDEX: f32 = 10.0;

/// A part of a [`Blend`](crate::Blend): a material or a mixture, with its weight, a tint and perhaps a coat above it.
#[derive(Clone, Copy)]
pub struct BlendPart<'a> {
    pub(super) of: Of<'a>,
    pub(super) weight: f32,
    pub(super) tint: Vec3,
    /// Refractive index of the coat above it; 1 for none.
    pub(super) coat: f32,
}

impl core::fmt::Debug for BlendPart<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self { weight, tint, coat, .. } = self;
        f.debug_struct("BlendPart")
            .field("weight", weight)
            .field("tint", tint)
            .field("coat", coat)
            .finish_non_exhaustive()
    }
}

/// A material or a mixture.
#[derive(Clone, Copy)]
pub(super) enum Of<'a> {
    Material(MaterialRef<'a>),
    Mixture(&'a AnyMixture<'a>),
}

impl<'a> BlendPart<'a> {
    /// A material with a weight, untinted.
    #[inline]
    pub fn new<B: AsRef<[u8]>>(material: &'a Material<B>, weight: f32) -> Self {
        Self { of: Of::Material(material.borrowed()), weight, tint: Vec3::ONE, coat: 1.0 }
    }

    /// A mixture with a weight, untinted: one that is prepared already, or one of the caller's lobes.
    #[inline]
    pub fn of_mixture(mixture: &'a AnyMixture<'a>, weight: f32) -> Self {
        Self { of: Of::Mixture(mixture), weight, tint: Vec3::ONE, coat: 1.0 }
    }

    /// The same with a tint, by which the channels of its values are multiplied; linear sRGB.
    #[must_use]
    #[inline]
    pub fn tinted(self, tint: impl Into<Vec3>) -> Self {
        Self { tint: tint.into(), ..self }
    }

    /// The same below a clear coat of a refractive index, whose smooth face reflects by Fresnel's equations.
    ///
    /// Values are multiplied by the transmittance of the coat for both directions: `(1 - F(wo)) (1 - F(wi))`. So a reciprocal material stays
    /// one, and its albedo is at most `1 - F(wo)` of its own. The light that the coat itself reflects is a part of its own, of weight
    /// [`fresnel`](crate::fresnel). This is a model: it leaves out refraction, light that goes back and forth below the coat, and
    /// absorption in it.
    #[must_use]
    #[inline]
    pub fn coated(self, index: f32) -> Self {
        Self { coat: index, ..self }
    }

    /// Its weight.
    pub fn weight(&self) -> f32 {
        self.weight
    }

    /// Its tint, linear sRGB.
    pub fn tint(&self) -> Vec3 {
        self.tint
    }

    /// The material, if it is one.
    #[cfg(feature = "simd")]
    #[inline(always)]
    pub(super) fn material(&self) -> Option<MaterialRef<'a>> {
        match self.of {
            Of::Material(material) => Some(material),
            _ => None,
        }
    }

    /// Groups of sixteen lobes of the material.
    #[cfg(feature = "simd")]
    #[inline(always)]
    pub(super) fn groups(&self) -> usize {
        self.material().map_or(1, |material| material.header.lobe_count().div_ceil(WIDEST).max(1))
    }

    /// Whether all numbers are in their ranges.
    #[inline(always)]
    pub(super) fn is_valid(&self) -> bool {
        // Without branches; false for a NaN.
        let fits = |x: f32| (0.0..=LARGEST).contains(&x);
        let Vec3 { x, y, z } = self.tint;
        let is_index = (1.0..=LARGEST_INDEX).contains(&self.coat);
        fits(self.weight) & fits(x) & fits(y) & fits(z) & is_index
    }

    /// What values are multiplied by, without a coat.
    #[inline(always)]
    pub(super) fn color(&self) -> Vec3 {
        self.tint * self.weight
    }

    /// The weight of its power in draws, without a coat.
    #[inline(always)]
    pub(super) fn brightness(&self) -> f32 {
        luminance(self.color())
    }

    /// The same for an outgoing direction, below the coat.
    #[inline(always)]
    pub(super) fn draws(&self, wo: Vec3) -> f32 {
        self.brightness() * through(self.coat, wo.z)
    }

    /// What values are multiplied by.
    #[inline(always)]
    pub(super) fn scale(&self, wo: Vec3, wi: Vec3) -> Vec3 {
        let color = self.color();
        if self.coat > 1.0 { color * self.through(wo, wi) } else { color }
    }

    /// The transmittance of the coat for both directions.
    pub(super) fn through(&self, wo: Vec3, wi: Vec3) -> f32 {
        through(self.coat, wo.z) * through(self.coat, wi.z)
    }

    /// Multiplies the answers of a request, those of the part, by its weight, its tint and its coat.
    pub(super) fn scale_answers(&self, wo: [&[f32]; 3], request: &mut Request<'_>) {
        if self.color() == Vec3::ONE && self.coat <= 1.0 {
            return;
        }
        let scale = |colors: &mut [&mut [f32]; 3], wi: [&[f32]; 3]| {
            for i in 0..wo[0].len() {
                let scale = self.scale(at(&wo, i), at(&wi, i));
                for (channel, color) in colors.iter_mut().enumerate() {
                    color[i] *= scale[channel];
                }
            }
        };
        if let Some(Draws { direction, weight: Some(weight), .. }) = &mut request.draw {
            scale(weight, direction.each_ref().map(|s| &**s));
        }
        if let Some(Towards { wi, value: Some(value), .. }) = &mut request.evaluate {
            scale(value, *wi);
        }
    }

    /// The answer of the material or the mixture, without weight, tint and coat.
    #[inline(always)]
    pub(super) fn ask(&self, wo: Vec3, asked: Asked) -> Answer {
        match self.of {
            Of::Material(material) => ask_one(material, wo, asked),
            Of::Mixture(mixture) => ask_mixture(mixture, asked),
        }
    }

    /// The answer of a blend that has no other part.
    #[inline(always)]
    pub(super) fn alone(&self, wo: Vec3, asked: Asked) -> Answer {
        let mut answer = self.ask(wo, asked);
        if let Some(sample) = &mut answer.sample {
            sample.weight *= self.scale(wo, sample.direction);
        }
        if let Some(wi) = asked.wi {
            answer.value *= self.scale(wo, wi.into());
        }
        answer
    }
}
