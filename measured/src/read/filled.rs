//! A measurement with holes, filled by what its samples are completed to.

use super::merl::Merl;
use super::rgl::Rgl;
use crate::FitError;
use crate::complete::{Completion, complete_pairs};
use crate::table::Brdf;

/// Values that a completion is made of.
const SAMPLES: usize = 3000;

/// A table whose unmeasured parts say what those that were measured are completed to.
pub struct Filled {
    table: Box<dyn Brdf + Send>,
    completion: Completion,
}

impl Filled {
    /// Fills the holes of a MERL material.
    ///
    /// # Errors
    /// As [`complete`](crate::complete::complete).
    pub fn new(grid: Merl) -> Result<Self, FitError> {
        let completion = complete_pairs(&grid.samples(SAMPLES))?;
        Ok(Self { table: Box::new(grid), completion })
    }

    /// Fills the holes of an RGL material.
    ///
    /// # Errors
    /// As [`complete`](crate::complete::complete).
    pub fn of_rgl(file: Rgl) -> Result<Self, FitError> {
        let completion = complete_pairs(&file.samples(SAMPLES))?;
        Ok(Self { table: Box::new(file), completion })
    }
}

impl Brdf for Filled {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let (value, share) = (self.table.evaluate(wi, wo), self.table.measured(wi, wo));
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
        self.table.measured(wi, wo)
    }
}
