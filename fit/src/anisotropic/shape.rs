//! The lobes of an anisotropic view: axes with any tilt, under a squeeze by a matrix.
//!
//! The squeeze of (x, y) is by the matrix `M = exp(S)`. With `S = m + [[d, o], [o, -d]]` and `R^2 = d^2 + o^2` the exponential is
//! `e^m (cosh R + sinh R / R [[d, o], [o, -d]])`. The axis as the surface has it is `b`, at an angle and azimuth of its two tilts. The
//! lobe sees it as `a = N b / rho` with `N = (M, 1)`, which is 1 for a round lobe. So `a` changes by `(v - a (a.v)) / rho`, with
//! `v = N db` for a tilt and `v = dN b` for a number of the squeeze (`family/unit.rs`).

use crate::family::unit::{Axis, Unit, ViewSqueeze, dot};

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

/// The squeeze by the exponential of a matrix.
pub(super) fn squeeze(ln: Symmetric) -> ViewSqueeze {
    let (matrix, slopes) = exponential(ln);
    let determinant = libm::exp(ln[0] + ln[2]);
    let inverse = [matrix[2], -matrix[1], matrix[0]].map(|v| v / determinant);
    // Rows of a product of symmetric matrices: those of the second, times rows of the first.
    let growth = slopes.map(|m| {
        let (above, below) = (times(inverse, m[0], m[1]), times(inverse, m[1], m[2]));
        [above[0], above[1], below[0], below[1]]
    });
    ViewSqueeze { matrix, determinant, growth: Some(growth) }
}

/// A lobe with tilts along and across the plane of incidence. `squeeze`: that of the view, for a squeezed lobe.
pub(super) fn unit([p, q]: [f64; 2], sharpness: f64, squeeze: Option<&ViewSqueeze>) -> Unit {
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
    let matrix = squeeze.map_or([1.0, 0.0, 1.0], |s| s.matrix);
    let seen = |v: [f64; 3]| {
        let [x, y] = times(matrix, v[0], v[1]);
        [x, y, v[2]]
    };
    let moved = seen(b);
    let rho = libm::sqrt(dot(&moved, &moved));
    let at = moved.map(|v| v / rho);
    let change = |v: [f64; 3]| {
        let along = dot(&at, &v);
        [0, 1, 2].map(|i| (v[i] - along * at[i]) / rho)
    };
    let [by_angle, by_off_plane] = db.map(|v| change(seen(v)));
    let growth = squeeze.and_then(|s| s.growth).unwrap_or_default();
    // dN b is the growth of N b.
    let by_squeeze = growth
        .map(|[xx, xy, yx, yy]| change([xx * moved[0] + xy * moved[1], yx * moved[0] + yy * moved[1], 0.0]));
    let above = Axis { at, by_angle, by_off_plane, by_squeeze };
    let mirrored = |[x, y, z]: [f64; 3]| [x, y, -z];
    let below = Axis {
        at: mirrored(at),
        by_angle: mirrored(by_angle),
        by_off_plane: mirrored(by_off_plane),
        by_squeeze: by_squeeze.map(mirrored),
    };
    Unit { sharpness, axes: [above, below, Axis::default(), Axis::default()], count: 2 }
}

/// An axis, and two directions perpendicular to it and to each other.
pub(super) fn frame(axis: [f64; 3]) -> [[f64; 3]; 3] {
    let [x, y, z] = axis;
    let across = libm::hypot(x, y);
    let (c, s) = if across > 1e-9 { (x / across, y / across) } else { (1.0, 0.0) };
    [axis, [z * c, z * s, -across], [-s, c, 0.0]]
}
