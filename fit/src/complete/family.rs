//! Which models a completion goes on with: the family by samples and views that were left out, then the best fits of it.

use super::held_out::HeldOut;
use super::measurement::{Measured, Measurement};
use super::microfacet::{Family, Microfacet};
use super::points::{Point, each, grouped, points};
use super::process::{Kernel, Process, factor};
use super::scale::Scale;
use super::{KERNELS, OF_MODEL, noises, width};
use rayon::prelude::*;

/// Models whose widths and exponents are this close are one.
const SAME: f64 = 0.1;

/// Most models that go on, each as it is and fitted to what the process leaves over.
const MODELS: usize = 2;

/// Samples that families are compared by.
const COMPARED: usize = 1500;

/// Samples are left out in so many parts.
const FOLDS: usize = 5;

/// Share of the error of the simplest family that one with a second lobe has to be below.
const WORTHWHILE: f64 = 0.97;

/// What the model is fitted beside, and samples.
const BESIDE: (Kernel, f64) = (KERNELS[3], 3e-3);
const OF_BESIDE: usize = 1500;
const REFINEMENTS: usize = 2;

/// What models there are.
pub(super) struct Models {
    /// The best fit of the family without a process.
    pub alone: Microfacet,
    /// Those that go on.
    pub all: Vec<Microfacet>,
}

/// The models of the family that is best at what it was not fitted to.
pub(super) fn models(measurement: &Measurement, scale: Scale) -> Models {
    let few = measurement.thinned(OF_MODEL);
    let compared = measurement.thinned(COMPARED);
    let mut families: Vec<(f64, Vec<(f64, Microfacet)>)> = Family::ALL
        .iter()
        .map(|&family| {
            let fits = Microfacet::fits(&few, scale, family);
            let error = unseen(&compared, scale, &fits[0].1);
            let error = samples_and_views(&error);
            (if family == Family::OneLobe { WORTHWHILE * error } else { error }, fits)
        })
        .collect();
    families.sort_by(|a, b| a.0.total_cmp(&b.0));
    let fits = families.swap_remove(0).1;
    let alone = fits[0].1;
    let mut all: Vec<Microfacet> = Vec::new();
    for (_, model) in fits {
        let close = |a: f64, b: f64| (a / b - 1.0).abs() < SAME;
        let is_new = |other: &Microfacet| {
            !(close(model.width(), other.width()) && close(model.exponent(), other.exponent()))
        };
        // Of two lobes there is one place that is best.
        let most = if model.family() == Family::OneLobe { MODELS } else { 1 };
        if all.len() < most && all.iter().all(is_new) {
            all.push(model);
        }
    }
    let few = measurement.thinned(OF_BESIDE);
    let beside: Vec<Microfacet> = all.par_iter().filter_map(|model| beside(&few, scale, *model)).collect();
    all.extend(beside);
    Models { alone, all }
}

/// A model fitted to what the process leaves over.
fn beside(few: &Measurement, scale: Scale, mut model: Microfacet) -> Option<Microfacet> {
    for _ in 0..REFINEMENTS {
        let points = points(few, &model, scale, width(&model));
        let factor = factor(&points, BESIDE.0, &noises(&points, BESIDE.1))?;
        model = model.refined(few, scale, &factor);
    }
    Some(model)
}

fn samples_and_views(unseen: &[HeldOut; 2]) -> f64 {
    unseen.iter().map(HeldOut::rank).sum()
}

/// Errors of a family of models at samples, and at views, that fits did not see.
pub(super) fn unseen(measurement: &Measurement, scale: Scale, start: &Microfacet) -> [HeldOut; 2] {
    let wide = measurement.views;
    let by_samples = (0..FOLDS).map(|part| (part, false));
    let by_views = (1..wide.saturating_sub(1)).map(|view| (view, true));
    let parts: Vec<(usize, bool)> = by_samples.chain(by_views).collect();
    let found: Vec<(bool, Vec<Point>)> = parts
        .into_par_iter()
        .map(|(part, is_view)| {
            let is_out = |s: &Measured| if is_view { s.view == part } else { s.number % FOLDS == part };
            let model = start.fitted_to(&measurement.only(|s| !is_out(s)), scale);
            let gone = Measurement {
                samples: measurement.samples.iter().filter(|s| is_out(s)).copied().collect(),
                ..*measurement
            };
            (is_view, each(&gone, &model, scale, width(&model)))
        })
        .collect();
    [false, true].map(|is_view| {
        let of = found.iter().filter(|f| f.0 == is_view);
        let gone: Vec<Point> = of.flat_map(|f| &f.1).cloned().collect();
        let above: Vec<[f64; 3]> = gone.iter().map(|p| p.above).collect();
        HeldOut::new(&gone, &above, scale)
    })
}

/// Errors of a completion at views that neither its model nor its process saw; `None` where there are fewer than three views, or the
/// arithmetic ends.
pub(super) fn unseen_views(
    measurement: &Measurement,
    scale: Scale,
    start: &Microfacet,
    (kernel, noise): (Kernel, f64),
) -> Option<HeldOut> {
    let parts: Vec<usize> = (1..measurement.views.saturating_sub(1)).collect();
    let found: Option<Vec<Vec<(Point, [f64; 3])>>> = parts
        .into_par_iter()
        .map(|view| {
            let rest = measurement.only(|s| s.view != view);
            let model = start.fitted_to(&rest, scale);
            let (points, _) = grouped(each(&rest, &model, scale, width(&model)));
            let process = Process::new(&points, kernel, &noises(&points, noise))?;
            let gone = Measurement {
                samples: measurement.samples.iter().filter(|s| s.view == view).copied().collect(),
                ..*measurement
            };
            let gone = each(&gone, &model, scale, width(&model)).into_iter().map(|p| {
                let said = process.at(&p.at);
                let left = [0, 1, 2].map(|c| p.above[c] - said[c]);
                (p, left)
            });
            Some(gone.collect())
        })
        .collect();
    let (gone, above): (Vec<Point>, Vec<[f64; 3]>) = found?.into_iter().flatten().unzip();
    (!gone.is_empty()).then(|| HeldOut::new(&gone, &above, scale))
}
