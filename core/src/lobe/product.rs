//! Products of lobes, and their integrals: again lobes, in closed form.
//!
//! With `r = s1 axis1 + s2 axis2`, the product of two Gaussians is
//!
//! ```text
//! G1(d) G2(d) = exp(-e) exp(|r| (d . r/|r| - 1)),   e = s1 + s2 - |r| = s1 s2 |axis1 - axis2|^2 / (s1 + s2 + |r|)
//! ```
//!
//! The right form of `e` does not cancel (multiply by `s1 + s2 + |r|` and expand). `r` does, where the axes
//! are nearly opposite and the sharpness equal; it is summed to twice the digits of f32.

use super::gaussian::{Gaussian, Lobe};
use crate::simd::error_free::{length_squared_minus_one, sum_of_products, two_product, two_sum};
use crate::{float, special};
use core::f32::consts::LOG2_E;
use glam::Vec3;

/// The product of two Gaussians: a Gaussian times `exp(-exponent)`.
///
/// The axis is held to twice the digits of f32: rounded to f32 it would turn a product of sharpness 1e8 by
/// 1/2000 of its width, and the value on its flank with it.
///
/// # Examples
/// ```
/// use srbf_core::Gaussian;
///
/// let a = Gaussian::new([0.0, 0.0, 1.0], 20.0)?;
/// let b = Gaussian::new([0.6, 0.0, 0.8], 50.0)?;
/// let both = a.product(&b);
/// let direction = [0.36, 0.0, 0.932_952_3];
/// let expected = a.value(direction) * b.value(direction);
/// assert!((both.value(direction) / expected - 1.0).abs() < 1e-4);
/// # Ok::<(), srbf_core::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaussianProduct {
    /// The Gaussian factor, its axis rounded to f32. Sharpness up to 2e8; axes opposite and of equal
    /// sharpness give 0.
    pub gaussian: Gaussian,
    /// What rounding took from the axis.
    pub axis_low: Vec3,
    /// `e`, not negative: the product at its own axis is `exp(-e)`.
    pub exponent: f32,
}

impl GaussianProduct {
    /// Evaluates the product towards a direction: `exp(-e - (|r|/2) |d - axis|^2)`.
    ///
    /// Accuracy: relative `3e-7 (2 + |t|)`, `t` the whole exponent.
    #[inline]
    pub fn value(&self, direction: impl Into<Vec3>) -> f32 {
        let chord = (direction.into() - self.gaussian.axis) - self.axis_low;
        float::exp2(-LOG2_E * (self.exponent + 0.5 * self.gaussian.sharpness * chord.length_squared()))
    }

    /// Integrates the product over the sphere, `exp(-e) I(|r|)`; sr.
    ///
    /// The spherical singular integral of the two Gaussians, which is also their convolution at the angle
    /// between their axes. Accuracy: relative `3e-7 (2 + e)`.
    /// Source: Weng and Shih 2006, eq. 6 with m = 2 (Tsai and Shih 2006).
    #[doc(alias = "spherical singular integral")]
    #[doc(alias = "convolution")]
    #[inline]
    pub fn integral(&self) -> f32 {
        float::exp(-self.exponent) * special::sphere_integral(self.gaussian.sharpness)
    }
}

impl Gaussian {
    /// Multiplies two Gaussians.
    ///
    /// Axes that are opposite with equal sharpness give sharpness 0, a constant, with the axis of `self`.
    pub fn product(&self, other: &Self) -> GaussianProduct {
        let (s1, s2) = (self.sharpness, other.sharpness);

        // r to twice the digits of f32, so that nearly opposite axes may cancel. The scale, a power of two
        // near the reciprocal of the sharpness, is exact and keeps tiny sharpness from underflowing.
        let exponent_bits = s1.max(s2).to_bits() >> 23;
        let scale = f32::from_bits((254 - exponent_bits.clamp(1, 253)) << 23);
        // What rounding adds to the length of either axis is taken off again: of opposite ones it would be
        // all of r.
        let (p1, p2) = (s1 * scale, s2 * scale);
        let excess1 = 0.5 * p1 * length_squared_minus_one(self.axis.to_array());
        let excess2 = 0.5 * p2 * length_squared_minus_one(other.axis.to_array());
        let (mut high, mut low) = (Vec3::ZERO, Vec3::ZERO);
        for i in 0..3 {
            let (h, l) = sum_of_products(p1, self.axis[i], p2, other.axis[i]);
            (high[i], low[i]) = two_sum(h, l - (excess1 * self.axis[i] + excess2 * other.axis[i]));
        }
        let length = float::sqrt(high.length_squared());
        if length < 1e-16 {
            let gaussian = Gaussian { axis: self.axis, sharpness: 0.0 };
            return GaussianProduct { gaussian, axis_low: Vec3::ZERO, exponent: s1 + s2 };
        }

        // r / |r|: what `high / length` leaves over is exact but for its own rounding, and so is the excess
        // of the length of the quotient over 1.
        let inverse = 1.0 / length;
        let axis = high * inverse;
        let mut remainder = low;
        for i in 0..3 {
            let (h, l) = two_product(axis[i], length);
            remainder[i] += (high[i] - h) - l;
        }
        let axis_low = remainder * inverse;
        let excess = 0.5 * length_squared_minus_one(axis.to_array()) + axis.dot(axis_low);

        let sharpness = (length + length * excess) / scale;
        let apart = (self.axis - other.axis).length_squared();
        let exponent = s1.max(s2) * apart * (s1.min(s2) / ((s1 + s2) + sharpness));
        let gaussian = Gaussian { axis, sharpness };
        GaussianProduct { gaussian, axis_low: axis_low - axis * excess, exponent }
    }
}

/// `a b exp(-e)` without an intermediate that under- or overflows.
fn attenuate(a: Vec3, b: Vec3, exponent: f32) -> Vec3 {
    // In quarters, as exp(-e) may underflow where two amplitudes of 1e38 bring the product back.
    let quarter = float::exp(-0.25 * exponent);
    ((a * quarter) * quarter) * ((b * quarter) * quarter)
}

impl Lobe {
    /// Multiplies two lobes, amplitudes channel by channel; the axis is rounded to f32, see
    /// [`GaussianProduct`].
    pub fn product(&self, other: &Self) -> Self {
        let product = self.gaussian.product(&other.gaussian);
        let amplitude = attenuate(self.amplitude, other.amplitude, product.exponent);
        Self { gaussian: product.gaussian, amplitude }
    }

    /// Integrates the product of two lobes over the sphere. Infinite where f32 overflows.
    #[doc(alias = "spherical singular integral")]
    pub fn inner_product(&self, other: &Self) -> Vec3 {
        self.integrated_product(other, Gaussian::integral)
    }

    /// The product of two lobes by an integral of its Gaussian. The product alone may overflow where this does not.
    pub(crate) fn integrated_product(&self, other: &Self, integral: impl Fn(&Gaussian) -> f32) -> Vec3 {
        let product = self.gaussian.product(&other.gaussian);
        let root = float::sqrt(integral(&product.gaussian));
        attenuate(self.amplitude * root, other.amplitude * root, product.exponent)
    }

    /// The lobe mirrored in z = 0.
    pub(crate) fn mirrored(mut self) -> Self {
        self.gaussian.axis.z = -self.gaussian.axis.z;
        self
    }
}
