//! Many hits, each with an outgoing direction of its own, and perhaps a material of its own, as a wavefront renderer
//! has them.
//!
//! With vectors they are taken in blocks, see `block.rs`; without, and where there are only a few, or some
//! material is anisotropic, one after the other.

#[cfg(feature = "simd")]
use super::super::each_mixture::by_mixtures;
#[cfg(feature = "simd")]
use super::super::multiply_factors::multiply_pairs;
use super::super::request::{Request, at};
#[cfg(feature = "simd")]
use super::super::slices::Block;
use super::super::slices::{one_length, same_length};
#[cfg(feature = "simd")]
use super::block::{HitBlock, Room, Sums};
#[cfg(feature = "simd")]
use super::lobes::{Kept, NOTHING};
#[cfg(feature = "simd")]
use super::one::GROUPS;
use super::one::{Asked, ask_one};
use crate::error::Error;
use crate::material::borrowed::{Material, MaterialRef};
#[cfg(feature = "simd")]
use crate::mixture::factors::Nodes;
#[cfg(feature = "simd")]
use crate::mixture::rows::{drawn_density, weight_of};
#[cfg(feature = "simd")]
use crate::simd::detect::Level;
#[cfg(feature = "simd")]
use crate::simd::lanes::{Lanes, Numbers, WIDEST};
#[cfg(feature = "simd")]
use crate::simd::routine::One;
use core::borrow::Borrow;
#[cfg(feature = "simd")]
use glam::Vec3;

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
        ask(Source::One(self.borrowed()), wo, &mut request);
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
        ask(Source::Each(&|i| materials[i].borrow().borrowed()), wo, &mut request);
        Ok(())
    }
}

/// Fewer hits than this are taken one by one.
#[cfg(feature = "simd")]
const FEW: usize = 4;

/// Up to that many hits have a small block.
#[cfg(feature = "simd")]
const SOME: usize = WIDEST / 2;

/// Whose hits they are.
#[derive(Clone, Copy)]
enum Source<'a, 'm> {
    One(MaterialRef<'m>),
    Each(&'a dyn Fn(usize) -> MaterialRef<'m>),
}

impl<'m> Source<'_, 'm> {
    #[inline(always)]
    fn get(&self, i: usize) -> MaterialRef<'m> {
        match self {
            Self::One(material) => *material,
            Self::Each(get) => get(i),
        }
    }
}

/// Asks for all. Not generic over who owns the bytes of a material: the kernels are compiled here, once.
fn ask(source: Source<'_, '_>, wo: [&[f32]; 3], request: &mut Request<'_>) {
    let n = wo[0].len();
    #[cfg(feature = "simd")]
    if n >= FEW {
        let level = Level::current();
        if level != Level::Scalar {
            if let Source::One(material) = source
                && !material.header.is_isotropic()
            {
                by_mixtures(material, wo, level, request);
                return;
            }
            let count = |i| source.get(i).header.lobe_count();
            let most = match source {
                Source::One(_) => count(0),
                Source::Each(_) => (0..n).map(count).max().unwrap_or(0),
            };
            match (most <= WIDEST, n <= SOME) {
                (true, true) => in_blocks::<1, SOME>(level, source, wo, request),
                (true, false) => in_blocks::<1, WIDEST>(level, source, wo, request),
                (false, _) => in_blocks::<GROUPS, WIDEST>(level, source, wo, request),
            }
            return;
        }
    }
    one_by_one(source, wo, request, 0..n);
}

fn one_by_one(
    source: Source<'_, '_>,
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

/// `B`: most hits of a block, so that few do not wait until room for many has been cleared.
#[cfg(feature = "simd")]
#[inline(never)]
fn in_blocks<const G: usize, const B: usize>(
    level: Level,
    source: Source<'_, '_>,
    wo: [&[f32]; 3],
    request: &mut Request<'_>,
) {
    let (mut room, mut kept) = (Room::NEW, [[NOTHING; G]; B]);
    let mut materials = [source.get(0); WIDEST];
    for block in Block::all(wo[0].len()) {
        let Block { from, count } = block;
        if let Source::Each(get) = source {
            for (i, material) in materials.iter_mut().enumerate() {
                *material = get(from + i.min(count - 1));
            }
        }
        if materials.iter().all(|material| material.header.is_isotropic()) {
            Hits { level, materials: &materials, block }.ask(&wo, request, &mut room, &mut kept);
        } else {
            one_by_one(source, wo, request, from..from + count);
        }
    }
}

/// The hits of a block.
#[cfg(feature = "simd")]
struct Hits<'a, 'm> {
    level: Level,
    materials: &'a [MaterialRef<'m>; WIDEST],
    block: Block,
}

#[cfg(feature = "simd")]
impl Hits<'_, '_> {
    fn ask<const G: usize>(
        &self,
        wo: &[&[f32]; 3],
        request: &mut Request<'_>,
        room: &mut Room,
        kept: &mut [Kept<G>],
    ) {
        let &Self { level, materials, block } = self;
        let count = block.count;
        block.copy_in(wo, &mut room.wo);
        if let Some(draw) = &request.draw {
            block.copy_in(&draw.u, &mut room.u);
        }
        if let Some(towards) = &request.evaluate {
            block.copy_in(&towards.wi, &mut room.wi);
        }
        let (draws, evaluates) = (request.draw.is_some(), request.evaluate.is_some());
        level.run_vectors(HitBlock::<G> { materials, count, draws, evaluates, room: &mut *room, kept });
        let Room { wo, wi, direction, drawn, towards, power, .. } = room;
        if let Some(draw) = &mut request.draw {
            if let Some(weight) = &mut draw.weight {
                self.multiply(wo, direction, drawn);
                let Sums { value, pdf } = drawn;
                for i in 0..WIDEST {
                    let colour = weight_of(Vec3::new(value[0][i], value[1][i], value[2][i]), pdf[i]);
                    [value[0][i], value[1][i], value[2][i]] = colour.to_array();
                }
                block.copy_out(value, weight);
            }
            if let Some(pdf) = &mut draw.pdf {
                for (density, &power) in drawn.pdf.iter_mut().zip(&*power) {
                    if power > 0.0 {
                        *density = drawn_density(*density);
                    }
                }
                block.copy_out(&[drawn.pdf], &mut [&mut **pdf]);
            }
            block.copy_out(direction, &mut draw.direction);
        }
        if let Some(evaluate) = &mut request.evaluate {
            if let Some(pdf) = &mut evaluate.pdf {
                block.copy_out(&[towards.pdf], &mut [&mut **pdf]);
            }
            if let Some(value) = &mut evaluate.value {
                self.multiply(wo, wi, towards);
                block.copy_out(&towards.value, value);
            }
        }
    }

    /// Multiplies values by their factors: all at once where the materials have the same.
    fn multiply(&self, wo: &[Numbers; 3], wi: &[Numbers; 3], sums: &mut Sums) {
        let &Self { level, materials, block } = self;
        if materials.iter().all(|material| !material.header.has_factors()) {
            return;
        }
        let first = Nodes::new(materials[0]);
        if materials.iter().all(|material| first.is(&Nodes::new(*material))) {
            // A vector that is no direction may have a factor of NaN, and 0 times NaN is NaN.
            let (mut outgoing, mut incident) = (*wo, *wi);
            for i in 0..WIDEST {
                if sums.pdf[i] == 0.0 && sums.value.iter().all(|channel| channel[i] == 0.0) {
                    outgoing.iter_mut().chain(&mut incident).for_each(|component| component[i] = 0.5);
                }
            }
            multiply_pairs(level, &first, &outgoing, &incident, &mut sums.value);
            return;
        }
        for (i, material) in materials.iter().enumerate().take(block.count) {
            let nodes = Nodes::new(*material);
            let is_dark = sums.value.iter().all(|channel| channel[i] == 0.0);
            if !nodes.is_none() && !is_dark {
                let pair = (&nodes, [wo[0][i], wo[1][i], wo[2][i]]);
                let factor = level.run_one::<_, Factor>(pair, [wi[0][i], wi[1][i], wi[2][i]]);
                for (channel, factor) in sums.value.iter_mut().zip(factor) {
                    channel[i] *= factor;
                }
            }
        }
    }
}

/// The factor towards a direction.
#[cfg(feature = "simd")]
struct Factor;

#[cfg(feature = "simd")]
impl One<(&Nodes<'_>, [f32; 3])> for Factor {
    type Output = [f32; 3];
    const IS_WIDE: bool = false;
    #[inline(always)]
    fn run<L: Lanes>((nodes, wo): (&Nodes<'_>, [f32; 3]), wi: [f32; 3]) -> [f32; 3] {
        nodes.towards::<L::One>(wo, wi).to_array()
    }
}
