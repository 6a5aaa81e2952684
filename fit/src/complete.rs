//! Scattered samples made a BRDF that can be evaluated everywhere.
//!
//! A few hundred samples say little of what lies between them, unless one knows what BRDFs are like. Three things are known:
//!
//! 1. they are reciprocal: a sample says as much of (wo, wi) as of (wi, wo), so that one view speaks for all others. The coordinates
//!    (`pair`) are the same both ways;
//! 2. a microfacet lobe and a diffuse term (`microfacet`) are close to most of them. They are fitted to the samples, from several
//!    widths on, and once more to what the next step leaves over;
//! 3. what is left is smooth. A Gaussian process (`process`) of the logarithms, over those coordinates, takes it. A scale
//!    (`scale`) that is even around 0 stands for the logarithm, so that samples that were clamped to 0, or are negative, say what they are: dark.
//!
//! Which model, how smooth, and how much noise there is: what says best of samples left out, one by one and view by view
//! (`held_out`). A sample that all others speak against counts less. Of more samples than `points` takes, close ones are taken together.

mod energy;
mod gaps;
mod grid;
pub mod held_out;
mod measurement;
mod microfacet;
mod pair;
mod points;
mod process;
mod report;
mod scale;

use crate::FitError;
use crate::table::{Brdf, Table, check_storable};
use energy::Energy;
pub use gaps::Gaps;
use gaps::gaps;
use grid::Grid;
use held_out::HeldOut;
use measurement::Measurement;
use microfacet::Microfacet;
use pair::Pair;
use points::{MOST, Point, points};
use process::{Kernel, Process, factor};
use rayon::prelude::*;
pub use report::CompletionReport;
use scale::Scale;

/// Farthest that a value is from the model, on the scale, and above the brightest sample.
const FARTHEST: f64 = 12.0;
const BRIGHTER: f64 = 1.4;

/// Widths that fits of the model start from; models whose widths and exponents are this close are one.
const WIDTHS: [f64; 4] = [0.3, 0.1, 0.03, 0.01];
const SAME: f64 = 0.1;

/// Most models that go on, each as it is and fitted to what the process leaves over.
const MODELS: usize = 2;

/// Least width of the coordinates.
const LEAST_WIDTH: f64 = 0.01;

/// Samples that the model is fitted to.
const OF_MODEL: usize = 4000;

/// No term of a coordinate alone.
const TOGETHER: [(f64, f64); 3] = [(0.0, 1.0); 3];

/// How smooth what is left may be: from short to long, and with what depends on one coordinate alone.
const KERNELS: [Kernel; 4] = [
    Kernel { alone: TOGETHER, joint: 1.0, lengths: [1.0, 0.8, 0.8, 2.0] },
    Kernel { alone: TOGETHER, joint: 3.0, lengths: [2.0, 1.2, 1.2, 3.0] },
    Kernel { alone: [(0.3, 0.5), (0.1, 0.4), (0.1, 0.3)], joint: 3.0, lengths: [2.0, 1.2, 1.2, 3.0] },
    Kernel { alone: TOGETHER, joint: 3.0, lengths: [2.0, 2.0, 2.0, 3.0] },
];

/// Variance of the noise of a sample, on the scale.
const NOISES: [f64; 2] = [1e-3, 1e-2];

/// What the model is fitted beside.
const BESIDE: (Kernel, f64) = (KERNELS[3], 3e-3);
const REFINEMENTS: usize = 2;

/// Standard deviations from what all others say at which a sample begins to count less, and the spread angle of the half vector up
/// to which it may: nearer, it is the peak, of which others know nothing.
const OUTLIER: f64 = 4.0;
const PEAK: f64 = 1.5;

/// Samples made a BRDF.
pub struct Completion {
    model: Microfacet,
    scale: Scale,
    above: Grid,
    /// Greatest size of a value, on the scale.
    most: f64,
    energy: Option<Energy>,
    /// What is known of how good it is.
    pub report: CompletionReport,
}

/// A way to complete samples, and how it fares.
struct Candidate {
    model: Microfacet,
    kernel: Kernel,
    noise: f64,
    rank: f64,
}

/// Completes the samples of a table.
///
/// # Errors
/// [`FitError::Table`] for samples that are black, or darker than lobes can be.
pub fn complete(table: &Table) -> Result<Completion, FitError> {
    check_storable(table.views.iter().flat_map(|view| &view.samples))?;
    let measurement = Measurement::new(table);
    let scale = Scale::of(&measurement);
    let models = models(&measurement, scale);
    let alone = models[0];
    let pairs: Vec<(Microfacet, Kernel, f64)> = models
        .into_iter()
        .flat_map(|model| {
            KERNELS.into_iter().flat_map(move |k| NOISES.into_iter().map(move |n| (model, k, n)))
        })
        .collect();
    let ranked = pairs.into_par_iter().filter_map(|(model, kernel, noise)| {
        let points = points(&measurement, &model, scale, width(&model));
        let process = Process::new(&points, kernel, &noises(&points, noise))?;
        let views = HeldOut::bands(&process, &points, scale).map_or(0.0, |left_out| left_out.rank());
        let rank = HeldOut::alone(&process, &points, scale).rank() + views;
        Some(Candidate { model, kernel, noise, rank })
    });
    let ranked: Vec<Candidate> = ranked.collect();
    let best = ranked.into_iter().filter(|c| c.rank.is_finite()).min_by(|a, b| a.rank.total_cmp(&b.rank));
    let made = best.and_then(|best| made(&measurement, scale, table, (&best, &alone)));
    let Some(mut completion) = made else {
        let text = "its samples are too far apart in size to say what lies between them";
        return Err(FitError::Table(text.into()));
    };
    completion.energy = Energy::new(&completion)?;
    Ok(completion)
}

/// The model at its best from several widths, each also beside the process.
fn models(measurement: &Measurement, scale: Scale) -> Vec<Microfacet> {
    let mut models: Vec<Microfacet> = Vec::new();
    for model in fitted(&measurement.thinned(OF_MODEL), scale) {
        let close = |a: f64, b: f64| (a / b - 1.0).abs() < SAME;
        let is_new = |other: &Microfacet| {
            !(close(model.width(), other.width()) && close(model.exponent(), other.exponent()))
        };
        if models.len() < MODELS && models.iter().all(is_new) {
            models.push(model);
        }
    }
    let few = measurement.thinned(MOST);
    let beside: Vec<Microfacet> = models.par_iter().filter_map(|model| beside(&few, scale, *model)).collect();
    models.extend(beside);
    models
}

/// Fits of the model from all widths, the best first.
fn fitted(few: &Measurement, scale: Scale) -> Vec<Microfacet> {
    let mut fitted: Vec<(f64, Microfacet)> =
        WIDTHS.par_iter().map(|&width| Microfacet::fit(few, scale, width)).collect();
    fitted.sort_by(|a, b| a.0.total_cmp(&b.0));
    fitted.into_iter().map(|fit| fit.1).collect()
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

/// Width of the coordinates for a model.
fn width(model: &Microfacet) -> f64 {
    model.width().max(LEAST_WIDTH)
}

/// Variances of the noise of points.
fn noises(points: &[Point], noise: f64) -> Vec<f64> {
    points.iter().map(|p| noise / p.count).collect()
}

/// The completion by what turned out best, in which samples that all others speak against count less.
fn made(
    measurement: &Measurement,
    scale: Scale,
    table: &Table,
    (best, alone): (&Candidate, &Microfacet),
) -> Option<Completion> {
    let &Candidate { model, kernel, noise, .. } = best;
    let points = points(measurement, &model, scale, width(&model));
    let mut noises = noises(&points, noise);
    let mut process = Process::new(&points, kernel, &noises)?;
    let mut outliers = 0;
    for ((left, variance), (noise, point)) in
        process.left_out_alone().into_iter().zip(noises.iter_mut().zip(&points))
    {
        let mean = left.iter().sum::<f64>() / 3.0;
        let deviations = mean.abs() / libm::sqrt(variance);
        if deviations > OUTLIER && point.at[0] > PEAK {
            *noise += mean * mean;
            outliers += 1;
        }
    }
    if outliers > 0 {
        process = Process::new(&points, kernel, &noises)?;
    }
    let of_model = self::points(measurement, alone, scale, width(alone));
    let above: Vec<[f64; 3]> = of_model.iter().map(|p| p.above).collect();
    let report = CompletionReport {
        samples: measurement.samples.len(),
        points: points.len(),
        outliers,
        width: model.width(),
        exponent: model.exponent(),
        lengths: kernel.lengths,
        noise,
        samples_left_out: HeldOut::alone(&process, &points, scale),
        views_left_out: HeldOut::bands(&process, &points, scale),
        model_alone: HeldOut::new(&of_model, &above, scale),
        gaps: gaps(table),
    };
    let above = Grid::new(width(&model), |at| process.at(at));
    let brightest = measurement.samples.iter().flat_map(|s| s.rgb).fold(0.0, f64::max);
    Some(Completion { model, scale, above, most: scale.to(brightest) + BRIGHTER, energy: None, report })
}

/// A diffuse term and a microfacet lobe fitted to samples: the first step of a completion alone, as a baseline.
pub struct Model(Microfacet);

impl Model {
    /// Fits it to the samples of a table.
    ///
    /// # Errors
    /// As [`complete`].
    pub fn fit(table: &Table) -> Result<Self, FitError> {
        check_storable(table.views.iter().flat_map(|view| &view.samples))?;
        let measurement = Measurement::new(table);
        Ok(Self(fitted(&measurement.thinned(OF_MODEL), Scale::of(&measurement)).swap_remove(0)))
    }
}

impl Brdf for Model {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        self.0.value(&Pair::new(wi, wo))
    }
}

impl Brdf for Completion {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let pair = Pair::new(wi, wo);
        let (model, above) = (self.model.value(&pair), self.above.at(&pair));
        let value = |c: usize| self.scale.to(model[c]) + above[c].clamp(-FARTHEST, FARTHEST);
        let share = self.energy.as_ref().map_or(1.0, |energy| energy.factor(wi[2]) * energy.factor(wo[2]));
        [0, 1, 2].map(|c| share * self.scale.back(value(c).clamp(-self.most, self.most)))
    }
}
