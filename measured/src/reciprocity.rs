//! Whether samples of swapped directions agree, as those of a BRDF do, and whether values are a BRDF times a cosine.
//!
//! May import: `numeric`, `row`.

pub(crate) mod pairs;

use crate::numeric::median::median;
use crate::row::{Row, Values};
use pairs::{Compared, Places};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;

/// Least number of pairs that tell of a cosine, and the least difference of the logarithms of their cosines.
const ENOUGH: usize = 10;
const APART: f64 = 0.1;

/// The logarithm of the ratio of swapped values over that of the cosines is 1 or -1 where there is one, within this.
const SLOPE: f64 = 0.15;

/// Largest share of their difference that swapped values keep without the cosine, and least difference before.
const LEFT: f64 = 0.3;
const SEEN: f64 = 0.05;

/// What swapped samples say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reciprocity {
    /// Pairs of samples whose directions are swapped, within half a degree.
    pub pairs: usize,
    /// Median of the size of the logarithm of their ratio.
    pub apart: f64,
    /// What values are, if not the BRDF itself.
    pub cosine: Option<Values>,
}

impl Reciprocity {
    pub(crate) fn of(pairs: &[Compared]) -> Option<Self> {
        let apart = median(pairs.iter().map(|p| p.log_ratio.abs()).collect())?;
        Some(Self { pairs: pairs.len(), apart, cosine: cosine(pairs) })
    }
}

/// Samples that contradict those with light and viewer exchanged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contradicted {
    /// Angle of the direction that was held, radians; their median.
    pub theta: f64,
    /// The samples over those with light and viewer exchanged: the median.
    pub ratio: f64,
    /// Pairs that say so.
    pub pairs: usize,
}

/// Angles that are one for this, radians: instruments often cannot exchange their directions exactly.
const NEARLY: f64 = 2.5 * PI / 180.0;
/// Slope of half vectors nearer to the normal than that, where values change within that angle.
const PEAK: f64 = 0.3;
/// Angles of the held direction that are taken together, radians.
const BAND: f64 = 10.0 * PI / 180.0;
/// Least difference of the logarithms; pairs of two bands, and of a band, that say something.
const CONTRADICTED: f64 = 0.4;
const OF_TWO_BANDS: usize = 5;
const OF_A_BAND: usize = 30;

/// Bands of angles of the held direction at which samples contradict those with light and viewer exchanged, where the others agree among
/// themselves: the worst is named, the others are looked at without it, and so on. `is_turned`: a turn of the sample changes its values.
pub(crate) fn contradicted(rows: &[Row], is_light_fixed: bool, is_turned: bool) -> Vec<Contradicted> {
    let is_beside = |row: &&Row| {
        let [x, y, z] = [0, 1, 2].map(|k| row.wi[k] + row.wo[k]);
        libm::hypot(x, y) > PEAK * z
    };
    let beside: Vec<Row> = rows.iter().filter(is_beside).copied().collect();
    // The angle of the first band, and the logarithm of its sample over the other's.
    let mut pairs: BTreeMap<[i32; 2], Vec<[f64; 2]>> = BTreeMap::new();
    for pair in Places::within(NEARLY, &beside, is_turned).swapped() {
        let [a, b] = pair.angles.map(|angles| angles[usize::from(!is_light_fixed)]);
        let [of_a, of_b] = [a, b].map(|angle| libm::round(angle / BAND) as i32);
        if of_a != of_b {
            pairs.entry([of_a, of_b]).or_default().push([a, pair.log_ratio]);
            pairs.entry([of_b, of_a]).or_default().push([b, -pair.log_ratio]);
        }
    }
    pairs.retain(|_, all| all.len() >= OF_TWO_BANDS);
    let mut found = Vec::new();
    loop {
        let Some((band, contradicted)) = worst(&pairs) else { return found };
        pairs.retain(|bands, _| !bands.contains(&band));
        found.push(contradicted);
    }
}

/// The band that is furthest from all others, if it is far and these are more than one.
fn worst(pairs: &BTreeMap<[i32; 2], Vec<[f64; 2]>>) -> Option<(i32, Contradicted)> {
    let middle = |all: &[[f64; 2]], n: usize| median(all.iter().map(|pair| pair[n]).collect());
    let bands: BTreeSet<i32> = pairs.keys().map(|bands| bands[0]).collect();
    let of_band = |band: i32| {
        let with: Vec<&Vec<[f64; 2]>> =
            pairs.iter().filter(|(bands, _)| bands[0] == band).map(|(_, all)| all).collect();
        let count: usize = with.iter().map(|all| all.len()).sum();
        let far = median(with.iter().filter_map(|all| middle(all, 1)).collect())?;
        let theta = median(with.iter().filter_map(|all| middle(all, 0)).collect())?;
        let says = with.len() > 1 && count >= OF_A_BAND && far.abs() > CONTRADICTED;
        says.then_some((band, Contradicted { theta, ratio: libm::exp(far), pairs: count }))
    };
    let size = |found: &(i32, Contradicted)| libm::log(found.1.ratio).abs();
    bands.into_iter().filter_map(of_band).max_by(|a, b| size(a).total_cmp(&size(b)))
}

fn cosine(pairs: &[Compared]) -> Option<Values> {
    let ratio = |p: &Compared| libm::log(p.cosines[1] / p.cosines[0]);
    let telling: Vec<&Compared> = pairs.iter().filter(|p| ratio(p).abs() > APART).collect();
    if telling.len() < ENOUGH {
        return None;
    }
    let slope = median(telling.iter().map(|p| p.log_ratio / ratio(p)).collect())?;
    let size = |slope: f64| median(telling.iter().map(|p| (p.log_ratio - slope * ratio(p)).abs()).collect());
    let (before, sign) = (size(0.0)?, slope.signum());
    let is_cosine = (slope - sign).abs() < SLOPE && before > SEEN && size(sign)? < LEFT * before;
    is_cosine.then_some(if sign > 0.0 { Values::CosineOutgoing } else { Values::CosineIncident })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::direction;

    /// Samples with the light at each of some angles, of a surface that is 0.1 of itself with the light at 80 degrees.
    fn rows(at_80: f64) -> Vec<Row> {
        let lights = [20.0, 40.0, 60.0, 80.0];
        let samples = lights.iter().flat_map(|&light| lights.map(|viewer| (light, viewer)));
        let turned =
            samples.flat_map(|(light, viewer)| (1..12).map(move |n| (light, viewer, 15.0 * f64::from(n))));
        let row = |(light, viewer, turn): (f64, f64, f64)| {
            let value = if light == 80.0 { at_80 } else { 1.0 } * (1.0 + 0.2 * (turn * 7.0 + light).sin());
            let towards = |theta: f64, phi: f64| direction(theta.to_radians(), phi.to_radians());
            // The viewer is a degree nearer to the normal, as many instruments have it.
            let (wi, wo) = (towards(light, 0.0), towards(viewer - 1.0, turn));
            Row { line: 1, wi, wo, rgb: [value; 3] }
        };
        turned.map(row).collect()
    }

    #[test]
    fn samples_of_one_angle_contradict_all_others() {
        let found = contradicted(&rows(0.1), true, false);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(
            (found[0].theta.to_degrees() - 80.0).abs() < 1.1 && (found[0].ratio - 0.1).abs() < 0.03,
            "{found:?}"
        );
        assert!(contradicted(&rows(0.9), true, false).is_empty());
        // With the roles exchanged it is the viewer at 80 degrees.
        let swapped: Vec<Row> =
            rows(10.0).into_iter().map(|row| Row { wi: row.wo, wo: row.wi, ..row }).collect();
        let found = contradicted(&swapped, false, false);
        assert!(found.len() == 1 && (found[0].ratio - 10.0).abs() < 3.0, "{found:?}");
    }
}
