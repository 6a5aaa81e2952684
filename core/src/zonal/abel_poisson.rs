//! The Abel-Poisson kernel: a lobe with a tail that falls only as the inverse cube of the distance.

use super::around::unit;
use super::kernel::Kernel;
use crate::error::Error;
use crate::float;
use core::f32::consts::PI;
use glam::Vec3;

/// The Abel-Poisson kernel `A(d) = (1 - h^2) / (1 - 2 h cos theta + h^2)^(3/2)`, held as `epsilon = 1 - h`.
///
/// `A(d) = eps (2 - eps) / (eps^2 + h |d - axis|^2)^(3/2)`: near h = 1 the plain form has lost the digits of
/// `1 - h`. At the axis it is `(2 - eps) / eps^2`; its integral over the sphere is 4 pi for every h.
///
/// | input | result |
/// |---|---|
/// | h = 0 (epsilon 1) | the constant 1 |
/// | epsilon 1e-8 | full accuracy; peak 2e16 |
/// | h negative, 1 and above, NaN | refused |
///
/// Source: Tsai and Shih 2006; Freeden, Gervens and Schreiner 1998.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AbelPoisson {
    axis: Vec3,
    epsilon: f32,
}

impl AbelPoisson {
    /// Smallest `1 - h`.
    pub const MIN_EPSILON: f32 = 1e-8;

    /// Makes a kernel of an axis, which it normalises, and `h` in [0, 1).
    ///
    /// # Errors
    /// [`Error::Axis`]; [`Error::Kernel`] for h outside the range.
    pub fn new(axis: impl Into<Vec3>, h: f32) -> Result<Self, Error> {
        // A tiny negative h would round to an epsilon of 1.
        if h < 0.0 {
            return Err(Error::Kernel);
        }
        Self::from_epsilon(axis, 1.0 - h)
    }

    /// Makes a kernel of an axis, which it normalises, and `epsilon = 1 - h` in [1e-8, 1].
    ///
    /// # Errors
    /// [`Error::Axis`]; [`Error::Kernel`] for epsilon outside the range.
    pub fn from_epsilon(axis: impl Into<Vec3>, epsilon: f32) -> Result<Self, Error> {
        let axis = unit(axis.into()).ok_or(Error::Axis)?;
        if !(Self::MIN_EPSILON..=1.0).contains(&epsilon) {
            return Err(Error::Kernel);
        }
        Ok(Self { axis, epsilon })
    }

    /// Convolves two kernels: the integral over the sphere of their product, sr.
    ///
    /// `4 pi A(axis1 . axis2; h1 h2)`, with `1 - h1 h2 = eps1 + eps2 - eps1 eps2`. Accuracy: relative 1e-6.
    #[doc(alias = "spherical singular integral")]
    pub fn inner_product(&self, other: &Self) -> f32 {
        let epsilon = self.epsilon + other.epsilon * (1.0 - self.epsilon);
        4.0 * PI * Self { axis: self.axis, epsilon }.value(other.axis)
    }
}

impl Kernel for AbelPoisson {
    #[inline]
    fn axis(&self) -> Vec3 {
        self.axis
    }

    /// Accuracy: relative 1e-6.
    #[inline]
    fn value_at(&self, chord_squared: f32) -> f32 {
        let eps = self.epsilon;
        let x = eps * eps + (1.0 - eps) * chord_squared;
        // eps / sqrt(x) is at most 1: the cube of sqrt(x) alone would underflow.
        let root = float::sqrt(x);
        (2.0 - eps) * (eps / root) / x
    }

    #[inline]
    fn integral(&self) -> f32 {
        4.0 * PI
    }

    /// `w = eps u (q + eps) / D`, `q = eps (2 - eps) / D`, `D = eps + 2 h (1 - u)`: neither cancels nor
    /// divides by h.
    ///
    /// Accuracy: relative 1e-6 for every `u`.
    #[inline]
    fn one_minus_cos(&self, u: f32) -> f32 {
        let eps = self.epsilon;
        let d = eps + 2.0 * (1.0 - eps) * (1.0 - u);
        let q = eps * (2.0 - eps) / d;
        (u * (eps / d) * (q + eps)).clamp(0.0, 2.0)
    }

    /// `(2 - eps) w / (S (S + eps))`, `S = sqrt(eps^2 + 2 h w)`. Accuracy: relative 1e-6.
    #[inline]
    fn share_within(&self, one_minus_cos: f32) -> f32 {
        let eps = self.epsilon;
        let root = float::sqrt(eps * eps + 2.0 * (1.0 - eps) * one_minus_cos);
        ((2.0 - eps) * (one_minus_cos / root) / (root + eps)).min(1.0)
    }
}
