//! Fits of isotropic surfaces: to a BRDF, or to samples and their completion.

use crate::clock::Clock;
use crate::complete::{CompletionReport, Gaps};
use crate::isotropic::effort::{COMPLETED, Effort, MEASURED};
use crate::isotropic::resample::resampled;
use crate::isotropic::search::schedule::Resampling;
use crate::isotropic::search::{self, DrawnBy, Source};
use crate::isotropic::stored_views::Probes;
use crate::isotropic::tuning::source::{DENSE, HELD_OUT, LAST_VIEW, SAMPLED, SHARE, SHIFT};
use crate::judge::appearance::Appearance;
use crate::judge::fitted_material::view_angles as view_angles_of;
use crate::judge::report::ViewReport;
use crate::table::evaluation_views;
use crate::table::{Brdf, Density, Sample, Table, Tabulation, View};
use crate::{Fit, FitError, Settings};
use srbf_core::Material;

/// Golden section: its multiples are spread evenly, and never at the same places.
const GOLDEN_SECTION: f64 = 0.618_033_988_75;

/// Fits the lobes of the settings to a BRDF.
pub(crate) fn fit_evaluable(
    brdf: &dyn Brdf,
    settings: &Settings,
    progress: impl FnMut(f64) + Send,
) -> Result<Fit, FitError> {
    fit_both(brdf, None, settings, progress)
}

/// Fits the lobes of the settings to samples and their completion.
///
/// The report has the samples' own views, and as held out the completion between the stored views.
pub(crate) fn fit_samples(
    table: &Table,
    completion: &dyn Brdf,
    report: &CompletionReport,
    settings: &Settings,
    progress: impl FnMut(f64) + Send,
) -> Result<Fit, FitError> {
    let mut fit = fit_both(completion, Some(table), settings, progress)?;
    // Albedos are those of the completion: samples that miss a peak, or meet it once, have none that can be believed.
    let thetas: Vec<f64> = table.views.iter().map(|view| view.theta).collect();
    let whole = Table::from_brdf(completion, &thetas, Density::default())?;
    let reports = table.views.iter().zip(&whole.views).map(|(view, whole)| {
        // But for samples that say more than any surface reflects: the report tells.
        let is_cut = view.albedo != view.uncut_albedo;
        let (albedo, uncut_albedo) = (whole.albedo, if is_cut { view.uncut_albedo } else { whole.albedo });
        ViewReport::new(&fit.bytes, &View { albedo, uncut_albedo, ..view.clone() })
    });
    fit.report.views = reports.collect::<Result<_, _>>()?;
    fit.report.completion = Some(report.clone());
    fit.report.gaps = Some(report.gaps.clone());
    Ok(fit)
}

fn fit_both(
    brdf: &dyn Brdf,
    samples: Option<&Table>,
    settings: &Settings,
    progress: impl FnMut(f64) + Send,
) -> Result<Fit, FitError> {
    let start = Clock::start();
    let effort = if samples.is_some() { &COMPLETED } else { &MEASURED };
    let probes = Probes::new(brdf, LAST_VIEW.to_radians(), settings.view_count(), effort.grazing)?;
    let tabulation = Tabulation::new(brdf, effort.density);
    let source = Evaluable { samples, probes, effort, tabulation };
    let asked = settings;
    let settings = Settings {
        smoothness: DENSE * settings.smoothness,
        starts: settings.starts.div_ceil(effort.starts),
        exchanges: settings.exchanges.div_ceil(effort.exchanges),
        steps: settings.steps.div_ceil(effort.steps),
        ..settings.clone()
    };
    let mut fit = search::run(&source, &settings, asked, progress)?;
    fit.report.appearance = Some(Appearance::new(brdf, &Material::from_bytes(fit.bytes.as_slice())?)?);
    fit.report.gaps = Some(Gaps::of_table(brdf));
    let mut middles = evaluation_views::halfway(&view_angles_of(&Material::from_bytes(&fit.bytes)?));
    middles.retain(|theta| *theta < LAST_VIEW.to_radians());
    if !middles.is_empty() {
        let held_out = Table::from_brdf(brdf, &middles, HELD_OUT)?;
        let reports = held_out.views.iter().map(|view| ViewReport::new(&fit.bytes, view));
        fit.report.held_out = reports.collect::<Result<_, _>>()?;
    }
    fit.report.seconds = start.seconds();
    Ok(fit)
}

/// A BRDF with the samples that it completes, if any.
struct Evaluable<'a> {
    /// The samples, if the BRDF is their completion.
    samples: Option<&'a Table>,
    probes: Probes,
    effort: &'static Effort,
    tabulation: Tabulation<'a>,
}

impl Evaluable<'_> {
    /// Adds the samples to the views of a table that have samples.
    fn with_samples(&self, table: &mut Table) {
        for view in &mut table.views {
            let own = self.samples.iter().flat_map(|s| &s.views).find(|own| own.theta == view.theta);
            let Some(own) = own else { continue };
            view.samples.iter_mut().for_each(|s| s.weight *= 1.0 - SHARE);
            view.samples.extend(own.samples.iter().map(|s| Sample { weight: SHARE * s.weight, ..*s }));
        }
    }

    /// Angles of the samples' views.
    fn sampled(&self, end: f64) -> impl Iterator<Item = f64> {
        let views = self.samples.iter().flat_map(|s| &s.views);
        let every = self.samples.map_or(1, |s| s.views.len().div_ceil(SAMPLED));
        views.step_by(every).map(|v| v.theta).filter(move |theta| *theta <= end)
    }
}

impl Source for Evaluable<'_> {
    fn effort(&self) -> &Effort {
        self.effort
    }

    fn view_angles(&self, count: usize) -> Vec<f64> {
        self.probes.place(count)
    }

    fn next_to_normal(&self) -> Option<f64> {
        self.probes.next_to_normal()
    }

    fn albedo(&self) -> &[(f64, [f64; 3])] {
        &self.probes.albedo
    }

    fn table(&self, view_angles: &[f64], drawn: Option<DrawnBy<'_>>) -> Result<Table, FitError> {
        let end = view_angles[view_angles.len() - 1].min(LAST_VIEW.to_radians());
        let between = self.effort.views_between;
        let resampling = drawn.map(|drawn| drawn.resampling);
        let thetas: Vec<f64> =
            tabulated(view_angles, end, resampling, between).into_iter().chain(self.sampled(end)).collect();
        let mut table = match drawn {
            None => self.tabulation.table(&thetas, &|_| Ok(None))?,
            Some(DrawnBy { bytes, resampling }) => {
                resampled(&self.tabulation, &thetas, bytes, resampling.number())?
            }
        };
        self.with_samples(&mut table);
        Ok(table)
    }
}

/// Angles of the table's views: the end, and irregular places in every interval, so that an error between stored views is met wherever it
/// lies. Every resampling has other places. The last one has the stored views too.
fn tabulated(view_angles: &[f64], end: f64, resampling: Option<Resampling>, between: usize) -> Vec<f64> {
    let shift = SHIFT * resampling.map_or(0, |resampling| 1 + resampling.number()) as f64;
    let mut thetas = vec![end];
    for (n, w) in view_angles.windows(2).enumerate() {
        for i in 0..between {
            let irregular = (GOLDEN_SECTION * (between * n + i) as f64 + shift).fract();
            let place =
                if i == 0 && resampling == Some(Resampling::Last) { 0.0 } else { i as f64 + irregular };
            thetas.push(w[0] + (w[1] - w[0]) * place / between as f64);
        }
    }
    thetas.retain(|&theta| theta <= end);
    thetas
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_table_that_is_fitted_has_views_at_the_stored_views() {
        let view_angles = [0.0, 0.3, 0.5, 1.1];
        let between = MEASURED.views_between;
        let resamplings = [Resampling::First, Resampling::Second, Resampling::Last, Resampling::Judging];
        for resampling in resamplings.map(Some) {
            let thetas = tabulated(&view_angles, 1.1, resampling, between);
            let at_stored = view_angles.iter().filter(|stored| thetas.contains(stored)).count();
            let (all, end_alone) = (view_angles.len(), 1);
            let expected = if resampling == Some(Resampling::Last) { all } else { end_alone };
            assert_eq!(at_stored, expected, "{resampling:?}: {thetas:?}");
            let inside = |w: &[f64]| thetas.iter().filter(|t| **t > w[0] && **t < w[1]).count();
            assert!(view_angles.windows(2).all(|w| inside(w) >= between - 1), "{resampling:?}: {thetas:?}");
        }
    }
}
