//! The directions of a block as the lobes see them, each in a frame of its own.
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use crate::simd::lanes::{Lanes, Numbers, WIDEST};
#[cfg(feature = "simd")]
use crate::squeeze::Sight;
use crate::squeeze::{NUMBERS, Precise, Seen};

/// The numbers of a block's directions as round and as squeezed lobes see them: structures of arrays.
pub(crate) type Sights = [[Numbers; NUMBERS]; 2];

/// Turns and squeezes directions; `azimuth`, its `excess` and `stretch` as a [`crate::squeeze::Squeeze`] has
/// them. `L`: what sums the lobes.
#[inline(always)]
pub(crate) fn sights<L: Lanes>(
    azimuth: [Numbers; 2],
    excess: Numbers,
    [along, inverse]: [Numbers; 2],
    [x, y, z]: &[Numbers; 3],
) -> Sights {
    let mut sights = [[[0.0; WIDEST]; NUMBERS]; 2];
    // The compiler makes vectors of this loop.
    for i in 0..WIDEST {
        let precise = Precise::new([azimuth[0][i], azimuth[1][i]], excess[i], along[i], inverse[i]);
        let pair = precise.see([x[i], y[i], z[i]], L::FUSED);
        for kind in 0..2 {
            let numbers = pair[kind].to_numbers();
            for n in 0..NUMBERS {
                sights[kind][n][i] = numbers[n];
            }
        }
    }
    sights
}

/// One direction of a block, as round and as squeezed lobes see it.
#[cfg(feature = "simd")]
#[inline(always)]
pub(crate) fn sight(sights: &Sights, i: usize) -> [Sight; 2] {
    let mut pair = [[0.0; NUMBERS]; 2];
    for kind in 0..2 {
        for n in 0..NUMBERS {
            pair[kind][n] = sights[kind][n][i];
        }
    }
    [Sight::from_numbers(pair[0]), Sight::from_numbers(pair[1])]
}

/// One direction of a block as lobes see it, squeezed in the lanes of a mask. It goes from memory to all lanes
/// at once: as numbers in registers it would take the port of the additions.
#[inline(always)]
pub(crate) fn seen<L: Lanes>(sights: &Sights, i: usize, squeezed: L::Mask) -> Seen<L> {
    let mut numbers = [L::splat(0.0); NUMBERS];
    for n in 0..NUMBERS {
        // A direction that is only turned keeps its length.
        let is_one = n == LENGTH || n == INVERSE_SQUARE || n == SCALE;
        let turned = L::splat(if is_one { 1.0 } else { sights[0][n][i] });
        numbers[n] = L::select(squeezed, L::splat(sights[1][n][i]), turned);
    }
    Seen::from_numbers(numbers)
}

/// Places of some of the numbers.
const LENGTH: usize = 6;
const INVERSE_SQUARE: usize = 7;
const SCALE: usize = 9;
