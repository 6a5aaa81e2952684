//! Reads a table that was stored: everything is checked once, and trusted from then on.

use super::look_up::corner_luminances;
use super::make::{other, power, row_of};
use super::table::{COLORS, Cell, Colors, Environment, MAGIC, PLACE, Shape, THRESHOLD, WORDS, checksum};
use crate::error::Error;

/// How far from 1 the density may integrate.
const ROUNDING: f64 = 1e-5;

impl<M: AsRef<[u32]>> Environment<M> {
    /// Takes a table that [`table`](Self::table) gave, on a processor of the same byte order, after checking
    /// it once. It is the fastest at a multiple of 64 bytes. Bytes of a file, at a multiple of four, are
    /// words by `bytemuck::try_cast_slice`.
    ///
    /// # Errors
    /// [`Error::Table`] for words that are no table, are damaged or of another length, or draw cells otherwise than by their power.
    pub fn from_table(table: M) -> Result<Self, Error> {
        let (shape, power) = check(table.as_ref()).ok_or(Error::Table)?;
        Ok(Self::of_table(table, 0, shape, power))
    }
}

/// The size and the power of the map of a sound table.
fn check(words: &[u32]) -> Option<(Shape, f32)> {
    let &[magic, width, height, power, low, high, ..] = words else { return None };
    let shape = Shape::new(width as usize, height as usize).ok()?;
    let power = f32::from_bits(power);
    if magic != MAGIC || words.len() != shape.words() || !(power > 0.0 && power.is_finite()) {
        return None;
    }
    if checksum(shape, power, &words[WORDS..]) != [low, high] {
        return None;
    }
    let unchecked = Environment::of_table(words, 0, shape, power);
    let table = unchecked.borrowed();
    let are_rows = table.rows.iter().enumerate().all(|(i, row)| *row == row_of(shape, i));
    let are_cells = || table.cells.iter().all(|cell| is_sound(shape, cell, table.cells));
    if !are_rows || !are_cells() {
        return None;
    }
    let (mut total, mut apart) = (0.0, 0.0);
    for (i, cell) in table.cells.iter().enumerate() {
        let power = self::power(shape, table.rows, i, cell);
        total += power;
        let stays = f64::from(f32::from_bits(cell[THRESHOLD]));
        let [own, others] = [i, other(shape, cell)].map(mark);
        apart += own * (power * table.cells.len() as f64 - stays) - others * (1.0 - stays);
    }
    let is_whole = (total - 1.0).abs() <= ROUNDING;
    (is_whole && apart.abs() <= allowed_apart(table.cells.len(), total)).then_some((shape, power))
}

/// How far apart the two sides of the sum over the shares may be, of a table of that many cells and that total.
///
/// Thresholds are rounded to f32, at random; and one cell takes up the difference of the total.
fn allowed_apart(cells: usize, total: f64) -> f64 {
    let cells = cells as f64;
    THRESHOLDS * (10.0 + libm::sqrt(cells)) + 1.1 * cells * (total - 1.0).abs()
}

/// Several times what rounding moves a threshold by.
const THRESHOLDS: f64 = 3e-7;

/// A number of a cell in [0, 1), as good as random.
///
/// A check of each cell would take the sum of the draws that are handed on to it, and memory for all of these sums. One sum of
/// all, each cell multiplied by its own number, needs none: draws that do not fit the powers change it, unless they are made to
/// suit these numbers (Freivalds 1977, of products of matrices).
fn mark(cell: usize) -> f64 {
    let mut z = (cell as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// Whether a cell can be drawn from: its numbers are such, and the other's colours are those of the cell that
/// it names.
fn is_sound(shape: Shape, cell: &Cell, cells: &[Cell]) -> bool {
    let (scale, threshold) = (f32::from_bits(cell[0]), f32::from_bits(cell[THRESHOLD]));
    let is_place = (cell[PLACE] & 0xffff) < shape.width as u32 && (cell[PLACE] >> 16) <= shape.height as u32;
    // A draw ends in a cell with light: the cell if it keeps anything, and its other, which rounding may lead to.
    scale.is_finite()
        && scale >= 0.0
        && (0.0..=1.0).contains(&threshold)
        && is_place
        && cells[other(shape, cell)][..COLORS] == cell[COLORS..2 * COLORS]
        && (threshold == 0.0 || has_light(Colors::new(cell, false)))
        && has_light(Colors::new(cell, true))
}

/// Whether the density is above 0 within a cell, and is in f32 at every place that is drawn.
fn has_light(colors: Colors<'_>) -> bool {
    colors.scale >= LEAST_SCALE && corner_luminances(colors.codes).into_iter().any(|corner| corner > 0.0)
}

/// The scale of the darkest cell that is made is above: 1e-22, over the largest code and 4 pi.
const LEAST_SCALE: f32 = 1e-28;
