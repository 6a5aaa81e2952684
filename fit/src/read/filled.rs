//! A measurement with holes, filled by what its samples are completed to.

use super::merl::Merl;
use crate::FitError;
use crate::complete::{Completion, complete_pairs};
use crate::table::Brdf;

/// Cells that a completion is made of.
const SAMPLES: usize = 3000;

/// A MERL material whose unmeasured cells say what those that were measured are completed to.
pub struct Filled {
    grid: Merl,
    completion: Completion,
}

impl Filled {
    /// Fills the holes of a material.
    ///
    /// # Errors
    /// As [`complete`](crate::complete::complete).
    pub fn new(grid: Merl) -> Result<Self, FitError> {
        let completion = complete_pairs(&grid.samples(SAMPLES))?;
        Ok(Self { grid, completion })
    }
}

impl Brdf for Filled {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let (value, share) = (self.grid.evaluate(wi, wo), self.grid.measured(wi, wo));
        if share >= 1.0 {
            return value;
        }
        let completed = self.completion.evaluate(wi, wo);
        if share > 0.0 {
            [0, 1, 2].map(|c| share * value[c] + (1.0 - share) * completed[c])
        } else {
            completed
        }
    }

    fn measured(&self, wi: [f64; 3], wo: [f64; 3]) -> f64 {
        self.grid.measured(wi, wo)
    }
}
