//! The value of unit lobes with any axis under a squeeze matrix, with derivatives.
//!
//! Let `N = (M, 1)` be the squeeze of (x, y) by the matrix `M = exp(S)`, and `u = N d / r` the direction as a squeezed lobe sees
//! it. `b` is the axis as stored, `a = N b / rho` as the lobe sees it, and `m` the mirror image of `a` in the horizon:
//!
//! ```text
//! G  = j [ exp(s (u.a - 1)) + exp(s (u.m - 1)) ],      j = det M / r^3
//! dG = j [ E+ (s d(u.a) + dj / j) + E- (s d(u.m) + dj / j) ]
//! d(u.a) by b:  (u.N db - (u.a) (a.N db)) / rho
//! d(u.a) by S:  (a.dN d - (u.a) (u.dN d)) / r + (u.dN b - (u.a) (a.dN b)) / rho,     dj / j = tr dS - 3 (u.dN d) / r
//! ```
//!
//! Round lobes have N = 1. With `S = m + [[d, o], [o, -d]]` and `R^2 = d^2 + o^2` the exponential is
//! `e^m (cosh R + sinh R / R [[d, o], [o, -d]])`.

use super::layout::Layout;
use crate::anisotropic::tuning::model::SMALLEST;
use std::f64::consts::FRAC_1_PI;

/// A symmetric 2 x 2 matrix: xx, xy, yy.
type Symmetric = [f64; 3];

fn times(m: Symmetric, x: f64, y: f64) -> [f64; 2] {
    [m[0] * x + m[1] * y, m[1] * x + m[2] * y]
}

/// Exponential of a symmetric matrix, and its derivatives by xx, xy and yy.
pub(super) fn exponential([xx, xy, yy]: Symmetric) -> (Symmetric, [Symmetric; 3]) {
    let (mean, d, o) = (0.5 * (xx + yy), 0.5 * (xx - yy), xy);
    let rr = d * d + o * o;
    let r = libm::sqrt(rr);
    let cosh = libm::cosh(r);
    // Both tend to a limit at 0, where the quotients cancel.
    let (ratio, slope) = if r < 1e-3 {
        (1.0 + rr / 6.0, 1.0 / 3.0 + rr / 30.0)
    } else {
        let ratio = libm::sinh(r) / r;
        (ratio, (cosh - ratio) / rr)
    };
    let e = libm::exp(mean);
    let m = [e * (cosh + ratio * d), e * ratio * o, e * (cosh - ratio * d)];
    let by = |v: f64, along: [f64; 3]| {
        // v is d or o: of cosh the slope is ratio v, of the ratio it is slope v.
        let (c, s) = (ratio * v, slope * v);
        [
            e * (c + s * d + ratio * along[0]),
            e * (s * o + ratio * along[1]),
            e * (c - s * d + ratio * along[2]),
        ]
    };
    let (by_d, by_o) = (by(d, [1.0, 0.0, -1.0]), by(o, [0.0, 1.0, 0.0]));
    let half = |sign: f64| [0, 1, 2].map(|i| 0.5 * (m[i] + sign * by_d[i]));
    (m, [half(1.0), by_o, half(-1.0)])
}

/// A lobe, ready to be evaluated.
struct Shape {
    /// The axis as the lobe sees it.
    axis: [f64; 3],
    sharpness: f64,
    /// `N db / rho` by the two tilts, and its product with the axis.
    by_tilt: [[f64; 3]; 2],
    along_tilt: [f64; 2],
    /// `dN b / rho` by the three numbers of S, and its product with the axis; 0 for round lobes.
    by_squeeze: [[f64; 2]; 3],
    along_squeeze: [f64; 3],
}

/// The lobes of one view, ready to be evaluated at many directions.
pub(super) struct Lobes {
    squeezed: usize,
    matrix: Symmetric,
    slopes: [Symmetric; 3],
    determinant: f64,
    shapes: Vec<Shape>,
}

/// The derivatives of one unit lobe at one direction, and its value.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Slopes {
    pub value: f64,
    pub by_tilt: [f64; 2],
    pub by_ln_sharpness: f64,
    pub by_squeeze: [f64; 3],
}

fn exp(t: f64) -> f64 {
    if t < SMALLEST { 0.0 } else { libm::exp(t) }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Lobes {
    /// Prepares the interpolated unknowns `q` of a view.
    pub fn new(layout: &Layout, q: &[f64]) -> Self {
        let (matrix, slopes) = exponential([q[0], q[1], q[2]]);
        let shapes = (0..layout.lobes)
            .map(|k| {
                let (p, q, ln_s) = (q[layout.along(k)], q[layout.across(k)], q[layout.sharpness(k)]);
                let (n, slopes) =
                    if k < layout.squeezed { (matrix, slopes) } else { ([1.0, 0.0, 1.0], [[0.0; 3]; 3]) };
                Shape::new(p, q, libm::exp(ln_s), n, slopes)
            })
            .collect();
        let determinant = libm::exp(q[0] + q[2]);
        Self { squeezed: layout.squeezed, matrix, slopes, determinant, shapes }
    }

    /// How many lobes there are, the diffuse term not counted.
    pub fn len(&self) -> usize {
        self.shapes.len()
    }

    /// Squeezed direction, length before it was normalised, change of solid angle.
    fn squeeze(&self, d: &[f64; 3]) -> ([f64; 3], f64, f64) {
        let [x, y] = times(self.matrix, d[0], d[1]);
        let r = libm::sqrt(x * x + y * y + d[2] * d[2]);
        ([x / r, y / r, d[2] / r], r, self.determinant / (r * r * r))
    }

    /// Values of the unit lobes, and of the diffuse term of albedo 1, `cos / pi`. Shapes: `out` [K + 1], overwritten.
    pub fn values(&self, d: &[f64; 3], out: &mut [f64]) {
        let (squeezed, _, j) = self.squeeze(d);
        for (k, (out, shape)) in out.iter_mut().zip(&self.shapes).enumerate() {
            let (u, j) = if k < self.squeezed { (&squeezed, j) } else { (d, 1.0) };
            let (across, z) = (u[0] * shape.axis[0] + u[1] * shape.axis[1] - 1.0, u[2] * shape.axis[2]);
            *out = j * (exp(shape.sharpness * (across + z)) + exp(shape.sharpness * (across - z)));
        }
        out[self.shapes.len()] = d[2] * FRAC_1_PI;
    }

    /// Values and derivatives of the unit lobes. Shapes: `out` [K], overwritten.
    pub fn slopes(&self, d: &[f64; 3], out: &mut [Slopes]) {
        let (squeezed, r, scale) = self.squeeze(d);
        // dN d / r, and its product with u.
        let moved = self.slopes.map(|m| times(m, d[0], d[1]).map(|v| v / r));
        let drawn = moved.map(|v| v[0] * squeezed[0] + v[1] * squeezed[1]);
        let trace = [1.0, 0.0, 1.0];
        for (k, (out, shape)) in out.iter_mut().zip(&self.shapes).enumerate() {
            let (u, j) = if k < self.squeezed { (squeezed, scale) } else { (*d, 1.0) };
            let (a, s) = (shape.axis, shape.sharpness);
            let (across, z) = (u[0] * a[0] + u[1] * a[1], u[2] * a[2]);
            let cosines = [across + z, across - z];
            let e = cosines.map(|c| j * exp(s * (c - 1.0)));
            out.value = e[0] + e[1];
            out.by_ln_sharpness = s * (e[0] * (cosines[0] - 1.0) + e[1] * (cosines[1] - 1.0));
            for i in 0..2 {
                let t = shape.by_tilt[i];
                let (flat, up) = (u[0] * t[0] + u[1] * t[1], u[2] * t[2]);
                let plus = flat + up - cosines[0] * shape.along_tilt[i];
                let minus = flat - up - cosines[1] * shape.along_tilt[i];
                out.by_tilt[i] = s * (e[0] * plus + e[1] * minus);
            }
            out.by_squeeze = [0.0; 3];
            if k < self.squeezed {
                for i in 0..3 {
                    let t = shape.by_squeeze[i];
                    let flat = moved[i][0] * a[0] + moved[i][1] * a[1] + u[0] * t[0] + u[1] * t[1];
                    let pull = drawn[i] + shape.along_squeeze[i];
                    let area = trace[i] - 3.0 * drawn[i];
                    out.by_squeeze[i] = e[0] * (s * (flat - cosines[0] * pull) + area)
                        + e[1] * (s * (flat - cosines[1] * pull) + area);
                }
            }
        }
    }
}

impl Shape {
    fn new(p: f64, q: f64, sharpness: f64, n: Symmetric, slopes: [Symmetric; 3]) -> Self {
        let rr = p * p + q * q;
        let r = libm::sqrt(rr);
        let (sin, cos) = libm::sincos(r);
        // sin r / r, and (its slope) / r.
        let (ratio, slope) =
            if r < 1e-3 { (1.0 - rr / 6.0, -1.0 / 3.0 + rr / 30.0) } else { (sin / r, (cos - sin / r) / rr) };
        let b = [p * ratio, q * ratio, cos];
        let db = [
            [ratio + p * p * slope, p * q * slope, -p * ratio],
            [p * q * slope, ratio + q * q * slope, -q * ratio],
        ];
        let squeeze = |v: [f64; 3]| {
            let [x, y] = times(n, v[0], v[1]);
            [x, y, v[2]]
        };
        let seen = squeeze(b);
        let rho = libm::sqrt(dot(seen, seen));
        let axis = seen.map(|v| v / rho);
        let by_tilt = db.map(|v| squeeze(v).map(|v| v / rho));
        let by_squeeze = slopes.map(|m| times(m, b[0], b[1]).map(|v| v / rho));
        Self {
            axis,
            sharpness,
            by_tilt,
            along_tilt: by_tilt.map(|v| dot(axis, v)),
            by_squeeze,
            along_squeeze: by_squeeze.map(|v| v[0] * axis[0] + v[1] * axis[1]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::random::Random;
    use crate::table::direction;

    #[test]
    fn derivatives_agree_with_differences() {
        let layout = Layout { lobes: 4, squeezed: 2, thetas: vec![0.0], azimuths: 1, turns: 1 };
        let mut random = Random::new(7);
        for round in 0..60 {
            let mut q = vec![0.0; layout.stride()];
            let size = if round % 3 == 0 { 1e-5 } else { 1.0 };
            (0..3).for_each(|i| q[i] = size * (2.0 * random.uniform() - 0.8));
            for k in 0..4 {
                q[layout.along(k)] = size * (3.0 * random.uniform() - 1.2);
                q[layout.across(k)] = size * (2.0 * random.uniform() - 1.0);
                q[layout.sharpness(k)] = 5.0 * random.uniform() - 1.0;
            }
            let d = direction(1.5 * random.uniform(), 6.2 * random.uniform());
            let mut slopes = [Slopes::default(); 4];
            Lobes::new(&layout, &q).slopes(&d, &mut slopes);
            for (k, s) in slopes.iter().enumerate() {
                for (index, slope) in [
                    (0, s.by_squeeze[0]),
                    (1, s.by_squeeze[1]),
                    (2, s.by_squeeze[2]),
                    (layout.along(k), s.by_tilt[0]),
                    (layout.across(k), s.by_tilt[1]),
                    (layout.sharpness(k), s.by_ln_sharpness),
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
                    let scale = s.value.abs() + slope.abs() + 1e-9;
                    assert!(
                        (difference - slope).abs() < 2e-6 * scale.max(1.0),
                        "{k} {index}: {difference} {slope}"
                    );
                    assert!((at(0.0) - s.value).abs() < 1e-12 * scale.max(1.0));
                }
            }
        }
    }
}
