//! Sums and products with what rounding takes from them (Dekker 1971, Knuth 1969): numbers of twice the
//! digits of f32.

use super::lanes::Lanes;

/// Half of the excess of the squared length of a plane vector, which is 1 but for rounding, over 1.
#[cfg(feature = "simd")]
#[inline(always)]
pub fn half_excess([x, y]: [f32; 2]) -> f32 {
    let (x, y) = (f64::from(x), f64::from(y));
    (0.5 * (x * x + y * y - 1.0)) as f32
}

/// The same bits by whole numbers: a small processor works out each operation of f64 by a hundred of its own.
#[cfg(any(test, not(feature = "simd")))]
#[inline]
pub fn half_excess_in_whole_numbers(vector: [f32; 2]) -> f32 {
    // The square in units of 2^-62; the lowest bit is also set if some bit below was.
    const UNIT: u32 = 62;
    let square = |x: f32| {
        let (mantissa, exponent) = (u64::from(x.to_bits() & 0x7f_ffff | 0x80_0000), x.to_bits() >> 23 & 0xff);
        let square = mantissa * mantissa;
        // x = mantissa 2^(exponent - 150); no component exceeds 1 by more than its rounding.
        let up = (2 * exponent + UNIT).wrapping_sub(300) as i32;
        if up >= 0 {
            square << (up as u32 & 31)
        } else {
            let down = up.unsigned_abs().min(63);
            square >> down | u64::from(square & ((1 << down) - 1) != 0)
        }
    };
    let sum = square(vector[0]).wrapping_add(square(vector[1]));
    // To the 53 bits of f64, halves to the even neighbour.
    let drop = 11u32.saturating_sub(sum.leading_zeros()).max(1);
    let rounded = sum.wrapping_add((1 << (drop - 1)) - 1 + (sum >> drop & 1)) >> drop << drop;
    (rounded as i64 - (1 << UNIT)) as f32 * (1.0 / (1u64 << (UNIT + 1)) as f32)
}

#[cfg(not(feature = "simd"))]
pub use half_excess_in_whole_numbers as half_excess;

/// `a + b` and its rounding error (Knuth 1969).
#[inline(always)]
pub fn two_sum<L: Lanes>(a: L, b: L) -> (L, L) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}

/// `a b` and its rounding error: one fused operation, or Dekker's 17 (1971), exact while nothing under- or
/// overflows.
#[inline(always)]
pub fn two_product<L: Lanes>(a: L, b: L) -> (L, L) {
    let product = a * b;
    if L::FUSED {
        return (product, a.mul_add(b, L::splat(0.0) - product));
    }
    let halves = |v: L| {
        let t = L::splat(4097.0) * v; // 2^12 + 1: halves of 12 bits
        let high = t - (t - v);
        (high, v - high)
    };
    let ((ah, al), (bh, bl)) = (halves(a), halves(b));
    (product, ((ah * bh - product) + ah * bl + al * bh) + al * bl)
}

/// `a b + c d` as a sum of two.
#[inline(always)]
pub fn sum_of_products<L: Lanes>(a: L, b: L, c: L, d: L) -> (L, L) {
    let (p, p_error) = two_product(a, b);
    let (q, q_error) = two_product(c, d);
    let (sum, error) = two_sum(p, q);
    (sum, error + (p_error + q_error))
}

/// `|v|^2 - 1` of a vector that f32 takes for a unit vector, without losing its digits.
#[inline(always)]
pub fn length_squared_minus_one<L: Lanes>([x, y, z]: [L; 3]) -> L {
    let (xx, x_error) = two_product(x, x);
    let (yy, y_error) = two_product(y, y);
    let (zz, z_error) = two_product(z, z);
    let (sum, xy_error) = two_sum(xx, yy);
    let (sum, error) = two_sum(sum, zz);
    (sum - L::splat(1.0)) + ((x_error + y_error) + (z_error + (xy_error + error)))
}

#[cfg(all(test, feature = "simd"))]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_give_the_bits_of_f64() {
        let mut state = 1u32;
        let mut uniform = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 * (1.0 / 16_777_216.0)
        };
        for i in 0..4_000_000 {
            // Every fourth vector is nearly along an axis.
            let small = if i % 4 == 0 { (uniform() * -60.0).exp2() } else { 1.0 };
            let (x, y) = (uniform() * 2.0 - 1.0, (uniform() * 2.0 - 1.0) * small);
            let inverse = 1.0 / (x * x + y * y).sqrt();
            if !inverse.is_finite() {
                continue;
            }
            let vector = if i % 2 == 0 { [x * inverse, y * inverse] } else { [y * inverse, x * inverse] };
            let [got, want] = [half_excess_in_whole_numbers(vector), half_excess(vector)];
            assert_eq!(got.to_bits(), want.to_bits(), "{vector:?}: {got:e} {want:e}");
        }
        for vector in [[1.0, 0.0], [0.0, -1.0], [0.8, -0.6], [1.0, 1e-30], [-1.0, 1e-40]] {
            assert_eq!(half_excess_in_whole_numbers(vector).to_bits(), half_excess(vector).to_bits());
        }
    }
}
