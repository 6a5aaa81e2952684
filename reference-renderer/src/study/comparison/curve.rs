//! The error of one method, the more the longer it is rendered.

use super::error::{Bias, Estimate};
use super::method::Method;
use glam::Vec3;

/// One measurement, the mean over repeats.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Samples a pixel.
    pub samples: u32,
    /// Time of processors to render all of them.
    pub seconds: f64,
    /// Relative mean squared error without the worst pixels, and that of the reference.
    pub mse: Estimate,
    /// The same over all pixels.
    pub whole_mse: Estimate,
    /// Whether the error is no more than that of the reference itself: then it is not known.
    pub is_below_reference: bool,
}

impl Point {
    /// The error, unless the reference is too poor to tell it.
    pub fn known(&self) -> Option<Estimate> {
        let is_known = !self.is_below_reference && self.mse.mean > 0.0 && self.mse.mean.is_finite();
        is_known.then_some(self.mse)
    }

    /// Root of the error, which falls with the square root of the samples.
    pub fn rmse(&self) -> f64 {
        self.mse.mean.max(0.0).sqrt()
    }
}

/// The picture of a method at the last measurement of its first repeat.
#[derive(Clone, Debug, Default)]
pub struct Shown {
    pub samples: u32,
    pub seconds: f64,
    /// Radiance, rows from the top.
    pub picture: Vec<Vec3>,
    /// Relative error of each pixel.
    pub errors: Vec<f32>,
}

/// The measurements of one method.
#[derive(Clone, Debug)]
pub struct Curve {
    pub method: Method,
    /// What draws, in words.
    pub title: String,
    pub points: Vec<Point>,
    /// From the last point of all repeats; `None` of a single repeat.
    pub bias: Option<Bias>,
    pub shown: Shown,
}

/// Largest root mean square of ln error about a line, for its slope to mean something.
const LINE: f64 = 0.1;

/// Fewest points of a line.
const LINE_POINTS: usize = 3;

impl Curve {
    /// The points whose error is known.
    pub fn known(&self) -> impl Iterator<Item = &Point> {
        self.points.iter().filter(|p| p.known().is_some())
    }

    /// Slope of log root mean squared error against log samples, by least squares: -1/2 of independent samples. `None` where the points
    /// are too few, or lie on no line.
    pub fn slope(&self) -> Option<f64> {
        let points: Vec<[f64; 2]> =
            self.known().map(|p| [f64::from(p.samples).ln(), p.rmse().ln()]).collect();
        let n = points.len() as f64;
        let [x, y] = [0, 1].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / n);
        let covariance: f64 = points.iter().map(|p| (p[0] - x) * (p[1] - y)).sum();
        let variance: f64 = points.iter().map(|p| (p[0] - x) * (p[0] - x)).sum();
        let slope = covariance / variance;
        let off = |p: &[f64; 2]| p[1] - y - slope * (p[0] - x);
        let residual = (points.iter().map(|p| off(p) * off(p)).sum::<f64>() / n).sqrt();
        (points.len() >= LINE_POINTS && residual <= LINE).then_some(slope)
    }

    /// The error at a time, interpolated in logarithms; beyond the ends along the nearest piece, and of a single point as one over
    /// the time.
    pub fn mse_at(&self, seconds: f64) -> Option<Estimate> {
        let points: Vec<(&Point, Estimate)> =
            self.points.iter().filter_map(|p| Some((p, p.known()?))).collect();
        let after =
            points.iter().position(|(p, _)| p.seconds >= seconds).unwrap_or(points.len().max(1) - 1).max(1);
        let (a, b) = match points.as_slice() {
            [] => return None,
            [only] => (None, *only),
            _ => (Some(points[after - 1]), points[after]),
        };
        let slope = match a {
            Some((a, mse)) if b.0.seconds > a.seconds => {
                (b.1.mean / mse.mean).ln() / (b.0.seconds / a.seconds).ln()
            }
            _ => -1.0,
        };
        let mean = b.1.mean * (seconds / b.0.seconds).powf(slope);
        Some(Estimate { mean, error: b.1.error * mean / b.1.mean })
    }

    /// Time of processors that a sample of all pixels takes.
    pub fn seconds_per_sample(&self) -> Option<f64> {
        self.points.last().map(|p| p.seconds / f64::from(p.samples))
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// A point of no error bars.
    pub fn point(samples: u32, seconds: f64, rmse: f64) -> Point {
        let mse = Estimate { mean: rmse * rmse, error: 0.0 };
        Point { samples, seconds, mse, whole_mse: mse, is_below_reference: false }
    }

    /// A curve of points.
    pub fn curve(points: Vec<Point>) -> Curve {
        Curve {
            method: "lobes".parse().unwrap(),
            title: "lobes".into(),
            points,
            bias: None,
            shown: Shown::default(),
        }
    }

    #[test]
    fn interpolation_and_slope_of_a_known_curve() {
        let of = |n: u32| point(n, 0.5 * f64::from(n), 3.0 / f64::from(n).sqrt());
        let line = curve([1, 4, 16].map(of).to_vec());
        assert!((line.slope().unwrap() + 0.5).abs() < 1e-12);
        for seconds in [0.1, 0.5, 1.3, 8.0, 40.0] {
            for some in [&line, &curve(vec![of(4)])] {
                let mse = some.mse_at(seconds).unwrap().mean;
                assert!((mse - 9.0 / (2.0 * seconds)).abs() < 1e-9, "{mse}");
            }
        }
    }

    #[test]
    fn what_lies_on_no_line_has_no_slope() {
        assert_eq!(curve(vec![point(1, 1.0, 1.0), point(4, 4.0, 0.5)]).slope(), None);
        let bent = [(1, 1.0), (4, 0.5), (16, 0.45), (64, 0.44)];
        assert_eq!(curve(bent.map(|(n, e)| point(n, f64::from(n), e)).to_vec()).slope(), None);
    }

    #[test]
    fn errors_below_that_of_the_reference_are_left_out() {
        let below = Point { is_below_reference: true, ..point(64, 64.0, 0.4) };
        let points = vec![
            point(1, 1.0, 1.0),
            point(4, 4.0, 0.5),
            point(16, 16.0, 0.25),
            below,
            point(256, 256.0, f64::NAN),
        ];
        let some = curve(points);
        assert!((some.slope().unwrap() + 0.5).abs() < 1e-12);
        assert!((some.mse_at(4.0).unwrap().mean - 0.25).abs() < 1e-12);
        let none = curve(vec![below]);
        assert_eq!((none.slope(), none.mse_at(1.0)), (None, None));
    }
}
