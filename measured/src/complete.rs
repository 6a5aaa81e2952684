//! Scattered samples made a BRDF that can be evaluated everywhere.
//!
//! A few hundred samples say little of the values between them. Knowledge of BRDFs adds the rest. Four things are known:
//!
//! 1. they are reciprocal: a sample says as much of (wo, wi) as of (wi, wo), so that one view speaks for all others. The
//!    coordinates (`pair`) are the same both ways. Light through a sheet whose sides differ may go the other way too, but the
//!    directions in front and behind do not change places (`changes`);
//! 2. a microfacet lobe and a diffuse term (`microfacet`) are close to most of them. The rest needs a clear coat too, or a
//!    lobe about the back direction. Which of these families it is, `family` chooses by samples and views that fits of them
//!    did not see;
//! 3. the residual is smooth. A Gaussian process (`process`) of the logarithms, over those coordinates, takes it. A scale
//!    (`scale`) that is even around 0 stands for the logarithm, so that samples that were clamped to 0, or are negative, count as
//!    dark;
//! 4. their colours are in XYZ, where none is negative (`color`).
//!
//! Smoothness of the residual, and noise, are those that predict left-out samples best, one by one and view by view
//! (`held_out`). Of a surface that was turned, `turned` finds whether a turn changes it, and along which axis. Samples that all others contradict are left out (`robust`). Of more samples than `points` takes, close ones are
//! taken together.
//!
//! May import: `error`, `numeric`, `row`, `table`.

mod changes;
pub(crate) mod color;
mod energy;
mod family;
mod gaps;
mod grid;
mod heights;
pub mod held_out;
mod kernel;
mod measurement;
mod microfacet;
pub(crate) mod pair;
mod points;
mod process;
mod report;
mod robust;
mod scale;
mod tuning;
mod turn;
pub(crate) mod turned;

use crate::FitError;
use crate::complete::tuning::choice::{ALONE, BRIGHTER, FARTHEST, KERNELS, LEAST_WIDTH, NOISES, OF_MODEL};
use crate::table::{Brdf, Symmetry, Table, check_storable};
use changes::Changes;
use energy::Energy;
use family::{Models, models, unseen};
pub use gaps::Gaps;
use gaps::gaps;
use grid::Grid;
use heights::Heights;
use held_out::HeldOut;
use kernel::Kernel;
use measurement::Measurement;
pub use microfacet::Family;
use microfacet::Microfacet;
use points::{Point, points};
use process::{Of, Process};
use rayon::prelude::*;
pub use report::CompletionReport;
pub use robust::Outlier;
use robust::without_outliers;
use scale::Scale;
use std::collections::BTreeSet;
use std::sync::Arc;
pub use turn::{Kept, Turn};

/// Samples made a BRDF.
#[derive(Clone)]
pub struct Completion {
    model: Microfacet,
    scale: Scale,
    changes: Changes,
    /// Whether it is that of light the other way through a sheet: both directions change places.
    is_back: bool,
    /// The residual above the model on the scale, if there is a process.
    above: Option<Arc<Grid>>,
    /// Greatest size of a value, on the scale.
    most: f64,
    energy: Option<Energy>,
    /// Its quality.
    pub report: CompletionReport,
}

/// A way to complete samples, and how it fares.
struct Candidate {
    model: Microfacet,
    kernel: Kernel,
    noise: f64,
    /// Errors at samples that are left out, and at those and views together.
    samples: HeldOut,
    rank: f64,
}

/// Least number of samples in different directions: as many as the model has unknowns in one channel.
const FEWEST: usize = 5;

/// Directions that are closer than one over this are one.
const CLOSE: f64 = 1e4;

/// Completes the samples of a table.
///
/// # Errors
/// [`FitError::Table`] for samples in fewer than five pairs of directions, and for some that are black, or darker than lobes can be.
pub fn complete(table: &Table) -> Result<Completion, FitError> {
    let samples = || table.views.iter().flat_map(|view| &view.samples);
    let place = |theta: f64, [x, y, _]: [f64; 3]| [theta, x, y].map(|v| libm::round(CLOSE * v) as i64);
    let (mut count, mut found) = (0, Vec::new());
    for view in &table.views {
        count += view.samples.len();
        for place in view.samples.iter().map(|sample| place(view.theta, sample.direction)) {
            if found.len() < FEWEST && !found.contains(&place) {
                found.push(place);
            }
        }
    }
    let places = found.len();
    if places < FEWEST {
        let s = |n: usize| if n == 1 { "" } else { "s" };
        let all = format!("{count} sample{}", s(count));
        let of =
            if places < count { format!("{all} at {places} pair{} of directions", s(places)) } else { all };
        return Err(FitError::Table(format!(
            "{of}; a diffuse term and a highlight need {FEWEST} at least, in different directions"
        )));
    }
    check_storable(samples())?;
    let mut completion = completed(Measurement::new(table), Changes::default())?;
    completion.report.gaps = gaps(table);
    Ok(completion)
}

/// Completes pairs of directions, incident and outgoing, and f in linear sRGB.
pub(crate) fn complete_pairs(pairs: &[([f64; 3], [f64; 3], [f64; 3])]) -> Result<Completion, FitError> {
    completed(Measurement::of_pairs(pairs), Changes::default())
}

fn completed(measurement: Measurement, changes: Changes) -> Result<Completion, FitError> {
    let (measurement, outliers) = without_outliers(measurement);
    let scale = Scale::of(&measurement);
    let models = models(&measurement, scale);
    let best = best(&measurement, scale, &models);
    let is_alone = best.as_ref().is_some_and(|b| is_better_alone(&measurement, scale, b, &models.alone));
    let made = best.and_then(|best| match is_alone {
        true => Some(made_alone(&measurement, scale, &models.alone, changes)),
        false => made(&measurement, scale, (&best, &models.alone), changes),
    });
    let Some(mut completion) = made else {
        let text = "its samples are too far apart in size to tell the values between them";
        return Err(FitError::Table(text.into()));
    };
    completion.report.outliers = outliers;
    (completion.report.turn, completion.report.sides) = (changes.turn, changes.sides);
    let (energy, albedo) = Energy::new(&completion)?;
    if changes.sides {
        let (other, _) = Energy::new(&completion.reversed())?;
        completion.energy = Energy::least(energy, other);
    } else {
        completion.energy = energy;
    }
    completion.report.albedo = albedo;
    Ok(completion)
}

/// What fares best at samples and views that are left out.
fn best(measurement: &Measurement, scale: Scale, models: &Models) -> Option<Candidate> {
    let ranked = |tried: Vec<(Microfacet, Kernel, f64)>| {
        let candidate = |(model, kernel, noise): (Microfacet, Kernel, f64)| {
            let points = points(measurement, &model, scale, width(&model));
            let process = Process::new(&points, kernel, &noises(&points, noise), Of::Values)?;
            let views = HeldOut::bands(&process, &points, scale).map_or(0.0, |left_out| left_out.rank());
            let samples = HeldOut::alone(&process, &points, scale);
            let rank = samples.rank() + views;
            rank.is_finite().then_some(Candidate { model, kernel, noise, samples, rank })
        };
        let mut ranked: Vec<Candidate> = tried.into_par_iter().filter_map(candidate).collect();
        ranked.sort_by(|a, b| a.rank.total_cmp(&b.rank));
        ranked
    };
    let of_model = |model: &Microfacet| {
        let model = *model;
        KERNELS.into_iter().flat_map(move |kernel| NOISES.map(|noise| (model, kernel, noise)))
    };
    ranked(models.all.iter().flat_map(of_model).collect()).into_iter().next()
}

/// Whether the model without a process predicts left-out samples and left-out views better.
fn is_better_alone(measurement: &Measurement, scale: Scale, best: &Candidate, alone: &Microfacet) -> bool {
    let Some([samples, views]) = unseen(measurement, scale, alone, None) else { return false };
    // A model that was not refitted is never worse.
    if samples.rank() > best.samples.rank() {
        return false;
    }
    let both = unseen(measurement, scale, &best.model, Some((best.kernel, best.noise)));
    both.is_some_and(|[_, both]| views.error < ALONE * both.error && views.rank() < both.rank())
}

/// Width of the coordinates for a model.
fn width(model: &Microfacet) -> f64 {
    model.width().max(LEAST_WIDTH)
}

/// Variances of the noise of points.
fn noises(points: &[Point], noise: f64) -> Vec<f64> {
    points.iter().map(|p| noise / p.count).collect()
}

/// The completion by what turned out best.
fn made(
    measurement: &Measurement,
    scale: Scale,
    (best, alone): (&Candidate, &Microfacet),
    changes: Changes,
) -> Option<Completion> {
    let &Candidate { model, kernel, noise, .. } = best;
    let points = points(measurement, &model, scale, width(&model));
    let process = Process::new(&points, kernel, &noises(&points, noise), Of::Values)?;
    let hues = match model.family() {
        Family::Coat => Some(Process::new(&points, kernel, &noises(&points, noise), Of::Hues)?),
        Family::OneLobe | Family::Retro => None,
    };
    let report = CompletionReport {
        samples: measurement.samples.len(),
        points: points.len(),
        family: model.family(),
        width: model.width(),
        exponent: model.exponent(),
        lengths: [0, 1, 2, 3].map(|k| kernel.lengths[k]),
        noise,
        samples_left_out: HeldOut::alone(&process, &points, scale),
        views_left_out: HeldOut::bands(&process, &points, scale),
        model_alone: of_model_alone(measurement, scale, alone),
        ..CompletionReport::default()
    };
    let heights = Heights::new(&points);
    let above = Grid::new(width(&model), changes, |pair, at| {
        let values = process.at(at);
        let mean = values.iter().sum::<f64>() / 3.0;
        let corrected = heights.correction(at[0], mean);
        let Some(hues) = &hues else { return values.map(|v| v + corrected) };
        let (free, hue) = (model.hue(pair), hues.at(at));
        hue.map(|v| mean + corrected + free * v)
    });
    let most = most(measurement, scale);
    let above = Some(Arc::new(above));
    Some(Completion { model, scale, changes, is_back: false, above, most, energy: None, report })
}

/// The completion by the model without a process.
fn made_alone(measurement: &Measurement, scale: Scale, model: &Microfacet, changes: Changes) -> Completion {
    let [samples_left_out, views_left_out] = unseen(measurement, scale, model, None).unwrap_or_default();
    let report = CompletionReport {
        samples: measurement.samples.len(),
        points: measurement.samples.len(),
        family: model.family(),
        width: model.width(),
        exponent: model.exponent(),
        samples_left_out,
        views_left_out: Some(views_left_out),
        model_alone: of_model_alone(measurement, scale, model),
        ..CompletionReport::default()
    };
    let most = most(measurement, scale);
    Completion { model: *model, scale, changes, is_back: false, above: None, most, energy: None, report }
}

fn of_model_alone(measurement: &Measurement, scale: Scale, model: &Microfacet) -> HeldOut {
    let points = points(measurement, model, scale, width(model));
    let above: Vec<[f64; 3]> = points.iter().map(|p| p.above).collect();
    HeldOut::new(&points, &above, scale)
}

/// Greatest size of a value, on the scale.
fn most(measurement: &Measurement, scale: Scale) -> f64 {
    scale.to(measurement.samples.iter().flat_map(|s| s.value).fold(0.0, f64::max)) + BRIGHTER
}

impl Completion {
    /// That of light the other way through a sheet: the values with both directions exchanged.
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self { is_back: !self.is_back, ..self.clone() }
    }

    /// The table that it is of without the samples that all others contradict.
    ///
    /// # Errors
    /// As [`Table::from_scattered`].
    pub fn without_outliers(&self, table: &Table) -> Result<Table, FitError> {
        let outliers: BTreeSet<(usize, usize)> =
            self.report.outliers.iter().map(|o| (o.view, o.sample)).collect();
        if outliers.is_empty() {
            return Ok(table.clone());
        }
        let kept = table.views.iter().enumerate().map(|(n, view)| {
            let kept = view.samples.iter().enumerate().filter(|(i, _)| !outliers.contains(&(n, *i)));
            (view.theta, kept.map(|(_, s)| (s.direction, s.rgb)).collect::<Vec<_>>())
        });
        Table::from_scattered(kept.filter(|view| !view.1.is_empty()).collect())
    }
}

/// A diffuse term and a microfacet lobe fitted to samples: the first step of a completion alone, as a baseline.
pub struct Model(Microfacet, Changes);

impl Model {
    /// Fits it to the samples of a table.
    ///
    /// # Errors
    /// As [`complete`].
    pub fn fit(table: &Table) -> Result<Self, FitError> {
        check_storable(table.views.iter().flat_map(|view| &view.samples))?;
        let measurement = Measurement::new(table);
        let few = measurement.thinned(OF_MODEL);
        let fits = Microfacet::fits(&few, Scale::of(&measurement), Family::OneLobe);
        Ok(Self(fits[0].1, Changes::default()))
    }
}

impl Brdf for Model {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        color::rgb(self.0.value(&self.1.pair(wi, wo)))
    }

    fn symmetry(&self) -> Symmetry {
        self.1.symmetry()
    }

    fn axis(&self) -> f64 {
        self.1.axis()
    }
}

impl Brdf for Completion {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let (wi, wo) = if self.is_back { (wo, wi) } else { (wi, wo) };
        let pair = self.changes.pair(wi, wo);
        let model = self.model.value(&pair);
        let above = self.above.as_ref().map_or([0.0; 3], |above| above.at(&pair, wi, wo));
        let value = |c: usize| self.scale.to(model[c]) + above[c].clamp(-FARTHEST, FARTHEST);
        let share = self.energy.as_ref().map_or(1.0, |energy| energy.factor(wi[2]) * energy.factor(wo[2]));
        color::rgb([0, 1, 2].map(|c| share * self.scale.back(value(c).clamp(-self.most, self.most))))
    }

    fn symmetry(&self) -> Symmetry {
        self.changes.symmetry()
    }

    fn axis(&self) -> f64 {
        self.changes.axis()
    }
}
