//! Powers of two, logarithms, sines and arc tangents of every lane.
//!
//! Each is one text for all levels; operations that a level does in instructions of its own are methods of [`Lanes`].
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use super::lanes::{Lanes, ROUND, quadrant};

/// `2^t`, exactly 0 below 2^-125. Relative error below 2.5e-7; `t` at most 127.
#[inline(always)]
pub fn exp2<L: Lanes>(t: L) -> L {
    exp2_above::<L, false>(t, -125.0)
}

/// [`exp2`] where it is rare: a call, in a program for a small processor.
#[cfg_attr(not(feature = "simd"), inline(never))]
#[cfg_attr(feature = "simd", inline(always))]
pub fn rare_exp2<L: Lanes>(t: L) -> L {
    exp2(t)
}

/// [`exp2`] by a shorter chain of more operations; other digits.
#[inline(always)]
pub fn exp2_soon<L: Lanes>(t: L) -> L {
    exp2_above::<L, true>(t, -125.0)
}

/// `2^t`, exactly 0 below 2^-100: the fall of a lobe. Relative error below 2.5e-7; `t` at most 127.
///
/// Neither the result nor its product with an amplitude above 2^-25 is a subnormal: one subnormal in a vector makes an Intel
/// processor take 150 cycles for that instruction. Among sixteen directions there is often one whose exponent is near -127.
#[inline(always)]
pub fn falloff<L: Lanes>(t: L) -> L {
    exp2_above::<L, false>(t, -100.0)
}

/// [`falloff`] by a shorter chain of more operations, for one direction, which waits for it; other digits.
#[inline(always)]
pub fn falloff_soon<L: Lanes>(t: L) -> L {
    exp2_above::<L, true>(t, -100.0)
}

/// Whether [`falloff`] is not 0.
#[inline(always)]
pub fn is_left<L: Lanes>(t: L) -> L::Mask {
    // The nearest whole number is -100 or more; a half goes to the even one.
    t.ge(L::splat(-100.5))
}

/// [`falloff`] where [`is_left`]; `SOON`: [`falloff_soon`].
#[inline(always)]
pub fn falloff_left<L: Lanes, const SOON: bool>(t: L) -> L {
    let (power, whole) = exp2_in_parts::<L, SOON>(t);
    power.add_exponent(whole)
}

/// `2^t`, exactly 0 where `t` is less than `least`, to a half, or a NaN. `least` is -125 or more: no
/// subnormal. `SOON`: the polynomial by pairs of terms (Estrin 1960).
#[inline(always)]
fn exp2_above<L: Lanes, const SOON: bool>(t: L, least: f32) -> L {
    let (power, whole) = exp2_in_parts::<L, SOON>(t);
    power.times_exp2(whole, least)
}

/// The power of two of the rest of a number without a whole one, and that, as [`Lanes::split_whole`] gives it.
#[inline(always)]
fn exp2_in_parts<L: Lanes, const SOON: bool>(t: L) -> (L, L) {
    let (f, whole) = t.split_whole();
    // Minimax on [-1/2, 1/2], relative error 2.4e-7 with all roundings, or as the level says.
    if SOON {
        let [a, b, c, d, e] = L::EXP2;
        let ff = f * f;
        let high = ff.mul_add(f.mul_add(L::splat(a), L::splat(b)), f.mul_add(L::splat(c), L::splat(d)));
        return (ff.mul_add(high, f.mul_add(L::splat(e), L::splat(1.0))), whole);
    }
    // Without fused operations 1 + f c (f^2 + a f + b) (f^2 + d f + e) is as many operations as Horner's form
    // in half the latency; relative error 2.0e-7 with all roundings. One lane keeps the digits that fits have
    // seen.
    if !L::FUSED && L::COUNT > 1 {
        let factor = |a, b| (f + L::splat(a)) * f + L::splat(b);
        let product = factor(7.802_083_5, 21.231_173) * factor(-0.514_329_14, 24.590_559);
        let small = product * (f * L::splat(0.001_327_648));
        return (small + L::splat(1.0), whole);
    }
    let mut p = L::splat(L::EXP2[0]);
    for i in 1..5 {
        p = p.mul_add(f, L::splat(L::EXP2[i]));
    }
    (p.mul_add(f, L::splat(1.0)), whole)
}

/// `2^t` and `1 - 2^t`, `t` not positive: each to a relative error of 3e-7, the second near 0 too. `2^t` is exactly
/// 0 below 2^-125.
///
/// With `t = n + f`, `n` whole and `f` in [-1/2, 1/2], it is `(1 - 2^n) - 2^n (2^f - 1)`: exact, then small.
#[inline(always)]
pub fn exp2_and_rest<L: Lanes>(t: L) -> [L; 2] {
    let one = L::splat(1.0);
    let t = t.max(L::splat(-126.0));
    let whole = t + L::splat(ROUND);
    let f = t - (whole - L::splat(ROUND));
    // (2^f - 1) / f; minimax on [-1/2, 1/2].
    let ff = f * f;
    let high = f.mul_add(L::splat(1.559_467_2e-4), L::splat(1.340_664_4e-3));
    let middle = f.mul_add(L::splat(9.617_693e-3), L::splat(5.550_310_6e-2));
    let low = f.mul_add(L::splat(0.240_226_53), L::splat(core::f32::consts::LN_2));
    let less = ff.mul_add(ff.mul_add(high, middle), low) * f;
    let power = one.add_exponent(whole);
    let exp2 = power.mul_add(less, power).keep(whole.ge(L::splat(ROUND - 125.0)));
    [exp2, power.neg_mul_add(less, one - power)]
}

/// `(ln x + rest) factor` of a positive normal number and a small one; relative error of the logarithm below
/// 2e-7 away from 1, absolute 1e-7 times `|x - 1|` near it. And that plus 2.
#[inline(always)]
pub fn ln_plus_times<L: Lanes>(x: L, rest: L, factor: L) -> [L; 2] {
    let (m, e) = x.split_exponent();
    let f = m - L::splat(1.0);
    // ln(1 + f) = f - f^2 / 2 + f^3 p(f); Cephes logf, Moshier 1992. Pairs, fours and eights of terms (Estrin
    // 1960): half the latency of Horner's form, for one multiplication.
    let ff = f * f;
    let ffff = ff * ff;
    let p0 = f.mul_add(L::splat(-2.499_999_4e-1), L::splat(0.333_333_3));
    let p2 = f.mul_add(L::splat(-1.666_805_7e-1), L::splat(2.000_071_5e-1));
    let p4 = f.mul_add(L::splat(-1.242_014_1e-1), L::splat(1.424_932_3e-1));
    let p6 = f.mul_add(L::splat(-1.151_461e-1), L::splat(1.167_699_84e-1));
    let p4 = ffff.mul_add(L::splat(7.037_683_6e-2), ff.mul_add(p6, p4));
    let p = ffff.mul_add(p4, ff.mul_add(p2, p0));
    // All that does not wait for the polynomial is done beside it: two operations are left, also of the sum
    // with 2 where one number is waited for. Without fused operations its digits would be others than those
    // that fits have seen.
    const PLACE: f32 = 1.0 / 8_388_608.0;
    let low = ff.neg_mul_add(L::splat(0.5), e.mul_add(L::splat(-2.121_944_4e-4 * PLACE), rest));
    let (small, large) = (p.mul_add(f * ff, low), e.mul_add(L::splat(0.693_359_4 * PLACE), f) * factor);
    let (product, two) = (small.mul_add(factor, large), L::splat(2.0));
    [product, if L::FUSED && L::COUNT == 1 { small.mul_add(factor, large + two) } else { product + two }]
}

/// Sine and cosine of an angle in `[-8, 8]`; absolute error below 1.2e-7.
#[inline(always)]
pub fn sin_cos<L: Lanes>(angle: L) -> (L, L) {
    let n = angle.mul_add(L::splat(core::f32::consts::FRAC_2_PI), L::splat(ROUND));
    let q = n - L::splat(ROUND);
    // pi/2 in three parts, the first with few enough bits that the product with q is exact.
    let r = q.neg_mul_add(L::splat(1.570_312_5), angle);
    let r = q.neg_mul_add(L::splat(4.837_513e-4), r);
    let r = q.neg_mul_add(L::splat(7.549_79e-8), r);
    quadrant(r, n)
}

/// `sin(x) / x` and the cosine of an angle of at most pi, of its square: what turns an angle as a vector into a direction, without a root or a
/// division. Absolute error below 1.4e-7 and 5e-7, up to pi / 2 below 1.0e-7.
#[cfg(feature = "simd")]
#[inline(always)]
pub fn sinc_cos<L: Lanes>(square: L) -> (L, L) {
    // Minimax of their excess over 1, divided by the square; errors 8.1e-10 and 1.2e-8.
    const SINC: [f32; 6] =
        [1.364_381_1e-10, -2.473_856_8e-8, 2.753_704e-6, -1.984_060_4e-4, 8.333_324e-3, -0.166_666_66];
    const COS: [f32; 6] =
        [1.729_061_4e-9, -2.709_348_6e-7, 2.477_164_4e-5, -1.388_790_5e-3, 4.166_652e-2, -0.499_999_9];
    let (mut sinc, mut cos) = (L::splat(SINC[0]), L::splat(COS[0]));
    for i in 1..6 {
        sinc = sinc.mul_add(square, L::splat(SINC[i]));
        cos = cos.mul_add(square, L::splat(COS[i]));
    }
    let one = L::splat(1.0);
    (sinc.mul_add(square, one), cos.mul_add(square, one))
}

/// Sine and cosine of `2 pi u`, `u` in `[0, 1]`; absolute error below 1.2e-7.
#[inline(always)]
pub fn sin_cos_turns<L: Lanes>(u: L) -> (L, L) {
    u.sin_cos_turns()
}

/// Angle of the vector (x, y), both not negative and not both 0, from the x axis; relative error below 3e-7.
#[inline(always)]
pub fn atan2_positive<L: Lanes>(y: L, x: L) -> L {
    let a = y.min(x) / y.max(x);
    let aa = a * a;
    // Minimax of atan(a) / a in a^2 on [0, 1], relative error 1.6e-8. With fused operations by pairs and fours of
    // terms (Estrin 1960): half the latency of Horner's form.
    const TERMS: [f32; 8] = [
        0.002_849_886_4,
        -0.016_068_615,
        0.042_691_5,
        -0.075_042_926,
        0.106_409_33,
        -0.142_036_44,
        0.199_926_2,
        -0.333_330_72,
    ];
    let mut p = L::splat(TERMS[0]);
    if L::FUSED {
        let pair = |i: usize| L::splat(TERMS[i]).mul_add(aa, L::splat(TERMS[i + 1]));
        let square = aa * aa;
        let (high, low) = (pair(0).mul_add(square, pair(2)), pair(4).mul_add(square, pair(6)));
        p = high.mul_add(square * square, low);
    } else {
        for i in 1..8 {
            p = p.mul_add(aa, L::splat(TERMS[i]));
        }
    }
    let angle = (p * aa).mul_add(a, a);
    L::select(x.lt(y), L::splat(core::f32::consts::FRAC_PI_2) - angle, angle)
}
