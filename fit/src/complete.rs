//! Scattered samples made a BRDF that can be evaluated everywhere.
//!
//! A few hundred samples say little of what lies between them, unless one knows what BRDFs are like. Four things are known:
//!
//! 1. they are reciprocal: a sample says as much of (wo, wi) as of (wi, wo), so that one view speaks for all others. The coordinates
//!    (`pair`) are the same both ways;
//! 2. a microfacet lobe and a diffuse term (`microfacet`) are close to most of them, with a clear coat or a lobe about the back direction to the
//!    rest. Which of these families it is, `family` chooses by samples and views that fits of them did not see;
//! 3. what is left is smooth. A Gaussian process (`process`) of the logarithms, over those coordinates, takes it. A scale
//!    (`scale`) that is even around 0 stands for the logarithm, so that samples that were clamped to 0, or are negative, say what they are: dark;
//! 4. their colours are in XYZ, where none is negative (`color`).
//!
//! How smooth what is left is, and how much noise there is: what says best of samples left out, one by one and view by view
//! (`held_out`). Samples that all others speak against are left out (`robust`). Of more samples than `points` takes, close ones are taken together.

mod color;
mod energy;
mod family;
mod gaps;
mod grid;
pub mod held_out;
mod measurement;
mod microfacet;
mod pair;
mod points;
mod process;
mod report;
mod robust;
mod scale;

use crate::FitError;
use crate::table::{Brdf, Table, check_storable};
use energy::Energy;
use family::{Models, models};
pub use gaps::Gaps;
use gaps::gaps;
use grid::Grid;
use held_out::HeldOut;
use measurement::Measurement;
pub use microfacet::Family;
use microfacet::Microfacet;
use pair::Pair;
use points::{Point, points};
use process::{Kernel, Process};
use rayon::prelude::*;
pub use report::CompletionReport;
pub use robust::Outlier;
use robust::without_outliers;
use scale::Scale;

/// Farthest that a value is from the model, on the scale, and above the brightest sample.
const FARTHEST: f64 = 12.0;
const BRIGHTER: f64 = 1.4;

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
    let (measurement, outliers) = without_outliers(Measurement::new(table));
    let scale = Scale::of(&measurement);
    let models = models(&measurement, scale);
    let best = best(&measurement, scale, &models);
    let made = best.and_then(|best| made(&measurement, scale, table, (&best, &models.alone)));
    let Some(mut completion) = made else {
        let text = "its samples are too far apart in size to say what lies between them";
        return Err(FitError::Table(text.into()));
    };
    completion.report.outliers = outliers;
    let (energy, albedo) = Energy::new(&completion)?;
    (completion.energy, completion.report.albedo) = (energy, albedo);
    Ok(completion)
}

/// What fares best at samples and views that are left out.
fn best(measurement: &Measurement, scale: Scale, models: &Models) -> Option<Candidate> {
    let of_model = |model: &Microfacet| {
        let model = *model;
        KERNELS.into_iter().flat_map(move |kernel| NOISES.into_iter().map(move |noise| (model, kernel, noise)))
    };
    let all: Vec<(Microfacet, Kernel, f64)> = models.all.iter().flat_map(of_model).collect();
    let ranked = all.into_par_iter().filter_map(|(model, kernel, noise)| {
        let points = points(measurement, &model, scale, width(&model));
        let process = Process::new(&points, kernel, &noises(&points, noise))?;
        let views = HeldOut::bands(&process, &points, scale).map_or(0.0, |left_out| left_out.rank());
        let rank = HeldOut::alone(&process, &points, scale).rank() + views;
        Some(Candidate { model, kernel, noise, rank })
    });
    let ranked: Vec<Candidate> = ranked.collect();
    ranked.into_iter().filter(|c| c.rank.is_finite()).min_by(|a, b| a.rank.total_cmp(&b.rank))
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
    table: &Table,
    (best, alone): (&Candidate, &Microfacet),
) -> Option<Completion> {
    let &Candidate { model, kernel, noise, .. } = best;
    let points = points(measurement, &model, scale, width(&model));
    let process = Process::new(&points, kernel, &noises(&points, noise))?;
    let of_model = self::points(measurement, alone, scale, width(alone));
    let above: Vec<[f64; 3]> = of_model.iter().map(|p| p.above).collect();
    let report = CompletionReport {
        samples: measurement.samples.len(),
        points: points.len(),
        family: model.family(),
        width: model.width(),
        exponent: model.exponent(),
        lengths: kernel.lengths,
        noise,
        samples_left_out: HeldOut::alone(&process, &points, scale),
        views_left_out: HeldOut::bands(&process, &points, scale),
        model_alone: HeldOut::new(&of_model, &above, scale),
        gaps: gaps(table),
        ..CompletionReport::default()
    };
    let above = Grid::new(width(&model), |at| process.at(at));
    let brightest = measurement.samples.iter().flat_map(|s| s.value).fold(0.0, f64::max);
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
        let few = measurement.thinned(OF_MODEL);
        let fits = Microfacet::fits(&few, Scale::of(&measurement), Family::OneLobe);
        Ok(Self(fits[0].1))
    }
}

impl Brdf for Model {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        color::rgb(self.0.value(&Pair::new(wi, wo)))
    }
}

impl Brdf for Completion {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let pair = Pair::new(wi, wo);
        let (model, above) = (self.model.value(&pair), self.above.at(&pair));
        let value = |c: usize| self.scale.to(model[c]) + above[c].clamp(-FARTHEST, FARTHEST);
        let share = self.energy.as_ref().map_or(1.0, |energy| energy.factor(wi[2]) * energy.factor(wo[2]));
        color::rgb([0, 1, 2].map(|c| share * self.scale.back(value(c).clamp(-self.most, self.most))))
    }
}
