//! Held-out error of scattered tables: what a fit says where it has seen nothing.

use crate::report::ViewReport;
use crate::table::{Scattered, Table, View};
use crate::{FitError, Settings, fit};

/// Errors of views whose samples were, in part or all, left out of the fit.
#[derive(Clone, Debug, PartialEq)]
pub struct CrossValidation {
    /// Each view's error over samples that were left out, a fifth at a time.
    pub folds: Vec<f64>,
    /// Each view's error when the whole view was left out; the first and the last view stay in.
    pub left_out: Vec<(f64, f64)>,
}

const FOLDS: usize = 5;

/// Fits a table without each fifth of its samples, and without each inner view, and judges what was left out.
///
/// The fifth is every fifth sample in the order of the file. Weights and albedo are made again from what is left.
///
/// # Errors
/// As [`fit`]; [`FitError::Table`] for a view with fewer than five samples.
pub fn cross_validate(table: &Table, settings: &Settings) -> Result<CrossValidation, FitError> {
    let scattered = |view: &View, keep: &dyn Fn(usize) -> bool| -> (f64, Scattered) {
        let kept = view.samples.iter().enumerate().filter(|(n, _)| keep(*n));
        (view.theta, kept.map(|(_, s)| (s.direction, s.rgb)).collect())
    };
    let mut squares = vec![0.0; table.views.len()];
    for fold in 0..FOLDS {
        let views = table.views.iter().map(|v| scattered(v, &|n| n % FOLDS != fold)).collect();
        let fitted = fit(&Table::from_scattered(views)?, settings, |_| {})?;
        for (square, view) in squares.iter_mut().zip(&table.views) {
            let samples = view.samples.iter().skip(fold).step_by(FOLDS).copied().collect();
            let report = ViewReport::new(&fitted.bytes, &View { samples, ..view.clone() })?;
            *square += report.error * report.error / FOLDS as f64;
        }
    }
    let mut left_out = Vec::new();
    for gone in 1..table.views.len().saturating_sub(1) {
        let mut rest = table.clone();
        let view = rest.views.remove(gone);
        let fitted = fit(&rest, settings, |_| {})?;
        left_out.push((view.theta, ViewReport::new(&fitted.bytes, &view)?.error));
    }
    Ok(CrossValidation { folds: squares.into_iter().map(libm::sqrt).collect(), left_out })
}
