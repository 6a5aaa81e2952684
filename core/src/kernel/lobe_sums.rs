//! Sums the lobes of one mixture towards vectors of directions: lanes are directions, the lobes are taken one
//! after the other.
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use crate::mixture::rows::{Domain, Mixture};
use crate::simd::elementary::falloff;
use crate::simd::lanes::{Lanes, TOGETHER, scale};
use crate::squeeze::Seen;
use core::f32::consts::FRAC_1_PI;
use core::ops::Range;

/// What one stage leaves for the next: a number for each lobe, and one for its fold.
pub(crate) type Stage<L> = [L; STAGE];

pub(crate) const STAGE: usize = 16;

/// Sums the lobes and the diffuse term towards a vector of directions, once for each of `C` sets of
/// amplitudes.
#[inline(always)]
pub(crate) fn sums<L: Lanes, const N: usize, const C: usize>(
    m: &Mixture<'_, N>,
    amplitudes: [&[f32; N]; C],
    diffuse: [f32; C],
    d: [L; 3],
    stage: &mut Stage<L>,
) -> [L; C] {
    let mut acc = [L::splat(0.0); C];
    let turned = m.squeeze.turn(d);
    if m.squeezed > 0 {
        let (seen, lobes) = (m.squeeze.squeeze(&turned), 0..m.squeezed);
        match (m.in_plane, L::FUSED) {
            (true, true) => run::<L, N, C, true, true, true>(m, amplitudes, &seen, lobes, &mut acc, stage),
            (true, false) => run::<L, N, C, true, true, false>(m, amplitudes, &seen, lobes, &mut acc, stage),
            (false, true) => run::<L, N, C, false, true, true>(m, amplitudes, &seen, lobes, &mut acc, stage),
            (false, false) => {
                run::<L, N, C, false, true, false>(m, amplitudes, &seen, lobes, &mut acc, stage)
            }
        }
        acc = scale(acc, seen.scale);
    }
    let lobes = m.squeezed..m.count;
    match (m.in_plane, m.squeeze.is_turned) {
        (true, true) => run::<L, N, C, true, true, false>(m, amplitudes, &turned, lobes, &mut acc, stage),
        (true, false) => run::<L, N, C, true, false, false>(m, amplitudes, &turned, lobes, &mut acc, stage),
        (false, true) => run::<L, N, C, false, true, false>(m, amplitudes, &turned, lobes, &mut acc, stage),
        (false, false) => run::<L, N, C, false, false, false>(m, amplitudes, &turned, lobes, &mut acc, stage),
    }
    if m.domain == Domain::Hemisphere {
        let zero = L::splat(0.0);
        let above = d[2].ge(zero);
        for i in 0..C {
            let sum = L::splat(diffuse[i] * FRAC_1_PI).mul_add(d[2], acc[i]);
            acc[i] = L::select(above, sum, zero);
        }
    }
    acc
}

/// Adds a run of lobes that see the same direction. `PLANE`: every axis has y = 0. `LOW`: the direction has a
/// low part. `LONG`: it has a length.
#[inline(always)]
fn run<L: Lanes, const N: usize, const C: usize, const PLANE: bool, const LOW: bool, const LONG: bool>(
    m: &Mixture<'_, N>,
    amplitudes: [&[f32; N]; C],
    seen: &Seen<L>,
    lobes: Range<usize>,
    acc: &mut [L; C],
    stage: &mut Stage<L>,
) {
    // Stretches of lobes that need their fold, and of lobes that do not: no branch in the loop over either.
    let (mut k, to) = (lobes.start, lobes.end.min(N));
    while k < to {
        let ahead = m.folded >> k;
        if ahead & 1 == 1 {
            let end = to.min(k + ahead.trailing_ones() as usize);
            stretch::<L, N, C, PLANE, LOW, LONG, true>(m, amplitudes, seen, k..end, acc, stage);
            k = end;
        } else {
            let end = to.min(k + ahead.trailing_zeros() as usize);
            stretch::<L, N, C, PLANE, LOW, LONG, false>(m, amplitudes, seen, k..end, acc, stage);
            k = end;
        }
    }
}

/// Adds lobes that all need their fold (`FOLD`), or none.
#[inline(always)]
fn stretch<
    L: Lanes,
    const N: usize,
    const C: usize,
    const PLANE: bool,
    const LOW: bool,
    const LONG: bool,
    const FOLD: bool,
>(
    m: &Mixture<'_, N>,
    amplitudes: [&[f32; N]; C],
    seen: &Seen<L>,
    lobes: Range<usize>,
    acc: &mut [L; C],
    stage: &mut Stage<L>,
) {
    let (mut k, to) = (lobes.start, lobes.end.min(N));
    // Axes in the plane share the part across it; its low part would only count relative to itself.
    let yy = seen.high[1] * seen.high[1];
    if L::VECTORS <= TOGETHER {
        for k in k..to {
            let axis = [m.axis_x[k], m.axis_y[k], m.axis_z[k]];
            let t = exponent::<L, PLANE, LOW, LONG>(axis, m.rate[k], seen, yy);
            let mut g = falloff(t);
            if FOLD {
                g = g + falloff(fold_exponent(m.fold_rate[k], seen, t));
            }
            for i in 0..C {
                acc[i] = g.mul_add(L::splat(amplitudes[i][k]), acc[i]);
            }
        }
        return;
    }
    // One lobe is a long chain of dependent operations, and a processor sees no further than a few of them
    // ahead. In stages, each a loop of its own with a short chain, it sees many lobes.
    while k < to {
        let n = (to - k).min(if FOLD { STAGE / 2 } else { STAGE });
        let (x, y, z) = (&m.axis_x[k..k + n], &m.axis_y[k..k + n], &m.axis_z[k..k + n]);
        let (rate, fold_rate) = (&m.rate[k..k + n], &m.fold_rate[k..k + n]);
        for j in 0..n {
            stage[j] = exponent::<L, PLANE, LOW, LONG>([x[j], y[j], z[j]], rate[j], seen, yy);
            if FOLD {
                stage[n + j] = fold_exponent(fold_rate[j], seen, stage[j]);
            }
        }
        for j in 0..if FOLD { 2 * n } else { n } {
            stage[j] = falloff(stage[j]);
        }
        if FOLD {
            for j in 0..n {
                stage[j] = stage[j] + stage[n + j];
            }
        }
        // Two channels at a time, and the last by itself: so many sums stay in registers. Both loops as one
        // function of one or two channels are compiled to 1.07 of the time.
        for i in (0..C).step_by(2) {
            let amplitude = &amplitudes[i][k..k + n];
            if i + 1 < C {
                let (other, mut sum) = (&amplitudes[i + 1][k..k + n], [acc[i], acc[i + 1]]);
                for j in 0..n {
                    sum[0] = stage[j].mul_add(L::splat(amplitude[j]), sum[0]);
                    sum[1] = stage[j].mul_add(L::splat(other[j]), sum[1]);
                }
                [acc[i], acc[i + 1]] = sum;
            } else {
                let mut sum = acc[i];
                for j in 0..n {
                    sum = stage[j].mul_add(L::splat(amplitude[j]), sum);
                }
                acc[i] = sum;
            }
        }
        k += n;
    }
}

/// The exponent of a lobe, to base 2; `yy` is the square of what is seen of y.
#[inline(always)]
fn exponent<L: Lanes, const PLANE: bool, const LOW: bool, const LONG: bool>(
    axis: [f32; 3],
    rate: f32,
    seen: &Seen<L>,
    yy: L,
) -> L {
    let ([x, y, z], [x_low, y_low, z_low]) = (seen.high, seen.low);
    let mut dx = apart::<L, LONG>(axis[0], x, seen.length);
    let mut dz = apart::<L, LONG>(axis[2], z, seen.length);
    if LOW {
        dx = lower::<L, LONG>(dx, x_low);
        // What is only turned or not made a unit vector has its height in one f32.
        if !L::FUSED {
            dz = lower::<L, LONG>(dz, z_low);
        }
    }
    let chord_squared = if PLANE {
        dx.mul_add(dx, dz.mul_add(dz, yy))
    } else {
        let mut dy = apart::<L, LONG>(axis[1], y, seen.length);
        if LOW {
            dy = lower::<L, LONG>(dy, y_low);
        }
        dx.mul_add(dx, dz.mul_add(dz, dy * dy))
    };
    let mut rate = L::splat(rate);
    if LONG {
        rate = rate * seen.inverse_square;
    }
    rate * chord_squared
}

/// The exponent of the fold of a lobe: `|d - mirrored axis|^2 = |d - axis|^2 + 4 d.z axis.z`, both terms of
/// one sign.
#[inline(always)]
fn fold_exponent<L: Lanes>(fold_rate: f32, seen: &Seen<L>, exponent: L) -> L {
    L::splat(fold_rate).mul_add(seen.height, exponent)
}

/// A component of the axis minus one of the direction, or of the direction minus the axis that is as long
/// (`LONG`): what is the same for all lobes stands where it may stay in memory.
#[inline(always)]
fn apart<L: Lanes, const LONG: bool>(axis: f32, direction: L, length: L) -> L {
    let axis = L::splat(axis);
    if LONG { axis.neg_mul_add(length, direction) } else { axis - direction }
}

/// Adds the low part of the direction to that.
#[inline(always)]
fn lower<L: Lanes, const LONG: bool>(apart: L, low: L) -> L {
    if LONG { apart + low } else { apart - low }
}
