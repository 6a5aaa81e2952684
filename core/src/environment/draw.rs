//! Draws directions from an environment: a cell by its power, a place in it by the luminance there.

use super::look_up::{between, corner_luminances};
use super::table::{Colors, Environment, PLACE, THRESHOLD, Table};
use crate::color::luminance;
use crate::float;
use crate::simd::elementary::sin_cos_turns;
use crate::simd::lanes::Lanes;
use glam::Vec3;

/// A direction drawn from an environment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvironmentSample {
    /// Unit vector in the world, towards the light.
    pub direction: Vec3,
    /// Density at the direction; 1/sr.
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
        let drawn = table.draw(u);
        let direction = Vec3::from_array(direction([drawn.turns, drawn.depth, drawn.side]));
        let relative = Vec3::from_array(drawn.light);
        EnvironmentSample { direction, pdf: luminance(relative), radiance: relative * table.power }
    }
}

/// A direction before its sines are worked out.
#[derive(Clone, Copy)]
pub(super) struct Drawn {
    /// Azimuth, in turns, in [0, 1].
    pub turns: f32,
    /// `1 - |z|`; beyond the equator it is above 1.
    pub depth: f32,
    /// 1 above the equator, -1 below.
    pub side: f32,
    /// Radiance over the power.
    pub light: [f32; 3],
}

/// Directions of azimuth, depth and side.
#[inline(always)]
pub(super) fn direction<L: Lanes>([turns, depth, side]: [L; 3]) -> [L; 3] {
    let (sin, cos) = sin_cos_turns(turns);
    let radius = (depth * (L::splat(2.0) - depth)).max(L::splat(0.0)).sqrt();
    [radius * cos, radius * sin, side * (L::splat(1.0) - depth)]
}

/// The largest f32 below 1.
const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

impl Table<'_> {
    /// Draws by three uniform numbers.
    #[inline(always)]
    pub(super) fn draw(&self, u: [f32; 3]) -> Drawn {
        // A cell, and what is left of the numbers, which is uniform again.
        let place = (f64::from(u[0]) + f64::from(u[1]) * (1.0 / 16_777_216.0)) * self.cells.len() as f64;
        let hit = (place as u32 as usize).min(self.cells.len() - 1);
        let left = (place - hit as f64) as f32;
        let cell = &self.cells[hit];
        let threshold = f32::from_bits(cell[THRESHOLD]);
        let is_other = left >= threshold;
        let (row, column) = if is_other {
            ((cell[PLACE] >> 16) as usize, (cell[PLACE] & 0xffff) as f32)
        } else {
            // Below 2^26, so that the quotient is right but for whole ones, which a half takes care of.
            let row = ((hit as f64 + 0.5) * (1.0 / self.shape.width as f64)) as u32 as usize;
            (row, (hit - row * self.shape.width) as f32)
        };
        let left =
            if is_other { (left - threshold) / (1.0 - threshold) } else { left / threshold }.min(BELOW_ONE);

        // A place in it, by the luminance, which is bilinear: first how far down, then how far to the right.
        let colors = Colors::new(cell, is_other);
        let [a, b, c, d] = corner_luminances(colors.codes);
        let down = linear(a + b, c + d, left);
        let across = linear(a + down * (c - a), b + down * (d - b), u[2]);

        let height = self.shape.height;
        let is_south = row > height / 2;
        let (row, from_edge) = if is_south { (height - row, 1.0 - down) } else { (row, down) };
        let [edge, rise, ..] = self.rows[row.min(self.rows.len() - 1)];
        let depth = f32::from_bits(edge) + from_edge * f32::from_bits(rise);
        let right = (column + 0.5 + across) * (1.0 / self.shape.width as f32);
        let turns = (0.5 + self.turn) - right;
        let turns = if turns < 0.0 { turns + 1.0 } else { turns };
        let turns = if turns > 1.0 { turns - 1.0 } else { turns };
        let side = if is_south { -1.0 } else { 1.0 };
        Drawn { turns, depth, side, light: between(colors, across, down) }
    }
}

/// Inverts the distribution on [0, 1] whose density goes linearly from `from` to `to`, which are not negative.
#[inline(always)]
fn linear(from: f32, to: f32, u: f32) -> f32 {
    // The root of u = x (2 from + x (to - from)) / (from + to), without cancellation.
    let root = float::sqrt(from * from + u * (to * to - from * from));
    let x = u * (from + to) / (from + root).max(1e-30);
    x.min(1.0)
}
