//! Held-out error of scattered tables, for any method: what a fit says where it has seen nothing.

use crate::FitError;
use crate::method::Method;
use crate::report::{Norm, relative_l2};
use crate::table::{Scattered, Table, View};

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
/// As [`Method::fit`]; [`FitError::Table`] for a view with fewer than five samples.
pub fn cross_validate(table: &Table, method: &dyn Method) -> Result<CrossValidation, FitError> {
    if let Some(view) = table.views.iter().find(|v| v.samples.len() < FOLDS) {
        return Err(FitError::Table(format!(
            "view at {:.2} degrees: {} samples, at least {FOLDS} are needed to leave some out",
            view.theta.to_degrees(),
            view.samples.len()
        )));
    }
    let scattered = |view: &View, keep: &dyn Fn(usize) -> bool| -> (f64, Scattered) {
        let kept = view.samples.iter().enumerate().filter(|(n, _)| keep(*n));
        (view.theta, kept.map(|(_, s)| (s.direction, s.rgb)).collect())
    };
    let mut squares = vec![0.0; table.views.len()];
    for fold in 0..FOLDS {
        let views = table.views.iter().map(|v| scattered(v, &|n| n % FOLDS != fold)).collect();
        let fitted = method.fit(&Table::from_scattered(views)?)?;
        for (square, view) in squares.iter_mut().zip(&table.views) {
            let samples = view.samples.iter().skip(fold).step_by(FOLDS).copied().collect();
            let error =
                relative_l2(fitted.view(view.theta)?.as_ref(), &View { samples, ..view.clone() }, Norm::FCos);
            *square += error * error / FOLDS as f64;
        }
    }
    let mut left_out = Vec::new();
    for gone in 1..table.views.len().saturating_sub(1) {
        let mut rest = table.clone();
        let view = rest.views.remove(gone);
        let fitted = method.fit(&rest)?;
        let error = relative_l2(fitted.view(view.theta)?.as_ref(), &view, Norm::FCos);
        left_out.push((view.theta, error));
    }
    Ok(CrossValidation { folds: squares.into_iter().map(libm::sqrt).collect(), left_out })
}
