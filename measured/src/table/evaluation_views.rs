//! Where BRDFs that can be evaluated are fitted and judged: at even angles, and halfway between.

use crate::FitError;
use crate::numeric::GOLDEN_ANGLE;
use crate::table::{Brdf, Density, Table, direction};
use std::f64::consts::{PI, TAU};

/// Angle of the last view, degrees: beyond, files hold noise.
const LAST: f64 = 87.0;

/// Directions of a view that is judged: more than are fitted, and elsewhere.
const FINE: Density = Density { hemisphere: 1000, cap: 300 };

/// Angles from the normal to 87 degrees, radians; at least two.
pub fn even_views(count: usize) -> Vec<f64> {
    let count = count.max(2);
    (0..count).map(|n| LAST.to_radians() * n as f64 / (count - 1) as f64).collect()
}

/// The angles halfway between.
pub fn halfway(thetas: &[f64]) -> Vec<f64> {
    thetas.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect()
}

/// Outgoing directions at which visible errors of a fit are judged, angles in radians: 5, 30, 60 and 75 degrees.
pub fn seen_views() -> [f64; 4] {
    [5.0f64, 30.0, 60.0, 75.0].map(f64::to_radians)
}

/// Tabulates a BRDF to judge fits by.
///
/// # Errors
/// As [`Table::from_brdf`].
pub fn judging_table(brdf: &dyn Brdf, thetas: &[f64]) -> Result<Table, FitError> {
    Table::from_brdf(brdf, thetas, FINE)
}

/// Directions that are spread evenly over the hemisphere.
#[doc(hidden)]
pub fn spread(count: usize) -> impl Iterator<Item = [f64; 3]> {
    (0..count).map(move |n| {
        let theta = libm::acos(1.0 - (n as f64 + 0.5) / count as f64);
        direction(theta, (GOLDEN_ANGLE * n as f64) % TAU)
    })
}

/// Directions about one, the denser the nearer: up to half a radian from it.
#[doc(hidden)]
pub fn about(axis: [f64; 3], count: usize) -> impl Iterator<Item = [f64; 3]> {
    let across = libm::hypot(axis[0], axis[1]);
    let (c, s) = if across > 1e-9 { (axis[0] / across, axis[1] / across) } else { (1.0, 0.0) };
    let (outward, aside) = ([axis[2] * c, axis[2] * s, -across], [-s, c, 0.0]);
    (0..count).map(move |n| {
        let place = (n as f64 + 0.5) / count as f64;
        let (sin, cos) = libm::sincos(0.5 * place * place);
        let (y, x) = libm::sincos(GOLDEN_ANGLE * n as f64);
        [0, 1, 2].map(|k| cos * axis[k] + sin * (x * outward[k] + y * aside[k]))
    })
}

/// Relative L2 distance of `f cos` of a BRDF from another one, over the hemisphere and all azimuths of outgoing directions of an angle,
/// radians. A half of the directions lies about the mirror direction.
#[doc(hidden)]
pub fn difference_over_turns(of: &dyn Brdf, from: &dyn Brdf, theta: f64) -> f64 {
    const TURNS: usize = 24;
    let (mut apart, mut all) = (0.0, 0.0);
    for turn in 0..TURNS {
        let phi = TAU * (turn as f64 + 0.3) / TURNS as f64;
        let (wo, mirror) = (direction(theta, phi), direction(theta, phi + PI));
        for (wi, weight) in weighed(mirror) {
            let [of, from] =
                [of, from].map(|brdf| brdf.evaluate(wi, wo).map(|v| if v.is_finite() { v } else { 0.0 }));
            for (a, b) in of.iter().zip(from) {
                apart += weight * wi[2] * wi[2] * (a - b) * (a - b);
                all += weight * wi[2] * wi[2] * b * b;
            }
        }
    }
    libm::sqrt(apart / all)
}

/// Directions over the hemisphere and about one, with weights whose sum over values is an integral.
#[doc(hidden)]
pub fn weighed(axis: [f64; 3]) -> impl Iterator<Item = ([f64; 3], f64)> {
    const COUNT: usize = 600;
    // Density of the two kinds: even, and by the angle from the axis, whose root is even up to half a radian.
    let weight = move |d: [f64; 3]| {
        let cos = (0..3).map(|k| d[k] * axis[k]).sum::<f64>().clamp(-1.0, 1.0);
        let angle = libm::acos(cos);
        let about = if angle < 0.5 && angle > 0.0 {
            1.0 / (2.0 * PI * libm::sin(angle) * 2.0 * libm::sqrt(0.5 * angle))
        } else {
            0.0
        };
        1.0 / (COUNT as f64 * (1.0 / TAU + about))
    };
    spread(COUNT).chain(about(axis, COUNT)).filter(|d| d[2] > 1e-3).map(move |d| (d, weight(d)))
}
