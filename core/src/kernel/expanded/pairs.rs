//! The verbs of an expanded material, for n hits, each with an outgoing direction of its own.

use super::super::answers::{LobeSource, answer_block};
use super::super::block::Room;
use super::super::request::Request;
use super::super::slices::{Block, one_length};
use super::block::Fill;
use super::table::Expanded;
use crate::error::Error;
use crate::mixture::factors::Nodes;
use crate::mixture::row::{Aligned, Group};
use crate::simd::detect::Level;
use crate::simd::lanes::{PARTS, WIDEST};

impl Expanded<'_> {
    /// Draws and evaluates for n hits, each with an outgoing direction of its own: outputs that are given are wanted.
    ///
    /// The answers of [`prepare`](Self::prepare) and the verbs of a [`Mixture`](crate::Mixture) but for rounding. An
    /// outgoing direction below the horizon, or none at all (not finite, not of unit length), reflects nothing.
    ///
    /// Shapes: `wo` x, y, z, each `[n]`; every slice of the request `[n]`.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn ask(&self, wo: [&[f32]; 3], mut request: Request<'_>) -> Result<(), Error> {
        let n = one_length(&wo)?;
        request.check(n)?;
        let (mut usual, mut most);
        let groups: &mut [Group] = if self.groups() == 1 {
            usual = Aligned::<WIDEST>::EMPTY;
            &mut usual.0
        } else {
            most = Aligned::<{ WIDEST * PARTS }>::EMPTY;
            &mut most.0
        };
        let (mut room, level) = (Room::NEW, Level::current());
        let mut hits = Rows { expanded: self, level, count: 0, groups };
        for block in Block::all(n) {
            hits.count = block.count;
            answer_block(level, &mut hits, block, Some(wo), &mut request, &mut room);
        }
        Ok(())
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
