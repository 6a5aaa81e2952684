//! The value of unit lobes at directions, with derivatives.
//!
//! With `u` the direction as a lobe sees it (squeezed or not), `j` the change of solid angle, and `m` the lobe's axes, a unit
//! lobe is
//!
//! ```text
//! G = j sum_m E_m,  E_m = exp(s (u.m - 1))
//! dG/da    = j s sum_m E_m (u.dm/da)          a: angle of the axis in the plane of incidence
//! dG/dln s = j s sum_m E_m (u.m - 1)
//! dG/dln c = j   sum_m E_m (-1 + 3 u.y^2 + s u.y^2 u.m)
//! dG/db    = j s sum_m E_m (u.dm/db)          b: angle out of that plane
//! ```
//!
//! The axes are `(sin a, 0, cos a)` and its mirror image in the horizon. A mirrored lobe has the four axes
//! `(sin a cos b, +-sin b, +-cos a cos b)`, and is not squeezed.
//!
//! In f64 the dot form loses nothing that matters: sharpness 1e6 leaves ten digits. Directions come in panels of a fixed size, and
//! the exponential is our own. So the loops over directions become vector instructions of any width (`crate::numeric::vector`),
//! with the same results to the last bit.

use crate::family::layout::Layout;
use crate::isotropic::tuning::model::NEGLIGIBLE;
use crate::numeric::vector::{exp, fused};
use std::f64::consts::FRAC_1_PI;

/// Directions of a panel.
pub(crate) const PANEL: usize = 64;

/// A number for every direction of a panel.
pub(crate) type Column = [f64; PANEL];

/// The lobes of one view, ready to be evaluated at many directions.
pub(crate) struct Lobes {
    squeezed: usize,
    mirrored: usize,
    inverse_squeeze: f64,
    lobes: Vec<Unit>,
}

/// One lobe.
struct Unit {
    sharpness: f64,
    axes: [Axis; 4],
    /// How many of the axes there are.
    count: usize,
}

/// One axis, and its derivatives by the angles in and out of the plane of incidence.
#[derive(Clone, Copy, Default)]
struct Axis {
    at: [f64; 3],
    by_angle: [f64; 3],
    by_off_plane: [f64; 3],
}

/// Directions side by side.
pub(crate) struct Panel {
    round: Directions,
    squeezed: Directions,
}

/// Directions as lobes see them, and the change of solid angle.
struct Directions {
    at: [Column; 3],
    jacobian: Column,
}

impl Unit {
    fn new(angle: f64, ln_sharpness: f64, off_plane: Option<f64>) -> Self {
        let (sin, cos) = libm::sincos(angle);
        let (sin_b, cos_b) = libm::sincos(off_plane.unwrap_or(0.0));
        let axis = |side: f64, up: f64| Axis {
            at: [sin * cos_b, side * sin_b, up * cos * cos_b],
            by_angle: [cos * cos_b, 0.0, -up * sin * cos_b],
            by_off_plane: [-sin * sin_b, side * cos_b, -up * cos * sin_b],
        };
        let axes = [axis(1.0, 1.0), axis(1.0, -1.0), axis(-1.0, 1.0), axis(-1.0, -1.0)];
        Self { sharpness: libm::exp(ln_sharpness), axes, count: if off_plane.is_some() { 4 } else { 2 } }
    }

    /// The axes.
    #[inline(always)]
    fn axes(&self) -> &[Axis] {
        &self.axes[..self.count]
    }

    /// Value at a direction as the lobe sees it.
    #[inline(always)]
    fn value(&self, u: &[f64; 3]) -> f64 {
        self.axes().iter().map(|axis| exp(self.sharpness * (dot(u, &axis.at) - 1.0))).sum()
    }

    /// Exponents at a panel of directions; false if all are too low to count.
    #[inline(always)]
    fn exponents(&self, axis: &Axis, directions: &Directions, out: &mut Column) -> bool {
        let [x, y, z] = &directions.at;
        let least = NEGLIGIBLE / self.sharpness;
        let mut is_near = false;
        for n in 0..PANEL {
            let t = x[n] * axis.at[0] + (y[n] * axis.at[1] + z[n] * axis.at[2]) - 1.0;
            is_near |= t > least;
            out[n] = t;
        }
        is_near
    }
}

#[inline(always)]
fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + (a[1] * b[1] + a[2] * b[2])
}

impl Lobes {
    /// Prepares the interpolated unknowns `q` of a view.
    pub fn new(layout: &Layout, q: &[f64]) -> Self {
        let off_plane = |k: usize| k.checked_sub(layout.first_mirrored()).map(|m| q[layout.off_plane(m)]);
        let lobe = |k| Unit::new(q[layout.angle(k)], q[layout.sharpness(k)], off_plane(k));
        Self {
            squeezed: layout.squeezed,
            mirrored: layout.mirrored,
            inverse_squeeze: libm::exp(-q[0]),
            lobes: (0..layout.lobes).map(lobe).collect(),
        }
    }

    /// How many lobes there are, the diffuse term not counted.
    pub fn len(&self) -> usize {
        self.lobes.len()
    }

    /// Squeezed direction and change of solid angle.
    #[inline(always)]
    fn squeeze(&self, d: &[f64; 3]) -> ([f64; 3], f64) {
        let y = d[1] * self.inverse_squeeze;
        let inverse = 1.0 / (d[0] * d[0] + y * y + d[2] * d[2]).sqrt();
        ([d[0] * inverse, y * inverse, d[2] * inverse], self.inverse_squeeze * inverse * inverse * inverse)
    }

    /// Values of the unit lobes, and of the diffuse term of albedo 1, `cos / pi`. Shapes: `out` [K + 1], overwritten.
    #[inline(always)]
    pub fn values(&self, d: &[f64; 3], out: &mut [f64]) {
        let (u, j) = self.squeeze(d);
        for (k, (lobe, out)) in self.lobes.iter().zip(&mut *out).enumerate() {
            *out = if k < self.squeezed { j * lobe.value(&u) } else { lobe.value(d) };
        }
        out[self.len()] = d[2] * FRAC_1_PI;
    }

    /// At most [`PANEL`] directions side by side, those that lack straight up.
    #[inline(always)]
    pub fn panel(&self, directions: impl Iterator<Item = [f64; 3]>) -> Panel {
        let zero = [0.0; PANEL];
        let mut round = Directions { at: [zero, zero, [1.0; PANEL]], jacobian: [1.0; PANEL] };
        for (n, d) in directions.enumerate() {
            (0..3).for_each(|axis| round.at[axis][n] = d[axis]);
        }
        let mut squeezed = Directions { at: [zero; 3], jacobian: zero };
        if self.squeezed > 0 {
            for n in 0..PANEL {
                let (u, j) = self.squeeze(&[round.at[0][n], round.at[1][n], round.at[2][n]]);
                (0..3).for_each(|axis| squeezed.at[axis][n] = u[axis]);
                squeezed.jacobian[n] = j;
            }
        }
        Panel { round, squeezed }
    }

    /// Values of one unit lobe at a panel of directions; none if it is 0 at all of them.
    #[inline(always)]
    pub fn column(&self, k: usize, panel: &Panel) -> Option<Column> {
        let directions = if k < self.squeezed { &panel.squeezed } else { &panel.round };
        let lobe = &self.lobes[k];
        let mut sums = [0.0; PANEL];
        let mut exponents = [0.0; PANEL];
        let mut is_near = false;
        for axis in lobe.axes() {
            if lobe.exponents(axis, directions, &mut exponents) {
                is_near = true;
                for n in 0..PANEL {
                    sums[n] += directions.jacobian[n] * exp(lobe.sharpness * exponents[n]);
                }
            }
        }
        is_near.then_some(sums)
    }

    /// [`values`](Self::values) at a panel of directions, summed over the lobes. Shapes: `amplitudes` [K + 1] per channel.
    #[inline(always)]
    pub fn sums(&self, panel: &Panel, amplitudes: &[Vec<f64>; 3]) -> [Column; 3] {
        let diffuse = |a: &Vec<f64>| panel.round.at[2].map(|cos| a[self.len()] * FRAC_1_PI * cos);
        let mut sums = [diffuse(&amplitudes[0]), diffuse(&amplitudes[1]), diffuse(&amplitudes[2])];
        for k in 0..self.len() {
            let Some(value) = self.column(k, panel) else { continue };
            for (sum, amplitudes) in sums.iter_mut().zip(amplitudes) {
                let amplitude = amplitudes[k];
                sum.iter_mut().zip(&value).for_each(|(sum, v)| *sum = fused(amplitude, *v, *sum));
            }
        }
        sums
    }

    /// How many columns [`slopes`](Self::slopes) gives.
    pub fn slopes_len(&self) -> usize {
        3 * self.len() + self.squeezed + self.mirrored + 1
    }

    /// Values and derivatives of the unit lobes and of the diffuse term at a panel of directions, each times its `scale`.
    ///
    /// Shapes: `out` and `is_used` [3 K + S + M + 1] for S squeezed lobes and M mirrored ones: K derivatives by angle, K by ln
    /// sharpness; K values; S derivatives by ln squeeze, M by the angle out of the plane; the value of the diffuse term of albedo
    /// 1. Where a lobe is 0 at the whole panel `is_used` is false, and its columns are undefined.
    #[inline(always)]
    pub fn slopes(&self, panel: &Panel, scale: &Column, out: &mut [Column], is_used: &mut [bool]) {
        let count = self.len();
        for (k, lobe) in self.lobes.iter().enumerate() {
            let is_squeezed = k < self.squeezed;
            let extra = match k.checked_sub(count - self.mirrored) {
                Some(m) => Some(3 * count + self.squeezed + m),
                None => is_squeezed.then_some(3 * count + k),
            };
            let directions = if is_squeezed { &panel.squeezed } else { &panel.round };
            let slopes = lobe.slopes(directions, scale, is_squeezed);
            let columns = [Some(k), Some(count + k), Some(2 * count + k), extra];
            for (n, column) in columns.into_iter().enumerate() {
                let Some(column) = column else { continue };
                is_used[column] = slopes.is_some();
                if let Some(slopes) = &slopes {
                    out[column] = slopes[n];
                }
            }
        }
        let last = self.slopes_len() - 1;
        is_used[last] = true;
        for n in 0..PANEL {
            out[last][n] = scale[n] * panel.round.at[2][n] * FRAC_1_PI;
        }
    }
}

impl Unit {
    /// Derivatives by angle and ln sharpness, the value, and the derivative by ln squeeze or by the angle out of the plane;
    /// none if the lobe is 0 at the whole panel.
    #[inline(always)]
    fn slopes(&self, directions: &Directions, scale: &Column, is_squeezed: bool) -> Option<[Column; 4]> {
        let mut sums = [[0.0; PANEL]; 4];
        let mut exponents = [0.0; PANEL];
        let mut is_near = false;
        let s = self.sharpness;
        let [x, y, z] = &directions.at;
        for axis in self.axes() {
            if !self.exponents(axis, directions, &mut exponents) {
                continue;
            }
            is_near = true;
            let ([ax, _, az], [bx, by, bz]) = (axis.by_angle, axis.by_off_plane);
            for n in 0..PANEL {
                let t = exponents[n];
                let e = scale[n] * directions.jacobian[n] * exp(s * t);
                sums[0][n] += s * e * (x[n] * ax + z[n] * az);
                sums[1][n] += s * e * t;
                sums[2][n] += e;
                sums[3][n] += if is_squeezed {
                    let yy = y[n] * y[n];
                    e * (3.0 * yy - 1.0 + s * yy * (t + 1.0))
                } else {
                    s * e * (x[n] * bx + (y[n] * by + z[n] * bz))
                };
            }
        }
        is_near.then_some(sums)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::random::Random;
    use crate::table::direction;

    #[test]
    fn derivatives_agree_with_differences() {
        let layout = Layout::new(4, 2, 1, vec![0.0]);
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
            let lobes = Lobes::new(&layout, &q);
            let panel = lobes.panel([d, d].into_iter());
            let (mut columns, mut is_used) = ([[f64::NAN; PANEL]; 16], [false; 16]);
            let scale = std::array::from_fn(|n| if n == 1 { 0.5 } else { 1.0 });
            lobes.slopes(&panel, &scale, &mut columns, &mut is_used);
            let slopes = std::array::from_fn::<f64, 16, _>(|i| if is_used[i] { columns[i][0] } else { 0.0 });
            assert!((0..16).all(|i| !is_used[i] || (columns[i][1] - 0.5 * slopes[i]).abs() < 1e-14));
            assert!((slopes[15] - d[2] * FRAC_1_PI).abs() < 1e-15);
            let sums = lobes.sums(&panel, &[vec![1.0; 5], vec![0.0; 5], (0..5).map(f64::from).collect()]);
            let weighted: f64 =
                (0..5).map(|k| if k < 4 { slopes[8 + k] } else { slopes[15] } * k as f64).sum();
            assert!((sums[2][0] - weighted).abs() < 1e-12 * weighted && sums[1] == [0.0; PANEL]);
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
