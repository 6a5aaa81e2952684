//! Every form that would cancel, once: the normaliser of a Gaussian lobe and the inverse of its distribution.

use crate::float;
use core::f32::consts::PI;

/// Integrates a Gaussian lobe of unit amplitude over the whole sphere.
///
/// `I(s) = 2 pi (1 - exp(-2 s)) / s`, written `-2 pi expm1(-2 s) / s` so that a small `s` does not cancel.
///
/// Returns: sr. Range: sharpness in [0, 1e8]; 0 gives `4 pi`.
/// Source: Weng and Shih 2006, eq. 5, integrated.
#[inline]
pub fn sphere_integral(sharpness: f32) -> f32 {
    if sharpness == 0.0 { 4.0 * PI } else { -2.0 * PI * float::exp_m1(-2.0 * sharpness) / sharpness }
}

/// Inverts the distribution of a Gaussian lobe: the angle within which a share `u` of the lobe lies, as `1 - cos`.
///
/// `w = -ln(1 + u expm1(-2 s)) / s`. `w` is carried in place of the cosine, which near 1 has no digits left for a
/// sharp lobe. Where the argument of the logarithm is small it is summed as `(1 - u) + u exp(-2 s)`: `1 - u` is exact
/// there, `u expm1(-2 s)` is not.
///
/// Returns: `1 - cos theta` in [0, 2]. Range: `u` in [0, 1]; sharpness in [0, 1e8]; 0 gives `2 u`.
#[inline]
pub fn one_minus_cos(u: f32, sharpness: f32) -> f32 {
    if sharpness == 0.0 {
        return 2.0 * u;
    }
    let drop = -u * float::exp_m1(-2.0 * sharpness);
    let log = if drop <= 0.5 {
        float::ln_1p(-drop)
    } else {
        float::ln((1.0 - u) + u * float::exp(-2.0 * sharpness))
    };
    // u = 1 at a large sharpness is -ln(0): the antipode, which f32 cannot tell from the limit.
    (-log / sharpness).clamp(0.0, 2.0)
}
