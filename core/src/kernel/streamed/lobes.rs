//! The lobes of a material for one outgoing direction, from the rows of its file into groups of sixteen: lanes
//! are lobes. Sharpness and luminance are left out, which neither sums nor draws need; for one hit the rates of folds too, which
//! follow from others.

use super::super::between_views::{Decoded, Lobes, NOT_DECODED, Place, room_for, rows_at};
use super::super::one_lobe;
use crate::material::borrowed::MaterialRef;
use crate::mixture::complete::LEAST_SHARPNESS;
use crate::mixture::row::{self, Group};
use crate::simd::elementary::exp2_and_rest;
use crate::simd::lanes::{Lanes, splat3};
use core::f32::consts::{LOG2_E, PI};

/// Interpolates the lobes round a place into groups, or into one, which is `FEW`; returns their power.
#[inline(always)]
pub(super) fn fill<L: Lanes, const FEW: bool>(
    material: MaterialRef<'_>,
    place: Place,
    groups: &mut [Group],
) -> f32 {
    let mut passed = L::splat(0.0);
    if L::COUNT == 1 {
        let from = one_lobe::OneRows::new(material, place.between_views());
        row::for_lobes!(false, L, groups, material.header.lobe_count(), |group, at, k| {
            let is_image = k >= material.header.lobes;
            let mut lobe =
                one_lobe::lobe::<true>(&from, if is_image { k - material.header.mirrored } else { k });
            if is_image {
                lobe.axis[1] = 0.0 - lobe.axis[1];
            }
            let (sharpness, luminance) = (L::splat(lobe.sharpness), L::splat(lobe.luminance));
            let lobes = Lobes { axis: splat3(lobe.axis), sharpness, rgb: splat3(lobe.rgb), luminance };
            store_shape(&lobes, group, at);
            passed = store_powers(sharpness, luminance, passed, group, at);
        });
        return passed.first();
    }
    let (copy_a, copy_b);
    let (mut room, mut little) = (None, None);
    let rows = rows_at!(L, material, place, copy_a, copy_b, room_for!(FEW, little, room));
    row::for_lobes!(FEW, L, groups, rows.total(), |group, at, k| {
        let lobes = rows.lobes::<L, true>(k);
        store_shape(&lobes, group, at);
        passed = store_powers(lobes.sharpness, lobes.luminance, passed, group, at);
    });
    passed.first()
}

/// The first stage of [`fill`] for blocks: all but what powers need a chain of operations for. `room`: for codes, if there are any.
#[inline(always)]
pub(super) fn fill_first<L: Lanes, const FEW: bool>(
    material: MaterialRef<'_>,
    place: Place,
    groups: &mut [Group],
    room: &mut Option<Decoded>,
) {
    let (copy_a, copy_b);
    let rows = rows_at!(L, material, place, copy_a, copy_b, {
        room.get_or_insert(NOT_DECODED).each_mut().map(|numbers| &mut numbers[..])
    });
    row::for_lobes!(FEW, L, groups, rows.total(), |group, at, k| {
        store_first(&rows.lobes::<L, false>(k), group, at);
    });
}

/// Stores the numbers of the first stage.
#[inline(always)]
pub(in super::super) fn store_first<L: Lanes>(lobes: &Lobes<L>, to: &mut Group, at: usize) {
    let fold_rate = store_shape(lobes, to, at);
    fold_rate.store(&mut to[row::FOLD_RATE][at..]);
    lobes.sharpness.store(&mut to[row::INVERSE_SHARPNESS][at..]);
    lobes.luminance.store(&mut to[row::CUMULATIVE][at..]);
}

/// The second stage; returns the power of the lobes.
#[inline(always)]
pub(super) fn fill_second<L: Lanes, const FEW: bool>(count: usize, groups: &mut [Group]) -> f32 {
    let mut passed = L::splat(0.0);
    row::for_lobes!(FEW, L, groups, count, |group, at, _k| {
        let sharpness = L::load(&group[row::INVERSE_SHARPNESS][at..]);
        let luminance = L::load(&group[row::CUMULATIVE][at..]);
        passed = store_powers(sharpness, luminance, passed, group, at);
    });
    passed.first()
}

/// Stores axes, rates and amplitudes; returns the rates of the folds.
#[inline(always)]
#[allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices
fn store_shape<L: Lanes>(lobes: &Lobes<L>, to: &mut Group, at: usize) -> L {
    let [x, y, z] = lobes.axis;
    let (z, rate) = (z.abs(), lobes.sharpness * L::splat(-0.5 * LOG2_E));
    x.store(&mut to[row::AXIS_X][at..]);
    y.store(&mut to[row::AXIS_Y][at..]);
    z.store(&mut to[row::AXIS_Z][at..]);
    rate.store(&mut to[row::RATE][at..]);
    for channel in 0..3 {
        lobes.rgb[channel].store(&mut to[row::RED + channel][at..]);
    }
    fold_rate(rate, z)
}

/// The rate of a fold: times d.z it is added to the exponent.
#[inline(always)]
pub(super) fn fold_rate<L: Lanes>(rate: L, axis_z: L) -> L {
    rate * L::splat(4.0) * axis_z
}

/// Stores what drawing needs, and the running sum of powers beyond what `passed` has in every lane; returns its last
/// in every lane.
#[inline(always)]
fn store_powers<L: Lanes>(sharpness: L, luminance: L, passed: L, to: &mut Group, at: usize) -> L {
    let s = sharpness.max(L::splat(LEAST_SHARPNESS));
    let [tail, inside] = exp2_and_rest(s * L::splat(-2.0 * LOG2_E));
    let inverse = L::splat(1.0) / s;
    let power = luminance * (inverse * inside * L::splat(2.0 * PI));
    let running = power.running_sum() + passed;
    inverse.store(&mut to[row::INVERSE_SHARPNESS][at..]);
    inside.store(&mut to[row::INSIDE][at..]);
    tail.store(&mut to[row::TAIL][at..]);
    running.store(&mut to[row::CUMULATIVE][at..]);
    // Lanes behind the last lobe add nothing.
    running.last()
}
