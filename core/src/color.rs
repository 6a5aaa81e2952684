//! Luminance; and the colours of lobes and of the diffuse term as a luminance, and how far red and blue are
//! from it, relative to it.
//!
//! `R = Y (1 + rho)`, `B = Y (1 + beta)`, and green makes the luminance Y: `G = Y (1 - (0.2126 rho +
//! 0.0722 beta) / 0.7152)`. What chooses lobes and weighs densities sees Y alone, so that a channel may be
//! negative, as measured colours outside the gamut of sRGB are.

use crate::simd::lanes::Lanes;
use glam::Vec3;

/// Weights of luminance in linear sRGB (Rec. 709).
pub const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// Luminance of a linear sRGB colour (Rec. 709), by which lobes are chosen and densities are weighted.
#[inline]
pub fn luminance(rgb: impl Into<Vec3>) -> f32 {
    rgb.into().dot(Vec3::from_array(LUMINANCE))
}

/// Largest magnitude of a relative colour difference.
pub(crate) const MOST_DIFFERENCE: f32 = 16.0;

/// Largest magnitude of a channel of a lobe, relative to its luminance: of any colour that
/// [`MOST_DIFFERENCE`] allows, and more.
const MOST_CHANNEL: f32 = 32.0;

/// Linear sRGB of luminances and colour differences.
#[inline(always)]
pub(crate) fn rgb<L: Lanes>(luminance: L, [rho, beta]: [L; 2]) -> [L; 3] {
    let green = rho.neg_mul_add(L::splat(LUMINANCE[0] / LUMINANCE[1]), L::splat(1.0));
    let green = beta.neg_mul_add(L::splat(LUMINANCE[2] / LUMINANCE[1]), green);
    [rho.mul_add(luminance, luminance), green * luminance, beta.mul_add(luminance, luminance)]
}

/// Base-2 logarithm of the luminance, and the relative colour differences, of a colour without negative channels. The colour is
/// given by the base-2 logarithms of red, green and blue; -126 and less stand for 0.
///
/// Returns: the logarithm, -126 for black, and `(R - Y) / Y`, `(B - Y) / Y`.
pub fn color_differences(log2_rgb: [f32; 3]) -> (f32, [f32; 2]) {
    let [red, green, blue] =
        log2_rgb.map(|log2| if log2 > -126.0 { libm::exp2(f64::from(log2)) } else { 0.0 });
    let [of_red, of_green, of_blue] = LUMINANCE.map(f64::from);
    // The three weights are 1 together but for rounding: a grey has its own logarithm.
    let luminance = (of_red * red + of_green * green + of_blue * blue) / (of_red + of_green + of_blue);
    if luminance <= 0.0 {
        return (-126.0, [0.0; 2]);
    }
    let difference = |channel: f64| ((channel - luminance) / luminance) as f32;
    ((libm::log2(luminance) as f32).max(-126.0), [difference(red), difference(blue)])
}

/// Whether a lobe or a diffuse term may have this colour: finite, its luminance not negative, no channel
/// farther from 0 than 32 times that.
pub(crate) fn is_admissible(rgb: Vec3) -> bool {
    // A colour without negative channels needs no such bound, which rounding could break for the smallest of
    // numbers.
    rgb.is_finite() && (rgb.min_element() >= 0.0 || rgb.abs().max_element() <= MOST_CHANNEL * luminance(rgb))
}
