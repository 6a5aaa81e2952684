//! Light and material sampled together.

use glam::{DVec3, Vec3};
use srbf_core::{
    AnyMixture, Domain, Environment, Error, Line, Lobe, Material, Mixture, PlaneLobe, ProductSampling, View,
};
use srbf_tests::inputs::{Random, UNIFORM, levels};
use srbf_tests::maps::{Map, Moments, both_ways, bright, frame, to_local, to_world};
use srbf_tests::oracle;
use srbf_tests::statistics::sidak;
use srbf_tests::tolerance::Worst;
use std::path::{Path, PathBuf};

/// Estimates of a case, each of a number of candidates.
const DRAWS: usize = 80_000;

/// Estimates by multiple importance sampling that each case is compared with.
const PAIRS: usize = 800_000;

fn wo(degrees: f32) -> Vec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    Vec3::new(0.6 * sin, 0.8 * sin, cos)
}

/// Presets by name, at angles from the normal to grazing.
fn presets() -> Vec<(String, Mixture<'static, 64>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../presets");
    let mut all = Vec::new();
    for name in ["cayman", "garnet_red", "krylon_blue"] {
        let bytes = std::fs::read(folder.join(name).with_extension("srbf")).unwrap();
        // Its mixtures borrow the material's factors.
        let material: &'static Material<Vec<u8>> = Box::leak(Box::new(Material::from_bytes(bytes).unwrap()));
        for degrees in [0.0, 35.0, 65.0, 84.0] {
            let mut m = Mixture::empty();
            material.prepare(wo(degrees), &mut m).unwrap();
            all.push((format!("{name} at {degrees} degrees"), m));
        }
    }
    all
}

/// Matte, glossy, nearly a mirror; squeezed lobes; the whole sphere; colours with a channel below 0.
fn synthetic() -> Vec<(String, Mixture<'static, 64>)> {
    let lobe = |axis: Vec3, sharpness: f32, color: Vec3| {
        Lobe::new(axis.normalize(), sharpness, color * sharpness.max(1.0) * 0.05).unwrap()
    };
    let matte = [lobe(Vec3::Z, 2.0, Vec3::new(0.8, 0.6, 0.4))];
    let glossy = [lobe(Vec3::new(0.5, 0.0, 1.0), 60.0, Vec3::ONE), matte[0]];
    let mirror = [lobe(Vec3::new(0.5, -0.3, 1.0), 3000.0, Vec3::ONE), glossy[0]];
    let blue = [Lobe::new(Vec3::Z, 20.0, Vec3::new(-0.2, 0.6, 2.0)).unwrap(), matte[0]];
    let mut random = Random(90);
    vec![
        ("matte".into(), Mixture::hemisphere(&matte).unwrap()),
        ("glossy".into(), Mixture::hemisphere(&glossy).unwrap()),
        ("mirror".into(), Mixture::hemisphere(&mirror).unwrap()),
        ("a channel below 0".into(), Mixture::hemisphere(&blue).unwrap()),
        ("squeezed".into(), Mixture::new(Domain::Hemisphere, 0.2, &glossy, &matte).unwrap()),
        ("the whole sphere".into(), random.mixture(Domain::Sphere, 5, 1.0)),
        ("one with a diffuse term".into(), with_diffuse()),
    ]
}

/// A sharp lobe above a diffuse term.
fn with_diffuse() -> Mixture<'static, 64> {
    let lobe = PlaneLobe {
        angle: 0.0,
        off_plane: 0.0,
        log2_sharpness: 9.0,
        log2_luminance: 4.0,
        color_differences: [0.2, -0.3],
    };
    let view = View {
        theta: 0.0,
        log2_squeeze: 0.0,
        log2_diffuse: -2.0,
        diffuse_color_differences: [0.5, -0.5],
        lobes: &[lobe],
    };
    let bytes: &'static mut [u8] = Box::leak(Box::new([0; 512]));
    let line = Line { views: &[view], squeezed: 0, mirrored: 0, factors: None };
    let length = line.encode("a test", bytes).unwrap();
    let mut m = Mixture::empty();
    let material: &'static _ = Box::leak(Box::new(Material::from_bytes(&bytes[..length]).unwrap()));
    material.prepare(Vec3::Z, &mut m).unwrap();
    m
}

fn maps() -> Vec<Map> {
    vec![
        Map::sky(),
        Map::constant(),
        Map::pixel(16, 8, 3, 2),
        Map::pixel(128, 64, 70, 20),
        Map::noise(64, 33),
        Map::noise(1, 9),
    ]
}

/// One estimate: a draw with the uniform numbers of a generator.
fn estimate(
    m: &AnyMixture<'_>,
    environment: &Environment<Vec<u32>>,
    frame: &[Vec3; 3],
    sampling: &ProductSampling,
    random: &mut Random,
) -> Option<srbf_core::ProductSample> {
    let mut u = [[0.0; 32]; 3];
    let n = sampling.candidates();
    u.iter_mut().for_each(|u| u[..n].fill_with(|| random.uniform()));
    let choice = random.uniform();
    m.sample_product(environment, frame, sampling, u.each_ref().map(|u| &u[..n]), choice).unwrap()
}

/// Statistics of a case: how many standard errors the means are apart, without and with the path's own ray, and the variance
/// relative to that of multiple importance sampling at as many directions.
struct Outcome {
    name: String,
    candidates: usize,
    apart: f64,
    apart_with_ray: f64,
    variance: f64,
    /// The standard error of that.
    error: f64,
    /// The luminance of some light was below 0.
    is_signed: bool,
}

fn examine(name: String, m: &Mixture<'_, 64>, map: &Map, candidates: usize, seed: u64) -> Outcome {
    let environment = map.environment().turned(seed as f32);
    let mut random = Random(seed);
    // A surface that sees some light.
    let axes = loop {
        let axes = frame(random.direction());
        let lit =
            (0..1000).map(|_| both_ways(m, &environment, &axes, |_| true, [random.three(), random.three()]));
        if lit.map(bright).sum::<f64>() > 0.0 {
            break axes;
        }
    };
    let (mut pairs, mut fourth) = (Moments::default(), Moments::default());
    let values: Vec<f64> = (0..PAIRS)
        .map(|_| bright(both_ways(m, &environment, &axes, |_| true, [random.three(), random.three()])))
        .collect();
    values.iter().for_each(|&v| pairs.see(v));
    let mean = pairs.mean();
    values.iter().for_each(|&v| fourth.see((v - mean).powi(4)));
    let sampling = ProductSampling::new(candidates, 0.5, f32::INFINITY).unwrap();
    let (mut alone, mut kurtosis, mut list) = (Moments::default(), Moments::default(), Vec::new());
    for _ in 0..DRAWS {
        let drawn = estimate(m, &environment, &axes, &sampling, &mut random);
        list.push(drawn.map_or(0.0, |drawn| bright(drawn.weight)));
    }
    list.iter().for_each(|&v| alone.see(v));
    list.iter().for_each(|&v| kurtosis.see((v - alone.mean()).powi(4)));
    let is_signed = list.iter().any(|&v| v < 0.0);
    let shared = ProductSampling::new(candidates, 0.5, 4.0).unwrap();
    let mut with_ray = Moments::default();
    for _ in 0..DRAWS {
        let drawn = estimate(m, &environment, &axes, &shared, &mut random);
        let mut sum = drawn.map_or(0.0, |drawn| bright(drawn.weight));
        if let Some(ray) = m.sample(random.three()) {
            let (radiance, pdf) = environment.radiance_and_pdf(to_world(&axes, ray.direction));
            sum += bright(ray.weight * radiance) * f64::from(shared.ray_weight(ray.pdf, pdf));
        }
        with_ray.see(sum);
    }
    let apart = |other: &Moments| {
        let error = other.error().hypot(pairs.error());
        // Where all draws bring the same, only rounding is left.
        (other.mean() - mean).abs() / error.max(2e-5 * mean.abs()).max(1e-30)
    };
    let spread = |m: &Moments, fourth: &Moments, n: usize| {
        let kurtosis = fourth.mean() / m.variance().powi(2).max(1e-300);
        ((kurtosis - 1.0).max(0.0) / n as f64).sqrt()
    };
    let error = spread(&alone, &kurtosis, DRAWS).hypot(spread(&pairs, &fourth, PAIRS));
    // A pair takes two directions. Where nothing varies, rounding is no variance.
    let floor = (1e-5 * mean).powi(2);
    let variance =
        (alone.variance() + floor) * candidates as f64 / (2.0 * pairs.variance() + floor * candidates as f64);
    Outcome {
        name,
        candidates,
        apart: apart(&alone),
        apart_with_ray: apart(&with_ray),
        variance,
        error,
        is_signed,
    }
}

/// Examines cases, two at a time.
fn examine_all(cases: &[(String, Mixture<'static, 64>, Map, usize)]) -> Vec<Outcome> {
    let run = |from: usize| {
        let own = cases.iter().enumerate().skip(from).step_by(2);
        own.map(|(i, (name, m, map, count))| {
            let name = format!("{name}, {}, {count} candidates", map.name);
            examine(name, m, map, *count, 4000 + i as u64)
        })
        .collect::<Vec<_>>()
    };
    std::thread::scope(|scope| {
        let other = scope.spawn(|| run(1));
        let mut all = run(0);
        all.extend(other.join().expect("no panic"));
        all
    })
}

/// Judges outcomes together.
fn judge(outcomes: &[Outcome]) {
    let n = outcomes.len() as f64;
    for o in outcomes {
        println!(
            "{}: {:.2} and {:.2} standard errors, variance {:.4} +- {:.4}",
            o.name, o.apart, o.apart_with_ray, o.variance, o.error
        );
    }
    let (mut beyond, mut worst, mut largest) = ([0; 2], 0f64, 0f64);
    for o in outcomes {
        for (i, apart) in [o.apart, o.apart_with_ray].into_iter().enumerate() {
            beyond[i] += usize::from(apart > 3.0);
            worst = worst.max(apart);
        }
        // Within 5 %, and the uncertainty of the test itself.
        if o.is_signed {
            // Nothing is drawn by light below 0: only no worse than by as many rays.
            println!("{} has light below 0: variance {:.3}", o.name, o.variance);
            assert!(o.variance < o.candidates as f64, "{}: {}", o.name, o.variance);
            continue;
        }
        let apart = (o.variance - 1.0).abs();
        assert!(apart < 0.05 || apart < 3.0 * o.error, "{}: variance {} +- {}", o.name, o.variance, o.error);
        largest = largest.max(o.variance);
    }
    // By chance alone one mean of 370 is more than three standard errors off: two are allowed, and none that is far off.
    let allowed = (0.0027 * n + 3.0 * (0.0027 * n).sqrt()).ceil() as usize;
    assert!(beyond.iter().all(|&b| b <= allowed), "{beyond:?} of {n} are beyond three standard errors");
    let far = 4.6; // probability 4e-6
    assert!(worst < far && sidak(0.01, 2 * outcomes.len()) > 4e-6, "{worst} standard errors");
    let plain: Vec<f64> = outcomes.iter().filter(|o| !o.is_signed).map(|o| o.variance).collect();
    // Measured paints outside the gamut have light below 0, with their highlights on a lamp; most cases have none.
    assert!(plain.len() as f64 > 0.8 * n, "{} of {n}", plain.len());
    let mean = plain.iter().sum::<f64>() / plain.len() as f64;
    println!(
        "{n} cases, {} with light below 0: at most {worst:.2} standard errors, variance {mean:.4} in the mean, {largest:.4} at most",
        outcomes.len() - plain.len()
    );
    assert!((mean - 1.0).abs() < 0.01, "{mean}");
}

/// Every mixture, map and number of candidates in some case; `statistics` of verbs tests sums and products on others.
#[test]
fn means_are_right_and_the_variance_is_that_of_as_many_draws() {
    let mut cases = Vec::new();
    for (i, (name, m)) in presets().into_iter().chain(synthetic()).enumerate() {
        for (j, map) in maps().into_iter().enumerate().filter(|(j, _)| (i + j) % 3 == 0) {
            cases.push((name.clone(), m.clone(), map, [8, 16, 32, 2, 4][(i + j / 3) % 5]));
        }
    }
    assert!(cases.len() >= 33);
    judge(&examine_all(&cases));
}

/// The same under real probes.
#[test]
#[ignore = "reads the maps in SRBF_DATA_DIR"]
fn means_are_right_under_real_probes() {
    let folder = PathBuf::from(std::env::var_os("SRBF_DATA_DIR").expect("SRBF_DATA_DIR")).join("envmaps");
    let mut cases = Vec::new();
    let files =
        ["cc0_forest_512", "cc0_hall_512", "funston_beach_latlong", "grace_latlong", "uffizi_latlong"];
    for (n, file) in files.into_iter().enumerate() {
        let map = Map::read(&folder.join(file).with_extension("hdr"));
        // Every mixture under one or two of the maps.
        let mixtures = presets().into_iter().chain(synthetic()).enumerate().filter(|(i, _)| (i + n) % 4 == 0);
        for (i, (name, m)) in mixtures {
            cases.push((name, m, map.clone(), [8, 16, 32][i % 3]));
        }
    }
    judge(&examine_all(&cases));
}

/// How far a direction drawn with others may be from one drawn alone: the tolerance of `Mixture::sample_product direction`.
const APART: f32 = 1e-6;

/// A draw by the plain text.
struct Plain {
    direction: Vec3,
    weight: DVec3,
    /// How far the choice was from falling on another, as a share of the whole.
    near: f64,
    /// How far the weight moves, over itself, where the directions of the candidates are [`APART`] off.
    moved: f64,
}

/// A candidate of the plain text: the light that it would bring, its luminance, and the weight it is chosen by.
struct Candidate {
    world: Vec3,
    light: DVec3,
    brought: f64,
    weight: f64,
}

/// The estimator in f64, in its plainest form, of candidates that single calls draw.
fn plain(
    m: &AnyMixture<'_>,
    environment: &Environment<Vec<u32>>,
    frame: &[Vec3; 3],
    [count, lobes]: [usize; 2],
    kappa: f64,
    u: [&[f32]; 3],
    choice: f32,
) -> Option<Plain> {
    let (count_f, of_lobes) = (count as f64, lobes as f64);
    let candidate = |world: Vec3| {
        let (value, p_b) = m.evaluate_and_pdf(to_local(frame, world));
        let (radiance, p_e) = environment.radiance_and_pdf(world);
        let light = radiance.as_dvec3() * value.as_dvec3();
        let (p_b, p_e) = (f64::from(p_b), f64::from(p_e));
        let p = (of_lobes * p_b + (count_f - of_lobes) * p_e) / count_f;
        // The integrand that is left to the candidates, over their density.
        let rest = if kappa.is_finite() { 1.0 - p_b / (p_b + kappa * p) } else { 1.0 };
        let brought = oracle::luminance(light).max(oracle::luminance(light.abs()) / 8.0);
        let target = rest * brought;
        let weight = if target > 0.0 && p > 1e-30 { target / p } else { 0.0 };
        Candidate { world, light, brought, weight }
    };
    let mut candidates = Vec::new();
    for i in 0..count {
        let u = [u[0][i], u[1][i], u[2][i]];
        let world =
            if i < lobes { to_world(frame, m.sample_direction(u)?) } else { environment.sample(u).direction };
        candidates.push(candidate(world));
    }
    let whole: f64 = candidates.iter().map(|c| c.weight).sum();
    if whole <= 0.0 {
        return None;
    }
    let place = f64::from(choice) * whole;
    let (mut sum, mut near) = (0.0, f64::INFINITY);
    let mut chosen = None;
    for c in &candidates {
        sum += c.weight;
        near = near.min((sum - place).abs() / whole);
        if chosen.is_none() && sum > place {
            chosen = Some(c);
        }
    }
    let chosen = chosen?;
    // The largest change of a number of a candidate, relative to `of`.
    let moved = |c: &Candidate, of: f64, change: &dyn Fn(&Candidate) -> f64| {
        let steps = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|axis| [axis, -axis]);
        let beside = steps.map(|step| candidate(c.world + step * APART));
        beside.map(|other| change(&other) / of).fold(0.0, f64::max)
    };
    let color = chosen.light / chosen.brought;
    let of_color = moved(chosen, color.abs().max_element(), &|other| {
        (other.light / other.brought - color).abs().max_element()
    });
    let of_weights: f64 =
        candidates.iter().map(|c| moved(c, whole, &|other| (other.weight - c.weight).abs())).sum();
    Some(Plain {
        direction: chosen.world,
        weight: color * (whole / count_f),
        near,
        moved: of_color + of_weights,
    })
}

#[test]
fn every_level_draws_what_a_plain_text_draws() {
    let mut of_direction = Worst::new("Mixture::sample_product direction");
    let mut of_weight = Worst::new("Mixture::sample_product weight");
    let mut mixtures = presets();
    mixtures.extend(synthetic());
    let (mut draws, mut near) = (0, 0);
    for (name, m) in &mixtures {
        for map in [Map::noise(16, 8), Map::sky(), Map::constant()] {
            let environment = map.environment().turned(0.4);
            for level in levels() {
                let m = m.clone().with_level(level).unwrap();
                // Every level draws the same.
                let mut random = Random(95);
                for round in 0..120 {
                    let axes = frame(random.direction());
                    let count = [2, 3, 8, 15, 16, 17, 31, 32][round % 8];
                    let share = [0.5, 0.0, 1.0, 0.3, 0.8][round % 5];
                    let kappa = [f32::INFINITY, 4.0, 0.5][round % 3];
                    let sampling = ProductSampling::new(count, share, kappa).unwrap();
                    let numbers: Vec<Vec3> = (0..count).map(|_| Vec3::from_array(random.three())).collect();
                    let u = [0, 1, 2].map(|i| numbers.iter().map(|n| n[i]).collect::<Vec<f32>>());
                    let u = u.each_ref().map(|u| &u[..]);
                    let choice = random.uniform();
                    let got = m.sample_product(&environment, &axes, &sampling, u, choice).unwrap();
                    let counts = [count, sampling.lobe_candidates()];
                    let want = plain(&m, &environment, &axes, counts, f64::from(kappa), u, choice);
                    let place =
                        || format!("{name}, {}, {level:?}, {count} candidates, {share}, {kappa}", map.name);
                    let (Some(got), Some(want)) = (got, &want) else {
                        assert!(got.is_none() && want.is_none(), "{}: {got:?}", place());
                        continue;
                    };
                    draws += 1;
                    // Light and lobes may be steep, as a dark place beside a bright pixel: there the rounding of a direction counts.
                    let rounding = f64::from(f32::EPSILON) + want.moved;
                    // It may choose the next one.
                    if want.near < 2.0 * rounding {
                        near += 1;
                        continue;
                    }
                    of_direction.see(f64::from((got.direction - want.direction).length()), place);
                    let error = (got.weight.as_dvec3() - want.weight).abs().max_element()
                        / want.weight.abs().max_element();
                    of_weight.see(error / rounding, place);
                }
            }
        }
    }
    let measured = [of_direction, of_weight];
    for worst in &measured {
        println!("{:36} {:.2e}, {} ({})", worst.name, worst.error, worst.place, worst.count);
    }
    println!("{near} of {draws} draws are nearly another");
    assert!(draws > 1000 && near < draws / 100, "{near} of {draws}");
    let failures: Vec<String> = measured.iter().filter_map(Worst::failure).collect();
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

#[test]
fn numbers_that_are_none_are_refused() {
    for (candidates, share, kappa, error) in [
        (0, 0.5, 1.0, Error::Candidates),
        (1, 0.5, 1.0, Error::Candidates),
        (33, 0.5, 1.0, Error::Candidates),
        (usize::MAX, 0.5, 1.0, Error::Candidates),
        (8, -0.1, 1.0, Error::Share),
        (8, 1.1, 1.0, Error::Share),
        (8, f32::NAN, 1.0, Error::Share),
        (8, 0.5, 0.0, Error::Kappa),
        (8, 0.5, f32::NAN, Error::Kappa),
        (8, 0.5, -1.0, Error::Kappa),
    ] {
        assert_eq!(
            ProductSampling::new(candidates, share, kappa),
            Err(error),
            "{candidates} {share} {kappa}"
        );
    }
    for candidates in 2..=32_usize {
        for (share, lobes) in [(0.0, 0), (1.0, candidates), (0.5, candidates.div_ceil(2))] {
            let sampling = ProductSampling::new(candidates, share, 1e-3).unwrap();
            assert_eq!((sampling.candidates(), sampling.lobe_candidates()), (candidates, lobes));
        }
    }
    let (environment, m) = (Map::sky().environment(), with_diffuse());
    let sampling = ProductSampling::new(4, 0.5, 1.0).unwrap();
    let axes = frame(Vec3::Z);
    let numbers = [0.5; 5];
    for lengths in [[3, 4, 4], [4, 5, 4], [4, 4, 0], [5, 5, 5]] {
        let u = lengths.map(|n| &numbers[..n]);
        assert_eq!(
            m.sample_product(&environment, &axes, &sampling, u, 0.5),
            Err(Error::Length),
            "{lengths:?}"
        );
    }
    let u = [&numbers[..4]; 3];
    let black = Mixture::<16>::empty();
    assert_eq!(black.sample_product(&environment, &axes, &sampling, u, 0.5), Ok(None));
    // No light above the horizon.
    let below = Map::pixel(16, 8, 3, 7).environment();
    assert_eq!(m.sample_product(&below, &axes, &sampling, u, 0.5), Ok(None));
    // The whole weight of a ray.
    let alone = ProductSampling::new(8, 0.5, f32::INFINITY).unwrap();
    assert_eq!((alone.ray_weight(1.0, 1.0), alone.ray_weight(0.0, 0.0)), (0.0, 0.0));
    let shared = ProductSampling::new(8, 0.5, 4.0).unwrap();
    for (pdf, other) in [(1.0, 2.0), (1e8, 0.0), (1e-30, 1e7), (0.0, 1.0)] {
        let want = if pdf > 0.0 { pdf / (pdf + 4.0 * 0.5 * (pdf + other)) } else { 0.0 };
        assert!((f64::from(shared.ray_weight(pdf, other)) - f64::from(want)).abs() < 1e-6, "{pdf} {other}");
    }
}

/// Sharp lobes, bright and dim maps, the ends of uniform numbers: no NaN, nothing infinite, no panic.
#[test]
fn the_ends_of_the_range_are_finite() {
    let sharp = Mixture::<16>::hemisphere(&[Lobe::new(Vec3::Z, 1e8, Vec3::splat(1e7)).unwrap()]).unwrap();
    let grazing = Mixture::<16>::hemisphere(&[Lobe::new(Vec3::X, 1e6, Vec3::splat(1e3)).unwrap()]).unwrap();
    let mut random = Random(99);
    let mut count = 0;
    for scale in [1e-27, 1.0, 1e27] {
        for mut map in [Map::constant(), Map::pixel(128, 64, 70, 20), Map::noise(16, 8)] {
            map.pixels.iter_mut().flatten().for_each(|v| *v *= scale);
            let environment = map.environment();
            for m in [&sharp, &grazing] {
                for level in levels() {
                    let m = m.clone().with_level(level).unwrap();
                    for round in 0..200 {
                        let candidates = [2, 16, 32][round % 3];
                        let kappa = [1e-3, f32::INFINITY][round % 2];
                        let share = [0.0, 1.0, 0.5][round / 3 % 3];
                        let sampling = ProductSampling::new(candidates, share, kappa).unwrap();
                        let mut end = || UNIFORM[(random.uniform() * UNIFORM.len() as f32) as usize];
                        let u: [Vec<f32>; 3] = [(); 3].map(|()| (0..candidates).map(|_| end()).collect());
                        let choice = end();
                        let axes = frame(if round % 4 == 0 { Vec3::Z } else { random.direction() });
                        let u = u.each_ref().map(|u| &u[..]);
                        let drawn = m.sample_product(&environment, &axes, &sampling, u, choice).unwrap();
                        if let Some(drawn) = drawn {
                            assert!(
                                drawn.weight.is_finite() && drawn.weight.min_element() >= 0.0,
                                "{drawn:?}"
                            );
                            assert!((drawn.direction.length() - 1.0).abs() < 1e-5, "{drawn:?}");
                            count += 1;
                        }
                    }
                }
            }
        }
    }
    assert!(count > 1000, "{count}");
}
