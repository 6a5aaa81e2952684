//! The value of unit lobes at a direction, with derivatives.
//!
//! With `u` the direction as a lobe sees it (squeezed or not), `j` the change of solid angle, and `m` the mirror image of
//! the axis `(sin a, 0, cos a)` in the horizon, a unit lobe is
//!
//! ```text
//! G = j [ exp(s (u.axis - 1)) + exp(s (u.m - 1)) ]
//! dG/da    = j s [ E+ (u.x cos a - u.z sin a) + E- (u.x cos a + u.z sin a) ]
//! dG/dln s = j s [ E+ (u.axis - 1) + E- (u.m - 1) ]
//! dG/dln c = j   [ E+ (-1 + 3 u.y^2 + s u.y^2 u.axis) + E- (-1 + 3 u.y^2 + s u.y^2 u.m) ]
//! ```
//!
//! A mirrored lobe is two of them, with the axes `(sin a cos b, +-sin b, cos a cos b)`, and is not squeezed.
//!
//! In f64 the dot form loses nothing that matters: sharpness 1e6 leaves ten digits. Lobes are columns of numbers, and the
//! exponential is our own, so that the loops over lobes become vector instructions of whatever width the machine has
//! (`crate::vector`), with the same results to the last bit.

use crate::parameters::Layout;
use crate::vector::exp;
use std::f64::consts::FRAC_1_PI;

/// The lobes of one view, ready to be evaluated at many directions.
pub(crate) struct Lobes {
    squeezed: usize,
    inverse_squeeze: f64,
    sin: Vec<f64>,
    cos: Vec<f64>,
    sharpness: Vec<f64>,
    /// Sine and cosine of the angle out of the plane of incidence, of the mirrored lobes.
    off_plane: Vec<(f64, f64)>,
}

impl Lobes {
    /// Prepares the interpolated unknowns `q` of a view.
    pub fn new(layout: &Layout, q: &[f64]) -> Self {
        let (sin, cos) = (0..layout.lobes).map(|k| libm::sincos(q[layout.angle(k)])).unzip();
        let sharpness = (0..layout.lobes).map(|k| libm::exp(q[layout.sharpness(k)])).collect();
        let off_plane = (0..layout.mirrored).map(|m| libm::sincos(q[layout.off_plane(m)])).collect();
        Self { squeezed: layout.squeezed, inverse_squeeze: libm::exp(-q[0]), sin, cos, sharpness, off_plane }
    }

    /// The first mirrored lobe; the number of lobes if there is none.
    fn first_mirrored(&self) -> usize {
        self.len() - self.off_plane.len()
    }

    /// How many lobes there are, the diffuse term not counted.
    pub fn len(&self) -> usize {
        self.sharpness.len()
    }

    /// Squeezed direction and change of solid angle.
    #[inline(always)]
    fn squeeze(&self, d: &[f64; 3]) -> ([f64; 3], f64) {
        let y = d[1] * self.inverse_squeeze;
        let inverse = 1.0 / (d[0] * d[0] + y * y + d[2] * d[2]).sqrt();
        ([d[0] * inverse, y * inverse, d[2] * inverse], self.inverse_squeeze * inverse * inverse * inverse)
    }

    /// The two runs of lobes in the plane of incidence, with the direction that each sees and its change of solid angle.
    #[inline(always)]
    fn runs(&self, d: &[f64; 3]) -> [(std::ops::Range<usize>, [f64; 3], f64); 2] {
        let (squeezed, j) = self.squeeze(d);
        [(0..self.squeezed, squeezed, j), (self.squeezed..self.first_mirrored(), *d, 1.0)]
    }

    /// Values of the unit lobes, and of the diffuse term of albedo 1, `cos / pi`. Shapes: `out` [K + 1], overwritten.
    #[inline(always)]
    pub fn values(&self, d: &[f64; 3], out: &mut [f64]) {
        for (run, u, j) in self.runs(d) {
            let (sin, cos, sharpness) =
                (&self.sin[run.clone()], &self.cos[run.clone()], &self.sharpness[run.clone()]);
            for (((out, sin), cos), s) in out[run].iter_mut().zip(sin).zip(cos).zip(sharpness) {
                let (x, z) = (u[0] * sin, u[2] * cos);
                *out = j * (exp(s * (x + z - 1.0)) + exp(s * (x - z - 1.0)));
            }
        }
        let first = self.first_mirrored();
        for (m, out) in out[first..self.len()].iter_mut().enumerate() {
            *out = self.mirrored(first + m, d);
        }
        out[self.len()] = d[2] * FRAC_1_PI;
    }

    /// Value of a mirrored lobe.
    #[inline(always)]
    fn mirrored(&self, k: usize, d: &[f64; 3]) -> f64 {
        let (sin, cos) = self.off_plane[k - self.first_mirrored()];
        let (x, y, z) = (d[0] * self.sin[k] * cos, d[1] * sin, d[2] * self.cos[k] * cos);
        let s = self.sharpness[k];
        let above = exp(s * (x + z + y - 1.0)) + exp(s * (x + z - y - 1.0));
        above + exp(s * (x - z + y - 1.0)) + exp(s * (x - z - y - 1.0))
    }

    /// Value of one unit lobe.
    pub fn value(&self, k: usize, d: &[f64; 3]) -> f64 {
        if k >= self.first_mirrored() {
            return self.mirrored(k, d);
        }
        let (u, j) = if k < self.squeezed { self.squeeze(d) } else { (*d, 1.0) };
        let (x, z) = (u[0] * self.sin[k], u[2] * self.cos[k]);
        j * (exp(self.sharpness[k] * (x + z - 1.0)) + exp(self.sharpness[k] * (x - z - 1.0)))
    }

    /// How many numbers [`slopes`](Self::slopes) gives.
    pub fn slopes_len(&self) -> usize {
        3 * self.len() + self.squeezed + self.off_plane.len() + 1
    }

    /// Values and derivatives of the unit lobes and of the diffuse term, times `scale`.
    ///
    /// Shapes: `out` [3 K + S + M + 1] for S squeezed lobes and M mirrored ones, overwritten: K derivatives by angle, K by ln
    /// sharpness, K values, S derivatives by ln squeeze, M by the angle out of the plane, the value of the diffuse term of albedo 1.
    #[inline(always)]
    pub fn slopes(&self, d: &[f64; 3], scale: f64, out: &mut [f64]) {
        let k = self.len();
        let (by_angle, rest) = out.split_at_mut(k);
        let (by_sharpness, rest) = rest.split_at_mut(k);
        let (value, by_squeeze) = rest.split_at_mut(k);
        for numbers in [&mut by_angle[self.first_mirrored()..], &mut by_sharpness[self.first_mirrored()..]] {
            numbers.fill(0.0);
        }
        value[self.first_mirrored()..].fill(0.0);
        by_squeeze.fill(0.0);
        for (run, u, j) in self.runs(d) {
            let is_squeezed = run.start == 0 && self.squeezed > 0;
            let j = scale * j;
            let yy = u[1] * u[1];
            let common = 3.0 * yy - 1.0;
            let count = run.len();
            let (sin, cos, sharpness) =
                (&self.sin[run.clone()], &self.cos[run.clone()], &self.sharpness[run.clone()]);
            let (by_angle, by_sharpness, value) =
                (&mut by_angle[run.clone()], &mut by_sharpness[run.clone()], &mut value[run]);
            for i in 0..count {
                let s = sharpness[i];
                let (x, z) = (u[0] * sin[i], u[2] * cos[i]);
                let (up, down) = (x + z - 1.0, x - z - 1.0);
                let (above, below) = (j * exp(s * up), j * exp(s * down));
                let (across_x, across_z) = (u[0] * cos[i], u[2] * sin[i]);
                value[i] = above + below;
                by_angle[i] = s * (above * (across_x - across_z) + below * (across_x + across_z));
                by_sharpness[i] = s * (above * up + below * down);
                if is_squeezed {
                    by_squeeze[i] = above * (common + s * yy * (x + z)) + below * (common + s * yy * (x - z));
                }
            }
        }
        for (m, &(sin, cos)) in self.off_plane.iter().enumerate() {
            let k = self.first_mirrored() + m;
            let (s, y) = (self.sharpness[k], d[1] * sin);
            let (x, z) = (d[0] * self.sin[k], d[2] * self.cos[k]);
            let (across_x, across_z) = (d[0] * self.cos[k], d[2] * self.sin[k]);
            for (z, across_z) in [(z, -across_z), (-z, across_z)] {
                let along = cos * (x + z);
                let (left, right) = (along + y - 1.0, along - y - 1.0);
                let (e, f) = (scale * exp(s * left), scale * exp(s * right));
                value[k] += e + f;
                by_angle[k] += s * cos * (e + f) * (across_x + across_z);
                by_sharpness[k] += s * (e * left + f * right);
                by_squeeze[self.squeezed + m] += s * ((e - f) * d[1] * cos - (e + f) * sin * (x + z));
            }
        }
        by_squeeze[self.squeezed + self.off_plane.len()] = scale * d[2] * FRAC_1_PI;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use crate::table::direction;

    #[test]
    fn derivatives_agree_with_differences() {
        let layout = Layout { lobes: 4, squeezed: 2, mirrored: 1, knots: vec![0.0] };
        let mut random = Random::new(7);
        for _ in 0..50 {
            let mut q = vec![0.0; layout.stride()];
            q[0] = -1.5 * random.next();
            for k in 0..4 {
                q[layout.angle(k)] = 3.0 * random.next() - 1.2;
                q[layout.sharpness(k)] = 6.0 * random.next() - 1.0;
            }
            q[layout.off_plane(0)] = 1.5 * random.next();
            let d = direction(1.5 * random.next(), 3.0 * random.next());
            let mut slopes = [0.0; 16];
            Lobes::new(&layout, &q).slopes(&d, 1.0, &mut slopes);
            assert!((slopes[15] - d[2] * FRAC_1_PI).abs() < 1e-15);
            for k in 0..4 {
                let value = slopes[8 + k];
                for (index, slope) in [
                    (0, if k < 2 { slopes[12 + k] } else { 0.0 }),
                    (layout.angle(k), slopes[k]),
                    (layout.sharpness(k), slopes[4 + k]),
                    (layout.off_plane(0), if k == 3 { slopes[14] } else { 0.0 }),
                ] {
                    let at = |h: f64| {
                        let mut q = q.clone();
                        q[index] += h;
                        let mut out = [0.0; 5];
                        Lobes::new(&layout, &q).values(&d, &mut out);
                        out[k]
                    };
                    let h = 1e-5;
                    let difference = (at(h) - at(-h)) / (2.0 * h);
                    let scale = value.abs() + slope.abs() + 1e-9;
                    assert!(
                        (difference - slope).abs() < 1e-6 * scale.max(1.0),
                        "{index}: {difference} {slope}"
                    );
                    assert!((at(0.0) - value).abs() < 1e-12 * scale.max(1.0));
                }
            }
        }
    }
}
