//! Held-out error of scattered tables, for any method: the error where a fit had no data.

use crate::FitError;
use crate::judge::method::Method;
use crate::judge::norm::{Norm, relative, squares, values};
use crate::table::owners;
use crate::table::{Scattered, Table, View};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Errors of views whose samples were, in part or all, left out of the fit.
#[derive(Clone, Debug, PartialEq)]
pub struct CrossValidation {
    /// Each view's error over samples that were left out, a fifth at a time.
    pub folds: Vec<f64>,
    /// Each view's error when the whole view was left out; the first and the last view stay in. Angle, and error.
    pub left_out: Vec<(f64, f64)>,
}

impl CrossValidation {
    /// Mean over the views of the errors of samples left out, and of views left out; `None` where there are none.
    pub fn means(&self) -> [Option<f64>; 2] {
        let mean = |errors: Vec<f64>| {
            let bright: Vec<f64> = errors.into_iter().filter(|e| !e.is_nan()).collect();
            (!bright.is_empty()).then(|| bright.iter().sum::<f64>() / bright.len() as f64)
        };
        [mean(self.folds.clone()), mean(self.left_out.iter().map(|v| v.1).collect())]
    }

    pub(crate) fn to_json(&self) -> serde_json::Value {
        let [samples, views] = self.means();
        let left_out =
            |v: &(f64, f64)| serde_json::json!({"theta_degrees": v.0.to_degrees(), "relative_l2": v.1});
        serde_json::json!({
            "folds_of_samples": FOLDS,
            "mean_relative_l2_of_samples": samples,
            "relative_l2_of_samples": self.folds,
            "mean_relative_l2_of_views": views,
            "relative_l2_of_views": self.left_out.iter().map(left_out).collect::<Vec<_>>(),
        })
    }
}

const FOLDS: usize = 5;

/// The fold of every sample: of the directions of a view in the order of the file, every fifth. Samples of one direction share a
/// fold, so that the fit has no twin of a left-out direction. On an isotropic surface its mirror image counts as the same.
fn folds(view: &View) -> Vec<usize> {
    let mut directions = Vec::new();
    let owner = owners(&view.samples).owner;
    let mut number = vec![None; owner.len()];
    for &owner in &owner {
        number[owner].get_or_insert_with(|| {
            directions.push(owner);
            directions.len() - 1
        });
    }
    owner.iter().map(|&owner| number[owner].unwrap_or(0) % FOLDS).collect()
}

/// Fits a table without each fifth of its directions, and without each inner view, and judges the fits there.
///
/// The fifth is every fifth direction in the order of the file. Weights and albedo are made again from the rest. A table that is
/// black has no relative error: such folds are left out of a view's mean, and a view without any other has NaN. The fits run side by side;
/// `progress` is called with the share of them that has ended, 0 to 1.
///
/// # Errors
/// As [`Method::fit`]; [`FitError::Table`] for a view with fewer than five directions.
pub fn cross_validate(
    table: &Table,
    method: &dyn Method,
    progress: impl Fn(f64) + Sync,
) -> Result<CrossValidation, FitError> {
    let fold_of: Vec<Vec<usize>> = table.views.iter().map(folds).collect();
    if let Some((view, _)) = table.views.iter().zip(&fold_of).find(|(_, f)| !f.contains(&(FOLDS - 1))) {
        return Err(FitError::Table(format!(
            "view at {:.2} degrees: at least {FOLDS} directions are needed to leave some out",
            view.theta.to_degrees(),
        )));
    }
    let inner = 1..table.views.len().saturating_sub(1);
    let (done, count) = (AtomicUsize::new(0), FOLDS + inner.len());
    let ended = |errors: Result<Vec<f64>, FitError>| {
        progress((1 + done.fetch_add(1, Ordering::Relaxed)) as f64 / count as f64);
        errors
    };
    // The views first: there are more of them, and no fit waits for another at the end.
    let views = inner.clone().into_par_iter().map(|gone| ended(without_view(table, method, gone)));
    let folds = (0..FOLDS).into_par_iter().map(|fold| ended(without_fold(table, method, &fold_of, fold)));
    let errors = views.chain(folds).collect::<Result<Vec<_>, FitError>>()?;
    let (of_views, of_folds) = errors.split_at(inner.len());
    let left_out = inner.zip(of_views).map(|(gone, errors)| (table.views[gone].theta, errors[0]));
    let mean = |view: usize| {
        let known = of_folds.iter().map(|errors| errors[view]).filter(|error| !error.is_nan());
        let (sum, count) = known.fold((0.0, 0), |sum, error| (sum.0 + error * error, sum.1 + 1));
        libm::sqrt(sum / f64::from(count))
    };
    Ok(CrossValidation { folds: (0..table.views.len()).map(mean).collect(), left_out: left_out.collect() })
}

/// The error of each view over the directions of a fold, by a fit of the others.
fn without_fold(
    table: &Table,
    method: &dyn Method,
    fold_of: &[Vec<usize>],
    fold: usize,
) -> Result<Vec<f64>, FitError> {
    let scattered = |(view, fold_of): (&View, &Vec<usize>)| -> (f64, Scattered) {
        let kept = view.samples.iter().zip(fold_of).filter(|(_, f)| **f != fold);
        (view.theta, kept.map(|(s, _)| (s.direction, s.rgb)).collect())
    };
    let rest = Table::from_scattered(table.views.iter().zip(fold_of).map(scattered).collect())?;
    let fitted = method.fit(&rest)?;
    let error = |(view, fold_of): (&View, &Vec<usize>)| {
        let gone = view.samples.iter().zip(fold_of).filter(|(_, f)| **f == fold);
        let gone = View { samples: gone.map(|(s, _)| *s).collect(), ..*view };
        let values = values(fitted.view(view.theta)?.as_ref(), &gone);
        Ok(relative_or_nan(squares(&values, &gone, Norm::FCos)))
    };
    table.views.iter().zip(fold_of).map(error).collect()
}

/// The error of a view by a fit of the others.
fn without_view(table: &Table, method: &dyn Method, gone: usize) -> Result<Vec<f64>, FitError> {
    let mut rest = table.clone();
    let view = rest.views.remove(gone);
    let fitted = method.fit(&rest)?;
    let values = values(fitted.view(view.theta)?.as_ref(), &view);
    Ok(vec![relative_or_nan(squares(&values, &view, Norm::FCos))])
}

/// The relative error; NaN if the data are black.
fn relative_or_nan(squares: (f64, f64)) -> f64 {
    if squares.1 > 0.0 { relative(squares) } else { f64::NAN }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::direction;

    #[test]
    fn samples_of_one_direction_and_mirror_images_share_a_fold() {
        let mut scattered: Scattered = Vec::new();
        for n in 0..12 {
            let (theta, phi) = (0.1 * f64::from(n), 0.2 + 0.1 * f64::from(n));
            for _ in 0..1 + n % 2 {
                scattered.extend([phi, -phi].map(|phi| (direction(theta, phi), [0.1; 3])));
            }
        }
        let table = Table::from_scattered(vec![(0.3, scattered)]).unwrap();
        let found = folds(&table.views[0]);
        for (a, fold) in table.views[0].samples.iter().zip(&found) {
            for (b, other) in table.views[0].samples.iter().zip(&found) {
                let apart: f64 = (0..3).map(|k| (a.direction[k] - b.direction[k]).abs()).sum();
                assert!(apart > 1e-5 || fold == other, "{a:?} {b:?}: {fold} {other}");
            }
        }
        assert!((0..FOLDS).all(|fold| found.contains(&fold)), "{found:?}");
    }
}
