//! Numbers that a path carries from surface to surface: a colour, or values at four wavelengths.

use crate::shade::shader::Shader;
use crate::world::illuminant::{HEROES, Illuminant};
use glam::{Vec3, Vec4};
use srbf_core::{Primaries, SpectralMap};
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign};

/// A kind of numbers that paths carry.
pub trait Carried: Copy {
    /// The numbers.
    type Value: Copy
        + PartialEq
        + Add<Output = Self::Value>
        + AddAssign
        + Mul<Output = Self::Value>
        + MulAssign
        + Mul<f32, Output = Self::Value>
        + Div<f32, Output = Self::Value>
        + DivAssign<f32>;
    /// Makes them of the colours of a surface.
    type Surface;
    /// No light.
    const BLACK: Self::Value;
    /// A fault, which is found in the picture.
    const NAN: Self::Value;

    /// The maker of them from the colours of a material.
    fn surface(&self, material: &Shader<'_>) -> Self::Surface;

    /// Those of a value or a weight of a surface, linear sRGB.
    fn scattered(&self, surface: &Self::Surface, rgb: Vec3) -> Self::Value;

    /// Those of a radiance, linear sRGB.
    fn light(&self, rgb: Vec3) -> Self::Value;

    /// Those of a product of both; `None` where it does not tell them.
    fn product(&self, rgb: Vec3) -> Option<Self::Value>;

    /// The largest, without its sign.
    fn size(value: Self::Value) -> f32;
}

/// Colours: linear sRGB.
#[derive(Clone, Copy, Debug)]
pub struct Rgb;

impl Carried for Rgb {
    type Value = Vec3;
    type Surface = ();
    const BLACK: Vec3 = Vec3::ZERO;
    const NAN: Vec3 = Vec3::NAN;

    #[inline]
    fn surface(&self, _: &Shader<'_>) {}

    #[inline]
    fn scattered(&self, (): &(), rgb: Vec3) -> Vec3 {
        rgb
    }

    #[inline]
    fn light(&self, rgb: Vec3) -> Vec3 {
        rgb
    }

    #[inline]
    fn product(&self, rgb: Vec3) -> Option<Vec3> {
        Some(rgb)
    }

    /// Of a colour outside the gamut, channels are negative.
    #[inline]
    fn size(value: Vec3) -> f32 {
        value.abs().max_element()
    }
}

/// Four wavelengths under a light: those of the path's own draw, and others that share its way, as densities depend on luminance alone
/// (Wilkie et al. 2014, "Hero Wavelength Spectral Sampling").
#[derive(Clone, Copy, Debug)]
pub struct Wavelengths {
    nm: [f32; HEROES],
    seen: [Vec3; HEROES],
    of_light: Primaries<HEROES>,
}

impl Wavelengths {
    /// Draws them with a number in [0, 1).
    pub fn draw(illuminant: &Illuminant, u: f32) -> Self {
        let drawn = illuminant.draw(u);
        let nm = drawn.map(|drawn| drawn.0);
        Self { nm, seen: drawn.map(|drawn| drawn.1), of_light: primaries(SpectralMap::FIXED, nm) }
    }

    /// The colour that values are an estimate of; linear sRGB.
    pub fn colour(&self, values: Vec4) -> Vec3 {
        let shown = self.seen.iter().zip(values.to_array()).map(|(seen, value)| *seen * value);
        shown.sum::<Vec3>() / HEROES as f32
    }
}

/// The columns of a map at wavelengths.
fn primaries(map: SpectralMap<'_>, nm: [f32; HEROES]) -> Primaries<HEROES> {
    Primaries::from_columns(nm.map(|nm| map.column_at(nm)))
}

impl Carried for Wavelengths {
    type Value = Vec4;
    type Surface = Primaries<HEROES>;
    const BLACK: Vec4 = Vec4::ZERO;
    const NAN: Vec4 = Vec4::NAN;

    fn surface(&self, material: &Shader<'_>) -> Primaries<HEROES> {
        primaries(material.truth.spectral_map().unwrap_or(SpectralMap::FIXED), self.nm)
    }

    fn scattered(&self, surface: &Primaries<HEROES>, rgb: Vec3) -> Vec4 {
        surface.of(rgb).into()
    }

    fn light(&self, rgb: Vec3) -> Vec4 {
        self.of_light.of(rgb).into()
    }

    fn product(&self, _: Vec3) -> Option<Vec4> {
        None
    }

    fn size(value: Vec4) -> f32 {
        value.abs().max_element()
    }
}
