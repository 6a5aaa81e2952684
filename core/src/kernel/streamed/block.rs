//! The lobes of a block of hits, each with a material and an outgoing direction of its own, from the rows of the files.
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use super::super::between_views::{Place, head_at, head_numbers, views_passed};
use super::super::block::{Hits, Room};
use super::super::outgoing::Facing;
use super::lobes::{fill_first, fill_second};
use crate::color::{LUMINANCE, rgb};
use crate::material::borrowed::MaterialRef;
use crate::mixture::row::Group;
use crate::simd::elementary::exp2;
use crate::simd::lanes::{Lanes, Numbers, WIDEST, dot3, splat3};
use crate::simd::routine::Routine;

/// Fills the lobes and the numbers of at most [`WIDEST`] hits, whose outgoing directions the room has.
pub(super) struct Fill<'a, 'm> {
    pub materials: &'a [MaterialRef<'m>; WIDEST],
    pub count: usize,
    pub room: &'a mut Room,
    /// As many for each hit as it has at most.
    pub groups: &'a mut [Group],
    pub groups_of_hit: usize,
}

impl Routine for Fill<'_, '_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { materials, count, room, groups, groups_of_hit } = self;
        let Room { wo, hits, .. } = room;
        hits.count = count.min(WIDEST);
        hits.in_plane = true;
        let (place, diffuse_power) = heads::<L>(materials, wo, hits);
        for (i, material) in materials.iter().enumerate().take(hits.count) {
            let header = material.header;
            hits.in_plane &= header.mirrored == 0;
            (hits.lobes[i], hits.squeezed[i]) = (header.lobe_count(), header.squeezed);
        }
        if L::FUSED && groups_of_hit == 1 {
            lobes::<L::Lobes, true>(materials, &place, hits, groups, 1);
        } else {
            lobes::<L::Lobes, false>(materials, &place, hits, groups, groups_of_hit);
        }
        hits.set_power::<L>(&diffuse_power);
    }
}

/// The lobes of all hits, and their powers.
#[inline(always)]
fn lobes<L: Lanes, const FEW: bool>(
    materials: &[MaterialRef<'_>; WIDEST],
    place: &[Place; WIDEST],
    hits: &mut Hits,
    groups: &mut [Group],
    groups_of_hit: usize,
) {
    let mut room = None;
    for (i, groups) in groups.chunks_exact_mut(groups_of_hit).enumerate().take(hits.count) {
        fill_first::<L, FEW>(materials[i], place[i], groups, &mut room);
    }
    for (i, groups) in groups.chunks_exact_mut(groups_of_hit).enumerate().take(hits.count) {
        hits.lobes_power[i] = fill_second::<L, FEW>(hits.lobes[i], groups);
    }
}

/// The numbers that hits have once, but for those of their lobes; their places among the views, and the power of the diffuse terms.
#[inline(always)]
fn heads<L: Lanes>(
    materials: &[MaterialRef<'_>; WIDEST],
    wo: &[Numbers; 3],
    hits: &mut Hits,
) -> ([Place; WIDEST], Numbers) {
    let zeros = [0.0; WIDEST];
    let (mut place, mut diffuse_power) = ([Place::NOWHERE; WIDEST], zeros);
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let mut theta = zeros;
    let mut at = 0;
    while at + L::COUNT <= WIDEST {
        let facing = Facing::<L>::new([L::load(&wo[0][at..]), L::load(&wo[1][at..]), L::load(&wo[2][at..])]);
        facing.theta.store(&mut theta[at..]);
        facing.azimuth[0].store(&mut hits.azimuth[0][at..]);
        facing.azimuth[1].store(&mut hits.azimuth[1][at..]);
        L::select(facing.is_there(), one, zero).store(&mut hits.is_there[at..]);
        at += L::COUNT;
    }
    hits.set_excess();
    let mut numbers = [zeros; 4];
    for i in 0..hits.count {
        // A vector that is no direction has no angle: any does, as nothing of it is seen.
        let theta = if hits.is_there[i] > 0.0 { theta[i] } else { 0.0 };
        let passed = views_passed::<L>(materials[i], theta);
        place[i] = Place::after(materials[i], passed, theta);
        place[i].prefetch(materials[i]);
        let of = head_numbers::<L::One>(materials[i], place[i]);
        for n in 0..4 {
            numbers[n][i] = of[n];
        }
    }
    let mut at = 0;
    while at + L::COUNT <= WIDEST {
        let squeeze = exp2(L::load(&numbers[0][at..]));
        squeeze.store(&mut hits.widen[1][at..]);
        (one / squeeze).store(&mut hits.stretch[1][at..]);
        let differences = [L::load(&numbers[2][at..]), L::load(&numbers[3][at..])];
        let color = rgb(exp2(L::load(&numbers[1][at..])), differences);
        for channel in 0..3 {
            color[channel].store(&mut hits.diffuse[channel][at..]);
        }
        at += L::COUNT;
    }
    for i in 0..hits.count {
        // Red, green and blue are logarithms in files of version 1.
        if !materials[i].header.has_luminance {
            let (_, diffuse) = head_at::<L>(materials[i], place[i]);
            for channel in 0..3 {
                hits.diffuse[channel][i] = diffuse[channel];
            }
        }
    }
    let mut at = 0;
    while at + L::COUNT <= WIDEST {
        let mut color = [zero; 3];
        for channel in 0..3 {
            color[channel] = L::load(&hits.diffuse[channel][at..]);
        }
        dot3(color, splat3(LUMINANCE)).store(&mut diffuse_power[at..]);
        at += L::COUNT;
    }
    (place, diffuse_power)
}
