//! Directions of light and of lobes that are evaluated together, and of which one is chosen by its weight.
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use super::light::{LIGHT_BLOCK, LightRows, LightSource};
use super::look_up::{Place, between, luminances, place};
use super::table::{Colors, Table};
use crate::kernel::draw::sample_direction;
use crate::mixture::rows::{Head, MixtureRef};
use crate::simd::lanes::{Lanes, dot3, splat3};
use core::ops::Range;
use glam::Vec3;

/// Three numbers of each of `M` directions.
pub(super) type Rows<const M: usize> = [[f32; M]; 3];

/// Where directions are thinner, 1/sr, they bring nothing: nothing is drawn there.
pub(super) const LEAST_DENSITY: f32 = 1e-30;

/// Light, as kernels take it.
#[derive(Clone, Copy)]
pub(crate) enum Light<'a> {
    /// A map, drawn from in vectors.
    Map(&'a Table<'a>),
    /// Code of the caller.
    Any(&'a dyn LightSource),
}

impl<'a> Light<'a> {
    /// The map, if it is one.
    #[inline(always)]
    pub fn map(self) -> Option<&'a Table<'a>> {
        if let Self::Map(table) = self { Some(table) } else { None }
    }
}

/// Room for `M` directions, lanes beside the last of them included: structures of arrays.
pub(super) struct Directions<const M: usize> {
    /// In the caller's shading frame, and in the world.
    pub local: Rows<M>,
    pub world: Rows<M>,
    /// Radiance, divided by the density or the power of the light.
    pub light: Rows<M>,
    /// Of a light that is no map its density, 1/sr.
    pub of_light: [f32; M],
    /// `f cos`; 1/sr.
    pub value: Rows<M>,
    /// Density of the lobes; 1/sr.
    pub pdf: [f32; M],
    /// Weights by which one is chosen, and their running sum.
    pub weight: [f32; M],
    pub cumulative: [f32; M],
}

/// Where `R` directions, those whose light is looked up, lie among the cells of a map.
pub(super) struct Places<const R: usize> {
    pub cell: [u32; R],
    /// The light is that of the cell's other.
    pub is_other: [bool; R],
    /// How far to the right, and down, in the cell.
    pub within: [[f32; R]; 2],
}

impl<const R: usize> Places<R> {
    pub const NONE: Self = Self { cell: [0; R], is_other: [false; R], within: [[0.0; R]; 2] };
}

/// What directions of the lobes are drawn by: axes of the shading frame in the world, and three uniform numbers a direction. Cells
/// are found in a map, if there is one.
pub(super) struct FromLobes<'a> {
    pub mixture: &'a MixtureRef<'a>,
    pub map: Option<&'a Table<'a>>,
    pub frame: [[f32; 3]; 3],
    pub u: [&'a [f32]; 3],
}

impl<const M: usize> Directions<M> {
    pub const NONE: Self = Self {
        local: [[0.0; M]; 3],
        world: [[0.0; M]; 3],
        light: [[0.0; M]; 3],
        of_light: [0.0; M],
        value: [[0.0; M]; 3],
        pdf: [0.0; M],
        weight: [0.0; M],
        cumulative: [0.0; M],
    };

    /// Draws `count` directions of the lobes, the first at row `from`, and finds their cells, which are asked for and not yet read.
    /// Lanes behind the last one hold anything.
    #[inline(always)]
    pub fn draw_lobes<L: Lanes, const R: usize>(
        &mut self,
        places: &mut Places<R>,
        by: &FromLobes<'_>,
        from: usize,
        count: usize,
    ) {
        // 0.5 is a valid uniform number.
        let mut u = [[0.5; R]; 3];
        for i in 0..3 {
            u[i][..count].copy_from_slice(&by.u[i][..count]);
        }
        let [tangent, bitangent, normal] = by.frame;
        let mut found = [[0.0; R]; 3];
        let mut at = 0;
        while at < count {
            let local = sample_direction(by.mixture, load3::<L, R>(&u, at));
            let mut world = local;
            for i in 0..3 {
                world[i] = dot3(local, splat3([tangent[i], bitangent[i], normal[i]]));
            }
            if let Some(table) = by.map {
                let Place { column, across, row, depth } = place(table, world);
                store3([column, row, depth], &mut found, at);
                across.store(&mut places.within[0][at..]);
            }
            store3(local, &mut self.local, from + at);
            store3(world, &mut self.world, from + at);
            at += L::COUNT;
        }
        let Some(table) = by.map else { return };
        for i in 0..count {
            let place = Place {
                column: found[0][i],
                across: places.within[0][i],
                row: found[1][i],
                depth: found[2][i],
            };
            let (cell, down) = table.cell(place, self.world[2][from + i]);
            table.prefetch(cell);
            (places.cell[i], places.within[1][i]) = (cell as u32, down);
        }
    }

    /// Evaluates the first `count` directions without factors.
    #[inline(always)]
    pub fn evaluate(&mut self, mixture: &MixtureRef<'_>, count: usize) {
        let local = self.local.each_ref().map(|row| &row[..count]);
        mixture.values(local, self.value.each_mut().map(|row| &mut row[..count]));
        mixture.densities(self.value.each_ref().map(|row| &row[..count]), &mut self.pdf[..count]);
    }

    /// Looks up the light of the directions in a range, in the cells of a map.
    #[inline(always)]
    pub fn look_up<const R: usize>(&mut self, table: &Table<'_>, places: &Places<R>, lit: Range<usize>) {
        let from = lit.start;
        for i in 0..lit.end - from {
            let colors = Colors::new(&table.cells[places.cell[i] as usize], places.is_other[i]);
            let light = between(colors, places.within[0][i], places.within[1][i]);
            for channel in 0..3 {
                self.light[channel][from + i] = light[channel];
            }
        }
    }

    /// The rows that a light which is no map fills, from a direction on.
    pub fn rows(&mut self, from: usize) -> LitRows<'_> {
        LitRows {
            local: self.local.each_mut().map(|row| &mut row[from..]),
            world: self.world.each_mut().map(|row| &mut row[from..]),
            light: self.light.each_mut().map(|row| &mut row[from..]),
            of_light: &mut self.of_light[from..],
        }
    }

    /// Multiplies the values of `count` directions by their factors.
    pub fn multiply(&mut self, mixture: &Head<'_>, count: usize) {
        let local = self.local.each_ref().map(|row| &row[..count]);
        mixture.multiply(local, self.value.each_mut().map(|row| &mut row[..count]));
    }

    /// Stores the weights of a vector of directions, and their running sum; `before` is the sum before, the returned one that behind.
    #[inline(always)]
    pub fn weigh<L: Lanes>(&mut self, weight: L, before: L, at: usize) -> L {
        weight.store(&mut self.weight[at..]);
        let sums = weight.running_sum() + before;
        sums.store(&mut self.cumulative[at..]);
        L::splat(self.cumulative[at + L::COUNT - 1])
    }

    /// Chooses one of the first `count` by its weight, at a share of their sum, in [0, 1); with the sum. `None` if all weights are 0.
    #[inline(always)]
    pub fn choose(&self, share: f32, count: usize) -> Option<(usize, f32)> {
        let sums = &self.cumulative[..count];
        let whole = sums.last().copied().filter(|&whole| whole > 0.0)?;
        let target = share * whole;
        let mut passed = 0;
        for sum in sums {
            passed += usize::from(*sum <= target);
        }
        // Sums that rounding has made a little larger than those before may stop at one that adds nothing.
        let adds = |&i: &usize| self.weight[i] > 0.0;
        let chosen = (passed..count).find(adds).or_else(|| (0..passed.min(count)).rev().find(adds))?;
        Some((chosen, whole))
    }

    /// Three numbers of one direction.
    #[inline(always)]
    pub fn at(rows: &Rows<M>, i: usize) -> Vec3 {
        Vec3::new(rows[0][i], rows[1][i], rows[2][i])
    }
}

/// Rows of directions that a light which is no map fills: whatever it does, with numbers. There is room for sixteen behind each.
pub(super) struct LitRows<'a> {
    local: [&'a mut [f32]; 3],
    world: [&'a mut [f32]; 3],
    light: [&'a mut [f32]; 3],
    of_light: &'a mut [f32],
}

/// The inputs by which a light draws directions: axes of the shading frame in the world, and three uniform numbers a direction.
#[derive(Clone, Copy)]
pub(super) struct FromLight<'a> {
    pub frame: &'a [[f32; 3]; 3],
    pub u: [&'a [f32]; 3],
}

/// Sixteen numbers from a place on.
#[inline(always)]
fn sixteen(row: &mut [f32], from: usize) -> &mut [f32; LIGHT_BLOCK] {
    row[from..].first_chunk_mut().expect("room behind the last direction")
}

impl LitRows<'_> {
    /// Draws the first `whole` of them, or looks up the light of those that are there: radiance and density. Overwrites sixteen at a
    /// time: lanes behind the last one hold anything.
    pub fn fill(self, light: &dyn LightSource, whole: usize, by: Option<FromLight<'_>>) {
        for from in (0..whole).step_by(LIGHT_BLOCK) {
            let count = (whole - from).min(LIGHT_BLOCK);
            let mut rows = LightRows::NONE;
            if let Some(FromLight { u, .. }) = by {
                light.sample_into(u.map(|u| &u[from..from + count]), &mut rows);
            } else {
                for k in 0..3 {
                    rows.direction[k] = *sixteen(self.world[k], from);
                }
                light.evaluate_into(count, &mut rows);
            }
            rows.mend(by.is_some());
            if let Some(FromLight { frame, .. }) = by {
                for k in 0..3 {
                    *sixteen(self.world[k], from) = rows.direction[k];
                    let local = sixteen(self.local[k], from);
                    for i in 0..LIGHT_BLOCK {
                        let [x, y, z] = rows.direction.each_ref().map(|row| row[i]);
                        local[i] = x * frame[k][0] + y * frame[k][1] + z * frame[k][2];
                    }
                }
            }
            for k in 0..3 {
                *sixteen(self.light[k], from) = rows.radiance[k];
            }
            *sixteen(self.of_light, from) = rows.pdf;
        }
    }

    /// Divides the radiance of the first `count` by its largest number, which is given back: no later product is more than a float holds.
    /// 1 where all is black.
    pub fn over_largest(self, count: usize) -> f32 {
        let mut largest = 0.0;
        for row in &self.light {
            for &number in &row[..count] {
                largest = if number > largest { number } else { largest };
            }
        }
        if largest <= 0.0 {
            return 1.0;
        }
        for row in self.light {
            row[..count].iter_mut().for_each(|number| *number /= largest);
        }
        largest
    }
}

/// Three rows from `at` on.
#[inline(always)]
pub(super) fn load3<L: Lanes, const M: usize>(rows: &Rows<M>, at: usize) -> [L; 3] {
    [L::load(&rows[0][at..]), L::load(&rows[1][at..]), L::load(&rows[2][at..])]
}

#[inline(always)]
pub(super) fn store3<L: Lanes, const M: usize>(vector: [L; 3], rows: &mut Rows<M>, at: usize) {
    for i in 0..3 {
        vector[i].store(&mut rows[i][at..]);
    }
}

/// The weights of directions: the luminance of their light, or a share of the luminance without signs, if that is more. Lobes may
/// have channels below 0, of which coloured light may make a luminance below 0 too.
#[inline(always)]
pub(super) fn target_of<L: Lanes>(light: [L; 3]) -> L {
    let unsigned = luminances([light[0].abs(), light[1].abs(), light[2].abs()]);
    luminances(light).max(unsigned * L::splat(LEAST_SHARE))
}

/// The smaller, the farther from the mean a draw of light below 0 may be; the larger, the more others than
/// these are off their luminance.
const LEAST_SHARE: f32 = 1.0 / 8.0;
