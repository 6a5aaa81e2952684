//! The last touch of a fit: amplitudes scaled, stored view by stored view, until errors of the albedo are small.
//!
//! The solver holds the mean square of those errors down beside everything else, at the views of its table; the albedo is asked for at any
//! view. Which factors do that is a linear problem of the stored views, in a line or on a grid: the caller solves it.

use crate::family::layout::{Layout, Views};
use crate::judge::energy::EnergyError;
use rayon::prelude::*;

/// The error of a channel's albedo at a place, and its derivative by the logarithm of a factor on all amplitudes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row<P> {
    pub place: P,
    pub error: f64,
    pub slope: f64,
}

/// The albedos that are aimed at.
pub(crate) struct Balance<'a, V: Views, F> {
    pub layout: &'a Layout<V>,
    /// Places, and the albedo of the data there.
    pub aims: &'a [(V::Place, [f64; 3])],
    /// The albedo of the interpolated unknowns at an aim, by its number.
    pub albedo: F,
    /// Times that factors are found: albedos between stored views do not follow them exactly.
    pub passes: usize,
    /// Largest logarithm of a factor.
    pub most: f64,
}

impl<V: Views, F: Fn(usize, &[f64]) -> [f64; 3] + Sync> Balance<'_, V, F> {
    /// Scales the amplitudes at all stored views by what `factors` finds for a channel: a logarithm for each stored view. A channel that has
    /// become worse, as one near 0 may, stays as it was. Returns the largest error that is left.
    pub fn scale(&self, x: &mut [f64], factors: impl Fn(&[Row<V::Place>]) -> Vec<f64>) -> f64 {
        let mut at = self.rows(x);
        for _ in 0..self.passes {
            let found = at.each_ref().map(|rows| factors(rows));
            let mut is_kept = [true; 3];
            for _ in 0..2 {
                let moved = self.layout.scaled(x, &found, is_kept, self.most);
                let then = self.rows(&moved);
                let kept = [0, 1, 2].map(|c| is_kept[c] && largest(&then[c]) <= largest(&at[c]));
                if kept == is_kept {
                    x.copy_from_slice(&moved);
                    at = then;
                    break;
                }
                is_kept = kept;
            }
        }
        at.iter().map(|rows| largest(rows)).fold(0.0, f64::max)
    }

    /// Of each channel.
    fn rows(&self, x: &[f64]) -> [Vec<Row<V::Place>>; 3] {
        let energy = EnergyError::new(self.aims.iter().map(|(_, data)| *data));
        let row = |(number, &(place, data)): (usize, &(V::Place, [f64; 3]))| {
            let mut q = vec![0.0; self.layout.stride()];
            self.layout.interpolate(x, place, &mut q);
            let fitted = (self.albedo)(number, &q);
            let errors = energy.errors(fitted, data);
            [0, 1, 2].map(|c| Row { place, error: errors[c], slope: fitted[c] / energy.scale(data, c) })
        };
        let rows: Vec<[Row<V::Place>; 3]> = self.aims.par_iter().enumerate().map(row).collect();
        [0, 1, 2].map(|c| rows.iter().map(|row| row[c]).collect())
    }
}

fn largest<P>(rows: &[Row<P>]) -> f64 {
    rows.iter().fold(0.0, |most: f64, row| most.max(row.error.abs()))
}
