//! A function whose means over patches are given values.
//!
//! It is linear between the middles of patches of both directions. Its values there are found by multiplications that take the means to
//! the data and keep every value above 0. Light that goes straight through, or is reflected as by a mirror, within less than a patch, is
//! a lobe of its own: a patch that is brighter than all beside it has one.

use super::{Basis, PatchMatrix};
use crate::table::{Brdf, Symmetry};
use std::f64::consts::{PI, TAU};

/// Standard deviation of light that is narrower than a patch, radians: 1.5 degrees, a Gaussian that a patch of 8 degrees holds.
const NARROW: f64 = 1.5 * PI / 180.0;

/// A patch is brighter than all beside it from this factor on.
const BRIGHTER: f64 = 1.25;

/// Multiplications of the values.
const STEPS: usize = 60;

/// Relative difference from the mean over all turns up to which a sheet is isotropic, and up to which halves and quarters are equal.
const ISOTROPIC: f64 = 0.15;
const EQUAL: f64 = 0.02;

/// Nodes of the azimuth of an isotropic sheet over half a turn, and turns that are averaged.
const AZIMUTHS: usize = 37;
const TURNS: usize = 72;

/// A function, f of two directions above the horizon, whose means over patches are given values: a quarter of a sheet.
#[derive(Clone, Debug)]
pub struct OfPatches {
    outgoing: Basis,
    incident: Basis,
    /// Values at the middles, `[outgoing][incident]`; and amplitudes of the narrow lobes.
    values: Vec<f64>,
    narrow: Vec<f64>,
    /// Of an isotropic sheet, values `[incident ring][outgoing ring][azimuth]`, amplitudes of each ring of incident directions.
    round: Option<(Vec<f64>, Vec<f64>)>,
    symmetry: Symmetry,
    /// Relative distance of the values from their mean over all turns.
    unevenness: f64,
}

/// The f of a narrow lobe of `f cos` about an axis, of integral 1.
fn narrow_lobe(axis: [f64; 3], d: [f64; 3]) -> f64 {
    const SHARPNESS: f64 = 1.0 / (NARROW * NARROW);
    let apart: f64 = (0..3).map(|k| (axis[k] - d[k]).powi(2)).sum();
    SHARPNESS / TAU * libm::exp(-0.5 * SHARPNESS * apart) / axis[2].max(0.05)
}

/// The mirror direction of one.
fn mirror([x, y, z]: [f64; 3]) -> [f64; 3] {
    [-x, -y, z]
}

impl OfPatches {
    /// Finds the function.
    pub fn new(matrix: &PatchMatrix) -> Self {
        let PatchMatrix { outgoing, incident, .. } = matrix;
        let mut values: Vec<f64> = matrix.values.iter().map(|v| v.max(0.0)).collect();
        let columns = incident.len();
        let points: Vec<Vec<[f64; 3]>> = (0..outgoing.len()).map(|r| outgoing.points(r)).collect();
        let mean = |r: usize, f: &dyn Fn([f64; 3]) -> f64| {
            points[r].iter().map(|d| f(*d)).sum::<f64>() / points[r].len() as f64
        };
        // Narrow lobes first, and then the rest.
        let mut narrow = vec![0.0; columns];
        for (c, amplitude) in narrow.iter_mut().enumerate() {
            let axis = mirror(incident.light(c));
            let place = outgoing.patch_of(axis);
            let at = |r: usize| r * columns + c;
            let beside = outgoing.beside(place).into_iter().map(|r| values[at(r)]).fold(0.0, f64::max);
            let excess = values[at(place)] - BRIGHTER * beside;
            // The light of the excess, whatever of the lobe lies in other patches.
            let light = |r: usize| mean(r, &|d| narrow_lobe(axis, d)) * outgoing.projected(r);
            let all: f64 = (0..outgoing.len()).map(light).sum();
            if excess <= 0.0 || all <= 0.0 {
                continue;
            }
            *amplitude = excess * outgoing.projected(place) / all;
            for r in outgoing.beside(place).into_iter().chain([place]) {
                let lobe = *amplitude * mean(r, &|d| narrow_lobe(axis, d));
                values[at(r)] = (values[at(r)] - lobe).max(0.0);
            }
        }
        // Shares of the values at middles in the mean of each patch.
        let shares: Vec<Vec<(usize, f64)>> =
            points.iter().map(|points| mean_shares(outgoing, points)).collect();
        let data = values.clone();
        for _ in 0..STEPS {
            refine(&mut values, &data, &shares, columns);
        }
        let mut found = Self {
            outgoing: outgoing.clone(),
            incident: incident.clone(),
            values,
            narrow,
            round: None,
            symmetry: Symmetry::None,
            unevenness: 0.0,
        };
        found.round = Some(found.rounded());
        found.unevenness = PatchMatrix::of(outgoing, incident, |wi, wo| found.f(wi, wo)).distance(matrix);
        if found.unevenness > ISOTROPIC {
            found.round = None;
            found.symmetry = found.symmetry_of();
        } else {
            found.symmetry = Symmetry::Isotropic;
        }
        found
    }

    /// Relative distance of the data from their mean over all turns: 0 of an isotropic sheet.
    pub fn unevenness(&self) -> f64 {
        self.unevenness
    }

    /// The same with all values times a factor.
    #[must_use]
    pub fn scaled(mut self, by: f64) -> Self {
        let round = self.round.iter_mut().flat_map(|(values, narrow)| values.iter_mut().chain(narrow));
        self.values.iter_mut().chain(&mut self.narrow).chain(round).for_each(|v| *v *= by);
        self
    }

    /// The values and amplitudes as means over all turns.
    fn rounded(&self) -> (Vec<f64>, Vec<f64>) {
        let (rows, columns) = (self.outgoing.rings(), self.incident.rings());
        let mut values = Vec::with_capacity(rows.len() * columns.len() * AZIMUTHS);
        for i in columns {
            for o in rows {
                for n in 0..AZIMUTHS {
                    let between = PI * n as f64 / (AZIMUTHS - 1) as f64;
                    let at = |turn: usize| {
                        let phi = TAU * turn as f64 / TURNS as f64;
                        let wi = crate::table::direction(i.theta, phi);
                        [between, -between]
                            .map(|b| self.between(wi, crate::table::direction(o.theta, phi + b)))
                    };
                    let sum: f64 = (0..TURNS).flat_map(at).sum();
                    values.push(sum / (2 * TURNS) as f64);
                }
            }
        }
        let mut first = 0;
        let ring = |count: usize| {
            let own = &self.narrow[first..first + count];
            first += count;
            own.iter().sum::<f64>() / count as f64
        };
        (values, columns.iter().map(|r| r.count).map(ring).collect())
    }

    /// The part without narrow lobes, of the values at middles.
    fn between(&self, wi: [f64; 3], wo: [f64; 3]) -> f64 {
        let (from, to) = (self.incident.nodes(mirror(wi)), self.outgoing.nodes(wo));
        let row = |(r, share): (usize, f64)| {
            let at = |(c, part): (usize, f64)| part * self.values[r * self.incident.len() + c];
            share * from.into_iter().map(at).sum::<f64>()
        };
        to.into_iter().map(row).sum()
    }

    /// The same of an isotropic sheet.
    fn round_between(&self, values: &[f64], wi: [f64; 3], wo: [f64; 3]) -> f64 {
        let turn = libm::atan2(wi[0] * wo[1] - wi[1] * wo[0], wi[0] * wo[0] + wi[1] * wo[1]).abs();
        let place = turn / PI * (AZIMUTHS - 1) as f64;
        let n = (place as usize).min(AZIMUTHS - 2);
        let part = place - n as f64;
        let (from, to) = (self.incident.rings_beside(wi), self.outgoing.rings_beside(wo));
        let mut sum = 0.0;
        for (i, a) in from {
            for (o, b) in to {
                let at = (i * self.outgoing.rings().len() + o) * AZIMUTHS + n;
                sum += a * b * ((1.0 - part) * values[at] + part * values[at + 1]);
            }
        }
        sum
    }

    fn f(&self, wi: [f64; 3], wo: [f64; 3]) -> f64 {
        let (broad, amplitude) = match &self.round {
            Some((values, narrow)) => {
                let amplitude: f64 = self.incident.rings_beside(wi).iter().map(|&(i, a)| a * narrow[i]).sum();
                (self.round_between(values, wi, wo), amplitude)
            }
            None => {
                let nodes = self.incident.nodes(mirror(wi));
                (self.between(wi, wo), nodes.iter().map(|&(c, share)| share * self.narrow[c]).sum())
            }
        };
        broad + if amplitude > 0.0 { amplitude * narrow_lobe(mirror(wi), wo) } else { 0.0 }
    }

    /// Which mirrors and turns leave it as it is.
    fn symmetry_of(&self) -> Symmetry {
        let at_middles = |image: &dyn Fn([f64; 3]) -> [f64; 3]| {
            PatchMatrix::at_middles(&self.outgoing, &self.incident, |wi, wo| self.f(image(wi), image(wo)))
        };
        let own = at_middles(&|d| d);
        let is_equal = |image: &dyn Fn([f64; 3]) -> [f64; 3]| at_middles(image).distance(&own) <= EQUAL;
        let half = is_equal(&mirror);
        match half {
            true if is_equal(&|[x, y, z]| [-x, y, z]) => Symmetry::Quadrant,
            true => Symmetry::HalfTurn,
            false => Symmetry::None,
        }
    }
}

impl Brdf for OfPatches {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        [self.f(wi, wo); 3]
    }

    fn symmetry(&self) -> Symmetry {
        self.symmetry
    }
}

/// Shares of the values at middles in the mean over points.
fn mean_shares(basis: &Basis, points: &[[f64; 3]]) -> Vec<(usize, f64)> {
    let mut all = vec![0.0; basis.len()];
    for (n, share) in points.iter().flat_map(|d| basis.nodes(*d)) {
        all[n] += share / points.len() as f64;
    }
    all.into_iter().enumerate().filter(|(_, share)| *share > 0.0).collect()
}

/// One multiplication of the values at middles, `[outgoing][incident]`, by the ratio of the data to the means that they have.
fn refine(values: &mut [f64], data: &[f64], shares: &[Vec<(usize, f64)>], columns: usize) {
    let mut ratios = vec![0.0; values.len()];
    for (r, row) in shares.iter().enumerate() {
        for c in 0..columns {
            let mean: f64 = row.iter().map(|&(n, share)| share * values[n * columns + c]).sum();
            let wanted = data[r * columns + c];
            ratios[r * columns + c] =
                if mean > 0.0 { wanted / mean } else { f64::from(u8::from(wanted > 0.0)) };
        }
    }
    let (mut up, mut all) = (vec![0.0; values.len()], vec![0.0; shares.len()]);
    for (r, row) in shares.iter().enumerate() {
        for &(n, share) in row {
            all[n] += share;
            for c in 0..columns {
                up[n * columns + c] += share * ratios[r * columns + c];
            }
        }
    }
    for (n, value) in values.iter_mut().enumerate() {
        let all = all[n / columns];
        if all > 0.0 {
            *value *= up[n] / all;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Means over patches of ground glass: a diffuse part, a broad lobe about the straight direction, a narrow one.
    fn glass(wi: [f64; 3], wo: [f64; 3]) -> f64 {
        let axis = mirror(wi);
        let apart: f64 = (0..3).map(|k| (axis[k] - wo[k]).powi(2)).sum();
        0.05 + 0.8 * libm::exp(-12.0 * apart) + 0.1 * narrow_lobe(axis, wo)
    }

    #[test]
    fn means_over_patches_are_the_data() {
        let basis = Basis::klems_full();
        let matrix = PatchMatrix::of(&basis, &basis, glass);
        let found = OfPatches::new(&matrix);
        assert_eq!(found.symmetry(), Symmetry::Isotropic);
        let means = PatchMatrix::of(&basis, &basis, |wi, wo| found.evaluate(wi, wo)[0]);
        let off = means.distance(&matrix);
        assert!(off < 0.02, "{off}");
        for c in 0..basis.len() {
            let (sum, wanted) = (means.sum(c), matrix.sum(c));
            assert!((sum / wanted - 1.0).abs() < 0.01, "{c}: {sum} {wanted}");
        }
        // Between the middles of incident patches, values are near the truth, but for the narrow lobe.
        for (wi, wo) in [([0.3, 0.1, 0.9], [0.2, -0.5, 0.8]), ([-0.5, 0.3, 0.7], [-0.6, 0.3, 0.6])] {
            let unit = |d: [f64; 3]| {
                let length = libm::sqrt(d.iter().map(|v| v * v).sum());
                d.map(|v: f64| v / length)
            };
            let (wi, wo) = (unit(wi), unit(wo));
            let (value, truth) = (found.evaluate(wi, wo)[0], glass(wi, wo));
            assert!((value / truth - 1.0).abs() < 0.15, "{value} {truth}");
        }
    }

    #[test]
    fn a_sheet_that_a_turn_changes_keeps_its_azimuths() {
        let basis = Basis::klems_full();
        let blind = |wi: [f64; 3], wo: [f64; 3]| glass(wi, wo) * (1.0 + 0.8 * wo[1]) * (1.0 - 0.5 * wi[1]);
        let matrix = PatchMatrix::of(&basis, &basis, blind);
        let found = OfPatches::new(&matrix);
        assert_eq!(found.symmetry(), Symmetry::None);
        let means = PatchMatrix::of(&basis, &basis, |wi, wo| found.evaluate(wi, wo)[0]);
        assert!(means.distance(&matrix) < 0.02, "{}", means.distance(&matrix));
        let cross =
            |wi: [f64; 3], wo: [f64; 3]| glass(wi, wo) * (1.0 + wo[1] * wo[1]) * (1.0 + wi[1] * wi[1]);
        let found = OfPatches::new(&PatchMatrix::of(&basis, &basis, cross));
        assert_eq!(found.symmetry(), Symmetry::Quadrant);
    }

    #[test]
    fn light_the_other_way_is_the_same_function() {
        let basis = Basis::klems_full();
        let one = |wi: [f64; 3], wo: [f64; 3]| 0.2 + 0.1 * wi[1] + 0.05 * wo[0];
        let matrix = PatchMatrix::at_middles(&basis, &basis, one);
        let reversed = matrix.reversed().unwrap();
        for (r, c) in [(0, 0), (3, 90), (140, 2), (77, 20)] {
            assert!((reversed.at(r, c) - one(basis.middle(r), basis.light(c))).abs() < 1e-9);
        }
        assert_eq!(reversed.reversed().unwrap(), matrix);
    }
}
