//! Factors on amplitudes along one angle, by which the largest error of the albedo becomes as small as it gets: `family/balance.rs` asks for them.
//!
//! A factor on all amplitudes of a channel at a stored view changes the albedo by nearly a hat
//! function of the angle: so the best factors are the solution of a linear problem, in the norm of a high power,
//! by iteratively reweighted least squares (Lawson 1961; Karlovitz 1970 for the shortened step).

use crate::family::balance::{Balance, Row};
use crate::family::factors::Factors;
use crate::isotropic::line::{Layout, LinePlace};
use crate::isotropic::tuning::balance::{MOST, PASSES, POWER, STAY, STEPS, UNCERTAIN};
use crate::numeric::banded::Banded;
use rayon::prelude::*;

/// Scales the amplitudes at all stored views. `albedo`: angles, radians, and the albedo of the data there. Returns the largest error that is
/// left.
pub(crate) fn balance(
    layout: &Layout,
    x: &mut [f64],
    table: Option<&Factors>,
    albedo: &[(f64, [f64; 3])],
    averaged: usize,
) -> f64 {
    let aims: Vec<_> = albedo.iter().map(|&(theta, data)| (layout.place(theta), data)).collect();
    // Amplitudes alone are scaled, and the means of factors over lobes do not depend on them.
    let means = |&(place, _): &(LinePlace, [f64; 3])| {
        let mut q = vec![0.0; layout.stride()];
        layout.interpolate(x, place, &mut q);
        table.map(|f| f.means(layout, &q, layout.theta(place), averaged))
    };
    let means: Vec<Option<Vec<[f64; 3]>>> = aims.par_iter().map(means).collect();
    let of = |number: usize, q: &[f64]| layout.albedo(q, means[number].as_deref());
    let balance = Balance { layout, aims: &aims, albedo: of, passes: PASSES, most: MOST };
    balance.scale(x, |rows| factors(rows, layout.views.angles.len()))
}

/// Factors at the stored views, interpolated.
fn at(factors: &[f64], (stored, blend): LinePlace) -> f64 {
    (1.0 - blend) * factors[stored] + if blend > 0.0 { blend * factors[stored + 1] } else { 0.0 }
}

/// Logarithms of factors at the stored views that make the largest error small.
fn factors(rows: &[Row<LinePlace>], count: usize) -> Vec<f64> {
    let mut factors = vec![0.0; count];
    for _ in 0..STEPS {
        let errors: Vec<f64> =
            rows.iter().map(|row| row.error + row.slope * at(&factors, row.place)).collect();
        let largest = errors.iter().fold(UNCERTAIN, |most, e| most.max(e.abs()));
        let mut matrix = Banded::zeros(count, 1.min(count - 1));
        let mut step = vec![0.0; count];
        for (&Row { place: (stored, blend), slope, .. }, error) in rows.iter().zip(&errors) {
            let weight = ((error * error + UNCERTAIN * UNCERTAIN) / (largest * largest)).powi(POWER / 2 - 1);
            if slope == 0.0 {
                continue;
            }
            let (weight, error) = (weight * slope * slope, error / slope);
            matrix.add(stored, stored, weight * (1.0 - blend) * (1.0 - blend));
            step[stored] -= weight * (1.0 - blend) * error;
            if blend > 0.0 {
                matrix.add(stored + 1, stored, weight * blend * (1.0 - blend));
                matrix.add(stored + 1, stored + 1, weight * blend * blend);
                step[stored + 1] -= weight * blend * error;
            }
        }
        for stored in 0..count {
            matrix.add(stored, stored, STAY);
            step[stored] -= STAY * factors[stored];
        }
        if !matrix.factor() {
            break;
        }
        matrix.solve(&mut step);
        factors.iter_mut().zip(&step).for_each(|(f, s)| *f += s / f64::from(POWER - 1));
    }
    factors
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors of a curve between 5 stored views, without and with the factors.
    fn largest(error: impl Fn(f64) -> f64) -> (f64, f64) {
        let places: Vec<(usize, f64)> = (0..80).map(|i| (i / 20, (i % 20) as f64 / 20.0)).collect();
        let row = |&(k, b): &(usize, f64)| Row { place: (k, b), error: error(k as f64 + b), slope: 1.0 };
        let rows: Vec<Row<LinePlace>> = places.iter().map(row).collect();
        let factors = factors(&rows, 5);
        let after = rows.iter().map(|r| (r.error + at(&factors, r.place)).abs());
        (rows.iter().fold(0.0, |m, r| m.max(r.error.abs())), after.fold(0.0, f64::max))
    }

    #[test]
    fn the_largest_error_is_halved_where_a_curve_bends_and_gone_where_it_does_not() {
        // A parabola between every two stored views, 0 at them: the best straight lines leave half of its height.
        let (before, after) = largest(|x| 0.02 * 4.0 * x.fract() * (1.0 - x.fract()));
        assert!((before - 0.02).abs() < 1e-12 && after < 0.0105, "{after}");
        let (before, after) = largest(|x| 0.03 - 0.01 * x);
        assert!((before - 0.03).abs() < 1e-12 && after < 1e-3, "{after}");
    }
}
