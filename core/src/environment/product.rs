//! Light and material sampled together: candidates of both, of which one is chosen by its contribution.
//!
//! # The estimator
//! Of `M` candidates, `m_b` are drawn from the lobes with density `p_b` and `m_e` from the environment with density `p_e`.
//! Together they have the density `p = (m_b p_b + m_e p_e) / M`. Candidate `i` weighs `w_i = t_i / p_i`, `t` the luminance of the
//! light that would be reflected, `L f cos` (made positive where a channel below 0 makes it negative). One is chosen with
//! probability `w_i / sum w`, and its light is multiplied by `sum w / (M t)`. The mean over all draws is the
//! integral of `L f cos`, exactly (Talbot, Cline and Egbert 2005). Without occlusion the luminance of the estimate is the mean of
//! `M` estimates by multiple importance sampling of light and lobes. Its variance is that of one over `M`; it takes one shadow ray.
//!
//! # Any light
//! The light may be any [`LightSource`], which draws, tells its density, and gives an estimate `E` of the radiance. Then `t` is the
//! luminance of `E f cos`. The renderer multiplies its own radiance `L` along the chosen direction by `f cos sum w / (M t)`, which is
//! [`factor`](ProductSample::factor). The mean is the integral of `L f cos`, whatever `E` is, if it is above 0 where `L` is:
//!
//! 1. For given candidates, each is chosen with probability `w_i / sum w`. The mean over the choice is the sum of
//!    `w_i / sum w * L_i f_i sum w / (M t_i)`. With `w_i = t_i / p_i` that is the sum of `L_i f_i / (M p_i)`: `E` is gone.
//! 2. Candidate `i` has the density `q_i`, which is `p_b` or `p_e`. The mean over the candidates is the sum over `i` of the integral
//!    of `q_i L f cos / (M p)`. The sum of all `q_i` is `M p`, and the integral of `L f cos` is left.
//! 3. A draw of the light that finds nothing brings nothing, and is a candidate all the same. Then `p_e` integrates to less than 1,
//!    which neither step needs.
//! 4. `L` may be random, as the light of a path that goes on is, if its mean for a given direction is the radiance there.
//!
//! So an occluder that the light does not know, and noise, cost variance alone.
//!
//! # With the path's own ray
//! The path goes on along a direction that the lobes drew, and meets the light where it escapes. That light
//! gets the weight `p_b / (p_b + kappa p)`, and the candidates the rest: they are weighed by `t / (p_b /
//! kappa + p)`. The larger kappa, the less the ray's light counts; an infinite one leaves it out.

use super::candidates::{Candidates, choose};
use super::directions::Light;
use super::light::LightSource;
use super::sampling::ProductSampling;
use super::table::Environment;
use crate::error::Error;
use crate::mixture::rows::AnyMixture;
use glam::Vec3;

/// A direction drawn for light and material together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProductSample {
    /// Unit vector in the world, towards the light: where the shadow ray goes.
    pub direction: Vec3,
    /// The light that is reflected to the viewer if nothing is in the way, radiance times `f cos` over the
    /// density of such a draw; linear sRGB, in the unit of the light. The radiance is that of a map; of another light, its estimate.
    pub weight: Vec3,
    /// `f cos` over the density of such a draw: the factor on the true radiance from there, where the light's is an estimate.
    pub factor: Vec3,
}

impl AnyMixture<'_> {
    /// Draws a direction for light and this mixture together: direct light by one shadow ray.
    ///
    /// The mean of `weight` over all draws is the integral of radiance times `f cos`, times one minus
    /// [`ray_weight`](ProductSampling::ray_weight). So is the mean of `factor` times the true radiance, whatever hides the light, and
    /// however far off the estimate of a [`LightSource`] is. The density of a draw has no closed form; see
    /// `core/src/environment/product.rs` for the estimator.
    ///
    /// Shapes: `frame` tangent, bitangent and normal of the caller's shading frame in the world, unit vectors
    /// at right angles; `u` three uniform numbers in [0, 1) a candidate, each `[candidates]`, those of the
    /// lobes first; `choice` one such number. `None` where no candidate brings light.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of that length.
    ///
    /// # Examples
    /// ```
    /// use srbf_core::{Environment, Lobe, Mixture, ProductSampling, Vec3, environment_len};
    ///
    /// let map = [[2.0; 3], [2.0; 3], [0.5; 3], [0.5; 3]];
    /// let environment = Environment::new(2, &map, vec![0; environment_len(2, 2)?])?;
    /// let mixture = Mixture::<16>::hemisphere(&[Lobe::new(Vec3::Z, 40.0, Vec3::splat(3.0))?])?;
    /// let sampling = ProductSampling::new(2, 0.5, f32::INFINITY)?;
    ///
    /// let u = [[0.3, 0.7], [0.6, 0.2], [0.1, 0.9]];
    /// let frame = [Vec3::X, Vec3::Y, Vec3::Z];
    /// let drawn = mixture.sample_product(&environment, &frame, &sampling, u.each_ref().map(|u| &u[..]),
    /// 0.4)?; let drawn = drawn.expect("there is light above");
    /// // Where the way along `drawn.direction` is clear, `drawn.weight` reaches the viewer.
    /// assert!(drawn.weight.min_element() > 0.0);
    /// # Ok::<(), srbf_core::Error>(())
    /// ```
    pub fn sample_product(
        &self,
        light: &impl LightSource,
        frame: &[Vec3; 3],
        sampling: &ProductSampling,
        u: [&[f32]; 3],
        choice: f32,
    ) -> Result<Option<ProductSample>, Error> {
        let environment = light.environment();
        let table = environment.as_ref().map(Environment::borrowed);
        let light = table.as_ref().map_or(Light::Any(light), Light::Map);
        self.product_of(light, frame, sampling, u, choice)
    }

    /// The same of either kind of light.
    fn product_of(
        &self,
        light: Light<'_>,
        frame: &[Vec3; 3],
        sampling: &ProductSampling,
        u: [&[f32]; 3],
        choice: f32,
    ) -> Result<Option<ProductSample>, Error> {
        if u.iter().any(|u| u.len() != sampling.count) {
            return Err(Error::Length);
        }
        if self.head.power <= 0.0 {
            return Ok(None);
        }
        let mut candidates = Candidates::NONE;
        let power = candidates.draw(&self.borrowed(), light, frame, sampling, u);
        if self.has_factors() {
            candidates.multiply(&self.head, sampling.count);
        }
        let is_map = light.map().is_some();
        let Some((chosen, brought, whole)) =
            choose(self.head.level, &mut candidates, sampling, is_map, choice)
        else {
            return Ok(None);
        };
        let [direction, light, value] = candidates.at(chosen);
        // The division by the first weight comes first: the sum over that alone may be more than a float holds.
        // A sum that is more than a float holds is the largest one: a channel of 0 stays 0.
        let (most, least) = (Vec3::splat(f32::MAX), Vec3::splat(f32::MIN));
        let factor = (value / brought * whole).clamp(least, most);
        let whole = (whole * power).min(f32::MAX);
        Ok(Some(ProductSample { direction, weight: light * value / brought * whole, factor }))
    }
}
