//! The numbers of sixteen lobes of a mixture: a row for each number.

use crate::simd::lanes::WIDEST;

/// The numbers of sixteen lobes: a row for each of the constants below. A text finds all of them from one address.
///
/// Places from the count of lobes up to the next multiple of the lobes that one direction takes at a time (two
/// vectors on AVX2, one elsewhere) hold lobes of amplitude 0.
pub(crate) type Group = [[f32; WIDEST]; ROWS];

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

/// Groups whose rows begin at cache lines: a vector that lies in two takes twice the time.
#[repr(align(64))]
pub(crate) struct Aligned<const G: usize>(pub [Group; G]);

impl<const G: usize> Aligned<G> {
    pub const EMPTY: Self = Self([EMPTY_GROUP; G]);
}

/// Runs a text for the lobes of groups, a vector at a time: `$group` is the group, `$at` the place in it, `$k` the number of the first
/// lobe of the vector. `$few`: there is one group; then there is no loop, which would keep more constants in registers than there
/// are, and takes a tenth more time.
macro_rules! for_lobes {
    ($few:expr, $L:ty, $groups:expr, $count:expr, |$group:ident, $at:ident, $k:ident| $text:block) => {{
        let (count, lanes): (usize, usize) = ($count, <$L as $crate::simd::lanes::Lanes>::COUNT);
        let mut groups = $groups.into_iter();
        if $few && lanes == $crate::simd::lanes::WIDEST {
            if let Some($group) = groups.next()
                && count > 0
            {
                let ($at, $k): (usize, usize) = (0, 0);
                $text
            }
        } else {
            let mut k = 0;
            for $group in groups {
                let mut at = 0;
                while k < count && at + lanes <= $crate::simd::lanes::WIDEST {
                    let ($at, $k) = (at, k);
                    $text(k, at) = (k + lanes, at + lanes);
                }
            }
        }
    }};
}
pub(crate) use for_lobes;

/// Lobes without an amplitude.
pub(crate) const EMPTY_GROUP: Group = [[0.0; WIDEST]; ROWS];
