//! Error against run time and against samples, sampler by sampler, on the sphere.
//!
//! Pure sampling of the material under the environment, without samples of the light (Weng and Shih 2006, section 5.3):
//! one scattering, so that the error is that of the choice of directions alone. The samplers take turns, so that a
//! change of the machine's load meets all of them.

use crate::camera::Camera;
use crate::environment::Environment;
use crate::film::Film;
use crate::material::StoredMaterial;
use crate::points::PointsName;
use crate::progress::Progress;
use crate::render::{Settings, add_samples};
use crate::sampling::Strategy;
use crate::sampling::sampler::{OWN, Sampler};
use crate::scene::{Scene, SceneName};
use crate::shader::{LoadedMaterial, Shader};
use anyhow::Context;
use glam::DVec3;
use std::time::Instant;

/// What is compared.
#[derive(Clone, Debug)]
pub struct Plan {
    pub strategies: Vec<Strategy>,
    /// Sides of the square picture, pixels.
    pub side: u32,
    /// Samples a pixel at which the error is taken, rising.
    pub samples: Vec<u32>,
    /// Samples a pixel of the reference, which is rendered by multiple importance sampling.
    pub reference_samples: u32,
    pub seed: u64,
}

impl Plan {
    /// Rows that are rendered in all: the steps of the progress.
    pub fn steps(&self) -> u64 {
        u64::from(self.side) * (2 + (self.strategies.len() * (self.samples.len() + 1)) as u64)
    }
}

/// One measurement.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Samples a pixel.
    pub samples: u32,
    /// Time to render all of them.
    pub seconds: f64,
    /// Root of the mean squared difference from the reference, over the mean of the reference; not above 0 where the error
    /// of the reference itself is as large.
    pub error: f64,
}

/// The measurements of one sampler.
#[derive(Clone, Debug)]
pub struct Curve {
    pub strategy: Strategy,
    pub points: Vec<Point>,
}

/// The curves of one material under one environment.
#[derive(Clone, Debug)]
pub struct Comparison {
    pub material: String,
    pub environment: String,
    pub curves: Vec<Curve>,
    /// Relative error of the reference itself, estimated from its two halves; already taken off the curves.
    pub reference_error: f64,
}

/// Directions that samplers which draw several together draw at a surface, unless fewer are asked for.
pub const SPLIT: u32 = 16;

/// Measures the curves. `lobes` sample a table.
///
/// # Errors
/// A sampler that cannot be fitted to the material; else only faults of the renderer.
pub fn measure(
    plan: &Plan,
    material: &LoadedMaterial,
    lobes: Option<&StoredMaterial>,
    environment_name: &str,
    environment: &Environment,
    progress: &Progress,
) -> anyhow::Result<Comparison> {
    let truth = material.truth();
    let fit =
        |strategy: &Strategy| Sampler::fit(strategy.sampler, &truth, lobes.map(|lobes| &lobes.material));
    let samplers: Vec<Sampler<'_>> = plan
        .strategies
        .iter()
        .map(fit)
        .collect::<anyhow::Result<_>>()
        .with_context(|| format!("material {}", material.name()))?;
    let scene_of = |sampler| {
        let shader = Shader { truth, sampler };
        Scene::new(SceneName::Sphere, shader, shader, environment)
    };
    let scenes: Vec<Scene<'_>> = samplers.iter().map(scene_of).collect();
    let camera = SceneName::Sphere.camera([plan.side; 2]);
    let settings = |strategy: Strategy, split, seed| Settings {
        light: strategy.light,
        split,
        max_bounces: 1,
        points: PointsName::Random,
        seed,
    };

    // Two halves with their own seeds: their difference tells how far the mean of both is from the truth.
    let own = scene_of(&OWN);
    let mut halves = [Film::new([plan.side; 2]), Film::new([plan.side; 2])];
    for (i, half) in halves.iter_mut().enumerate() {
        let seed = plan.seed.wrapping_add(1 + i as u64);
        let samples = plan.reference_samples.div_ceil(2);
        add_samples(&own, &camera, &settings(Strategy::MIS, 1, seed), half, samples, progress)?;
    }
    let reference = Reference::new(&own, &camera, &halves);

    let mut curves: Vec<Curve> =
        plan.strategies.iter().map(|&strategy| Curve { strategy, points: Vec::new() }).collect();
    let mut films = vec![Film::new([plan.side; 2]); curves.len()];
    for (curve, scene) in curves.iter().zip(&scenes) {
        // Into a film that is thrown away: caches and clock speed settle.
        let mut film = Film::new([plan.side; 2]);
        add_samples(scene, &camera, &settings(curve.strategy, 1, plan.seed), &mut film, 1, progress)?;
    }
    for &samples in &plan.samples {
        for ((curve, film), scene) in curves.iter_mut().zip(&mut films).zip(&scenes) {
            // Directions that are drawn together are worth more the more there are: such a film does not go on from a smaller one.
            let is_multi = curve.strategy.sampler.is_multi();
            if is_multi {
                *film = Film::new([plan.side; 2]);
            }
            // The directions of a ray count, not the rays.
            let split = if is_multi { samples.min(SPLIT) } else { 1 };
            let more = samples.div_ceil(split) - film.samples;
            let start = Instant::now();
            add_samples(scene, &camera, &settings(curve.strategy, split, plan.seed), film, more, progress)?;
            let before = curve.points.last().filter(|_| !is_multi).map_or(0.0, |point| point.seconds);
            let seconds = before + start.elapsed().as_secs_f64();
            curve.points.push(Point {
                samples: film.samples * split,
                seconds,
                error: reference.error_of(film),
            });
        }
    }
    Ok(Comparison {
        material: material.name().to_owned(),
        environment: environment_name.to_owned(),
        curves,
        reference_error: reference.error,
    })
}

/// Where the error is taken: the outgoing direction at most 80 degrees from the normal.
///
/// Gonioreflectometers end there, and beyond it a material is extrapolation. With the spikes that it has there a few
/// pixels of the outline would decide a root mean square.
const LEAST_COSINE: f32 = 0.173_648_18;

/// The converged picture, on the pixels where the error is taken.
struct Reference {
    /// Pixel and its value.
    pixels: Vec<(usize, DVec3)>,
    mean: f64,
    /// Error of the reference itself.
    error: f64,
}

impl Reference {
    fn new(scene: &Scene<'_>, camera: &Camera, halves: &[Film; 2]) -> Self {
        let [width, height] = halves[0].size();
        let counts = |i: usize| {
            let ray = camera.ray((i as u32 % width) as f32 + 0.5, (i as u32 / width) as f32 + 0.5);
            scene.hit(&ray).is_some_and(|surface| -surface.smooth.dot(ray.direction) >= LEAST_COSINE)
        };
        let pixels: Vec<(usize, DVec3)> = (0..(width * height) as usize)
            .filter(|&i| counts(i))
            .map(|i| (i, 0.5 * (halves[0].mean(i) + halves[1].mean(i))))
            .collect();
        let sum: f64 = pixels.iter().map(|(_, value)| value.element_sum() / 3.0).sum();
        let mean = sum / pixels.len().max(1) as f64;
        // The mean of two independent halves has half their difference as error.
        let differences = pixels.iter().map(|&(i, _)| 0.5 * (halves[0].mean(i) - halves[1].mean(i)));
        Self { error: root_mean_square(differences) / mean, pixels, mean }
    }

    /// Relative error of a film, without the part that is the reference's own: independent errors add in squares.
    fn error_of(&self, film: &Film) -> f64 {
        let differences = self.pixels.iter().map(|&(i, value)| film.mean(i) - value);
        let whole = root_mean_square(differences) / self.mean;
        (whole * whole - self.error * self.error).max(0.0).sqrt()
    }
}

/// Over the pixels and the three channels.
fn root_mean_square(differences: impl ExactSizeIterator<Item = DVec3>) -> f64 {
    let count = 3.0 * differences.len().max(1) as f64;
    (differences.map(DVec3::length_squared).sum::<f64>() / count).sqrt()
}

impl Point {
    /// The error, unless the reference is too poor to tell it.
    pub fn known_error(&self) -> Option<f64> {
        (self.error > 0.0 && self.error.is_finite()).then_some(self.error)
    }
}

impl Curve {
    /// The points whose error is known.
    pub fn known(&self) -> impl Iterator<Item = &Point> {
        self.points.iter().filter(|p| p.known_error().is_some())
    }

    /// Slope of log error against log samples, by least squares; `None` with fewer than two points.
    pub fn slope(&self) -> Option<f64> {
        let points: Vec<[f64; 2]> = self.known().map(|p| [f64::from(p.samples).ln(), p.error.ln()]).collect();
        let n = points.len() as f64;
        let [x, y] = [0, 1].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / n);
        let covariance: f64 = points.iter().map(|p| (p[0] - x) * (p[1] - y)).sum();
        let variance: f64 = points.iter().map(|p| (p[0] - x) * (p[0] - x)).sum();
        (points.len() > 1).then(|| covariance / variance)
    }

    /// The error at a time, interpolated in logarithms; beyond the ends along the nearest piece.
    pub fn error_at(&self, seconds: f64) -> Option<f64> {
        let points: Vec<Point> = self.known().copied().collect();
        match points.as_slice() {
            [] => None,
            [only] => Some(only.error),
            points => {
                let after =
                    points.iter().position(|p| p.seconds >= seconds).unwrap_or(points.len() - 1).max(1);
                let [a, b] = [points[after - 1], points[after]];
                let share = (seconds / a.seconds).ln() / (b.seconds / a.seconds).ln();
                Some((a.error.ln() + share * (b.error.ln() - a.error.ln())).exp())
            }
        }
    }
}

impl Comparison {
    /// The longest time that every sampler was run for.
    pub fn common_seconds(&self) -> f64 {
        let longest = self.curves.iter().filter_map(|c| c.points.last()).map(|p| p.seconds);
        longest.fold(f64::INFINITY, f64::min)
    }

    /// How many times the first sampler's error another sampler's is, after equal times and after equal samples.
    /// `None` where the errors are not known.
    pub fn error_ratios(&self, curve: &Curve) -> [Option<f64>; 2] {
        let seconds = self.common_seconds();
        let by_time = |curve: &Curve| curve.error_at(seconds);
        let by_samples = |curve: &Curve| curve.points.last()?.known_error();
        let ratio = |error: &dyn Fn(&Curve) -> Option<f64>| Some(error(curve)? / error(&self.curves[0])?);
        [ratio(&by_time), ratio(&by_samples)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::tests::lacquer;
    use crate::sampling::SamplerName;

    const LOBES: Strategy = Strategy::alone(SamplerName::Lobes);

    fn plan(side: u32) -> Plan {
        Plan {
            strategies: [SamplerName::Lobes, SamplerName::Uniform, SamplerName::Cosine]
                .map(Strategy::alone)
                .to_vec(),
            side,
            samples: vec![4, 8, 16, 32, 64, 128],
            reference_samples: 1024,
            seed: 7,
        }
    }

    #[test]
    fn error_falls_with_the_square_root_of_the_samples() {
        // A light without a sharp sun and a material without a sharp highlight: 48 x 48 pixels are then enough to
        // estimate a slope.
        let pixels = (0..32 * 16).map(|i| glam::Vec3::splat(0.2 + ((i * 37) % 11) as f32)).collect();
        let environment = Environment::new(32, pixels).unwrap();
        let matte = LoadedMaterial::load("matte").unwrap();
        let result = measure(&plan(48), &matte, None, "test", &environment, &Progress::hidden()).unwrap();
        for curve in &result.curves {
            let slope = curve.slope().unwrap();
            assert!((slope + 0.5).abs() < 0.03, "{}: {slope}", curve.strategy);
        }
        // A sharp highlight is where lobes gain.
        let result = measure(
            &plan(24),
            &LoadedMaterial::Lobes(lacquer()),
            None,
            "test",
            &environment,
            &Progress::hidden(),
        )
        .unwrap();
        for curve in &result.curves[1..] {
            let [_, by_samples] = result.error_ratios(curve);
            assert!(by_samples > Some(1.2), "lobes must beat {}: {by_samples:?}", curve.strategy);
        }
    }

    #[test]
    fn interpolation_and_slope_of_a_known_curve() {
        let point = |samples: u32| Point {
            samples,
            seconds: 0.5 * f64::from(samples),
            error: 3.0 / f64::from(samples).sqrt(),
        };
        let curve = Curve { strategy: LOBES, points: [1, 4, 16].map(point).to_vec() };
        assert!((curve.slope().unwrap() + 0.5).abs() < 1e-12);
        for seconds in [0.1, 0.5, 1.3, 8.0, 40.0] {
            let error = curve.error_at(seconds).unwrap();
            assert!((error - 3.0 / (2.0 * seconds).sqrt()).abs() < 1e-12);
        }
    }

    #[test]
    fn errors_below_that_of_the_reference_are_left_out() {
        let point = |(samples, error)| Point { samples, seconds: f64::from(samples), error };
        let curve = |points: &[(u32, f64)]| Curve {
            strategy: LOBES,
            points: points.iter().copied().map(point).collect(),
        };
        let some = curve(&[(1, 1.0), (4, 0.5), (16, 0.0), (64, f64::NAN)]);
        assert!((some.slope().unwrap() + 0.5).abs() < 1e-12);
        assert!((some.error_at(4.0).unwrap() - 0.5).abs() < 1e-12);
        let none = curve(&[(1, 0.0)]);
        assert_eq!((none.slope(), none.error_at(1.0)), (None, None));
        let comparison = Comparison {
            material: String::new(),
            environment: String::new(),
            curves: vec![some.clone(), none.clone()],
            reference_error: 0.5,
        };
        assert_eq!(comparison.error_ratios(&some)[1], None);
        assert_eq!(comparison.error_ratios(&none), [None, None]);
    }
}
