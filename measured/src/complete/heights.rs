//! Bounds of heights that no sample caught.
//!
//! Between the samples nearest to the mirror direction a process goes on as it came, and may end at several times any of them. Near
//! the peak, the residual is held within that of the samples there.

use super::points::Point;
use crate::complete::tuning::heights::{BEYOND, FEWEST, PEAK};

/// Least and greatest residual of samples near the peak, mean of the channels.
pub(super) struct Heights {
    least: f64,
    most: f64,
}

impl Heights {
    /// Of points; no bounds where too few are near the peak.
    pub fn new(points: &[Point]) -> Self {
        let near: Vec<f64> =
            points.iter().filter(|p| p.at[0] < PEAK).map(|p| p.above.iter().sum::<f64>() / 3.0).collect();
        if near.len() < FEWEST {
            return Self { least: f64::NEG_INFINITY, most: f64::INFINITY };
        }
        // The model itself is inside.
        let ends = |(least, most): (f64, f64), v: &f64| (least.min(*v), most.max(*v));
        let (least, most) = near.iter().fold((0.0, 0.0), ends);
        Self { least, most }
    }

    /// The correction of a mean of the channels at a spread angle that brings it within the bounds.
    pub fn correction(&self, spread: f64, mean: f64) -> f64 {
        let beyond = BEYOND[0] + BEYOND[1] * spread;
        mean.clamp(self.least - beyond, self.most + beyond) - mean
    }
}
