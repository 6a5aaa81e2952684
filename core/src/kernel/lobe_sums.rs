//! Sums the lobes of one mixture towards vectors of directions: lanes are directions, the lobes are taken one
//! after the other.
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use crate::mixture::row::{self, Group};
use crate::mixture::rows::{Domain, MixtureRef};
use crate::simd::elementary::falloff;
use crate::simd::lanes::{Lanes, Numbers, PARTS, TOGETHER, WIDEST, scale};
use crate::squeeze::Seen;
use core::f32::consts::FRAC_1_PI;
use core::ops::Range;

/// The results of one stage for the next: a number for each lobe, and one for its fold.
pub(crate) type Stage<L> = [L; STAGE];

pub(crate) const STAGE: usize = 16;

/// Sums the lobes and the diffuse term towards a vector of directions, once for each of `C` sets of
/// amplitudes.
#[inline(always)]
pub(crate) fn sums<L: Lanes, const C: usize>(
    m: &MixtureRef<'_>,
    diffuse: [f32; C],
    d: [L; 3],
    stage: &mut Stage<L>,
) -> [L; C] {
    let mut acc = [L::splat(0.0); C];
    let turned = m.head.squeeze.turn(d);
    if m.head.squeezed > 0 {
        let (seen, lobes) = (m.head.squeeze.squeeze(&turned), 0..m.head.squeezed);
        if L::FUSED {
            run::<L, C, Long>(m, &seen, lobes, &mut acc, stage);
        } else {
            run::<L, C, Split>(m, &seen, lobes, &mut acc, stage);
        }
        acc = scale(acc, seen.scale);
    }
    let lobes = m.head.squeezed..m.head.count;
    if m.head.squeeze.is_turned {
        run::<L, C, Split>(m, &turned, lobes, &mut acc, stage);
    } else {
        run::<L, C, Plain>(m, &turned, lobes, &mut acc, stage);
    }
    if m.head.domain == Domain::Hemisphere {
        let zero = L::splat(0.0);
        let above = d[2].ge(zero);
        for i in 0..C {
            let sum = L::splat(diffuse[i] * FRAC_1_PI).mul_add(d[2], acc[i]);
            acc[i] = L::select(above, sum, zero);
        }
    }
    acc
}

/// The form in which a direction is held that lobes see, and how far from an axis it is in that.
trait Form {
    /// A component of the axis minus one of the direction, or the other way round: the number that all lobes share is the operand
    /// that may stay in memory.
    fn apart<L: Lanes>(axis: f32, seen: &Seen<L>, i: usize) -> L;
    /// The factor that makes an exponent of the squared distance, in every lane.
    fn rate<L: Lanes>(rate: f32, seen: &Seen<L>) -> L;
}

/// One f32 a component, of length 1.
struct Plain;

/// Two f32 a component, of length 1: a direction that was turned, or squeezed and made a unit vector.
struct Split;

/// Two f32 a component, with a length: a squeezed direction, where operations are fused. The axis is made as
/// long.
struct Long;

/// Whether a component has a low part: a direction only turned, or not made a unit vector, has its height in one f32.
#[inline(always)]
fn has_low<L: Lanes>(i: usize) -> bool {
    i < 2 || !L::FUSED
}

impl Form for Plain {
    #[inline(always)]
    fn apart<L: Lanes>(axis: f32, seen: &Seen<L>, i: usize) -> L {
        L::splat(axis) - seen.high[i]
    }
    #[inline(always)]
    fn rate<L: Lanes>(rate: f32, _seen: &Seen<L>) -> L {
        L::splat(rate)
    }
}

impl Form for Split {
    #[inline(always)]
    fn apart<L: Lanes>(axis: f32, seen: &Seen<L>, i: usize) -> L {
        let apart = Plain::apart(axis, seen, i);
        if has_low::<L>(i) { apart - seen.low[i] } else { apart }
    }
    #[inline(always)]
    fn rate<L: Lanes>(rate: f32, _seen: &Seen<L>) -> L {
        L::splat(rate)
    }
}

impl Form for Long {
    #[inline(always)]
    fn apart<L: Lanes>(axis: f32, seen: &Seen<L>, i: usize) -> L {
        let apart = L::splat(axis).neg_mul_add(seen.length, seen.high[i]);
        if has_low::<L>(i) { apart + seen.low[i] } else { apart }
    }
    #[inline(always)]
    fn rate<L: Lanes>(rate: f32, seen: &Seen<L>) -> L {
        L::splat(rate) * seen.inverse_square
    }
}

/// Adds a run of lobes that see the same direction, which is held as `F` says.
#[inline(always)]
fn run<L: Lanes, const C: usize, F: Form>(
    m: &MixtureRef<'_>,
    seen: &Seen<L>,
    lobes: Range<usize>,
    acc: &mut [L; C],
    stage: &mut Stage<L>,
) {
    if m.head.in_plane {
        stretches::<L, C, F, true>(m, seen, lobes, acc, stage);
    } else {
        stretches::<L, C, F, false>(m, seen, lobes, acc, stage);
    }
}

/// Adds a run of lobes. `PLANE`: every axis has y = 0.
#[inline(always)]
fn stretches<L: Lanes, const C: usize, F: Form, const PLANE: bool>(
    m: &MixtureRef<'_>,
    seen: &Seen<L>,
    lobes: Range<usize>,
    acc: &mut [L; C],
    stage: &mut Stage<L>,
) {
    // Stretches of lobes of one block that need their fold, and of lobes that do not: no branch in the loop over
    // either.
    let (mut k, to) = (lobes.start, lobes.end.min(WIDEST * PARTS));
    while k < to {
        let lobes = Lobes::of_group(m.groups[k / WIDEST]);
        let (ahead, from, left) = (m.head.folded >> k, k % WIDEST, to - k);
        if ahead & 1 == 1 {
            let n = left.min(ahead.trailing_ones() as usize).min(WIDEST - from);
            stretch::<L, C, F, PLANE, true>(&lobes, seen, from..from + n, acc, stage);
            k += n;
        } else {
            let n = left.min(ahead.trailing_zeros() as usize).min(WIDEST - from);
            stretch::<L, C, F, PLANE, false>(&lobes, seen, from..from + n, acc, stage);
            k += n;
        }
    }
}

/// A block of lobes with `C` sets of amplitudes: red, green and blue, or the luminance.
struct Lobes<'a, const C: usize> {
    group: &'a Group,
    amplitudes: [&'a Numbers; C],
}

impl<'a, const C: usize> Lobes<'a, C> {
    #[inline(always)]
    fn of_group(group: &'a Group) -> Self {
        let mut amplitudes = [&group[row::LUMINANCE]; C];
        if C == 3 {
            amplitudes.copy_from_slice(&[&group[row::RED], &group[row::GREEN], &group[row::BLUE]]);
        }
        Self { group, amplitudes }
    }
}

/// Adds lobes that all need their fold (`FOLD`), or none.
#[inline(always)]
fn stretch<L: Lanes, const C: usize, F: Form, const PLANE: bool, const FOLD: bool>(
    lobes: &Lobes<'_, C>,
    seen: &Seen<L>,
    range: Range<usize>,
    acc: &mut [L; C],
    stage: &mut Stage<L>,
) {
    // Axes in the plane share the part across it; its low part would only count relative to itself.
    let yy = seen.high[1] * seen.high[1];
    if L::VECTORS <= TOGETHER {
        one_by_one::<L, C, F, PLANE, FOLD>(lobes, seen, yy, range, acc);
    } else {
        in_stages::<L, C, F, PLANE, FOLD>(lobes, seen, yy, range, acc, stage);
    }
}

/// Adds lobes one after the other.
#[inline(always)]
fn one_by_one<L: Lanes, const C: usize, F: Form, const PLANE: bool, const FOLD: bool>(
    lobes: &Lobes<'_, C>,
    seen: &Seen<L>,
    yy: L,
    range: Range<usize>,
    acc: &mut [L; C],
) {
    let group = lobes.group;
    let [x, y, z] = [&group[row::AXIS_X], &group[row::AXIS_Y], &group[row::AXIS_Z]];
    let (rate, fold_rate) = (&group[row::RATE], &group[row::FOLD_RATE]);
    for k in range.start..range.end.min(WIDEST) {
        let t = exponent::<L, F, PLANE>([x[k], y[k], z[k]], rate[k], seen, yy);
        let mut g = falloff(t);
        if FOLD {
            g = g + falloff(fold_exponent(fold_rate[k], seen, t));
        }
        for i in 0..C {
            acc[i] = g.mul_add(L::splat(lobes.amplitudes[i][k]), acc[i]);
        }
    }
}

/// Adds lobes in stages, each a loop of its own with a short chain of operations. One lobe is a long chain,
/// and a processor sees no further than a few of them ahead; of short ones it sees many.
#[inline(always)]
fn in_stages<L: Lanes, const C: usize, F: Form, const PLANE: bool, const FOLD: bool>(
    lobes: &Lobes<'_, C>,
    seen: &Seen<L>,
    yy: L,
    range: Range<usize>,
    acc: &mut [L; C],
    stage: &mut Stage<L>,
) {
    let (mut k, to) = (range.start, range.end.min(WIDEST));
    while k < to {
        let n = (to - k).min(if FOLD { STAGE / 2 } else { STAGE });
        let group = lobes.group;
        let (x, y, z) =
            (&group[row::AXIS_X][k..k + n], &group[row::AXIS_Y][k..k + n], &group[row::AXIS_Z][k..k + n]);
        let (rate, fold_rate) = (&group[row::RATE][k..k + n], &group[row::FOLD_RATE][k..k + n]);
        for j in 0..n {
            stage[j] = exponent::<L, F, PLANE>([x[j], y[j], z[j]], rate[j], seen, yy);
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
        // Two channels at a time, and the last by itself: the sums of two stay in registers. Both loops as one
        // function of one or two channels are compiled to 1.07 of the time.
        for i in (0..C).step_by(2) {
            let amplitude = &lobes.amplitudes[i][k..k + n];
            if i + 1 < C {
                let (other, mut sum) = (&lobes.amplitudes[i + 1][k..k + n], [acc[i], acc[i + 1]]);
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

/// The exponent of a lobe, to base 2; `yy` is the square of y after the squeeze.
#[inline(always)]
fn exponent<L: Lanes, F: Form, const PLANE: bool>(axis: [f32; 3], rate: f32, seen: &Seen<L>, yy: L) -> L {
    let (dx, dz) = (F::apart(axis[0], seen, 0), F::apart(axis[2], seen, 2));
    let yy = if PLANE {
        yy
    } else {
        let dy = F::apart(axis[1], seen, 1);
        dy * dy
    };
    F::rate(rate, seen) * dx.mul_add(dx, dz.mul_add(dz, yy))
}

/// The exponent of the fold of a lobe: `|d - mirrored axis|^2 = |d - axis|^2 + 4 d.z axis.z`, both terms of
/// one sign.
#[inline(always)]
fn fold_exponent<L: Lanes>(fold_rate: f32, seen: &Seen<L>, exponent: L) -> L {
    L::splat(fold_rate).mul_add(seen.height, exponent)
}
