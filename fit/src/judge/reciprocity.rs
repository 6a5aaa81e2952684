//! How far a fit is from reciprocity: f(a, b) = f(b, a).
//!
//! The pairs are a fixed spread over the hemisphere, every second one with its second direction near the mirror direction
//! of the first; to a fit that is anisotropic, the pair is turned round the normal by any angle. Of the pairs where both values are above a floor, the measure is `|ln f(a, b) / f(b, a)|` in luminance:
//! 0.1 is 10 %.

use crate::FitError;
use crate::judge::method::Fitted;
use crate::numeric::median::median;
use crate::table::direction;
use srbf_core::LUMINANCE;
use std::f64::consts::{PI, TAU};

/// Reciprocity error of a fit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reciprocity {
    /// Median of `|ln f(a, b) / f(b, a)|`.
    pub median: f64,
    /// The largest.
    pub worst: f64,
    /// Pairs above the floor.
    pub pairs: usize,
}

/// Pairs that are looked at.
const PAIRS: usize = 500;
/// Largest angle of either direction from the normal, radians: 80 degrees.
const LARGEST: f64 = 80.0 * PI / 180.0;
/// Share of the mean luminance of f over the pairs below which a value is noise.
const FLOOR: f64 = 0.05;
/// Largest distance from the mirror direction in every second pair, radians.
const NEAR: f64 = 0.35;

/// Measures a fit.
///
/// # Errors
/// As [`Fitted::view`].
pub fn reciprocity(fit: &dyn Fitted) -> Result<Reciprocity, FitError> {
    // Steps of the generalised golden ratio: every coordinate evenly spread.
    let spread = |n: usize, step: f64| (0.5 + step * n as f64).fract();
    let luminance = |theta_o: f64, turn: f64, theta_i: f64, azimuth: f64| -> Result<f64, FitError> {
        let wi = direction(theta_i, azimuth);
        let value = fit.view_at(theta_o, turn)?.f_cos(wi);
        Ok((0..3).map(|c| f64::from(LUMINANCE[c]) * value[c]).sum::<f64>() / wi[2])
    };
    let mut values = Vec::with_capacity(PAIRS);
    for n in 0..PAIRS {
        let theta_o = LARGEST * spread(n, 0.819_172_513_4);
        let (theta_i, azimuth) = if n % 2 == 0 {
            (LARGEST * spread(n, 0.671_043_606_7), PI * spread(n, 0.549_700_477_9))
        } else {
            let theta_i = theta_o + NEAR * (2.0 * spread(n, 0.671_043_606_7) - 1.0);
            (theta_i.clamp(0.02, LARGEST), NEAR * spread(n, 0.549_700_477_9))
        };
        let turn = TAU * spread(n, 0.618_033_988_75);
        // As seen from the other direction, which lies at -x in the frame of its own view.
        let back = luminance(theta_i, turn + azimuth - PI, theta_o, -azimuth)?;
        values.push([luminance(theta_o, turn, theta_i, azimuth)?, back]);
    }
    let floor = FLOOR * values.iter().flatten().sum::<f64>() / (2 * PAIRS) as f64;
    let bright = values.iter().filter(|[a, b]| *a > floor && *b > floor);
    let errors: Vec<f64> = bright.map(|[a, b]| libm::log(a / b).abs()).collect();
    let worst = errors.iter().copied().max_by(f64::total_cmp).unwrap_or(0.0);
    Ok(Reciprocity { worst, pairs: errors.len(), median: median(errors).unwrap_or(0.0) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::judge::method::FittedView;

    /// `f = 1 + tilt cos(theta_o)`, and a lobe that is the same both ways.
    struct Tilted(f64);
    struct TiltedView(f64, f64);
    impl Fitted for Tilted {
        fn view(&self, theta: f64) -> Result<Box<dyn FittedView + '_>, FitError> {
            Ok(Box::new(TiltedView(self.0, theta)))
        }
    }
    impl FittedView for TiltedView {
        fn f_cos(&self, d: [f64; 3]) -> [f64; 3] {
            let mirror = direction(self.1, 0.0);
            let lobe = libm::exp(20.0 * ((0..3).map(|k| d[k] * mirror[k]).sum::<f64>() - 1.0));
            [d[2] * (1.0 + self.0 * libm::cos(self.1) + lobe); 3]
        }
    }

    #[test]
    fn what_is_the_same_both_ways_has_no_error() {
        let found = reciprocity(&Tilted(0.0)).unwrap();
        assert!(found.worst < 1e-12 && found.pairs == PAIRS, "{found:?}");
    }

    /// Reciprocal, and another at every azimuth.
    struct Brushed;
    struct BrushedView([f64; 3], f64);
    impl Fitted for Brushed {
        fn view(&self, theta: f64) -> Result<Box<dyn FittedView + '_>, FitError> {
            self.view_at(theta, 0.0)
        }
        fn view_at(&self, theta: f64, azimuth: f64) -> Result<Box<dyn FittedView + '_>, FitError> {
            Ok(Box::new(BrushedView(direction(theta, azimuth + PI), azimuth)))
        }
    }
    impl FittedView for BrushedView {
        fn f_cos(&self, d: [f64; 3]) -> [f64; 3] {
            let (sin, cos) = libm::sincos(self.1);
            let wi = [d[0] * cos - d[1] * sin, d[0] * sin + d[1] * cos];
            let bent =
                wi[0] * self.0[0] - 2.0 * wi[1] * self.0[1] + 0.3 * (wi[0] * self.0[1] + wi[1] * self.0[0]);
            [d[2] * libm::exp(bent); 3]
        }
    }

    #[test]
    fn what_is_the_same_both_ways_at_every_azimuth_has_no_error() {
        let found = reciprocity(&Brushed).unwrap();
        assert!(found.worst < 1e-12 && found.pairs > PAIRS / 2, "{found:?}");
    }

    #[test]
    fn the_error_is_the_logarithm_of_the_ratio() {
        let found = reciprocity(&Tilted(0.1)).unwrap();
        // The largest possible is between the normal and 80 degrees.
        let most = libm::log((1.0 + 0.1) / (1.0 + 0.1 * libm::cos(LARGEST)));
        assert!(found.worst <= most && found.worst > 0.7 * most, "{found:?} {most}");
        assert!(found.median > 0.0 && found.median < found.worst, "{found:?}");
    }
}
