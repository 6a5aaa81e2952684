//! The entry of every fit: samples are completed to a BRDF that can be evaluated anywhere, then lobes are fitted to that.
//!
//! May import: `anisotropic`, `clock`, `fewest_lobes`, `isotropic`, `judge`, `settings`.

use crate::anisotropic;
use crate::clock::rising;
use crate::complete::complete;
use crate::fewest_lobes::fewest_lobes;
use crate::isotropic;
use crate::judge::method::{Fitted, Method};
use crate::judge::report::Fit;
use crate::judge::spectral::{SpectralReport, with_map};
use crate::look::Look;
use crate::read::{Content, Source, check_memory};
use crate::table::{Brdf, Symmetry, Table, or_black};
use crate::{FitError, Settings};
use srbf_core::Material;

/// An allowance for the memory that a fit takes beside its table, bytes, and for each sample. An allocation that fails within the fit
/// ends the process, so that as much is looked for before.
const MEMORY: u64 = 400_000_000;
const OF_SAMPLE: u64 = 400;

/// Fits lobes to a measurement: to a BRDF that can be evaluated anywhere, or to samples.
///
/// Samples are first completed: a microfacet model and a smooth residual make them a BRDF that can be evaluated anywhere
/// ([`complete`](crate::complete)). The fit sees both, the samples with four fifths of the weight of their views.
///
/// The material's views are placed where it changes, up to 87 degrees, unless the settings name them. The views of the table lie
/// between them. The report has the samples' own views, or those of the table, and held-out views in the middle of every interval.
///
/// A BRDF that is nowhere above 0 is black, and is fitted at f of 1e-9 / sr.
///
/// The number of lobes is that of the settings, or the fewest that reach the error that they ask for. `progress` is called with the
/// share of the work that is done, 0 to 1, by one thread of the fit at a time. It never falls: where a fit misses a goal and goes on, the
/// rest of the shares is for the rest of the work.
///
/// # Errors
/// [`FitError::Setting`] for a setting out of its range, and for one that the fit of an anisotropic surface would ignore;
/// [`FitError::Table`] for a table that has too few samples; [`FitError::Memory`] where so much
/// is not there. [`FitError::Format`] never for a table with finite numbers.
pub fn fit_content(
    content: &Content,
    settings: &Settings,
    progress: impl FnMut(f64) + Send,
) -> Result<Fit, FitError> {
    match content {
        Content::Samples(table) => fit(table, settings, progress),
        Content::Evaluable(brdf) => {
            check_memory(MEMORY).map_err(FitError::Memory)?;
            let brdf = or_black(brdf.as_ref());
            with_lobes(settings, progress, |settings, progress| fit_brdf(brdf, settings, progress))
        }
    }
}

/// [`fit_content`] of a measurement that was read, with the facts of its samples beyond their colours: findings about them, and the
/// map from colours to spectra, which the material keeps.
///
/// # Errors
/// As [`fit_content`].
pub fn fit_source(
    source: &Source,
    settings: &Settings,
    progress: impl FnMut(f64) + Send,
) -> Result<Fit, FitError> {
    let intake = source.intake.as_ref();
    let mut fit = match (&source.content, intake, &source.completion) {
        (Content::Evaluable(brdf), Some(intake), _) if brdf.symmetry() != Symmetry::Isotropic => {
            check_memory(MEMORY + OF_SAMPLE * intake.rows.len() as u64).map_err(FitError::Memory)?;
            settings.check_anisotropic()?;
            with_lobes(settings, progress, |settings, progress| {
                anisotropic::fit_samples(
                    brdf.as_ref(),
                    &intake.rows,
                    intake.is_light_fixed,
                    settings,
                    progress,
                )
            })?
        }
        (Content::Evaluable(brdf), Some(intake), Some(report)) => {
            check_memory(MEMORY + OF_SAMPLE * intake.rows.len() as u64).map_err(FitError::Memory)?;
            let table = Table::from_scattered(intake.without(&report.outliers).views())?;
            with_lobes(settings, progress, |settings, progress| {
                isotropic::fit_samples(&table, brdf.as_ref(), report, settings, progress)
            })?
        }
        (content, ..) => fit_content(content, settings, progress)?,
    };
    if let Some(completion) = &source.completion {
        fit.report.gaps = Some(completion.gaps.clone());
        fit.report.completion = Some(completion.clone());
    }
    fit.report.look = intake.map(|intake| Look::new(intake, fit.report.completion.as_ref()));
    fit.report.mark_contradicted();
    if let Some(spectra) = source.spectra() {
        fit.bytes = with_map(&fit.bytes, &spectra.to_map()?)?;
        let material = Material::from_bytes(fit.bytes.as_slice())?;
        let is_light_fixed = intake.is_some_and(|intake| intake.is_light_fixed);
        fit.report.spectra = Some(SpectralReport::new(spectra, is_light_fixed, &material)?);
    }
    Ok(fit)
}

/// Fits lobes to the samples of a table; as [`fit_content`].
///
/// # Errors
/// As [`fit_content`].
pub fn fit(table: &Table, settings: &Settings, progress: impl FnMut(f64) + Send) -> Result<Fit, FitError> {
    // Before the completion, which takes seconds.
    settings.check()?;
    let samples: usize = table.views.iter().map(|view| view.samples.len()).sum();
    check_memory(MEMORY + OF_SAMPLE * samples as u64).map_err(FitError::Memory)?;
    let completion = complete(table)?;
    let table = completion.without_outliers(table)?;
    with_lobes(settings, progress, |settings, progress| {
        isotropic::fit_samples(&table, &completion, &completion.report, settings, progress)
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
        Some(error) => fewest_lobes(settings, error, progress, fit),
        None => {
            let found = fit(settings, &mut rising(&mut progress))?;
            progress(1.0);
            Ok(found)
        }
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
        settings.check_anisotropic()?;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read::read;

    /// A brushed metal in the dark.
    struct Dark;

    impl Brdf for Dark {
        fn evaluate(&self, _: [f64; 3], _: [f64; 3]) -> [f64; 3] {
            [0.0, -1e-6, 0.0]
        }
        fn symmetry(&self) -> Symmetry {
            Symmetry::None
        }
    }

    #[test]
    fn black_is_fitted_through_every_door() {
        let few =
            Settings { lobes: 1, starts: 1, steps: 2, exchanges: 0, views: Some(2), ..Settings::default() };
        let directions =
            [[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [-0.6, 0.0, 0.8], [0.0, 0.6, 0.8], [0.0, -0.8, 0.6]];
        let table = Table::from_scattered(vec![(0.3, directions.map(|d| (d, [0.0; 3])).to_vec())]).unwrap();
        let model = |name: &str| read(name.as_ref()).unwrap().content;
        for content in [
            model("model:lambert:albedo=0"),
            model("model:phong:diffuse=0,specular=0,exponent=50"),
            Content::Evaluable(Box::new(Dark)),
            Content::Samples(table),
        ] {
            let fit = fit_content(&content, &few, |_| {}).unwrap();
            let material = Material::from_bytes(fit.bytes.as_slice()).unwrap();
            let mut mixture = srbf_core::Mixture::<16>::empty();
            material.prepare([-0.6, 0.0, 0.8], &mut mixture).unwrap();
            let value = mixture.evaluate([0.6, 0.0, 0.8]);
            assert!(value.x >= 0.0 && value.x < 1e-6, "{value}");
            let views = &fit.report.views;
            assert!(views.iter().all(|view| view.error < 0.2), "{views:?}");
        }
    }
}
