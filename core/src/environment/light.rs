//! Light of any kind: what draws directions, tells their density and estimates the radiance from there.
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use super::table::Environment;
use glam::Vec3;

/// Samples in a block of light, and the most directions of one call of a [`LightSource`].
pub const LIGHT_BLOCK: usize = 16;

/// Up to sixteen directions of a light as rows: filled by a [`LightSource`]. Its rows lie as in
/// [`LightBlock`](crate::LightBlock), but for the radiance, which is not divided by the density.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct LightRows {
    /// Unit vectors in the world, towards the light: x, y, z.
    pub direction: [[f32; LIGHT_BLOCK]; 3],
    /// Estimates of the radiance from there: red, green, blue; linear sRGB, not negative.
    pub radiance: [[f32; LIGHT_BLOCK]; 3],
    /// Densities; 1/sr.
    pub pdf: [f32; LIGHT_BLOCK],
}

impl LightRows {
    /// Directions along +z that bring no light.
    pub const NONE: Self = Self {
        direction: [[0.0; LIGHT_BLOCK], [0.0; LIGHT_BLOCK], [1.0; LIGHT_BLOCK]],
        radiance: [[0.0; LIGHT_BLOCK]; 3],
        pdf: [0.0; LIGHT_BLOCK],
    };

    /// Makes all rows numbers that every sum can take: a light is code of the caller. A drawn direction that is no unit vector, or whose
    /// density is not above 0, brings nothing.
    #[inline(always)]
    pub(super) fn mend(&mut self, is_drawn: bool) {
        // Without branches, so that the loop is one over vectors. A comparison with NaN is false.
        for i in 0..LIGHT_BLOCK {
            let [x, y, z] = self.direction.each_ref().map(|row| row[i]);
            let squared = x * x + y * y + z * z;
            let is_unit = !is_drawn | ((squared - 1.0).abs() <= 2e-3);
            let is_valid = is_unit & (self.pdf[i] > 0.0);
            // One step of Newton's towards the length of 1.
            let scale = if is_drawn { 1.5 - 0.5 * squared } else { 1.0 };
            for (k, (number, other)) in [(x, 0.0), (y, 0.0), (z, 1.0)].into_iter().enumerate() {
                self.direction[k][i] = if is_unit { number * scale } else { other };
            }
            self.pdf[i] = if is_valid { self.pdf[i].min(f32::MAX) } else { 0.0 };
            for row in &mut self.radiance {
                let is_light = (row[i] > 0.0) & (is_valid | !is_drawn);
                row[i] = if is_light { row[i].min(f32::MAX) } else { 0.0 };
            }
        }
    }
}

/// Light that can be drawn from: what [`sample_product`](crate::AnyMixture::sample_product) and
/// [`reflect`](crate::AnyMixture::reflect) take.
///
/// A light learnt from a renderer's own paths is one, a list of lamps that a surface sees, and an [`Environment`]. Both verbs give the
/// density of the draws, and an *estimate* of the radiance. A draw is multiplied by the renderer's own radiance along the
/// direction, so that the mean is right whatever the estimate is. Two things are asked of a light for that:
///
/// * The density is that of the draws, and both verbs give the same. A draw that finds nothing has density 0.
/// * The estimate is above 0 wherever the true radiance may be, if only by little.
///
/// The nearer estimate and density are to the light, the less the draws vary. `core/src/environment/product.rs` has the proof.
///
/// # Examples
/// ```
/// use srbf_core::{LightRows, LightSource, Lobe, Mixture, ProductSampling, Vec3};
/// use std::f32::consts::{PI, TAU};
///
/// /// A sky of one radiance above the ground.
/// struct Sky(f32);
///
/// impl LightSource for Sky {
///     fn sample_into(&self, u: [&[f32]; 3], to: &mut LightRows) {
///         for i in 0..u[0].len() {
///             let (z, (sin, cos)) = (1.0 - u[0][i], (TAU * u[1][i]).sin_cos());
///             let radius = (1.0 - z * z).sqrt();
///             (to.direction[0][i], to.direction[1][i], to.direction[2][i]) = (radius * cos, radius * sin, z);
///         }
///         self.evaluate_into(u[0].len(), to);
///     }
///     fn evaluate_into(&self, count: usize, to: &mut LightRows) {
///         for i in 0..count {
///             let is_sky = to.direction[2][i] > 0.0;
///             to.radiance.iter_mut().for_each(|row| row[i] = if is_sky { self.0 } else { 0.0 });
///             to.pdf[i] = if is_sky { 0.5 / PI } else { 0.0 };
///         }
///     }
/// }
///
/// let mixture = Mixture::<16>::hemisphere(&[Lobe::new(Vec3::Z, 40.0, Vec3::splat(3.0))?])?;
/// let sampling = ProductSampling::new(2, 0.5, f32::INFINITY)?;
/// let u = [[0.3, 0.7], [0.6, 0.2], [0.1, 0.9]];
/// let frame = [Vec3::X, Vec3::Y, Vec3::Z];
/// let drawn = mixture.sample_product(&Sky(2.0), &frame, &sampling, u.each_ref().map(|u| &u[..]), 0.4)?;
/// let drawn = drawn.expect("there is light above");
/// // The radiance along `drawn.direction`, times `drawn.factor`, reaches the viewer.
/// assert!((drawn.factor * 2.0 - drawn.weight).abs().max_element() < 1e-5 * drawn.weight.x);
/// # Ok::<(), srbf_core::Error>(())
/// ```
pub trait LightSource {
    /// Draws as many directions as there are triples of uniform numbers in [0, 1), sixteen at most, each by itself with the density
    /// that it tells; with estimates of their radiance. Overwrites that many places of each row.
    fn sample_into(&self, u: [&[f32]; 3], to: &mut LightRows);

    /// Gives estimates of the radiance, and the density of [`sample_into`](Self::sample_into), of the first `count` directions of `to`.
    fn evaluate_into(&self, count: usize, to: &mut LightRows);

    /// The map that this light is, if it is one: that is drawn from in vectors.
    fn environment(&self) -> Option<Environment<&[u32]>> {
        None
    }
}

impl<L: LightSource + ?Sized> LightSource for &L {
    fn sample_into(&self, u: [&[f32]; 3], to: &mut LightRows) {
        (**self).sample_into(u, to);
    }

    fn evaluate_into(&self, count: usize, to: &mut LightRows) {
        (**self).evaluate_into(count, to);
    }

    fn environment(&self) -> Option<Environment<&[u32]>> {
        (**self).environment()
    }
}

/// The estimate is the radiance of the map.
impl<M: AsRef<[u32]>> LightSource for Environment<M> {
    fn sample_into(&self, u: [&[f32]; 3], to: &mut LightRows) {
        for i in 0..u[0].len().min(LIGHT_BLOCK) {
            let drawn = self.sample([u[0][i], u[1][i], u[2][i]]);
            for k in 0..3 {
                (to.direction[k][i], to.radiance[k][i]) = (drawn.direction[k], drawn.radiance[k]);
            }
            to.pdf[i] = drawn.pdf;
        }
    }

    fn evaluate_into(&self, count: usize, to: &mut LightRows) {
        for i in 0..count.min(LIGHT_BLOCK) {
            let d = Vec3::new(to.direction[0][i], to.direction[1][i], to.direction[2][i]);
            let (radiance, pdf) = self.radiance_and_pdf(d);
            for k in 0..3 {
                to.radiance[k][i] = radiance[k];
            }
            to.pdf[i] = pdf;
        }
    }

    #[inline]
    fn environment(&self) -> Option<Environment<&[u32]>> {
        Some(self.by_reference())
    }
}
