//! One spherical Gaussian: the kernel, and the lobe that adds an amplitude.

use crate::error::Error;
use crate::zonal::around::{around, unit};
use crate::zonal::kernel::Kernel;
use crate::{color, float, special};
use core::f32::consts::LOG2_E;
use glam::Vec3;

/// Largest sharpness that lobes may have: beyond it the lobe is narrower than the spacing of f32 unit
/// vectors.
pub const MAX_SHARPNESS: f32 = 1e8;

/// A spherical Gaussian of unit amplitude, `G(d) = exp(s (d . axis - 1))`, over the whole sphere.
///
/// Every function is evaluated in a form that keeps its digits at every sharpness, and takes the extremes as
/// follows:
///
/// | input | result |
/// |---|---|
/// | sharpness 0, 1e-30 | the constant 1; samples are uniform over the sphere |
/// | sharpness 1e8 | full accuracy; a sample is rounded to the grid of f32 unit vectors, 1/2000 of the lobe's width |
/// | sharpness negative, NaN, infinite, above 1e8 | [`Gaussian::new`] refuses |
/// | axis off unit length by up to 1e-3 | [`Gaussian::new`] normalises it; beyond, or not finite, it refuses |
/// | axis exactly -z, or on the horizon | as any other |
/// | u = 0 | the axis itself; u = 1 - 2^-24 is `w = 16.6 / s` from it; u = 1 the antipode |
///
/// The fields are public and unchecked: if they would not pass [`Gaussian::new`] the results are unspecified
/// numbers. A [`product`](Gaussian::product) may have a sharpness up to 2e8, which every function here takes.
///
/// # Examples
/// ```
/// use srbf_core::Gaussian;
///
/// let lobe = Gaussian::new([0.0, 0.0, 1.0], 100.0)?;
/// assert_eq!(lobe.value([0.0, 0.0, 1.0]), 1.0);
/// let direction = lobe.sample([0.3, 0.7]);
/// let density = lobe.value(direction) / lobe.integral();
/// assert!((lobe.pdf(direction) / density - 1.0).abs() < 1e-5);
/// # Ok::<(), srbf_core::Error>(())
/// ```
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
    /// Makes a kernel of an axis, which it normalises, and a sharpness.
    ///
    /// # Errors
    /// [`Error::Axis`] unless the axis is finite and of length 1 within 1e-3; [`Error::Sharpness`].
    pub fn new(axis: impl Into<Vec3>, sharpness: f32) -> Result<Self, Error> {
        let axis = unit(axis.into()).ok_or(Error::Axis)?;
        if !(0.0..=MAX_SHARPNESS).contains(&sharpness) {
            return Err(Error::Sharpness);
        }
        Ok(Self { axis, sharpness })
    }

    /// Evaluates `exp(-(s/2) |d - axis|^2)`, 1 at the axis.
    ///
    /// The chordal form: `s (d . axis - 1)` loses a digit per decade of sharpness. Accuracy: relative
    /// `3e-7 (2 + |t|)`, `t` the exponent, where the result is a normal number.
    #[inline]
    pub fn value(&self, direction: impl Into<Vec3>) -> f32 {
        self.value_at((direction.into() - self.axis).length_squared())
    }

    /// Integrates over the whole sphere; sr. See [`special::sphere_integral`].
    #[inline]
    pub fn integral(&self) -> f32 {
        special::sphere_integral(self.sharpness)
    }

    /// Integrates over the cap within `w = 1 - cos angle` of the axis; sr. See [`special::cap_integral`].
    #[inline]
    pub fn cap_integral(&self, one_minus_cos: f32) -> f32 {
        special::cap_integral(self.sharpness, one_minus_cos)
    }

    /// Evaluates the density `G / I` on the whole sphere; 1/sr.
    #[inline]
    pub fn pdf(&self, direction: impl Into<Vec3>) -> f32 {
        self.value(direction) / self.integral()
    }

    /// Draws a direction from the density, two uniform numbers in [0, 1) to a unit vector.
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> Vec3 {
        around(self.axis, special::one_minus_cos(u[0], self.sharpness), u[1])
    }

    /// Inverts [`sample`](Self::sample): the two numbers that lead to a direction.
    ///
    /// The rounding of the direction limits it: `u[0]` returns within `3e-7 (2 + sqrt(s))`, `u[1]` within
    /// `1e-6 / sin theta`; at the axis `u[1]` is any number.
    #[inline]
    pub fn invert_sample(&self, direction: impl Into<Vec3>) -> [f32; 2] {
        Kernel::invert_sample(self, direction.into())
    }
}

impl Kernel for Gaussian {
    #[inline]
    fn axis(&self) -> Vec3 {
        self.axis
    }
    #[inline]
    fn value_at(&self, chord_squared: f32) -> f32 {
        float::exp2((-0.5 * LOG2_E * self.sharpness) * chord_squared)
    }
    #[inline]
    fn integral(&self) -> f32 {
        special::sphere_integral(self.sharpness)
    }
    #[inline]
    fn one_minus_cos(&self, u: f32) -> f32 {
        special::one_minus_cos(u, self.sharpness)
    }
    #[inline]
    fn share_within(&self, one_minus_cos: f32) -> f32 {
        special::share_within(self.sharpness, one_minus_cos)
    }
}

/// A Gaussian with an amplitude per colour channel.
///
/// # Examples
/// ```
/// use srbf_core::Lobe;
///
/// let red = Lobe::new([0.0, 0.0, 1.0], 100.0, [0.8, 0.2, 0.1])?;
/// assert_eq!(red.value([0.0, 0.0, 1.0]).x, 0.8);
/// assert!(red.integral().x > red.integral().y);
/// # Ok::<(), srbf_core::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Lobe {
    /// Axis and sharpness.
    pub gaussian: Gaussian,
    /// Value at the axis, linear sRGB; its luminance is not negative, a channel may be.
    #[doc(alias = "coefficient")]
    pub amplitude: Vec3,
}

impl Lobe {
    /// Makes a lobe of a unit axis, a sharpness and an amplitude.
    ///
    /// A channel may be negative, as it is in colours outside the gamut of sRGB: no channel may be farther
    /// from 0 than 32 times the luminance. Densities and draws see the luminance alone.
    ///
    /// # Errors
    /// [`Error::Axis`], [`Error::Sharpness`], [`Error::Amplitude`].
    pub fn new(axis: impl Into<Vec3>, sharpness: f32, amplitude: impl Into<Vec3>) -> Result<Self, Error> {
        let amplitude = amplitude.into();
        if !color::is_admissible(amplitude) {
            return Err(Error::Amplitude);
        }
        Ok(Self { gaussian: Gaussian::new(axis, sharpness)?, amplitude })
    }

    /// Evaluates `amplitude G(d)`, linear sRGB.
    #[inline]
    pub fn value(&self, direction: impl Into<Vec3>) -> Vec3 {
        self.amplitude * self.gaussian.value(direction)
    }

    /// Integrates over the whole sphere; unit of the amplitude times sr. Infinite where f32 overflows.
    #[inline]
    pub fn integral(&self) -> Vec3 {
        self.amplitude * self.gaussian.integral()
    }
}
