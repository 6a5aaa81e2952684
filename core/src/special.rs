//! Every form that would cancel, once: the normaliser of a Gaussian lobe, its distribution and the inverse of
//! that, the scaled Bessel function and the Langevin function.
//!
//! The polar angle is carried as `w = 1 - cos theta` in [0, 2]: near the axis of a sharp lobe the cosine
//! itself has no digits left.

use crate::float;
use core::f32::consts::PI;

/// Below this sharpness a lobe is constant over the sphere to within a tenth of a rounding.
const FLAT: f32 = 1e-8;

/// Integrates a Gaussian lobe of unit amplitude over the whole sphere.
///
/// `I(s) = 2 pi (1 - exp(-2 s)) / s`, written `-2 pi expm1(-2 s) / s` so that a small `s` does not cancel.
///
/// Returns: sr. Range: sharpness in [0, 4e8]; 0 gives `4 pi`. Accuracy: relative 5e-7 (`INTEGRAL` of the
/// tests).
/// Source: Weng and Shih 2006, eq. 5, integrated.
#[inline]
pub fn sphere_integral(sharpness: f32) -> f32 {
    if sharpness < FLAT { 4.0 * PI } else { -2.0 * PI * float::exp_m1(-2.0 * sharpness) / sharpness }
}

/// Integrates a Gaussian lobe of unit amplitude over the cap within `w = 1 - cos angle` of its axis.
///
/// `2 pi (1 - exp(-s w)) / s`; `2 pi w` at s = 0. An angle in radians is `w = 2 sin^2(angle / 2)`.
///
/// Returns: sr. Range: `w` in [0, 2], sharpness in [0, 4e8]. Accuracy: relative 5e-7.
#[inline]
pub fn cap_integral(sharpness: f32, one_minus_cos: f32) -> f32 {
    let x = sharpness * one_minus_cos;
    // The quotient of two tiny numbers would underflow; 1 - x/2 is all of the series that f32 sees there.
    if x < 1e-4 {
        2.0 * PI * one_minus_cos * (1.0 - x * (0.5 - x / 6.0))
    } else {
        -2.0 * PI * float::exp_m1(-x) / sharpness
    }
}

/// Share of a Gaussian lobe that lies within `w = 1 - cos angle` of its axis: the distribution function of
/// `w`.
///
/// `(1 - exp(-s w)) / (1 - exp(-2 s))`; `w / 2` at s = 0. The inverse of [`one_minus_cos`].
///
/// Range: `w` in [0, 2], sharpness in [0, 4e8]. Accuracy: relative 5e-7.
#[inline]
pub fn share_within(sharpness: f32, one_minus_cos: f32) -> f32 {
    if sharpness < FLAT {
        return 0.5 * one_minus_cos;
    }
    let whole = -float::exp_m1(-2.0 * sharpness);
    let x = sharpness * one_minus_cos;
    let share = if x < 1e-4 {
        one_minus_cos * (1.0 - x * (0.5 - x / 6.0)) * (sharpness / whole)
    } else {
        -float::exp_m1(-x) / whole
    };
    share.min(1.0)
}

/// Inverts the distribution of a Gaussian lobe: `w = 1 - cos angle` of the cap that holds a share `u` of the
/// lobe.
///
/// `w = -ln(1 + u expm1(-2 s)) / s`. Where the argument of the logarithm is small it is summed as
/// `(1 - u) + u exp(-2 s)`: `1 - u` is exact there, `u expm1(-2 s)` is not.
///
/// Returns: `1 - cos theta` in [0, 2]. Range: `u` in [0, 1]; sharpness in [0, 4e8]; 0 gives `2 u`, u = 1
/// gives 2.
/// Accuracy: relative 2e-6 (`ONE_MINUS_COS` of the tests) for every `u`.
#[inline]
pub fn one_minus_cos(u: f32, sharpness: f32) -> f32 {
    if sharpness < FLAT {
        return 2.0 * u;
    }
    if u >= 1.0 {
        return 2.0;
    }
    let whole = -float::exp_m1(-2.0 * sharpness);
    let drop = u * whole;
    if drop < 1e-4 {
        // Two terms of -ln(1 - drop); the quotient first, so that no tiny `u` underflows.
        return u * (whole / sharpness) * (1.0 + drop * (0.5 + drop / 3.0));
    }
    let log = if drop <= 0.5 {
        float::ln_1p(-drop)
    } else {
        float::ln((1.0 - u) + u * float::exp(-2.0 * sharpness))
    };
    (-log / sharpness).clamp(0.0, 2.0)
}

/// Bounds the share of a Gaussian lobe that lies below the horizon z = 0, for an axis above it.
///
/// `exp(-s (1 - t))`, `t = sqrt(1 - axis.z^2)` the largest cosine that a direction below the horizon can
/// have. The proof stands in [`Folded`](crate::Folded). 1 for an axis on the horizon or below.
#[inline]
pub fn share_below_horizon_bound(axis_z: f32, sharpness: f32) -> f32 {
    if axis_z <= 0.0 {
        return 1.0;
    }
    // 1 - t without cancellation.
    let squared = (axis_z * axis_z).min(1.0);
    float::exp(-sharpness * (squared / (1.0 + float::sqrt(1.0 - squared))))
}

/// Modified Bessel function of order 0, scaled: `exp(-x) I0(x)`.
///
/// Up to 8 the power series, whose terms are all positive; beyond, `sqrt(x) exp(-x) I0(x)` as a polynomial in
/// `1 / x` (minimax, relative error 4e-9 before rounding).
///
/// Range: `x` in [0, 1e38]. Accuracy: relative 4e-7 (`BESSEL` of the tests).
#[inline]
pub fn bessel_i0_scaled(x: f32) -> f32 {
    if x <= 8.0 {
        let q = 0.25 * x * x;
        // 1 + q (1 + q/4 (1 + q/9 (1 + ...))): every step divides by the square of its number.
        let mut sum = 1.0;
        for k in (1..=17).rev() {
            let square: f32 = SQUARE_INVERSE[k - 1];
            sum = 1.0 + sum * q * square;
        }
        sum * float::exp(-x)
    } else {
        let y = 1.0 / x;
        let mut p = 0.371_994_93;
        for c in [-0.008_832_3, 0.033_233_373, 0.027_923_534, 0.049_869_2, 0.398_942_3] {
            p = p * y + c;
        }
        p * float::sqrt(y)
    }
}

/// `1 / k^2`.
const SQUARE_INVERSE: [f32; 17] = {
    let mut table = [0.0; 17];
    let mut k = 0;
    while k < 17 {
        table[k] = 1.0 / ((k + 1) * (k + 1)) as f32;
        k += 1;
    }
    table
};

/// Langevin function `coth s - 1 / s`: the mean cosine to the axis of a Gaussian lobe.
///
/// Up to 3 the continued fraction `s / (3 + s^2 / (5 + s^2 / (7 + ...)))`, whose parts are all positive;
/// beyond, the difference, which does not cancel there.
///
/// Range: sharpness in [0, 4e8]; 0 gives 0. Accuracy: relative 5e-7.
#[inline]
pub fn mean_cosine(sharpness: f32) -> f32 {
    let s = sharpness;
    if s <= 3.0 {
        let q = s * s;
        let mut f = 21.0;
        for odd in [19.0, 17.0, 15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0] {
            f = odd + q / f;
        }
        s / f
    } else {
        // coth s = 1 + 2 exp(-2 s) / (1 - exp(-2 s)).
        let e = float::exp(-2.0 * s);
        (1.0 - 1.0 / s) + 2.0 * e / (1.0 - e)
    }
}
