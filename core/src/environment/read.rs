//! Reads a table that was stored: everything is checked once, and trusted from then on.

use super::make::{other, power, row_of};
use super::table::{COLORS, Cell, Environment, MAGIC, PLACE, Shape, THRESHOLD, WORDS, checksum};
use crate::error::Error;

/// How far from 1 the density may integrate.
const ROUNDING: f64 = 1e-5;

impl<M: AsRef<[u32]>> Environment<M> {
    /// Takes a table that [`table`](Self::table) gave, on a processor of the same byte order, after checking
    /// it once. It is the fastest at a multiple of 64 bytes. Bytes of a file, at a multiple of four, are
    /// words by `bytemuck::try_cast_slice`.
    ///
    /// # Errors
    /// [`Error::Table`] for what is none, damaged, or of another length.
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
    let total: f64 =
        table.cells.iter().enumerate().map(|(i, cell)| self::power(shape, table.rows, i, cell)).sum();
    ((total - 1.0).abs() <= ROUNDING).then_some((shape, power))
}

/// Whether a cell can be drawn from: its numbers are such, and the other's colours are those of the cell that
/// it names.
fn is_sound(shape: Shape, cell: &Cell, cells: &[Cell]) -> bool {
    let (scale, threshold) = (f32::from_bits(cell[0]), f32::from_bits(cell[THRESHOLD]));
    let is_place = (cell[PLACE] & 0xffff) < shape.width as u32 && (cell[PLACE] >> 16) <= shape.height as u32;
    scale.is_finite()
        && scale >= 0.0
        && (0.0..=1.0).contains(&threshold)
        && is_place
        && cells[other(shape, cell)][..COLORS] == cell[COLORS..2 * COLORS]
}
