//! Many hits, each with an outgoing direction of its own, and perhaps a material of its own, as a wavefront renderer
//! has them.
//!
//! With vectors they are taken in blocks, see `block.rs`; without, and where there are only a few, one after the other.

#[cfg(feature = "simd")]
use super::super::answers::{LobeSource, answer_block, in_room};
#[cfg(feature = "simd")]
use super::super::block::Room;
use super::super::request::{Request, at};
#[cfg(feature = "simd")]
use super::super::slices::Block;
use super::super::slices::{one_length, same_length};
#[cfg(feature = "simd")]
use super::block::fill;
use super::one::{Asked, ask_one};
use crate::error::Error;
use crate::material::borrowed::{Material, MaterialRef};
#[cfg(feature = "simd")]
use crate::mixture::factors::Nodes;
#[cfg(feature = "simd")]
use crate::mixture::row::Group;
#[cfg(feature = "simd")]
use crate::simd::detect::Level;
#[cfg(feature = "simd")]
use crate::simd::lanes::WIDEST;
#[cfg(feature = "simd")]
use crate::simd::{prefetch, prefetch_lines};
use core::borrow::Borrow;

/// One outgoing direction for each of n hits.
impl<B: AsRef<[u8]>> Material<B> {
    /// Draws and evaluates for n hits, each with an outgoing direction of its own: outputs that are given are wanted.
    ///
    /// The answers of [`sample`](Self::sample) and [`evaluate_and_pdf`](Self::evaluate_and_pdf), one by one, within
    /// rounding and in less time. An outgoing direction below the horizon, or none at all (not finite, not of unit
    /// length), reflects nothing.
    ///
    /// Shapes: `wo` x, y, z, each `[n]`; every slice of the request `[n]`. Takes up to 25 kB of stack, 60 for a
    /// material of more than 16 lobes.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn ask(&self, wo: [&[f32]; 3], mut request: Request<'_>) -> Result<(), Error> {
        let n = one_length(&wo)?;
        request.check(n)?;
        ask(Asking::One(self.borrowed()), wo, &mut request);
        Ok(())
    }

    /// The same for n hits, each with a material of its own; they need not be sorted.
    ///
    /// Shapes: `materials` `[n]`, or references to them; the rest as in [`ask`](Self::ask).
    ///
    /// # Errors
    /// As [`ask`](Self::ask).
    pub fn ask_each(
        materials: &[impl Borrow<Self>],
        wo: [&[f32]; 3],
        mut request: Request<'_>,
    ) -> Result<(), Error> {
        let n = same_length(wo.iter().map(|s| s.len()).chain([materials.len()]))?;
        request.check(n)?;
        ask(Asking::Each(&|i| materials[i].borrow().borrowed()), wo, &mut request);
        Ok(())
    }
}

/// [`Material::ask`] of what kernels read, of slices that have been checked.
pub(crate) fn ask_material(material: MaterialRef<'_>, wo: [&[f32]; 3], request: &mut Request<'_>) {
    ask(Asking::One(material), wo, request);
}

/// [`Material::ask_each`] of what kernels read, of slices that have been checked.
pub(crate) fn ask_materials(materials: &[MaterialRef<'_>], wo: [&[f32]; 3], request: &mut Request<'_>) {
    ask(Asking::Each(&|i| materials[i]), wo, request);
}

/// Fewer hits than this are taken one by one.
#[cfg(feature = "simd")]
const FEW: usize = 4;

/// The material of each hit.
#[derive(Clone, Copy)]
enum Asking<'a, 'm> {
    One(MaterialRef<'m>),
    Each(&'a dyn Fn(usize) -> MaterialRef<'m>),
}

impl<'m> Asking<'_, 'm> {
    #[inline(always)]
    fn get(&self, i: usize) -> MaterialRef<'m> {
        match self {
            Self::One(material) => *material,
            Self::Each(get) => get(i),
        }
    }
}

/// Asks for all. Not generic over who owns the bytes of a material: the kernels are compiled here, once.
fn ask(source: Asking<'_, '_>, wo: [&[f32]; 3], request: &mut Request<'_>) {
    let n = wo[0].len();
    #[cfg(feature = "simd")]
    if n >= FEW {
        let level = Level::current();
        if level != Level::Scalar {
            let count = |i| source.get(i).header.lobe_count();
            let most = match source {
                Asking::One(_) => count(0),
                Asking::Each(_) => (0..n).map(count).max().unwrap_or(0),
            };
            in_blocks(level, source, most.div_ceil(WIDEST).max(1), wo, request);
            return;
        }
    }
    one_by_one(source, wo, request, 0..n);
}

fn one_by_one(
    source: Asking<'_, '_>,
    wo: [&[f32]; 3],
    request: &mut Request<'_>,
    range: core::ops::Range<usize>,
) {
    for i in range {
        let (material, wo) = (source.get(i), at(&wo, i));
        let draw = request.draw.as_mut();
        let evaluate = request.evaluate.as_mut();
        let colors = draw.as_ref().is_some_and(|draw| draw.weight.is_some())
            || evaluate.as_ref().is_some_and(|towards| towards.value.is_some());
        let u = draw.as_ref().map(|draw| at(&draw.u, i).to_array());
        let wi = evaluate.as_ref().map(|towards| at(&towards.wi, i).to_array());
        let answer = ask_one(material, wo, Asked { u, wi, colors });
        if let Some(draw) = draw {
            draw.put(i, &answer.sample);
        }
        if let Some(towards) = evaluate {
            towards.put(i, &answer.value, answer.pdf);
        }
    }
}

/// `groups_of_hit`: of sixteen lobes, most that a hit has.
#[cfg(feature = "simd")]
#[inline(never)]
fn in_blocks(
    level: Level,
    source: Asking<'_, '_>,
    groups_of_hit: usize,
    wo: [&[f32]; 3],
    request: &mut Request<'_>,
) {
    let n = wo[0].len();
    in_room(groups_of_hit * n.min(WIDEST), &mut |groups| {
        let mut room = Room::NEW;
        let mut hits = Files { level, materials: [source.get(0); WIDEST], count: 0, groups, groups_of_hit };
        for block in Block::all(n) {
            let Block { from, count } = block;
            hits.count = count;
            if let Asking::Each(get) = source {
                for (i, material) in hits.materials.iter_mut().enumerate() {
                    *material = get(from + i.min(count - 1));
                    // Angles of views are read first, and then heads, which stand behind them.
                    prefetch(material.header);
                    prefetch_lines::<3>(material.bytes, 0);
                }
            }
            answer_block(level, &mut hits, block, Some(wo), request, &mut room);
        }
    });
}

/// The hits of a block, whose lobes come from files.
#[cfg(feature = "simd")]
struct Files<'a, 'm> {
    level: Level,
    materials: [MaterialRef<'m>; WIDEST],
    count: usize,
    groups: &'a mut [Group],
    groups_of_hit: usize,
}

#[cfg(feature = "simd")]
impl LobeSource for Files<'_, '_> {
    fn fill(&mut self, room: &mut Room) -> [&[Group]; WIDEST] {
        let &mut Self { level, ref materials, count, ref mut groups, groups_of_hit } = self;
        fill(level, materials, count, room, groups, groups_of_hit);
        core::array::from_fn(|i| &groups[i.min(count - 1) * groups_of_hit..][..groups_of_hit])
    }

    fn has_factors(&self) -> bool {
        self.materials.iter().any(|material| material.header.has_factors())
    }

    fn factors(&self, hit: usize) -> Nodes<'_> {
        Nodes::new(self.materials[hit])
    }
}
