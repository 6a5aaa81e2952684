//! The lobes of a block of hits, each with an outgoing direction of its own, from the rows of an expanded material.
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use super::super::block::Room;
use super::super::outgoing::Facing;
use super::between_rows::{blend, store_lobes};
use super::table::{DIFFUSE, DIFFUSE_POWER, Expanded, HIT_HEAD, INVERSE_SQUEEZE, LOBES_POWER, whole};
use crate::mixture::row::Group;
use crate::simd::lanes::{Lanes, WIDEST};
use crate::simd::routine::Routine;

/// Fills the lobes and the numbers of at most [`WIDEST`] hits, whose outgoing directions the room has.
pub(super) struct Fill<'a> {
    pub expanded: &'a Expanded<'a>,
    pub count: usize,
    pub room: &'a mut Room,
    /// As many for each hit as it has.
    pub groups: &'a mut [Group],
}

impl Routine for Fill<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { expanded, count, room: Room { wo, hits, .. }, groups } = self;
        let zeros = [0.0; WIDEST];
        let (mut place, mut share) = (zeros, zeros);
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let mut at = 0;
        while at + L::COUNT <= WIDEST {
            let wo = [L::load(&wo[0][at..]), L::load(&wo[1][at..]), L::load(&wo[2][at..])];
            let facing = Facing::<L>::new(wo);
            let [before, beyond] = expanded.places(facing.theta);
            before.store(&mut place[at..]);
            beyond.store(&mut share[at..]);
            facing.azimuth[0].store(&mut hits.azimuth[0][at..]);
            facing.azimuth[1].store(&mut hits.azimuth[1][at..]);
            L::select(facing.is_there(), one, zero).store(&mut hits.is_there[at..]);
            at += L::COUNT;
        }
        hits.set_excess();
        let header = expanded.material.borrowed().header;
        hits.count = count.min(WIDEST);
        hits.lobes = [header.lobe_count(); WIDEST];
        hits.squeezed = [header.squeezed; WIDEST];
        hits.in_plane = header.mirrored == 0;
        hits.any_squeezed = header.squeezed > 0;
        hits.any_diffuse = expanded.any_diffuse;
        let mut numbers = [zeros; HIT_HEAD];
        numbers[INVERSE_SQUEEZE] = [1.0; WIDEST];
        for (i, groups) in groups.chunks_exact_mut(expanded.groups()).enumerate().take(hits.count) {
            let rows = expanded.two_rows(whole(place[i]));
            for n in 0..HIT_HEAD {
                let [a, b] = rows.map(|row| L::One::splat(row[0][n]));
                numbers[n][i] = blend(a, b, L::One::splat(share[i])).first();
            }
            store_lobes::<L::Lobes>(expanded, rows, share[i], groups);
        }
        for i in 0..WIDEST {
            hits.widen[1][i] = 1.0 / numbers[INVERSE_SQUEEZE][i];
        }
        hits.stretch[1] = numbers[INVERSE_SQUEEZE];
        hits.diffuse.copy_from_slice(&numbers[DIFFUSE..DIFFUSE + 3]);
        hits.lobes_power = numbers[LOBES_POWER];
        hits.set_power::<L>(&numbers[DIFFUSE_POWER]);
    }
}
