//! Peaks of a view in the plane of incidence: the highest, and others that are narrow and stand alone.
//!
//! Directions lie densely about the highest peak alone. A second peak that is narrow falls between the directions of the
//! hemisphere, and so a fit without it would seem to be good. A wide one needs no directions of its own.

use std::f64::consts::FRAC_PI_2;

/// Steps of the search along the plane of incidence, and smallest distance from the mirror direction, radians.
const SEARCH: usize = 720;
const CLOSEST: f64 = 1e-4;
/// Angle from the horizon at which the search ends, radians.
const END: f64 = 1e-3;

/// Most peaks beside the highest.
const MOST_OTHERS: usize = 2;
/// Least height of another peak over that of the highest. On the steps of the search a needle may seem to be a fifth as high.
const LEAST: f64 = 0.02;
/// Largest half width of another peak, radians: wider ones are met by the directions of the hemisphere.
const NARROW: f64 = 0.07;
/// Half widths from another peak at which values have to be lower than its height by that factor: noise is not.
const BESIDE: f64 = 4.0;
const LOWER: f64 = 0.2;
/// Steps to either side, of which at least one has to show less than half of a peak: a closer look at every bump of noise takes time.
const ASIDE: [usize; 3] = [2, 8, 24];
/// Steps within a step of the search by which another peak is found more closely.
const CLOSER: usize = 40;

/// A peak in the plane of incidence: its angle from the normal, and the distance at which it has fallen to half, radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Peak {
    pub angle: f64,
    pub width: f64,
}

/// The highest peak of `value` first, then narrow others, the higher ones first.
pub(super) fn find(value: &dyn Fn(f64) -> f64, theta: f64) -> Vec<Peak> {
    let limit = FRAC_PI_2 - END;
    let step = 2.0 * limit / SEARCH as f64;
    let wide: Vec<(f64, f64)> = (0..SEARCH)
        .map(|i| limit * (2.0 * (i as f64 + 0.5) / SEARCH as f64 - 1.0))
        .map(|angle| (angle, value(angle)))
        .collect();
    let (highest, height) = highest(value, &wide, theta);
    let mut others: Vec<(f64, Peak)> = Vec::new();
    for i in 1..SEARCH - 1 {
        let mut top = wide[i];
        let is_lower = |n: Option<usize>| n.and_then(|n| wide.get(n)).is_none_or(|side| side.1 < 0.5 * top.1);
        let is_higher = top.1 > wide[i - 1].1 && top.1 >= wide[i + 1].1 && top.1 > LEAST * height;
        if !is_higher || !ASIDE.iter().any(|n| is_lower(i.checked_sub(*n)) && is_lower(Some(i + n))) {
            continue;
        }
        for n in 0..=2 * CLOSER {
            let angle = wide[i - 1].0 + step * n as f64 / CLOSER as f64;
            let v = value(angle);
            if v > top.1 {
                top = (angle, v);
            }
        }
        let peak = Peak { angle: top.0, width: half_width(value, top) };
        let sides = [-BESIDE, BESIDE].map(|n| peak.angle + n * peak.width);
        let stands_alone =
            sides.into_iter().filter(|side| side.abs() < limit).all(|side| value(side) < LOWER * top.1);
        let is_apart = (peak.angle - highest.angle).abs() > BESIDE * peak.width.max(highest.width);
        if stands_alone && is_apart && peak.width < NARROW {
            others.push((top.1, peak));
        }
    }
    others.sort_by(|a, b| b.0.total_cmp(&a.0));
    let others = others.into_iter().take(MOST_OTHERS).map(|other| other.1);
    std::iter::once(highest).chain(others).collect()
}

/// The highest peak, and its height.
fn highest(value: &dyn Fn(f64) -> f64, wide: &[(f64, f64)], theta: f64) -> (Peak, f64) {
    let limit = FRAC_PI_2 - END;
    let steps = 60;
    let near = (0..=steps).flat_map(|i| {
        let distance = CLOSEST * libm::pow(0.3 / CLOSEST, f64::from(i) / f64::from(steps));
        [theta - distance, theta + distance]
    });
    let near = near.filter(|a| a.abs() < limit).map(|angle| (angle, value(angle)));
    let mirror = theta.min(limit);
    let mut top = (mirror, value(mirror));
    for place in wide.iter().copied().chain(near) {
        if place.1 > top.1 {
            top = place;
        }
    }
    (Peak { angle: top.0, width: half_width(value, top) }, top.1)
}

/// Distance from the top of a peak at which values on both sides are below half.
fn half_width(value: &dyn Fn(f64) -> f64, (angle, height): (f64, f64)) -> f64 {
    let mut width = CLOSEST;
    while width < 0.5 {
        let sides = [angle - width, angle + width];
        if sides.iter().filter(|a| a.abs() < FRAC_PI_2 - END).all(|&a| value(a) < 0.5 * height) {
            break;
        }
        width *= 1.25;
    }
    width
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Peaks of some heights and sharpnesses over a base.
    fn peaks(of: &[(f64, f64, f64)], theta: f64) -> Vec<Peak> {
        let value = |angle: f64| {
            let one = |&(at, height, sharpness): &(f64, f64, f64)| {
                height * libm::exp(sharpness * (libm::cos(angle - at) - 1.0))
            };
            0.02 + of.iter().map(one).sum::<f64>()
        };
        find(&value, theta)
    }

    #[test]
    fn a_needle_beside_the_highest_peak_is_found() {
        for at in [-0.8, -0.2, 0.1234, 1.2] {
            for sharpness in [3e3, 3e4, 1e6] {
                let found = peaks(&[(0.5, 100.0, sharpness), (at, 40.0, sharpness)], 0.5);
                assert_eq!(found.len(), 2, "{at} {sharpness}: {found:?}");
                assert!(
                    (found[0].angle - 0.5).abs() < 1e-3 && (found[1].angle - at).abs() < 1e-3,
                    "{found:?}"
                );
            }
        }
    }

    #[test]
    fn wide_peaks_and_noise_are_no_needles() {
        assert_eq!(peaks(&[(0.5, 100.0, 3e4), (-0.5, 40.0, 30.0)], 0.5).len(), 1);
        assert_eq!(peaks(&[(0.5, 100.0, 3e4), (0.504, 40.0, 3e4)], 0.5).len(), 1);
        let noisy = |angle: f64| 1.0 + 0.3 * libm::sin(1e4 * angle * angle);
        assert_eq!(find(&noisy, 0.5).len(), 1);
    }
}
