//! Fits of isotropic surfaces: to a BRDF that can be evaluated anywhere, or to what samples are completed to, beside the samples.

use crate::complete::Completion;
use crate::isotropic::effort::{COMPLETED, Effort, MEASURED};
use crate::isotropic::knots::Probes;
use crate::isotropic::search::schedule::LOOKS;
use crate::isotropic::search::{self, Source};
use crate::isotropic::seen_by::seen_by;
use crate::judge::appearance::Appearance;
use crate::judge::fitted_material::knots as knots_of;
use crate::judge::report::ViewReport;
use crate::table::evaluation_views;
use crate::table::{Brdf, Density, Sample, Table, View};
use crate::{Fit, FitError, Settings};
use srbf_core::Material;
use std::time::Instant;

/// Angle of the last view of a BRDF that can be evaluated, degrees.
const LAST_KNOT: f64 = 87.0;

/// Smoothness over that of the settings: with views between all knots less of it is needed (alum-bronze 3.9 % at unseen
/// views in place of 4.4 %).
const DENSE: f64 = 0.4;

/// Share of the samples themselves in the weight of their views, and most of those views.
const SHARE: f64 = 0.8;
const SAMPLED: usize = 16;

/// Golden section: its multiples are spread evenly, and never at the same places.
const GOLDEN_SECTION: f64 = 0.618_033_988_75;

/// Shift of those places from round to round.
const SHIFT: f64 = 0.381_966;

/// Directions of a held-out view.
const HELD_OUT: Density = Density { hemisphere: 1000, cap: 300 };

/// Fits as many lobes as the settings say to what can be evaluated.
pub(crate) fn fit_evaluable(
    brdf: &dyn Brdf,
    settings: &Settings,
    progress: impl FnMut(f64) + Send,
) -> Result<Fit, FitError> {
    fit_both(brdf, None, settings, progress)
}

/// Fits as many lobes as the settings say to samples: to what they are completed to, and to themselves.
///
/// The report has the samples' own views, and as held out the completion between the knots.
pub(crate) fn fit_samples(
    table: &Table,
    completion: &Completion,
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
    fit.report.completion = Some(completion.report.clone());
    Ok(fit)
}

fn fit_both(
    brdf: &dyn Brdf,
    samples: Option<&Table>,
    settings: &Settings,
    progress: impl FnMut(f64) + Send,
) -> Result<Fit, FitError> {
    let start = Instant::now();
    let probes = Probes::new(brdf, LAST_KNOT.to_radians(), settings.view_count())?;
    let effort = if samples.is_some() { &COMPLETED } else { &MEASURED };
    let source = Evaluable { brdf, samples, probes, effort };
    let settings = Settings {
        smoothness: DENSE * settings.smoothness,
        starts: settings.starts.div_ceil(effort.starts),
        exchanges: settings.exchanges.div_ceil(effort.exchanges),
        steps: settings.steps.div_ceil(effort.steps),
        ..settings.clone()
    };
    let mut fit = search::run(&source, &settings, progress)?;
    fit.report.appearance = Some(Appearance::new(brdf, &Material::from_bytes(fit.bytes.as_slice())?)?);
    let mut middles = evaluation_views::halfway(&knots_of(&Material::from_bytes(&fit.bytes)?));
    middles.retain(|theta| *theta < LAST_KNOT.to_radians());
    if !middles.is_empty() {
        let held_out = Table::from_brdf(brdf, &middles, HELD_OUT)?;
        let reports = held_out.views.iter().map(|view| ViewReport::new(&fit.bytes, view));
        fit.report.held_out = reports.collect::<Result<_, _>>()?;
    }
    fit.report.seconds = start.elapsed().as_secs_f64();
    Ok(fit)
}

/// What can be evaluated, as the fit sees it.
struct Evaluable<'a> {
    brdf: &'a dyn Brdf,
    /// What it was made of, if it was.
    samples: Option<&'a Table>,
    probes: Probes,
    effort: &'static Effort,
}

impl Evaluable<'_> {
    /// The views of the samples, with the samples beside what a table has there.
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

    fn knots(&self, count: usize) -> Vec<f64> {
        self.probes.place(count)
    }

    fn albedo(&self) -> &[(f64, [f64; 3])] {
        &self.probes.albedo
    }

    fn table(&self, knots: &[f64], seen: Option<(&[u8], usize)>) -> Result<Table, FitError> {
        let end = knots[knots.len() - 1].min(LAST_KNOT.to_radians());
        let (density, between) = (self.effort.density, self.effort.views_between);
        let thetas = |round| {
            tabulated(knots, end, round, between).into_iter().chain(self.sampled(end)).collect::<Vec<_>>()
        };
        let mut table = match seen {
            None => Table::from_brdf(self.brdf, &thetas(0), density)?,
            Some((bytes, round)) => seen_by(self.brdf, &thetas(1 + round), density, bytes, round)?,
        };
        self.with_samples(&mut table);
        Ok(table)
    }
}

/// Angles of the table's views: at irregular places in every interval, so that what a lobe does between knots is seen
/// wherever it happens, other ones in every round, and at the end. In the last round also at the knots: a lobe that is there at a
/// single knot is highest there.
fn tabulated(knots: &[f64], end: f64, round: usize, between: usize) -> Vec<f64> {
    let mut thetas = vec![end];
    for (n, w) in knots.windows(2).enumerate() {
        for i in 0..between {
            let irregular = (GOLDEN_SECTION * (between * n + i) as f64 + SHIFT * round as f64).fract();
            let place = if i == 0 && round == LOOKS { 0.0 } else { i as f64 + irregular };
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
    fn the_last_table_that_is_fitted_has_views_at_the_knots() {
        let knots = [0.0, 0.3, 0.5, 1.1];
        let between = MEASURED.views_between;
        for round in 1..=LOOKS + 1 {
            let thetas = tabulated(&knots, 1.1, round, between);
            let at_knots = knots.iter().filter(|knot| thetas.contains(knot)).count();
            let (all, end_alone) = (knots.len(), 1);
            assert_eq!(at_knots, if round == LOOKS { all } else { end_alone }, "{round}: {thetas:?}");
            let inside = |w: &[f64]| thetas.iter().filter(|t| **t > w[0] && **t < w[1]).count();
            assert!(knots.windows(2).all(|w| inside(w) >= between - 1), "{round}: {thetas:?}");
        }
    }
}
