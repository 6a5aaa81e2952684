//! One method on one table, with everything that a row of the thesis's Table 5.1 says, judged the same way for each.

use crate::FitError;
use crate::clock::Clock;
use crate::judge::cross::{CrossValidation, cross_validate};
use crate::judge::method::Method;
use crate::judge::norm::{Norm, relative, squares, values};
use crate::table::{Table, View};

/// The fit of a table by a method.
#[derive(Clone, Debug, PartialEq)]
pub struct Score {
    /// Mean over the views that are not black of the relative L2 error of `f cos`.
    pub mean: f64,
    /// The same of f alone.
    pub mean_of_f: f64,
    /// Relative L2 error of `f cos` over all views as one.
    pub whole: f64,
    /// Time of the fit.
    pub seconds: f64,
    /// Held-out errors, if they were asked for.
    pub held_out: Option<CrossValidation>,
}

/// Fits a table by a method and judges the fit; with `cross`, by left-out samples too.
///
/// # Errors
/// As [`Method::fit`] and [`cross_validate`].
pub fn score(table: &Table, method: &dyn Method, cross: bool) -> Result<Score, FitError> {
    let start = Clock::start();
    let fitted = method.fit(table)?;
    let seconds = start.seconds();
    let mut score = Score { mean: 0.0, mean_of_f: 0.0, whole: 0.0, seconds, held_out: None };
    let (mut difference, mut data) = (0.0, 0.0);
    let is_bright = |view: &&View| view.samples.iter().any(|s| s.rgb.iter().any(|v| *v > 0.0));
    let bright = table.views.iter().filter(is_bright).count();
    for view in &table.views {
        let fitted = fitted.view(view.theta)?;
        let values = values(fitted.as_ref(), view);
        let [f_cos, f] = [Norm::FCos, Norm::F].map(|norm| squares(&values, view, norm));
        difference += f_cos.0;
        data += f_cos.1;
        if f_cos.1 > 0.0 {
            score.mean += relative(f_cos) / bright as f64;
            score.mean_of_f += relative(f) / bright as f64;
        }
    }
    score.whole = relative((difference, data));
    if cross {
        score.held_out = Some(cross_validate(table, method, |_| {})?);
    }
    Ok(score)
}
