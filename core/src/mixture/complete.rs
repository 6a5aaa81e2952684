//! Completes a mixture from axes, sharpness and amplitudes: everything that evaluating and drawing want to
//! have at hand.

use super::leave_out::LeaveOut;
use super::row::{self, ROWS};
use super::rows::{AnyMixture, Domain, lowest_bits};
use crate::color::{LUMINANCE, luminance};
use crate::simd::elementary::exp2;
use crate::simd::lanes::{Lanes, WIDEST, dot3, splat3};
use core::f32::consts::{LOG2_E, PI};
use glam::Vec3;

/// A lobe that is less sharp is constant to f32.
pub(crate) const LEAST_SHARPNESS: f32 = 1e-7;

/// From this sharpness on, `1 - exp(-2 s)` is as exact as its series.
pub(crate) const LEAST_WITHOUT_SERIES: f32 = 0.25;

/// `exp(-2 s)` and `1 - exp(-2 s)`, which times `2 pi / s` is the integral of a Gaussian of that sharpness.
#[inline(always)]
#[allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices
pub(crate) fn tail_and_inside<L: Lanes>(s: L) -> [L; 2] {
    let [tail, mut inside] = tail_and_inside_of_sharp(s);
    // By its series where the difference would cancel.
    let small = s.lt(L::splat(LEAST_WITHOUT_SERIES));
    if L::bits(small) != 0 {
        let x = s + s;
        let mut series = L::splat(-1.0 / 40_320.0);
        const SERIES: [f32; 7] = [1. / 5040., -1. / 720., 1. / 120., -1. / 24., 1. / 6., -0.5, 1.];
        for i in 0..SERIES.len() {
            series = series.mul_add(x, L::splat(SERIES[i]));
        }
        inside = L::select(small, series * x, inside);
    }
    [tail, inside]
}

/// [`tail_and_inside`] of a sharpness of at least [`LEAST_WITHOUT_SERIES`].
#[inline(always)]
pub(crate) fn tail_and_inside_of_sharp<L: Lanes>(s: L) -> [L; 2] {
    let tail = exp2(s * L::splat(-2.0 * LOG2_E));
    [tail, L::splat(1.0) - tail]
}

impl AnyMixture<'_> {
    /// Completes the mixture from axes, sharpness and amplitudes, which the caller has stored and checked;
    /// those of the places up to the next multiple of the lanes must be valid, of amplitude 0. On AVX2 `L` is
    /// a pair of vectors, as it is where one direction is evaluated.
    #[inline(always)]
    pub(crate) fn finish<L: Lanes>(&mut self, count: usize, squeezed: usize, leave_out: LeaveOut) {
        self.finish_lobes::<L, false>(count, squeezed, leave_out);
        self.sum_up();
    }

    /// The part of [`finish`](Self::finish) that every lobe needs; [`sum_up`](Self::sum_up) is to follow. `FEW`: in one group.
    #[cfg_attr(not(feature = "simd"), inline(never))]
    #[cfg_attr(feature = "simd", inline(always))]
    #[allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices
    #[allow(unused_assignments)] // `place`, where there is no loop
    pub(crate) fn finish_lobes<L: Lanes, const FEW: bool>(
        &mut self,
        count: usize,
        squeezed: usize,
        leave_out: LeaveOut,
    ) {
        (self.head.count, self.head.squeezed) = (count, squeezed);
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let mut albedo = [zero; 3];
        let (mut folded, mut place) = (0, 1u64);
        let is_hemisphere = self.head.domain == Domain::Hemisphere;
        row::for_lobes!(FEW, L, &mut self.groups, count, |group, at, k| {
            let s = L::load(&group[row::SHARPNESS][at..]);
            let rate = s * L::splat(-0.5 * LOG2_E);
            rate.store(&mut group[row::RATE][at..]);

            let s = s.max(L::splat(LEAST_SHARPNESS));
            let inverse = one / s;
            let [tail, inside] = tail_and_inside(s);
            let integral = inside * inverse * L::splat(2.0 * PI);
            inverse.store(&mut group[row::INVERSE_SHARPNESS][at..]);
            tail.store(&mut group[row::TAIL][at..]);
            inside.store(&mut group[row::INSIDE][at..]);

            if is_hemisphere {
                let axis_z = L::load(&group[row::AXIS_Z][at..]).abs();
                axis_z.store(&mut group[row::AXIS_Z][at..]);
                // s (1 - t) = s z^2 / (1 + t), without cancellation.
                let zz = axis_z * axis_z;
                let t = (one - zz).max(zero).sqrt();
                let folds = (s * zz).lt((one + t) * L::splat(leave_out.fold_exponent));
                if L::COUNT > 1 {
                    folded |= L::bits(folds) << k;
                } else {
                    // Small processors shift a number of 64 bits by a variable one in ten instructions.
                    folded |= if L::bits(folds) != 0 { place } else { 0 };
                    place <<= 1;
                }
                let fold_rate = rate * axis_z * L::splat(4.0);
                let fold_rate = L::select(folds, fold_rate, L::splat(f32::NEG_INFINITY));
                fold_rate.store(&mut group[row::FOLD_RATE][at..]);
            }

            let mut rgb = [zero; 3];
            for i in 0..3 {
                rgb[i] = L::load(&group[row::RED + i][at..]);
            }
            let luminance = dot3(rgb, splat3(LUMINANCE));
            luminance.store(&mut group[row::LUMINANCE][at..]);
            // The powers first, their running sum below.
            (luminance * integral).store(&mut group[row::CUMULATIVE][at..]);
            for i in 0..3 {
                albedo[i] = rgb[i].mul_add(integral, albedo[i]);
            }
        });
        self.head.folded = folded & lowest_bits(count);
        let mut lobes_albedo = Vec3::new(albedo[0].sum(), albedo[1].sum(), albedo[2].sum());
        if leave_out.lobes > 0.0 {
            // Less what rounding may have taken from the power of a lobe: one that is all there is stays.
            let power = luminance(lobes_albedo) + self.head.diffuse_power;
            let (stays, albedo) = self.of_at_least::<L>(leave_out.lobes * (1.0 - 1e-6) * power);
            if stays != lowest_bits(count) {
                lobes_albedo = albedo;
                self.keep_lobes(stays);
            }
        }
        self.head.lobes_albedo = lobes_albedo;
    }

    /// Sums up the powers of the lobes, a chain of as many dependent additions, and of the diffuse term.
    #[inline(always)]
    pub(crate) fn sum_up(&mut self) {
        let (mut power, mut left) = (0.0, self.head.count);
        for group in &mut self.groups {
            for running in &mut group[row::CUMULATIVE][..left.min(WIDEST)] {
                power += *running;
                *running = power;
            }
            left = left.saturating_sub(WIDEST);
        }
        self.head.lobes_power = power;
        self.add_diffuse();
    }

    /// Which lobes have a power, which `cumulative` still holds one by one, of at least a bound, one bit
    /// each; and the albedo of these.
    #[inline(always)]
    #[allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices
    fn of_at_least<L: Lanes>(&self, least: f32) -> (u64, Vec3) {
        let zero = L::splat(0.0);
        let mut albedo = [zero; 3];
        let mut stays = 0;
        let mut k = 0;
        while self.has(k, self.head.count) {
            let stay = self.load::<L>(row::CUMULATIVE, k).ge(L::splat(least));
            stays |= L::bits(stay) << k;
            let integral = self.load::<L>(row::INSIDE, k) * self.load(row::INVERSE_SHARPNESS, k);
            let integral = L::select(stay, integral, zero);
            for i in 0..3 {
                albedo[i] = self.load::<L>(row::RED + i, k).mul_add(integral, albedo[i]);
            }
            k += L::COUNT;
        }
        let [red, green, blue] = albedo;
        let albedo = Vec3::new(red.sum(), green.sum(), blue.sum()) * (2.0 * PI);
        (stays & lowest_bits(self.head.count), albedo)
    }

    /// Drops all lobes but some, one bit each, which keep their order.
    #[inline(always)]
    fn keep_lobes(&mut self, stays: u64) {
        let count = self.head.count;
        let all = lowest_bits(count);
        // The lobes before the first that goes are in their places.
        let mut to = stays.trailing_ones() as usize;
        let mut left = stays & !lowest_bits(to);
        while left != 0 {
            let k = left.trailing_zeros() as usize;
            left &= left - 1;
            // Never so: the compiler sees that no place below lies outside.
            if !self.has_room(k) || !self.has_room(to) {
                break;
            }
            for row in 0..ROWS {
                *self.number_mut(row, to) = self.number(row, k);
            }
            to += 1;
        }
        for k in to..count {
            if self.has_room(k) {
                let group = &mut self.groups[k / WIDEST];
                group[row::RED][k % WIDEST] = 0.0;
                group[row::GREEN][k % WIDEST] = 0.0;
                group[row::BLUE][k % WIDEST] = 0.0;
                group[row::LUMINANCE][k % WIDEST] = 0.0;
            }
        }
        self.head.squeezed = (stays & lowest_bits(self.head.squeezed)).count_ones() as usize;
        self.head.count = to;
        // The bits of the folds move down over every one that goes, the highest first.
        let mut goes = all & !stays;
        while goes != 0 {
            let place = 63 - goes.leading_zeros();
            let below = (1 << place) - 1;
            self.head.folded = self.head.folded & below | self.head.folded >> 1 & !below;
            goes &= below;
        }
    }

    /// Sets the albedo of the diffuse term, and its power: three numbers that have just been stored would
    /// have to be read at once for that, and would not be there yet.
    #[inline(always)]
    pub(crate) fn set_diffuse(&mut self, albedo: [f32; 3]) {
        let [red, green, blue] = albedo;
        self.head.diffuse_power = luminance(Vec3::new(red, green, blue));
        self.head.diffuse = Vec3::new(red, green, blue);
    }

    /// Adds the power of the diffuse term to that of the lobes.
    #[inline(always)]
    pub(crate) fn add_diffuse(&mut self) {
        let power = self.head.lobes_power + self.head.diffuse_power;
        // A sum so small that its inverse is infinite reflects nothing.
        (self.head.power, self.head.inverse_power) =
            if power >= f32::MIN_POSITIVE { (power, 1.0 / power) } else { (0.0, 0.0) };
    }
}
