//! Where samples say nothing.

use crate::complete::tuning::gaps::{DIRECTIONS, MOST, NEAR, STEP};
use crate::numeric::GOLDEN_ANGLE;
use crate::table::{Table, direction};
use std::f64::consts::PI;

/// Where samples say nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gaps {
    /// For angles of the outgoing direction, degrees: share of the projected solid angle with no sample within 20 degrees, in neither
    /// direction, either way round.
    pub shares: Vec<(f64, f64)>,
}

impl Gaps {
    /// Mean over the angles.
    pub fn mean(&self) -> f64 {
        self.shares.iter().map(|s| s.1).sum::<f64>() / self.shares.len().max(1) as f64
    }

    /// Angles, degrees, at which most of the hemisphere has no sample near: the first and the last of each run.
    pub fn empty(&self) -> Vec<(f64, f64)> {
        let mut runs: Vec<(f64, f64)> = Vec::new();
        for pair in self.shares.iter().filter(|s| s.1 > 0.5) {
            match runs.last_mut() {
                Some(run) if (pair.0 - run.1 - STEP as f64).abs() < 0.1 => run.1 = pair.0,
                _ => runs.push((pair.0, pair.0)),
            }
        }
        runs
    }

    /// The share, in words.
    pub fn text(&self) -> String {
        let empty: Vec<String> =
            self.empty().iter().map(|(from, to)| format!("{from:.0} to {to:.0}")).collect();
        let views = match empty.as_slice() {
            [] => String::new(),
            runs => format!("; most of it at views of {} degrees", runs.join(", ")),
        };
        format!("no sample within 20 degrees: {:.0} % of all pairs of directions{views}", 100.0 * self.mean())
    }
}

/// Looks where a table has no samples.
pub(super) fn gaps(table: &Table) -> Gaps {
    let total: usize = table.views.iter().map(|v| v.samples.len()).sum();
    let every = total.div_ceil(MOST).max(1);
    let samples = table.views.iter().flat_map(|v| v.samples.iter().map(move |s| (v.theta, s.direction)));
    // Both ways: seen from the incident direction, the outgoing one is on the other side of the same plane.
    let both = samples.step_by(every).flat_map(|(theta, d)| {
        let (other, azimuth) = (libm::acos(d[2]), libm::atan2(d[1], d[0]));
        [(theta, d), (other, direction(theta, azimuth))]
    });
    let both: Vec<(f64, [f64; 3])> = both.collect();
    let share = |degrees: usize| {
        let theta = (degrees as f64).to_radians();
        let near: Vec<[f64; 3]> =
            both.iter().filter(|(t, _)| (t - theta).abs() < NEAR).map(|(_, d)| *d).collect();
        let (mut empty, mut all) = (0.0, 0.0);
        for i in 0..DIRECTIONS {
            let cos = libm::sqrt((i as f64 + 0.5) / DIRECTIONS as f64);
            let d = direction(libm::acos(cos), (GOLDEN_ANGLE * i as f64) % PI);
            let is_near = |s: &[f64; 3]| {
                let dot = d[0] * s[0] + (d[1] * s[1]).abs() + d[2] * s[2];
                dot > libm::cos(NEAR)
            };
            all += 1.0;
            empty += f64::from(u8::from(!near.iter().any(is_near)));
        }
        (degrees as f64, empty / all)
    };
    Gaps { shares: (0..90).step_by(STEP).map(share).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::Scattered;

    #[test]
    fn one_view_leaves_the_others_empty_but_for_what_reciprocity_says() {
        let around = (0..400).map(|i| direction(1.5 * (0.618 * f64::from(i)).fract(), f64::from(i)));
        let scattered: Scattered = around.map(|d| (d, [0.1; 3])).collect();
        let gaps = gaps(&Table::from_scattered(vec![(0.1, scattered)]).unwrap());
        let at = |degrees: f64| gaps.shares.iter().find(|s| s.0 == degrees).unwrap().1;
        assert!(at(5.0) < 0.05, "{gaps:?}");
        // From 60 degrees, light from near the normal alone is known.
        assert!(at(60.0) > 0.7 && at(60.0) < 0.95, "{gaps:?}");
        assert!(gaps.empty().last().unwrap().1 == 85.0 && gaps.mean() > 0.3);
    }
}
