//! Pictures and errors of methods, the more samples the smaller.

use super::materials::FittedPaint;
use glam::{DVec3, Vec3};
use srbf_reference_renderer::numbers::points::PointsName;
use srbf_reference_renderer::out::progress::Progress;
use srbf_reference_renderer::shade::Strategy;
use srbf_reference_renderer::shade::shader::Shader;
use srbf_reference_renderer::study::comparison::curve::{Curve, Point, Shown};
use srbf_reference_renderer::study::comparison::{
    Comparison, Estimate, Judge, Method, Reading, ReferenceReport, RelativeMse,
};
use srbf_reference_renderer::trace::film::Film;
use srbf_reference_renderer::trace::render::add_samples;
use srbf_reference_renderer::trace::scene::{Role, Scene, SceneName};
use srbf_reference_renderer::trace::settings::RenderSettings;
use srbf_reference_renderer::world::environment::Environment;
use srbf_reference_renderer::world::mesh::Mesh;

/// The scene: the object's material, the ground's, and the light.
pub struct Subject<'a> {
    pub scene: SceneName,
    pub mesh: Option<Mesh>,
    pub object: &'a FittedPaint<'a>,
    pub ground: &'a FittedPaint<'a>,
    pub light: &'static str,
    pub environment: &'a Environment,
    pub size: [u32; 2],
    pub max_bounces: u32,
}

/// A method, and the counts at which its error is taken: counts of samples, rising.
pub type Task<'t> = (Method, &'t [u32]);

/// How well it is measured.
#[derive(Clone, Copy)]
pub struct Effort {
    pub repeats: u32,
    /// Sobol points a pixel of the reference.
    pub reference_samples: u32,
    pub seed: u64,
}

/// The curves of a subject, and the pictures of each method at each count.
pub struct Measured {
    pub comparison: Comparison,
    pub pictures: Vec<Vec<Vec<Vec3>>>,
}

impl Subject<'_> {
    /// Rows that are rendered in all: the steps of the progress.
    pub fn steps(&self, tasks: &[Task<'_>], effort: Effort) -> u64 {
        let counts: usize = tasks.iter().map(|task| task.1.len()).sum();
        u64::from(self.size[1]) * (2 + u64::from(effort.repeats) * counts as u64)
    }

    fn scene(&self, method: Method) -> Scene<'_> {
        let shader = |role: Role| -> Shader<'_> {
            let fitted = if role == Role::Object { self.object } else { self.ground };
            match method.reading {
                Reading::Itself => fitted.shader(method.strategy.sampler),
                Reading::Fit => fitted.itself(method.strategy.sampler),
            }
        };
        Scene::build(self.scene.shapes(self.mesh.clone()), shader, self.environment)
    }

    fn settings(&self, strategy: Strategy, points: PointsName, seed: u64) -> RenderSettings {
        RenderSettings { light: strategy.light, split: 1, max_bounces: self.max_bounces, points, seed }
    }

    /// Renders the reference, then every method at every count.
    ///
    /// # Errors
    /// None but faults of the renderer.
    pub fn measure(
        &self,
        tasks: &[Task<'_>],
        effort: Effort,
        progress: &Progress,
    ) -> anyhow::Result<Measured> {
        let own = self.scene(Method::of(Strategy::PRODUCT));
        let camera = self.scene.camera(self.size);
        let pixels = self.size[0] as usize * self.size[1] as usize;
        let half = |seed: u64| -> anyhow::Result<Vec<DVec3>> {
            let mut film = Film::new(self.size);
            let settings =
                self.settings(Strategy::PRODUCT, PointsName::Sobol, effort.seed.wrapping_add(seed));
            add_samples(&own, &camera, &settings, &mut film, effort.reference_samples.div_ceil(2), progress)?;
            Ok((0..pixels).map(|i| film.mean(i)).collect())
        };
        let halves = [half(1)?, half(2)?];
        let judge = Judge::new(&own, &camera, self.size, &halves);
        let (mut curves, mut pictures) = (Vec::new(), Vec::new());
        for &(method, counts) in tasks {
            let scene = self.scene(method);
            let mut errors: Vec<Vec<(f64, RelativeMse)>> = vec![Vec::new(); counts.len()];
            let mut shown = Vec::new();
            for repeat in 0..effort.repeats {
                let (mut film, mut seconds) = (Film::new(self.size), 0.0);
                // Independent samples: the error is that of a method, and not of its points.
                let seed = effort.seed.wrapping_add(16 + u64::from(repeat));
                let settings = self.settings(method.strategy, PointsName::Random, seed);
                for (at, &count) in counts.iter().enumerate() {
                    let more = count - film.samples;
                    seconds +=
                        add_samples(&scene, &camera, &settings, &mut film, more, progress)?.as_secs_f64();
                    errors[at].push((seconds, judge.error(&film)));
                    if repeat == 0 {
                        shown.push(film.to_picture());
                    }
                }
            }
            let points =
                counts.iter().zip(&errors).map(|(&samples, errors)| point(samples, errors, judge.own));
            let title = scene.object().sampler.title(&scene.object().truth);
            curves.push(Curve {
                method,
                title,
                points: points.collect(),
                bias: None,
                shown: Shown::default(),
            });
            pictures.push(shown);
        }
        let picture = halves[0].iter().zip(&halves[1]).map(|(a, b)| (0.5 * (*a + *b)).as_vec3()).collect();
        let samples = effort.reference_samples.div_ceil(2) * 2;
        let reference = ReferenceReport { samples, own: judge.own, was_kept: false, picture };
        let comparison = Comparison {
            scene: self.scene.text(),
            material: self.object.painted.title.to_owned(),
            environment: self.light.to_owned(),
            size: self.size,
            curves,
            reference,
        };
        Ok(Measured { comparison, pictures })
    }
}

fn point(samples: u32, errors: &[(f64, RelativeMse)], own: RelativeMse) -> Point {
    let of = |what: fn(&RelativeMse) -> f64| {
        Estimate::of(&errors.iter().map(|e| what(&e.1)).collect::<Vec<f64>>())
    };
    let mse = of(|error| error.trimmed);
    Point {
        samples,
        seconds: errors.iter().map(|error| error.0).sum::<f64>() / errors.len().max(1) as f64,
        mse,
        whole_mse: of(|error| error.whole),
        is_below_reference: mse.mean < own.trimmed,
    }
}
