//! The lobes of an isotropic material for one outgoing direction, as they are kept while they are summed and drawn
//! from: lanes are lobes.
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use super::super::between_views::{Lobes, Place, rows_at};
use super::super::draw::Choice;
use super::super::one_lobe;
use super::super::sights::folded_falloff;
#[cfg(feature = "simd")]
use super::super::sights::{Sights, seen};
use crate::material::borrowed::MaterialRef;
use crate::mixture::complete::LEAST_SHARPNESS;
use crate::simd::elementary::exp2_and_rest;
use crate::simd::lanes::{Lanes, Numbers, WIDEST, splat3};
use crate::squeeze::{Seen, Sight};
use core::f32::consts::{LOG2_E, PI};

/// Rows of numbers of sixteen lobes: axis, rate, amplitudes.
pub(super) const KEPT: usize = 11;
const RATE: usize = 3;
const AMPLITUDE: usize = 4;
/// `1 / s`, `1 - exp(-2 s)` and `exp(-2 s)`.
const INVERSE: usize = 7;
const INSIDE: usize = 8;
const GONE: usize = 9;
/// Running sum of the powers.
const RUNNING: usize = 10;

/// The lobes of one outgoing direction, in groups of sixteen.
pub(super) type Kept<const G: usize> = [[Numbers; KEPT]; G];

/// No lobes.
pub(super) const NOTHING: [Numbers; KEPT] = [[0.0; WIDEST]; KEPT];

/// Lobes of a mixture that a group count allows.
#[inline(always)]
fn is_within<const G: usize>(k: usize, count: usize) -> bool {
    k < count && k < WIDEST * G
}

/// Interpolates the lobes round a place and keeps them; returns their power. `MIRRORED`: some are.
#[inline(always)]
pub(super) fn keep<L: Lanes, const G: usize, const MIRRORED: bool>(
    material: MaterialRef<'_>,
    place: Place,
    kept: &mut Kept<G>,
) -> f32 {
    let mut passed = L::splat(0.0);
    if L::COUNT == 1 {
        let from = one_lobe::OneRows::new(material, place.between_views());
        let mut k = 0;
        while is_within::<G>(k, material.header.lobe_count()) {
            let is_image = k >= material.header.lobes;
            let mut lobe =
                one_lobe::lobe::<true>(&from, if is_image { k - material.header.mirrored } else { k });
            if is_image {
                lobe.axis[1] = 0.0 - lobe.axis[1];
            }
            let (sharpness, luminance) = (L::splat(lobe.sharpness), L::splat(lobe.luminance));
            let lobes = Lobes { axis: splat3(lobe.axis), sharpness, rgb: splat3(lobe.rgb), luminance };
            let (to, j) = (&mut kept[k / WIDEST], k % WIDEST);
            keep_shape(&lobes, to, j);
            passed = keep_powers(sharpness, luminance, passed, to, j);
            k += 1;
        }
        return passed.first();
    }
    let (copy_a, copy_b);
    let rows = rows_at!(L, MIRRORED, material, place, copy_a, copy_b);
    let mut k = 0;
    while is_within::<G>(k, rows.total()) {
        let lobes = rows.lobes::<L, MIRRORED, true>(k);
        let (to, j) = (&mut kept[k / WIDEST], k % WIDEST);
        keep_shape(&lobes, to, j);
        passed = keep_powers(lobes.sharpness, lobes.luminance, passed, to, j);
        k += L::COUNT;
    }
    passed.first()
}

/// The first stage of [`keep`] for blocks: all but what powers need a chain of operations for.
#[cfg(feature = "simd")]
#[inline(always)]
pub(super) fn keep_first<L: Lanes, const G: usize, const MIRRORED: bool>(
    material: MaterialRef<'_>,
    place: Place,
    kept: &mut Kept<G>,
) {
    let (copy_a, copy_b);
    let rows = rows_at!(L, MIRRORED, material, place, copy_a, copy_b);
    let mut k = 0;
    while is_within::<G>(k, rows.total()) {
        let lobes = rows.lobes::<L, MIRRORED, false>(k);
        let (to, j) = (&mut kept[k / WIDEST], k % WIDEST);
        keep_shape(&lobes, to, j);
        lobes.sharpness.store(&mut to[INVERSE][j..]);
        lobes.luminance.store(&mut to[RUNNING][j..]);
        k += L::COUNT;
    }
}

/// The second stage; returns the power of the lobes.
#[cfg(feature = "simd")]
#[inline(always)]
pub(super) fn keep_second<L: Lanes, const G: usize>(count: usize, kept: &mut Kept<G>) -> f32 {
    let mut passed = L::splat(0.0);
    let mut k = 0;
    while is_within::<G>(k, count) {
        let (to, j) = (&mut kept[k / WIDEST], k % WIDEST);
        let (sharpness, luminance) = (L::load(&to[INVERSE][j..]), L::load(&to[RUNNING][j..]));
        passed = keep_powers(sharpness, luminance, passed, to, j);
        k += L::COUNT;
    }
    passed.first()
}

/// Keeps axes, rates and amplitudes.
#[inline(always)]
fn keep_shape<L: Lanes>(lobes: &Lobes<L>, to: &mut [Numbers; KEPT], j: usize) {
    let [x, y, z] = lobes.axis;
    x.store(&mut to[0][j..]);
    y.store(&mut to[1][j..]);
    z.abs().store(&mut to[2][j..]);
    (lobes.sharpness * L::splat(-0.5 * LOG2_E)).store(&mut to[RATE][j..]);
    for channel in 0..3 {
        lobes.rgb[channel].store(&mut to[AMPLITUDE + channel][j..]);
    }
}

/// Keeps what drawing needs, and the running sum of powers beyond what `passed` has in every lane; returns its last
/// in every lane.
#[inline(always)]
fn keep_powers<L: Lanes>(sharpness: L, luminance: L, passed: L, to: &mut [Numbers; KEPT], j: usize) -> L {
    let s = sharpness.max(L::splat(LEAST_SHARPNESS));
    let [tail, inside] = exp2_and_rest(s * L::splat(-2.0 * LOG2_E));
    let inverse = L::splat(1.0) / s;
    let power = luminance * (inverse * inside * L::splat(2.0 * PI));
    let running = power.running_sum() + passed;
    inverse.store(&mut to[INVERSE][j..]);
    inside.store(&mut to[INSIDE][j..]);
    tail.store(&mut to[GONE][j..]);
    running.store(&mut to[RUNNING][j..]);
    // Lanes behind the last lobe add nothing.
    running.last()
}

/// The lobe at a place on the running sum of powers; the last one ends the search whatever the sum is rounded to.
#[inline(always)]
pub(super) fn chosen_lobe<L: Lanes, const G: usize>(kept: &Kept<G>, count: usize, target: f32) -> usize {
    let mut above = 1u64.wrapping_shl((count as u32).wrapping_sub(1));
    let mut k = 0;
    while is_within::<G>(k, count) {
        above |= L::bits(L::splat(target).lt(L::load(&kept[k / WIDEST][RUNNING][k % WIDEST..]))) << k;
        k += L::COUNT;
    }
    (above.trailing_zeros() as usize).min(WIDEST * G - 1)
}

/// What drawing needs of lobe `k`: axis, `1 - exp(-2 s)`, `exp(-2 s)`, `1 / s`.
#[inline(always)]
pub(super) fn numbers_of<const G: usize>(kept: &Kept<G>, k: usize) -> [f32; 6] {
    let (group, j) = (&kept[(k / WIDEST).min(G - 1)], k % WIDEST);
    [group[0][j], group[1][j], group[2][j], group[INSIDE][j], group[GONE][j], group[INVERSE][j]]
}

/// A choice of such numbers.
#[inline(always)]
pub(super) fn choice<L: Lanes>(numbers: [L; 6], is_squeezed: L::Mask, is_lobe: L::Mask) -> Choice<L> {
    let [x, y, z, inside, gone, inverse_sharpness] = numbers;
    Choice { axis: [x, y, z], inside, gone, inverse_sharpness, is_squeezed, is_lobe }
}

/// Sums the lobes in red, green and blue towards a direction, as round and as squeezed ones see it.
#[inline(always)]
pub(super) fn sums<L: Lanes, const G: usize>(
    kept: &Kept<G>,
    count: usize,
    squeezed_count: usize,
    [turned, squeezed]: &[Sight; 2],
) -> [L; 3] {
    let mut acc = [L::splat(0.0); 3];
    let mut k = 0;
    while is_within::<G>(k, count) {
        let mask = L::first_lanes(squeezed_count.saturating_sub(k).min(L::COUNT));
        let seen = Sight::splat_either::<L>(mask, squeezed, turned);
        add::<L, true>(&kept[k / WIDEST], k % WIDEST, &seen, &mut acc);
        k += L::COUNT;
    }
    acc
}

/// The same for pair `i` of a block.
#[cfg(feature = "simd")]
#[inline(always)]
pub(super) fn sums_of_block<L: Lanes, const G: usize>(
    kept: &Kept<G>,
    count: usize,
    squeezed_count: usize,
    sights: &Sights,
    i: usize,
) -> [L; 3] {
    let mut acc = [L::splat(0.0); 3];
    let mut k = 0;
    while is_within::<G>(k, count) {
        let mask = L::first_lanes(squeezed_count.saturating_sub(k).min(L::COUNT));
        add::<L, false>(&kept[k / WIDEST], k % WIDEST, &seen(sights, i, mask), &mut acc);
        k += L::COUNT;
    }
    acc
}

/// Adds the lobes from the `j`-th on of a group. `SOON`: by a shorter chain of more operations.
#[inline(always)]
fn add<L: Lanes, const SOON: bool>(of: &[Numbers; KEPT], j: usize, seen: &Seen<L>, acc: &mut [L; 3]) {
    let axis = [L::load(&of[0][j..]), L::load(&of[1][j..]), L::load(&of[2][j..])];
    let g = folded_falloff::<L, SOON>(axis, L::load(&of[RATE][j..]), seen);
    for channel in 0..3 {
        acc[channel] = g.mul_add(L::load(&of[AMPLITUDE + channel][j..]), acc[channel]);
    }
}
