//! Errors over one another, and their uncertainty.

use srbf_reference_renderer::study::comparison::report::short;
use srbf_reference_renderer::study::comparison::{Comparison, Curve, Estimate};

/// Error of one method over that of another.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ratio {
    /// After the same time of processors.
    pub time: Option<Estimate>,
    /// After the same samples.
    pub samples: Option<Estimate>,
}

/// Whether a ratio is certainly below 1, certainly above, or neither.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Certain {
    Better,
    Worse,
    Open,
}

/// How many standard errors a mean of a number of repeats may be off, nineteen times of twenty: Student's t for the degrees of
/// freedom of two such means.
pub fn t_factor(repeats: u32) -> f64 {
    const FACTORS: [f64; 10] = [4.30, 2.78, 2.45, 2.31, 2.23, 2.18, 2.14, 2.12, 2.10, 2.09];
    FACTORS.get(repeats.saturating_sub(2) as usize).copied().unwrap_or(2.09)
}

impl Ratio {
    /// Of two methods by their names; nothing where one was not run, or an error is not known.
    pub fn of(comparison: &Comparison, method: &str, base: &str) -> Self {
        let curve = |name: &str| -> Option<&Curve> { comparison.curve(name.parse().ok()?) };
        let (Some(method), Some(base)) = (curve(method), curve(base)) else { return Self::default() };
        Self {
            time: after_time(method, base),
            samples: last(method).zip(last(base)).map(|(a, b)| a.1.over(b.1)),
        }
    }
}

/// Errors over one another after the time that the last point of the base took.
fn after_time(method: &Curve, base: &Curve) -> Option<Estimate> {
    let (samples, of_base) = last(base)?;
    // As many samples as the method makes in the time of the base.
    let as_many = samples * seconds_per_sample(base)? / seconds_per_sample(method)?;
    Some(at(method, as_many)?.over(of_base))
}

/// Samples of the last point, and its error.
fn last(curve: &Curve) -> Option<(f64, Estimate)> {
    let point = curve.points.last()?;
    Some((f64::from(point.samples), point.known()?))
}

/// Time of processors of one more sample of all pixels: between the last two points, so that work done once does not count.
pub fn seconds_per_sample(curve: &Curve) -> Option<f64> {
    let [.., before, after] = &curve.points[..] else { return None };
    let seconds = (after.seconds - before.seconds) / f64::from(after.samples.saturating_sub(before.samples));
    (seconds > 0.0 && seconds.is_finite()).then_some(seconds)
}

/// The error after a number of samples, along the line through the logarithms of the last two points.
fn at(curve: &Curve, samples: f64) -> Option<Estimate> {
    let [.., before, after] = &curve.points[..] else { return None };
    let (first, mse) = (before.known()?, after.known()?);
    let [from, to] = [before, after].map(|point| f64::from(point.samples));
    let slope = ((mse.mean / first.mean).ln() / (to / from).ln()).clamp(-2.0, 0.0);
    let factor = (samples / to).powf(slope);
    Some(Estimate { mean: mse.mean * factor, error: mse.error * factor })
}

/// The certainty of a ratio; `t` standard errors have to lie between it and 1.
pub fn certain(ratio: Estimate, t: f64) -> Certain {
    let off = ratio.mean.ln() * ratio.mean;
    match off.abs() > t * ratio.error {
        true if off < 0.0 => Certain::Better,
        true => Certain::Worse,
        false => Certain::Open,
    }
}

/// Many ratios in a line: their geometric mean, least and largest, and how many are certain.
pub struct Several {
    pub count: usize,
    pub mean: f64,
    pub range: [f64; 2],
    pub better: usize,
    pub worse: usize,
}

impl Several {
    /// `None` of none.
    pub fn of(ratios: &[Estimate], t: f64) -> Option<Self> {
        let count = ratios.len();
        let means = || ratios.iter().map(|ratio| ratio.mean);
        let is = |wanted| ratios.iter().filter(|ratio| certain(**ratio, t) == wanted).count();
        (count > 0).then(|| Self {
            count,
            mean: (means().map(f64::ln).sum::<f64>() / count as f64).exp(),
            range: [means().fold(f64::INFINITY, f64::min), means().fold(0.0, f64::max)],
            better: is(Certain::Better),
            worse: is(Certain::Worse),
        })
    }

    /// Mean, range, and wins and losses.
    pub fn text(&self) -> String {
        let [least, most] = self.range.map(short);
        let Self { count, better, worse, .. } = self;
        format!("{} ({least} to {most}); {better} better, {worse} worse of {count}", short(self.mean))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::imagined::{curve, point};

    #[test]
    fn what_is_made_once_does_not_count_as_time() {
        // 1 s made once; then 0.1 s a sample beside 0.2 s, the same error after the same samples.
        let errors = |once: f64, each: f64| {
            curve(
                [16u32, 64].map(|n| point(n, once + each * f64::from(n), 1.0 / f64::from(n).sqrt())).to_vec(),
            )
        };
        let found = after_time(&errors(1.0, 0.1), &errors(0.0, 0.2)).unwrap();
        assert!((found.mean - 0.5).abs() < 1e-9, "{}", found.mean);
    }

    #[test]
    fn what_is_within_the_error_is_open() {
        let at = |mean, error| certain(Estimate { mean, error }, t_factor(5));
        assert_eq!(
            [at(0.8, 0.05), at(1.3, 0.05), at(0.9, 0.05)],
            [Certain::Better, Certain::Worse, Certain::Open]
        );
        // Few repeats make the same ratio open.
        assert_eq!(certain(Estimate { mean: 0.8, error: 0.05 }, t_factor(2)), Certain::Open);
        let several = [0.5, 2.0].map(|mean| Estimate { mean, error: 0.01 });
        assert_eq!(Several::of(&several, 2.0).unwrap().text(), "1.00 (0.50 to 2.00); 1 better, 1 worse of 2");
        assert!(Several::of(&[], 2.0).is_none());
    }
}
