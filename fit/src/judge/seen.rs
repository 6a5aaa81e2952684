//! What an eye sees of a fit: the peak, and what lies away from it.
//!
//! The relative L2 error of a view is that of its highlight: a fit may have 3 % of it, and the wrong brightness or colour on
//! most of a ball. So the two are told apart by the angle from the mirror direction.

use crate::judge::method::FittedView;
use crate::table::{Sample, View};
use srbf_core::LUMINANCE;

/// Angle from the mirror direction, degrees, from which a direction is away from the peak.
const PEAK: f64 = 15.0;
/// Angle from the mirror direction, degrees, up to which colours are compared: farther, tables of measurements are dark and noisy.
const RING: f64 = 60.0;
/// Least cosine of what is compared by its own brightness: at the horizon a share of `f cos` is a share of nothing.
const LEAST_COSINE: f64 = 0.1;

/// Errors of one view, by where they are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seen {
    /// Relative L2 error of `f cos` within 15 degrees of the mirror direction; NaN without a sample there, or if all are black.
    pub peak: f64,
    /// The same beyond.
    pub off_peak: f64,
    /// Median of the relative error of the luminance beyond 15 degrees, by the cosine; NaN as above.
    pub luminance: f64,
    /// Median of the distance of colours from 15 to 60 degrees: the sum over the channels of the differences of their shares.
    pub chroma: f64,
}

/// Compares a fit with one view of a table.
pub(crate) fn seen(fitted: &dyn FittedView, view: &View) -> Seen {
    let (sin, cos) = libm::sincos(view.theta);
    let (peak, far) = (libm::cos(PEAK.to_radians()), libm::cos(RING.to_radians()));
    let mut squares = [(0.0, 0.0); 2];
    let (mut luminances, mut chromas) = (Vec::new(), Vec::new());
    for s in &view.samples {
        let from_mirror = s.direction[0] * sin + s.direction[2] * cos;
        let is_off = from_mirror < peak;
        let data = s.rgb.map(|v| v * s.direction[2]);
        let value = fitted.f_cos(s.direction);
        let (difference, sum) = &mut squares[usize::from(is_off)];
        for c in 0..3 {
            *difference += s.weight * (value[c] - data[c]) * (value[c] - data[c]);
            *sum += s.weight * data[c] * data[c];
        }
        if is_off && s.direction[2] > LEAST_COSINE {
            let weight = s.weight * s.direction[2];
            luminances.push((relative(luminance(value), luminance(data)), weight));
            if from_mirror > far {
                chromas.push((chroma(value, data), weight));
            }
        }
    }
    let [peak, off_peak] = squares.map(|(d, s)| if s > 0.0 { libm::sqrt(d / s) } else { f64::NAN });
    Seen { peak, off_peak, luminance: median(luminances), chroma: median(chromas) }
}

/// Share of the squared norm of `f cos` in negative channels, and share of the weight of samples that have one.
pub(crate) fn negatives(samples: &[Sample]) -> (f64, f64) {
    let (mut below, mut square, mut count, mut all) = (0.0, 0.0, 0.0, 0.0);
    for s in samples {
        let z = s.direction[2];
        for v in s.rgb {
            square += s.weight * v * v * z * z;
            below += if v < 0.0 { s.weight * v * v * z * z } else { 0.0 };
        }
        all += s.weight;
        count += if s.rgb.iter().any(|v| *v < 0.0) { s.weight } else { 0.0 };
    }
    let share = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 0.0 };
    (share(count, all), libm::sqrt(share(below, square)))
}

fn luminance(rgb: [f64; 3]) -> f64 {
    (0..3).map(|c| f64::from(LUMINANCE[c]) * rgb[c]).sum()
}

fn relative(value: f64, data: f64) -> f64 {
    (value - data).abs() / data.abs().max(1e-9)
}

/// Sum of the differences of the shares that the channels have of the sum of their magnitudes.
fn chroma(value: [f64; 3], data: [f64; 3]) -> f64 {
    let shares = |rgb: [f64; 3]| {
        let sum = rgb.iter().map(|v| v.abs()).sum::<f64>().max(1e-9);
        rgb.map(|v| v / sum)
    };
    let (a, b) = (shares(value), shares(data));
    (0..3).map(|c| (a[c] - b[c]).abs()).sum()
}

/// Weighted median; NaN of nothing.
fn median(mut values: Vec<(f64, f64)>) -> f64 {
    values.retain(|v| v.1 > 0.0);
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * values.iter().map(|v| v.1).sum::<f64>();
    let mut sum = 0.0;
    let middle = values.iter().find(|v| {
        sum += v.1;
        sum >= half
    });
    middle.map_or(f64::NAN, |v| v.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::direction;

    /// Three times the data within the peak; beyond, twice the data, in another colour.
    struct Off;

    impl FittedView for Off {
        fn f_cos(&self, d: [f64; 3]) -> [f64; 3] {
            if d[0] * libm::sin(0.5) + d[2] * libm::cos(0.5) > 0.966 {
                [3.0 * d[2]; 3]
            } else {
                [2.0 * d[2], 2.0 * d[2], 0.0]
            }
        }
    }

    #[test]
    fn what_is_off_the_peak_is_told_apart() {
        let spread = (0..80).flat_map(|t| (0..60).map(move |p| (f64::from(t) / 51.0, f64::from(p) / 19.0)));
        let sample =
            |(t, p): (f64, f64)| Sample { direction: direction(t, p), rgb: [1.0; 3], weight: libm::sin(t) };
        let samples = spread.map(sample).collect();
        let view = View { theta: 0.5, samples, albedo: [1.0; 3], uncut_albedo: [1.0; 3] };
        let found = seen(&Off, &view);
        assert!((found.peak - 2.0).abs() < 0.02, "{found:?}");
        assert!((found.off_peak - 1.0).abs() < 0.02, "{found:?}");
        assert!((found.luminance - (2.0 * (1.0 - 0.0722) - 1.0)).abs() < 1e-3, "{found:?}");
        assert!((found.chroma - 2.0 / 3.0).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn the_median_is_by_weight() {
        assert_eq!(median(vec![(3.0, 1.0), (1.0, 1.0), (2.0, 5.0)]), 2.0);
        assert_eq!(median(vec![(3.0, 9.0), (1.0, 1.0), (2.0, 5.0)]), 3.0);
        assert!(median(vec![]).is_nan());
    }
}
