//! How the draws of an environment are shared out among its cells: for who chooses cells in an order of his own.

use super::make::{other, power};
use super::table::{Environment, THRESHOLD};

/// A cell between four pixels, as [`sample`](Environment::sample) draws from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvironmentCell {
    /// Its part of all draws: of the [`power`](Environment::power).
    pub share: f64,
    /// The part of the draws that hit it which stays in it, in [0, 1]; each cell is hit as often as any other.
    pub kept: f32,
    /// The cell that the rest of them goes to.
    pub other: usize,
}

impl<M: AsRef<[u32]>> Environment<M> {
    /// How many cells there are: one more row than the map has. The first is in the top row, on the left.
    pub fn cell_count(&self) -> usize {
        self.borrowed().cells.len()
    }

    /// A cell by its number.
    ///
    /// The first two numbers of [`sample`](Self::sample), the second over 2^24 added to the first, are multiplied by the number of
    /// cells. The whole part is the cell that is hit, the fraction a place in [0, 1): below [`kept`](EnvironmentCell::kept) the
    /// draw stays, and from there on it goes to the other. The place within its part, 0 to 1, then gives the height in the cell,
    /// by the luminance there.
    ///
    /// `None` from [`cell_count`](Self::cell_count) on.
    pub fn cell(&self, index: usize) -> Option<EnvironmentCell> {
        let table = self.borrowed();
        let cell = table.cells.get(index)?;
        Some(EnvironmentCell {
            share: power(table.shape, table.rows, index, cell),
            kept: f32::from_bits(cell[THRESHOLD]),
            other: other(table.shape, cell),
        })
    }
}
