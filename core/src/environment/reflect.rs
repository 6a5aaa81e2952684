//! Light and material sampled together with even points: sums without shadows, which rays correct.
//!
//! # The estimator
//! The light that a surface reflects is the integral of `V L f cos`, `V` 1 where the way is clear and 0 where
//! something is in it. With the weights of multiple importance sampling, `w_e + w_b = 1`, it has two parts. The environment
//! samples one with density `p_e`, the lobes the other with `p_b`:
//!
//! ```text
//! h_e(d) = L f cos w_e / p_e  of a direction of the environment     w_e = p_e^2 / (p_e^2 + p_b^2)
//! h_b(d) = L f cos w_b / p_b  of a direction of the lobes
//! ```
//!
//! Both without `V`; both are 0 below the surface. A draw takes 16 directions of the environment, a [`LightBlock`], and `n` of the
//! lobes. The first of these is the ray that the path goes on along. It sums `h` over all of them,
//!
//! ```text
//! G_e = mean of h_e over the block            G_b = mean of h_b over the lobes' directions
//! ```
//!
//! which costs no ray, and sends a shadow ray towards one direction `c` of the block, chosen with probability
//! `t_c / sum t`, `t` the luminance of `h_e` (made positive where a channel below 0 makes it negative). With
//! `x = h_e(c) sum t / (16 t_c)`, with `V_c` for the shadow ray, `V_1` and `h_1` for the path's ray, the
//! estimate is
//!
//! ```text
//! V_c x + V_1 (G_e - x)    +    V_1 h_1 + V_c (G_b - h_1)
//! ```
//!
//! where `V_c` is 1 in the last term if no direction of the block brings light, so that no shadow ray goes.
//!
//! # Why it is unbiased
//! 1. For a given block, the mean of `x` over the choice is the sum of `t_c / sum t * h_e(c) sum t / (16
//!    t_c)`, which is `G_e`; and the mean of `V_c x` is that of `V h_e` over the block. Each direction of the
//!    block by itself has density `p_e`, so that over blocks `V_c x` has the mean of `V h_e / p_e`: the
//!    environment's part of the integral. What `t` is does not matter, if it is above 0 wherever `h_e` is not.
//! 2. `V_1` depends on the numbers of the lobes alone, the choice on others: for given `V_1` and block the
//!    mean of `G_e - x` is 0 by 1. So is that of `V_1 (G_e - x)`.
//! 3. The path's ray has density `p_b`: `V_1 h_1` has the mean of the lobes' part of the integral.
//! 4. Each of the `n` directions by itself has density `p_b`, so that `G_b - h_1` has mean 0. `V_c` depends on
//!    the block and the choice alone, which are independent of the lobes' numbers: `V_c (G_b - h_1)` has mean
//!    0 too.
//!
//! So the numbers of the block, the choice, and the lobes have to be independent of each other; within the
//! block and among the lobes' directions they may depend on each other in any way, if each is uniform by
//! itself.
//!
//! Where nothing is in the way, the estimate is `G_e + G_b`: the sums alone, which are as even as the points.
//! Where everything is, it is 0. What varies is left where one of the two rays is blocked and the other is not.
//!
//! # Another truth
//! Lobes may sample another function, such as a measured table. The sums stay those of the lobes, and the two directions that rays
//! go along are corrected: `x` and `h_1` outside of the differences are those of the other function. The differences have mean 0
//! whatever they are made of.
//!
//! # Any light
//! So may the light. Of a [`LightSource`] the sums are of its estimate `E`; the two corrected terms are of the radiance that the
//! renderer finds, `L_c` and `L_1`. `V_c` and `V_1` in front of the differences become `min(1, L / E)` of the luminances there: how
//! much of the estimate arrived. Of them steps 2 and 4 use only that `V_1` is independent of the choice, and `V_c` of the lobes'
//! numbers. A mean of 0 stays 0, whatever it is multiplied by; so the mean is the integral of `L f cos`.

use super::directions::Light;
use super::light::{LIGHT_BLOCK, LightSource};
use super::light_block::LightBlock;
use super::table::Environment;
use super::together::{MAX_REFLECT_RAYS, Together};
use crate::color::luminance;
use crate::error::Error;
use crate::mixture::rows::{AnyMixture, Sample, drawn_density, weight_of};
use glam::Vec3;

/// What light a surface reflects, but for two rays: see [`AnyMixture::reflect`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflection {
    /// The path's own ray, drawn from the mixture: direction in the caller's shading frame, density and
    /// weight. `None` where the mixture reflects nothing.
    pub ray: Option<Sample>,
    /// Unit vector in the world, towards the light: where the shadow ray goes. `None` where no direction of
    /// the block brings light.
    pub shadow: Option<Vec3>,
    /// What `f cos` towards the ray, and towards the shadow ray, is multiplied by to be the light from there;
    /// linear sRGB.
    pub ray_light: Vec3,
    /// Likewise of the shadow ray.
    pub shadow_light: Vec3,
    /// What radiance along the ray is multiplied by to be `ray_light`, where the light's is an estimate; sr.
    pub ray_factor: f32,
    /// Likewise of the shadow ray.
    pub shadow_factor: f32,
    /// `f cos` of the mixture towards the shadow ray; 1/sr.
    pub shadow_value: Vec3,
    /// `f cos` of the mixture towards the ray; 1/sr.
    pub ray_value: Vec3,
    /// The means of all directions of the block, and of the lobes, without shadows; linear sRGB, in the unit
    /// of the map.
    pub block_sum: Vec3,
    /// Likewise of the lobes.
    pub ray_sum: Vec3,
}

impl Reflection {
    const NONE: Self = Self {
        ray: None,
        shadow: None,
        ray_light: Vec3::ZERO,
        shadow_light: Vec3::ZERO,
        ray_factor: 0.0,
        shadow_factor: 0.0,
        shadow_value: Vec3::ZERO,
        ray_value: Vec3::ZERO,
        block_sum: Vec3::ZERO,
        ray_sum: Vec3::ZERO,
    };

    /// The light that is reflected to the viewer, direct light by both rays: whether the path's own ray
    /// escapes to the light, and whether the shadow ray does. The light that the path meets further on along the ray is
    /// added to it; of the light itself, nothing is.
    ///
    /// Returns: linear sRGB, in the unit of the map. Single estimates may be below 0, where one of the rays
    /// is blocked.
    #[inline]
    pub fn light(&self, ray_escapes: bool, shadow_is_clear: bool) -> Vec3 {
        self.light_of(ray_escapes, shadow_is_clear, self.ray_value, self.shadow_value)
    }

    /// As [`light`](Self::light), of another function than the mixture: `f cos` of it towards the path's ray,
    /// and towards the shadow ray. One that is blocked, or that does not exist, may have any value.
    #[inline]
    pub fn light_of(
        &self,
        ray_escapes: bool,
        shadow_is_clear: bool,
        ray_value: Vec3,
        shadow_value: Vec3,
    ) -> Vec3 {
        let shadow = shadow_is_clear.then_some((1.0, self.shadow_light * shadow_value));
        self.sum(ray_escapes.then_some((1.0, self.ray_light * ray_value)), shadow)
    }

    /// As [`light`](Self::light), of any light: the radiance that the renderer finds along the path's ray, and along the shadow ray, 0
    /// where nothing comes from there. It may be noisy. That of a ray that does not exist may have any value.
    ///
    /// The light counts whole, also that which the path meets further on along its ray, if the light's estimates are of all that.
    #[inline]
    pub fn light_from(&self, ray_radiance: Vec3, shadow_radiance: Vec3) -> Vec3 {
        let of = |radiance: Vec3, factor: f32, estimate: Vec3, value: Vec3| {
            let found = radiance * factor;
            // How much of the estimate arrived: in [0, 1], where both are 0 too.
            let ratio = luminance(found) / luminance(estimate);
            let share = if ratio > 0.0 { ratio.min(1.0) } else { 0.0 };
            (share, found * value)
        };
        let ray = of(ray_radiance, self.ray_factor, self.ray_light, self.ray_value);
        let shadow = of(shadow_radiance, self.shadow_factor, self.shadow_light, self.shadow_value);
        self.sum(self.ray.is_some().then_some(ray), Some(shadow))
    }

    /// The sums, corrected by two rays: how much of the light each brings, and that light. `None` where nothing is seen.
    #[inline]
    fn sum(&self, ray: Option<(f32, Vec3)>, shadow: Option<(f32, Vec3)>) -> Vec3 {
        // A shadow ray that does not exist hides nothing, and brings nothing.
        let shadow = if self.shadow.is_some() { shadow } else { Some((1.0, Vec3::ZERO)) };
        let mut light = Vec3::ZERO;
        if let Some((share, brought)) = shadow {
            light += (self.ray_sum - self.ray_light * self.ray_value) * share;
            light += brought;
        }
        if let Some((share, brought)) = ray {
            light += (self.block_sum - self.shadow_light * self.shadow_value) * share;
            light += brought;
        }
        light
    }
}

impl AnyMixture<'_> {
    /// Draws the ray that a path goes on along, and a shadow ray, for an environment or another light. Where nothing is in the way,
    /// the reflected light is a sum over all directions of `block` and all of `u`: with evenly spread numbers it is nearly exact.
    /// See `core/src/environment/reflect.rs` for the estimator and why it is unbiased.
    ///
    /// Of lobes and light alike, many in the open, this has a fraction of the error of one sample of each;
    /// where most directions are blocked it has about the same, in more time.
    ///
    /// Shapes: `frame` tangent, bitangent and normal of the caller's shading frame in the world, unit vectors
    /// at right angles; `flat` the normal of the surface itself, below which light counts nothing; `u` three
    /// uniform numbers in [0, 1) for each direction of the lobes, each `[n]`, n from 1 to
    /// [`MAX_REFLECT_RAYS`]: the first is the path's own ray, the others may be its shifts along a lattice; 8
    /// serve well. `choice` one more number. Block, `u` and `choice` are independent of each other.
    ///
    /// # Errors
    /// [`Error::Length`] for slices of different lengths, or of none or too many; [`Error::Amplitude`] where the
    /// reflected light overflows f32.
    ///
    /// # Examples
    /// ```
    /// use srbf_core::{Environment, LightBlock, Lobe, Mixture, Vec3, environment_len};
    ///
    /// let map = [[2.0; 3], [2.0; 3], [0.5; 3], [0.5; 3]];
    /// let environment = Environment::new(2, &map, vec![0; environment_len(2, 2)?])?;
    /// let even: [f32; 16] = std::array::from_fn(|i| (i as f32 + 0.5) / 16.0);
    /// let block = LightBlock::new(&environment, [&even, &[0.0; 16], &even]);
    ///
    /// let mixture = Mixture::<16>::hemisphere(&[Lobe::new(Vec3::Z, 40.0, Vec3::splat(3.0))?])?;
    /// let frame = [Vec3::X, Vec3::Y, Vec3::Z];
    /// let u = [[0.3, 0.8], [0.6, 0.1], [0.1, 0.6]];
    /// let drawn = mixture.reflect(&environment, &block, &frame, Vec3::Z, u.each_ref().map(|u| &u[..]), 0.4)?;
    /// // Nothing is in the way of either ray.
    /// let light = drawn.light(true, true);
    /// assert!((light - (drawn.block_sum + drawn.ray_sum)).length() < 1e-5 * light.length());
    /// # Ok::<(), srbf_core::Error>(())
    /// ```
    pub fn reflect(
        &self,
        light: &impl LightSource,
        block: &LightBlock,
        frame: &[Vec3; 3],
        flat: Vec3,
        u: [&[f32]; 3],
        choice: f32,
    ) -> Result<Reflection, Error> {
        let environment = light.environment();
        let table = environment.as_ref().map(Environment::borrowed);
        let light = table.as_ref().map_or(Light::Any(light), Light::Map);
        self.reflect_of(light, block, frame, flat, u, choice)
    }

    /// The same of either kind of light.
    fn reflect_of(
        &self,
        light: Light<'_>,
        block: &LightBlock,
        frame: &[Vec3; 3],
        flat: Vec3,
        u: [&[f32]; 3],
        choice: f32,
    ) -> Result<Reflection, Error> {
        let count = u[0].len();
        if u.iter().any(|u| u.len() != count) || count == 0 || count > MAX_REFLECT_RAYS {
            return Err(Error::Length);
        }
        if self.head.power <= 0.0 {
            return Ok(Reflection::NONE);
        }
        let mut together = Together::NONE;
        together.draw(&self.borrowed(), light, block, frame, u);
        if self.has_factors() {
            together.multiply(&self.head, count);
        }
        let power = light.map().map(|table| table.power);
        let [block_sum, ray_sum] = together.weigh(self.head.level, block, power, flat, count);
        let (direction, ray_value, ray_light, [pdf, factor]) = together.ray();
        let ray = Sample { direction, pdf: drawn_density(pdf), weight: weight_of(ray_value, pdf) };
        let mut drawn = Reflection {
            ray: Some(ray),
            ray_light,
            // `min` is a number, whatever it is given.
            ray_factor: (factor / power.unwrap_or(1.0)).min(f32::MAX),
            ray_value,
            block_sum: block_sum / LIGHT_BLOCK as f32,
            ray_sum: ray_sum / count as f32,
            ..Reflection::NONE
        };
        if let Some(chosen) = together.choose(block, choice) {
            drawn.shadow = Some(chosen.direction);
            drawn.shadow_value = chosen.value;
            let over_probability = chosen.over_probability / LIGHT_BLOCK as f32;
            drawn.shadow_light = chosen.light * over_probability;
            drawn.shadow_factor = (chosen.factor * over_probability).min(f32::MAX);
        }
        let both = drawn.ray_light * drawn.ray_value + drawn.shadow_light * drawn.shadow_value;
        if (drawn.block_sum + drawn.ray_sum + both).is_finite() { Ok(drawn) } else { Err(Error::Amplitude) }
    }
}
