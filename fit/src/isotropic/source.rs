//! Fits to what a file holds: samples as they are, or a table made of what can be evaluated anywhere.

use crate::isotropic::knots::Probes;
use crate::isotropic::search::schedule::LOOKS;
use crate::isotropic::search::{self, Data, Source};
use crate::isotropic::seen_by::seen_by;
use crate::judge::fitted_material::knots as knots_of;
use crate::judge::report::ViewReport;
use crate::table::evaluation_views;
use crate::table::{Brdf, Density, Table};
use crate::{Fit, FitError, Settings};
use std::time::Instant;

/// Angle of the last view of a BRDF that can be evaluated, degrees.
const LAST_KNOT: f64 = 87.0;

/// Views of the table between two of the material's.
const BETWEEN: usize = 3;

/// Smoothness over that of the settings: with views between all knots less of it is needed (alum-bronze 3.9 % at unseen
/// views in place of 4.4 %).
const DENSE: f64 = 0.4;

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
    progress: impl FnMut(f64),
) -> Result<Fit, FitError> {
    let start = Instant::now();
    let source =
        Evaluable { brdf, probes: Probes::new(brdf, LAST_KNOT.to_radians(), settings.view_count())? };
    let settings = Settings { smoothness: DENSE * settings.smoothness, ..settings.clone() };
    let mut fit = search::run(Data::Source(&source), &settings, progress)?;
    let mut middles = evaluation_views::halfway(&knots_of(&fit.bytes)?);
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
    probes: Probes,
}

impl Source for Evaluable<'_> {
    fn knots(&self, count: usize) -> Vec<f64> {
        self.probes.place(count)
    }

    fn albedo(&self) -> &[(f64, [f64; 3])] {
        &self.probes.albedo
    }

    fn table(&self, knots: &[f64], seen: Option<(&[u8], usize)>) -> Result<Table, FitError> {
        let end = knots[knots.len() - 1].min(LAST_KNOT.to_radians());
        match seen {
            None => Table::from_brdf(self.brdf, &tabulated(knots, end, 0), Density::default()),
            Some((bytes, round)) => {
                let thetas = tabulated(knots, end, 1 + round);
                seen_by(self.brdf, &thetas, Density::default(), bytes, round)
            }
        }
    }
}

/// Angles of the table's views: at irregular places in every interval, so that what a lobe does between knots is seen
/// wherever it happens, other ones in every round, and at the end. In the last round also at the knots: a lobe that is there at a
/// single knot is highest there.
fn tabulated(knots: &[f64], end: f64, round: usize) -> Vec<f64> {
    let mut thetas = vec![end];
    for (n, w) in knots.windows(2).enumerate() {
        for i in 0..BETWEEN {
            let irregular = (GOLDEN_SECTION * (BETWEEN * n + i) as f64 + SHIFT * round as f64).fract();
            let place = if i == 0 && round == LOOKS { 0.0 } else { i as f64 + irregular };
            thetas.push(w[0] + (w[1] - w[0]) * place / BETWEEN as f64);
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
        for round in 1..=LOOKS + 1 {
            let thetas = tabulated(&knots, 1.1, round);
            let at_knots = knots.iter().filter(|knot| thetas.contains(knot)).count();
            let (all, end_alone) = (knots.len(), 1);
            assert_eq!(at_knots, if round == LOOKS { all } else { end_alone }, "{round}: {thetas:?}");
            let inside = |w: &[f64]| thetas.iter().filter(|t| **t > w[0] && **t < w[1]).count();
            assert!(knots.windows(2).all(|w| inside(w) >= BETWEEN - 1), "{round}: {thetas:?}");
        }
    }
}
