//! The directions of a block as the lobes see them, each in a frame of its own.
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use crate::simd::elementary::{falloff, falloff_soon, is_left};
use crate::simd::lanes::{Lanes, Numbers, WIDEST};
use crate::squeeze::{NUMBERS, Precise, Seen};

/// The numbers of a block's directions as round and as squeezed lobes see them: structures of arrays, whose numbers are pairs.
pub(crate) type Sights = [[[f32; 2]; WIDEST]; NUMBERS];

/// Turns and squeezes directions; `azimuth`, its `excess` and `stretch` as a [`crate::squeeze::Squeeze`] has
/// them. `L`: what sums the lobes.
#[inline(always)]
pub(crate) fn sights<L: Lanes>(
    azimuth: [Numbers; 2],
    excess: Numbers,
    [along, inverse]: [Numbers; 2],
    [x, y, z]: &[Numbers; 3],
) -> Sights {
    let mut sights = [[[0.0; 2]; WIDEST]; NUMBERS];
    // The compiler makes vectors of this loop.
    for i in 0..WIDEST {
        let precise = Precise::new([azimuth[0][i], azimuth[1][i]], excess[i], along[i], inverse[i]);
        let pair = precise.see([x[i], y[i], z[i]], L::FUSED);
        let (turned, squeezed) = (pair[0].to_numbers(), pair[1].to_numbers());
        for n in 0..NUMBERS {
            sights[n][i] = [turned[n], squeezed[n]];
        }
    }
    sights
}

/// One direction of a block as lobes see it, squeezed in the lanes of a mask. It goes from memory to all lanes
/// at once: as numbers in registers it would take the port of the additions.
#[inline(always)]
pub(crate) fn seen<L: Lanes>(sights: &Sights, i: usize, squeezed: L::Mask) -> Seen<L> {
    let mut numbers = [L::splat(0.0); NUMBERS];
    for n in 0..NUMBERS {
        // With fused operations no direction is made shorter, so that both have one height.
        numbers[n] = if L::FUSED && n == HIGH_Z {
            L::splat(sights[n][i][0])
        } else {
            L::either(squeezed, &sights[n][i])
        };
    }
    Seen::from_numbers(numbers)
}

/// What lobes and their mirror images below the horizon have in a direction, of amplitude 1. `SOON`: by a shorter chain of more
/// operations.
#[inline(always)]
pub(crate) fn folded_falloff<L: Lanes, const SOON: bool>(
    [x, y, z]: [L; 3],
    rate: L,
    fold_rate: L,
    seen: &Seen<L>,
) -> L {
    let (mut rate, [mut dx, mut dy, mut dz]) = (rate, seen.high);
    if L::FUSED {
        dx = x.neg_mul_add(seen.length, dx) + seen.low[0];
        dy = y.neg_mul_add(seen.length, dy) + seen.low[1];
        dz = z.neg_mul_add(seen.length, dz);
        rate = rate * seen.inverse_square;
    } else {
        dx = (dx - x) + seen.low[0];
        dy = (dy - y) + seen.low[1];
        dz = (dz - z) + seen.low[2];
    }
    let t = rate * dx.mul_add(dx, dy.mul_add(dy, dz * dz));
    // |d - mirrored axis|^2 = |d - axis|^2 + 4 d.z axis.z
    let folded = fold_rate.mul_add(seen.height, t);
    let mut g = if SOON { falloff_soon(t) } else { falloff(t) };
    // Few lobes reach below the horizon: where an exponential is dear, a branch is cheaper.
    if L::FUSED || L::bits(is_left(folded)) != 0 {
        g = g + if SOON { falloff_soon(folded) } else { falloff(folded) };
    }
    g * seen.scale
}

/// Place of one of the numbers.
const HIGH_Z: usize = 2;
