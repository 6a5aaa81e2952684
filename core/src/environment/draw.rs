//! Draws directions from an environment: a cell by its power, a place in it by the luminance there.

use super::look_up::{between, corner_luminances};
use super::table::{Colors, Environment, PLACE, THRESHOLD, Table};
use crate::color::luminance;
use crate::float::BELOW_ONE;
use crate::simd::elementary::sin_cos_turns;
use crate::simd::lanes::Lanes;
use glam::Vec3;

/// A direction drawn from an environment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvironmentSample {
    /// Unit vector in the world, towards the light.
    pub direction: Vec3,
    /// Density at the direction, above 0 whatever the numbers were; 1/sr.
    pub pdf: f32,
    /// Radiance from there, linear sRGB: over the density, its luminance is the
    /// [`power`](Environment::power).
    pub radiance: Vec3,
}

impl<M: AsRef<[u32]>> Environment<M> {
    /// Draws a direction by the luminance of its radiance, with three uniform numbers in [0, 1).
    ///
    /// The first two choose the cell and the height in it, the third the azimuth. Of the first two all digits
    /// count: 24 bits of one are not enough for a map of millions of pixels.
    #[inline]
    pub fn sample(&self, u: [f32; 3]) -> EnvironmentSample {
        let table = self.borrowed();
        let (hit, left) = table.hit([u[0], u[1]]);
        let chosen = table.choose(hit, left);
        let [across, down] = within(chosen.luminances, chosen.left, u[2]);
        let direction = Vec3::from_array(table.direction([across, down], chosen.place));
        let colors = Colors::new(&table.cells[hit], chosen.is_other);
        let relative = Vec3::from_array(between(colors, across, down));
        EnvironmentSample { direction, pdf: luminance(relative), radiance: relative * table.power }
    }

    /// Draws a direction of one cell by the luminance there, with two uniform numbers in [0, 1): the first is the
    /// height, the second the azimuth. For who finds cells in an order of his own, each as often as its
    /// [`share`](crate::EnvironmentCell::share): then it has the density of [`sample`](Self::sample), which it
    /// gives.
    ///
    /// `None` for a cell without light, and from [`cell_count`](Self::cell_count) on.
    #[inline]
    pub fn sample_cell(&self, cell: usize, u: [f32; 2]) -> Option<EnvironmentSample> {
        let table = self.borrowed();
        let colors = Colors::new(table.cells.get(cell)?, false);
        let luminances = corner_luminances(colors.codes);
        let has_light = luminances[0] + luminances[1] + luminances[2] + luminances[3] > 0.0;
        let place = table.place_of(cell);
        let [across, down] = within(luminances, u[0].min(BELOW_ONE), u[1]);
        let direction = Vec3::from_array(table.direction([across, down], place));
        let relative = Vec3::from_array(between(colors, across, down));
        let sample =
            EnvironmentSample { direction, pdf: luminance(relative), radiance: relative * table.power };
        has_light.then_some(sample)
    }

    /// Asks the processor for what [`sample_cell`](Self::sample_cell) will read. Changes no result.
    #[inline]
    pub fn prefetch_cell(&self, cell: usize) {
        let table = self.borrowed();
        table.prefetch(cell.min(table.cells.len() - 1));
    }

    /// Asks the processor for what [`sample`](Self::sample) will read of the map for these numbers, which is in
    /// no cache if the map is large: ask before other work of some ten nanoseconds, such as
    /// [`prepare`](crate::Material::prepare). Changes no result.
    #[inline]
    pub fn prefetch(&self, u: [f32; 3]) {
        let table = self.borrowed();
        let (hit, _) = table.hit([u[0], u[1]]);
        table.prefetch(hit);
    }
}

/// A cell that was drawn.
#[derive(Clone, Copy)]
pub(super) struct Chosen {
    /// The other of the cell that was hit.
    pub is_other: bool,
    /// The remainder of the uniform number, which is uniform too.
    pub left: f32,
    /// Of its corners.
    pub luminances: [f32; 4],
    /// Its middle, in columns; depth `1 - |z|` of the edge that is nearer to the pole, and how much deeper
    /// the other is; 1 above the equator, -1 below.
    pub place: [f32; 4],
}

impl Table<'_> {
    /// The cell that two uniform numbers hit, and their remainders.
    #[inline(always)]
    pub(super) fn hit(&self, u: [f32; 2]) -> (usize, f32) {
        let place = (f64::from(u[0]) + f64::from(u[1]) * (1.0 / 16_777_216.0)) * self.cells.len() as f64;
        let hit = (place as u32 as usize).min(self.cells.len() - 1);
        (hit, (place - hit as f64) as f32)
    }

    /// The cell that was hit, or its other.
    #[inline(always)]
    pub(super) fn choose(&self, hit: usize, left: f32) -> Chosen {
        let cell = &self.cells[hit];
        let threshold = f32::from_bits(cell[THRESHOLD]);
        let is_other = left >= threshold;
        let (row, column) = if is_other {
            ((cell[PLACE] >> 16) as usize, (cell[PLACE] & 0xffff) as usize)
        } else {
            self.row_and_column(hit)
        };
        let [more, of] = if is_other { [left - threshold, 1.0 - threshold] } else { [left, threshold] };
        Chosen {
            is_other,
            left: (more / of).min(BELOW_ONE),
            luminances: corner_luminances(Colors::new(cell, is_other).codes),
            place: self.place(row, column),
        }
    }

    /// The row and the column of a cell.
    #[inline(always)]
    fn row_and_column(&self, cell: usize) -> (usize, usize) {
        // Below 2^26, so that the quotient is right but for whole ones, which a half takes care of.
        let row = ((cell as f64 + 0.5) * (1.0 / self.shape.width as f64)) as u32 as usize;
        (row, cell - row * self.shape.width)
    }

    /// Where a cell lies, as [`Chosen`] has it.
    #[inline(always)]
    fn place_of(&self, cell: usize) -> [f32; 4] {
        let (row, column) = self.row_and_column(cell);
        self.place(row, column)
    }

    /// Where the cell of a row and a column lies.
    #[inline(always)]
    fn place(&self, row: usize, column: usize) -> [f32; 4] {
        let is_south = row > self.shape.height / 2;
        let from_pole = if is_south { self.shape.height - row } else { row };
        let [edge, rise, ..] = self.rows[from_pole.min(self.rows.len() - 1)];
        let side = if is_south { -1.0 } else { 1.0 };
        [column as f32 + 0.5, f32::from_bits(edge), f32::from_bits(rise), side]
    }

    /// Directions of places in cells that were chosen.
    #[inline(always)]
    pub(super) fn direction<L: Lanes>(
        &self,
        [across, down]: [L; 2],
        [middle, edge, rise, side]: [L; 4],
    ) -> [L; 3] {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let right = (middle + across) * L::splat(1.0 / self.shape.width as f32);
        let turns = L::splat(0.5 + self.turn) - right;
        let turns = L::select(turns.lt(zero), turns + one, turns);
        let turns = L::select(one.lt(turns), turns - one, turns);
        let (sin, cos) = sin_cos_turns(turns);
        let from_edge = L::select(side.lt(zero), one - down, down);
        // At a pole there would be no azimuth any more, which the light there depends on.
        let depth = rise.mul_add(from_edge, edge).max(L::splat(1e-30));
        let radius = (depth * (L::splat(2.0) - depth)).max(zero).sqrt();
        [radius * cos, radius * sin, side * (one - depth)]
    }
}

/// Draws places in cells by the luminance there, which is bilinear: how far to the right, and how far down,
/// with two uniform numbers.
#[inline(always)]
pub(super) fn within<L: Lanes>([a, b, c, d]: [L; 4], left: L, u: L) -> [L; 2] {
    let down = linear(a + b, c + d, left);
    [linear(down.mul_add(c - a, a), down.mul_add(d - b, b), u), down]
}

/// What stands for a uniform number below: such a number is one of all those that round to it. At 0 itself a draw would end at an
/// edge without light, where the density is 0.
pub(super) const LEAST_UNIFORM: f32 = 1.0 / (1 << 26) as f32;

/// Inverts the distribution on [0, 1] whose density goes linearly from `from` to `to`, which are not
/// negative.
///
/// The density is above 0 at the result, if it is anywhere: the result keeps a distance from an end whose density is 0. From
/// `from` it is at least the root of [`LEAST_UNIFORM`], from `to` that of the distance of `u` from 1, at least 2^-24.
#[inline(always)]
fn linear<L: Lanes>(from: L, to: L, u: L) -> L {
    let u = u.max(L::splat(LEAST_UNIFORM));
    // The root of u = x (2 from + x (to - from)) / (from + to), without cancellation.
    let squared = from * from;
    let root = u.mul_add(to.mul_add(to, L::splat(0.0) - squared), squared).max(L::splat(0.0)).sqrt();
    let x = u * (from + to) / (from + root).max(L::splat(1e-30));
    x.min(L::splat(1.0))
}
