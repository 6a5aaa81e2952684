//! Many hits on blends: with vectors in blocks of sixteen, of which each part is a block of hits on materials.
//!
//! Without vectors, and where there are only a few hits, a part is a mixture, or lobes are many, one after the other.
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use super::Blend;
use super::part::{BlendPart, Of};
use crate::error::Error;
#[cfg(feature = "simd")]
use crate::kernel::answers::{in_room, multiply, weigh};
#[cfg(feature = "simd")]
use crate::kernel::block::{Hits, Room, Sums, Work};
#[cfg(feature = "simd")]
use crate::kernel::draw::choose;
use crate::kernel::request::{Request, at};
#[cfg(feature = "simd")]
use crate::kernel::slices::Block;
use crate::kernel::slices::{one_length, same_length};
#[cfg(feature = "simd")]
use crate::kernel::streamed::block::fill;
use crate::kernel::streamed::one::Asked;
use crate::kernel::streamed::pairs::ask_material;
#[cfg(feature = "simd")]
use crate::material::borrowed::MaterialRef;
#[cfg(feature = "simd")]
use crate::mixture::factors::Nodes;
#[cfg(feature = "simd")]
use crate::mixture::row::Group;
#[cfg(feature = "simd")]
use crate::mixture::rows::drawn_density;
#[cfg(feature = "simd")]
use crate::simd::detect::Level;
#[cfg(feature = "simd")]
use crate::simd::lanes::{Numbers, WIDEST};
use core::ops::Range;
#[cfg(feature = "simd")]
use glam::Vec3;

impl Blend<'_> {
    /// Draws and evaluates for n hits, each with an outgoing direction of its own: outputs that are given are wanted.
    ///
    /// The answers of [`sample`](Self::sample) and [`evaluate_and_pdf`](Self::evaluate_and_pdf), one by one, within rounding and in less
    /// time. Shapes: `wo` x, y, z, each `[n]`; every slice of the request `[n]`. Takes up to 90 kB of stack.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn ask(&self, wo: [&[f32]; 3], mut request: Request<'_>) -> Result<(), Error> {
        let n = one_length(&wo)?;
        request.check(n)?;
        match self.only() {
            Some(part @ BlendPart { of: Of::Material(material), .. }) => {
                ask_material(*material, wo, &mut request);
                part.scale_answers(wo, &mut request);
            }
            _ => ask(&|_| *self, wo, &mut request),
        }
        Ok(())
    }

    /// The same for n hits, each with a blend of its own; they need not be sorted.
    ///
    /// Shapes: `blends` `[n]`; the rest as in [`ask`](Self::ask).
    ///
    /// # Errors
    /// As [`ask`](Self::ask).
    pub fn ask_each(blends: &[Self], wo: [&[f32]; 3], mut request: Request<'_>) -> Result<(), Error> {
        let n = same_length(wo.iter().map(|s| s.len()).chain([blends.len()]))?;
        request.check(n)?;
        ask(&|i| blends[i], wo, &mut request);
        Ok(())
    }
}

/// Fewer hits than this are taken one by one.
#[cfg(feature = "simd")]
const FEW: usize = 4;

/// Groups of lobes of one hit, of all its parts, beyond which hits are taken one by one; most parts too.
#[cfg(feature = "simd")]
const MOST: usize = 4;

fn ask<'a>(get: &dyn Fn(usize) -> Blend<'a>, wo: [&[f32]; 3], request: &mut Request<'_>) {
    let n = wo[0].len();
    #[cfg(feature = "simd")]
    {
        let level = Level::current();
        if n >= FEW && level != Level::Scalar {
            in_blocks(level, get, wo, request);
            return;
        }
    }
    one_by_one(get, wo, request, 0..n);
}

fn one_by_one<'a>(
    get: &dyn Fn(usize) -> Blend<'a>,
    wo: [&[f32]; 3],
    request: &mut Request<'_>,
    range: Range<usize>,
) {
    for i in range {
        let draw = request.draw.as_mut();
        let evaluate = request.evaluate.as_mut();
        let colors = draw.as_ref().is_some_and(|draw| draw.weight.is_some())
            || evaluate.as_ref().is_some_and(|towards| towards.value.is_some());
        let u = draw.as_ref().map(|draw| at(&draw.u, i).to_array());
        let wi = evaluate.as_ref().map(|towards| at(&towards.wi, i).to_array());
        let answer = get(i).ask_one(at(&wo, i), Asked { u, wi, colors });
        if let Some(draw) = draw {
            draw.put(i, &answer.sample);
        }
        if let Some(towards) = evaluate {
            towards.put(i, &answer.value, answer.pdf);
        }
    }
}

#[cfg(feature = "simd")]
#[inline(never)]
fn in_blocks<'a>(level: Level, get: &dyn Fn(usize) -> Blend<'a>, wo: [&[f32]; 3], request: &mut Request<'_>) {
    let n = wo[0].len();
    let (mut parts, mut groups) = (0, 0);
    for blend in (0..n).map(get) {
        parts = parts.max(blend.seen.count_ones() as usize);
        groups = blend.seen().map(BlendPart::groups).fold(groups, usize::max);
    }
    in_room((parts * groups).min(MOST) * n.min(WIDEST), &mut |groups| {
        let mut scratch = Scratch { room: Room::NEW, hits: [const { Hits::NONE }; MOST], chosen: Hits::NONE };
        for block in Block::all(n) {
            match Columns::new(get, block) {
                Some(columns) => columns.answer(level, wo, request, &mut scratch, groups),
                None => one_by_one(get, wo, request, block.from..block.from + block.count),
            }
        }
    });
}

/// Room for the work on a block, beside its lobes.
#[cfg(feature = "simd")]
struct Scratch {
    room: Room,
    /// The numbers of each part of the hits, and of the parts that draws have chosen.
    hits: [Hits; MOST],
    chosen: Hits,
}

/// The parts of the hits of a block that are not black: the first of each hit, the second, and so on, as many as any hit has.
#[cfg(feature = "simd")]
struct Columns<'a> {
    block: Block,
    parts: [[Option<&'a BlendPart<'a>>; WIDEST]; MOST],
    materials: [[MaterialRef<'a>; WIDEST]; MOST],
    /// What values are multiplied by, but for coats.
    colors: [[Numbers; 3]; MOST],
    count: usize,
    groups_of_hit: usize,
    has_factors: bool,
    has_coats: bool,
}

/// Shares of the draws of each hit.
#[cfg(feature = "simd")]
type Shares = [[f32; MOST]; WIDEST];

#[cfg(feature = "simd")]
impl<'a> Columns<'a> {
    /// `None` of hits that are taken one by one.
    fn new(get: &dyn Fn(usize) -> Blend<'a>, block: Block) -> Option<Self> {
        let (mut parts, mut count, mut groups_of_hit) = ([[None; WIDEST]; MOST], 0, 1);
        let (mut any, mut has_factors, mut has_coats) = (None, false, false);
        let mut colors = [[[0.0; WIDEST]; 3]; MOST];
        for i in 0..block.count {
            for (column, part) in get(block.from + i).seen().enumerate() {
                let material = part.material()?;
                any = Some(material);
                has_factors |= material.header.has_factors();
                has_coats |= part.coat > 1.0;
                parts.get_mut(column)?[i] = Some(part);
                let color = part.color();
                (0..3).for_each(|channel| colors[column][channel][i] = color[channel]);
                (count, groups_of_hit) = (count.max(column + 1), groups_of_hit.max(part.groups()));
            }
        }
        let any = any.filter(|_| count * groups_of_hit <= MOST)?;
        let material = |part: Option<&'a BlendPart<'a>>| part.and_then(BlendPart::material).unwrap_or(any);
        let materials = parts.map(|column| column.map(material));
        Some(Self { block, parts, materials, colors, count, groups_of_hit, has_factors, has_coats })
    }

    /// The lobes of a part of a hit.
    fn lobes<'g>(&self, groups: &'g [Group], column: usize, hit: usize) -> &'g [Group] {
        let hit = hit.min(self.block.count - 1);
        &groups[(column * self.block.count + hit) * self.groups_of_hit..][..self.groups_of_hit]
    }

    #[inline(never)]
    fn answer(
        &self,
        level: Level,
        wo: [&[f32]; 3],
        request: &mut Request<'_>,
        scratch: &mut Scratch,
        groups: &mut [Group],
    ) {
        let block = self.block;
        let mut outgoing = scratch.room.wo;
        block.copy_in(&wo, &mut outgoing);
        let shares = self.fill(level, &outgoing, scratch, groups);
        let groups = &*groups;
        if let Some(towards) = &mut request.evaluate {
            block.copy_in(&towards.wi, &mut scratch.room.wi);
            let sums = self.sums(level, &outgoing, &shares, scratch, groups, false);
            if let Some(value) = &mut towards.value {
                block.copy_out(&sums.value, value);
            }
            if let Some(pdf) = &mut towards.pdf {
                block.copy_out(&[sums.pdf], &mut [&mut **pdf]);
            }
        }
        let Some(draw) = &mut request.draw else { return };
        block.copy_in(&draw.u, &mut scratch.room.u);
        let mut lobes = [self.lobes(groups, 0, 0); WIDEST];
        (scratch.chosen.count, scratch.chosen.in_plane) = (block.count, true);
        for (i, lobes) in lobes.iter_mut().enumerate().take(block.count) {
            let (column, left) = choose(&shares[i], scratch.room.u[0][i]);
            *lobes = self.lobes(groups, column, i);
            scratch.chosen.copy_hit(i, &scratch.hits[column], shares[i][column] > 0.0);
            scratch.room.u[0][i] = left;
        }
        let Scratch { room, chosen, .. } = scratch;
        core::mem::swap(&mut room.hits, chosen);
        level.run_vectors(Work { room, groups: &lobes, draws: true, evaluates: false });
        core::mem::swap(&mut room.hits, chosen);
        let direction = room.direction;
        block.copy_out(&direction, &mut draw.direction);
        if draw.pdf.is_none() && draw.weight.is_none() {
            return;
        }
        room.wi = direction;
        let is_one = self.count == 1;
        if is_one {
            core::mem::swap(&mut room.towards, &mut room.drawn);
        }
        let mut sums = self.sums(level, &outgoing, &shares, scratch, groups, is_one);
        if let Some(pdf) = &mut draw.pdf {
            let drawn =
                |i: usize| if scratch.chosen.power[i] > 0.0 { drawn_density(sums.pdf[i]) } else { 0.0 };
            block.copy_out(&[core::array::from_fn(drawn)], &mut [&mut **pdf]);
        }
        if let Some(weight) = &mut draw.weight {
            weigh(&mut sums);
            block.copy_out(&sums.value, weight);
        }
    }

    /// Fills the lobes and the numbers of all parts; returns the shares of the draws.
    fn fill(
        &self,
        level: Level,
        outgoing: &[Numbers; 3],
        Scratch { room, hits, .. }: &mut Scratch,
        groups: &mut [Group],
    ) -> Shares {
        let (count, mut shares) = (self.block.count, [[0.0; MOST]; WIDEST]);
        let groups = groups.chunks_exact_mut(count * self.groups_of_hit);
        for (column, (groups, hits)) in groups.zip(hits).enumerate().take(self.count) {
            let materials = &self.materials[column];
            room.wo = *outgoing;
            for i in (0..count).filter(|i| self.parts[column][*i].is_none()) {
                // No outgoing direction reflects nothing.
                room.wo.iter_mut().for_each(|component| component[i] = 0.0);
            }
            core::mem::swap(&mut room.hits, hits);
            fill(level, materials, count, room, groups, self.groups_of_hit);
            core::mem::swap(&mut room.hits, hits);
            for (i, shares) in shares.iter_mut().enumerate().take(count) {
                let power = self.parts[column][i].map(|part| part.draws(vector(outgoing, i)) * hits.power[i]);
                shares[column] = power.unwrap_or(0.0);
            }
        }
        shares.iter_mut().for_each(|shares| super::complete(shares));
        shares
    }

    /// Values and densities of the blends towards the incident directions of the room. `is_there`: those of the only part are there.
    fn sums(
        &self,
        level: Level,
        outgoing: &[Numbers; 3],
        shares: &Shares,
        Scratch { room, hits, .. }: &mut Scratch,
        groups: &[Group],
        is_there: bool,
    ) -> Sums {
        let zeros = [0.0; WIDEST];
        let mut sums = Sums { value: [zeros; 3], pdf: zeros };
        let incident = room.wi;
        for (column, hits) in hits.iter_mut().enumerate().take(self.count) {
            if !is_there {
                let lobes = core::array::from_fn(|i| self.lobes(groups, column, i));
                core::mem::swap(&mut room.hits, hits);
                level.run_vectors(Work { room, groups: &lobes, draws: false, evaluates: true });
                core::mem::swap(&mut room.hits, hits);
            }
            let own = &mut room.towards;
            if self.has_factors {
                let factors = |i: usize| Nodes::new(self.materials[column][i]);
                multiply(level, &factors, self.block.count, outgoing, &incident, own);
            }
            if self.has_coats {
                for (i, part) in self.parts[column].iter().enumerate() {
                    let Some(part) = part else { continue };
                    let coat = part.through(vector(outgoing, i), vector(&incident, i));
                    own.value.iter_mut().for_each(|channel| channel[i] *= coat);
                }
            }
            for channel in 0..3 {
                let (to, from) = (&mut sums.value[channel], &own.value[channel]);
                let colors = &self.colors[column][channel];
                for i in 0..WIDEST {
                    to[i] += from[i] * colors[i];
                }
            }
            for i in 0..WIDEST {
                sums.pdf[i] += own.pdf[i] * shares[i][column];
            }
        }
        sums
    }
}

#[cfg(feature = "simd")]
fn vector(of: &[Numbers; 3], i: usize) -> Vec3 {
    Vec3::new(of[0][i], of[1][i], of[2][i])
}
