//! Every unbiased method converges to the same picture: a test of every pixel, with false discoveries controlled.

use crate::numbers::points::PointsName;
use crate::out::progress::Progress;
use crate::shade::shader::Shader;
use crate::shade::{Light, Sampler, SamplerName, Strategy};
use crate::trace::film::Film;
use crate::trace::render::add_samples;
use crate::trace::scene::{Scene, SceneName};
use crate::trace::settings::RenderSettings;
use crate::truth::Truth;
use crate::truth::measured::tests::model;
use crate::truth::stored::StoredMaterial;
use crate::world::environment::Environment;
use std::f64::consts::SQRT_2;

/// Pixels along each side: for all methods, and for three of them.
const SIDE: u32 = 4;
const LARGER_SIDE: u32 = 6;

/// Pictures of a method with seeds of their own, from which the error of its mean is told: so of Sobol points too.
const REPEATS: u64 = 32;
const SAMPLES: u32 = 128;

/// Share of the findings that may be due to chance.
const FALSE_DISCOVERIES: f64 = 0.01;

/// Mean, and its variance, of a pixel's brightness.
type Pixel = (f64, f64);

fn pixels(
    scene: &Scene<'_>,
    side: u32,
    strategy: Strategy,
    points: PointsName,
    first_seed: u64,
) -> Vec<Pixel> {
    let size = [side; 2];
    let split = if strategy.sampler.is_multi() { 4 } else { 1 };
    let camera = SceneName::Sphere.camera(size);
    let mut sums = vec![(0.0, 0.0); (side * side) as usize];
    for repeat in 0..REPEATS {
        let mut film = Film::new(size);
        let settings = RenderSettings {
            light: strategy.light,
            split,
            max_bounces: 1,
            points,
            seed: first_seed + repeat,
        };
        add_samples(scene, &camera, &settings, &mut film, SAMPLES / split, &Progress::hidden()).unwrap();
        for (i, sum) in sums.iter_mut().enumerate() {
            let value = film.mean(i).element_sum();
            *sum = (sum.0 + value, sum.1 + value * value);
        }
    }
    let n = REPEATS as f64;
    sums.into_iter()
        .map(|(sum, squares)| (sum / n, (squares - sum * sum / n).max(0.0) / (n * (n - 1.0))))
        .collect()
}

/// Probability of a difference as large as that of two means, or larger: Student's t by Wallace's approximation.
fn probability(a: Pixel, b: Pixel) -> f64 {
    let variance = a.1 + b.1;
    if variance == 0.0 {
        return if a.0 == b.0 { 1.0 } else { 0.0 };
    }
    let freedom = (REPEATS - 1) as f64 * variance * variance / (a.1 * a.1 + b.1 * b.1);
    let square = (a.0 - b.0) * (a.0 - b.0) / variance;
    let z = (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0) * (freedom * (square / freedom).ln_1p()).sqrt();
    two_sided(z)
}

/// Probability that a normal deviate is farther from 0 (Abramowitz and Stegun 1964, 7.1.26: within 1.5e-7).
fn two_sided(z: f64) -> f64 {
    let x = z.abs() / SQRT_2;
    let t = 1.0 / (1.0 + 0.327_591_1 * x);
    let polynomial = [1.061_405_429, -1.453_152_027, 1.421_413_741, -0.284_496_736, 0.254_829_592];
    polynomial.iter().fold(0.0, |sum, c| (sum + c) * t) * (-x * x).exp()
}

/// The names of the tests that fail, by Benjamini and Hochberg 1995.
fn discoveries(mut tested: Vec<(f64, String)>) -> Vec<(f64, String)> {
    tested.sort_by(|a, b| a.0.total_cmp(&b.0));
    let n = tested.len() as f64;
    let is_found = |(k, test): (usize, &(f64, String))| test.0 <= FALSE_DISCOVERIES * (k + 1) as f64 / n;
    let found =
        tested.iter().enumerate().filter(|&test| is_found(test)).map(|(k, _)| k + 1).max().unwrap_or(0);
    tested.truncate(found);
    tested
}

/// Tests every pixel of every method against one method; `bias` is a factor on the mean of a method, to show that the test finds it.
fn tested(
    what: &str,
    truth: Truth<'_>,
    side: u32,
    is_tried: impl Fn(&SamplerName) -> bool,
    bias: impl Fn(Strategy, PointsName) -> f64,
) -> Vec<(f64, String)> {
    let light = (0..32 * 16).map(|i| glam::Vec3::splat(1.0 + ((i * 37) % 11) as f32)).collect();
    let light = Environment::new(32, light).unwrap();
    let names: Vec<SamplerName> = SamplerName::all().filter(is_tried).collect();
    let samplers: Vec<Sampler<'_>> =
        Sampler::fit_all(names.iter().copied(), &truth, None).map(|(_, fitted)| fitted.unwrap()).collect();
    let scene = |name: SamplerName| {
        let shader =
            Shader { truth, sampler: &samplers[names.iter().position(|&other| other == name).unwrap()] };
        Scene::new(SceneName::Sphere, shader, shader, &light)
    };
    let expected = pixels(&scene(SamplerName::Lobes), side, Strategy::MIS, PointsName::Random, 1000);
    let alone = names.iter().map(|&name| Strategy::alone(name));
    let beside = names.iter().map(|&sampler| Strategy { sampler, light: Light::Mis });
    let methods = alone.chain(beside).chain([Strategy::PRODUCT, "light".parse().unwrap()]);
    let mut tests = Vec::new();
    for strategy in methods {
        // The spread of points is the same for every sampler: lobes alone, beside the light, and times the light have both.
        let is_both =
            [Strategy::alone(SamplerName::Lobes), Strategy::MIS, Strategy::PRODUCT].contains(&strategy);
        let all_points = [PointsName::Random, PointsName::Sobol];
        for &points in &all_points[..1 + usize::from(is_both)] {
            let factor = bias(strategy, points);
            let found = pixels(&scene(strategy.sampler), side, strategy, points, 1);
            for (i, (&pixel, &expected)) in found.iter().zip(&expected).enumerate() {
                let pixel = (pixel.0 * factor, pixel.1 * factor * factor);
                let text =
                    format!("{what}, {strategy}, {points:?}, pixel {i}: {pixel:?}, expected {expected:?}");
                tests.push((probability(pixel, expected), text));
            }
        }
    }
    tests
}

/// Warps come with files, and the random walk is biased.
fn is_unbiased(name: &SamplerName) -> bool {
    !matches!(name, SamplerName::Rgl | SamplerName::ThesisWalk)
}

#[test]
fn every_unbiased_method_converges_to_the_same_picture() {
    let lobes = StoredMaterial::load("garnet_red").unwrap();
    let table = model("model:ggx:alpha=0.3,f0=0.6/0.4/0.2,diffuse=0.1");
    let mut tests = tested("garnet red", Truth::Lobes(&lobes.material), SIDE, is_unbiased, |_, _| 1.0);
    tests.extend(tested("ggx", Truth::Table(&table), SIDE, is_unbiased, |_, _| 1.0));
    let found = discoveries(tests);
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn a_bias_of_one_percent_of_one_method_is_found() {
    let table = model("model:ggx:alpha=0.3,f0=0.6/0.4/0.2,diffuse=0.1");
    let is_quick =
        |name: &SamplerName| matches!(name, SamplerName::Lobes | SamplerName::Guided | SamplerName::Cosine);
    let planted = |strategy, points| {
        let is_it = strategy == Strategy::MIS && points == PointsName::Sobol;
        if is_it { 1.01 } else { 1.0 }
    };
    let found = discoveries(tested("ggx", Truth::Table(&table), LARGER_SIDE, is_quick, planted));
    let of_others = found.iter().filter(|test| !test.1.contains("mis, Sobol")).count();
    // In an eighth of the pixels and more. One in a hundred may be found by chance.
    assert!(
        8 * found.len() > (LARGER_SIDE * LARGER_SIDE) as usize && of_others <= 1,
        "{of_others} of others: {found:#?}"
    );
}

#[test]
fn probabilities_are_those_of_tables() {
    for (z, p) in [(0.0, 1.0), (1.0, 0.317_311), (2.575_829, 0.01), (4.0, 6.334e-5)] {
        assert!((two_sided(z) - p).abs() < 1e-6, "{z}: {}", two_sided(z));
    }
    let tests = [1e-9, 0.004, 0.3, 0.9].map(|p| (p, String::new())).to_vec();
    assert_eq!(discoveries(tests).len(), 2);
}
