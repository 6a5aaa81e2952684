//! Which models a completion goes on with: the family by samples and views that were left out, then the best fits of it.

use super::held_out::HeldOut;
use super::kernel::Kernel;
use super::measurement::{Measured, Measurement};
use super::microfacet::{Family, Microfacet};
use super::points::{Point, each, points};
use super::process::{Of, Process, factor};
use super::scale::Scale;
use super::tuning::choice::OF_MODEL;
use super::{noises, width};
use crate::complete::tuning::family::{
    BESIDE, CLOSE, COMPARED, COMPARED_BESIDE, COMPARED_WITH_PROCESS, FOLDS, MODELS, OF_BESIDE, REFINEMENTS,
    SAME, WITHOUT_DOUBT, WORTHWHILE,
};
use rayon::prelude::*;

/// What models there are.
pub(super) struct Models {
    /// The best fit of the family without a process.
    pub alone: Microfacet,
    /// Those that go on.
    pub all: Vec<Microfacet>,
}

/// The models of the family that predicts left-out data best.
pub(super) fn models(measurement: &Measurement, scale: Scale) -> Models {
    let few = measurement.thinned(OF_MODEL);
    let compared = measurement.thinned(COMPARED);
    let with_process = measurement.thinned(COMPARED_WITH_PROCESS);
    let error = |model: &Microfacet, process: Option<(Kernel, f64)>| {
        let demanded = match model.family() {
            Family::OneLobe => 1.0,
            Family::Coat => 1.0 / WORTHWHILE,
            Family::Retro => 1.0 / WITHOUT_DOUBT,
        };
        let samples = if process.is_some() { &with_process } else { &compared };
        unseen(samples, scale, model, process).map_or(f64::INFINITY, |u| demanded * samples_and_views(&u))
    };
    let mut families: Vec<(f64, Vec<(f64, Microfacet)>)> = Family::ALL
        .iter()
        .map(|&family| {
            let fits = Microfacet::fits(&few, scale, family);
            (error(&fits[0].1, None), fits)
        })
        .collect();
    families.sort_by(|a, b| a.0.total_cmp(&b.0));
    // A second lobe has to be worth it by itself: beside a process it may follow noise that the process would smooth.
    let simplest = families.iter().position(|family| family.1[0].1.family() == Family::OneLobe);
    families.truncate(simplest.map_or(families.len(), |at| at + 1));
    // Those that come near to the best are compared with a process over each.
    let near = CLOSE * families[0].0;
    families.retain(|family| family.0 <= near);
    if families.len() > 1 {
        families.iter_mut().for_each(|family| family.0 = error(&family.1[0].1, Some(COMPARED_BESIDE)));
        families.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
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

/// A model fitted to the residual of the process.
fn beside(few: &Measurement, scale: Scale, mut model: Microfacet) -> Option<Microfacet> {
    for _ in 0..REFINEMENTS {
        let points = points(few, &model, scale, width(&model));
        let factor = factor(&points, BESIDE.0, &noises(&points, BESIDE.1), Of::Values)?;
        model = model.refined(few, scale, &factor);
    }
    Some(model)
}

fn samples_and_views(unseen: &[HeldOut; 2]) -> f64 {
    unseen.iter().map(HeldOut::rank).sum()
}

/// Whether a whole view was left out, and the distances of left-out points from their predictions.
type Gone = (bool, Vec<([f64; 3], Point)>);

/// Errors at samples, and at views, of which fits of a model did not know, nor a process over them if there is one; `None` where the
/// arithmetic of that ends. The views are all but the first and the last.
pub(super) fn unseen(
    measurement: &Measurement,
    scale: Scale,
    start: &Microfacet,
    process: Option<(Kernel, f64)>,
) -> Option<[HeldOut; 2]> {
    let by_samples = (0..FOLDS).map(|part| (part, false));
    let by_views = (1..measurement.parts.saturating_sub(1)).map(|part| (part, true));
    let parts: Vec<(usize, bool)> = by_samples.chain(by_views).collect();
    let left_out = |(part, is_view): (usize, bool)| {
        let is_out = |s: &Measured| if is_view { s.part == part } else { s.number % FOLDS == part };
        let rest = measurement.only(|s| !is_out(s));
        let model = start.fitted_to(&rest, scale);
        let gone = measurement.samples.iter().filter(|s| is_out(s)).copied().collect();
        let gone = each(&Measurement { samples: gone, ..*measurement }, &model, scale, width(&model));
        let Some((kernel, noise)) = process else {
            return Some((is_view, gone.into_iter().map(|p| (p.above, p)).collect()));
        };
        let points = points(&rest, &model, scale, width(&model));
        let process = Process::of_all(&points, kernel, &noises(&points, noise), Of::Values)?;
        let above = |p: &Point| {
            let said = process.at(&p.at);
            [0, 1, 2].map(|c| p.above[c] - said[c])
        };
        Some((is_view, gone.into_iter().map(|p| (above(&p), p)).collect()))
    };
    let found: Vec<Gone> = parts.into_par_iter().map(left_out).collect::<Option<_>>()?;
    Some([false, true].map(|is_view| {
        let of = found.iter().filter(|f| f.0 == is_view);
        let (above, gone): (Vec<[f64; 3]>, Vec<Point>) = of.flat_map(|f| f.1.iter().cloned()).unzip();
        HeldOut::new(&gone, &above, scale)
    }))
}
