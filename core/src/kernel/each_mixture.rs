//! Many mixtures, each with a direction of its own.
//!
//! With vectors they are taken in blocks, see `block.rs`; without, and where there are only a few, one after the
//! other.

#[cfg(feature = "simd")]
use super::block::{DrawBlock, SumBlock};
#[cfg(feature = "simd")]
use super::multiply_factors::multiply_block;
use super::prepare::prepare_each;
use super::request::{Draws, Request, Towards, at};
use super::slices::{Block, same_length};
#[cfg(feature = "simd")]
use crate::color::luminance;
use crate::error::Error;
use crate::material::borrowed::Material;
#[cfg(feature = "simd")]
use crate::material::borrowed::MaterialRef;
#[cfg(feature = "simd")]
use crate::mixture::factors::Nodes;
#[cfg(feature = "simd")]
use crate::mixture::rows::{Domain, density_of, weight_of};
use crate::mixture::rows::{Mixture, Sample, drawn_density};
use crate::simd::detect::Level;
#[cfg(feature = "simd")]
use crate::simd::lanes::Numbers;
use crate::simd::lanes::WIDEST;
use core::borrow::{Borrow, BorrowMut};
use glam::Vec3;

impl<B: AsRef<[u8]>> Material<B> {
    /// Makes the mixtures for n outgoing directions; see [`prepare`](Self::prepare).
    ///
    /// Shapes: `wo` x, y, z, each `[n]`; `mixtures` `[n]`, or references to them, overwritten. A direction that
    /// is none gives an empty mixture.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; [`Error::Capacity`] if a mixture has room
    /// for fewer lobes than the material has. Nothing is written then.
    pub fn prepare_into<'a, const N: usize>(
        &'a self,
        wo: [&[f32]; 3],
        mixtures: &mut [impl BorrowMut<Mixture<'a, N>>],
    ) -> Result<(), Error> {
        same_length(wo.iter().map(|s| s.len()).chain([mixtures.len()]))?;
        if self.lobe_count() > N {
            return Err(Error::Capacity { needed: self.lobe_count(), available: N });
        }
        let (material, level) = (self.borrowed(), Level::current());
        for (Block { from, count }, mixtures) in Block::all(mixtures.len()).zip(mixtures.chunks_mut(WIDEST)) {
            let wo = wo.map(|s| &s[from..from + count]);
            let mut left = mixtures.iter_mut();
            let mut mixtures: [_; WIDEST] = core::array::from_fn(|_| left.next().map(BorrowMut::borrow_mut));
            prepare_each(material, wo, level, &mut mixtures[..count]);
        }
        Ok(())
    }
}

/// One direction for each of n mixtures, or references to them. Every mixture uses the kernels of its own level;
/// those of one level and one material are taken in blocks.
impl<'m, const N: usize> Mixture<'m, N> {
    /// Draws and evaluates for n hits, each with a mixture of its own: outputs that are given are wanted.
    ///
    /// Shapes: `mixtures` `[n]`; every slice of the request `[n]`.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn ask_each(mixtures: &[impl Borrow<Self>], request: Request<'_>) -> Result<(), Error> {
        for_each_mixture(mixtures, request)
    }
}

/// Fewer pairs than this are taken one by one.
#[cfg(feature = "simd")]
const FEW: usize = 4;

fn for_each_mixture<'m, const N: usize>(
    mixtures: &[impl Borrow<Mixture<'m, N>>],
    mut request: Request<'_>,
) -> Result<(), Error> {
    request.check(mixtures.len())?;
    for (block, mixtures) in Block::all(mixtures.len()).zip(mixtures.chunks(WIDEST)) {
        let last = mixtures.len() - 1;
        let each: [&Mixture<'m, N>; WIDEST] = core::array::from_fn(|i| mixtures[i.min(last)].borrow());
        let each = &each[..=last];
        #[cfg(feature = "simd")]
        if let Some(level) = level_of_block(each) {
            block_of(&mut request, level, each, block);
            continue;
        }
        for (i, mixture) in each.iter().enumerate() {
            one_of(&mut request, mixture, block.from + i);
        }
    }
    Ok(())
}

/// The level of mixtures that can be taken together: they have it in common, live on the hemisphere, and have the
/// same factors if any. `None` for others.
#[cfg(feature = "simd")]
fn level_of_block<const N: usize>(mixtures: &[&Mixture<'_, N>]) -> Option<Level> {
    let level = mixtures[0].head.level;
    if mixtures.len() < FEW || level == Level::Scalar {
        return None;
    }
    let factors = mixtures.iter().map(|m| m.head.factors.nodes).find(|nodes| !nodes.is_none());
    let factors = factors.unwrap_or(Nodes::NONE);
    let fits = |m: &&Mixture<'_, N>| {
        let nodes = m.head.factors.nodes;
        // A mixture with neither lobes nor factors may be multiplied by any factor.
        let same_factors = (nodes.is_none() && m.is_nothing()) || nodes.is(&factors);
        m.head.level == level && m.head.domain == Domain::Hemisphere && same_factors
    };
    mixtures.iter().all(fits).then_some(level)
}

/// The densities of a block, of the values before they are multiplied by factors.
#[cfg(feature = "simd")]
fn densities<const N: usize>(value: &[Numbers; 3], mixtures: &[&Mixture<'_, N>], pdf: &mut [f32]) {
    for (i, (m, pdf)) in mixtures.iter().zip(pdf).enumerate() {
        let luminance = luminance(Vec3::new(value[0][i], value[1][i], value[2][i]));
        *pdf = density_of(luminance, m.head.inverse_power);
    }
}

/// Asks the mixtures for the outgoing directions of a material, which are made in blocks: of an anisotropic one,
/// as an isotropic one needs none.
#[cfg(feature = "simd")]
pub(crate) fn by_mixtures(
    material: MaterialRef<'_>,
    wo: [&[f32]; 3],
    level: Level,
    request: &mut Request<'_>,
) {
    match material.header.lobe_count() {
        0..=16 => with_room::<16>(material, wo, level, request),
        17..=32 => with_room::<32>(material, wo, level, request),
        _ => with_room::<64>(material, wo, level, request),
    }
}

#[cfg(feature = "simd")]
fn with_room<const N: usize>(
    material: MaterialRef<'_>,
    wo: [&[f32]; 3],
    level: Level,
    request: &mut Request<'_>,
) {
    let mut mixtures = [const { Mixture::<N>::empty() }; WIDEST];
    for block in Block::all(wo[0].len()) {
        let wo = wo.map(|s| &s[block.from..block.from + block.count]);
        let mut made = mixtures.each_mut().map(Some);
        prepare_each(material, wo, level, &mut made[..block.count]);
        block_of(request, level, &mixtures.each_ref()[..block.count], block);
    }
}

/// Answers for mixture `m`, an empty one if the outgoing direction of hit `i` was none.
fn one_of<const N: usize>(request: &mut Request<'_>, m: &Mixture<'_, N>, i: usize) {
    if let Some(draw) = &mut request.draw {
        draw_one(draw, m, i);
    }
    if let Some(towards) = &mut request.evaluate {
        evaluate_one(towards, m, i);
    }
}

/// Draw `i`, of mixture `m`.
pub(super) fn draw_one<const N: usize>(draw: &mut Draws<'_>, m: &Mixture<'_, N>, i: usize) {
    let u = at(&draw.u, i).to_array();
    let sample = if draw.weight.is_some() {
        m.sample(u)
    } else {
        m.sample_direction(u).map(|direction| {
            let pdf = if draw.pdf.is_some() { drawn_density(m.pdf(direction)) } else { 0.0 };
            Sample { direction, pdf, weight: Vec3::ZERO }
        })
    };
    draw.put(i, &sample);
}

/// Value and density of mixture `m` towards direction `i`.
pub(super) fn evaluate_one<const N: usize>(towards: &mut Towards<'_>, m: &Mixture<'_, N>, i: usize) {
    let wi = at(&towards.wi, i);
    let (value, pdf) = if m.is_nothing() {
        (Vec3::ZERO, 0.0)
    } else if towards.value.is_some() {
        m.evaluate_and_pdf(wi)
    } else {
        (Vec3::ZERO, m.pdf(wi))
    };
    towards.put(i, &value, pdf);
}

/// Answers for the hits of a block, as many as mixtures.
#[cfg(feature = "simd")]
fn block_of<const N: usize>(
    request: &mut Request<'_>,
    level: Level,
    mixtures: &[&Mixture<'_, N>],
    block: Block,
) {
    let (from, count) = (block.from, block.count);
    if let Some(Draws { u, direction, pdf, weight }) = &mut request.draw {
        let directions = level.run(DrawBlock { mixtures, u: &block.padded(u) });
        let mut density = [0.0; WIDEST];
        if let Some(weight) = weight {
            let mut value = level.run(SumBlock::<N, 3> { mixtures, directions: &directions });
            densities(&value, mixtures, &mut density[..count]);
            multiply_block(level, mixtures, &directions, &mut value);
            for (i, &density) in density[..count].iter().enumerate() {
                let value = Vec3::new(value[0][i], value[1][i], value[2][i]);
                [weight[0][from + i], weight[1][from + i], weight[2][from + i]] =
                    weight_of(value, density).to_array();
            }
        } else if pdf.is_some() {
            let [sums] = level.run(SumBlock::<N, 1> { mixtures, directions: &directions });
            for (i, m) in mixtures.iter().enumerate() {
                density[i] = sums[i] * m.head.inverse_power;
            }
        }
        if let Some(pdf) = pdf {
            for (i, m) in mixtures.iter().enumerate() {
                pdf[from + i] = if m.head.power > 0.0 { drawn_density(density[i]) } else { density[i] };
            }
        }
        block.copy_out(&directions, direction);
    }
    if let Some(Towards { wi, value, pdf }) = &mut request.evaluate {
        let directions = &block.padded(wi);
        if let Some(value) = value {
            let mut sums = level.run(SumBlock::<N, 3> { mixtures, directions });
            if let Some(pdf) = pdf {
                densities(&sums, mixtures, &mut pdf[from..from + count]);
            }
            multiply_block(level, mixtures, directions, &mut sums);
            block.copy_out(&sums, value);
        } else if let Some(pdf) = pdf {
            let [sums] = level.run(SumBlock::<N, 1> { mixtures, directions });
            for (i, m) in mixtures.iter().enumerate() {
                pdf[from + i] = sums[i] * m.head.inverse_power;
            }
        }
    }
}
