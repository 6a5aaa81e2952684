//! Makes the table of a map: colours, then powers, then who goes where.

use super::look_up::corner_luminances;
use super::table::{
    COLORS, Cell, Colors, Environment, LARGEST_CODE, MAGIC, PLACE, Row, Shape, THRESHOLD, WORDS, checksum,
    environment_len,
};
use crate::error::Error;
use core::f64::consts::{PI, TAU};

/// Largest radiance that a map may have: no sum of it overflows.
const MAX_RADIANCE: f32 = 1e30;

/// A cell whose brightest channel is less than this of the brightest of the map is black. Products with smaller radiances would be
/// subnormals, or 0: where draws end, a cell has at least 2^-26 of its smallest code.
const LEAST_RELATIVE: f64 = 1e-22;

/// Smallest power that is not black: its inverse is a finite number.
const LEAST_POWER: f64 = 1e-30;

impl<M: AsRef<[u32]> + AsMut<[u32]>> Environment<M> {
    /// Makes the table of a map of radiance in `memory`, of at least [`environment_len`] words of any value.
    /// It takes about 0.1 us a pixel.
    ///
    /// Shapes: `radiance` linear sRGB, the top row first, `[width height]`. Range: each channel in [0, 1e30].
    ///
    /// # Errors
    /// [`Error::MapSize`] for a width and a number of pixels that are no map; [`Error::Radiance`] for a value out of range, NaN
    /// too; [`Error::BlackMap`] for a power below 1e-30; [`Error::Memory`] for too little memory, in which nothing is written then.
    pub fn new(width: usize, radiance: &[[f32; 3]], mut memory: M) -> Result<Self, Error> {
        let words = memory.as_mut();
        let start = words.as_ptr().align_offset(4 * WORDS).min(WORDS - 1);
        let (shape, power) = fill(width, radiance, start, words)?;
        Ok(Self::of_table(memory, start, shape, power))
    }
}

/// Makes a table that begins at a word.
fn fill(width: usize, radiance: &[[f32; 3]], start: usize, words: &mut [u32]) -> Result<(Shape, f32), Error> {
    if width == 0 || !radiance.len().is_multiple_of(width) {
        return Err(Error::MapSize);
    }
    let shape = Shape::new(width, radiance.len() / width)?;
    let fits = |pixel: &[f32; 3]| pixel.iter().all(|v| (0.0..=MAX_RADIANCE).contains(v));
    if let Some(pixel) = radiance.iter().position(|pixel| !fits(pixel)) {
        return Err(Error::Radiance { column: pixel % width, row: pixel / width });
    }
    let (needed, available) = (environment_len(shape.width, shape.height)?, words.len());
    if available < needed {
        return Err(Error::Memory { needed, available });
    }
    let largest = radiance.as_flattened().iter().fold(0.0, |a: f32, &b| a.max(b));
    if largest <= 0.0 {
        return Err(Error::BlackMap);
    }

    let (chunks, _) = words[start..][..shape.words()].as_chunks_mut::<WORDS>();
    let (rows, cells) = chunks[1..].split_at_mut(shape.row_chunks());
    rows.as_flattened_mut().fill(0);
    let (rows, _) = rows.as_flattened_mut().as_chunks_mut::<4>();
    for (index, row) in rows.iter_mut().take(shape.rows()).enumerate() {
        *row = row_of(shape, index);
    }
    let rows = &*rows;
    for (index, cell) in cells.iter_mut().enumerate() {
        let (row, column) = (index / width, index % width);
        let right = if column + 1 < width { column + 1 } else { 0 };
        let [upper, lower] =
            [row.saturating_sub(1), row.min(shape.height - 1)].map(|row| &radiance[row * width..][..width]);
        *cell = colored([upper[column], upper[right], lower[column], lower[right]], largest);
    }

    // The powers are those of the codes, so that the density integrates to 1 as it is read.
    let total: f64 = cells.iter().enumerate().map(|(i, cell)| power(shape, rows, i, cell)).sum();
    let map_power = total * f64::from(largest);
    if map_power < LEAST_POWER {
        return Err(Error::BlackMap);
    }
    for cell in cells.iter_mut() {
        cell[0] = ((f64::from(f32::from_bits(cell[0])) / total) as f32).to_bits();
    }
    share_out(shape, rows, cells);
    let power = map_power as f32;
    let (head, rest) = words[start..][..shape.words()].split_at_mut(WORDS);
    let [low, high] = checksum(shape, power, rest);
    head.fill(0);
    head[..6].copy_from_slice(&[MAGIC, shape.width as u32, shape.height as u32, power.to_bits(), low, high]);
    Ok((shape, power))
}

/// The edges of a row of cells, counted from a pole: centres of pixels, or the pole.
pub(super) fn row_of(shape: Shape, index: usize) -> Row {
    let angle = |row: usize| (row as f64 - 0.5).max(0.0) * PI / shape.height as f64;
    let [upper, lower] = [angle(index), angle(index + 1)];
    let half_sine = libm::sin(0.5 * upper);
    let edge = 2.0 * half_sine * half_sine;
    // cos upper - cos lower, without cancellation.
    let height = 2.0 * libm::sin(0.5 * (upper + lower)) * libm::sin(0.5 * (lower - upper));
    [(edge as f32).to_bits(), (height as f32).to_bits(), ((1.0 / height) as f32).to_bits(), 0]
}

/// Solid angle of a cell.
fn solid_angle(shape: Shape, rows: &[Row], index: usize) -> f64 {
    let row = index / shape.width;
    let from_pole = if row > shape.height / 2 { shape.height - row } else { row };
    let [_, height, ..] = rows[from_pole];
    f64::from(f32::from_bits(height)) * TAU / shape.width as f64
}

/// A cell between four pixels, which keeps its colours over the largest radiance.
fn colored(corners: [[f32; 3]; 4], largest: f32) -> Cell {
    let brightest = corners.as_flattened().iter().fold(0.0, |a: f32, &b| a.max(b));
    let mut cell = [0; WORDS];
    cell[THRESHOLD] = 1f32.to_bits();
    let relative = f64::from(brightest) / f64::from(largest);
    if relative < LEAST_RELATIVE {
        return cell;
    }
    let code = |value: f32| {
        let code = f64::from(value) / f64::from(brightest) * f64::from(LARGEST_CODE) + 0.5;
        u32::from(code as u16)
    };
    cell[0] = ((relative / f64::from(LARGEST_CODE)) as f32).to_bits();
    for channel in 0..3 {
        let [a, b, c, d] = corners.map(|corner| code(corner[channel]));
        // Two codes in a word, as a `[u16; 2]` has them in memory.
        let pair = |a: u32, b: u32| bytemuck::cast::<[u16; 2], u32>([a as u16, b as u16]);
        cell[1 + 2 * channel] = pair(a, b);
        cell[2 + 2 * channel] = pair(c, d);
    }
    cell
}

/// Integral of the luminance over a cell.
pub(super) fn power(shape: Shape, rows: &[Row], index: usize, cell: &Cell) -> f64 {
    let colors = Colors::new(cell, false);
    let sum: f64 = corner_luminances(colors.codes).into_iter().map(f64::from).sum();
    0.25 * sum * f64::from(colors.scale) * solid_angle(shape, rows, index)
}

/// Shares the draws out: each cell is hit as often as any other, and hands its surplus of draws to one that has too few.
///
/// Walker's alias table (1977), swept over in one pass without lists of the light and the heavy
/// (Hübschle-Schneider and Sanders 2019, section 4.1): a cell of less than the mean is filled up by the
/// current heavy one; a heavy one that has given so much that it is light is filled up by the next.
fn share_out(shape: Shape, rows: &[Row], cells: &mut [Cell]) {
    let count = cells.len();
    // In units of the mean.
    let weight = |cells: &[Cell], i: usize| power(shape, rows, i, &cells[i]) * count as f64;
    let following = |cells: &[Cell], from: usize, is_heavy: bool| {
        (from..count).find(|&i| (weight(cells, i) > 1.0) == is_heavy).unwrap_or(count)
    };
    for index in 0..count {
        hand_on(shape, cells, index, 1.0, index);
    }
    let mut light = following(cells, 0, false);
    let mut heavy = following(cells, 0, true);
    let mut left = if heavy < count { weight(cells, heavy) } else { 0.0 };
    // No heavy one: all are alike, and keep their draws.
    while heavy < count {
        if left > 1.0 {
            if light == count {
                break;
            }
            let share = weight(cells, light);
            hand_on(shape, cells, light, share, heavy);
            left -= 1.0 - share;
            light = following(cells, light + 1, false);
        } else {
            let next = following(cells, heavy + 1, true);
            if next == count {
                break;
            }
            hand_on(shape, cells, heavy, left, next);
            left += weight(cells, next) - 1.0;
            heavy = next;
        }
    }
    // Rounding may leave light ones: they are filled up by the last.
    while heavy < count && light < count {
        let share = weight(cells, light);
        hand_on(shape, cells, light, share, heavy);
        light = following(cells, light + 1, false);
    }
    for index in 0..count {
        let other = other(shape, &cells[index]);
        let (from, to) = (cells[other], &mut cells[index]);
        to[COLORS..2 * COLORS].copy_from_slice(&from[..COLORS]);
    }
}

/// Lets a cell keep a share of its draws, and hand the others on.
fn hand_on(shape: Shape, cells: &mut [Cell], index: usize, share: f64, other: usize) {
    cells[index][PLACE] = (((other / shape.width) << 16) | (other % shape.width)) as u32;
    cells[index][THRESHOLD] = (share.min(1.0) as f32).to_bits();
}

/// The cell that one hands on to; any number for a place outside.
pub(super) fn other(shape: Shape, cell: &Cell) -> usize {
    (cell[PLACE] >> 16) as usize * shape.width + (cell[PLACE] & 0xffff) as usize
}
