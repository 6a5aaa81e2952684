//! Draws against densities, without quadrature, however sharp the lobes are.
//!
//! The oracle gives every draw to one lobe, at random in proportion to the parts of the density there. Where draws follow the density, a
//! lobe gets the share of its power. And the coordinates of a draw in its lobe are uniform: the share of the lobe within its angle from
//! the axis, and its azimuth. So counts are binomial, and their p-values exact.
//!
//!     SRBF_TESTS=1000000 cargo test --release --workspace --test verbs -- --ignored --nocapture statistics

use glam::{DVec3, Vec3};
use srbf_core::{
    AnyMixture, Blend, BlendPart, Domain, Draws, Error, Expanded, FactorTable, Grid, GridView, Level,
    LightBlock, Line, Lobe, Material, Mixture, PackOptions, PlaneLobe, ProductSampling, Quarter, Request,
    Sample, Sheet, SheetMixture, TiltedLobe, View, fresnel,
};
use srbf_tests::inputs::Random;
use srbf_tests::kinds::{Soa, for_each_level, packed};
use srbf_tests::maps::{Map, both_ways, bright, frame, to_world};
use srbf_tests::oracle::{gaussian, luminance, mirrored, share_within, sphere_integral, squeezed, turned};
use srbf_tests::seeds::same_without_azimuth;
use srbf_tests::statistics::{binomial, chi_square, chi_square_tail, sidak};
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::path::Path;

/// Draws of each verb for a material and an outgoing direction.
const DRAWS: usize = 4096;
/// A test that expects fewer counts is skipped.
const LEAST: f64 = 50.0;
const ALPHA: f64 = 0.01;
/// Where p-values are counted.
const LIMITS: [f64; 3] = [1e-2, 1e-3, 1e-4];
/// Tests of the long run, unless `SRBF_TESTS` says how many.
const TESTS: usize = 200_000;
/// Largest skewness of weights whose mean is tested as a normal variable: at the level of a million tests p is off by a half.
const SKEWNESS: f64 = 2.0;
/// Largest difference of a weight's luminance from the power, relative to the largest channel.
const LUMINANCE: f64 = 2e-6;

/// A lobe or a diffuse term, as the oracle sees it.
struct Part {
    share: f64,
    /// Axis and sharpness; `None` for the diffuse term.
    lobe: Option<(DVec3, f64)>,
    is_squeezed: bool,
}

/// A mixture within a density.
struct Seen {
    parts: Vec<Part>,
    domain: Domain,
    is_below: bool,
    azimuth: [f64; 2],
    squeeze: [f64; 2],
}

/// A part of the density at a direction: its place among all, the density, and the direction as the lobe sees it.
type Image = (usize, f64, DVec3);

impl Seen {
    /// A mixture that has a share of the draws, above the horizon or below.
    fn new(m: &AnyMixture<'_>, share: f64, is_below: bool) -> Self {
        let lobe = |k: usize| {
            let lobe = m.lobe(k).expect("lobe");
            let s = f64::from(lobe.gaussian.sharpness);
            let share = luminance(lobe.amplitude.as_dvec3()) * sphere_integral(s);
            let axis = lobe.gaussian.axis.as_dvec3().normalize();
            Part { share, lobe: Some((axis, s)), is_squeezed: k < m.squeezed_len() }
        };
        let diffuse = Part { share: luminance(m.diffuse().as_dvec3()), lobe: None, is_squeezed: false };
        let mut parts: Vec<Part> = (0..m.len()).map(lobe).chain([diffuse]).collect();
        let power: f64 = parts.iter().map(|part| part.share).sum();
        parts.iter_mut().for_each(|part| part.share *= if power > 0.0 { share / power } else { 0.0 });
        Self {
            parts,
            domain: m.domain(),
            is_below,
            azimuth: m.azimuth_cos_sin().map(f64::from),
            squeeze: [m.squeeze_along(), m.squeeze()].map(f64::from),
        }
    }

    /// Appends its parts of the density at a direction; `first` is the place of its first part.
    fn images(&self, d: DVec3, first: usize, images: &mut Vec<Image>) {
        let is_folded = self.domain == Domain::Hemisphere;
        if is_folded && self.is_below != (d.z < 0.0) {
            return;
        }
        let height = if is_folded { d.z.abs() } else { d.z };
        let turned = turned(self.azimuth, d.with_z(height));
        let (narrow, squeezed) = squeezed(self.squeeze, turned);
        for (place, part) in self.parts.iter().enumerate() {
            let Some((axis, sharpness)) = part.lobe else {
                images.push((first + place, part.share * height / PI, turned));
                continue;
            };
            let (u, scale) = if part.is_squeezed { (narrow, squeezed) } else { (turned, 1.0) };
            let height = part.share * scale / sphere_integral(sharpness);
            for u in [u, mirrored(u)].into_iter().take(1 + usize::from(is_folded)) {
                images.push((first + place, height * gaussian(axis, sharpness, u), u));
            }
        }
    }
}

impl Part {
    /// The uniform numbers that a direction comes from.
    fn coordinates(&self, u: DVec3) -> [f64; 2] {
        let u = u.normalize();
        let (within, [x, y]) = match self.lobe {
            None => (u.x * u.x + u.y * u.y, [u.x, u.y]),
            Some((axis, s)) => {
                let (t, b) = axis.any_orthonormal_pair();
                (share_within(s, 0.5 * (u - axis).length_squared()), [u.dot(t), u.dot(b)])
            }
        };
        [within, (y.atan2(x) / TAU).rem_euclid(1.0)]
    }
}

/// The mean that weights have to have, the factor that is divided out of them, and their luminance where it is constant.
struct Furnace<'a> {
    albedo: Vec3,
    factor: &'a dyn Fn(Vec3) -> Vec3,
    luminance: Option<f32>,
}

impl<'a> Furnace<'a> {
    /// Of a mixture: the sum of its lobes, as the difference that factors make to the albedo is a stored one.
    fn of(m: &AnyMixture<'_>, factor: &'a dyn Fn(Vec3) -> Vec3) -> Self {
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
struct Table {
    rows: BTreeMap<[&'static str; 3], Row>,
    luminance: f64,
}

impl Table {
    fn see(&mut self, key: [&'static str; 3], p: Option<f64>) {
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

    fn tests(&self) -> usize {
        self.rows.values().map(|row| row.tests).sum()
    }

    /// Rows with a p-value that is too small, too many of them or too few.
    fn failures(&self) -> Vec<String> {
        let mut failures = Vec::new();
        let rows = self.with_sums();
        let (least, counts) = (sidak(ALPHA, self.tests()), sidak(ALPHA, LIMITS.len() * rows.len()));
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

    fn csv(&self) -> String {
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
    fn check(
        &mut self,
        place: [&'static str; 2],
        truth: &[Seen],
        draws: &[Option<Sample>],
        furnace: Option<&Furnace<'_>>,
        random: &mut Random,
    ) {
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
        self.see(key("choice"), choice(counts.map(|(share, n)| (share * DRAWS as f64, n as f64)).collect()));
        for (part, drawn) in parts.iter().zip(&drawn) {
            let expected = part.share * DRAWS as f64;
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
        let (n, wanted) = (draws.len() as f64, f64::from(furnace.albedo[channel]));
        let mean = weights.iter().map(|w| w[channel]).sum::<f64>() / n;
        let moment = |k: i32| weights.iter().map(|w| (w[channel] - mean).powi(k)).sum::<f64>() / n;
        let (spread, size) =
            (moment(2).sqrt(), weights.iter().map(|w| w.abs().max_element()).fold(0.0, f64::max));
        // Of weights that are constant but for rounding there is nothing to test.
        let is_tested = spread > 1e-3 * size && moment(3).abs() <= SKEWNESS * spread.powi(3);
        self.see(key, is_tested.then(|| chi_square_tail((mean - wanted).powi(2) * n / spread.powi(2), 1)));
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

/// Uniform numbers of a verb.
fn numbers(random: &mut Random) -> Vec<Vec3> {
    (0..DRAWS).map(|_| random.three().into()).collect()
}

/// Draws one by one.
fn singles(random: &mut Random, sample: impl Fn([f32; 3]) -> Option<Sample>) -> Vec<Option<Sample>> {
    numbers(random).into_iter().map(|u| sample(u.to_array())).collect()
}

/// Draws of one request.
fn batch(
    random: &mut Random,
    wo: Vec3,
    ask: impl Fn([&[f32]; 3], Request<'_>) -> Result<(), Error>,
) -> Vec<Option<Sample>> {
    let (u, wo) = (Soa::new(&numbers(random)), Soa::new(&[wo; DRAWS]));
    let (mut direction, mut weight, mut pdf) = (Soa::empty(DRAWS), Soa::empty(DRAWS), vec![f32::NAN; DRAWS]);
    let draw = Draws {
        u: u.slices(),
        direction: direction.slices_mut(),
        pdf: Some(&mut pdf),
        weight: Some(weight.slices_mut()),
    };
    ask(wo.slices(), draw.into()).unwrap();
    let sample = |i: usize| Sample { direction: direction.at(i), pdf: pdf[i], weight: weight.at(i) };
    (0..DRAWS).map(|i| (pdf[i] > 0.0).then(|| sample(i))).collect()
}

/// A direction from the normal to grazing.
fn outgoing(random: &mut Random) -> Vec3 {
    let z = match random.below(8) {
        0 => 1.0,
        1 => 10f32.powf(random.between(-6.0, -1.0)),
        _ => random.between(0.0, std::f32::consts::FRAC_PI_2).cos(),
    };
    let ((sin, cos), r) = (random.between(0.0, std::f32::consts::TAU).sin_cos(), (1.0 - z * z).sqrt());
    Vec3::new(r * cos, r * sin, z).normalize()
}

/// A material of any kind.
fn material(random: &mut Random) -> Material<Vec<u8>> {
    let bytes = if random.below(2) == 0 { line(random) } else { grid(random) };
    let options = PackOptions { bits: [8, 16][random.below(2)], channels: [1, 3][random.below(2)] };
    Material::from_bytes(if random.below(3) == 0 { packed(&bytes, options) } else { bytes }).unwrap()
}

fn lobe_count(random: &mut Random) -> usize {
    [1, 1, 2, 3, 5, 8, 12, 16, 17, 33, 64][random.below(11)]
}

/// Logarithms of sharpness and luminance, so that powers differ by some times, and colour differences.
fn shape(random: &mut Random) -> (f32, f32, [f32; 2]) {
    let log2_sharpness = random.between(-3.0, 24.0);
    let log2_luminance = log2_sharpness.max(0.0) - 6.0 + random.between(-2.0, 2.0);
    (log2_sharpness, log2_luminance, [random.between(-1.0, 2.0), random.between(-1.0, 4.0)])
}

/// The logarithm of a diffuse albedo, or of none.
fn diffuse(random: &mut Random) -> f32 {
    if random.below(3) == 0 { -126.0 } else { random.between(-8.0, 0.0) }
}

fn line(random: &mut Random) -> Vec<u8> {
    let thetas = [0.0, 0.8, 1.3];
    let count = lobe_count(random);
    let mirrored = random.below(count.min(64 - count) + 1);
    let squeezed = random.below(count - mirrored + 1);
    let lobes = thetas.map(|theta| {
        let mut lobe = |k: usize| {
            let (log2_sharpness, log2_luminance, color_differences) = shape(random);
            let free = |limit: f32, is_free| if is_free && theta > 0.0 { limit } else { 0.0 };
            PlaneLobe {
                angle: free(random.between(-1.6, 1.6), true),
                off_plane: free(random.between(-1.5, 1.5), k >= count - mirrored),
                log2_sharpness,
                log2_luminance,
                color_differences,
            }
        };
        (0..count).map(&mut lobe).collect::<Vec<_>>()
    });
    let views = [0, 1, 2].map(|v| View {
        theta: thetas[v],
        log2_squeeze: if v > 0 { random.between(-6.64, 0.5) } else { 0.0 },
        log2_diffuse: diffuse(random),
        diffuse_color_differences: [0.3, -0.2],
        lobes: &lobes[v],
    });
    with_factors(random, views.len(), |factors| {
        let line = Line { views: &views, squeezed, mirrored, factors };
        let mut bytes = vec![0; line.encoded_len("")];
        line.encode("", &mut bytes).unwrap();
        bytes
    })
}

fn grid(random: &mut Random) -> Vec<u8> {
    let (count, azimuths, turns) = (lobe_count(random), 3, 1 + random.below(2));
    let squeezed = random.below(count + 1);
    let lobes: Vec<Vec<TiltedLobe>> = (0..1 + azimuths)
        .map(|_| {
            let mut lobe = |_| {
                let (log2_sharpness, log2_luminance, color_differences) = shape(random);
                let tilt = [random.between(-1.2, 1.2), random.between(-1.2, 1.2)];
                TiltedLobe { tilt, log2_sharpness, log2_luminance, color_differences }
            };
            (0..count).map(&mut lobe).collect()
        })
        .collect();
    let view = |lobes| GridView {
        log2_squeeze: [random.between(-3.9, 5.5), random.between(-1.0, 1.0), random.between(-3.9, 5.5)],
        log2_diffuse: diffuse(random),
        diffuse_color_differences: [0.3, -0.2],
        lobes,
    };
    let views: Vec<GridView<'_>> = lobes.iter().map(Vec::as_slice).map(view).collect();
    with_factors(random, views.len(), |factors| {
        let grid = Grid { thetas: &[0.0, 1.1], azimuths, turns, axis: 0.4, views: &views, squeezed, factors };
        let mut bytes = vec![0; grid.encoded_len("")];
        grid.encode("", &mut bytes).unwrap();
        bytes
    })
}

/// With a table of factors in one of three.
fn with_factors(
    random: &mut Random,
    views: usize,
    encode: impl FnOnce(Option<FactorTable>) -> Vec<u8>,
) -> Vec<u8> {
    let (half, difference, azimuth) = (5, 4, 2);
    let mut factors: Vec<[f32; 3]> = (0..40).map(|_| [(); 3].map(|()| random.between(0.3, 2.0))).collect();
    same_without_azimuth(&mut factors, half, difference);
    let (is_signed, albedo_differences) = (random.below(2) == 0, vec![[0.0; 3]; views]);
    let (factors, albedo_differences) = (&factors[..], &albedo_differences[..]);
    let table = FactorTable { half, difference, azimuth, is_signed, factors, albedo_differences };
    encode((random.below(3) == 0).then_some(table))
}

/// One subject of every kind, by all its verbs.
fn round(table: &mut Table, level: Level, random: &mut Random) {
    of_material(table, level.name(), random);
    of_own_lobes(table, level.name(), random);
    of_sheet(table, level.name(), random);
    of_blend(table, level.name(), random);
    of_light(table, level.name(), 1.0, random);
}

fn of_material(table: &mut Table, level: &'static str, random: &mut Random) {
    let (material, wo) = (material(random), outgoing(random));
    let factor = |wi: Vec3| material.factor(wo, wi);
    let mut m = Mixture::<64>::empty();
    material.prepare(wo, &mut m).unwrap();
    of_mixture(table, level, &m, &factor, random);
    let mut check = |verb, m: &AnyMixture<'_>, draws: Vec<_>, random: &mut Random| {
        let truth = [Seen::new(m, 1.0, false)];
        table.check([verb, level], &truth, &draws, Some(&Furnace::of(m, &factor)), random);
    };
    check("Material::sample", &m, singles(random, |u| material.sample(wo, u)), random);
    check("Material::ask", &m, batch(random, wo, |wo, request| material.ask(wo, request)), random);
    if material.is_isotropic() {
        const ROWS: usize = 64;
        let mut memory = vec![0.0; material.expanded_len(ROWS)];
        let expanded = Expanded::new(&material, ROWS, &mut memory).unwrap();
        expanded.prepare(wo, &mut m).unwrap();
        check("Expanded::ask", &m, batch(random, wo, |wo, request| expanded.ask(wo, request)), random);
    }
}

fn of_mixture(
    table: &mut Table,
    level: &'static str,
    m: &AnyMixture<'_>,
    factor: &dyn Fn(Vec3) -> Vec3,
    random: &mut Random,
) {
    let (truth, furnace) = ([Seen::new(m, 1.0, false)], Furnace::of(m, factor));
    let draws = singles(random, |u| m.sample(u));
    table.check(["Mixture::sample", level], &truth, &draws, Some(&furnace), random);
    let draws = batch(random, Vec3::Z, |_, request| m.ask(request));
    table.check(["Mixture::ask", level], &truth, &draws, Some(&furnace), random);
}

/// On the sphere too.
fn of_own_lobes(table: &mut Table, level: &'static str, random: &mut Random) {
    let domain = [Domain::Sphere, Domain::Hemisphere][random.below(2)];
    let (count, squeeze) = (lobe_count(random), 10f32.powf(random.between(-2.0, 0.3)));
    let m = random.mixture(domain, count, squeeze);
    of_mixture(table, level, &m, &|_| Vec3::ONE, random);
}

fn of_sheet(table: &mut Table, level: &'static str, random: &mut Random) {
    let all = [(); 4].map(|()| material(random));
    let is_symmetric = random.below(2) == 0;
    let quarter = |q: Quarter| (!(is_symmetric && q.is_back()) && random.below(8) > 0).then_some(());
    let mut quarters = Quarter::ALL.map(quarter);
    quarters[0] = Some(());
    let mut place = 0..;
    let quarters = quarters.map(|given| place.next().and_then(|n: usize| given.map(|()| &all[n])));
    let mut bytes = vec![0; Sheet::encoded_len(quarters, "")];
    Sheet::encode(quarters, is_symmetric, "", &mut bytes).unwrap();
    let sheet = Sheet::from_bytes(bytes).unwrap();
    let mut wo = outgoing(random);
    if random.below(2) == 0 {
        wo.z = -wo.z;
    }
    let mut pair = SheetMixture::<64>::empty();
    sheet.prepare(wo, &mut pair).unwrap();
    let is_back = wo.z < 0.0;
    let truth = [false, true].map(|is_transmission| {
        let reflected = f64::from(sheet.reflected_share(wo));
        let share = if is_transmission { 1.0 - reflected } else { reflected };
        Seen::new(pair.half(is_transmission), share, is_back != is_transmission)
    });
    let has_factors = [false, true].iter().any(|&way| pair.half(way).has_factors());
    let [reflected, transmitted] = pair.albedos();
    let furnace = Furnace { albedo: reflected + transmitted, factor: &|_| Vec3::ONE, luminance: None };
    let furnace = (!has_factors).then_some(&furnace);
    let mut check = |verb, draws: Vec<_>, random: &mut Random| {
        table.check([verb, level], &truth, &draws, furnace, random);
    };
    check("SheetMixture::sample", singles(random, |u| pair.sample(u)), random);
    check("Sheet::sample", singles(random, |u| sheet.sample(wo, u)), random);
    check("Sheet::ask", batch(random, wo, |wo, request| sheet.ask(wo, request)), random);
}

fn of_blend(table: &mut Table, level: &'static str, random: &mut Random) {
    let materials: Vec<_> = (0..2 + random.below(3)).map(|_| material(random)).collect();
    let wo = outgoing(random);
    let coated = random.below(3) == 0;
    let index = if coated { random.between(1.0, 2.0) } else { 1.0 };
    let part = |material| {
        let weight = random.between(0.05, 1.0);
        BlendPart::new(material, weight).tinted(random.three()).coated(index)
    };
    let parts: Vec<BlendPart<'_>> = materials.iter().map(part).collect();
    let blend = Blend::new(&parts).unwrap();
    let mut mixtures = vec![Mixture::<64>::empty(); parts.len()];
    for (material, m) in materials.iter().zip(&mut mixtures) {
        material.prepare(wo, m).unwrap();
    }
    let powers: Vec<f64> = parts
        .iter()
        .zip(&mixtures)
        .map(|(part, m)| luminance(part.tint().as_dvec3()) * f64::from(part.weight() * m.power()))
        .collect();
    let power: f64 = powers.iter().sum();
    let truth: Vec<Seen> =
        mixtures.iter().zip(powers).map(|(m, own)| Seen::new(m, own / power, false)).collect();
    // Below a coat the weights have the transmittance towards wi, of which the albedo is a bound.
    let coat = |wi: Vec3| Vec3::splat(1.0 - fresnel(index, wi.z));
    let furnace = Furnace { albedo: blend.albedo(wo), factor: &coat, luminance: None };
    let furnace = (!mixtures.iter().any(|m| m.has_factors())).then_some(&furnace);
    let draws = singles(random, |u| blend.sample(wo, u));
    table.check(["Blend::sample", level], &truth, &draws, furnace, random);
    let draws = batch(random, wo, |wo, request| blend.ask(wo, request));
    table.check(["Blend::ask", level], &truth, &draws, furnace, random);
}

/// Even sums and products of a random material and a random map, in a random frame, against one draw of each by the balance heuristic.
/// A random pattern is in the way of the sums' rays. A bias may be planted in both.
fn of_light(table: &mut Table, level: &'static str, planted: f64, random: &mut Random) {
    let (material, wo) = (material(random), outgoing(random));
    let mut m = Mixture::<64>::empty();
    material.prepare(wo, &mut m).unwrap();
    let [columns, rows] = [1 + random.below(64), 1 + random.below(32)];
    let map = match random.below(4) {
        0 => Map::sky(),
        1 => Map::constant(),
        2 => Map::pixel(columns, rows, random.below(columns), random.below(rows)),
        _ => Map::noise(columns, rows),
    };
    let environment = map.environment().turned(random.between(0.0, 6.0));
    let (axes, wave, hidden) =
        (frame(random.direction()), 10.0 * random.direction(), random.between(-0.9, 1.5));
    let sampling = ProductSampling::new(2 + random.below(15), 0.5, f32::INFINITY).unwrap();
    let is_above = |d: Vec3| d.dot(axes[2]) > 0.0;
    let seen = |d: Vec3| is_above(d) && d.dot(wave).sin() < hidden;
    let (mut sums, mut products, mut of_seen, mut of_all) = (vec![], vec![], vec![], vec![]);
    for n in 0..4 * DRAWS {
        let both = |seen: &dyn Fn(Vec3) -> bool, u| bright(both_ways(&m, &environment, &axes, seen, u));
        of_seen.push(both(&seen, [random.three(), random.three()]));
        of_all.push(both(&is_above, [random.three(), random.three()]));
        if n >= DRAWS {
            continue;
        }
        let mut u = [[0.0; 16]; 3];
        u.as_flattened_mut().fill_with(|| random.uniform());
        let block = LightBlock::new(&environment, u.each_ref());
        u.as_flattened_mut().fill_with(|| random.uniform());
        let given = u.each_ref().map(|u| &u[..8]);
        let drawn = m.reflect(&environment, &block, &axes, axes[2], given, random.uniform()).unwrap();
        let ray = drawn.ray.is_some_and(|ray| seen(to_world(&axes, ray.direction)));
        sums.push(planted * bright(drawn.light(ray, drawn.shadow.is_some_and(seen))));
        u.as_flattened_mut().fill_with(|| random.uniform());
        let given = u.each_ref().map(|u| &u[..sampling.candidates()]);
        let drawn = m.sample_product(&environment, &axes, &sampling, given, random.uniform()).unwrap();
        products.push(planted * drawn.map_or(0.0, |drawn| bright(drawn.weight)));
    }
    for (verb, ours, theirs) in [("even sums", &sums, &of_seen), ("products", &products, &of_all)] {
        let p = mean(ours).zip(mean(theirs)).map(|((ours, error), (theirs, other))| {
            chi_square_tail((ours - theirs).powi(2) / (error + other), 1)
        });
        table.see([verb, level, "light"], p);
    }
}

/// The mean of numbers and the square of its standard error; `None` of numbers that are nearly constant, or too skewed.
fn mean(of: &[f64]) -> Option<(f64, f64)> {
    let n = of.len() as f64;
    let mean = of.iter().sum::<f64>() / n;
    let moment = |k: i32| of.iter().map(|x| (x - mean).powi(k)).sum::<f64>() / n;
    let spread = moment(2).sqrt();
    let is_tested = spread > 1e-3 * mean.abs() && moment(3).abs() <= SKEWNESS * spread.powi(3);
    is_tested.then_some((mean, spread.powi(2) / n))
}

/// Rounds at every level until there are as many tests, and more than none.
fn tests(wanted: usize) -> Table {
    let mut table = Table::default();
    let levels = srbf_tests::inputs::levels().len();
    for_each_level(|level| {
        let before = table.tests();
        let mut random = Random(66 + level as u64);
        while table.tests() == before || table.tests() - before < wanted / levels {
            round(&mut table, level, &mut random);
        }
    });
    table
}

#[test]
fn statistics_of_a_few_draws_of_every_verb() {
    let table = tests(800);
    assert!(table.failures().is_empty(), "{}\n{:#?}", table.csv(), table.failures());
}

#[test]
#[ignore = "two hundred thousand tests, or SRBF_TESTS: a minute or more"]
fn statistics_of_very_many_draws_of_every_verb() {
    let wanted = std::env::var("SRBF_TESTS").map_or(TESTS, |n| n.parse().expect("a number of tests"));
    let table = tests(wanted);
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("statistics.csv");
    std::fs::write(&path, table.csv()).unwrap();
    println!("{}{} tests, bound of all {:.1e}", table.csv(), table.tests(), sidak(ALPHA, table.tests()));
    println!("luminance of weights within {:.1e}; {}", table.luminance, path.display());
    assert!(table.failures().is_empty(), "{:#?}", table.failures());
}

#[test]
fn statistics_find_light_that_is_off_by_a_tenth() {
    let off = |planted: f64| {
        let (mut table, mut random) = (Table::default(), Random(68));
        while table.tests() < 16 {
            of_light(&mut table, "any", planted, &mut random);
        }
        table.failures()
    };
    assert_eq!(off(1.0), Vec::<String>::new());
    let found = off(1.1);
    for verb in ["even sums", "products"] {
        assert!(found.iter().any(|failure| failure.contains(verb)), "{verb}: {found:?}");
    }
}

#[test]
fn statistics_find_a_sampler_of_another_density() {
    let changed = |change: &dyn Fn(Lobe) -> Lobe| {
        let (mut table, mut random) = (Table::default(), Random(67));
        for _ in 0..40 {
            let mut lobes: Vec<Lobe> = (0..2).map(|_| random.lobe(0.0, 6.0)).collect();
            let truth = [Seen::new(&Mixture::<16>::hemisphere(&lobes).unwrap(), 1.0, false)];
            lobes[0] = change(lobes[0]);
            let other = Mixture::<16>::hemisphere(&lobes).unwrap();
            let draws = singles(&mut random, |u| other.sample(u));
            table.check(["another", "density"], &truth, &draws, None, &mut random);
        }
        table.failures()
    };
    let with = |lobe: Lobe, axis: Vec3, sharpness: f32, power: f32| {
        let s = lobe.gaussian.sharpness;
        Lobe::new(axis, s * sharpness, lobe.amplitude * (power * sharpness)).unwrap()
    };
    assert_eq!(changed(&|lobe| lobe), Vec::<String>::new());
    let sharper = changed(&|lobe| with(lobe, lobe.gaussian.axis, 1.05, 1.0));
    let aside = changed(&|lobe| {
        let width = 1.0 / lobe.gaussian.sharpness.sqrt();
        let axis = lobe.gaussian.axis;
        with(lobe, (axis + 0.1 * width * axis.any_orthonormal_vector()).normalize(), 1.0, 1.0)
    });
    let brighter = changed(&|lobe| with(lobe, lobe.gaussian.axis, 1.0, 1.1));
    for (name, failures) in [("sharper", sharper), ("aside", aside), ("brighter", brighter)] {
        println!("{name}: {failures:?}");
        assert!(!failures.is_empty(), "{name}");
    }
}
