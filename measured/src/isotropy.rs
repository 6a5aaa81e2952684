//! Whether a surface was turned, and whether a turn matters: an isotropic surface is the same after it.
//!
//! Two processes explain the samples: one whose coordinates know nothing of a turn, and one with a term over the azimuth of the
//! half vector beside it. Only samples whose incident *and* outgoing azimuths vary were turned: left and right of one plane of
//! incidence are no turn. Samples are left out one by one. The ratio of likelihoods tells a turn that matters from noise and from
//! steep highlights, which both explain alike.
//!
//! A sample that lies on its table tilted changes with the turn too. Its directions are those of an isotropic surface once the tilt is
//! taken back. So where a turn seems to matter, the tilt is looked for that explains samples best, and the turn is held against it.
//!
//! May import: `complete`, `numeric`, `row`.

use crate::complete::pair::{COORDINATES, ISOTROPIC, Pair};
use crate::numeric::cholesky::Square;
use crate::numeric::median::median;
use crate::row::{NORMAL, Row, thin};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Samples that are looked at.
const MOST: usize = 400;

/// Fewer say nothing.
const FEWEST: usize = 24;

/// Azimuths vary if the mean of `exp(2 i phi)` is shorter than 1 by this.
const TURNED: f64 = 0.02;

/// Widths of highlights, lengths, and variances of noise that are tried.
const WIDTHS: [f64; 3] = [0.4, 0.1, 0.02];
const LENGTHS: [[f64; ISOTROPIC]; 3] = [[1.0, 0.8, 0.8, 2.0], [2.0, 1.2, 1.2, 3.0], [1.0, 0.15, 0.8, 2.0]];
const NOISES: [f64; 4] = [1e-3, 1e-2, 0.1, 0.3];
const VARIANCE: f64 = 3.0;

/// Variances of the term over the turn, as shares of that of a process.
const SHARES: [f64; 2] = [0.1, 1.0];

/// Times that the term over the turn goes round: brushed metals have two, a square lattice or a cloth of equal threads has four.
const ROUNDS: [f64; 2] = [2.0, 4.0];

/// Largest tilt that is looked for, the first step of the search and the last one, radians.
const MOST_TILT: f64 = 6.0 * PI / 180.0;
const TILTS: [f64; 2] = [2.0 * PI / 180.0, 0.2 * PI / 180.0];

/// Values below this share of the median size count as even about 0.
const FLOOR: f64 = 0.04;

/// Logarithm of the likelihood, a sample, that the turn brings: from here on an anisotropic surface, said from there on.
const ANISOTROPIC: f64 = 0.1;
const SAID: f64 = 0.04;

/// Samples whose directions are as close as this, radians, but for a turn by more than that, are compared for the words.
const CLOSE: f64 = 1.0 * PI / 180.0;
const APART: f64 = 20.0 * PI / 180.0;

/// Least turns of a pair of directions, of all pairs together, and least deviation of logarithms: then steps from turn to turn tell. The last is
/// the size below which a turn changes values.
const TURNS: usize = 4;
const ENOUGH: f64 = 200.0;
const VARIES: f64 = 0.2;
const STEADY: f64 = 0.6;

/// The result of a turn of the sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Isotropy {
    /// Logarithm of the likelihood that a turn brings, for each sample.
    pub gain: f64,
    /// Ratio of the largest to the least value of a pair of directions that differ by a turn alone, which nine in ten are below.
    pub apart: Option<f64>,
    /// Squared differences from one turn of a pair of directions to the next over twice their variance: 1 for noise, little for a surface
    /// that a turn changes. `None` where there are too few turns.
    pub steps: Option<f64>,
    /// Whether an isotropic completion predicts samples and turns as well that it did not see: then a turn explains noise.
    pub explained: bool,
}

impl Isotropy {
    /// Looks at samples; `None` where the sample was not turned.
    pub(crate) fn of(rows: &[Row]) -> Option<Self> {
        if spread(rows, |row| row.wi).min(spread(rows, |row| row.wo)) < TURNED {
            return None;
        }
        let few: Vec<&Row> = thin(rows, MOST);
        if few.len() < FEWEST {
            return None;
        }
        let values = values(&few)?;
        let mut plain = Vec::new();
        for width in WIDTHS {
            for lengths in LENGTHS {
                for noise in NOISES {
                    plain.push(Candidate { width, lengths, noise, share: 0.0, rounds: 0.0 });
                }
            }
        }
        let (plain, of) = best(&plain, &few, &values)?;
        let mut turned = Vec::new();
        for rounds in ROUNDS {
            for share in SHARES {
                for noise in NOISES {
                    turned.push(Candidate { share, noise, rounds, ..of });
                }
            }
        }
        let (turned, _) = best(&turned, &few, &values)?;
        let groups = over_turns(rows);
        let (apart, steps) = (apart(&groups), from_turn_to_turn(&groups));
        let mut found = Self { gain: (turned - plain) / few.len() as f64, apart, steps, explained: false };
        if found.is_doubtful() {
            let tilted = tilted(&few, &values, of).unwrap_or(plain);
            found.gain = (turned - tilted.max(plain)) / few.len() as f64;
        }
        Some(found)
    }

    /// Whether the surface is anisotropic beyond doubt.
    pub fn is_anisotropic(&self) -> bool {
        (self.gain > ANISOTROPIC || self.is_steady()) && !self.explained
    }

    /// Whether values from one turn to the next tell by themselves that it is.
    pub(crate) fn is_steady(&self) -> bool {
        self.steps.is_some_and(|steps| steps < STEADY)
    }

    /// Whether it may be.
    pub fn is_doubtful(&self) -> bool {
        self.gain > SAID
    }

    /// By how much a turn changes values, in words.
    pub fn text(&self) -> String {
        let apart = self.apart.map_or_else(String::new, |ratio| {
            format!(", {ratio:.1} times at the 90th of 100 pairs of directions")
        });
        format!("values change when the sample is turned{apart}")
    }
}

/// How far the azimuths of a direction are from lying in one plane: 0 to 1.
fn spread(rows: &[Row], of: fn(&Row) -> [f64; 3]) -> f64 {
    let (mut sum, mut count) = ([0.0; 2], 0.0);
    for d in rows.iter().map(of).filter(|d| d[2] < libm::cos(NORMAL)) {
        let (sin, cos) = libm::sincos(2.0 * libm::atan2(d[1], d[0]));
        sum = [sum[0] + cos, sum[1] + sin];
        count += 1.0;
    }
    if count > 0.0 { 1.0 - libm::hypot(sum[0], sum[1]) / count } else { 0.0 }
}

/// Values on a scale that is logarithmic where they are bright, about their mean.
fn values(rows: &[&Row]) -> Option<Vec<f64>> {
    let level = |row: &&Row| row.rgb.iter().sum::<f64>() / 3.0;
    let size = median(rows.iter().map(|row| level(row).abs()).collect())?.max(1e-12);
    let scaled: Vec<f64> = rows.iter().map(|row| libm::asinh(level(row) / (FLOOR * size))).collect();
    let mean = scaled.iter().sum::<f64>() / scaled.len() as f64;
    Some(scaled.into_iter().map(|v| v - mean).collect())
}

/// The logarithm of the likelihood of the tilt that explains samples best, as the candidate has it.
fn tilted(rows: &[&Row], values: &[f64], of: Candidate) -> Option<f64> {
    // By a loop: rustc 1.95 breaks at a closure that updates this struct.
    let mut candidates = Vec::new();
    for noise in NOISES {
        candidates.push(Candidate { noise, ..of });
    }
    let at = |tilt: [f64; 2]| {
        let turned: Vec<Row> = rows.iter().map(|row| level(row, tilt)).collect();
        best(&candidates, &turned.iter().collect::<Vec<_>>(), values).map(|found| found.0)
    };
    let (mut most, mut tilt) = (at([0.0; 2])?, [0.0; 2]);
    let mut step = TILTS[0];
    while step >= TILTS[1] {
        let from = tilt;
        let mut is_better = false;
        for (x, y) in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
            let there = [from[0] + step * x, from[1] + step * y];
            if libm::hypot(there[0], there[1]) > MOST_TILT {
                continue;
            }
            if let Some(likelihood) = at(there).filter(|likelihood| *likelihood > most) {
                (most, tilt, is_better) = (likelihood, there, true);
            }
        }
        if !is_better {
            step *= 0.5;
        }
    }
    Some(most)
}

/// A sample with its directions as a surface sees them that leans by two small angles, towards x and towards y.
fn level(row: &Row, [x, y]: [f64; 2]) -> Row {
    let angle = libm::hypot(x, y);
    if angle == 0.0 {
        return *row;
    }
    let (axis, (sin, cos)) = ([-y / angle, x / angle], libm::sincos(angle));
    // By Rodrigues, about a horizontal axis; the horizon is not passed.
    let turned = |[a, b, c]: [f64; 3]| {
        let along = (axis[0] * a + axis[1] * b) * (1.0 - cos);
        let d = [
            a * cos + axis[1] * c * sin + axis[0] * along,
            b * cos - axis[0] * c * sin + axis[1] * along,
            (c * cos + (axis[0] * b - axis[1] * a) * sin).max(1e-3),
        ];
        let length = libm::sqrt(d.iter().map(|v| v * v).sum());
        d.map(|v| v / length)
    };
    Row { wi: turned(row.wi), wo: turned(row.wo), ..*row }
}

/// The candidate that explains samples best, and the logarithm of its likelihood.
fn best(candidates: &[Candidate], rows: &[&Row], values: &[f64]) -> Option<(f64, Candidate)> {
    let likelihoods: Vec<Option<f64>> =
        candidates.par_iter().map(|candidate| candidate.likelihood(rows, values)).collect();
    let found = likelihoods.into_iter().zip(candidates).filter_map(|(l, candidate)| Some((l?, *candidate)));
    found.max_by(|a, b| a.0.total_cmp(&b.0))
}

/// A process that may explain the samples.
#[derive(Clone, Copy)]
struct Candidate {
    width: f64,
    lengths: [f64; ISOTROPIC],
    noise: f64,
    /// Variance of the term over the turn.
    share: f64,
    /// How often that goes round.
    rounds: f64,
}

impl Candidate {
    /// Logarithm of the likelihood of samples left out one by one; `None` where the arithmetic does not suffice.
    fn likelihood(&self, rows: &[&Row], values: &[f64]) -> Option<f64> {
        let at: Vec<([f64; COORDINATES], f64)> = rows
            .iter()
            .map(|row| {
                let half = [row.wi[0] + row.wo[0], row.wi[1] + row.wo[1]];
                (Pair::new(row.wi, row.wo).coordinates(self.width), libm::atan2(half[1], half[0]))
            })
            .collect();
        let mut matrix = Square::zeros(rows.len());
        for i in 0..rows.len() {
            for j in 0..=i {
                let squared: f64 =
                    (0..ISOTROPIC).map(|k| ((at[i].0[k] - at[j].0[k]) / self.lengths[k]).powi(2)).sum();
                let r = libm::sqrt(5.0 * squared);
                let matern = (1.0 + r + r * r / 3.0) * libm::exp(-r);
                let round = self.rounds * (at[i].1 - at[j].1);
                let turn = if self.share > 0.0 { self.share * libm::cos(round) } else { 0.0 };
                matrix.row_mut(i)[j] = matern * (VARIANCE + turn);
            }
            matrix.row_mut(i)[i] += self.noise;
        }
        let factor = matrix.cholesky()?;
        let solution = factor.solve(values);
        let columns = factor.inverse_of_lower();
        let one = |i: usize| {
            let precision = columns.squared(i);
            let left = solution[i] / precision;
            0.5 * (libm::log(precision) - left * left * precision)
        };
        Some((0..rows.len()).map(one).sum()).filter(|l: &f64| l.is_finite())
    }
}

/// The logarithms of values of directions that differ by a turn alone, each with its turn.
fn over_turns(rows: &[Row]) -> Vec<Vec<(f64, f64)>> {
    use std::collections::BTreeMap;
    let mut groups: BTreeMap<[i64; 3], Vec<(f64, f64)>> = BTreeMap::new();
    for row in rows {
        let level = row.rgb.iter().sum::<f64>();
        let ([i, o], Some(turn)) = row.angles() else { continue };
        if level <= 0.0 {
            continue;
        }
        let azimuth = libm::atan2(row.wi[1], row.wi[0]);
        let key = [i, o, turn].map(|angle| libm::round(angle / CLOSE) as i64);
        groups.entry(key).or_default().push((azimuth, libm::log(level)));
    }
    let is_turned = |group: &Vec<(f64, f64)>| {
        group.iter().any(|b| libm::remainder(group[0].0 - b.0, 2.0 * PI).abs() > APART)
    };
    groups.into_values().filter(is_turned).collect()
}

/// The ratio of the largest to the least value that nine in ten pairs of directions are below, over turns of the sample.
fn apart(groups: &[Vec<(f64, f64)>]) -> Option<f64> {
    let range = |group: &Vec<(f64, f64)>| {
        let ends = |(least, most): (f64, f64), v: &(f64, f64)| (least.min(v.1), most.max(v.1));
        let (least, most) = group.iter().fold((f64::INFINITY, f64::NEG_INFINITY), ends);
        most - least
    };
    let mut found: Vec<f64> = groups.iter().map(range).collect();
    found.sort_by(f64::total_cmp);
    (found.len() >= 10).then(|| libm::exp(found[found.len() * 9 / 10]))
}

/// Squared differences from one turn to the next over twice the variance of all, half turns being one: 1 for noise, and about 1 for a
/// tilted sample, little for a surface that a turn changes. `None` for too few turns, and for values that hardly vary.
fn from_turn_to_turn(groups: &[Vec<(f64, f64)>]) -> Option<f64> {
    let (mut steps, mut variance, mut count) = (0.0, 0.0, 0.0);
    for group in groups.iter().filter(|group| group.len() >= TURNS) {
        let mut half: Vec<(f64, f64)> =
            group.iter().map(|(azimuth, v)| (libm::remainder(*azimuth, PI), *v)).collect();
        half.sort_by(|a, b| a.0.total_cmp(&b.0));
        let n = half.len();
        let mean = half.iter().map(|v| v.1).sum::<f64>() / n as f64;
        steps += (0..n).map(|k| (half[(k + 1) % n].1 - half[k].1).powi(2)).sum::<f64>();
        variance += half.iter().map(|v| (v.1 - mean).powi(2)).sum::<f64>();
        count += (n - 1) as f64;
    }
    (count >= ENOUGH && variance > VARIES * VARIES * count).then(|| 0.5 * steps / variance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::direction;

    /// Samples of f at four turns of the sample, with noise.
    fn rows(noise: f64, f: impl Fn([f64; 3], [f64; 3]) -> f64) -> Vec<Row> {
        let mut random = crate::numeric::random::Random::new(7);
        let mut rows = Vec::new();
        for turn in 0..4 {
            let azimuth = 0.7 * f64::from(turn);
            for (i, o, p) in (0..125).map(|n| (n % 5, n / 5 % 5, n / 25)) {
                let wi = direction(0.2 + 0.25 * f64::from(i), azimuth);
                let wo = direction(0.15 + 0.27 * f64::from(o), azimuth + PI - 0.4 * f64::from(p));
                let value = f(wi, wo) * libm::exp(noise * (random.uniform() - 0.5) * 3.46);
                rows.push(Row { line: 1, wi, wo, rgb: [value; 3] });
            }
        }
        rows
    }

    fn ward(alpha: [f64; 2]) -> impl Fn([f64; 3], [f64; 3]) -> f64 {
        move |wi, wo| {
            let half = [0, 1, 2].map(|k| wi[k] + wo[k]);
            let slope = (half[0] / half[2] / alpha[0]).powi(2) + (half[1] / half[2] / alpha[1]).powi(2);
            0.05 + 0.3 * libm::exp(-slope) / libm::sqrt(wi[2] * wo[2])
        }
    }

    #[test]
    fn a_turn_that_matters_is_told_from_noise_and_gloss() {
        for (noise, alpha, is) in [
            (0.0, [0.3, 0.3], false),
            (0.3, [0.3, 0.3], false),
            (0.05, [0.05, 0.05], false),
            (0.0, [0.1, 0.4], true),
            (0.1, [0.2, 0.4], true),
        ] {
            let found = Isotropy::of(&rows(noise, ward(alpha))).unwrap();
            println!("noise {noise}, {alpha:?}: {found:?}");
            assert_eq!(found.is_anisotropic(), is, "noise {noise}, {alpha:?}: {found:?}");
        }
    }

    #[test]
    fn steps_from_turn_to_turn_tell_a_lattice_from_noise_and_tilt() {
        let mut random = crate::numeric::random::Random::new(9);
        let rows = |f: &mut dyn FnMut(f64) -> f64| -> Vec<Row> {
            let turns = (0..18).flat_map(|turn| (0..40).map(move |n| (0.35 * f64::from(turn), f64::from(n))));
            let row = |(turn, n): (f64, f64)| {
                let wi = direction(0.2 + 0.3 * (n % 4.0), turn);
                Row { line: 1, wi, wo: direction(0.3 + 0.02 * n, turn + 0.1 * n), rgb: [f(turn); 3] }
            };
            turns.map(row).collect()
        };
        let steps = |rows: &[Row]| from_turn_to_turn(&over_turns(rows)).unwrap();
        assert!(steps(&rows(&mut |turn| libm::exp(libm::cos(4.0 * turn)))) < 0.5);
        assert!(steps(&rows(&mut |_| libm::exp(random.uniform()))) > 0.8);
        assert!(steps(&rows(&mut |turn| libm::exp(libm::cos(turn)))) > 0.8);
    }

    #[test]
    fn a_tilt_is_no_turn_that_matters() {
        let isotropic = ward([0.2, 0.2]);
        let tilted = |wi, wo| {
            let row = level(&Row { line: 1, wi, wo, rgb: [0.0; 3] }, [0.03, -0.02]);
            isotropic(row.wi, row.wo)
        };
        let found = Isotropy::of(&rows(0.0, tilted)).unwrap();
        println!("{found:?}");
        assert!(!found.is_anisotropic() && !found.is_doubtful(), "{found:?}");
        // A brushed surface is not explained by a tilt, and taking one back is its inverse.
        let brushed = Isotropy::of(&rows(0.0, ward([0.1, 0.4]))).unwrap();
        assert!(brushed.is_anisotropic(), "{brushed:?}");
        let row = Row { line: 1, wi: direction(0.7, 1.0), wo: direction(0.2, 4.0), rgb: [1.0; 3] };
        let back = level(&level(&row, [0.03, -0.02]), [-0.03, 0.02]);
        assert!((0..3).all(|k| (back.wi[k] - row.wi[k]).abs() < 1e-12), "{row:?} {back:?}");
    }

    #[test]
    fn both_sides_of_one_plane_of_incidence_are_no_turn() {
        let mut rows = rows(0.0, ward([0.1, 0.4]));
        rows.retain(|row| row.wi[1].abs() < 1e-9);
        assert_eq!(Isotropy::of(&rows), None);
    }
}
