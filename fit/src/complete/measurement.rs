//! Scattered samples as a completion sees them.

use super::pair::Pair;
use crate::table::{Sample, Table};
use std::f64::consts::PI;

/// Share of the samples that are darker than what a diffuse term starts from.
const DARK: f64 = 0.2;

/// Least mean radiance over the brightest sample: where most is noise around 0, the mean may be anything.
const LEAST_LEVEL: f64 = 1e-4;

/// One sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measured {
    /// Its directions.
    pub pair: Pair,
    /// f; 1/sr.
    pub rgb: [f64; 3],
    /// The view that it is of.
    pub view: usize,
    /// Weight of the squared difference of f that makes the squared relative L2 error of `f cos` of a view.
    pub relative: f64,
    /// Share of the projected solid angle of all views.
    pub even: f64,
}

/// The samples of all views.
pub(super) struct Measurement {
    /// All samples, view after view.
    pub samples: Vec<Measured>,
    /// How many views there are.
    pub views: usize,
    /// Mean radiance under a white sky, mean of the channels and views; 1/sr.
    pub level: f64,
    /// f that a fifth of the samples are below, per channel.
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
            let square =
                |s: &Sample| s.rgb.iter().map(|v| v * v).sum::<f64>() * s.direction[2] * s.direction[2];
            let norm: f64 = from.samples.iter().map(|s| s.weight * square(s)).sum::<f64>().max(1e-300);
            samples.extend(from.samples.iter().map(|s| Measured {
                pair: Pair::new(s.direction, wo),
                rgb: s.rgb,
                view,
                relative: s.weight * s.direction[2] * s.direction[2] / norm,
                even: s.weight * s.direction[2] / projected,
            }));
        }
        let brightest = samples.iter().flat_map(|s| s.rgb).fold(0.0, f64::max);
        let albedos =
            table.views.iter().flat_map(|v| v.uncut_albedo).sum::<f64>() / 3.0 / table.views.len() as f64;
        let level = (albedos / PI).max(LEAST_LEVEL * brightest);
        let dark = [0, 1, 2].map(|c| {
            let mut values: Vec<f64> = samples.iter().map(|s| s.rgb[c]).collect();
            values.sort_by(f64::total_cmp);
            values[(DARK * values.len() as f64) as usize]
        });
        Self { samples, views: table.views.len(), level, dark }
    }

    /// Every n-th sample, such that at most so many are left.
    pub fn thinned(&self, most: usize) -> Self {
        let every = self.samples.len().div_ceil(most).max(1);
        let samples = self.samples.iter().step_by(every).copied().collect();
        Self { samples, ..*self }
    }
}
