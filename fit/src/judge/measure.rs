//! The measure of a fit: errors of the peak, and visible errors away from it.
//!
//! The relative L2 error of a view is that of its highlight: a fit may have 3 % of it, and the wrong brightness or colour on
//! most of a ball. So the report tells the two apart by the angle from the mirror direction, and one measure has
//! both: the objective of a fit, the rank in its search, and the judge of its end.
//!
//! The measure of a view is the root of `e^2 + w a^2`. e is the relative L2 error of `f cos`. `a^2` is the mean, by the projected
//! solid angle, of the squared difference of `ln(f + floor)`, f the mean of the channels: as a difference of values it is
//! `cos / pi |df|^2 / 3 / (f + floor)^2` where it is small, for every channel. The floor is a hundredth of the mean radiance, so
//! that black surroundings hardly count. From 1.5 to 15 degrees from the mirror direction it counts four times.

use crate::numeric::median::weighted_median;
use crate::table::{Sample, View, luminance};
use std::f64::consts::PI;

/// Weight of the squared error away from the peak beside that of the squared relative L2 error. With three times as much, nothing
/// more is gained there; without, golden yellow has 1.3 to 2 times the error of luminance, for no less L2.
const AWAY_WEIGHT: f64 = 0.01;
/// Floor that is added to f, over the mean radiance, albedo / pi.
const FLOOR: f64 = 0.01;
/// Least and largest factor by which logarithms differ from their tangents.
const SECANT: (f64, f64) = (0.02, 20.0);

/// Angles from the mirror direction, degrees, between which errors count more, and how much more: it is a small part of the
/// hemisphere, and people look at the surroundings of a highlight.
const SKIRT: (f64, f64) = (1.5, 15.0);
const MORE: f64 = 4.0;

/// Angle from the mirror direction, degrees, from which a direction is away from the peak.
const PEAK: f64 = 15.0;
/// Least cosine of values that are compared by their own brightness: at the horizon a share of `f cos` is a share of nothing.
const LEAST_COSINE: f64 = 0.1;

/// Mean of the channels, and 0 where that is negative.
#[doc(hidden)]
pub fn brightness(rgb: [f64; 3]) -> f64 {
    (rgb.iter().sum::<f64>() / 3.0).max(0.0)
}

/// Mean radiance under a white sky, per channel.
#[doc(hidden)]
pub fn level(albedo: [f64; 3]) -> f64 {
    albedo.iter().sum::<f64>() / 3.0 / PI
}

/// The floor that is added to f.
#[doc(hidden)]
pub fn floor(level: f64) -> f64 {
    FLOOR * level
}

/// Weight of the squared differences of `f cos`, at a direction whose f has that mean, beside those of the squared relative L2
/// error; 1 / sr is missing: the caller multiplies by the solid angle.
#[doc(hidden)]
pub fn weight(mean: f64, level: f64, cos: f64) -> f64 {
    AWAY_WEIGHT / (3.0 * PI * cos.max(1e-3) * (mean + floor(level)).powi(2))
}

/// Weight of errors at a direction for its angle from the mirror direction of a view.
#[doc(hidden)]
pub fn beside_highlight(direction: [f64; 3], theta: f64) -> f64 {
    let (sin, cos) = libm::sincos(theta);
    let from_mirror = sin * direction[0] + cos * direction[2];
    let ends = (libm::cos(SKIRT.1.to_radians()), libm::cos(SKIRT.0.to_radians()));
    if (ends.0..ends.1).contains(&from_mirror) { MORE } else { 1.0 }
}

/// Factor by which a squared difference of values counts so that it is that of the logarithms; both not negative.
pub(crate) fn secant(value: f64, data: f64, floor: f64) -> f64 {
    let ratio = (value + floor) / (data + floor);
    let apart = (ratio - 1.0).abs();
    if apart.is_nan() || apart <= 1e-4 {
        return 1.0;
    }
    let slope = libm::log(ratio.max(1e-300)) / (ratio - 1.0);
    (slope * slope).clamp(SECANT.0, SECANT.1)
}

/// The squared error of a view away from its peak, times [`AWAY_WEIGHT`]. `values`: `f cos` at every sample.
pub(crate) fn away(values: &[[f64; 3]], view: &View) -> f64 {
    let level = level(view.uncut_albedo);
    if level <= 0.0 {
        return 0.0;
    }
    let square = |(s, value): (&Sample, &[f64; 3])| {
        let cos = s.direction[2];
        let secant = secant(brightness(*value) / cos, brightness(s.rgb), floor(level));
        let distance: f64 = (0..3).map(|c| (value[c] - s.rgb[c] * cos).powi(2)).sum();
        let more = beside_highlight(s.direction, view.theta);
        s.weight * more * secant * weight(brightness(s.rgb), level, cos) * distance
    };
    view.samples.iter().zip(values).map(square).sum()
}

/// Errors of one view, by where they are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RegionErrors {
    /// Relative L2 error of `f cos` within 15 degrees of the mirror direction; NaN without a sample there, or if all are black.
    pub peak: f64,
    /// The same beyond.
    pub off_peak: f64,
    /// Median of the error of the luminance beyond 15 degrees, by the cosine. It is relative to that of the data and the floor of
    /// the measure, a hundredth of the mean radiance; NaN as above.
    pub luminance: f64,
    /// Median of the distance of colours beyond 15 degrees, by the cosine: the sum over the channels of the differences of their shares.
    pub chroma: f64,
}

/// Compares `f cos` at every sample with one view of a table.
pub(crate) fn region_errors(values: &[[f64; 3]], view: &View) -> RegionErrors {
    let (sin, cos) = libm::sincos(view.theta);
    let peak = libm::cos(PEAK.to_radians());
    let mut squares = [(0.0, 0.0); 2];
    let (mut luminances, mut chromas) = (Vec::new(), Vec::new());
    let floor = floor(level(view.uncut_albedo).max(0.0));
    for (s, &value) in view.samples.iter().zip(values) {
        let from_mirror = s.direction[0] * sin + s.direction[2] * cos;
        let is_off = from_mirror < peak;
        let data = s.rgb.map(|v| v * s.direction[2]);
        let (difference, sum) = &mut squares[usize::from(is_off)];
        for c in 0..3 {
            *difference += s.weight * (value[c] - data[c]) * (value[c] - data[c]);
            *sum += s.weight * data[c] * data[c];
        }
        if is_off && s.direction[2] > LEAST_COSINE {
            let weight = s.weight * s.direction[2];
            luminances.push((relative(luminance(value), luminance(data), floor * s.direction[2]), weight));
            chromas.push((chroma(value, data), weight));
        }
    }
    let [peak, off_peak] = squares.map(|(d, s)| if s > 0.0 { libm::sqrt(d / s) } else { f64::NAN });
    RegionErrors { peak, off_peak, luminance: weighted_median(luminances), chroma: weighted_median(chromas) }
}

/// Share of the weight of samples that have a negative channel, and relative L2 norm of `f cos` in those channels.
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

/// Error relative to the data, which may be 0, and a floor.
fn relative(value: f64, data: f64, floor: f64) -> f64 {
    (value - data).abs() / (data.abs() + floor).max(1e-9)
}

/// Sum of the differences of the shares that the channels have of the sum of their magnitudes.
pub(crate) fn chroma(value: [f64; 3], data: [f64; 3]) -> f64 {
    let shares = |rgb: [f64; 3]| {
        let sum = rgb.iter().map(|v| v.abs()).sum::<f64>().max(1e-9);
        rgb.map(|v| v / sum)
    };
    let (a, b) = (shares(value), shares(data));
    (0..3).map(|c| (a[c] - b[c]).abs()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::judge::method::FittedView;
    use crate::judge::norm::values;
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
        let view = View { theta: 0.5, samples, albedo: [1.0; 3], uncut_albedo: [1.0; 3], floor: 0.0 };
        let found = region_errors(&values(&Off, &view), &view);
        assert!((found.peak - 2.0).abs() < 0.02, "{found:?}");
        assert!((found.off_peak - 1.0).abs() < 0.02, "{found:?}");
        assert!(
            (found.luminance - (2.0 * (1.0 - 0.0722) - 1.0) / (1.0 + 0.01 / PI)).abs() < 1e-6,
            "{found:?}"
        );
        assert!((found.chroma - 2.0 / 3.0).abs() < 1e-9, "{found:?}");
    }

    /// A thousandth everywhere.
    struct Faint;

    impl FittedView for Faint {
        fn f_cos(&self, d: [f64; 3]) -> [f64; 3] {
            [0.001 * d[2]; 3]
        }
    }

    #[test]
    fn what_is_black_in_the_data_counts_by_the_floor() {
        for data in [0.0, 1e-12, -1e-12] {
            let sample =
                |i| Sample { direction: direction(0.015 * f64::from(i), 1.0), rgb: [data; 3], weight: 1.0 };
            let samples = (0..100).map(sample).collect();
            let view = View { theta: 0.5, samples, albedo: [0.3; 3], uncut_albedo: [0.3; 3], floor: 0.0 };
            let found = region_errors(&values(&Faint, &view), &view).luminance;
            assert!((found - 0.001 / (0.01 * 0.3 / PI)).abs() < 1e-6, "{data}: {found}");
        }
    }
}
