//! The rows of a mixture, one for each number of a lobe, and vectors of lobes in them.
//!
//! A row need not be a multiple of the lanes: then the last vector is of fewer numbers, and goes through a padded copy.
//! The compiler knows the case.

use crate::simd::lanes::{Lanes, PARTS, WIDEST, WIDEST_PAIR};

/// The numbers of a mixture for each of `N` lobes: a row for each of the constants below.
///
/// Places from the count of lobes up to the next multiple of the lobes that one direction takes at a time (two
/// vectors on AVX2, one elsewhere) hold lobes of amplitude 0.
pub(crate) type Rows<const N: usize> = [[f32; N]; ROWS];

/// The rows of sixteen lobes. A text finds all of them from one address.
pub(crate) type Block = Rows<WIDEST>;

/// Number of rows.
pub(crate) const ROWS: usize = 14;

pub(crate) const AXIS_X: usize = 0;
pub(crate) const AXIS_Y: usize = 1;
pub(crate) const AXIS_Z: usize = 2;
pub(crate) const SHARPNESS: usize = 3;
pub(crate) const RED: usize = 4;
pub(crate) const GREEN: usize = 5;
pub(crate) const BLUE: usize = 6;
/// Luminance of the amplitude.
pub(crate) const LUMINANCE: usize = 7;
/// `-s / 2` in base 2: times the squared chord it is the exponent.
pub(crate) const RATE: usize = 8;
/// `-2 s axis.z` in base 2: times d.z the fold adds it to the exponent. A lobe may not need its fold, but share a
/// vector with one that does. It has minus infinity, or a NaN times 0, which both leave nothing of the fold.
pub(crate) const FOLD_RATE: usize = 9;
/// `1 / s`, of at least 1e-7: below, the lobe is constant to f32.
pub(crate) const INVERSE_SHARPNESS: usize = 10;
/// `1 - exp(-2 s)`.
pub(crate) const INSIDE: usize = 11;
/// `exp(-2 s)`.
pub(crate) const TAIL: usize = 12;
/// Running sum of the luminance of the integrals.
pub(crate) const CUMULATIVE: usize = 13;

/// Blocks for a mixture of any capacity.
pub(crate) const EMPTY_BLOCKS: [Block; PARTS] = [[[0.0; WIDEST]; ROWS]; PARTS];

/// The rows as a block, if they are as long as one.
#[inline(always)]
pub(crate) fn as_block<const N: usize>(rows: &Rows<N>) -> Option<&Block> {
    let (numbers, _) = rows.as_flattened().as_chunks::<WIDEST>();
    if N == WIDEST { numbers.first_chunk() } else { None }
}

/// Copies the rows of the first `count` lobes into blocks; returns these.
#[inline(always)]
pub(crate) fn copy_into<'a, const N: usize>(
    rows: &Rows<N>,
    count: usize,
    blocks: &'a mut [Block; PARTS],
) -> [&'a Block; PARTS] {
    for (p, block) in blocks.iter_mut().enumerate().take(count.min(N).div_ceil(WIDEST)) {
        let (from, count) = (p * WIDEST, WIDEST.min(N - p * WIDEST));
        for (to, row) in block.iter_mut().zip(rows) {
            to[..count].copy_from_slice(&row[from..from + count]);
        }
    }
    blocks.each_ref()
}

/// Lobe `from` takes the place of lobe `to`.
#[inline(always)]
pub(crate) fn move_lobe<const N: usize>(rows: &mut Rows<N>, from: usize, to: usize) {
    for row in rows {
        row[to] = row[from];
    }
}

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
