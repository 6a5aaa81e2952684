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
//! In f64 the dot form loses nothing that matters: sharpness 1e6 leaves ten digits.

use crate::parameters::Layout;
use std::f64::consts::FRAC_1_PI;

/// The lobes of one view, ready to be evaluated at many directions.
pub(crate) struct Lobes {
    squeezed: usize,
    inverse_squeeze: f64,
    /// Sine and cosine of the angle of the axis, sharpness.
    shapes: Vec<[f64; 3]>,
}

/// The derivatives of one unit lobe at one direction, and its value.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Slopes {
    pub value: f64,
    pub by_angle: f64,
    pub by_ln_sharpness: f64,
    pub by_ln_squeeze: f64,
}

/// Below this the exponential is left out: it is under the rounding of anything that it is added to.
const SMALLEST: f64 = -60.0;

fn exp(t: f64) -> f64 {
    if t < SMALLEST { 0.0 } else { libm::exp(t) }
}

impl Lobes {
    /// Prepares the interpolated unknowns `q` of a view.
    pub fn new(layout: &Layout, q: &[f64]) -> Self {
        let shapes = (0..layout.lobes)
            .map(|k| {
                let (sin, cos) = libm::sincos(q[layout.angle(k)]);
                [sin, cos, libm::exp(q[layout.sharpness(k)])]
            })
            .collect();
        Self { squeezed: layout.squeezed, inverse_squeeze: libm::exp(-q[0]), shapes }
    }

    /// How many lobes there are, the diffuse term not counted.
    pub fn len(&self) -> usize {
        self.shapes.len()
    }

    /// Squeezed direction and change of solid angle.
    #[inline]
    fn squeeze(&self, d: &[f64; 3]) -> ([f64; 3], f64) {
        let y = d[1] * self.inverse_squeeze;
        let inverse = 1.0 / libm::sqrt(d[0] * d[0] + y * y + d[2] * d[2]);
        ([d[0] * inverse, y * inverse, d[2] * inverse], self.inverse_squeeze * inverse * inverse * inverse)
    }

    /// Values of the unit lobes, and of the diffuse term of albedo 1, `cos / pi`. Shapes: `out` [K + 1], overwritten.
    pub fn values(&self, d: &[f64; 3], out: &mut [f64]) {
        let (squeezed, j) = self.squeeze(d);
        for (k, (out, [sin, cos, s])) in out.iter_mut().zip(&self.shapes).enumerate() {
            let (u, j) = if k < self.squeezed { (&squeezed, j) } else { (d, 1.0) };
            let (x, z) = (u[0] * sin, u[2] * cos);
            *out = j * (exp(s * (x + z - 1.0)) + exp(s * (x - z - 1.0)));
        }
        out[self.shapes.len()] = d[2] * FRAC_1_PI;
    }

    /// Values and derivatives of the unit lobes. Shapes: `out` [K], overwritten.
    pub fn slopes(&self, d: &[f64; 3], out: &mut [Slopes]) {
        let (squeezed, j) = self.squeeze(d);
        for (k, (out, [sin, cos, s])) in out.iter_mut().zip(&self.shapes).enumerate() {
            let is_squeezed = k < self.squeezed;
            let (u, j) = if is_squeezed { (&squeezed, j) } else { (d, 1.0) };
            let (x, z) = (u[0] * sin, u[2] * cos);
            let (above, below) = (exp(s * (x + z - 1.0)), exp(s * (x - z - 1.0)));
            let (across_x, across_z) = (u[0] * cos, u[2] * sin);
            out.value = j * (above + below);
            out.by_angle = j * s * (above * (across_x - across_z) + below * (across_x + across_z));
            out.by_ln_sharpness = j * s * (above * (x + z - 1.0) + below * (x - z - 1.0));
            out.by_ln_squeeze = if is_squeezed {
                let yy = u[1] * u[1];
                let common = 3.0 * yy - 1.0;
                j * (above * (common + s * yy * (x + z)) + below * (common + s * yy * (x - z)))
            } else {
                0.0
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use crate::table::direction;

    #[test]
    fn derivatives_agree_with_differences() {
        let layout = Layout { lobes: 4, squeezed: 2, knots: vec![0.0] };
        let mut random = Random::new(7);
        for _ in 0..50 {
            let mut q = vec![0.0; layout.stride()];
            q[0] = -1.5 * random.next();
            for k in 0..4 {
                q[layout.angle(k)] = 3.0 * random.next() - 1.2;
                q[layout.sharpness(k)] = 6.0 * random.next() - 1.0;
            }
            let d = direction(1.5 * random.next(), 3.0 * random.next());
            let mut slopes = [Slopes::default(); 4];
            Lobes::new(&layout, &q).slopes(&d, &mut slopes);
            for k in 0..4 {
                for (index, slope) in [
                    (0, slopes[k].by_ln_squeeze),
                    (layout.angle(k), slopes[k].by_angle),
                    (layout.sharpness(k), slopes[k].by_ln_sharpness),
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
                    let scale = slopes[k].value.abs() + slope.abs() + 1e-9;
                    assert!(
                        (difference - slope).abs() < 1e-6 * scale.max(1.0),
                        "{index}: {difference} {slope}"
                    );
                    assert!((at(0.0) - slopes[k].value).abs() < 1e-12 * scale.max(1.0));
                }
            }
        }
    }
}
