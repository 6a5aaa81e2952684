//! How many lobes: the fewest that reach an error.

use crate::clock::{Clock, rising};
use crate::judge::report::mean_error;
use crate::{Fit, FitError, Settings};

/// Fits with ever more lobes until the error of the settings is reached, then with fewer, as long as it is.
///
/// What counts is the mean relative L2 error over the views, or over the held-out ones if that is larger. It is taken to fall with the
/// number of lobes; where it does not, a number that reaches the error is found, if not the smallest. Time and evaluations in the
/// report are those of all fits.
///
/// # Errors
/// [`FitError::Setting`] with the error that is reached if the most lobes allowed do not reach it; otherwise as `fit`.
pub(crate) fn fewest_lobes(
    settings: &Settings,
    error: f64,
    mut progress: impl FnMut(f64) + Send,
    fit: impl Fn(&Settings, &mut (dyn FnMut(f64) + Send)) -> Result<Fit, FitError>,
) -> Result<Fit, FitError> {
    let most = settings.lobes;
    // Doublings, then halvings of the interval.
    let rounds = 2.0 * (1.0 + libm::log2(most as f64));
    let mut done = 0.0;
    let (start, mut evaluations) = (Clock::start(), 0);
    let mut with = |lobes: usize| {
        let settings = Settings { error: None, ..settings.with_lobes(lobes) };
        let found = fit(&settings, &mut rising(|share| progress(((done + share) / rounds).min(1.0))))?;
        done += 1.0;
        evaluations += found.report.evaluations;
        let reached = found.report.mean_error().max(mean_error(&found.report.held_out));
        Ok::<_, FitError>((found, reached))
    };
    let (mut too_few, mut lobes) = (0, 1);
    let mut best = loop {
        let (found, reached) = with(lobes)?;
        if reached <= error {
            break found;
        }
        if lobes == most {
            return Err(FitError::Setting {
                name: "error",
                reason: format!("{most} lobes reach {:.3} %, not {:.3} %", 100.0 * reached, 100.0 * error),
            });
        }
        too_few = lobes;
        lobes = (2 * lobes).min(most);
    };
    let mut enough = lobes;
    while enough - too_few > 1 {
        let middle = too_few + (enough - too_few) / 2;
        let (found, reached) = with(middle)?;
        if reached <= error {
            (best, enough) = (found, middle);
        } else {
            too_few = middle;
        }
    }
    progress(1.0);
    best.report.seconds = start.seconds();
    best.report.evaluations = evaluations;
    Ok(best)
}
