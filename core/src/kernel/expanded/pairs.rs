//! The verbs of an expanded material, for n hits, each with an outgoing direction of its own.

use super::super::answers::{LobeSource, answer_block, in_room};
use super::super::block::Room;
use super::super::each_mixture::{FEW, one_of};
use super::super::request::{Request, at};
use super::super::slices::{Block, one_length};
use super::block::Fill;
use super::table::Expanded;
use crate::error::Error;
use crate::mixture::factors::Nodes;
use crate::mixture::row::Group;
use crate::mixture::rows::{AnyMixture, Mixture};
use crate::simd::detect::Level;
use crate::simd::lanes::WIDEST;

impl Expanded<'_> {
    /// Draws and evaluates for n hits, each with an outgoing direction of its own: outputs that are given are wanted.
    ///
    /// The answers of [`prepare`](Self::prepare) and the verbs of a [`Mixture`] but for rounding. An
    /// outgoing direction below the horizon, or none at all (not finite, not of unit length), reflects nothing.
    ///
    /// Shapes: `wo` x, y, z, each `[n]`; every slice of the request `[n]`.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn ask(&self, wo: [&[f32]; 3], mut request: Request<'_>) -> Result<(), Error> {
        let n = one_length(&wo)?;
        request.check(n)?;
        if n < FEW {
            // Room that is not needed is not cleared.
            if self.groups() == 1 {
                self.one_by_one(wo, &mut request, &mut Mixture::<16>::empty());
            } else {
                self.one_by_one(wo, &mut request, &mut Mixture::<64>::empty());
            }
            return Ok(());
        }
        in_room(self.groups() * n.min(WIDEST), &mut |groups| {
            let (mut room, level) = (Room::NEW, Level::current());
            let mut hits = Rows { expanded: self, level, count: 0, groups };
            for block in Block::all(n) {
                hits.count = block.count;
                answer_block(level, &mut hits, block, Some(wo), &mut request, &mut room);
            }
        });
        Ok(())
    }

    /// The same by the mixture of each hit.
    #[inline(never)]
    fn one_by_one<'a>(&'a self, wo: [&[f32]; 3], request: &mut Request<'_>, mixture: &mut AnyMixture<'a>) {
        for i in 0..wo[0].len() {
            // A vector that is no direction makes an empty mixture.
            let _ = self.prepare(at(&wo, i), mixture);
            one_of(request, mixture, i);
        }
    }

    /// Groups of sixteen lobes.
    pub(super) fn groups(&self) -> usize {
        self.material.lobe_count().div_ceil(WIDEST).max(1)
    }
}

/// The hits of a block, whose lobes come from rows.
struct Rows<'a> {
    expanded: &'a Expanded<'a>,
    level: Level,
    count: usize,
    groups: &'a mut [Group],
}

impl LobeSource for Rows<'_> {
    fn fill(&mut self, room: &mut Room) -> [&[Group]; WIDEST] {
        let &mut Self { expanded, level, count, ref mut groups } = self;
        level.run_vectors(Fill { expanded, count, room, groups });
        let groups_of_hit = expanded.groups();
        core::array::from_fn(|i| &groups[i.min(count - 1) * groups_of_hit..][..groups_of_hit])
    }

    fn has_factors(&self) -> bool {
        self.expanded.material.borrowed().header.has_factors()
    }

    fn factors(&self, _: usize) -> Nodes<'_> {
        Nodes::new(self.expanded.material.borrowed())
    }
}
