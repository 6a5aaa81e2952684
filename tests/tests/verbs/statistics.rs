//! Draws against densities, without quadrature, however sharp the lobes are.
//!
//! The oracle gives every draw to one lobe, at random in proportion to the parts of the density there. Where draws follow the density, a
//! lobe gets the share of its power. And the coordinates of a draw in its lobe are uniform: the share of the lobe within its angle from
//! the axis, and its azimuth. So counts are binomial, and their p-values exact.
//!
//!     SRBF_TESTS=1000000 cargo test --release --workspace --test verbs -- --ignored --nocapture statistics

mod density;
mod materials;
mod table;

use density::Seen;
use glam::Vec3;
use materials::{lobe_count, material};
use srbf_core::{
    AnyMixture, Blend, BlendPart, Domain, Draws, Error, Expanded, Level, LightBlock, Lobe, Material, Mixture,
    ProductSampling, Quarter, Request, Sample, Sheet, SheetMixture, fresnel,
};
use srbf_tests::inputs::Random;
use srbf_tests::kinds::{Soa, for_each_level};
use srbf_tests::maps::{Map, both_ways, bright, frame, to_world};
use srbf_tests::oracle::luminance;
use std::path::Path;
use table::{Furnace, Table, difference, mean};

/// Draws of each verb for a material and an outgoing direction.
const DRAWS: usize = 4096;
/// Tests of the long run, unless `SRBF_TESTS` says how many.
const TESTS: usize = 200_000;

/// Uniform numbers of a verb.
fn numbers(random: &mut Random, count: usize) -> Vec<Vec3> {
    (0..count).map(|_| random.three().into()).collect()
}

/// Draws one by one.
fn singles(random: &mut Random, sample: impl Fn([f32; 3]) -> Option<Sample>) -> Vec<Option<Sample>> {
    numbers(random, DRAWS).into_iter().map(|u| sample(u.to_array())).collect()
}

/// Draws of one request.
fn batch(
    random: &mut Random,
    wo: Vec3,
    ask: impl Fn([&[f32]; 3], Request<'_>) -> Result<(), Error>,
) -> Vec<Option<Sample>> {
    let mut draws = Vec::new();
    request(random, DRAWS, &[wo], &mut |_, sample| draws.push(sample), |_, wo, request| ask(wo, request));
    draws
}

/// Draws of many requests of one to three hits, which are taken one by one.
fn few(
    random: &mut Random,
    wo: Vec3,
    ask: impl Fn([&[f32]; 3], Request<'_>) -> Result<(), Error>,
) -> Vec<Option<Sample>> {
    let mut draws = Vec::new();
    while draws.len() < DRAWS {
        let count = 1 + random.below(3);
        request(random, count, &[wo], &mut |_, sample| draws.push(sample), |_, wo, request| ask(wo, request));
    }
    draws
}

/// Draws of requests whose hits have subjects at random, in no order, those of each apart. Half of them are of one request, and the others of
/// requests of any size up to 40.
fn mixed<const N: usize>(
    random: &mut Random,
    wo: [Vec3; N],
    ask: impl Fn(&[usize], [&[f32]; 3], Request<'_>) -> Result<(), Error>,
) -> [Vec<Option<Sample>>; N] {
    let mut draws = [const { Vec::new() }; N];
    let (mut left, mut count) = (N * DRAWS, N * DRAWS / 2);
    while left > 0 {
        request(random, count, &wo, &mut |subject, sample| draws[subject].push(sample), &ask);
        left -= count;
        count = left.min(1 + random.below(40));
    }
    draws
}

/// One request of `count` hits, each of a subject at random, which has its outgoing direction.
fn request(
    random: &mut Random,
    count: usize,
    wo: &[Vec3],
    see: &mut dyn FnMut(usize, Option<Sample>),
    ask: impl Fn(&[usize], [&[f32]; 3], Request<'_>) -> Result<(), Error>,
) {
    let subjects: Vec<usize> = (0..count).map(|_| random.below(wo.len())).collect();
    let u = Soa::new(&numbers(random, count));
    let wo = Soa::new(&subjects.iter().map(|&subject| wo[subject]).collect::<Vec<_>>());
    let (mut direction, mut weight, mut pdf) = (Soa::empty(count), Soa::empty(count), vec![f32::NAN; count]);
    let draw = Draws {
        u: u.slices(),
        direction: direction.slices_mut(),
        pdf: Some(&mut pdf),
        weight: Some(weight.slices_mut()),
    };
    ask(&subjects, wo.slices(), draw.into()).unwrap();
    for (i, &subject) in subjects.iter().enumerate() {
        let sample = Sample { direction: direction.at(i), pdf: pdf[i], weight: weight.at(i) };
        see(subject, (pdf[i] > 0.0).then_some(sample));
    }
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

/// One subject of every kind, by all its verbs.
fn round(table: &mut Table, level: Level, random: &mut Random) {
    of_material(table, level.name(), random);
    of_own_lobes(table, level.name(), random);
    of_sheet(table, level.name(), random);
    of_blends(table, level.name(), random);
    of_two_materials(table, level.name(), random);
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
    check("Material::ask of few", &m, few(random, wo, |wo, request| material.ask(wo, request)), random);
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
    let draws = few(random, Vec3::Z, |_, request| m.ask(request));
    table.check(["Mixture::ask of few", level], &truth, &draws, Some(&furnace), random);
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
    check("Sheet::ask of few", few(random, wo, |wo, request| sheet.ask(wo, request)), random);
}

/// Two materials, or their mixtures, in the same requests.
fn of_two_materials(table: &mut Table, level: &'static str, random: &mut Random) {
    let (materials, wo) = ([material(random), material(random)], [outgoing(random), outgoing(random)]);
    let mut mixtures = [Mixture::<64>::empty(), Mixture::empty()];
    for ((material, wo), m) in materials.iter().zip(wo).zip(&mut mixtures) {
        material.prepare(wo, m).unwrap();
    }
    let mut check = |verb, draws: [Vec<_>; 2], random: &mut Random| {
        for (i, draws) in draws.iter().enumerate() {
            let factor = |wi: Vec3| materials[i].factor(wo[i], wi);
            let furnace = Furnace::of(&mixtures[i], &factor);
            let truth = [Seen::new(&mixtures[i], 1.0, false)];
            table.check([verb, level], &truth, draws, Some(&furnace), random);
        }
    };
    let draws = mixed(random, wo, |subjects, wo, request| {
        Material::ask_each(&subjects.iter().map(|&i| &materials[i]).collect::<Vec<_>>(), wo, request)
    });
    check("Material::ask_each", draws, random);
    let draws = mixed(random, wo, |subjects, _, request| {
        AnyMixture::ask_each(&subjects.iter().map(|&i| &mixtures[i]).collect::<Vec<_>>(), request)
    });
    check("Mixture::ask_each", draws, random);
}

/// A blend at an outgoing direction, with the densities of its parts.
struct Blended<'a> {
    parts: Vec<BlendPart<'a>>,
    wo: Vec3,
    /// Of the coat; 1 is none.
    index: f32,
    truth: Vec<Seen>,
    has_factors: bool,
}

impl<'a> Blended<'a> {
    fn new(materials: &'a [Material<Vec<u8>>], random: &mut Random) -> Self {
        let wo = outgoing(random);
        let index = if random.below(3) == 0 { random.between(1.0, 2.0) } else { 1.0 };
        let part = |material| {
            let weight = random.between(0.05, 1.0);
            BlendPart::new(material, weight).tinted(random.three()).coated(index)
        };
        let parts: Vec<BlendPart<'_>> = materials.iter().map(part).collect();
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
        let truth = mixtures.iter().zip(powers).map(|(m, own)| Seen::new(m, own / power, false)).collect();
        let has_factors = mixtures.iter().any(|m| m.has_factors());
        Self { parts, wo, index, truth, has_factors }
    }

    fn blend(&self) -> Blend<'_> {
        Blend::new(&self.parts).unwrap()
    }

    fn check(
        &self,
        table: &mut Table,
        place: [&'static str; 2],
        draws: &[Option<Sample>],
        random: &mut Random,
    ) {
        // Below a coat the weights have the transmittance towards wi, of which the albedo is a bound.
        let coat = |wi: Vec3| Vec3::splat(1.0 - fresnel(self.index, wi.z));
        let furnace = Furnace { albedo: self.blend().albedo(self.wo), factor: &coat, luminance: None };
        let furnace = (!self.has_factors).then_some(&furnace);
        table.check(place, &self.truth, draws, furnace, random);
    }
}

fn of_blends(table: &mut Table, level: &'static str, random: &mut Random) {
    let materials: Vec<_> = (0..2 + random.below(3)).map(|_| material(random)).collect();
    let one = Blended::new(&materials, random);
    let (blend, wo) = (one.blend(), one.wo);
    let draws = singles(random, |u| blend.sample(wo, u));
    one.check(table, ["Blend::sample", level], &draws, random);
    let draws = batch(random, wo, |wo, request| blend.ask(wo, request));
    one.check(table, ["Blend::ask", level], &draws, random);
    let draws = few(random, wo, |wo, request| blend.ask(wo, request));
    one.check(table, ["Blend::ask of few", level], &draws, random);
    let both = [one, Blended::new(&materials[1..], random)];
    let draws = mixed(random, both.each_ref().map(|blended| blended.wo), |subjects, wo, request| {
        Blend::ask_each(&subjects.iter().map(|&i| both[i].blend()).collect::<Vec<_>>(), wo, request)
    });
    for (blended, draws) in both.iter().zip(&draws) {
        blended.check(table, ["Blend::ask_each", level], draws, random);
    }
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
        let size = ours.iter().fold(0.0, |size, x: &f64| x.max(size));
        let p = mean(ours, size)
            .zip(mean(theirs, size))
            .map(|((ours, square), (theirs, other))| difference(ours - theirs, square + other));
        table.see([verb, level, "light"], p);
    }
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
    println!("{}{} tests, bound of all {:.1e}", table.csv(), table.tests(), table.bound());
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
