//! Blocks of samples of the light, which are drawn once and serve all pixels.

use super::Environment;
use crate::numbers::random::Random;
use srbf_core::{EnvironmentSample, LIGHT_BLOCK, LightBlock};

/// Blocks of a tile: the points of one Sobol sequence, 0.5 MB, which the caches of a core hold.
pub const BLOCKS: usize = 1024;

/// Blocks of samples, those of one scrambled sequence in its order: any 2^k that follow each other on a multiple of that lie evenly.
///
/// A pixel that has taken every block once has seen all that a tile knows of the light. From there on it needs another.
pub struct LightTile {
    blocks: Vec<LightBlock>,
}

impl LightTile {
    /// Draws `blocks` blocks of the tile of a seed, the `number`-th.
    pub fn new(environment: &Environment, seed: u64, number: u64, blocks: usize) -> Self {
        let key = Random::new(seed, u64::from_le_bytes(*b"the tile"), number).key() as u32;
        let sample = |i: usize| {
            let [u, v, ..] = sobol_burley::sample_4d(i as u32, 0, key);
            let drawn = environment.sample_place(environment.ordered_place([u, v]));
            EnvironmentSample { direction: drawn.direction, pdf: drawn.pdf, radiance: drawn.radiance }
        };
        let block = |b: usize| LightBlock::of(|i| sample(b * LIGHT_BLOCK + i));
        Self { blocks: (0..blocks).map(block).collect() }
    }

    /// One of the blocks; behind the last comes the first.
    #[inline]
    pub fn block(&self, index: usize) -> &LightBlock {
        &self.blocks[index % self.blocks.len()]
    }
}
