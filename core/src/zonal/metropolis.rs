//! The Metropolis random walk of Weng and Shih 2006, sections 4.2.2 and 5.2: samples of a kernel that has no
//! inverse.

use super::around::around;
use super::kernel::Kernel;
use crate::float;
use glam::Vec3;
use rand_core::Rng;

/// Half the widest proposal, as a share of the range of the walk: wide enough to cross the range in the
/// default five steps, narrow enough that most proposals for a bell are accepted.
const REACH: f32 = 0.5;

/// A random walk over the angle to the axis, whose density tends to that of the kernel.
///
/// The density in theta is `K(theta) sin theta`: the kernel times the circumference of its circle. Every sample starts at a
/// uniform angle of the range and takes `steps` steps. Each goes to a uniform angle within half the range, mirrored at the ends,
/// and is accepted with probability `min(1, target' / target)`. Samples are independent of each other; the influence of the start
/// falls geometrically with the steps.
///
/// The walk is confined to where the kernel exceeds `floor` times its value at the axis. The rest is
/// never drawn (of a Gaussian a share `floor`), whatever the number of steps. So the samples have no exactly
/// known density; dividing by the kernel's own leaves a bias that `cargo lab samples` shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metropolis {
    /// Steps a sample.
    pub steps: u32,
    /// Smallest value relative to the axis that the walk enters, in [0, 1).
    pub floor: f32,
}

impl Default for Metropolis {
    /// The thesis's: five steps, floor 0.01.
    fn default() -> Self {
        Self { steps: 5, floor: 0.01 }
    }
}

impl Metropolis {
    /// Finds the range of the walk: the angle, radians, at which a kernel that falls from its axis meets the
    /// floor.
    ///
    /// `kernel` is a function of `w = 1 - cos theta`. Returns: pi for a kernel that stays above the floor.
    /// Not to be repeated per sample.
    pub fn range(&self, kernel: impl Fn(f32) -> f32) -> f32 {
        let least = self.floor * kernel(0.0);
        let above = |theta: f32| kernel(one_minus_cos(theta)) > least;
        let (mut low, mut high) = (0.0, core::f32::consts::PI);
        if above(high) {
            return high;
        }
        // Halving finds the scale of a kernel of any sharpness, bisection the angle in it.
        while high > 1e-8 && !above(0.5 * high) {
            high *= 0.5;
        }
        for _ in 0..24 {
            let middle = 0.5 * (low + high);
            if above(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        high
    }

    /// Walks for one sample: `1 - cos theta` with a density that tends to `K(theta) sin theta` in theta.
    ///
    /// `kernel` is a function of `w = 1 - cos theta`; `range` is what [`range`](Self::range) gives for it.
    pub fn one_minus_cos<R: Rng + ?Sized>(
        &self,
        kernel: impl Fn(f32) -> f32,
        range: f32,
        rng: &mut R,
    ) -> f32 {
        // The target over w: sin theta = sqrt(w (2 - w)).
        let target = |w: f32| kernel(w) * float::sqrt(w * (2.0 - w));
        let mut theta = range * uniform(rng);
        let mut w = one_minus_cos(theta);
        let mut density = target(w);
        for _ in 0..self.steps {
            let step = REACH * range * (2.0 * uniform(rng) - 1.0);
            // Mirrored at both ends; a step is shorter than the range, so once is enough.
            let moved = (theta + step).abs();
            let proposal = if moved > range { 2.0 * range - moved } else { moved };
            let proposed_w = one_minus_cos(proposal);
            let proposed = target(proposed_w);
            if uniform(rng) * density < proposed {
                (theta, w, density) = (proposal, proposed_w, proposed);
            }
        }
        w
    }

    /// Draws a direction round the axis of a kernel; see [`one_minus_cos`](Self::one_minus_cos).
    pub fn sample<K: Kernel, R: Rng + ?Sized>(&self, kernel: &K, range: f32, rng: &mut R) -> Vec3 {
        let w = self.one_minus_cos(|w| kernel.value_at(2.0 * w), range, rng);
        around(kernel.axis(), w, uniform(rng))
    }
}

/// `1 - cos theta = 2 sin^2(theta / 2)`, without the cancellation.
fn one_minus_cos(theta: f32) -> f32 {
    let (sin, _) = float::sin_cos(0.5 * theta);
    2.0 * sin * sin
}

/// Uniform in [0, 1): the upper 24 bits.
fn uniform<R: Rng + ?Sized>(rng: &mut R) -> f32 {
    (rng.next_u32() >> 8) as f32 * (1.0 / 16_777_216.0)
}
