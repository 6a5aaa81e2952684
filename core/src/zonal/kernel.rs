//! What all zonal kernels share: they depend on the angle to an axis alone, and that angle can be drawn by
//! inversion.

use super::around::{around, where_around};
use crate::float::BELOW_ONE;
use glam::Vec3;

/// A kernel on the sphere, not negative, that depends on the angle to its axis alone.
///
/// An implementation gives five functions of one number; value, density and sampling follow, and with
/// [`Folded`](crate::Folded) the folded and squeezed forms.
///
/// ```
/// use srbf_core::{AbelPoisson, Kernel, Vec3};
///
/// let kernel = AbelPoisson::new(Vec3::Z, 0.9)?;
/// let direction = kernel.sample([0.3, 0.7]);
/// assert!((direction.length() - 1.0).abs() < 1e-6);
/// assert!((kernel.pdf(direction) * kernel.integral() / kernel.value(direction) - 1.0).abs() < 1e-6);
/// let [u, _] = kernel.invert_sample(direction);
/// assert!((u - 0.3).abs() < 1e-4);
/// # Ok::<(), srbf_core::Error>(())
/// ```
pub trait Kernel {
    /// Where the kernel is centred; unit vector.
    fn axis(&self) -> Vec3;

    /// Evaluates the kernel where `|d - axis|^2 = 2 (1 - cos theta)` is `chord_squared`, in [0, 4].
    fn value_at(&self, chord_squared: f32) -> f32;

    /// Integrates over the whole sphere; sr.
    fn integral(&self) -> f32;

    /// Inverts the distribution: `1 - cos theta` of the cap round the axis that holds a share `u`, in [0, 1].
    fn one_minus_cos(&self, u: f32) -> f32;

    /// Share of the integral within `1 - cos theta` of the axis, in [0, 1].
    fn share_within(&self, one_minus_cos: f32) -> f32;

    /// Evaluates the kernel towards a direction.
    #[inline]
    fn value(&self, direction: Vec3) -> f32 {
        self.value_at((direction - self.axis()).length_squared())
    }

    /// Evaluates the density of [`sample`](Self::sample); 1/sr.
    #[inline]
    fn pdf(&self, direction: Vec3) -> f32 {
        self.value(direction) / self.integral()
    }

    /// Draws a direction from the density, two uniform numbers in [0, 1) to a unit vector.
    #[inline]
    fn sample(&self, u: [f32; 2]) -> Vec3 {
        around(self.axis(), self.one_minus_cos(u[0]), u[1])
    }

    /// Inverts [`sample`](Self::sample): the two numbers that lead to a direction.
    #[inline]
    fn invert_sample(&self, direction: Vec3) -> [f32; 2] {
        let [w, turns] = where_around(self.axis(), direction);
        [self.share_within(w).min(BELOW_ONE), turns]
    }
}
