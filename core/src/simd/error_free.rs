//! Sums and products with what rounding takes from them (Dekker 1971, Knuth 1969): numbers of twice the
//! digits of f32.

use super::lanes::Lanes;

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
