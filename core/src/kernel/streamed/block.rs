//! The lobes of a block of hits, each with a material and an outgoing direction of its own, from the rows of the files.
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use super::super::among_rings::{FillRings, Frame};
use super::super::between_views::{Place, head_at, head_numbers, views_passed};
use super::super::block::{Hits, Room};
use super::super::outgoing::Facing;
use super::lobes::{fill_first, fill_second};
use crate::color::{LUMINANCE, rgb};
use crate::material::borrowed::MaterialRef;
use crate::mixture::row::Group;
use crate::simd::detect::Level;
use crate::simd::elementary::exp2;
use crate::simd::lanes::{Lanes, Numbers, WIDEST, dot3, splat3};
use crate::simd::routine::Routine;

/// Fills the lobes and the numbers of at most [`WIDEST`] hits, whose outgoing directions the room has; as many groups for each hit as it has
/// at most.
pub(crate) fn fill(
    level: Level,
    materials: &[MaterialRef<'_>; WIDEST],
    count: usize,
    room: &mut Room,
    groups: &mut [Group],
    groups_of_hit: usize,
) {
    let count = count.min(WIDEST);
    let is_line = |material: &MaterialRef<'_>| material.header.is_isotropic();
    let (mut any, mut all) = (false, true);
    for material in &materials[..count] {
        (any, all) = (any | is_line(material), all & is_line(material));
    }
    room.hits.count = count;
    if any {
        level.run_vectors(Fill { materials, room, groups, groups_of_hit });
    }
    if !all {
        fill_turned(level, &materials[..count], room, groups, groups_of_hit);
    }
    level.run_vectors(Powers { room, groups, groups_of_hit });
}

/// The part of [`fill`] for hits on anisotropic materials.
#[inline(never)]
fn fill_turned(
    level: Level,
    materials: &[MaterialRef<'_>],
    Room { wo, hits, .. }: &mut Room,
    groups: &mut [Group],
    groups_of_hit: usize,
) {
    let mut frames = [Frame::NONE; WIDEST];
    let frames = &mut frames[..materials.len()];
    let groups = &mut groups.chunks_exact_mut(groups_of_hit);
    let wo = wo.each_ref().map(|numbers| &numbers[..]);
    level.run_vectors(FillRings { materials, wo, frames, groups });
    hits.in_plane = false;
    for (i, (material, frame)) in materials.iter().zip(frames).enumerate() {
        if material.header.is_isotropic() {
            continue;
        }
        (hits.lobes[i], hits.squeezed[i]) = (material.header.lobes, material.header.squeezed);
        for n in 0..2 {
            hits.azimuth[n][i] = frame.azimuth[n];
            hits.stretch[n][i] = frame.stretch[n];
            hits.widen[n][i] = 1.0 / frame.stretch[n];
        }
        for channel in 0..3 {
            hits.diffuse[channel][i] = frame.diffuse[channel];
        }
        hits.is_there[i] = if frame.is_there { 1.0 } else { 0.0 };
    }
    hits.set_excess();
}

/// Fills the lobes and the numbers of hits on isotropic materials, but for their powers.
struct Fill<'a, 'm> {
    materials: &'a [MaterialRef<'m>; WIDEST],
    room: &'a mut Room,
    groups: &'a mut [Group],
    groups_of_hit: usize,
}

impl Routine for Fill<'_, '_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { materials, room, groups, groups_of_hit } = self;
        let Room { wo, hits, .. } = room;
        hits.in_plane = true;
        // Anisotropic materials of another block may have set them.
        (hits.stretch[0], hits.widen[0]) = ([1.0; WIDEST], [1.0; WIDEST]);
        let place = heads::<L>(materials, wo, hits);
        for (i, material) in materials.iter().enumerate().take(hits.count) {
            let header = material.header;
            hits.in_plane &= header.mirrored == 0;
            (hits.lobes[i], hits.squeezed[i]) = (header.lobe_count(), header.squeezed);
        }
        let each = groups.chunks_exact_mut(groups_of_hit).enumerate().take(hits.count);
        if L::FUSED && groups_of_hit == 1 {
            fill_each::<L::Lobes, true>(materials, &place, each);
        } else {
            fill_each::<L::Lobes, false>(materials, &place, each);
        }
    }
}

/// The first stage of the lobes of all hits.
#[inline(always)]
fn fill_each<'g, L: Lanes, const FEW: bool>(
    materials: &[MaterialRef<'_>; WIDEST],
    place: &[Place; WIDEST],
    groups: impl Iterator<Item = (usize, &'g mut [Group])>,
) {
    let mut room = None;
    for (i, groups) in groups {
        if materials[i].header.is_isotropic() {
            fill_first::<L, FEW>(materials[i], place[i], groups, &mut room);
        }
    }
}

/// The powers of all hits, whose lobes have been filled but for these.
struct Powers<'a> {
    room: &'a mut Room,
    groups: &'a mut [Group],
    groups_of_hit: usize,
}

impl Routine for Powers<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { room: Room { hits, .. }, groups, groups_of_hit } = self;
        let each = groups.chunks_exact_mut(groups_of_hit).enumerate().take(hits.count);
        if L::FUSED && groups_of_hit == 1 {
            for (i, groups) in each {
                hits.lobes_power[i] = fill_second::<L::Lobes, true>(hits.lobes[i], groups);
            }
        } else {
            for (i, groups) in each {
                hits.lobes_power[i] = fill_second::<L::Lobes, false>(hits.lobes[i], groups);
            }
        }
        let (mut diffuse_power, mut at) = ([0.0; WIDEST], 0);
        while at + L::COUNT <= WIDEST {
            let mut color = [L::splat(0.0); 3];
            for channel in 0..3 {
                color[channel] = L::load(&hits.diffuse[channel][at..]);
            }
            dot3(color, splat3(LUMINANCE)).store(&mut diffuse_power[at..]);
            at += L::COUNT;
        }
        hits.set_power::<L>(&diffuse_power);
    }
}

/// The numbers that hits have once, but for those of their lobes; their places among the views.
#[inline(always)]
fn heads<L: Lanes>(
    materials: &[MaterialRef<'_>; WIDEST],
    wo: &[Numbers; 3],
    hits: &mut Hits,
) -> [Place; WIDEST] {
    let zeros = [0.0; WIDEST];
    let mut place = [Place::NOWHERE; WIDEST];
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
        if !materials[i].header.is_isotropic() {
            continue;
        }
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
        if !materials[i].header.has_luminance && materials[i].header.is_isotropic() {
            let (_, diffuse) = head_at::<L>(materials[i], place[i]);
            for channel in 0..3 {
                hits.diffuse[channel][i] = diffuse[channel];
            }
        }
    }
    place
}
