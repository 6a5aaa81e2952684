//! The thesis's claim: 300 samples of lobes are at or below the error of 1200 of Lafortune's.

use srbf_reference_renderer::study::comparison::{Comparison, Estimate};

/// Samples of the method that is to be caught up with.
pub const SAMPLES: u32 = 300;

/// Samples of Lafortune's that the thesis set beside them.
pub const CLAIMED: f64 = 1200.0;

/// The count of samples at which Lafortune's error falls to that of 300 samples of another method, and its standard error; `None` where
/// an error is not known.
///
/// Samples are independent, and the methods unbiased: the mean squared error falls as one over the count. So the count is that at which
/// Lafortune's error was measured last, times the ratio of the errors.
pub fn catches_up(comparison: &Comparison, lafortune: usize, other: usize) -> Option<Estimate> {
    let last = comparison.curves[lafortune].points.last()?;
    let at = comparison.curves[other].points.iter().find(|point| point.samples == SAMPLES)?;
    let Estimate { mean, error } = last.known()?.over(at.known()?);
    let samples = f64::from(last.samples);
    Some(Estimate { mean: samples * mean, error: samples * error })
}

/// Whether a count bears the claim out: not by less than twice its standard error.
pub fn holds(count: Estimate) -> &'static str {
    match count.mean - CLAIMED {
        more if more > 2.0 * count.error => "yes",
        less if less < -2.0 * count.error => "no",
        _ => "within the error",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::imagined::{curve, point};
    use srbf_reference_renderer::study::comparison::ReferenceReport;

    #[test]
    fn counts_follow_the_ratio_of_the_errors() {
        // Twice the error of the root at four times the samples: sixteen times as many are needed.
        let lafortune = curve(vec![point(300, 1.0, 0.4), point(1200, 4.0, 0.2)]);
        let other = curve(vec![point(100, 1.0, 0.17), point(300, 3.0, 0.1)]);
        let comparison = Comparison {
            scene: "sphere",
            material: String::new(),
            environment: String::new(),
            size: [1, 1],
            curves: vec![lafortune, other],
            reference: ReferenceReport::default(),
        };
        let count = catches_up(&comparison, 0, 1).unwrap();
        assert!((count.mean - 4800.0).abs() < 1e-6 && count.error == 0.0, "{count:?}");
        assert_eq!(holds(count), "yes");
        assert_eq!(holds(Estimate { mean: 700.0, error: 100.0 }), "no");
        assert_eq!(holds(Estimate { mean: 1100.0, error: 100.0 }), "within the error");
    }
}
