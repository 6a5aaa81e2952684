//! The radiance of a direction: its place among the cells, and the radiance of the cell there.
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use super::table::{Colors, Environment, Table};
use crate::color::{LUMINANCE, luminance};
use crate::simd::elementary::atan2_positive;
use crate::simd::lanes::{Lanes, ROUND, dot3, splat3};
use core::f32::consts::{FRAC_1_PI, PI};
use glam::Vec3;

impl<M: AsRef<[u32]>> Environment<M> {
    /// The radiance from a direction, a unit vector in the world; in the unit of the map, linear sRGB.
    #[inline]
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        let table = self.borrowed();
        Vec3::from_array(table.towards(direction.to_array())) * table.power
    }

    /// The density of [`sample`](Self::sample) towards a direction; 1/sr.
    #[inline]
    pub fn pdf(&self, direction: Vec3) -> f32 {
        luminance(Vec3::from_array(self.borrowed().towards(direction.to_array())))
    }

    /// Radiance and density in one look.
    #[inline]
    pub fn radiance_and_pdf(&self, direction: Vec3) -> (Vec3, f32) {
        let table = self.borrowed();
        let relative = Vec3::from_array(table.towards(direction.to_array()));
        (relative * table.power, luminance(relative))
    }
}

/// Where a direction lies among the cells.
#[derive(Clone, Copy)]
pub(super) struct Place<L> {
    /// The column of cells, as the low bits of a float ([`whole`]), and how far to the right in it.
    pub column: L,
    pub across: L,
    /// The row of cells from the nearest pole, likewise, and the depth `1 - |z|`.
    pub row: L,
    pub depth: L,
}

/// The whole number, up to 2^22, that was added to [`ROUND`], at most `last`: whatever the float is.
#[inline(always)]
pub(super) fn whole(number: f32, last: usize) -> usize {
    ((number.to_bits() & 0x3f_ffff) as usize).min(last)
}

/// Adds a whole number to [`ROUND`]: the one below a number that is not negative; at a whole number that may
/// be the one before; at most `last`.
#[inline(always)]
fn below<L: Lanes>(number: L, last: usize) -> L {
    (number - L::splat(0.5)).max(L::splat(0.0)).min(L::splat(last as f32)) + L::splat(ROUND)
}

/// The place of directions. Polynomials: the turn is off by at most 3e-7 relative and what its sum with a
/// half rounds, and so is the row; which of two cells is named at their edge does not matter, as they agree
/// there.
#[inline(always)]
pub(super) fn place<L: Lanes>(table: &Table<'_>, [x, y, z]: [L; 3]) -> Place<L> {
    let (zero, one, tiny) = (L::splat(0.0), L::splat(1.0), L::splat(1e-30));
    let (width, height) = (table.shape.width as f32, table.shape.height as f32);
    let squared = x.mul_add(x, y * y);
    let up = z.abs();
    let from_pole = atan2_positive(squared.sqrt(), up.max(tiny));
    let aside = atan2_positive(y.abs(), x.abs().max(tiny));
    let azimuth = L::select(x.lt(zero), L::splat(PI) - aside, aside).copy_sign(y);

    let turns = azimuth.neg_mul_add(L::splat(0.5 * FRAC_1_PI), L::splat(0.5 + table.turn));
    let turns = L::select(turns.ge(one), turns - one, turns);
    let right = turns.mul_add(L::splat(width), L::splat(-0.5));
    let right = L::select(right.lt(zero), right + L::splat(width), right);
    let column = below(right, table.shape.width - 1);
    let row = from_pole.mul_add(L::splat(height * FRAC_1_PI), L::splat(0.5));
    let row = below(row, table.shape.rows() - 1);
    Place { column, across: right - (column - L::splat(ROUND)), row, depth: squared / (one + up) }
}

impl Table<'_> {
    /// Radiance over the power from one direction; 1/sr.
    #[inline(always)]
    pub(super) fn towards(&self, direction: [f32; 3]) -> [f32; 3] {
        let place = place(self, direction);
        let (cell, down) = self.cell(place, direction[2]);
        between(Colors::new(&self.cells[cell], false), place.across, down)
    }

    /// The cell of a place, of a direction of height z, and how far down in it.
    #[inline(always)]
    pub(super) fn cell(&self, place: Place<f32>, z: f32) -> (usize, f32) {
        let column = whole(place.column, self.shape.width - 1);
        let row = whole(place.row, self.shape.rows() - 1);
        let [edge, _, inverse, _] = self.rows[row];
        let down = (place.depth - f32::from_bits(edge)) * f32::from_bits(inverse);
        let down = down.clamp(0.0, 1.0);
        let (row, down) = if z < 0.0 { (self.shape.height - row, 1.0 - down) } else { (row, down) };
        (row * self.shape.width + column, down)
    }
}

/// The radiance of a cell that far to the right and down in it.
#[inline(always)]
pub(super) fn between(colors: Colors<'_>, across: f32, down: f32) -> [f32; 3] {
    let upper = (1.0 - down) * colors.scale;
    let lower = down * colors.scale;
    let weights = [(1.0 - across) * upper, across * upper, (1.0 - across) * lower, across * lower];
    let mut color = [0.0; 3];
    for channel in 0..3 {
        let mut terms = weights;
        for corner in 0..4 {
            terms[corner] *= f32::from(colors.codes[channel][corner]);
        }
        color[channel] = (terms[0] + terms[1]) + (terms[2] + terms[3]);
    }
    color
}

/// The luminance of a cell at its corners, in units of its scale.
#[inline(always)]
pub(super) fn corner_luminances(codes: &[[u16; 4]; 3]) -> [f32; 4] {
    let mut sum = [0.0; 4];
    for channel in 0..3 {
        for corner in 0..4 {
            sum[corner] += LUMINANCE[channel] * f32::from(codes[channel][corner]);
        }
    }
    sum
}

/// Luminance of every lane.
#[inline(always)]
pub(super) fn luminances<L: Lanes>(color: [L; 3]) -> L {
    dot3(color, splat3(LUMINANCE))
}
