//! The truth in f64, from the equations of the design, in their plainest form; shares no code with `core`.
//!
//! f64 has nine digits more than f32: forms that lose a digit per decade of sharpness still have eight left at 1e8.

use glam::DVec3;
use srbf_core::{AnyMixture, Domain};
use std::f64::consts::PI;

/// `exp(s (cos - 1))` with the angle between two vectors of any length.
pub fn gaussian(axis: DVec3, sharpness: f64, d: DVec3) -> f64 {
    let (a, b) = (axis.normalize(), d.normalize());
    (-0.5 * sharpness * (a - b).length_squared()).exp()
}

/// Integral of a Gaussian over the sphere.
pub fn sphere_integral(sharpness: f64) -> f64 {
    if sharpness == 0.0 { 4.0 * PI } else { -2.0 * PI * (-2.0 * sharpness).exp_m1() / sharpness }
}

/// Share of a Gaussian within `w = 1 - cos` of its axis.
pub fn share_within(sharpness: f64, w: f64) -> f64 {
    if sharpness == 0.0 { 0.5 * w } else { (-sharpness * w).exp_m1() / (-2.0 * sharpness).exp_m1() }
}

/// The direction mirrored in z = 0.
pub fn mirrored(d: DVec3) -> DVec3 {
    DVec3::new(d.x, d.y, -d.z)
}

/// A direction in the frame of the view, by the cosine and sine of its azimuth. They are rounded, and the direction keeps its angle from the normal.
pub fn turned([cos, sin]: [f64; 2], d: DVec3) -> DVec3 {
    DVec3::new(cos * d.x + sin * d.y, cos * d.y - sin * d.x, cos.hypot(sin) * d.z)
}

/// The direction that squeezed lobes see, by the squeezes along x and y, and the change of solid angle, in the frame of the view.
pub fn squeezed([along, across]: [f64; 2], d: DVec3) -> (DVec3, f64) {
    let m = DVec3::new(d.x / along, d.y / across, d.z);
    let r = m.length() / d.length();
    (m, 1.0 / (along * across * r * r * r))
}

/// Value of the lobes of a mixture: linear sRGB.
pub fn mixture(m: &AnyMixture<'_>, d: DVec3) -> DVec3 {
    (0..m.len()).map(|k| mixture_lobe(m, k, d)).sum()
}

/// Value of lobe `k` of a mixture.
pub fn mixture_lobe(m: &AnyMixture<'_>, k: usize, d: DVec3) -> DVec3 {
    let folded = m.domain() == Domain::Hemisphere;
    if folded && d.z < 0.0 {
        return DVec3::ZERO;
    }
    let d = turned(m.azimuth_cos_sin().map(f64::from), d);
    let lobe = m.lobe(k).expect("lobe");
    let (axis, s) = (lobe.gaussian.axis.as_dvec3(), f64::from(lobe.gaussian.sharpness));
    let squeeze = [m.squeeze_along(), m.squeeze()].map(f64::from);
    let (u, scale) = if k < m.squeezed_len() { squeezed(squeeze, d) } else { (d, 1.0) };
    let fold = if folded { gaussian(axis, s, mirrored(u)) } else { 0.0 };
    lobe.amplitude.as_dvec3() * ((gaussian(axis, s, u) + fold) * scale)
}

/// Luminance of linear sRGB.
pub fn luminance(rgb: DVec3) -> f64 {
    0.2126 * rgb.x + 0.7152 * rgb.y + 0.0722 * rgb.z
}

/// Linear sRGB of a luminance and two relative colour differences.
pub fn color(luminance: f64, [rho, beta]: [f64; 2]) -> DVec3 {
    let green = 1.0 - (0.2126 * rho + 0.0722 * beta) / 0.7152;
    luminance * DVec3::new(1.0 + rho, green, 1.0 + beta)
}

/// Factor for a pair of directions above the horizon, of `nodes` evenly spaced nodes from 0 to 1 along the roots of the half angle and of
/// the difference angle, and along the squared cosine of the azimuth of wi round the half direction from the normal. The directions are
/// taken as they are, rounded to f32.
pub fn factor(
    ([half, difference, azimuth], is_signed): ([usize; 3], bool),
    node: impl Fn(usize, usize, usize) -> DVec3,
    wo: DVec3,
    wi: DVec3,
) -> DVec3 {
    let sum = wi + wo;
    // 1 - cos of the half angle, and of the difference angle, without cancellation.
    let to_normal = (sum.x * sum.x + sum.y * sum.y) / (sum.length() * (sum.length() + sum.z));
    let to_outgoing = (wi - wo).length_squared() / (4.0 + 2.0 * sum.length());
    let place = |x: f64, nodes: usize| {
        let x = (x * (nodes - 1) as f64).min((nodes - 1) as f64);
        let before = (x as usize).min(nodes - 2);
        (before, x - before as f64)
    };
    let ((i, a), (j, b)) = (place(to_normal.powf(0.25), half), place(to_outgoing.sqrt(), difference));
    let plane = |k| {
        (node(i, j, k) * (1.0 - a) + node(i + 1, j, k) * a) * (1.0 - b)
            + (node(i, j + 1, k) * (1.0 - a) + node(i + 1, j + 1, k) * a) * b
    };
    if azimuth == 1 {
        return plane(0);
    }
    // Both wo and the normal without their parts along the half direction; where one is 0, all azimuths have the same nodes.
    let (h, apart) = (sum.normalize(), wi - wo);
    let cosine = apart.normalize_or_zero().z / h.x.hypot(h.y).max(1e-300);
    let square = (cosine * cosine).min(1.0);
    let (k, c) = place(if is_signed { 0.5 + (0.5 * square).copysign(apart.z) } else { square }, azimuth);
    plane(k) * (1.0 - c) + plane(k + 1) * c
}

/// Value of a mixture with its diffuse term, and its density.
pub fn mixture_and_pdf(m: &AnyMixture<'_>, d: DVec3) -> (DVec3, f64) {
    let diffuse = m.diffuse().as_dvec3();
    let power = |k| {
        let lobe = m.lobe(k).expect("lobe");
        luminance(lobe.amplitude.as_dvec3()) * sphere_integral(f64::from(lobe.gaussian.sharpness))
    };
    let power: f64 = luminance(diffuse) + (0..m.len()).map(power).sum::<f64>();
    let value = mixture(m, d) + diffuse * (d.z.max(0.0) / PI);
    (value, luminance(value) / power)
}

/// Legendre polynomial by its three-term recurrence.
pub fn legendre(l: usize, x: f64) -> f64 {
    let (mut p0, mut p1) = (1.0, x);
    if l == 0 {
        return 1.0;
    }
    for k in 1..l {
        let k = k as f64;
        (p0, p1) = (p1, ((2.0 * k + 1.0) * x * p1 - k * p0) / (k + 1.0));
    }
    p1
}

/// Nodes and weights of Gauss's rule of three points on [0, 1].
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_31, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// Integrates over the sphere, or the upper hemisphere, on a grid of `n` heights by `4 n` azimuths.
pub fn integrate(domain: Domain, n: usize, f: impl Fn(DVec3) -> f64) -> f64 {
    let low = if domain == Domain::Hemisphere { 0.0 } else { -1.0 };
    let (height, columns) = ((1.0 - low) / n as f64, 4 * n);
    let mut sum = 0.0;
    for i in 0..n {
        for (x, weight) in GAUSS {
            let z = low + (i as f64 + x) * height;
            let r = (1.0 - z * z).sqrt();
            for j in 0..columns {
                let (s, c) = ((j as f64 + 0.5) / columns as f64 * 2.0 * PI).sin_cos();
                sum += weight * f(DVec3::new(r * c, r * s, z));
            }
        }
    }
    sum * height * 2.0 * PI / columns as f64
}

/// As [`integrate`] over the sphere, on a grid that is geometric in the angle to an axis: for functions that are sharp there.
pub fn integrate_around(axis: DVec3, n: usize, f: impl Fn(DVec3) -> f64) -> f64 {
    let (t, b) = axis.any_orthonormal_pair();
    let mut sum = 0.0;
    let rows = 2 * n;
    // w = 1 - cos from 2^-40 to 2 in `rows` steps of equal ratio for the inner half, even steps of z outside.
    let edge = |i: usize| {
        if i == 0 {
            0.0
        } else if i <= n {
            0.25 * 2f64.powf(-38.0 * (n - i) as f64 / n as f64)
        } else {
            0.25 + 1.75 * (i - n) as f64 / n as f64
        }
    };
    const GAUSS: [(f64, f64); 3] =
        [(0.112_701_665_379_258_31, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];
    let columns = 4 * n;
    for i in 0..rows {
        let (from, to) = (edge(i), edge(i + 1));
        for (x, weight) in GAUSS {
            let w = from + x * (to - from);
            let sin = (w * (2.0 - w)).sqrt();
            for j in 0..columns {
                let (s, c) = ((j as f64 + 0.5) / columns as f64 * 2.0 * PI).sin_cos();
                let d = axis * (1.0 - w) + t * (sin * c) + b * (sin * s);
                sum += weight * (to - from) * (2.0 * PI / columns as f64) * f(d);
            }
        }
    }
    sum
}
