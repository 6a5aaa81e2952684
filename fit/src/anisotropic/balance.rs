//! The last touch of an anisotropic fit: amplitudes scaled, stored view by stored view, until errors of the albedo are small.
//!
//! As `isotropic/balance.rs` does along one angle. A stored view of a grid has eight others round it, so the matrix is a full one.

use crate::anisotropic::grid::{CellPlace, Layout};
use crate::anisotropic::tuning::balance::{MOST, PASSES, POWER, STAY, STEPS, UNCERTAIN};
use crate::judge::energy::EnergyError;
use crate::numeric::cholesky::Square;
use rayon::prelude::*;

/// Scales the amplitudes at all stored views. `albedo`: places, and the albedo of the data there.
pub(super) fn balance(layout: &Layout, x: &mut [f64], albedo: &[(CellPlace, [f64; 3])]) {
    let energy = EnergyError::new(albedo.iter().map(|(_, albedo)| *albedo));
    let rows = |x: &[f64]| -> Vec<[Row; 3]> {
        let row = |&(place, data): &(CellPlace, [f64; 3])| {
            let mut q = vec![0.0; layout.stride()];
            layout.interpolate(x, place, &mut q);
            let fitted = layout.albedo(&q, None);
            let errors = energy.errors(fitted, data);
            [0, 1, 2].map(|c| Row { place, error: errors[c], slope: fitted[c] / energy.scale(data, c) })
        };
        albedo.par_iter().map(row).collect()
    };
    let largest =
        |rows: &[[Row; 3]], c: usize| rows.iter().fold(0.0, |most: f64, row| most.max(row[c].error.abs()));
    let mut at = rows(x);
    for _ in 0..PASSES {
        let found = [0, 1, 2].map(|c| {
            let of_channel: Vec<Row> = at.iter().map(|row| row[c]).collect();
            factors(&of_channel, layout.stored_views())
        });
        // A channel that has become worse, as one near 0 may, stays as it was.
        let then = rows(&layout.scaled(x, &found, [true; 3], MOST));
        let is_kept = [0, 1, 2].map(|c| largest(&then, c) <= largest(&at, c));
        let moved = layout.scaled(x, &found, is_kept, MOST);
        x.copy_from_slice(&moved);
        at = rows(x);
    }
}

/// The error of a channel's albedo at a place, and its derivative by the logarithm of a factor on all amplitudes.
#[derive(Clone, Copy, Debug)]
struct Row {
    place: CellPlace,
    error: f64,
    slope: f64,
}

/// Logarithms of factors at the stored views that make the largest errors small: weights grow with the errors that are left.
fn factors(rows: &[Row], count: usize) -> Vec<f64> {
    let mut factors = vec![0.0; count];
    for step in 0..STEPS {
        let left = |row: &Row| {
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
