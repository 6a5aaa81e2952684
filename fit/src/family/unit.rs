//! The value of unit lobes at directions, with derivatives.
//!
//! With `u` the direction as a lobe sees it (squeezed or not), `j` the change of solid angle, and `m` the lobe's axes, a unit
//! lobe is
//!
//! ```text
//! G = j sum_m E_m,  E_m = exp(s (u.m - 1))
//! dG/da    = j s sum_m E_m (u.dm/da)          a: angle of the axis in the plane of incidence, or out of it
//! dG/dln s = j s sum_m E_m (u.m - 1)
//! dG/dq    = j   sum_m E_m (s (v.m - (u.v) u.m + u.dm/dq) + dj/j),   v = dN/dq d / |N d|,  dj/j = tr dN/dq N^-1 - 3 u.v
//! ```
//!
//! where q is a number of the squeeze `N = (M, 1)` of (x, y) by a matrix M, and `u = N d / |N d|`. Two kinds of lobes are made of it.
//! In the one kind M is `1 / c` across the plane of incidence, and axes in that plane are given as the lobe sees them. So v is
//! `(0, -u.y, 0)` for ln c, and the last line is `j sum_m E_m (-1 + 3 u.y^2 + s u.y^2 u.m)`. In the other kind M is any symmetric
//! matrix, and axes are given as the surface has them; so they move with M.
//!
//! Panels of directions are in f32. So `u.m - 1` is `-|u - m|^2 / 2` there, and a derivative of an axis, which is perpendicular to it, meets
//! `u - m` and not `u`: a value at sharpness 1e6 is within 1e-3 of its own, one at 1e3 within 1e-5. The exponential is our own. So the loops
//! over directions become vector instructions of any width (`crate::numeric::vector`), with the same results to the last bit.

use crate::family::tuning::lobes::NEGLIGIBLE;
use crate::numeric::vector::{exp, exp_f32, fused_f32};

/// Directions of a panel.
pub(crate) const PANEL: usize = 64;

/// A number for every direction of a panel.
pub(crate) type Column = [f32; PANEL];

/// How a view's squeezed lobes see directions.
pub(crate) struct ViewSqueeze {
    /// The matrix M of x and y: xx, xy, yy.
    pub matrix: [f64; 3],
    pub determinant: f64,
    /// `dM/dq M^-1` by each number q of the squeeze, row by row; none if the squeeze is across the plane of incidence alone.
    pub growth: Option<[[f64; 4]; 3]>,
}

/// One lobe.
pub(crate) struct Unit {
    pub sharpness: f64,
    pub axes: [Axis; 4],
    /// How many of the axes there are.
    pub count: usize,
}

/// One axis, and its derivatives by the angles in and out of the plane of incidence and by the squeeze.
#[derive(Clone, Copy, Default)]
pub(crate) struct Axis {
    pub at: [f64; 3],
    pub by_angle: [f64; 3],
    pub by_off_plane: [f64; 3],
    pub by_squeeze: [[f64; 3]; 3],
}

/// Directions as lobes see them, and the change of solid angle.
pub(crate) struct Directions {
    pub at: [Column; 3],
    pub jacobian: Column,
}

impl Unit {
    /// The axes.
    #[inline(always)]
    pub fn axes(&self) -> &[Axis] {
        &self.axes[..self.count]
    }

    /// Value at a direction as the lobe sees it.
    #[inline(always)]
    pub fn value(&self, u: &[f64; 3]) -> f64 {
        self.axes().iter().map(|axis| exp(self.sharpness * (dot(u, &axis.at) - 1.0))).sum()
    }

    /// Exponents over the sharpness at a panel of directions; false if all are too low to count.
    #[inline(always)]
    pub fn exponents(&self, axis: &Axis, directions: &Directions, out: &mut Column) -> bool {
        let [x, y, z] = &directions.at;
        let [ax, ay, az] = in_f32(axis.at);
        let least = (NEGLIGIBLE / self.sharpness) as f32;
        let mut is_near = false;
        for n in 0..PANEL {
            let [dx, dy, dz] = [x[n] - ax, y[n] - ay, z[n] - az];
            let t = -0.5 * fused_f32(dx, dx, fused_f32(dy, dy, dz * dz));
            is_near |= t > least;
            out[n] = t;
        }
        is_near
    }

    /// Derivatives by angle and ln sharpness, the value, and the derivative by the angle out of the plane; then, of a squeezed lobe,
    /// those by the squeeze. None if the lobe is 0 at the whole panel.
    ///
    /// `N` is 4 where the squeeze is across the plane of incidence alone: there a lobe is either squeezed or has an angle out of the
    /// plane, and the fourth column is by that. Else `N` is 7. Columns by a squeeze that a lobe does not have are 0.
    #[inline(always)]
    pub fn slopes<const N: usize>(
        &self,
        directions: &Directions,
        scale: &Column,
        growth: Option<&[[f64; 4]; 3]>,
        is_squeezed: bool,
    ) -> Option<[Column; N]> {
        let mut sums = [[0.0; PANEL]; N];
        let mut exponents = [0.0; PANEL];
        let mut values = [0.0; PANEL];
        let mut is_near = false;
        let s = self.sharpness as f32;
        let [x, y, z] = &directions.at;
        for axis in self.axes() {
            if !self.exponents(axis, directions, &mut exponents) {
                continue;
            }
            is_near = true;
            let at = in_f32(axis.at);
            let [ax, ay, az] = in_f32(axis.by_angle);
            let [bx, by, bz] = in_f32(axis.by_off_plane);
            for n in 0..PANEL {
                let t = exponents[n];
                let [dx, dy, dz] = [x[n] - at[0], y[n] - at[1], z[n] - at[2]];
                let e = scale[n] * directions.jacobian[n] * exp_f32(s * t);
                let se = s * e;
                // In the plane of incidence `ay` is 0.
                let along = if N == 4 { dz * az } else { fused_f32(dy, ay, dz * az) };
                sums[0][n] += se * fused_f32(dx, ax, along);
                sums[1][n] += se * t;
                sums[2][n] += e;
                sums[3][n] += if N == 4 && is_squeezed {
                    let yy = y[n] * y[n];
                    fused_f32(se * yy, t + 1.0, e * fused_f32(3.0, yy, -1.0))
                } else {
                    se * fused_f32(dx, bx, fused_f32(dy, by, dz * bz))
                };
                values[n] = e;
            }
            let growth = growth.filter(|_| N > 4 && is_squeezed);
            for (q, [xx, xy, yx, yy]) in growth.into_iter().flatten().map(|g| g.map(|v| v as f32)).enumerate()
            {
                let moved = in_f32(axis.by_squeeze[q]);
                for n in 0..PANEL {
                    let d = [x[n] - at[0], y[n] - at[1], z[n] - at[2]];
                    let v = [xx * x[n] + xy * y[n], yx * x[n] + yy * y[n]];
                    let along = v[0] * x[n] + v[1] * y[n];
                    // v.m - (u.v) u.m is -v.(u - m) - (u.v) (u.m - 1).
                    let turned = (moved[0] - v[0]) * d[0] + (moved[1] - v[1]) * d[1] + moved[2] * d[2];
                    let change = s * (turned - along * exponents[n]) + (xx + yy - 3.0 * along);
                    sums[4 + q][n] += values[n] * change;
                }
            }
        }
        is_near.then_some(sums)
    }
}

#[inline(always)]
fn in_f32(v: [f64; 3]) -> [f32; 3] {
    v.map(|v| v as f32)
}

#[inline(always)]
pub(crate) fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + (a[1] * b[1] + a[2] * b[2])
}
