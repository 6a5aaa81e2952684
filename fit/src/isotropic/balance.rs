//! The last touch of a fit: amplitudes scaled, knot by knot, until the largest error of the albedo is as small as it gets.
//!
//! The solver holds the mean square of those errors down beside everything else, at the views of its table; the albedo is asked
//! for at any view. A factor on all amplitudes of a channel at a knot changes the logarithm of the albedo by a hat
//! function of the angle, exactly: so the best factors are the solution of a linear problem, in the norm of a high power,
//! by iteratively reweighted least squares (Lawson 1961; Karlovitz 1970 for the shortened step).

use crate::isotropic::model::parameters::Layout;
use crate::numeric::banded::Banded;
use crate::table::albedo_log::Ratio;

/// Power of the norm: high enough that only the largest errors count.
const POWER: f64 = 16.0;

/// Error of the albedo that is no error: what a quadrature is uncertain by.
const UNCERTAIN: f64 = 1e-3;

/// Weight of the squared factors beside the squared errors.
const STAY: f64 = 1e-4;

/// Steps of the reweighted least squares.
const STEPS: usize = 150;

/// Scales the amplitudes at all knots. `albedo`: angles, radians, and the albedo of the data there. Returns the largest error that is
/// left, of the logarithm.
pub(crate) fn balance(layout: &Layout, x: &mut [f64], albedo: &[(f64, [f64; 3])]) -> f64 {
    let p = layout.stride();
    let ratio = Ratio::new(albedo.iter().map(|(_, albedo)| *albedo));
    let mut q = vec![0.0; p];
    let rows: Vec<((usize, f64), [f64; 3])> = albedo
        .iter()
        .map(|&(theta, data)| {
            let place = layout.place(theta);
            layout.interpolate(x, place, &mut q);
            let fitted = layout.albedo(&q);
            (place, [0, 1, 2].map(|c| ratio.ln(fitted[c], data[c])))
        })
        .collect();
    let mut largest = 0.0;
    for channel in 0..3 {
        let rows: Vec<_> = rows.iter().map(|&(place, errors)| (place, errors[channel])).collect();
        let factors = factors(&rows, layout.knots.len());
        largest = rows
            .iter()
            .fold(largest, |most: f64, &(place, error)| most.max((error + at(&factors, place)).abs()));
        for (knot, factor) in factors.into_iter().enumerate() {
            (0..layout.lobes).for_each(|k| x[knot * p + layout.amplitude(channel, k)] += factor);
            x[knot * p + layout.diffuse(channel)] += factor;
        }
    }
    largest
}

/// Factors at the knots, interpolated.
fn at(factors: &[f64], (knot, blend): (usize, f64)) -> f64 {
    (1.0 - blend) * factors[knot] + if blend > 0.0 { blend * factors[knot + 1] } else { 0.0 }
}

/// Logarithms of factors at the knots that make the largest error small. `rows`: places between knots and the errors there.
fn factors(rows: &[((usize, f64), f64)], knots: usize) -> Vec<f64> {
    let mut factors = vec![0.0; knots];
    for _ in 0..STEPS {
        let errors: Vec<f64> = rows.iter().map(|&(place, error)| error + at(&factors, place)).collect();
        let largest = errors.iter().fold(UNCERTAIN, |most, e| most.max(e.abs()));
        let mut matrix = Banded::zeros(knots, 1.min(knots - 1));
        let mut step = vec![0.0; knots];
        for (&((knot, blend), _), error) in rows.iter().zip(&errors) {
            let weight = libm::pow(libm::hypot(*error, UNCERTAIN) / largest, POWER - 2.0);
            matrix.add(knot, knot, weight * (1.0 - blend) * (1.0 - blend));
            step[knot] -= weight * (1.0 - blend) * error;
            if blend > 0.0 {
                matrix.add(knot + 1, knot, weight * blend * (1.0 - blend));
                matrix.add(knot + 1, knot + 1, weight * blend * blend);
                step[knot + 1] -= weight * blend * error;
            }
        }
        for knot in 0..knots {
            matrix.add(knot, knot, STAY);
            step[knot] -= STAY * factors[knot];
        }
        if !matrix.factor() {
            break;
        }
        matrix.solve(&mut step);
        factors.iter_mut().zip(&step).for_each(|(f, s)| *f += s / (POWER - 1.0));
    }
    factors
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors of a curve between 5 knots, without and with the factors.
    fn largest(error: impl Fn(f64) -> f64) -> (f64, f64) {
        let places: Vec<(usize, f64)> = (0..80).map(|i| (i / 20, (i % 20) as f64 / 20.0)).collect();
        let rows: Vec<_> = places.iter().map(|&(k, b)| ((k, b), error(k as f64 + b))).collect();
        let factors = factors(&rows, 5);
        let after = rows.iter().map(|&((k, b), e)| (e + (1.0 - b) * factors[k] + b * factors[k + 1]).abs());
        (rows.iter().fold(0.0, |m, r| m.max(r.1.abs())), after.fold(0.0, f64::max))
    }

    #[test]
    fn the_largest_error_is_halved_where_a_curve_bends_and_gone_where_it_does_not() {
        // A parabola between every two knots, 0 at them: the best straight lines leave half of its height.
        let (before, after) = largest(|x| 0.02 * 4.0 * x.fract() * (1.0 - x.fract()));
        assert!((before - 0.02).abs() < 1e-12 && after < 0.0105, "{after}");
        let (before, after) = largest(|x| 0.03 - 0.01 * x);
        assert!((before - 0.03).abs() < 1e-12 && after < 1e-3, "{after}");
    }
}
