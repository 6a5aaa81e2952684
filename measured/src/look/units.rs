//! Whether values are f in 1/sr. Other units show in the albedo of the completion.

use crate::complete::CompletionReport;
use crate::numeric::median::median;
use crate::row::{Row, polar};
use crate::table::albedo_bounds::{LEAST, MOST, NOTHING, albedos, is_off};
use std::f64::consts::PI;

/// Share of the hemisphere without samples up to which an albedo is believed.
const EMPTY: f64 = 0.3;

/// What values may be too large or too small by, and its name as an option takes it.
const LARGER: [(&str, f64); 6] =
    [("pi", PI), ("100", 100.0), ("100pi", 100.0 * PI), ("1000", 1e3), ("1000pi", 1e3 * PI), ("1e6", 1e6)];
const SMALLER: [(&str, f64); 4] = [("0.01", 1e-2), ("0.001", 1e-3), ("1e-4", 1e-4), ("1e-6", 1e-6)];

/// Albedos that a surface may have: an albedo in between makes a factor a candidate.
const LIKELY: [f64; 2] = [0.02, 1.02];

/// Angles within which a sample at the normal stands for all azimuths, radians, and steps of the other direction that are looked at.
const NORMAL: f64 = 12.0 * PI / 180.0;
const STEP: f64 = 15.0 * PI / 180.0;

/// The units by the albedo.
#[derive(Clone, Debug, PartialEq)]
pub struct Units {
    /// Largest albedo, luminance, where samples cover the hemisphere.
    pub most: f64,
    /// Median of these albedos.
    pub albedo: f64,
    /// What values may have to be divided by, as an option takes it, and the albedo then; empty if nothing is off.
    pub candidates: Vec<(&'static str, f64)>,
}

impl Units {
    /// Albedo of the completion; `None` where samples cover the hemisphere at no angle.
    pub(super) fn of(rows: &[Row], completion: &CompletionReport) -> Option<Self> {
        let at_normal = covers_normal(rows);
        let is_known = |theta: f64| completion.gaps.share_at(theta) < EMPTY || (theta < NORMAL && at_normal);
        let known = completion.albedo.iter().copied().filter(|(theta, _)| is_known(*theta));
        let albedos = albedos(known);
        let most = albedos.iter().copied().reduce(f64::max).filter(|most| *most > NOTHING)?;
        let albedo = median(albedos)?;
        let factors: &[(&str, f64)] = match most {
            a if a > MOST => &LARGER,
            a if a < LEAST => &SMALLER,
            _ => &[],
        };
        let with = |&(name, factor): &(&'static str, f64)| (name, albedo / factor);
        let is_likely = |candidate: &(&str, f64)| (LIKELY[0]..=LIKELY[1]).contains(&candidate.1);
        Some(Self { most, albedo, candidates: factors.iter().map(with).filter(is_likely).collect() })
    }

    /// Whether values cannot be f in 1/sr.
    pub fn is_off(&self) -> bool {
        is_off(self.most)
    }

    /// The fault in words.
    pub fn text(&self) -> String {
        let than = if self.most > MOST {
            "more than any surface"
        } else {
            "as little as a light trap or the blackest coatings do; if it is none of these, units are others"
        };
        let each = |(name, albedo): &(&str, f64)| format!("--divide {name} gives {albedo:.2}");
        let candidates: Vec<String> = self.candidates.iter().map(each).collect();
        let which =
            if candidates.is_empty() { "no usual factor explains it".into() } else { candidates.join(", ") };
        let most = match self.most {
            most if (0.01..1000.0).contains(&most) => format!("{most:.2}"),
            most => format!("{most:.2e}"),
        };
        format!("as f in 1/sr they reflect up to {most} of the light, {than}; {which}")
    }
}

/// Whether samples with one direction near the normal have the other at all angles: there they stand for all azimuths.
fn covers_normal(rows: &[Row]) -> bool {
    let mut steps = [false; 5];
    for row in rows {
        let (a, b) = (polar(row.wi), polar(row.wo));
        for (near, other) in [(a, b), (b, a)] {
            if near < NORMAL {
                steps[((other / STEP) as usize).min(steps.len() - 1)] = true;
            }
        }
    }
    steps.iter().all(|step| *step)
}
