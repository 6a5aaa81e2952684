//! Bounds of heights that no sample caught.
//!
//! Between the samples nearest to the mirror direction a process goes on as it came, and may end at several times what any of them says. Near
//! the peak, what lies above the model is held to what samples there lie above it.

use super::points::Point;

/// Spread angle of the half vector up to which samples are near the peak, and fewest of them.
const PEAK: f64 = 2.0;
const FEWEST: usize = 3;

/// How far beyond the samples it may be, on the scale: at the peak, and more per unit of the spread angle.
const BEYOND: [f64; 2] = [0.3, 1.0];

/// Least and greatest of what samples near the peak are above the model, mean of the channels.
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

    /// What is to be added to a mean of the channels at a spread angle, so that it is within the bounds.
    pub fn correction(&self, spread: f64, mean: f64) -> f64 {
        let beyond = BEYOND[0] + BEYOND[1] * spread;
        mean.clamp(self.least - beyond, self.most + beyond) - mean
    }
}
