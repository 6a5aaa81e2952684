//! The candidates of a product draw: drawn, evaluated and weighed in vectors of directions.
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use super::directions::{
    Directions, FromLight, FromLobes, LEAST_DENSITY, Light, Places, load3, store3, target_of,
};
use super::draw::within;
use super::look_up::luminances;
use super::sampling::{MAX_CANDIDATES, ProductSampling};
use super::table::Table;
use crate::mixture::rows::{Head, MixtureRef};
use crate::simd::detect::Level;
use crate::simd::lanes::{Lanes, dot3, splat3};
use crate::simd::routine::Routine;
use glam::Vec3;

/// Widest vector that is loaded from the last candidate on.
const WIDEST: usize = 16;

/// Places for candidates, and for the lanes beside the last of them.
const ROOM: usize = MAX_CANDIDATES + WIDEST;

/// The candidates of one draw. Their light is the radiance over a number that [`draw`](Self::draw) gives: the power of a map, whose
/// luminance is the density then, or the largest radiance of another light.
pub(crate) struct Candidates(Directions<ROOM>);

impl Candidates {
    pub const NONE: Self = Self(Directions::NONE);

    /// Draws and evaluates them, without factors; gives what their radiance is divided by.
    #[inline(always)]
    pub fn draw(
        &mut self,
        mixture: &MixtureRef<'_>,
        light: Light<'_>,
        frame: &[Vec3; 3],
        sampling: &ProductSampling,
        u: [&[f32]; 3],
    ) -> f32 {
        let frame = [frame[0].to_array(), frame[1].to_array(), frame[2].to_array()];
        let (lobes, count) = (sampling.lobes, sampling.count);
        let (to, mut places) = (&mut self.0, Places::NONE);
        let by = FromLobes { mixture, map: light.map(), frame, u };
        mixture.head.level.run(Draw { by, lobes, count, to, places: &mut places });
        if let Light::Any(light) = light {
            // Those of the light overwrite the lanes behind the last one of the lobes.
            self.0.rows(0).fill(light, lobes, None);
            self.0.rows(lobes).fill(
                light,
                count - lobes,
                Some(FromLight { frame: &frame, u: u.map(|u| &u[lobes..]) }),
            );
        }
        self.0.evaluate(mixture, count);
        if let Light::Map(table) = light {
            self.0.look_up(table, &places, 0..count);
            return table.power;
        }
        self.0.rows(0).over_largest(count)
    }

    /// Multiplies the values by their factors.
    pub fn multiply(&mut self, mixture: &Head<'_>, count: usize) {
        self.0.multiply(mixture, count);
    }

    /// Direction in the world, light and `f cos` of one.
    pub fn at(&self, i: usize) -> [Vec3; 3] {
        [&self.0.world, &self.0.light, &self.0.value].map(|rows| Directions::at(rows, i))
    }
}

/// Four rows from `at` on.
#[inline(always)]
fn load4<L: Lanes>(rows: &[[f32; ROOM]; 4], at: usize) -> [L; 4] {
    let [x, y, z, w] = rows;
    [L::load(&x[at..]), L::load(&y[at..]), L::load(&z[at..]), L::load(&w[at..])]
}

/// Draws candidates, of which the first `lobes` are of the lobes.
struct Draw<'a> {
    by: FromLobes<'a>,
    lobes: usize,
    count: usize,
    to: &'a mut Directions<ROOM>,
    places: &'a mut Places<ROOM>,
}

impl Routine for Draw<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(mut self) {
        // The cells are asked for as soon as they are known, and read when something else has been done.
        let mut left = [0.0; ROOM];
        if let Some(table) = self.by.map {
            for i in self.lobes..self.count {
                let (hit, rest) = table.hit([self.by.u[0][i], self.by.u[1][i]]);
                table.prefetch(hit);
                (self.places.cell[i], left[i]) = (hit as u32, rest);
            }
        }
        // The candidates of the environment overwrite the lanes behind the last one of the lobes.
        if self.lobes > 0 {
            self.to.draw_lobes::<L, ROOM>(self.places, &self.by, 0, self.lobes);
        }
        if let Some(table) = self.by.map.filter(|_| self.lobes < self.count) {
            self.draw_map::<L>(table, &mut left);
        }
    }
}

impl Draw<'_> {
    /// Directions of a map, in cells that were hit, by the remainders `left` of the uniform numbers.
    #[inline(always)]
    fn draw_map<L: Lanes>(&mut self, table: &Table<'_>, left: &mut [f32; ROOM]) {
        let (places, by) = (&mut *self.places, &self.by);
        let (mut bright, mut found, mut u) = ([[0.0; ROOM]; 4], [[0.0; ROOM]; 4], [0.5; ROOM]);
        u[self.lobes..self.count].copy_from_slice(&by.u[2][self.lobes..self.count]);
        for i in self.lobes..self.count {
            let chosen = table.choose(places.cell[i] as usize, left[i]);
            (places.is_other[i], left[i]) = (chosen.is_other, chosen.left);
            for corner in 0..4 {
                (bright[corner][i], found[corner][i]) = (chosen.luminances[corner], chosen.place[corner]);
            }
        }
        let mut at = self.lobes;
        while at < self.count {
            let place = within(load4::<L>(&bright, at), L::load(&left[at..]), L::load(&u[at..]));
            let world = table.direction(place, load4(&found, at));
            let mut local = world;
            for i in 0..3 {
                local[i] = dot3(world, splat3(by.frame[i]));
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
    is_map: bool,
    choice: f32,
) -> Option<(usize, f32, f32)> {
    level.run(Weigh { to: &mut candidates.0, sampling, is_map });
    let (chosen, whole) = candidates.0.choose(choice, sampling.count)?;
    let [_, light, value] = candidates.at(chosen);
    Some((chosen, target_of((light * value).to_array()), whole))
}

/// Weighs the candidates, and sums their weights.
struct Weigh<'a> {
    to: &'a mut Directions<ROOM>,
    sampling: &'a ProductSampling,
    is_map: bool,
}

impl Routine for Weigh<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { to, sampling, is_map } = self;
        let (of_lobes, of_environment) = (L::splat(sampling.of_lobes), L::splat(sampling.of_environment));
        let zero = L::splat(0.0);
        let (mut before, mut at) = (zero, 0);
        while at < sampling.count {
            let light = load3::<L, ROOM>(&to.light, at);
            let mut reflected = load3::<L, ROOM>(&to.value, at);
            for i in 0..3 {
                reflected[i] = reflected[i] * light[i];
            }
            let target = target_of(reflected);
            let pdf = L::load(&to.pdf[at..]);
            let of_light = if is_map { luminances(light) } else { L::load(&to.of_light[at..]) };
            let divisor = of_lobes.mul_add(pdf, of_environment * of_light);
            // Where f32 rounds the densities to nothing, there is nothing to be weighed either.
            let is_drawn = L::both(zero.lt(target), L::splat(LEAST_DENSITY).lt(divisor));
            before = to.weigh(L::select(is_drawn, target / divisor, zero), before, at);
            at += L::COUNT;
        }
    }
}
