//! The one entry: fits to what a file holds, samples as they are, or a table made of what can be evaluated anywhere.

use crate::anisotropic;
use crate::complete::complete;
use crate::fewest_lobes::fewest_lobes;
use crate::isotropic;
use crate::judge::method::{Fitted, Method};
use crate::judge::report::Fit;
use crate::read::Content;
use crate::table::{Brdf, Symmetry, Table};
use crate::{FitError, Settings};
use srbf_core::Material;

/// Fits lobes to a measurement: to its samples, or to a table of what can be evaluated.
///
/// In the second case the material's views are placed where it changes, up to 87 degrees (unless the settings name
/// them), the views of the table lie between them, and the report has held-out views in the middle of every interval.
/// As many lobes as the settings say, or as few as reach the error that they ask for. `progress` is called with
/// the share of the work that is done, 0 to 1, by one thread of the fit at a time; it falls where a goal is missed by what should
/// have been the end.
///
/// # Errors
/// [`FitError::Setting`], [`FitError::Table`]; [`FitError::Format`] never for a table with finite numbers.
pub fn fit_content(
    content: &Content,
    settings: &Settings,
    progress: impl FnMut(f64) + Send,
) -> Result<Fit, FitError> {
    match content {
        Content::Samples(table) => fit(table, settings, progress),
        Content::Evaluable(brdf) => {
            with_lobes(settings, progress, |settings, progress| fit_brdf(brdf.as_ref(), settings, progress))
        }
    }
}

/// Fits lobes to the samples of a table; as [`fit_content`].
///
/// # Errors
/// As [`fit_content`].
pub fn fit(table: &Table, settings: &Settings, progress: impl FnMut(f64) + Send) -> Result<Fit, FitError> {
    settings.check()?;
    let completion = complete(table)?;
    with_lobes(settings, progress, |settings, progress| {
        isotropic::fit_samples(table, &completion, settings, progress)
    })
}

/// Checks the settings, and fits with the lobes that they say, or as few as reach the error that they ask for.
fn with_lobes(
    settings: &Settings,
    mut progress: impl FnMut(f64) + Send,
    fit: impl Fn(&Settings, &mut (dyn FnMut(f64) + Send)) -> Result<Fit, FitError>,
) -> Result<Fit, FitError> {
    settings.check()?;
    match settings.error {
        Some(error) => fewest_lobes(settings, error, progress, |settings| fit(settings, &mut |_| {})),
        None => fit(settings, &mut progress),
    }
}

fn fit_brdf(
    brdf: &dyn Brdf,
    settings: &Settings,
    progress: &mut (dyn FnMut(f64) + Send),
) -> Result<Fit, FitError> {
    if brdf.symmetry() == Symmetry::Isotropic {
        isotropic::fit_evaluable(brdf, settings, progress)
    } else {
        anisotropic::fit_brdf(brdf, settings, progress)
    }
}

/// Our method with its settings.
pub struct Tracked<'a>(pub &'a Settings);

impl Method for Tracked<'_> {
    fn fit(&self, table: &Table) -> Result<Box<dyn Fitted>, FitError> {
        Ok(Box::new(Material::from_bytes(fit(table, self.0, |_| {})?.bytes)?))
    }
}
