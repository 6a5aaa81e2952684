//! Multiplies values by their factors, in vectors of directions.

use crate::mixture::factors::{Nodes, variables};
use crate::mixture::rows::Head;
use crate::simd::detect::Level;
use crate::simd::lanes::{Lanes, Numbers, WIDEST, splat3};
use crate::simd::routine::Routine;

/// Outgoing directions of a batch.
#[derive(Clone, Copy)]
enum Outgoing<'a> {
    /// The same for all.
    One([f32; 3]),
    /// One for each incident direction: in blocks of pairs.
    Each([&'a [f32]; 3]),
}

/// Multiplies values by their factors.
struct Multiply<'a, 'm> {
    nodes: &'a Nodes<'m>,
    wo: Outgoing<'a>,
    wi: [&'a [f32]; 3],
    value: [&'a mut [f32]; 3],
}

/// Vectors that are taken through a stage of the lookup before the next: the roots are a long chain of operations, each of which
/// waits for the one before. A processor sees no further than one vector's ahead. In stages it takes 0.7 of the time.
const STAGED: usize = 4;

impl Routine for Multiply<'_, '_> {
    type Output = ();
    #[inline(always)]
    #[allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices
    fn run<L: Lanes>(self) {
        let Self { nodes, wo, wi, value: [red, green, blue] } = self;
        let n = red.len();
        let mut staged = [[L::splat(0.0); 3]; STAGED];
        let mut from = 0;
        while from < n {
            let vectors = STAGED.min((n - from).div_ceil(L::COUNT));
            for i in 0..vectors {
                let at = from + i * L::COUNT;
                let count = L::COUNT.min(n - at);
                let incident =
                    [some::<L>(&wi[0][at..], count), some(&wi[1][at..], count), some(&wi[2][at..], count)];
                let outgoing = match wo {
                    Outgoing::One(wo) => splat3(wo),
                    Outgoing::Each(wo) => {
                        [some(&wo[0][at..], count), some(&wo[1][at..], count), some(&wo[2][at..], count)]
                    }
                };
                staged[i] = variables(outgoing, incident, nodes.has_azimuth());
            }
            for i in 0..vectors {
                staged[i] = nodes.places(staged[i]);
            }
            for i in 0..vectors {
                let at = from + i * L::COUNT;
                let count = L::COUNT.min(n - at);
                let factor = nodes.between(staged[i]);
                times(&mut red[at..], factor[0], count);
                times(&mut green[at..], factor[1], count);
                times(&mut blue[at..], factor[2], count);
            }
            from += vectors * L::COUNT;
        }
    }
}

/// The first `count` numbers of a slice, and harmless ones.
#[inline(always)]
fn some<L: Lanes>(from: &[f32], count: usize) -> L {
    if count == L::COUNT {
        return L::load(from);
    }
    let mut padded = [0.5; WIDEST];
    padded[..count].copy_from_slice(&from[..count]);
    L::load(&padded)
}

/// Multiplies the first `count` numbers of a slice.
#[inline(always)]
fn times<L: Lanes>(numbers: &mut [f32], by: L, count: usize) {
    if count == L::COUNT {
        (L::load(numbers) * by).store(numbers);
        return;
    }
    let mut padded = [0.0; WIDEST];
    by.store(&mut padded);
    for i in 0..count {
        numbers[i] *= padded[i];
    }
}

/// Multiplies the values of a block of pairs of an outgoing and an incident direction; there has to be a table.
pub(crate) fn multiply_pairs(
    level: Level,
    nodes: &Nodes<'_>,
    [wo_x, wo_y, wo_z]: &[Numbers; 3],
    [wi_x, wi_y, wi_z]: &[Numbers; 3],
    [red, green, blue]: &mut [Numbers; 3],
) {
    let wo = Outgoing::Each([wo_x, wo_y, wo_z]);
    level.run(Multiply { nodes, wo, wi: [wi_x, wi_y, wi_z], value: [red, green, blue] });
}

impl Head<'_> {
    /// Multiplies values towards n directions by their factors.
    pub(crate) fn multiply(&self, wi: [&[f32]; 3], value: [&mut [f32]; 3]) {
        let wo = Outgoing::One(self.factors.wo);
        self.level.run(Multiply { nodes: &self.factors.nodes, wo, wi, value });
    }
}
