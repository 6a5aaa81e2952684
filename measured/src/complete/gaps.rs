//! Where nothing was measured.

use crate::complete::tuning::gaps::{DIRECTIONS, MOST, NEAR, STEP};
use crate::numeric::GOLDEN_ANGLE;
use crate::row::{Row, polar};
use crate::table::{Brdf, Table, direction};
use serde_json::{Value, json};
use std::f64::consts::PI;

/// Where nothing was measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gaps {
    /// For angles of the outgoing direction, degrees: a share of the projected solid angle. Of samples, that with no sample within
    /// 20 degrees, in neither direction, either way round. Of a table, that without a value.
    pub shares: Vec<(f64, f64)>,
    /// Whether it is of a table, which has values or has none.
    pub is_of_table: bool,
}

/// Turns of the sample that are looked at.
const TURNS: usize = 8;

/// Shares as people say them.
const SHARES: [(f64, &str); 9] = [
    (0.1, "a tenth"),
    (0.2, "a fifth"),
    (0.25, "a quarter"),
    (1.0 / 3.0, "a third"),
    (0.5, "half"),
    (2.0 / 3.0, "two thirds"),
    (0.75, "three quarters"),
    (0.9, "nine tenths"),
    (1.0, "nearly all"),
];

impl Gaps {
    /// Mean over the angles.
    pub fn mean(&self) -> f64 {
        self.shares.iter().map(|s| s.1).sum::<f64>() / self.shares.len().max(1) as f64
    }

    /// The share at the angle that is closest to one, radians; 1 where there is none.
    pub fn share_at(&self, theta: f64) -> f64 {
        let apart = |share: &&(f64, f64)| (share.0.to_radians() - theta).abs();
        self.shares.iter().min_by(|a, b| apart(a).total_cmp(&apart(b))).map_or(1.0, |share| share.1)
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

    /// Looks where a table has no values.
    pub fn of_table(brdf: &dyn Brdf) -> Self {
        let share = |degrees: usize| {
            let wo = direction((degrees as f64).to_radians(), PI);
            let missing = |wi: [f64; 3]| {
                let is_number = brdf.evaluate(wi, wo).iter().all(|v| v.is_finite());
                if is_number { 1.0 - brdf.measured(wi, wo) } else { 1.0 }
            };
            let all: f64 = (0..DIRECTIONS).map(|i| missing(spread(i))).sum();
            (degrees as f64, all / DIRECTIONS as f64)
        };
        Self { shares: (0..90).step_by(STEP).map(share).collect(), is_of_table: true }
    }

    /// Views, in words, at which most of the hemisphere was not measured; empty for none, and for all.
    fn views(&self) -> String {
        let run = |(from, to): &(f64, f64)| {
            if from == to { format!("{from:.0}") } else { format!("{from:.0} to {to:.0}") }
        };
        let empty: Vec<String> = self.empty().iter().map(run).collect();
        let is_everywhere = self.shares.iter().all(|share| share.1 > 0.5);
        match empty.as_slice() {
            [] => String::new(),
            _ if is_everywhere => String::new(),
            runs => format!("most of it at views of {} degrees", runs.join(", ")),
        }
    }

    /// The share, in numbers.
    pub fn text(&self) -> String {
        let what = if self.is_of_table { "no value" } else { "no sample within 20 degrees" };
        let views = self.views();
        let views = if views.is_empty() { views } else { format!("; {views}") };
        format!("{what}: {:.0} % of all pairs of directions{views}", 100.0 * self.mean())
    }

    /// The same, as people say it.
    pub fn words(&self) -> String {
        let apart = |share: &(f64, &str)| (share.0 - self.mean()).abs();
        let near = SHARES.iter().min_by(|a, b| apart(a).total_cmp(&apart(b)));
        let share = near.map_or("a part", |share| share.1);
        let about = if self.mean() > 0.95 { "" } else { "about " };
        let of = if self.is_of_table { "the table was" } else { "all pairs of directions were" };
        let views = self.views();
        let views = if views.is_empty() { views } else { format!(" ({views})") };
        format!("{about}{share} of {of} not measured{views}; there the fit is a guess")
    }

    #[doc(hidden)]
    pub fn to_json(&self) -> Value {
        json!({
            "of": if self.is_of_table { "a table without values" } else { "samples, none within 20 degrees" },
            "share": self.mean(),
            "shares_by_view_degrees": self.shares.iter().map(|s| [s.0, s.1]).collect::<Vec<_>>(),
            "mostly_empty_views_degrees": self.empty().iter().map(|run| [run.0, run.1]).collect::<Vec<_>>(),
        })
    }
}

/// An incident direction, of all that are evenly spread over the projected solid angle of half a hemisphere.
fn spread(i: usize) -> [f64; 3] {
    let cos = libm::sqrt((i as f64 + 0.5) / DIRECTIONS as f64);
    direction(libm::acos(cos), (GOLDEN_ANGLE * i as f64) % PI)
}

/// Looks where a table has no samples.
pub(super) fn gaps(table: &Table) -> Gaps {
    let samples = table.views.iter().flat_map(|v| v.samples.iter().map(move |s| (v.theta, s.direction)));
    // Both ways: seen from the incident direction, the outgoing one is on the other side of the same plane.
    let both = thinned(samples.collect()).flat_map(|(theta, d)| {
        let (other, azimuth) = (libm::acos(d[2]), libm::atan2(d[1], d[0]));
        [(theta, d), (other, direction(theta, azimuth))]
    });
    around(&both.collect::<Vec<_>>())
}

/// Looks where light through a sheet has no samples, as seen from the front.
pub(super) fn gaps_of_sides(rows: &[Row]) -> Gaps {
    let azimuth = |d: [f64; 3]| libm::atan2(d[1], d[0]);
    let sample =
        |row: &Row| (polar(row.wo), direction(polar(row.wi), PI + azimuth(row.wi) - azimuth(row.wo)));
    around(&thinned(rows.iter().map(sample).collect()).collect::<Vec<_>>())
}

fn thinned<T>(samples: Vec<T>) -> impl Iterator<Item = T> {
    let every = samples.len().div_ceil(MOST).max(1);
    samples.into_iter().step_by(every)
}

/// Looks where there is no sample, of samples by the angle of the outgoing direction, and the incident one.
fn around(both: &[(f64, [f64; 3])]) -> Gaps {
    let share = |degrees: usize| {
        let theta = (degrees as f64).to_radians();
        let near: Vec<[f64; 3]> =
            both.iter().filter(|(t, _)| (t - theta).abs() < NEAR).map(|(_, d)| *d).collect();
        let (mut empty, mut all) = (0.0, 0.0);
        for i in 0..DIRECTIONS {
            let d = spread(i);
            let is_near = |s: &[f64; 3]| {
                let dot = d[0] * s[0] + (d[1] * s[1]).abs() + d[2] * s[2];
                dot > libm::cos(NEAR)
            };
            all += 1.0;
            empty += f64::from(u8::from(!near.iter().any(is_near)));
        }
        (degrees as f64, empty / all)
    };
    Gaps { shares: (0..90).step_by(STEP).map(share).collect(), is_of_table: false }
}

/// Looks where a surface that a turn changes has no samples, at several turns; `is_half`: half a turn leaves it as it is.
pub(super) fn gaps_of_turned(rows: &[Row], is_half: bool) -> Gaps {
    let both = thinned(rows.iter().collect()).flat_map(|row| [[row.wi, row.wo], [row.wo, row.wi]]);
    let pairs: Vec<[[f64; 3]; 2]> = both.collect();
    let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| a[k] * b[k]).sum::<f64>();
    let turned = |d: [f64; 3]| [-d[0], -d[1], d[2]];
    let near = libm::cos(NEAR);
    let share = |degrees: usize| {
        let mut empty = 0;
        for n in 0..TURNS {
            let wo = direction((degrees as f64).to_radians(), 2.0 * PI * n as f64 / TURNS as f64);
            let mut around: Vec<[f64; 3]> =
                pairs.iter().filter(|pair| dot(pair[1], wo) > near).map(|pair| pair[0]).collect();
            if is_half {
                let opposite = pairs.iter().filter(|pair| dot(turned(pair[1]), wo) > near);
                around.extend(opposite.map(|pair| turned(pair[0])));
            }
            // Over the whole hemisphere.
            let is_empty = |i: &usize| {
                let [x, y, z] = spread(*i);
                let d = if i.is_multiple_of(2) { [x, y, z] } else { [x, -y, z] };
                !around.iter().any(|s| dot(*s, d) > near)
            };
            empty += (0..DIRECTIONS).filter(is_empty).count();
        }
        (degrees as f64, empty as f64 / (TURNS * DIRECTIONS) as f64)
    };
    Gaps { shares: (0..90).step_by(STEP).map(share).collect(), is_of_table: false }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::Scattered;

    /// Has values where the incident direction is on one side, or near the normal.
    struct Sided(f64);

    impl Brdf for Sided {
        fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
            if wi[0] * wo[0] < 0.0 || wi[2] > self.0 { [0.1; 3] } else { [f64::NAN; 3] }
        }
    }

    #[test]
    fn a_share_without_values_is_said_in_numbers_and_in_words() {
        let half = Gaps::of_table(&Sided(1.0));
        // But for the normal, where there is no side.
        assert!((half.shares[5].1 - 0.5).abs() < 0.05 && half.shares[0].1 > 0.4, "{half:?}");
        assert!(half.words().starts_with("about half of the table was not measured"), "{}", half.words());
        assert!(half.text().starts_with("no value: 5") || half.text().starts_with("no value: 4"));
        let little = Gaps::of_table(&Sided(0.5));
        assert!(little.mean() < 0.2 && little.words().contains("there the fit is a guess"), "{little:?}");
        assert_eq!(Gaps::of_table(&Sided(-1.0)).mean(), 0.0);
    }

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
