//! No surface reflects more than it receives. The completion keeps to that between samples and beyond the last one.

use crate::FitError;
use crate::complete::tuning::energy::{DENSITY, INTERVALS, MOST};
use crate::table::{Brdf, Table};
use std::f64::consts::FRAC_PI_2;

/// Angles, radians, and the albedos there in linear sRGB.
type Albedos = Vec<(f64, [f64; 3])>;

/// What values are multiplied by, once for each of the two directions, so that they stay reciprocal.
pub(super) struct Energy {
    factors: Vec<f64>,
}

impl Energy {
    /// Factors that hold the albedos of a BRDF, `None` where they hold by themselves; and the albedos before, with their angles, radians.
    pub fn new(brdf: &dyn Brdf) -> Result<(Option<Self>, Albedos), FitError> {
        let last = 0.999 * FRAC_PI_2;
        let theta = |n: usize| libm::acos(1.0 - (n as f64 / INTERVALS as f64).powi(2)).min(last);
        let thetas: Vec<f64> = (0..=INTERVALS).map(theta).collect();
        let table = Table::from_brdf(brdf, &thetas, DENSITY)?;
        let factor = |albedo: [f64; 3]| libm::sqrt((MOST / albedo.into_iter().fold(MOST, f64::max)).min(1.0));
        let factors: Vec<f64> = table.views.iter().map(|view| factor(view.albedo)).collect();
        let albedos = table.views.iter().map(|view| (view.theta, view.albedo)).collect();
        Ok((factors.iter().any(|f| *f < 1.0).then_some(Self { factors }), albedos))
    }

    /// The factor of one direction, by its cosine.
    pub fn factor(&self, cos: f64) -> f64 {
        let place = libm::sqrt((1.0 - cos).clamp(0.0, 1.0)) * INTERVALS as f64;
        let node = (place as usize).min(INTERVALS - 1);
        let part = place - node as f64;
        self.factors[node] + part * (self.factors[node + 1] - self.factors[node])
    }
}
