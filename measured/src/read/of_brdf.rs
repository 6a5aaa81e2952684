//! The spectra of a BRDF that is known at every pair of directions: of a table of RGL, or of a model that takes its colours from files.
//!
//! Its values are looked at at some pairs, three wavelengths at a time in place of the colour.

use super::spectra::Spectra;
use super::wavelengths::Wavelengths;
use crate::ReadError;
use crate::numeric::GOLDEN_ANGLE;
use crate::table::{Symmetry, direction};
use std::f64::consts::{FRAC_PI_2, PI};

/// Outgoing directions that are looked at, and the last of them, degrees.
const VIEWS: usize = 15;
const LAST: f64 = 80.0;

/// Incident directions of each, at least.
const EACH: usize = 200;

/// Least height of an incident direction.
const LOW: f64 = 0.02;

/// An incident and an outgoing direction, unit vectors.
pub type Pair = [[f64; 3]; 2];

/// Pairs of directions, of which about `count` are tried: the half vectors lie denser about the normal.
pub fn pairs(count: usize, symmetry: Symmetry) -> impl Iterator<Item = Pair> {
    let each = count.div_ceil(VIEWS).max(EACH);
    let is_turned = symmetry != Symmetry::Isotropic;
    let pair = move |view: usize, n: usize| {
        let theta = LAST.to_radians() * (view as f64 + 0.5) / VIEWS as f64;
        let wo = direction(theta, if is_turned { GOLDEN_ANGLE * view as f64 } else { PI });
        let along = (n as f64 + 0.5) / each as f64;
        let h = direction(along * along * FRAC_PI_2, GOLDEN_ANGLE * n as f64);
        let twice = 2.0 * (0..3).map(|k| h[k] * wo[k]).sum::<f64>();
        let wi = [0, 1, 2].map(|k| twice * h[k] - wo[k]);
        (wi[2] > LOW).then_some([wi, wo])
    };
    (0..VIEWS).flat_map(move |view| (0..each).filter_map(move |n| pair(view, n)))
}

/// The spectra of the colours, from values of the BRDF at pairs of directions: `values` has them for three of the wavelengths, by their
/// places. `None` where there is nothing to tell them by.
///
/// # Errors
/// Those of `values`.
pub fn spectra(
    wavelengths: &Wavelengths,
    pairs: &[Pair],
    mut values: impl FnMut([usize; 3]) -> Result<Vec<[f64; 3]>, ReadError>,
) -> Result<Option<Spectra>, ReadError> {
    let Some(mut sums) = wavelengths.samples() else { return Ok(None) };
    let mut rows = vec![vec![0.0; wavelengths.count()]; pairs.len()];
    for three in sums.places().to_vec().chunks(3) {
        let of = [0, 1, 2].map(|c| three[c.min(three.len() - 1)]);
        for (row, found) in rows.iter_mut().zip(values(of)?) {
            of.iter().zip(found).for_each(|(&n, value)| row[n] = value);
        }
    }
    rows.iter().zip(pairs).for_each(|(row, pair)| sums.add(row, 1.0, *pair));
    Ok(sums.finish(|n| rows[n].iter().all(|v| v.is_finite())))
}
