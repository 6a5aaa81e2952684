//! Values, densities and draws of a file, in f64 or f32.

use super::RANGE;
use super::arrays::Arrays;
use super::real::Real;
use super::warp::Warp;
use crate::table::{Known, Symmetry};
use std::f64::consts::{FRAC_PI_2, PI};

/// Least solid angle of half vectors over the area of the square: at the normal it is 0.
const SMALLEST_AREA: f64 = 1e-6;

/// Values and densities of pairs of directions, from a file.
#[derive(Debug)]
pub(super) struct Lookup<T = f64> {
    pub symmetry: Symmetry,
    pub arrays: Arrays<T>,
}

/// An outgoing direction as the file knows it.
struct Sight<T> {
    /// What x and y are multiplied by to come to where it was measured.
    flips: [T; 2],
    theta: T,
    phi: T,
    /// The up to four measured directions round it, with their shares.
    corners: [(usize, T); 4],
}

impl<T: Real> Sight<T> {
    fn flip(&self, d: [T; 3]) -> [T; 3] {
        [self.flips[0] * d[0], self.flips[1] * d[1], d[2]]
    }
}

fn angles<T: Real>(d: [T; 3]) -> (T, T) {
    (d[0].hypot(d[1]).atan2(d[2]), d[1].atan2(d[0]))
}

/// Turns of an azimuth, from -pi on; in [0, 1).
fn turns<T: Real>(phi: T) -> T {
    let u = (phi + T::of(PI)) / T::of(2.0 * PI);
    u - u.floor()
}

/// An angle from the normal, as it is along the side of the square.
fn along_square<T: Real>(theta: T) -> T {
    (theta / T::of(FRAC_PI_2)).sqrt()
}

/// Whether both directions are above the horizon, by more than where a quotient by the cosine overflows.
pub(super) fn is_above<T: Real>(wi: [T; 3], wo: [T; 3]) -> bool {
    wi[2] > T::LEAST_COSINE && wo[2] > T::LEAST_COSINE
}

pub(super) fn dot<T: Real>(a: [T; 3], b: [T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl<T: Real> Lookup<T> {
    /// `f cos` of the incident direction, and not clamped: the value of the file.
    /// 0 where a direction is on the horizon or below it.
    pub fn f_cos(&self, wi: [T; 3], wo: [T; 3]) -> [T; 3] {
        if !is_above(wi, wo) {
            return [T::of(0.0); 3];
        }
        let sight = self.sight(wo);
        let (normal, _) = self.normal(&sight, wi, wo);
        let sample = Warp::invert(&self.visible(&sight), normal);
        self.value(&sight, normal, sample)
    }

    /// The density of a draw.
    #[cfg(test)]
    pub fn density(&self, wi: [T; 3], wo: [T; 3]) -> T {
        if !is_above(wi, wo) {
            return T::of(0.0);
        }
        let sight = self.sight(wo);
        let (normal, h) = self.normal(&sight, wi, wo);
        let sample = Warp::invert(&self.visible(&sight), normal);
        self.density_at(&sight, normal, sample, h, wo)
    }

    /// `f cos` at a point of the square of half vectors, and where its colour is kept.
    fn value(&self, sight: &Sight<T>, normal: [T; 2], sample: [T; 2]) -> [T; 3] {
        let Arrays { ndf, sigma, rgb, jacobian, .. } = &self.arrays;
        let scale = if *jacobian {
            ndf.value(normal) / (T::of(4.0) * sigma.value([along_square(sight.theta), turns(sight.phi)]))
        } else {
            T::of(1.0)
        };
        [0, 1, 2].map(|c| {
            let inside = sight.corners.iter().filter(|(_, share)| *share > T::of(0.0));
            scale * inside.map(|&(n, share)| share * rgb[n][c].value(sample)).sum::<T>()
        })
    }

    fn density_at(&self, sight: &Sight<T>, normal: [T; 2], sample: [T; 2], h: [T; 3], wo: [T; 3]) -> T {
        let in_square =
            Warp::density(&self.bright(sight), sample) * Warp::density(&self.visible(sight), normal);
        // Solid angle of half vectors over the area of the square, and of incident directions over that of half vectors.
        let sin = h[0].hypot(h[1]);
        let area = (T::of(2.0 * PI * PI) * normal[0] * sin).most(T::of(SMALLEST_AREA));
        in_square / (area * T::of(4.0) * dot(h, wo))
    }

    fn visible(&self, sight: &Sight<T>) -> [(&Warp<T>, T); 4] {
        sight.corners.map(|(n, share)| (&self.arrays.visible[n], share))
    }

    fn bright(&self, sight: &Sight<T>) -> [(&Warp<T>, T); 4] {
        sight.corners.map(|(n, share)| (&self.arrays.luminance[n], share))
    }

    /// Where an outgoing direction lies among the measured ones.
    fn sight(&self, wo: [T; 3]) -> Sight<T> {
        let Arrays { phis, thetas, .. } = &self.arrays;
        let (zero, one) = (T::of(0.0), T::of(1.0));
        // Where the outgoing direction was not measured, both directions are turned or mirrored to where it was.
        let sign = |v: T| if v > zero { -one } else { one };
        let flips = match self.symmetry {
            Symmetry::Quadrant => [sign(wo[0]), sign(wo[1])],
            Symmetry::HalfTurn => [sign(wo[1]), sign(wo[1])],
            Symmetry::Isotropic | Symmetry::None => [one, one],
        };
        let (theta_o, phi_o) = angles([flips[0] * wo[0], flips[1] * wo[1], wo[2]]);
        let (theta, along_theta) = place(thetas, theta_o);
        // atan2 gives pi where -pi was measured: y = 0 on the side of -x.
        let is_round = phi_o > phis[phis.len() - 1] + T::of(RANGE);
        let (phi, along_phi) = place(phis, if is_round { phi_o - T::of(2.0 * PI) } else { phi_o });
        let mut corners = [(0, zero); 4];
        for (corner, (i, j)) in corners.iter_mut().zip([(0, 0), (0, 1), (1, 0), (1, 1)]) {
            let share = |at: usize, along: T| if at == 0 { one - along } else { along };
            let index = |at: usize, add: usize, list: &[T]| (at + add).min(list.len() - 1);
            *corner = (
                index(phi, i, phis) * thetas.len() + index(theta, j, thetas),
                share(i, along_phi) * share(j, along_theta),
            );
        }
        Sight { flips, theta: theta_o, phi: phi_o, corners }
    }

    /// The half vector: in the square, and as a unit vector in the frame of the surface.
    fn normal(&self, sight: &Sight<T>, wi: [T; 3], wo: [T; 3]) -> ([T; 2], [T; 3]) {
        let mut h = [wi[0] + wo[0], wi[1] + wo[1], wi[2] + wo[2]];
        let length = dot(h, h).sqrt();
        h.iter_mut().for_each(|v| *v /= length);
        let (theta, phi) = angles(sight.flip(h));
        let isotropic = self.symmetry == Symmetry::Isotropic;
        ([along_square(theta), turns(if isotropic { phi - sight.phi } else { phi })], h)
    }
}

impl Lookup<f32> {
    /// A direction by the warps, with the value and the density that are known where the warps end.
    pub fn draw(&self, u: [f32; 2], wo: [f32; 3]) -> ([f32; 3], Known) {
        let sight = self.sight(wo);
        let sample = Warp::sample(&self.bright(&sight), u);
        let normal = Warp::sample(&self.visible(&sight), sample);
        let isotropic = self.symmetry == Symmetry::Isotropic;
        let phi = (2.0 * normal[1] - 1.0) * PI as f32 + if isotropic { sight.phi } else { 0.0 };
        let (sin, cos) = (normal[0] * normal[0] * FRAC_PI_2 as f32).sin_cos();
        let (across, along) = phi.sin_cos();
        let h = sight.flip([sin * along, sin * across, cos]);
        let twice: f32 = 2.0 * dot(h, wo);
        let wi = [0, 1, 2].map(|k| twice * h[k] - wo[k]);
        if !is_above(wi, wo) || twice <= 0.0 {
            return (wi, Known::default());
        }
        (wi, self.known(&sight, normal, sample, h, wo))
    }

    /// Value and density of an incident direction.
    pub fn look_up(&self, wi: [f32; 3], wo: [f32; 3]) -> Known {
        if !is_above(wi, wo) {
            return Known::default();
        }
        let sight = self.sight(wo);
        let (normal, h) = self.normal(&sight, wi, wo);
        let sample = Warp::invert(&self.visible(&sight), normal);
        self.known(&sight, normal, sample, h, wo)
    }

    /// Value and density at a place in the squares; a number beyond the range of f32 counts as 0.
    fn known(
        &self,
        sight: &Sight<f32>,
        normal: [f32; 2],
        sample: [f32; 2],
        h: [f32; 3],
        wo: [f32; 3],
    ) -> Known {
        let or_nothing = |v: f32| if v.is_finite() { v } else { 0.0 };
        Known {
            value: self.value(sight, normal, sample).map(or_nothing),
            density: or_nothing(self.density_at(sight, normal, sample, h, wo)).max(0.0),
        }
    }
}

/// The entry of a rising list before a number, and how far towards the next one it lies, 0 to 1.
fn place<T: Real>(list: &[T], value: T) -> (usize, T) {
    let last = list.len() - 1;
    if last == 0 {
        return (0, T::of(0.0));
    }
    let after = list.partition_point(|&v| v <= value).clamp(1, last);
    let (from, to) = (list[after - 1], list[after]);
    (after - 1, ((value - from) / (to - from)).within_one())
}
