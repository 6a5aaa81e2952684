//! A block of mixtures on the hemisphere, each with a direction of its own.
//!
//! Some work is needed once a mixture: the draw from the chosen lobe, the turn and squeeze of the direction. It is done for the
//! whole block with lanes as mixtures; what every lobe needs, with lanes as lobes. So nothing waits for the long chain of
//! dependent operations that one direction is alone.
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use super::draw::{Choice, Frame, chosen_lobe, chosen_power, draw};
use super::one_direction::{all_lobes, with_diffuse};
use super::sights::{sight, sights};
use crate::mixture::row;
use crate::mixture::rows::AnyMixture;
use crate::simd::lanes::{Lanes, Numbers, WIDEST};
use crate::simd::routine::Routine;

/// Draws a direction from each of at most [`WIDEST`] mixtures. One that reflects nothing gives the normal.
pub(crate) struct DrawBlock<'a> {
    pub mixtures: &'a [&'a AnyMixture<'a>],
    pub u: &'a [Numbers; 3],
}

impl Routine for DrawBlock<'_> {
    type Output = [Numbers; 3];
    #[inline(always)]
    fn run<L: Lanes>(self) -> [Numbers; 3] {
        let Self { mixtures, u } = self;
        let zeros = [0.0; WIDEST];
        // Of lobes with axes in the plane of incidence y is 0, which a general frame handles as well.
        let (mut in_plane, mut any_squeezed, mut any_diffuse) = (true, false, false);
        let (mut axis, mut azimuth, mut narrow) = ([zeros; 3], [zeros; 2], [zeros; 2]);
        let (mut inside, mut gone, mut inverse_sharpness) = (zeros, zeros, zeros);
        let (mut squeezed, mut lobe, mut dark) = (zeros, zeros, zeros);
        for (i, m) in mixtures.iter().take(WIDEST).enumerate() {
            let target = chosen_power(m.head.power, u[0][i]);
            let k = chosen_lobe::<L>(m, target);
            axis[0][i] = m.number(row::AXIS_X, k);
            axis[1][i] = m.number(row::AXIS_Y, k);
            axis[2][i] = m.number(row::AXIS_Z, k);
            inside[i] = m.number(row::INSIDE, k);
            gone[i] = m.number(row::TAIL, k);
            inverse_sharpness[i] = m.number(row::INVERSE_SHARPNESS, k);
            azimuth[0][i] = m.head.squeeze.azimuth[0];
            azimuth[1][i] = m.head.squeeze.azimuth[1];
            narrow[0][i] = m.head.squeeze.along;
            narrow[1][i] = m.head.squeeze.inverse;
            squeezed[i] = if k < m.head.squeezed { 1.0 } else { 0.0 };
            lobe[i] = if target < m.head.lobes_power { 1.0 } else { 0.0 };
            dark[i] = if m.head.power == 0.0 { 1.0 } else { 0.0 };
            in_plane &= m.head.in_plane;
            any_squeezed |= m.head.squeezed > 0;
            any_diffuse |= m.head.lobes_power < m.head.power;
        }
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let half = L::splat(0.5);
        let mut out = [zeros; 3];
        let mut at = 0;
        while at < mixtures.len() && at + L::COUNT <= WIDEST {
            let frame = Frame {
                in_plane,
                any_squeezed,
                any_diffuse,
                is_folded: true,
                azimuth: [L::load(&azimuth[0][at..]), L::load(&azimuth[1][at..])],
                widen: [one / L::load(&narrow[0][at..]), one / L::load(&narrow[1][at..])],
            };
            let choice = Choice {
                axis: [L::load(&axis[0][at..]), L::load(&axis[1][at..]), L::load(&axis[2][at..])],
                inside: L::load(&inside[at..]),
                gone: L::load(&gone[at..]),
                inverse_sharpness: L::load(&inverse_sharpness[at..]),
                is_squeezed: L::load(&squeezed[at..]).ge(half),
                is_lobe: L::load(&lobe[at..]).ge(half),
            };
            let [x, y, z] = draw(&frame, choice, L::load(&u[1][at..]), L::load(&u[2][at..]));
            let is_dark = L::load(&dark[at..]).ge(half);
            L::select(is_dark, zero, x).store(&mut out[0][at..]);
            L::select(is_dark, zero, y).store(&mut out[1][at..]);
            L::select(is_dark, one, z).store(&mut out[2][at..]);
            at += L::COUNT;
        }
        out
    }
}

/// Evaluates each of at most [`WIDEST`] mixtures towards its direction: red, green and blue, or the luminance
/// (`C` = 1).
pub(crate) struct SumBlock<'a, const C: usize> {
    pub mixtures: &'a [&'a AnyMixture<'a>],
    pub directions: &'a [Numbers; 3],
}

impl<const C: usize> Routine for SumBlock<'_, C> {
    type Output = [Numbers; C];
    #[inline(always)]
    fn run<L: Lanes>(self) -> [Numbers; C] {
        let Self { mixtures, directions: [_, _, z] } = self;
        let zeros = [0.0; WIDEST];
        let (mut azimuth, mut excess) = ([zeros; 2], zeros);
        let (mut along, mut inverse) = ([1.0; WIDEST], [1.0; WIDEST]);
        for (i, m) in mixtures.iter().take(WIDEST).enumerate() {
            azimuth[0][i] = m.head.squeeze.azimuth[0];
            azimuth[1][i] = m.head.squeeze.azimuth[1];
            excess[i] = m.head.squeeze.excess;
            along[i] = m.head.squeeze.along;
            inverse[i] = m.head.squeeze.inverse;
        }
        let sights = sights::<L>(azimuth, excess, [along, inverse], self.directions);
        let mut out = [zeros; C];
        for (i, m) in mixtures.iter().take(WIDEST).enumerate() {
            // False for a NaN too.
            let above = z[i] >= 0.0;
            if !above || m.is_nothing() {
                continue;
            }
            let [turned, squeezed] = sight(&sights, i);
            let rows = [row::RED, row::GREEN, row::BLUE, row::LUMINANCE];
            let mut amplitudes = [rows[3]; C];
            let mut diffuse = [m.head.diffuse_power; C];
            if C == 3 {
                for channel in 0..C {
                    amplitudes[channel] = rows[channel];
                    diffuse[channel] = m.head.diffuse[channel];
                }
            }
            let sums = all_lobes::<L::Lobes, C, true>(m, amplitudes, &turned, &squeezed);
            let sums = with_diffuse(sums, diffuse, z[i]);
            for channel in 0..C {
                out[channel][i] = sums[channel];
            }
        }
        out
    }
}
