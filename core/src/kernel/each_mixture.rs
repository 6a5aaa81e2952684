//! Many mixtures, each with a direction of its own.
//!
//! With vectors they are taken in blocks, see `block.rs`; without, and where there are only a few, one after the
//! other.

#[cfg(feature = "simd")]
use super::answers::{LobeSource, answer_block};
#[cfg(feature = "simd")]
use super::block::Room;
use super::prepare::prepare_each;
use super::request::{Draws, Request, Towards, at};
use super::slices::{Block, same_length};
use crate::error::Error;
use crate::material::borrowed::Material;
#[cfg(feature = "simd")]
use crate::mixture::factors::Nodes;
#[cfg(feature = "simd")]
use crate::mixture::row::Group;
#[cfg(feature = "simd")]
use crate::mixture::rows::Domain;
use crate::mixture::rows::{AnyMixture, Sample, drawn_density};
use crate::simd::detect::Level;
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
pub(super) const FEW: usize = 4;

fn for_each_mixture<'m>(
    mixtures: &[impl AsRef<AnyMixture<'m>>],
    mut request: Request<'_>,
) -> Result<(), Error> {
    request.check(mixtures.len())?;
    #[cfg(feature = "simd")]
    let mut room = Room::NEW;
    for (block, mixtures) in Block::all(mixtures.len()).zip(mixtures.chunks(WIDEST)) {
        let last = mixtures.len() - 1;
        let each: [&AnyMixture<'m>; WIDEST] = core::array::from_fn(|i| mixtures[i.min(last)].as_ref());
        let each = &each[..=last];
        #[cfg(feature = "simd")]
        if let Some(level) = level_of_block(each) {
            answer_block(level, &mut Made(each), block, None, &mut request, &mut room);
            continue;
        }
        for (i, mixture) in each.iter().enumerate() {
            one_of(&mut request, mixture, block.from + i);
        }
    }
    Ok(())
}

/// The level of mixtures that can be taken together: they have it in common, and live on the hemisphere. `None` for others.
#[cfg(feature = "simd")]
fn level_of_block(mixtures: &[&AnyMixture<'_>]) -> Option<Level> {
    let level = mixtures[0].head.level;
    let fits = |m: &&AnyMixture<'_>| m.head.level == level && m.head.domain == Domain::Hemisphere;
    (mixtures.len() >= FEW && level != Level::Scalar && mixtures.iter().all(fits)).then_some(level)
}

/// The hits of a block, whose lobes are those of mixtures.
#[cfg(feature = "simd")]
struct Made<'a, 'm>(&'a [&'a AnyMixture<'m>]);

#[cfg(feature = "simd")]
impl LobeSource for Made<'_, '_> {
    fn fill(&mut self, room: &mut Room) -> [&[Group]; WIDEST] {
        let Room { wo, hits, .. } = room;
        hits.count = self.0.len().min(WIDEST);
        (hits.in_plane, hits.any_squeezed, hits.any_diffuse) = (true, false, false);
        for (i, m) in self.0.iter().take(WIDEST).enumerate() {
            let (head, squeeze) = (&m.head, &m.head.squeeze);
            hits.lobes[i] = head.count;
            hits.squeezed[i] = head.squeezed;
            // Of lobes with axes in the plane of incidence y is 0, which a general frame handles as well.
            hits.in_plane &= head.in_plane;
            hits.any_squeezed |= head.squeezed > 0;
            hits.any_diffuse |= head.lobes_power < head.power;
            [hits.azimuth[0][i], hits.azimuth[1][i]] = squeeze.azimuth;
            hits.excess[i] = squeeze.excess;
            (hits.stretch[0][i], hits.stretch[1][i]) = (squeeze.along, squeeze.inverse);
            [hits.diffuse[0][i], hits.diffuse[1][i], hits.diffuse[2][i]] = head.diffuse.to_array();
            hits.lobes_power[i] = head.lobes_power;
            hits.power[i] = head.power;
            hits.inverse_power[i] = head.inverse_power;
            // Nothing is towards any vector, also where an infinite one would make a NaN of a product with 0.
            hits.is_there[i] = if m.is_nothing() { 0.0 } else { 1.0 };
            [wo[0][i], wo[1][i], wo[2][i]] = head.factors.wo;
        }
        for (widen, stretch) in hits.widen.iter_mut().zip(&hits.stretch) {
            for (widen, stretch) in widen.iter_mut().zip(stretch) {
                *widen = 1.0 / stretch;
            }
        }
        core::array::from_fn(|i| &self.0[i.min(self.0.len() - 1)].groups)
    }

    fn has_factors(&self) -> bool {
        self.0.iter().any(|m| !m.head.factors.nodes.is_none())
    }

    fn factors(&self, hit: usize) -> Nodes<'_> {
        // A mixture of nothing may be multiplied by any factor, so that all have the same.
        let hits = if self.0[hit].is_nothing() { self.0 } else { &self.0[hit..=hit] };
        let nodes = hits.iter().map(|m| m.head.factors.nodes).find(|nodes| !nodes.is_none());
        nodes.unwrap_or(Nodes::NONE)
    }
}

/// Answers for mixture `m`, an empty one if the outgoing direction of hit `i` was none.
pub(super) fn one_of(request: &mut Request<'_>, m: &AnyMixture<'_>, i: usize) {
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
