//! The one place that chooses the elementary functions, with or without `std`, so that results do not depend
//! on the platform's C library: `libm` where it computes in f32 alone, and our own exp2, sine and cosine,
//! because `libm`'s pass through f64, which small processors lack.

#[cfg(any(feature = "zonal", test))]
pub(crate) use crate::simd::elementary::sin_cos;
pub(crate) use crate::simd::elementary::sin_cos_turns;
pub(crate) use crate::simd::scalar::sqrt;

/// The largest number below 1: uniform numbers lie in [0, 1), and a number computed from them may round to 1.
pub(crate) const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

/// `2^x`: 0 below -160, infinite from 130 on.
///
/// `x = n + f` with `n` whole and `f` in [-1/2, 1/2], both exact; a polynomial of degree 6 for `2^f`
/// (relative error 2e-9 before rounding). Relative error at most 1.3e-7 where the result is a normal number.
#[inline]
pub(crate) fn exp2(x: f32) -> f32 {
    // Adding 1.5 * 2^23 leaves the nearest whole number in the low bits.
    const ROUND: f32 = 12_582_912.0;
    // The comparisons keep a NaN, and the number that it makes is a NaN again.
    let x = if x < -160.0 { -160.0 } else { x };
    let x = if x > 130.0 { 130.0 } else { x };
    let n = (x + ROUND) - ROUND;
    let f = x - n;
    let mut p = 1.546_144_5e-4;
    for c in [1.340_042_8e-3, 9.618_057e-3, 5.550_327e-2, 2.402_265e-1, core::f32::consts::LN_2, 1.0] {
        p = p * f + c;
    }
    // Two factors, so that the scale itself neither over- nor underflows.
    let n = n as i32;
    let half = n / 2;
    let power = |k: i32| f32::from_bits(((k + 127) << 23) as u32);
    p * power(half) * power(n - half)
}

#[inline]
pub(crate) fn exp(x: f32) -> f32 {
    libm::expf(x)
}
#[inline]
pub(crate) fn exp_m1(x: f32) -> f32 {
    libm::expm1f(x)
}
#[inline]
pub(crate) fn ln(x: f32) -> f32 {
    libm::logf(x)
}
#[inline]
pub(crate) fn ln_1p(x: f32) -> f32 {
    libm::log1pf(x)
}
#[inline]
pub(crate) fn atan2(y: f32, x: f32) -> f32 {
    libm::atan2f(y, x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exp2_keeps_its_bound() {
        let mut worst = 0f64;
        for i in -1_250_000..1_270_000 {
            let x = i as f32 * 1.000_3e-4;
            let exact = f64::from(x).exp2();
            worst = worst.max((f64::from(exp2(x)) / exact - 1.0).abs());
        }
        assert!(worst < 1.3e-7, "{worst:e}");
        assert_eq!(exp2(-200.0), 0.0);
        assert_eq!(exp2(f32::NEG_INFINITY), 0.0);
        assert_eq!(exp2(200.0), f32::INFINITY);
        assert_eq!(exp2(0.0), 1.0);
        assert!(exp2(f32::NAN).is_nan());
    }

    #[test]
    fn sine_and_cosine_keep_their_bounds() {
        let (mut absolute, mut relative) = (0f64, 0f64);
        for i in -200_000..200_000 {
            let t = i as f32 * 5.000_01e-6;
            let x = f64::from(t) * core::f64::consts::TAU;
            let (s, c) = sin_cos_turns(t);
            let error = (f64::from(s) - x.sin()).abs();
            absolute = absolute.max(error).max((f64::from(c) - x.cos()).abs());
            if t != 0.0 && t.abs() <= 0.125 {
                relative = relative.max(error / x.sin().abs());
            }
            let x = t * 7.9;
            let (s, c) = sin_cos(x);
            let exact = f64::from(x).sin_cos();
            absolute = absolute.max((f64::from(s) - exact.0).abs()).max((f64::from(c) - exact.1).abs());
        }
        assert!(absolute < 1.2e-7, "{absolute:e}");
        assert!(relative < 3e-7, "{relative:e}");
    }
}
