//! Directions of a block of light and of the lobes, evaluated and weighed in vectors.
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use super::directions::{Directions, FromLobes, LEAST_DENSITY, Light, Places, load3, store3, target_of};
use super::draw::LEAST_UNIFORM;
use super::light::LIGHT_BLOCK;
use super::light_block::LightBlock;
use super::look_up::luminances;
use crate::mixture::rows::{Head, MixtureRef};
use crate::simd::detect::Level;
use crate::simd::lanes::{Lanes, dot3, splat3};
use crate::simd::routine::Routine;
use glam::Vec3;

/// Most directions of the lobes that [`reflect`](crate::AnyMixture::reflect) takes.
pub const MAX_REFLECT_RAYS: usize = 16;

/// Places: those of the block, then those of the lobes, of which each begins a vector at every level.
const ROOM: usize = LIGHT_BLOCK + MAX_REFLECT_RAYS;

/// All directions of a surface. Their light: of the block radiance over its density; of the lobes radiance over the power of a map,
/// or that of another light, until they are weighed.
pub(super) struct Together(Directions<ROOM>);

/// A direction of the block that was chosen.
pub(super) struct ChosenLight {
    pub direction: Vec3,
    pub value: Vec3,
    pub light: Vec3,
    /// What radiance from there was multiplied by to be that light.
    pub factor: f32,
    /// One over the probability that it is chosen with.
    pub over_probability: f32,
}

impl Together {
    pub const NONE: Self = Self(Directions::NONE);

    /// Draws the directions of the lobes, and evaluates all, without factors.
    #[inline(always)]
    pub fn draw(
        &mut self,
        mixture: &MixtureRef<'_>,
        light: Light<'_>,
        block: &LightBlock,
        frame: &[Vec3; 3],
        u: [&[f32]; 3],
    ) {
        let frame = [frame[0].to_array(), frame[1].to_array(), frame[2].to_array()];
        let count = LIGHT_BLOCK + u[0].len().min(MAX_REFLECT_RAYS);
        let (to, mut places) = (&mut self.0, Places::NONE);
        let by = FromLobes { mixture, map: light.map(), frame, u };
        mixture.head.level.run(Draw { by, block, to, places: &mut places });
        self.0.evaluate(mixture, count);
        match light {
            Light::Map(table) => self.0.look_up(table, &places, LIGHT_BLOCK..count),
            Light::Any(light) => self.0.rows(LIGHT_BLOCK).fill(light, count - LIGHT_BLOCK, None),
        }
    }

    /// Multiplies the values by their factors.
    pub fn multiply(&mut self, mixture: &Head<'_>, rays: usize) {
        self.0.multiply(mixture, LIGHT_BLOCK + rays);
    }

    /// Weighs all directions, of which a number come from the lobes; the sums of block and lobes. `power` that of a map; `None` of
    /// another light.
    pub fn weigh(
        &mut self,
        level: Level,
        block: &LightBlock,
        power: Option<f32>,
        flat: Vec3,
        rays: usize,
    ) -> [Vec3; 2] {
        let to = &mut self.0;
        let [block, lobes] = level.run(Weigh { to, block, power, flat: flat.to_array(), rays });
        [Vec3::from_array(block), Vec3::from_array(lobes)]
    }

    /// The first of the lobes' directions: in the shading frame, its value, its light, its density; and what radiance over `power`
    /// was multiplied by to be that light.
    pub fn ray(&self) -> (Vec3, Vec3, Vec3, [f32; 2]) {
        let (Self(all), i) = (self, LIGHT_BLOCK);
        (
            Directions::at(&all.local, i),
            Directions::at(&all.value, i),
            Directions::at(&all.light, i),
            [all.pdf[i], all.of_light[i]],
        )
    }

    /// Chooses one of the block; `None` if none brings light.
    pub fn choose(&self, block: &LightBlock, choice: f32) -> Option<ChosenLight> {
        let Self(all) = self;
        // 0 would choose a direction that brings next to nothing, and one over its probability has no digits.
        let (i, whole) = all.choose(choice.max(LEAST_UNIFORM), LIGHT_BLOCK)?;
        Some(ChosenLight {
            direction: Directions::at(&all.world, i),
            value: Directions::at(&all.value, i),
            light: Directions::at(&all.light, i),
            factor: all.of_light[i] / block.pdf[i],
            over_probability: whole / all.weight[i],
        })
    }
}

/// Draws the directions of the lobes, and takes those of the block.
struct Draw<'a> {
    by: FromLobes<'a>,
    block: &'a LightBlock,
    to: &'a mut Directions<ROOM>,
    places: &'a mut Places<MAX_REFLECT_RAYS>,
}

impl Routine for Draw<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let rays = self.by.u[0].len().min(MAX_REFLECT_RAYS);
        self.to.draw_lobes::<L, MAX_REFLECT_RAYS>(self.places, &self.by, LIGHT_BLOCK, rays);
        let mut at = 0;
        while at < LIGHT_BLOCK {
            let world = load3::<L, LIGHT_BLOCK>(&self.block.direction, at);
            let mut local = world;
            for i in 0..3 {
                local[i] = dot3(world, splat3(self.by.frame[i]));
            }
            store3(local, &mut self.to.local, at);
            store3(world, &mut self.to.world, at);
            store3(load3::<L, LIGHT_BLOCK>(&self.block.light, at), &mut self.to.light, at);
            at += L::COUNT;
        }
    }
}

/// Weighs and sums.
struct Weigh<'a> {
    to: &'a mut Directions<ROOM>,
    block: &'a LightBlock,
    power: Option<f32>,
    flat: [f32; 3],
    rays: usize,
}

impl Routine for Weigh<'_> {
    /// Sums over the block, and over the lobes.
    type Output = [[f32; 3]; 2];
    #[inline(always)]
    fn run<L: Lanes>(self) -> [[f32; 3]; 2] {
        let (to, flat) = (self.to, splat3::<L>(self.flat));
        let (zero, one, power) = (L::splat(0.0), L::splat(1.0), L::splat(self.power.unwrap_or(1.0)));
        let (mut acc, mut before) = ([[zero; 3]; 2], zero);
        let mut at = 0;
        while at < LIGHT_BLOCK + self.rays {
            let of_lobes = usize::from(at >= LIGHT_BLOCK);
            let (mut light, mut value) = (load3::<L, ROOM>(&to.light, at), load3::<L, ROOM>(&to.value, at));
            let pdf = L::load(&to.pdf[at..]);
            let is_above = zero.lt(dot3(load3::<L, ROOM>(&to.world, at), flat));
            // The power heuristic, by the ratio of the densities: their squares may be too large or too small.
            let scale = if of_lobes == 1 {
                let of_map = self.power.is_some();
                let of_light = if of_map { luminances(light) } else { L::load(&to.of_light[at..]) };
                let ratio = of_light / pdf;
                let is_drawn = L::both(is_above, L::splat(LEAST_DENSITY).lt(pdf));
                (power / (ratio.mul_add(ratio, one) * pdf)).keep(is_drawn)
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
            // The density has been read: the factor takes its place.
            scale.store(&mut to.of_light[at..]);
            if of_lobes == 0 {
                before = to.weigh(target_of(value), before, at);
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
