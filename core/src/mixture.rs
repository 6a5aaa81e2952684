//! A mixture: the lobes that one outgoing direction needs, ready to evaluate and sample.

use crate::float;
use crate::squeeze::{Seen, Squeeze};
use crate::{Error, Gaussian, Lobe, special};
use core::f32::consts::LOG2_E;
use glam::Vec3;

/// Most lobes that a mixture can hold.
pub const MAX_LOBES: usize = 64;

/// Share of a lobe's integral that may lie below the horizon before the lobe is folded.
///
/// Smaller folds more lobes and costs an exponential each. Below this the error of leaving the fold out is under the
/// rounding of the integral itself; see [`Mixture`], "Which lobes are folded".
const FOLD_BOUND: f32 = 1e-7;

/// Luminance of a linear sRGB colour (Rec. 709 weights): what lobes are chosen by and densities are weighted with.
#[inline]
pub fn luminance(rgb: Vec3) -> f32 {
    0.2126 * rgb.x + 0.7152 * rgb.y + 0.0722 * rgb.z
}

/// Where a mixture lives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Domain {
    /// The whole sphere: no fold.
    Sphere,
    /// The upper hemisphere, z >= 0: what a lobe has below the horizon is mirrored back up; 0 below.
    #[default]
    Hemisphere,
}

/// A direction drawn from a mixture, with everything that a renderer asks next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Incident direction, unit vector in the caller's shading frame.
    pub direction: Vec3,
    /// Density of the whole mixture at the direction; 1/sr.
    pub pdf: f32,
    /// `f cos` at the direction, linear sRGB; 1/sr.
    pub value: Vec3,
}

/// A sum of lobes for one outgoing direction, in storage for `N` of them (64 at most), without allocation.
///
/// The first lobes see the squeezed direction, the others the direction itself.
///
/// # Which lobes are folded
/// A folded lobe is `a (G(d) + G(d mirrored in z = 0))`, whose integral over the hemisphere is that of the lobe over
/// the sphere. The second term is left out, once per lobe, where the share of the lobe below the horizon is at most
/// 1e-7. Below the horizon `cos <= t = sqrt(1 - axis.z^2)`, and a Gaussian has a share
/// `(exp(-s (1 - t)) - exp(-2 s)) / (1 - exp(-2 s)) <= exp(-s (1 - t))` of its integral at `cos <= t`.
#[derive(Clone, Debug)]
pub struct Mixture<const N: usize> {
    pub(crate) count: usize,
    pub(crate) squeezed: usize,
    pub(crate) domain: Domain,
    pub(crate) squeeze: Squeeze,
    /// Bit k: lobe k needs its fold.
    pub(crate) folded: u64,
    pub(crate) albedo: Vec3,
    /// Luminance of the albedo: the normaliser of the density.
    pub(crate) power: f32,
    pub(crate) axis_x: [f32; N],
    pub(crate) axis_y: [f32; N],
    pub(crate) axis_z: [f32; N],
    pub(crate) sharpness: [f32; N],
    pub(crate) red: [f32; N],
    pub(crate) green: [f32; N],
    pub(crate) blue: [f32; N],
    /// Luminance amplitude over the mixture's integral: the density is the sum of `weight G`.
    pub(crate) weight: [f32; N],
    /// Running share of the integral, 1 from the last lobe that can be chosen on.
    pub(crate) cumulative: [f32; N],
}

impl<const N: usize> Default for Mixture<N> {
    fn default() -> Self {
        Self::empty()
    }
}

impl<const N: usize> Mixture<N> {
    /// The mixture without lobes: value, albedo and density are 0, and no sample can be drawn.
    pub const fn empty() -> Self {
        const { assert!(N <= MAX_LOBES) };
        Self {
            count: 0,
            squeezed: 0,
            domain: Domain::Hemisphere,
            squeeze: Squeeze::NONE,
            folded: 0,
            albedo: Vec3::ZERO,
            power: 0.0,
            axis_x: [0.0; N],
            axis_y: [0.0; N],
            axis_z: [0.0; N],
            sharpness: [0.0; N],
            red: [0.0; N],
            green: [0.0; N],
            blue: [0.0; N],
            weight: [0.0; N],
            cumulative: [0.0; N],
        }
    }

    /// Makes a mixture of folded, round lobes on the upper hemisphere.
    ///
    /// # Errors
    /// [`Error::Capacity`]; and what [`Lobe::new`] refuses.
    pub fn hemisphere(lobes: &[Lobe]) -> Result<Self, Error> {
        Self::new(Domain::Hemisphere, 1.0, &[], lobes)
    }

    /// Makes a mixture of round lobes on the whole sphere.
    ///
    /// # Errors
    /// [`Error::Capacity`]; and what [`Lobe::new`] refuses.
    pub fn sphere(lobes: &[Lobe]) -> Result<Self, Error> {
        Self::new(Domain::Sphere, 1.0, &[], lobes)
    }

    /// Makes a mixture of squeezed and round lobes; the squeeze narrows along y.
    ///
    /// # Errors
    /// [`Error::Capacity`], [`Error::Squeeze`]; and what [`Lobe::new`] refuses.
    pub fn new(domain: Domain, squeeze: f32, squeezed: &[Lobe], round: &[Lobe]) -> Result<Self, Error> {
        let needed = squeezed.len() + round.len();
        if needed > N {
            return Err(Error::Capacity { needed, available: N });
        }
        if !(0.01..=2.0).contains(&squeeze) {
            return Err(Error::Squeeze);
        }
        let mut mixture = Self::empty();
        mixture.begin(domain, Squeeze { azimuth: [1.0, 0.0], inverse: 1.0 / squeeze }, squeezed.len());
        for lobe in squeezed.iter().chain(round) {
            let checked = Lobe::new(lobe.gaussian.axis, lobe.gaussian.sharpness, lobe.amplitude)?;
            mixture.push(checked.gaussian, checked.amplitude);
        }
        mixture.finish();
        Ok(mixture)
    }

    /// Starts over, keeping the storage.
    pub(crate) fn begin(&mut self, domain: Domain, squeeze: Squeeze, squeezed: usize) {
        self.count = 0;
        self.squeezed = squeezed;
        self.domain = domain;
        self.squeeze = squeeze;
        self.folded = 0;
        self.albedo = Vec3::ZERO;
        self.power = 0.0;
    }

    /// Adds one lobe, whose parts the caller has checked.
    #[inline]
    pub(crate) fn push(&mut self, gaussian: Gaussian, amplitude: Vec3) {
        let (k, s) = (self.count, gaussian.sharpness);
        let rgb = amplitude * gaussian.integral();
        self.axis_x[k] = gaussian.axis.x;
        self.axis_y[k] = gaussian.axis.y;
        self.axis_z[k] = gaussian.axis.z;
        self.sharpness[k] = s;
        self.red[k] = amplitude.x;
        self.green[k] = amplitude.y;
        self.blue[k] = amplitude.z;
        self.weight[k] = luminance(amplitude);
        self.power += luminance(rgb);
        self.cumulative[k] = self.power;
        self.albedo += rgb;
        if self.domain == Domain::Hemisphere
            && special::share_below_horizon_bound(gaussian.axis.z, s) > FOLD_BOUND
        {
            self.folded |= 1 << k;
        }
        self.count += 1;
    }

    /// Normalises the density and closes the distribution over the lobes.
    pub(crate) fn finish(&mut self) {
        if self.power > 0.0 && self.power.is_finite() {
            let inverse = 1.0 / self.power;
            let total = self.power;
            for k in 0..self.count {
                self.weight[k] *= inverse;
                // The last lobe that adds anything gets exactly 1, and so do the black ones behind it.
                self.cumulative[k] =
                    if self.cumulative[k] >= total { 1.0 } else { self.cumulative[k] * inverse };
            }
        } else {
            self.weight[..self.count].fill(0.0);
            self.cumulative[..self.count].fill(0.0);
            self.power = 0.0;
        }
    }

    /// Number of lobes.
    #[inline]
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there is no lobe.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Number of lobes that see the squeezed direction; they come first.
    #[inline]
    pub fn squeezed_len(&self) -> usize {
        self.squeezed
    }

    /// The squeeze c, 1 for none.
    #[inline]
    pub fn squeeze(&self) -> f32 {
        1.0 / self.squeeze.inverse
    }

    /// Lobe `k` in the frame of the view, or `None` past the end.
    pub fn lobe(&self, k: usize) -> Option<Lobe> {
        (k < self.count).then(|| Lobe {
            gaussian: self.gaussian(k),
            amplitude: Vec3::new(self.red[k], self.green[k], self.blue[k]),
        })
    }

    #[inline]
    pub(crate) fn gaussian(&self, k: usize) -> Gaussian {
        let axis = Vec3::new(self.axis_x[k], self.axis_y[k], self.axis_z[k]);
        Gaussian { axis, sharpness: self.sharpness[k] }
    }

    /// Integral of the value over the domain, in closed form: `sum a I(s)`; linear sRGB.
    ///
    /// For a material, the directional albedo towards the outgoing direction.
    #[inline]
    pub fn albedo(&self) -> Vec3 {
        self.albedo
    }

    /// Evaluates `f cos` towards an incident direction, linear sRGB; 1/sr. 0 below the horizon of a hemisphere.
    #[inline]
    pub fn evaluate(&self, direction: Vec3) -> Vec3 {
        let mut sum = Vec3::ZERO;
        self.for_each_lobe(direction, |k, g| {
            sum += Vec3::new(self.red[k], self.green[k], self.blue[k]) * g;
        });
        sum
    }

    /// Evaluates the density of [`sample`](Self::sample) at a direction; 1/sr.
    #[inline]
    pub fn pdf(&self, direction: Vec3) -> f32 {
        let mut sum = 0.0;
        self.for_each_lobe(direction, |k, g| sum += self.weight[k] * g);
        sum
    }

    /// Value and density in one pass over the lobes.
    #[inline]
    pub fn evaluate_and_pdf(&self, direction: Vec3) -> (Vec3, f32) {
        let (mut value, mut pdf) = (Vec3::ZERO, 0.0);
        self.for_each_lobe(direction, |k, g| {
            value += Vec3::new(self.red[k], self.green[k], self.blue[k]) * g;
            pdf += self.weight[k] * g;
        });
        (value, pdf)
    }

    /// Calls with every lobe and its unit value at the direction, fold and change of solid angle included.
    #[inline]
    pub(crate) fn for_each_lobe(&self, direction: Vec3, mut each: impl FnMut(usize, f32)) {
        // The comparison is false for a NaN too.
        let above = direction.z >= 0.0;
        if !above && self.domain == Domain::Hemisphere {
            return;
        }
        let turned = self.squeeze.turn(direction);
        let mut run = |seen: Seen, from: usize, to: usize| {
            for k in from..to {
                let gaussian = self.gaussian(k);
                let chord = (seen.high - gaussian.axis) + seen.low;
                let rate = -0.5 * LOG2_E * gaussian.sharpness;
                let mut g = float::exp2(rate * chord.length_squared());
                if self.folded >> k & 1 == 1 {
                    let mirrored = Vec3::new(chord.x, chord.y, (seen.high.z + gaussian.axis.z) + seen.low.z);
                    g += float::exp2(rate * mirrored.length_squared());
                }
                each(k, g * seen.scale);
            }
        };
        if self.squeezed > 0 {
            run(self.squeeze.squeeze(&turned), 0, self.squeezed);
        }
        run(turned, self.squeezed, self.count);
    }

    /// Draws an incident direction from the density: lobe by `u[0]`, direction in it by `u[1]` and `u[2]`.
    ///
    /// `None` where every amplitude is 0: such a mixture reflects nothing. No sample is wasted below the horizon.
    /// The three numbers are uniform in [0, 1).
    /// Source: Weng and Shih 2006, section 4.2.2, eq. 14; differs: what falls below the horizon is mirrored up.
    #[inline]
    pub fn sample(&self, u: [f32; 3]) -> Option<Sample> {
        let direction = self.draw_direction(u)?;
        let (value, pdf) = self.evaluate_and_pdf(direction);
        // A density that f32 rounds to 0 cannot be divided by: far out in a tail, where the value is 0 too.
        (pdf > 0.0).then_some(Sample { direction, pdf, value })
    }

    /// Draws a direction without its density; `None` where every amplitude is 0.
    #[inline]
    pub(crate) fn draw_direction(&self, u: [f32; 3]) -> Option<Vec3> {
        if self.power == 0.0 {
            return None;
        }
        let k = self.cumulative[..self.count].iter().position(|&c| u[0] < c).unwrap_or(self.count - 1);
        Some(self.direction_from_lobe(k, [u[1], u[2]]))
    }

    /// Draws a direction from the density of one lobe, `k < len`.
    #[inline]
    pub(crate) fn direction_from_lobe(&self, k: usize, u: [f32; 2]) -> Vec3 {
        let mut d = self.gaussian(k).sample(u);
        if k < self.squeezed {
            d = self.squeeze.unsqueeze(d);
        }
        if self.domain == Domain::Hemisphere {
            d.z = d.z.abs();
        }
        self.squeeze.turn_back(d).normalize()
    }

    /// Luminance of the albedo; what the density was normalised by.
    #[inline]
    pub fn power(&self) -> f32 {
        self.power
    }

    /// Checks for tests: the sphere integral of every lobe by the closed form, sr.
    #[doc(hidden)]
    pub fn lobe_integral(&self, k: usize) -> f32 {
        special::sphere_integral(self.sharpness[k])
    }
}
