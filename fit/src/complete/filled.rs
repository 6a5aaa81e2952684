//! A measurement with holes, filled by what its samples are completed to.

use super::measurement::Measurement;
use super::{Completion, completed};
use crate::FitError;
use crate::read::merl::Merl;
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
    /// As [`complete`](super::complete).
    pub fn new(grid: Merl) -> Result<Self, FitError> {
        let completion = completed(Measurement::of_pairs(&grid.samples(SAMPLES)))?;
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
        if share > 0.0 { [0, 1, 2].map(|c| share * value[c] + (1.0 - share) * completed[c]) } else { completed }
    }

    fn measured(&self, wi: [f64; 3], wo: [f64; 3]) -> f64 {
        self.grid.measured(wi, wo)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export;
    use crate::read::merl::{CELLS, SIZE, parse};
    use crate::table::direction;

    /// Half angles beyond 40 degrees were not measured; the truth is a model.
    #[test]
    fn holes_are_filled_by_what_surrounds_them_and_stay_marked() {
        let model = crate::analytic::parse("ggx:alpha=0.2,f0=0.9").unwrap().brdf;
        let mut bytes = export::merl(model.as_ref()).unwrap().bytes;
        for channel in 0..3 {
            for cell in 60 * SIZE[1] * SIZE[2]..CELLS {
                let at = 12 + 8 * (CELLS * channel + cell);
                bytes[at..at + 8].copy_from_slice(&(-1.0f64).to_le_bytes());
            }
        }
        let grid = parse(&bytes).unwrap();
        let missing = grid.missing();
        assert!(missing > 0.05 && missing < 0.5, "{missing}");
        let filled = Filled::new(grid).unwrap();
        for (i, phi, o) in [(75.0f64, 60.0f64, 70.0f64), (70.0, 90.0, 60.0), (80.0, 40.0, 60.0)] {
            let (wi, wo) = (direction(i.to_radians(), phi.to_radians()), direction(o.to_radians(), 0.0));
            let (said, truth) = (filled.evaluate(wi, wo)[1], model.evaluate(wi, wo)[1]);
            assert!((said / truth - 1.0).abs() < 0.15, "{i} {phi} {o}: {said} for {truth}");
            assert_eq!(filled.measured(wi, wo), 0.0);
        }
        let again = export::merl(&filled).unwrap().bytes;
        assert!((parse(&again).unwrap().missing() / missing - 1.0).abs() < 0.01);
    }
}
