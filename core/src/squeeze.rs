//! The squeeze: the sphere made narrower across the plane of incidence, so that round lobes make the streak of a
//! highlight towards grazing.
//!
//! In the frame of a view, +x in the plane of incidence and +y across it, a direction `d` is seen as
//!
//! ```text
//! u = (d.x, d.y / c, d.z) / r,    r = |(d.x, d.y / c, d.z)|
//! ```
//!
//! and `dw(u) = dw(d) / (c r^3)`: of the linear map M = diag(1, 1/c, 1) with determinant 1/c, a unit direction's solid
//! angle changes by `det M / |M d|^3`. A squeezed lobe is `G(u) / (c r^3)`, so its integral is that of the round one.
//! The map commutes with the mirror z -> -z, so it commutes with the fold. It is the transform of linearly transformed
//! cosines (Heitz, Dupuy, Hill and Neubelt 2016), kept to the one diagonal entry that commutes with the fold.
//!
//! Rounding. `G` at sharpness `s` turns an error `e` across the direction into one of `sqrt(2 s |t|) e` in the value,
//! `t` its exponent: 1e-4 at s = 1e6 if `u` is rounded to f32. So the turned and squeezed direction is carried as an
//! unevaluated sum of two f32, by error-free transformations (Dekker 1971, Knuth 1969). The error along the direction
//! that remains in `1 / r` counts only squared.

use crate::float;
use glam::Vec3;

/// The turn into the frame of a view, and the squeeze in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Squeeze {
    /// Cosine and sine of the azimuth, in the caller's frame, of the view's +x.
    pub azimuth: [f32; 2],
    /// `1 / c`.
    pub inverse: f32,
}

/// A direction as the lobes see it: `high + low`, `low` the part that f32 rounds away.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    pub high: Vec3,
    pub low: Vec3,
    /// Change of solid angle, `1 / (c r^3)`.
    pub scale: f32,
}

impl Squeeze {
    pub const NONE: Self = Self { azimuth: [1.0, 0.0], inverse: 1.0 };

    /// The direction as round lobes see it: turned only.
    #[inline]
    pub fn turn(&self, d: Vec3) -> Seen {
        let [c, s] = self.azimuth;
        let (x, x_low) = sum_of_products(d.x, c, d.y, s);
        let (y, y_low) = sum_of_products(d.y, c, -d.x, s);
        Seen { high: Vec3::new(x, y, d.z), low: Vec3::new(x_low, y_low, 0.0), scale: 1.0 }
    }

    /// The direction as squeezed lobes see it, from the turned one.
    #[inline]
    pub fn squeeze(&self, turned: &Seen) -> Seen {
        let (y, y_error) = two_product(turned.high.y, self.inverse);
        let v = Vec3::new(turned.high.x, y, turned.high.z);
        let v_low = Vec3::new(turned.low.x, y_error + turned.low.y * self.inverse, 0.0);
        let inverse_length = 1.0 / float::sqrt(v.length_squared());
        let (hx, lx) = two_product(v.x, inverse_length);
        let (hy, ly) = two_product(v.y, inverse_length);
        let (hz, lz) = two_product(v.z, inverse_length);
        Seen {
            high: Vec3::new(hx, hy, hz),
            low: Vec3::new(lx, ly, lz) + v_low * inverse_length,
            scale: self.inverse * inverse_length * inverse_length * inverse_length,
        }
    }

    /// The direction whose squeezed image is `u`, still in the frame of the view.
    #[inline]
    pub fn unsqueeze(&self, u: Vec3) -> Vec3 {
        Vec3::new(u.x, u.y / self.inverse, u.z).normalize()
    }

    /// Turns a direction from the frame of the view back to the caller's.
    #[inline]
    pub fn turn_back(&self, d: Vec3) -> Vec3 {
        let [c, s] = self.azimuth;
        Vec3::new(d.x * c - d.y * s, d.x * s + d.y * c, d.z)
    }
}

/// `a + b` and its rounding error (Knuth).
#[inline]
pub(crate) fn two_sum(a: f32, b: f32) -> (f32, f32) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}

/// `a b` and its rounding error (Dekker; exact while nothing under- or overflows).
#[inline]
pub(crate) fn two_product(a: f32, b: f32) -> (f32, f32) {
    const SPLIT: f32 = 4097.0; // 2^12 + 1: halves of 12 bits
    let halves = |v: f32| {
        let t = SPLIT * v;
        let high = t - (t - v);
        (high, v - high)
    };
    let product = a * b;
    let ((ah, al), (bh, bl)) = (halves(a), halves(b));
    (product, ((ah * bh - product) + ah * bl + al * bh) + al * bl)
}

/// `a b + c d` as a sum of two.
#[inline]
pub(crate) fn sum_of_products(a: f32, b: f32, c: f32, d: f32) -> (f32, f32) {
    let (p, p_error) = two_product(a, b);
    let (q, q_error) = two_product(c, d);
    let (sum, error) = two_sum(p, q);
    (sum, error + (p_error + q_error))
}
