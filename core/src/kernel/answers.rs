//! The answers of a request for many hits, each with lobes of its own: a block at a time.

use super::block::{Room, Sums, Work};
use super::multiply_factors::multiply_pairs;
use super::request::Request;
use super::slices::Block;
use crate::mixture::factors::Nodes;
use crate::mixture::row::{Aligned, Group};
use crate::mixture::rows::{LEAST_DENSITY, drawn_density};
use crate::simd::detect::Level;
use crate::simd::lanes::{Lanes, Numbers, PARTS, WIDEST};
use crate::simd::routine::One;

/// Runs the work of a request in room for the lobes of a block, at least `groups` of sixteen: in as little as serves, as room is cleared
/// first.
pub(crate) fn in_room(groups: usize, work: &mut dyn FnMut(&mut [Group])) {
    if groups <= 1 {
        in_room_of::<1>(work);
    } else if groups <= SOME {
        in_room_of::<SOME>(work);
    } else if groups <= WIDEST {
        in_room_of::<WIDEST>(work);
    } else {
        in_room_of::<{ WIDEST * PARTS }>(work);
    }
}

/// Groups of a small block.
const SOME: usize = WIDEST / 2;

/// In room on the stack, which only such a call takes.
#[inline(never)]
fn in_room_of<const G: usize>(work: &mut dyn FnMut(&mut [Group])) {
    let mut room = Aligned::<G>::EMPTY;
    work(&mut room.0);
}

/// Where the lobes of the hits of a block come from.
pub(crate) trait LobeSource {
    /// Fills the numbers of the hits, whose outgoing directions the room has, or sets them; and tells their lobes, those of the last
    /// hit again behind it.
    fn fill(&mut self, room: &mut Room) -> [&[Group]; WIDEST];
    /// Whether a hit has factors.
    fn has_factors(&self) -> bool;
    /// The factors of a hit.
    fn factors(&self, hit: usize) -> Nodes<'_>;
}

/// Answers for the hits of a block. `wo`: their outgoing directions, if the source wants some.
pub(crate) fn answer_block(
    level: Level,
    source: &mut dyn LobeSource,
    block: Block,
    wo: Option<[&[f32]; 3]>,
    request: &mut Request<'_>,
    room: &mut Room,
) {
    if let Some(wo) = &wo {
        block.copy_in(wo, &mut room.wo);
    }
    if let Some(draw) = &request.draw {
        block.copy_in(&draw.u, &mut room.u);
    }
    if let Some(towards) = &request.evaluate {
        block.copy_in(&towards.wi, &mut room.wi);
    }
    let (draws, evaluates) = (request.draw.is_some(), request.evaluate.is_some());
    let groups = source.fill(room);
    level.run_vectors(Work { room, groups: &groups, draws, evaluates });
    let has_factors = source.has_factors();
    let Room { wo, wi, direction, drawn, towards, hits, .. } = room;
    if let Some(draw) = &mut request.draw {
        if let Some(weight) = &mut draw.weight {
            if has_factors {
                multiply(level, &|hit| source.factors(hit), hits.count, wo, direction, drawn);
            }
            weigh(drawn);
            block.copy_out(&drawn.value, weight);
        }
        if let Some(pdf) = &mut draw.pdf {
            for (density, &power) in drawn.pdf.iter_mut().zip(&hits.power) {
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
            if has_factors {
                multiply(level, &|hit| source.factors(hit), hits.count, wo, wi, towards);
            }
            block.copy_out(&towards.value, value);
        }
    }
}

/// Divides values by their densities, as [`weight_of`](crate::mixture::rows::weight_of) does: without a branch, for vectors.
pub(crate) fn weigh(Sums { value, pdf }: &mut Sums) {
    for channel in value {
        for (value, &pdf) in channel.iter_mut().zip(&*pdf) {
            let weight = *value / if pdf >= LEAST_DENSITY { pdf } else { 1.0 };
            *value = if pdf >= LEAST_DENSITY { weight } else { 0.0 };
        }
    }
}

/// Multiplies values by their factors: all at once where the hits have the same.
pub(crate) fn multiply<'n>(
    level: Level,
    factors: &dyn Fn(usize) -> Nodes<'n>,
    count: usize,
    wo: &[Numbers; 3],
    wi: &[Numbers; 3],
    sums: &mut Sums,
) {
    let is_dark = |sums: &Sums, i: usize| sums.value.iter().all(|channel| channel[i] == 0.0);
    let first = factors(0);
    if (1..count).all(|i| first.is(&factors(i))) {
        if first.is_none() {
            return;
        }
        // A vector that is no direction may have a factor of NaN, and 0 times NaN is NaN.
        let (mut outgoing, mut incident) = (*wo, *wi);
        for i in 0..WIDEST {
            if sums.pdf[i] == 0.0 && is_dark(sums, i) {
                outgoing.iter_mut().chain(&mut incident).for_each(|component| component[i] = 0.5);
            }
        }
        multiply_pairs(level, &first, &outgoing, &incident, &mut sums.value);
        return;
    }
    for i in 0..count {
        let nodes = factors(i);
        if !nodes.is_none() && !is_dark(sums, i) {
            let pair = (&nodes, [wo[0][i], wo[1][i], wo[2][i]]);
            let factor = level.run_one::<_, Factor>(pair, [wi[0][i], wi[1][i], wi[2][i]]);
            for (channel, factor) in sums.value.iter_mut().zip(factor) {
                channel[i] *= factor;
            }
        }
    }
}

/// The factor towards a direction.
struct Factor;

impl One<(&Nodes<'_>, [f32; 3])> for Factor {
    type Output = [f32; 3];
    const IS_WIDE: bool = false;
    #[inline(always)]
    fn run<L: Lanes>((nodes, wo): (&Nodes<'_>, [f32; 3]), wi: [f32; 3]) -> [f32; 3] {
        nodes.towards::<L::One>(wo, wi).to_array()
    }
}
