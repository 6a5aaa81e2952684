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
use crate::mixture::rows::{AnyMixture, Sample, drawn_density};
#[cfg(feature = "simd")]
use crate::mixture::rows::{Domain, Mixture, weight_of};
use crate::simd::detect::Level;
#[cfg(feature = "simd")]
use crate::simd::lanes::Numbers;
use crate::simd::lanes::WIDEST;
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
    pub fn prepare_into<'a>(
        &'a self,
        wo: [&[f32]; 3],
        mixtures: &mut [impl AsMut<AnyMixture<'a>>],
    ) -> Result<(), Error> {
        same_length(wo.iter().map(|s| s.len()).chain([mixtures.len()]))?;
        let needed = self.lobe_count();
        let capacities = mixtures.iter_mut().map(|mixture| mixture.as_mut().capacity());
        if let Some(available) = capacities.min().filter(|least| *least < needed) {
            return Err(Error::Capacity { needed, available });
        }
        let (material, level) = (self.borrowed(), Level::current());
        for (Block { from, count }, mixtures) in Block::all(mixtures.len()).zip(mixtures.chunks_mut(WIDEST)) {
            let wo = wo.map(|s| &s[from..from + count]);
            let mut left = mixtures.iter_mut();
            let mut mixtures: [_; WIDEST] = core::array::from_fn(|_| left.next().map(AsMut::as_mut));
            prepare_each(material, wo, level, &mut mixtures[..count]);
        }
        Ok(())
    }
}

/// One direction for each of n mixtures, or references to them. Every mixture uses the kernels of its own level;
/// those of one level and one material are taken in blocks.
impl<'m> AnyMixture<'m> {
    /// Draws and evaluates for n hits, each with a mixture of its own: outputs that are given are wanted.
    ///
    /// Shapes: `mixtures` `[n]`; every slice of the request `[n]`.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn ask_each(mixtures: &[impl AsRef<AnyMixture<'m>>], request: Request<'_>) -> Result<(), Error> {
        for_each_mixture(mixtures, request)
    }
}

/// Fewer pairs than this are taken one by one.
#[cfg(feature = "simd")]
const FEW: usize = 4;

fn for_each_mixture<'m>(
    mixtures: &[impl AsRef<AnyMixture<'m>>],
    mut request: Request<'_>,
) -> Result<(), Error> {
    request.check(mixtures.len())?;
    for (block, mixtures) in Block::all(mixtures.len()).zip(mixtures.chunks(WIDEST)) {
        let last = mixtures.len() - 1;
        let each: [&AnyMixture<'m>; WIDEST] = core::array::from_fn(|i| mixtures[i.min(last)].as_ref());
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
fn level_of_block(mixtures: &[&AnyMixture<'_>]) -> Option<Level> {
    let level = mixtures[0].head.level;
    if mixtures.len() < FEW || level == Level::Scalar {
        return None;
    }
    let factors = mixtures.iter().map(|m| m.head.factors.nodes).find(|nodes| !nodes.is_none());
    let factors = factors.unwrap_or(Nodes::NONE);
    let fits = |m: &&AnyMixture<'_>| {
        let nodes = m.head.factors.nodes;
        // A mixture with neither lobes nor factors may be multiplied by any factor.
        let same_factors = (nodes.is_none() && m.is_nothing()) || nodes.is(&factors);
        m.head.level == level && m.head.domain == Domain::Hemisphere && same_factors
    };
    mixtures.iter().all(fits).then_some(level)
}

/// The densities of a block, of the values before they are multiplied by factors.
#[cfg(feature = "simd")]
fn densities(value: &[Numbers; 3], mixtures: &[&AnyMixture<'_>], pdf: &mut [f32]) {
    for (i, (m, pdf)) in mixtures.iter().zip(pdf).enumerate() {
        *pdf = luminance(Vec3::new(value[0][i], value[1][i], value[2][i])) * m.head.inverse_power;
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
    // Room that is not needed is not cleared.
    if material.header.lobe_count() <= WIDEST {
        let mut mixtures = [const { Mixture::<16>::empty() }; WIDEST];
        let mixtures = mixtures.each_mut().map(|mixture| -> &mut AnyMixture<'_> { mixture });
        in_room(material, wo, level, request, mixtures);
    } else {
        let mut mixtures = [const { Mixture::<64>::empty() }; WIDEST];
        let mixtures = mixtures.each_mut().map(|mixture| -> &mut AnyMixture<'_> { mixture });
        in_room(material, wo, level, request, mixtures);
    }
}

#[cfg(feature = "simd")]
fn in_room<'m>(
    material: MaterialRef<'m>,
    wo: [&[f32]; 3],
    level: Level,
    request: &mut Request<'_>,
    mut mixtures: [&mut AnyMixture<'m>; WIDEST],
) {
    for block in Block::all(wo[0].len()) {
        let wo = wo.map(|s| &s[block.from..block.from + block.count]);
        let mut made = mixtures.each_mut().map(|mixture| Some(&mut **mixture));
        prepare_each(material, wo, level, &mut made[..block.count]);
        let made = mixtures.each_ref().map(|mixture| &**mixture);
        block_of(request, level, &made[..block.count], block);
    }
}

/// Answers for mixture `m`, an empty one if the outgoing direction of hit `i` was none.
fn one_of(request: &mut Request<'_>, m: &AnyMixture<'_>, i: usize) {
    if let Some(draw) = &mut request.draw {
        draw_one(draw, m, i);
    }
    if let Some(towards) = &mut request.evaluate {
        evaluate_one(towards, m, i);
    }
}

/// Draw `i`, of mixture `m`.
pub(super) fn draw_one(draw: &mut Draws<'_>, m: &AnyMixture<'_>, i: usize) {
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
pub(super) fn evaluate_one(towards: &mut Towards<'_>, m: &AnyMixture<'_>, i: usize) {
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
fn block_of(request: &mut Request<'_>, level: Level, mixtures: &[&AnyMixture<'_>], block: Block) {
    let (from, count) = (block.from, block.count);
    if let Some(Draws { u, direction, pdf, weight }) = &mut request.draw {
        let directions = level.run_vectors(DrawBlock { mixtures, u: &block.padded(u) });
        let mut density = [0.0; WIDEST];
        if let Some(weight) = weight {
            let mut value = level.run_vectors(SumBlock::<3> { mixtures, directions: &directions });
            densities(&value, mixtures, &mut density[..count]);
            multiply_block(level, mixtures, &directions, &mut value);
            for (i, &density) in density[..count].iter().enumerate() {
                let value = Vec3::new(value[0][i], value[1][i], value[2][i]);
                [weight[0][from + i], weight[1][from + i], weight[2][from + i]] =
                    weight_of(value, density).to_array();
            }
        } else if pdf.is_some() {
            let [sums] = level.run_vectors(SumBlock::<1> { mixtures, directions: &directions });
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
            let mut sums = level.run_vectors(SumBlock::<3> { mixtures, directions });
            if let Some(pdf) = pdf {
                densities(&sums, mixtures, &mut pdf[from..from + count]);
            }
            multiply_block(level, mixtures, directions, &mut sums);
            block.copy_out(&sums, value);
        } else if let Some(pdf) = pdf {
            let [sums] = level.run_vectors(SumBlock::<1> { mixtures, directions });
            for (i, m) in mixtures.iter().enumerate() {
                pdf[from + i] = sums[i] * m.head.inverse_power;
            }
        }
    }
}
