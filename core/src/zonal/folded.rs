//! A kernel folded at the horizon, and squeezed, as a reflecting surface needs it of a kernel that lives on
//! the sphere.

use super::kernel::Kernel;
use crate::error::Error;
use crate::squeeze::{Seen, Squeeze};
use glam::Vec3;

/// A kernel folded onto the upper hemisphere and squeezed across the plane of incidence.
///
/// # The fold
/// With `m(d)` the direction mirrored in z = 0, a kernel `K` folded is, for d.z >= 0,
///
/// ```text
/// F(d) = K(d) + K(m(d))
/// ```
///
/// *Integral.* The mirror keeps areas and exchanges the hemispheres. So the integral of `K(m(d))` over the upper one is that of
/// `K` over the lower one: F has over the hemisphere the integral that K has over the sphere.
///
/// *Sampling.* Draw d from K / I on the sphere and mirror it if d.z < 0. An upper direction is reached from
/// itself and from its mirror image, both with a Jacobian of 1, so its density is (K(d) + K(m(d))) / I = F /
/// I. No sample is lost.
///
/// *Inverse.* Two pairs of numbers lead to each direction. [`invert_sample`](Self::invert_sample) takes one
/// of them at random in the ratio K(d) : K(m(d)). Then directions drawn from F with an independent choice
/// give numbers that are uniform on the square: on the preimage of each branch the density of the pair is F/I
/// times K/F over K/I = 1.
///
/// # When the fold of a Gaussian can be left out
/// Let the axis be at height z >= 0. The largest cosine to it below the horizon is `t = sqrt(1 - z^2)`, at the point of the
/// horizon under the axis. So there `G <= exp(-s (1 - t))`. The share of the integral below the horizon is at most that of the
/// directions with a cosine of at most t:
///
/// ```text
/// (exp(-s (1 - t)) - exp(-2 s)) / (1 - exp(-2 s)) <= exp(-s (1 - t))          since (a - b)/(1 - b) <= a for a <= 1
/// ```
///
/// [`share_below_horizon_bound`](crate::special::share_below_horizon_bound) is this bound; a mixture leaves
/// the second term out where it is at most 1e-7. The error of the value is then at most 1e-7 of the lobe's peak. That of the
/// integral is at most 1e-7 of itself, less than its rounding. Close to the horizon, where G is below 1e-7 of its peak, the
/// *relative* error of that one lobe reaches 1/2.
///
/// # The squeeze
/// With M = diag(1, 1/c, 1), `u = M d / r`, `r = |M d|`. For a linear map the solid angles have the ratio
/// `dw(u) = det M / |M d|^3 dw(d) = dw(d) / (c r^3)`: a cone over the area element dA at d has the volume `dA / 3`. M multiplies
/// it by det M, and scaling its base back to the unit sphere divides it by r^3. Hence `F(u) / (c r^3)` has the integral of F; a
/// sample u of F / I goes to `M^-1 u` normalised, with exactly the density `F(u) / (I c r^3)`; and the inverse maps d to u and
/// inverts there. M commutes with the mirror, so fold and squeeze may be taken in either order. c < 1 narrows along y; it is held
/// as its reciprocal, rounded to f32.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Folded<K> {
    kernel: K,
    squeeze: Squeeze,
}

impl<K: Kernel> Folded<K> {
    /// Folds a kernel at the horizon z = 0.
    pub fn new(kernel: K) -> Self {
        Self { kernel, squeeze: Squeeze::NONE }
    }

    /// Folds a kernel and squeezes it along y by `c` in [0.01, 2]; 1 is no squeeze.
    ///
    /// # Errors
    /// [`Error::Squeeze`].
    pub fn squeezed(kernel: K, c: f32) -> Result<Self, Error> {
        if !(0.01..=2.0).contains(&c) {
            return Err(Error::Squeeze);
        }
        Ok(Self { kernel, squeeze: Squeeze::new([1.0, 0.0], 1.0, 1.0 / c) })
    }

    /// The kernel without fold and squeeze.
    pub fn kernel(&self) -> &K {
        &self.kernel
    }

    /// Evaluates the kernel and its mirror image, each times the change of solid angle; 0 below the horizon.
    #[inline]
    fn parts(&self, direction: Vec3) -> [f32; 2] {
        // False for a NaN too.
        let above = direction.z >= 0.0;
        if !above {
            return [0.0; 2];
        }
        let seen = self.seen(direction);
        let axis = self.kernel.axis();
        let (high, low) = (Vec3::from_array(seen.high), Vec3::from_array(seen.low));
        let chord = (high - axis) + low;
        let mirrored = Vec3::new(chord.x, chord.y, (high.z + axis.z) + low.z);
        [chord, mirrored].map(|c| self.kernel.value_at(c.length_squared()) * seen.scale)
    }

    #[inline]
    fn seen(&self, direction: Vec3) -> Seen<f32> {
        let turned = self.squeeze.turn(direction.to_array());
        if self.squeeze == Squeeze::NONE { turned } else { self.squeeze.squeeze(&turned) }
    }

    /// Evaluates `(K(u) + K(u mirrored)) / (c r^3)` towards a direction; 0 below the horizon.
    #[inline]
    pub fn value(&self, direction: impl Into<Vec3>) -> f32 {
        let [direct, mirrored] = self.parts(direction.into());
        direct + mirrored
    }

    /// Integrates over the upper hemisphere; sr: exactly the integral of the kernel over the sphere.
    #[inline]
    pub fn integral(&self) -> f32 {
        self.kernel.integral()
    }

    /// Evaluates the density of [`sample`](Self::sample); 1/sr.
    #[inline]
    pub fn pdf(&self, direction: impl Into<Vec3>) -> f32 {
        self.value(direction) / self.integral()
    }

    /// Draws a direction of the upper hemisphere, two uniform numbers in [0, 1) to a unit vector.
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> Vec3 {
        let mut d = self.kernel.sample(u);
        if self.squeeze != Squeeze::NONE {
            d = Vec3::from_array(self.squeeze.unsqueeze(d.to_array())).normalize();
        }
        d.z = d.z.abs();
        d
    }

    /// Inverts [`sample`](Self::sample): one of the two pairs of numbers that lead to a direction.
    ///
    /// `choice` in [0, 1) takes the preimage above the horizon if it is below that one's part of the density,
    /// else the mirrored one. Range: d.z >= 0.
    #[inline]
    pub fn invert_sample(&self, direction: impl Into<Vec3>, choice: f32) -> [f32; 2] {
        let direction = direction.into();
        let [direct, mirrored] = self.parts(direction);
        let seen = self.seen(direction);
        let mut u = Vec3::from_array(seen.high) + Vec3::from_array(seen.low);
        if mirrored > 0.0 && choice * (direct + mirrored) >= direct {
            u.z = -u.z;
        }
        self.kernel.invert_sample(u)
    }
}
