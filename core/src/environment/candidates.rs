//! The candidates of a product draw: drawn, evaluated and weighed in vectors of directions.
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use super::draw::within;
use super::look_up::{Place, between, luminances, place};
use super::sampling::{MAX_CANDIDATES, ProductSampling};
use super::table::{Colors, Table};
use crate::kernel::draw::sample_direction;
use crate::mixture::rows::{Head, MixtureRef};
use crate::simd::detect::Level;
use crate::simd::lanes::{Lanes, dot3, splat3};
use crate::simd::routine::Routine;
use glam::Vec3;

/// Widest vector that is loaded from the last candidate on.
const WIDEST: usize = 16;

/// Places for candidates, and for the lanes beside the last of them.
const ROOM: usize = MAX_CANDIDATES + WIDEST;

/// One number of each candidate.
type Row = [f32; ROOM];

/// The candidates of one draw: structures of arrays.
pub(crate) struct Candidates {
    /// Directions in the caller's shading frame, and in the world.
    local: [Row; 3],
    world: [Row; 3],
    /// Radiance over the power of the environment; 1/sr.
    light: [Row; 3],
    /// `f cos`; 1/sr.
    value: [Row; 3],
    /// Density of the lobes; 1/sr.
    pdf: Row,
    /// Weights, and their running sum.
    weight: Row,
    cumulative: Row,
}

impl Candidates {
    const ZERO: Row = [0.0; ROOM];
    pub const NONE: Self = Self {
        local: [Self::ZERO; 3],
        world: [Self::ZERO; 3],
        light: [Self::ZERO; 3],
        value: [Self::ZERO; 3],
        pdf: Self::ZERO,
        weight: Self::ZERO,
        cumulative: Self::ZERO,
    };

    /// Draws and evaluates them, without factors.
    #[inline(always)]
    pub fn draw(
        &mut self,
        mixture: &MixtureRef<'_>,
        table: &Table<'_>,
        frame: &[Vec3; 3],
        sampling: &ProductSampling,
        u: [&[f32]; 3],
    ) {
        let frame = [frame[0].to_array(), frame[1].to_array(), frame[2].to_array()];
        let (lobes, count) = (sampling.lobes, sampling.count);
        let mut places = Places { cell: [0; ROOM], is_other: [false; ROOM], within: [[0.0; ROOM]; 2] };
        let to = &mut *self;
        mixture.head.level.run(Draw { mixture, table, frame, lobes, count, u, to, places: &mut places });
        let local = self.local.each_ref().map(|row| &row[..count]);
        mixture.values(local, self.value.each_mut().map(|row| &mut row[..count]));
        mixture.densities(self.value.each_ref().map(|row| &row[..count]), &mut self.pdf[..count]);
        for i in 0..count {
            let colors = Colors::new(&table.cells[places.cell[i] as usize], places.is_other[i]);
            let light = between(colors, places.within[0][i], places.within[1][i]);
            for channel in 0..3 {
                self.light[channel][i] = light[channel];
            }
        }
    }

    /// Multiplies the values by their factors.
    pub fn multiply(&mut self, mixture: &Head<'_>, count: usize) {
        let [x, y, z] = &self.local;
        let [red, green, blue] = &mut self.value;
        mixture.multiply(
            [&x[..count], &y[..count], &z[..count]],
            [&mut red[..count], &mut green[..count], &mut blue[..count]],
        );
    }

    /// Direction in the world, and light over the power times `f cos`, of one.
    pub fn at(&self, i: usize) -> (Vec3, Vec3) {
        let [world, light, value] =
            [&self.world, &self.light, &self.value].map(|rows| Vec3::new(rows[0][i], rows[1][i], rows[2][i]));
        (world, light * value)
    }
}

/// Three rows from `at` on.
#[inline(always)]
fn load3<L: Lanes>(rows: &[Row; 3], at: usize) -> [L; 3] {
    [L::load(&rows[0][at..]), L::load(&rows[1][at..]), L::load(&rows[2][at..])]
}

/// Four rows from `at` on.
#[inline(always)]
fn load4<L: Lanes>(rows: &[Row; 4], at: usize) -> [L; 4] {
    let [x, y, z, w] = rows;
    [L::load(&x[at..]), L::load(&y[at..]), L::load(&z[at..]), L::load(&w[at..])]
}

#[inline(always)]
fn store3<L: Lanes>(vector: [L; 3], rows: &mut [Row; 3], at: usize) {
    for i in 0..3 {
        vector[i].store(&mut rows[i][at..]);
    }
}

/// Draws candidates and evaluates them.
struct Draw<'a, 't> {
    mixture: &'a MixtureRef<'a>,
    table: &'a Table<'t>,
    frame: [[f32; 3]; 3],
    lobes: usize,
    count: usize,
    u: [&'a [f32]; 3],
    to: &'a mut Candidates,
    places: &'a mut Places,
}

/// Where candidates lie among the cells.
struct Places {
    cell: [u32; ROOM],
    /// The light is that of the cell's other.
    is_other: [bool; ROOM],
    /// How far to the right, and down, in the cell.
    within: [Row; 2],
}

impl Routine for Draw<'_, '_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(mut self) {
        // The cells are asked for as soon as they are known, and read when something else has been done.
        let mut left = [0.0; ROOM];
        for i in self.lobes..self.count {
            let (hit, rest) = self.table.hit([self.u[0][i], self.u[1][i]]);
            self.table.prefetch(hit);
            (self.places.cell[i], left[i]) = (hit as u32, rest);
        }
        // The candidates of the environment overwrite the lanes behind the last one of the lobes.
        if self.lobes > 0 {
            self.draw_lobes::<L>();
        }
        if self.lobes < self.count {
            self.draw_environment::<L>(&mut left);
        }
    }
}

impl Draw<'_, '_> {
    /// Directions of the lobes, and where they lie.
    #[inline(always)]
    fn draw_lobes<L: Lanes>(&mut self) {
        let places = &mut *self.places;
        // 0.5 is a valid uniform number.
        let mut u = [[0.5; ROOM]; 3];
        for i in 0..3 {
            u[i][..self.lobes].copy_from_slice(&self.u[i][..self.lobes]);
        }
        let [tangent, bitangent, normal] = self.frame;
        let mut found = [[0.0; ROOM]; 3];
        let mut at = 0;
        while at < self.lobes {
            let local = sample_direction(self.mixture, load3::<L>(&u, at));
            let mut world = local;
            for i in 0..3 {
                world[i] = dot3(local, splat3([tangent[i], bitangent[i], normal[i]]));
            }
            let Place { column, across, row, depth } = place(self.table, world);
            store3([column, row, depth], &mut found, at);
            store3(local, &mut self.to.local, at);
            store3(world, &mut self.to.world, at);
            // The lanes behind the last one are overwritten later.
            across.store(&mut places.within[0][at..]);
            at += L::COUNT;
        }
        for i in 0..self.lobes {
            let place = Place {
                column: found[0][i],
                across: places.within[0][i],
                row: found[1][i],
                depth: found[2][i],
            };
            let (cell, down) = self.table.cell(place, self.to.world[2][i]);
            self.table.prefetch(cell);
            (places.cell[i], places.within[1][i]) = (cell as u32, down);
        }
    }

    /// Directions of the environment, in cells that were hit, by the remainders `left` of the uniform numbers.
    #[inline(always)]
    fn draw_environment<L: Lanes>(&mut self, left: &mut Row) {
        let places = &mut *self.places;
        let (mut bright, mut found, mut u) = ([[0.0; ROOM]; 4], [[0.0; ROOM]; 4], [0.5; ROOM]);
        u[self.lobes..self.count].copy_from_slice(&self.u[2][self.lobes..self.count]);
        for i in self.lobes..self.count {
            let chosen = self.table.choose(places.cell[i] as usize, left[i]);
            (places.is_other[i], left[i]) = (chosen.is_other, chosen.left);
            for corner in 0..4 {
                (bright[corner][i], found[corner][i]) = (chosen.luminances[corner], chosen.place[corner]);
            }
        }
        let mut at = self.lobes;
        while at < self.count {
            let place = within(load4::<L>(&bright, at), L::load(&left[at..]), L::load(&u[at..]));
            let world = self.table.direction(place, load4(&found, at));
            let mut local = world;
            for i in 0..3 {
                local[i] = dot3(world, splat3(self.frame[i]));
            }
            place[0].store(&mut places.within[0][at..]);
            place[1].store(&mut places.within[1][at..]);
            store3(local, &mut self.to.local, at);
            store3(world, &mut self.to.world, at);
            at += L::COUNT;
        }
    }
}

/// Chooses one of the candidates: its number, its weight, and the sum of all weights. `None` if none brings
/// light.
pub(crate) fn choose(
    level: Level,
    candidates: &mut Candidates,
    sampling: &ProductSampling,
    choice: f32,
) -> Option<(usize, f32, f32)> {
    level.run(Weigh { candidates, sampling });
    let sums = &candidates.cumulative[..sampling.count];
    let whole = sums.last().copied().filter(|&whole| whole > 0.0)?;
    let target = choice * whole;
    let passed = sums.iter().filter(|&&sum| sum <= target).count();
    // Sums that rounding has made a little larger than those before may stop at one that adds nothing.
    let adds = |&i: &usize| candidates.weight[i] > 0.0;
    let chosen = (passed..sampling.count).find(adds).or_else(|| (0..passed).rev().find(adds))?;
    let (_, light) = candidates.at(chosen);
    Some((chosen, target_of(light.to_array()), whole))
}

/// Where candidates are thinner, 1/sr, they bring nothing: nothing is drawn there.
const LEAST_DENSITY: f32 = 1e-30;

/// The weights of candidates: the luminance of their light, or a share of the luminance without signs, if that is more. Lobes may
/// have channels below 0, of which coloured light may make a luminance below 0 too.
#[inline(always)]
pub(super) fn target_of<L: Lanes>(light: [L; 3]) -> L {
    let unsigned = luminances([light[0].abs(), light[1].abs(), light[2].abs()]);
    luminances(light).max(unsigned * L::splat(LEAST_SHARE))
}

/// The smaller, the farther from the mean a draw of light below 0 may be; the larger, the more others than
/// these are off their luminance.
const LEAST_SHARE: f32 = 1.0 / 8.0;

/// Weighs the candidates, and sums their weights.
struct Weigh<'a> {
    candidates: &'a mut Candidates,
    sampling: &'a ProductSampling,
}

impl Routine for Weigh<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { candidates, sampling } = self;
        let (of_lobes, of_environment) = (L::splat(sampling.of_lobes), L::splat(sampling.of_environment));
        let zero = L::splat(0.0);
        let (mut before, mut at) = (zero, 0);
        while at < sampling.count {
            let light = load3::<L>(&candidates.light, at);
            let mut reflected = load3::<L>(&candidates.value, at);
            for i in 0..3 {
                reflected[i] = reflected[i] * light[i];
            }
            let target = target_of(reflected);
            let pdf = L::load(&candidates.pdf[at..]);
            let divisor = of_lobes.mul_add(pdf, of_environment * luminances(light));
            // Where f32 rounds the densities to nothing, there is nothing to be weighed either.
            let is_drawn = L::both(zero.lt(target), L::splat(LEAST_DENSITY).lt(divisor));
            let weight = L::select(is_drawn, target / divisor, zero);
            weight.store(&mut candidates.weight[at..]);
            let sums = weight.running_sum() + before;
            sums.store(&mut candidates.cumulative[at..]);
            before = L::splat(candidates.cumulative[at + L::COUNT - 1]);
            at += L::COUNT;
        }
    }
}
