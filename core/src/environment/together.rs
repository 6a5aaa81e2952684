//! Directions of a block of light and of the lobes, evaluated and weighed in vectors.
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use super::candidates::target_of;
use super::draw::LEAST_UNIFORM;
use super::light_block::{LIGHT_BLOCK, LightBlock};
use super::look_up::{Place, between, luminances, place};
use super::table::{Colors, Table};
use crate::kernel::draw::sample_direction;
use crate::mixture::rows::{Head, MixtureRef};
use crate::simd::detect::Level;
use crate::simd::lanes::{Lanes, dot3, splat3};
use crate::simd::routine::Routine;
use glam::Vec3;

/// Most directions of the lobes that [`reflect`](crate::Mixture::reflect) takes.
pub const MAX_REFLECT_RAYS: usize = 16;

/// Places: those of the block, then those of the lobes, of which each begins a vector at every level.
const ROOM: usize = LIGHT_BLOCK + MAX_REFLECT_RAYS;

/// One number of each place.
type PerPlace = [f32; ROOM];

/// All directions of a surface: structures of arrays.
pub(super) struct Together {
    /// In the caller's shading frame, and in the world.
    local: [PerPlace; 3],
    world: [PerPlace; 3],
    /// Factors on the value: of the block radiance over its density; of the lobes radiance over the
    /// power of the environment, until they are weighed.
    light: [PerPlace; 3],
    /// `f cos`; 1/sr.
    value: [PerPlace; 3],
    /// Density of the lobes; 1/sr.
    pdf: PerPlace,
    /// The weight by which a direction of the block is chosen, and the running sum of weights.
    target: [f32; LIGHT_BLOCK],
    cumulative: [f32; LIGHT_BLOCK],
}

/// A direction of the block that was chosen.
pub(super) struct ChosenLight {
    pub direction: Vec3,
    pub value: Vec3,
    pub light: Vec3,
    /// One over the probability that it is chosen with.
    pub over_probability: f32,
}

/// Three rows from `at` on.
#[inline(always)]
fn load3<L: Lanes, const M: usize>(rows: &[[f32; M]; 3], at: usize) -> [L; 3] {
    [L::load(&rows[0][at..]), L::load(&rows[1][at..]), L::load(&rows[2][at..])]
}

#[inline(always)]
fn store3<L: Lanes>(vector: [L; 3], rows: &mut [PerPlace; 3], at: usize) {
    for i in 0..3 {
        vector[i].store(&mut rows[i][at..]);
    }
}

impl Together {
    const ZERO: PerPlace = [0.0; ROOM];
    pub const NONE: Self = Self {
        local: [Self::ZERO; 3],
        world: [Self::ZERO; 3],
        light: [Self::ZERO; 3],
        value: [Self::ZERO; 3],
        pdf: Self::ZERO,
        target: [0.0; LIGHT_BLOCK],
        cumulative: [0.0; LIGHT_BLOCK],
    };

    /// Draws the directions of the lobes, and evaluates all, without factors.
    #[inline(always)]
    pub fn draw(
        &mut self,
        mixture: &MixtureRef<'_>,
        table: &Table<'_>,
        block: &LightBlock,
        frame: &[Vec3; 3],
        u: [&[f32]; 3],
    ) {
        let frame = [frame[0].to_array(), frame[1].to_array(), frame[2].to_array()];
        let rays = u[0].len().min(MAX_REFLECT_RAYS);
        let (mut cells, mut within) = ([0; MAX_REFLECT_RAYS], [[0.0; MAX_REFLECT_RAYS]; 2]);
        let to = &mut *self;
        let (cells_to, within_to) = (&mut cells, &mut within);
        mixture.head.level.run(Draw {
            mixture,
            table,
            block,
            frame,
            u,
            to,
            cells: cells_to,
            within: within_to,
        });
        let count = LIGHT_BLOCK + rays;
        let local = self.local.each_ref().map(|row| &row[..count]);
        mixture.values(local, self.value.each_mut().map(|row| &mut row[..count]));
        mixture.densities(self.value.each_ref().map(|row| &row[..count]), &mut self.pdf[..count]);
        for i in 0..rays {
            let colors = Colors::new(&table.cells[cells[i] as usize], false);
            let light = between(colors, within[0][i], within[1][i]);
            for channel in 0..3 {
                self.light[channel][LIGHT_BLOCK + i] = light[channel];
            }
        }
    }

    /// Multiplies the values by their factors.
    pub fn multiply(&mut self, mixture: &Head<'_>, rays: usize) {
        let count = LIGHT_BLOCK + rays;
        let [x, y, z] = &self.local;
        let [red, green, blue] = &mut self.value;
        mixture.multiply(
            [&x[..count], &y[..count], &z[..count]],
            [&mut red[..count], &mut green[..count], &mut blue[..count]],
        );
    }

    /// Weighs all directions, of which a number come from the lobes; the sums of block and lobes.
    pub fn weigh(
        &mut self,
        level: Level,
        block: &LightBlock,
        power: f32,
        flat: Vec3,
        rays: usize,
    ) -> [Vec3; 2] {
        let [block, lobes] = level.run(Weigh { to: self, block, power, flat: flat.to_array(), rays });
        [Vec3::from_array(block), Vec3::from_array(lobes)]
    }

    /// Numbers of one direction.
    #[inline(always)]
    fn at(rows: &[PerPlace; 3], i: usize) -> Vec3 {
        Vec3::new(rows[0][i], rows[1][i], rows[2][i])
    }

    /// The first of the lobes' directions: in the shading frame, its value, its light, its density.
    pub fn ray(&self) -> (Vec3, Vec3, Vec3, f32) {
        let i = LIGHT_BLOCK;
        (Self::at(&self.local, i), Self::at(&self.value, i), Self::at(&self.light, i), self.pdf[i])
    }

    /// Chooses one of the block; `None` if none brings light.
    pub fn choose(&self, choice: f32) -> Option<ChosenLight> {
        let sums = &self.cumulative;
        let whole = sums.last().copied().filter(|&whole| whole > 0.0)?;
        // 0 would choose a direction that brings next to nothing, and one over its probability has no digits.
        let place = choice.max(LEAST_UNIFORM) * whole;
        let mut passed = 0;
        for sum in sums {
            passed += usize::from(*sum <= place);
        }
        // Sums that rounding has made a little larger than those before may stop at one that adds nothing.
        let adds = |&i: &usize| self.target[i] > 0.0;
        let i = (passed..LIGHT_BLOCK).find(adds).or_else(|| (0..passed.min(LIGHT_BLOCK)).rev().find(adds))?;
        Some(ChosenLight {
            direction: Self::at(&self.world, i),
            value: Self::at(&self.value, i),
            light: Self::at(&self.light, i),
            over_probability: whole / self.target[i],
        })
    }
}

/// Draws and evaluates.
struct Draw<'a, 't> {
    mixture: &'a MixtureRef<'a>,
    table: &'a Table<'t>,
    block: &'a LightBlock,
    frame: [[f32; 3]; 3],
    u: [&'a [f32]; 3],
    to: &'a mut Together,
    /// Where the directions of the lobes lie among the cells, which are asked for here, and read after the lobes have been summed.
    cells: &'a mut [u32; MAX_REFLECT_RAYS],
    within: &'a mut [[f32; MAX_REFLECT_RAYS]; 2],
}

impl Routine for Draw<'_, '_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(mut self) {
        self.draw_lobes::<L>();
        let mut at = 0;
        while at < LIGHT_BLOCK {
            let world = load3::<L, LIGHT_BLOCK>(&self.block.direction, at);
            let mut local = world;
            for i in 0..3 {
                local[i] = dot3(world, splat3(self.frame[i]));
            }
            store3(local, &mut self.to.local, at);
            store3(world, &mut self.to.world, at);
            store3(load3::<L, LIGHT_BLOCK>(&self.block.light, at), &mut self.to.light, at);
            at += L::COUNT;
        }
    }
}

impl Draw<'_, '_> {
    /// Directions of the lobes, and where they lie among the cells.
    #[inline(always)]
    fn draw_lobes<L: Lanes>(&mut self) {
        let (cells, within) = (&mut *self.cells, &mut *self.within);
        let rays = self.u[0].len().min(MAX_REFLECT_RAYS);
        // 0.5 is a valid uniform number.
        let mut u = [[0.5; MAX_REFLECT_RAYS]; 3];
        for i in 0..3 {
            u[i][..rays].copy_from_slice(&self.u[i][..rays]);
        }
        let [tangent, bitangent, normal] = self.frame;
        let mut found = [[0.0; MAX_REFLECT_RAYS]; 3];
        let mut at = 0;
        while at < rays {
            let local = sample_direction(self.mixture, load3::<L, MAX_REFLECT_RAYS>(&u, at));
            let mut world = local;
            for i in 0..3 {
                world[i] = dot3(local, splat3([tangent[i], bitangent[i], normal[i]]));
            }
            let Place { column, across, row, depth } = place(self.table, world);
            column.store(&mut found[0][at..]);
            row.store(&mut found[1][at..]);
            depth.store(&mut found[2][at..]);
            across.store(&mut within[0][at..]);
            store3(local, &mut self.to.local, LIGHT_BLOCK + at);
            store3(world, &mut self.to.world, LIGHT_BLOCK + at);
            at += L::COUNT;
        }
        for i in 0..rays {
            let place =
                Place { column: found[0][i], across: within[0][i], row: found[1][i], depth: found[2][i] };
            let (cell, down) = self.table.cell(place, self.to.world[2][LIGHT_BLOCK + i]);
            self.table.prefetch(cell);
            (cells[i], within[1][i]) = (cell as u32, down);
        }
    }
}

/// Where the lobes are thinner, 1/sr, their directions bring nothing.
const LEAST_DENSITY: f32 = 1e-30;

/// Weighs and sums.
struct Weigh<'a> {
    to: &'a mut Together,
    block: &'a LightBlock,
    power: f32,
    flat: [f32; 3],
    rays: usize,
}

impl Routine for Weigh<'_> {
    /// Sums over the block, and over the lobes.
    type Output = [[f32; 3]; 2];
    #[inline(always)]
    fn run<L: Lanes>(self) -> [[f32; 3]; 2] {
        let (to, flat) = (self.to, splat3::<L>(self.flat));
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let (mut acc, mut before) = ([[zero; 3]; 2], zero);
        let mut at = 0;
        while at < LIGHT_BLOCK + self.rays {
            let of_lobes = usize::from(at >= LIGHT_BLOCK);
            let (mut light, mut value) = (load3::<L, ROOM>(&to.light, at), load3::<L, ROOM>(&to.value, at));
            let pdf = L::load(&to.pdf[at..]);
            let is_above = zero.lt(dot3(load3::<L, ROOM>(&to.world, at), flat));
            // The power heuristic, by the ratio of the densities: their squares may be too large or too small.
            let scale = if of_lobes == 1 {
                let ratio = luminances(light) / pdf;
                let is_drawn = L::both(is_above, L::splat(LEAST_DENSITY).lt(pdf));
                (L::splat(self.power) / (ratio.mul_add(ratio, one) * pdf)).keep(is_drawn)
            } else {
                let ratio = pdf / L::load(&self.block.pdf[at..]);
                (one / ratio.mul_add(ratio, one)).keep(is_above)
            };
            for i in 0..3 {
                light[i] = light[i] * scale;
                value[i] = value[i] * light[i];
                acc[of_lobes][i] = acc[of_lobes][i] + value[i];
            }
            store3(light, &mut to.light, at);
            if of_lobes == 0 {
                let target = target_of(value);
                target.store(&mut to.target[at..]);
                let sums = target.running_sum() + before;
                sums.store(&mut to.cumulative[at..]);
                before = L::splat(to.cumulative[at + L::COUNT - 1]);
            }
            at += L::COUNT;
        }
        let mut sums = [[0.0; 3]; 2];
        for of_lobes in 0..2 {
            for i in 0..3 {
                sums[of_lobes][i] = acc[of_lobes][i].sum();
            }
        }
        sums
    }
}
