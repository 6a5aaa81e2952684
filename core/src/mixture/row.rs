//! Vectors of lobes in the rows of a mixture, which need not be a multiple of the lanes: then the last vector is
//! of fewer numbers, and goes through a padded copy. Which it is, the compiler knows.

use crate::simd::lanes::{Lanes, WIDEST_PAIR};

/// Whether the `k`-th lobe is one of `count`, and within a row.
#[inline(always)]
pub(crate) fn is_within<L: Lanes, const N: usize>(k: usize, count: usize) -> bool {
    k < count && if N.is_multiple_of(L::COUNT) { k + L::COUNT <= N } else { k < N }
}

/// The numbers from the `k`-th on; behind the end of the row 0.
#[inline(always)]
pub(crate) fn load<L: Lanes, const N: usize>(row: &[f32; N], k: usize) -> L {
    if N.is_multiple_of(L::COUNT) {
        return L::load(&row[k..]);
    }
    let (mut padded, count) = ([0.0; WIDEST_PAIR], L::COUNT.min(N - k));
    padded[..count].copy_from_slice(&row[k..k + count]);
    L::load(&padded)
}

/// Stores numbers from the `k`-th on; numbers behind the end of the row go nowhere.
#[inline(always)]
pub(crate) fn store<L: Lanes, const N: usize>(numbers: L, row: &mut [f32; N], k: usize) {
    if N.is_multiple_of(L::COUNT) {
        return numbers.store(&mut row[k..]);
    }
    let (mut padded, count) = ([0.0; WIDEST_PAIR], L::COUNT.min(N - k));
    numbers.store(&mut padded);
    row[k..k + count].copy_from_slice(&padded[..count]);
}
