//! One direction: lanes are lobes, for renderers that shade a point at a time.
#![allow(clippy::needless_range_loop)] // see lanes: kernels loop over array indices

use crate::batch::sample_direction;
use crate::lanes::{Lanes, exp2, splat3};
use crate::simd::Routine;
use crate::squeeze::Seen;
use crate::{Domain, Mixture};
use core::f32::consts::FRAC_1_PI;
use glam::Vec3;

pub(crate) struct EvaluateOne<'a, const N: usize> {
    pub mixture: &'a Mixture<N>,
    pub direction: Vec3,
}

impl<const N: usize> Routine for EvaluateOne<'_, N> {
    type Output = Vec3;
    #[inline(always)]
    fn run<L: Lanes>(self) -> Vec3 {
        let m = self.mixture;
        Vec3::from_array(sums_one::<L, N, 3>(
            m,
            [&m.red, &m.green, &m.blue],
            m.diffuse.to_array(),
            self.direction,
        ))
    }
}

pub(crate) struct PdfOne<'a, const N: usize> {
    pub mixture: &'a Mixture<N>,
    pub direction: Vec3,
}

impl<const N: usize> Routine for PdfOne<'_, N> {
    type Output = f32;
    #[inline(always)]
    fn run<L: Lanes>(self) -> f32 {
        let m = self.mixture;
        let [sum] = sums_one::<L, N, 1>(m, [&m.luminance], [m.power - m.lobes_power], self.direction);
        sum * m.inverse_power
    }
}

pub(crate) struct SampleOne<'a, const N: usize> {
    pub mixture: &'a Mixture<N>,
    pub u: [f32; 3],
}

impl<const N: usize> Routine for SampleOne<'_, N> {
    /// Direction and value.
    type Output = (Vec3, Vec3);
    #[inline(always)]
    fn run<L: Lanes>(self) -> (Vec3, Vec3) {
        let m = self.mixture;
        let direction = Vec3::from_array(sample_direction::<f32, N>(m, self.u));
        let value = sums_one::<L, N, 3>(m, [&m.red, &m.green, &m.blue], m.diffuse.to_array(), direction);
        (direction, Vec3::from_array(value))
    }
}

/// Sums the lobes towards one direction, once for each of `C` sets of amplitudes.
#[inline(always)]
pub(crate) fn sums_one<L: Lanes, const N: usize, const C: usize>(
    m: &Mixture<N>,
    amplitudes: [&[f32; N]; C],
    diffuse: [f32; C],
    direction: Vec3,
) -> [f32; C] {
    // False for a NaN too.
    let above = direction.z >= 0.0;
    if !above && m.domain == Domain::Hemisphere {
        return [0.0; C];
    }
    let turned = m.squeeze.turn(splat3::<L>(direction.to_array()));
    let squeezed = if m.squeezed > 0 { m.squeeze.squeeze(&turned) } else { turned };

    let mut acc = [L::splat(0.0); C];
    let mut k = 0;
    while k < m.count && k + L::COUNT <= N {
        let seen = if k + L::COUNT <= m.squeezed {
            squeezed
        } else if k >= m.squeezed {
            turned
        } else {
            mix::<L>(&squeezed, &turned, m.squeezed - k)
        };
        let [x, y, z] = seen.high;
        let dx = (x - L::load(&m.axis_x[k..])) + seen.low[0];
        let dy = (y - L::load(&m.axis_y[k..])) + seen.low[1];
        let dz = (z - L::load(&m.axis_z[k..])) + seen.low[2];
        let t = L::load(&m.rate[k..]) * dx.mul_add(dx, dy.mul_add(dy, dz * dz));
        let mut g = exp2(t);
        if m.folded >> k & lane_bits(L::COUNT) != 0 {
            // Lanes whose fold cannot matter get it too: it is smaller than its bound there.
            g = g + exp2(L::load(&m.fold_rate[k..]).mul_add(z, t));
        }
        let g = g * seen.scale;
        for i in 0..C {
            acc[i] = g.mul_add(L::load(&amplitudes[i][k..]), acc[i]);
        }
        k += L::COUNT;
    }
    let mut sums = [0.0; C];
    for i in 0..C {
        sums[i] = acc[i].sum();
        if m.domain == Domain::Hemisphere {
            sums[i] += diffuse[i] * FRAC_1_PI * direction.z;
        }
    }
    sums
}

/// The lowest `count` bits.
#[inline(always)]
const fn lane_bits(count: usize) -> u64 {
    (1 << count) - 1
}

/// What the first `count` lanes see from `first`, the others from `then`.
#[inline(always)]
fn mix<L: Lanes>(first: &Seen<L>, then: &Seen<L>, count: usize) -> Seen<L> {
    let is_first = L::iota().lt(L::splat(count as f32));
    let mut seen = *then;
    for i in 0..3 {
        seen.high[i] = L::select(is_first, first.high[i], then.high[i]);
        seen.low[i] = L::select(is_first, first.low[i], then.low[i]);
    }
    seen.scale = L::select(is_first, first.scale, then.scale);
    seen
}
