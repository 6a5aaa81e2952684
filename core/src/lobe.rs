//! One spherical Gaussian: the kernel, and the lobe that adds an amplitude.

use crate::special;
use crate::{Error, float};
use core::f32::consts::{LOG2_E, PI};
use glam::Vec3;

/// Largest sharpness that lobes may have: beyond it the lobe is narrower than the spacing of f32 unit vectors.
pub const MAX_SHARPNESS: f32 = 1e8;

/// A spherical Gaussian of unit amplitude, `G(d) = exp(s (d . axis - 1))`, over the whole sphere.
#[doc(alias = "SRBF")]
#[doc(alias = "von Mises-Fisher")]
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Gaussian {
    /// Where the lobe is highest; unit vector.
    #[doc(alias = "center")]
    pub axis: Vec3,
    /// How narrow the lobe is, in [0, 1e8]; 0 is constant over the sphere.
    #[doc(alias = "bandwidth")]
    #[doc(alias = "lambda")]
    #[doc(alias = "kappa")]
    pub sharpness: f32,
}

impl Gaussian {
    /// Makes a kernel of a unit axis and a sharpness.
    ///
    /// # Errors
    /// [`Error::Axis`], [`Error::Sharpness`].
    pub fn new(axis: Vec3, sharpness: f32) -> Result<Self, Error> {
        if !axis.is_finite() || (axis.length_squared() - 1.0).abs() > 2e-3 {
            return Err(Error::Axis);
        }
        if !(0.0..=MAX_SHARPNESS).contains(&sharpness) {
            return Err(Error::Sharpness);
        }
        Ok(Self { axis, sharpness })
    }

    /// Evaluates `exp(-(s/2) |d - axis|^2)`, 1 at the axis.
    ///
    /// The chordal form: `s (d . axis - 1)` loses a digit per decade of sharpness.
    #[inline]
    pub fn value(&self, direction: Vec3) -> f32 {
        float::exp2((-0.5 * LOG2_E * self.sharpness) * (direction - self.axis).length_squared())
    }

    /// Integrates over the whole sphere; sr. See [`special::sphere_integral`].
    #[inline]
    pub fn integral(&self) -> f32 {
        special::sphere_integral(self.sharpness)
    }

    /// Evaluates the density `G / I` on the whole sphere; 1/sr.
    #[inline]
    pub fn pdf(&self, direction: Vec3) -> f32 {
        self.value(direction) / self.integral()
    }

    /// Draws a direction from the density, two uniform numbers in [0, 1) to a unit vector.
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> Vec3 {
        let w = special::one_minus_cos(u[0], self.sharpness);
        let sin_theta = float::sqrt(w * (2.0 - w));
        let (sin_phi, cos_phi) = float::sin_cos(2.0 * PI * u[1]);
        let (tangent, bitangent) = frame(self.axis);
        // The axis is added last and whole: `axis (1 - w)` would round the narrow lobe to the grid round the axis.
        let across = tangent * (sin_theta * cos_phi) + bitangent * (sin_theta * sin_phi);
        self.axis + (across - self.axis * w)
    }
}

/// Completes a unit vector to a right-handed frame, without a singular direction.
///
/// Source: Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
#[inline]
pub(crate) fn frame(n: Vec3) -> (Vec3, Vec3) {
    let sign = 1f32.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), Vec3::new(b, sign + n.y * n.y * a, -n.y))
}

/// A Gaussian with an amplitude per colour channel.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Lobe {
    /// Axis and sharpness.
    pub gaussian: Gaussian,
    /// Value at the axis, linear sRGB, not negative.
    #[doc(alias = "coefficient")]
    pub amplitude: Vec3,
}

impl Lobe {
    /// Makes a lobe of a unit axis, a sharpness and an amplitude.
    ///
    /// # Errors
    /// [`Error::Axis`], [`Error::Sharpness`], [`Error::Amplitude`].
    pub fn new(axis: Vec3, sharpness: f32, amplitude: Vec3) -> Result<Self, Error> {
        if !amplitude.is_finite() || amplitude.min_element() < 0.0 {
            return Err(Error::Amplitude);
        }
        Ok(Self { gaussian: Gaussian::new(axis, sharpness)?, amplitude })
    }
}
