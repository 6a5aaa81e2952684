//! Scattered samples as a completion sees them.

use super::changes::Changes;
use super::color::xyz;
use super::pair::Pair;
use crate::complete::tuning::measurement::{DARK, LEAST_LEVEL, VIEWS_OF_PAIRS};
use crate::table::{DARKEST, Table};
use std::f64::consts::{FRAC_PI_2, PI};

/// One sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measured {
    /// Its directions.
    pub pair: Pair,
    /// f, XYZ over white; 1/sr.
    pub value: [f64; 3],
    /// The view that it is of, and which of its samples it is.
    pub view: usize,
    pub number: usize,
    /// The part that is left out with it: its view, or the turn of its sample.
    pub part: usize,
    /// Weight of the squared difference of f that makes the squared relative L2 error of `f cos` of a view.
    pub relative: f64,
    /// Share of the projected solid angle of all views.
    pub even: f64,
}

/// A sample with its places in parts of a measurement.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    pub wi: [f64; 3],
    pub wo: [f64; 3],
    pub rgb: [f64; 3],
    /// Cosine of the direction that the instrument moved.
    pub moved: f64,
    pub view: usize,
    pub part: usize,
    pub number: usize,
}

/// The samples of all views.
pub(super) struct Measurement {
    /// All samples, view after view.
    pub samples: Vec<Measured>,
    /// How many views there are.
    pub views: usize,
    /// How many parts there are.
    pub parts: usize,
    /// Mean radiance under a white sky, mean of the channels and views; 1/sr.
    pub level: f64,
    /// The value that a fifth of the samples are below, per channel.
    pub dark: [f64; 3],
}

impl Measurement {
    /// Of a table.
    pub fn new(table: &Table) -> Self {
        let all = || table.views.iter().flat_map(|view| &view.samples);
        let projected: f64 = all().map(|s| s.weight * s.direction[2]).sum();
        let mut samples = Vec::with_capacity(all().count());
        for (view, from) in table.views.iter().enumerate() {
            let (sin, cos) = libm::sincos(from.theta);
            let wo = [-sin, 0.0, cos];
            samples.extend(from.samples.iter().enumerate().map(|(number, s)| Measured {
                pair: Pair::new(s.direction, wo),
                value: xyz(s.rgb),
                view,
                number,
                part: view,
                relative: s.weight * s.direction[2] * s.direction[2],
                even: s.weight * s.direction[2] / projected,
            }));
        }
        let albedos =
            table.views.iter().flat_map(|v| v.uncut_albedo).sum::<f64>() / 3.0 / table.views.len() as f64;
        let views = table.views.len();
        Self::of_samples(samples, [views; 2], albedos / PI)
    }

    /// Of pairs of directions: incident and outgoing one, in any frame with +z the normal, and f in linear sRGB.
    pub fn of_pairs(pairs: &[([f64; 3], [f64; 3], [f64; 3])]) -> Self {
        let mut numbers = [0; VIEWS_OF_PAIRS];
        let sample = |(wi, wo, rgb): &([f64; 3], [f64; 3], [f64; 3])| {
            let place = libm::acos(wo[2].clamp(0.0, 1.0)) / FRAC_PI_2 * VIEWS_OF_PAIRS as f64;
            let view = (place as usize).min(VIEWS_OF_PAIRS - 1);
            numbers[view] += 1;
            let (value, number) = (xyz(*rgb), numbers[view] - 1);
            let (relative, even) = (wi[2] * wi[2], 1.0 / pairs.len() as f64);
            Measured { pair: Pair::new(*wi, *wo), value, view, number, part: view, relative, even }
        };
        let samples: Vec<Measured> = pairs.iter().map(sample).collect();
        let level = samples.iter().map(|s| s.even * s.value.iter().sum::<f64>() / 3.0).sum();
        Self::of_samples(samples, [VIEWS_OF_PAIRS; 2], level)
    }

    /// Of samples with their places, by what changes values. Their numbers are those of the samples.
    pub fn of_placed(placed: &[Placed], [views, parts]: [usize; 2], changes: &Changes) -> Self {
        let even = 1.0 / placed.len() as f64;
        let sample = |s: &Placed| {
            let pair = changes.pair(s.wi, s.wo);
            let relative = s.moved * s.moved;
            let Placed { view, part, number, .. } = *s;
            Measured { pair, value: xyz(s.rgb), view, number, part, relative, even }
        };
        let samples: Vec<Measured> = placed.iter().map(sample).collect();
        let level = samples.iter().map(|s| s.even * s.value.iter().sum::<f64>() / 3.0).sum();
        Self::of_samples(samples, [views, parts], level)
    }

    /// With the numbers that depend on all samples; `relative` need not be over the norms of the views yet.
    fn of_samples(mut samples: Vec<Measured>, [views, parts]: [usize; 2], level: f64) -> Self {
        let mut norms = vec![0.0; views];
        for s in &samples {
            norms[s.view] += s.relative * s.value.iter().map(|v| v * v).sum::<f64>();
        }
        samples.iter_mut().for_each(|s| s.relative /= norms[s.view].max(1e-300));
        let brightest = samples.iter().flat_map(|s| s.value).fold(0.0, f64::max);
        let dark = [0, 1, 2].map(|c| {
            let mut values: Vec<f64> = samples.iter().map(|s| s.value[c]).collect();
            values.sort_by(f64::total_cmp);
            values.get((DARK * values.len() as f64) as usize).copied().unwrap_or(0.0)
        });
        Self { samples, views, parts, level: level.max(LEAST_LEVEL * brightest), dark }
    }

    /// Whether no sample is bright enough for lobes to be stored.
    pub fn is_black(&self) -> bool {
        self.samples.iter().flat_map(|s| s.value).fold(0.0, f64::max) < DARKEST
    }

    /// Those samples alone.
    pub fn only(&self, is_kept: impl Fn(&Measured) -> bool) -> Self {
        let samples: Vec<Measured> = self.samples.iter().filter(|s| is_kept(s)).copied().collect();
        let (sum, all) = samples
            .iter()
            .fold((0.0, 0.0), |(a, b), s| (a + s.even * s.value.iter().sum::<f64>() / 3.0, b + s.even));
        Self::of_samples(samples, [self.views, self.parts], sum / all.max(1e-300))
    }

    /// Every n-th sample, so that at most `most` are left.
    pub fn thinned(&self, most: usize) -> Self {
        let every = self.samples.len().div_ceil(most).max(1);
        let samples = self.samples.iter().step_by(every).copied().collect();
        Self { samples, ..*self }
    }
}
