//! Factors on amplitudes over a grid of stored views, by which errors of the albedo become small: `family/balance.rs` asks for them.
//!
//! A stored view of a grid has eight others round it, so the matrix is a full one.

use crate::anisotropic::grid::{CellPlace, Layout};
use crate::anisotropic::tuning::balance::{MOST, PASSES, POWER, STAY, STEPS, UNCERTAIN};
use crate::family::balance::{Balance, Row};
use crate::family::factors::Factors;
use crate::family::tuning::factors::AVERAGED;
use crate::numeric::cholesky::Square;
use rayon::prelude::*;

/// Scales the amplitudes at all stored views. `albedo`: places, and the albedo of the data there.
pub(super) fn balance(
    layout: &Layout,
    x: &mut [f64],
    table: Option<&Factors>,
    albedo: &[(CellPlace, [f64; 3])],
) {
    // Amplitudes alone are scaled, and the means of factors over lobes do not depend on them.
    let means = |&(place, _): &(CellPlace, [f64; 3])| {
        let mut q = vec![0.0; layout.stride()];
        layout.interpolate(x, place, &mut q);
        table.map(|f| f.means(layout, &q, layout.theta(place), AVERAGED))
    };
    let means: Vec<Option<Vec<[f64; 3]>>> = albedo.par_iter().map(means).collect();
    let of = |number: usize, q: &[f64]| layout.albedo(q, means[number].as_deref());
    let balance = Balance { layout, aims: albedo, albedo: of, passes: PASSES, most: MOST };
    balance.scale(x, |rows| factors(rows, layout.stored_views()));
}

/// Logarithms of factors at the stored views that make the largest errors small: weights grow with the errors that are left.
fn factors(rows: &[Row<CellPlace>], count: usize) -> Vec<f64> {
    let mut factors = vec![0.0; count];
    for step in 0..STEPS {
        let left = |row: &Row<CellPlace>| {
            row.error
                + row.slope * row.place.stored().iter().map(|(k, share)| share * factors[*k]).sum::<f64>()
        };
        let errors: Vec<f64> = rows.iter().map(left).collect();
        let largest = errors.iter().fold(UNCERTAIN, |most, e| most.max(e.abs()));
        let mut matrix = Square::zeros(count);
        let mut right = vec![0.0; count];
        for (row, error) in rows.iter().zip(&errors) {
            let weight = libm::pow(libm::hypot(*error, UNCERTAIN) / largest, POWER);
            let stored = row.place.stored();
            for &(a, share) in &stored {
                right[a] -= weight * row.slope * share * error;
                for &(b, other) in stored.iter().filter(|other| other.0 <= a) {
                    matrix.row_mut(a)[b] += weight * row.slope * row.slope * share * other;
                }
            }
        }
        for k in 0..count {
            matrix.row_mut(k)[k] += STAY;
            right[k] -= STAY * factors[k];
        }
        let Some(factor) = matrix.cholesky() else { break };
        // Full steps at high powers go too far.
        let share = if step == 0 { 1.0 } else { 1.0 / (1.0 + POWER) };
        factors.iter_mut().zip(factor.solve(&right)).for_each(|(f, by)| *f += share * by);
    }
    factors
}
