//! P-values by verb, level and kind, and the tests that give them.

use super::density::{Image, Part, Seen};
use glam::{DVec3, Vec3};
use srbf_core::{AnyMixture, Sample};
use srbf_tests::inputs::Random;
use srbf_tests::oracle::luminance;
use srbf_tests::statistics::{binomial, chi_square, chi_square_tail, sidak};
use std::collections::BTreeMap;

/// A test that expects fewer counts is skipped.
const LEAST: f64 = 50.0;
const ALPHA: f64 = 0.01;
/// Where p-values are counted.
const LIMITS: [f64; 3] = [1e-2, 1e-3, 1e-4];
/// Largest skewness of weights whose mean is tested as a normal variable: at the level of a million tests p is off by a half.
const SKEWNESS: f64 = 2.0;
/// Largest difference of a weight's luminance from the power, relative to the largest channel.
const LUMINANCE: f64 = 2e-6;

/// The mean that weights have to have, the factor that is divided out of them, and their luminance where it is constant.
pub struct Furnace<'a> {
    pub albedo: Vec3,
    pub factor: &'a dyn Fn(Vec3) -> Vec3,
    pub luminance: Option<f32>,
}

impl<'a> Furnace<'a> {
    /// Of a mixture: the sum of its lobes, as the difference that factors make to the albedo is a stored one.
    pub fn of(m: &AnyMixture<'_>, factor: &'a dyn Fn(Vec3) -> Vec3) -> Self {
        let lobes = (0..m.len()).map(|k| m.lobe(k).expect("lobe").integral()).sum::<Vec3>();
        Self { albedo: lobes + m.diffuse(), factor, luminance: Some(m.power()) }
    }
}

/// Tests of a verb, a level and a kind.
#[derive(Clone, Copy)]
struct Row {
    tests: usize,
    skipped: usize,
    least: f64,
    below: [usize; LIMITS.len()],
}

impl Row {
    const EMPTY: Self = Self { tests: 0, skipped: 0, least: 1.0, below: [0; LIMITS.len()] };

    fn add(&mut self, other: &Self) {
        self.tests += other.tests;
        self.skipped += other.skipped;
        self.least = self.least.min(other.least);
        self.below.iter_mut().zip(other.below).for_each(|(count, more)| *count += more);
    }

    fn of(p: Option<f64>) -> Self {
        match p {
            Some(p) => {
                Self { tests: 1, least: p, below: LIMITS.map(|limit| usize::from(p < limit)), ..Self::EMPTY }
            }
            None => Self { skipped: 1, ..Self::EMPTY },
        }
    }
}

/// All tests, by verb, level and kind.
#[derive(Default)]
pub struct Table {
    rows: BTreeMap<[&'static str; 3], Row>,
    /// Largest difference of a weight from its constant luminance.
    pub luminance: f64,
}

impl Table {
    pub fn see(&mut self, key: [&'static str; 3], p: Option<f64>) {
        self.rows.entry(key).or_insert(Row::EMPTY).add(&Row::of(p));
    }

    /// The rows, then the sum of each kind.
    fn with_sums(&self) -> Vec<([&'static str; 3], Row)> {
        let mut sums = BTreeMap::new();
        for (&[_, _, kind], row) in &self.rows {
            sums.entry(["all", "all", kind]).or_insert(Row::EMPTY).add(row);
        }
        self.rows.iter().chain(&sums).map(|(key, row)| (*key, *row)).collect()
    }

    pub fn tests(&self) -> usize {
        self.rows.values().map(|row| row.tests).sum()
    }

    /// Rows with a p-value that is too small, too many of them or too few.
    pub fn failures(&self) -> Vec<String> {
        let mut failures = Vec::new();
        let rows = self.with_sums();
        let (least, counts) = (self.bound(), sidak(ALPHA, LIMITS.len() * rows.len()));
        for (key, row) in rows {
            if row.least <= least {
                failures.push(format!("{key:?}: p = {:.1e}", row.least));
            }
            for (&count, limit) in row.below.iter().zip(LIMITS) {
                let [fewer, at, more] = binomial(row.tests, limit, count);
                let p = 2.0 * (fewer + at).min(at + more);
                if p <= counts {
                    failures.push(format!("{key:?}: {count} of {} below {limit:e}: p = {p:.1e}", row.tests));
                }
            }
        }
        if self.luminance > LUMINANCE {
            failures.push(format!("the luminance of a weight is off by {:.1e}", self.luminance));
        }
        failures
    }

    /// The bound of all tests.
    pub fn bound(&self) -> f64 {
        sidak(ALPHA, self.tests())
    }

    pub fn csv(&self) -> String {
        let mut csv =
            "verb,level,kind,tests,skipped,least p,bound,below 1e-2,below 1e-3,below 1e-4\n".to_owned();
        for ([verb, level, kind], row) in self.with_sums() {
            let Row { tests, skipped, least, below: [a, b, c] } = row;
            let bound = sidak(ALPHA, tests);
            csv += &format!("{verb},{level},{kind},{tests},{skipped},{least:.1e},{bound:.1e},{a},{b},{c}\n");
        }
        csv
    }

    /// Tests draws against the density that mixtures sum to.
    pub fn check(
        &mut self,
        place: [&'static str; 2],
        truth: &[Seen],
        draws: &[Option<Sample>],
        furnace: Option<&Furnace<'_>>,
        random: &mut Random,
    ) {
        let count = draws.len() as f64;
        let parts: Vec<&Part> = truth.iter().flat_map(|seen| &seen.parts).collect();
        let key = |kind| [place[0], place[1], kind];
        let mut drawn = vec![Vec::new(); parts.len()];
        let mut images: Vec<Image> = Vec::new();
        for sample in draws.iter().flatten() {
            let (mut first, d) = (0, sample.direction.as_dvec3().normalize());
            images.clear();
            for seen in truth {
                seen.images(d, first, &mut images);
                first += seen.parts.len();
            }
            let density: f64 = images.iter().map(|image| image.1).sum();
            assert!(density > 0.0, "{place:?}: {sample:?} has density {density}");
            let mut left = fine(random) * density;
            let is_chosen = |image: &&Image| {
                left -= image.1;
                left < 0.0
            };
            let &(part, _, u) = images.iter().find(is_chosen).unwrap_or(&images[0]);
            drawn[part].push(parts[part].coordinates(u));
        }

        let shares: f64 = parts.iter().map(|part| part.share).sum();
        let nothing = draws.iter().filter(|sample| sample.is_none()).count();
        assert!(nothing == 0 || shares < 1.0 - 1e-6, "{place:?}: {nothing} draws of nothing");
        let of_parts = parts.iter().zip(&drawn).map(|(part, drawn)| (part.share, drawn.len()));
        let counts = of_parts.chain([((1.0 - shares).max(0.0), nothing)]);
        self.see(key("choice"), choice(counts.map(|(share, n)| (share * count, n as f64)).collect()));
        for (part, drawn) in parts.iter().zip(&drawn) {
            let expected = part.share * count;
            let [cap, from, width] = random.three().map(f64::from);
            let inside = |measure: f64, is_inside: &dyn Fn(&&[f64; 2]) -> bool, random: &mut Random| {
                (expected * measure >= LEAST)
                    .then(|| two_sided(drawn.len(), measure, drawn.iter().filter(is_inside).count(), random))
            };
            let in_cap = inside(cap, &|[within, _]| *within < cap, random);
            let in_sector = inside(width, &|[_, turn]| (turn - from).rem_euclid(1.0) < width, random);
            self.see(key("cap"), in_cap);
            self.see(key("sector"), in_sector);
            self.see(key("width"), (expected >= LEAST).then(|| width_of(drawn)));
            let mut cells = [0.0; 16];
            for [within, turn] in drawn {
                let [row, column] = [within, turn].map(|x| ((4.0 * x) as usize).min(3));
                cells[4 * row + column] += 1.0;
            }
            let of_cells = || chi_square(&cells, &[drawn.len() as f64 / 16.0; 16]).p;
            self.see(key("cells"), (expected / 16.0 >= LEAST).then(of_cells));
        }
        if let Some(furnace) = furnace {
            self.weigh(key("furnace"), furnace, draws, random);
        }
    }

    /// The mean of a channel of the weights against the albedo.
    fn weigh(
        &mut self,
        key: [&'static str; 3],
        furnace: &Furnace<'_>,
        draws: &[Option<Sample>],
        random: &mut Random,
    ) {
        let weight = |sample: &Option<Sample>| {
            sample.map_or(DVec3::ZERO, |s| s.weight.as_dvec3() / (furnace.factor)(s.direction).as_dvec3())
        };
        let weights: Vec<DVec3> = draws.iter().map(weight).collect();
        if let Some(power) = furnace.luminance.map(f64::from) {
            let off =
                weights.iter().map(|w| (luminance(*w) - power).abs() / w.abs().max_element().max(power));
            self.luminance = off.fold(self.luminance, f64::max);
        }
        let channel = random.below(3);
        let size = weights.iter().map(|w| w.abs().max_element()).fold(0.0, f64::max);
        let of_channel: Vec<f64> = weights.iter().map(|w| w[channel]).collect();
        let wanted = f64::from(furnace.albedo[channel]);
        self.see(key, mean(&of_channel, size).map(|(mean, square)| difference(mean - wanted, square)));
    }
}

/// Chi-square of the counts of parts, of which the smallest are pooled.
fn choice(mut counts: Vec<(f64, f64)>) -> Option<f64> {
    counts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut bins, mut pooled): (Vec<(f64, f64)>, _) = (Vec::new(), (0.0, 0.0));
    for (expected, observed) in counts {
        pooled = (pooled.0 + expected, pooled.1 + observed);
        if pooled.0 >= LEAST {
            bins.push(std::mem::take(&mut pooled));
        }
    }
    let last = bins.last_mut()?;
    *last = (last.0 + pooled.0, last.1 + pooled.1);
    let (expected, observed): (Vec<f64>, Vec<f64>) = bins.into_iter().unzip();
    (expected.len() > 1).then(|| chi_square(&observed, &expected).p)
}

/// A uniform number of 48 bits: one of 24 is 0 often enough to choose a lobe that has hardly a part of the density.
fn fine(random: &mut Random) -> f64 {
    f64::from(random.uniform()) + f64::from(random.uniform()) / 16_777_216.0
}

/// The p-value of a count that is binomial. A uniform number divides the chance of the count itself, so that p is uniform.
fn two_sided(n: usize, chance: f64, count: usize, random: &mut Random) -> f64 {
    let ([fewer, at, more], part) = (binomial(n, chance, count), fine(random));
    2.0 * (fewer + part * at).min(more + (1.0 - part) * at)
}

/// The p-value of a lobe's sharpness: twice the sum of the logarithms of uniform numbers is a chi-square variable.
fn width_of(drawn: &[[f64; 2]]) -> f64 {
    let sum: f64 = drawn.iter().map(|[within, _]| -(1.0 - within).max(f64::MIN_POSITIVE).ln()).sum();
    let tail = chi_square_tail(2.0 * sum, 2 * drawn.len());
    2.0 * tail.min(1.0 - tail)
}

/// The mean of numbers and the square of its standard error; `None` of numbers that are constant but for rounding of `size`, or too skewed.
pub fn mean(of: &[f64], size: f64) -> Option<(f64, f64)> {
    let n = of.len() as f64;
    let mean = of.iter().sum::<f64>() / n;
    let moment = |k: i32| of.iter().map(|x| (x - mean).powi(k)).sum::<f64>() / n;
    let spread = moment(2).sqrt();
    let is_tested = spread > 1e-3 * size && moment(3).abs() <= SKEWNESS * spread.powi(3);
    is_tested.then_some((mean, spread.powi(2) / n))
}

/// The p-value of the difference of two means, from that and from the square of its standard error.
pub fn difference(of: f64, square: f64) -> f64 {
    chi_square_tail(of.powi(2) / square, 1)
}
