//! Error against run time and against samples, method by method, on one scene.
//!
//! A [`Case`] is a scene to render, a [`Plan`] says how it is measured, and [`measure`] gives a [`Comparison`]. Times are those of the processors
//! that work on a picture, not the clock's. The methods take turns, so that a change of the machine's load meets all of them.
//! Fitting samplers and building scenes is not counted.
//!
//! | file | holds |
//! |---|---|
//! | `method` | a strategy, and the material that is rendered with it |
//! | `reference` | the converged picture, kept in a file |
//! | `error` | relative mean squared error, its part that is bias |
//! | `curve` | the points of a method: slope, error after a time |
//! | `page` | a comparison as a page: tables, pictures, errors in false colours |

pub mod curve;
pub mod error;
pub mod method;
pub mod page;
pub mod plot;
pub mod reference;
pub mod report;

use crate::numbers::points::PointsName;
use crate::out::print::error_line;
use crate::out::progress::Progress;
use crate::shade::{Light, Sampler, SamplerName, Strategy};
use crate::trace::camera::Camera;
use crate::trace::cast::Cast;
use crate::trace::film::{Film, warning_of};
use crate::trace::render::add_samples;
use crate::trace::scene::{Scene, SceneName};
use crate::trace::settings::RenderSettings;
use crate::truth::Truth;
use crate::world::environment::Environment;
use crate::world::mesh::Mesh;
pub use curve::{Curve, Point, Shown};
pub use error::{Estimate, Judge, RelativeMse, Repeats};
use glam::{DVec3, Vec3};
pub use method::{Method, Reading};
use reference::Key;
use std::path::PathBuf;

/// Directions that samplers which draw several together draw at a surface, unless fewer are asked for.
pub const SPLIT: u32 = 16;

/// Most samples a pixel of a time budget.
const MAX_SAMPLES: f64 = (1 << 24) as f64;

/// Least time of processors over which the time of a sample is taken before the first budget.
const WARM_UP: f64 = 0.01;

/// The scene to render.
#[derive(Clone, Copy)]
pub struct Case<'a> {
    pub scene: SceneName,
    /// What takes the place of the teapot, or is the statue.
    pub mesh: Option<&'a Mesh>,
    pub cast: &'a Cast,
    /// What tables call the light.
    pub light: &'a str,
    pub environment: &'a Environment,
    /// Names of all that was loaded, as they were given: references are kept under them, with the content of the files.
    pub sources: &'a [String],
}

/// Where the error is taken; rising.
#[derive(Clone, Debug)]
pub enum Budgets {
    /// After a number of samples a pixel.
    Samples(Vec<u32>),
    /// After such times of processors, seconds.
    Seconds(Vec<f64>),
}

impl Budgets {
    /// How many there are.
    pub fn count(&self) -> usize {
        match self {
            Self::Samples(samples) => samples.len(),
            Self::Seconds(seconds) => seconds.len(),
        }
    }
}

/// How it is measured.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The methods; ratios are multiples of the first one's error.
    pub methods: Vec<Method>,
    /// Width and height of the picture, pixels.
    pub size: [u32; 2],
    pub budgets: Budgets,
    /// Pictures of each method, with seeds of their own: for error bars, and to tell bias from variance.
    pub repeats: u32,
    /// Samples a pixel of the reference.
    pub reference_samples: u32,
    pub max_bounces: u32,
    /// Where the numbers come from.
    pub points: PointsName,
    pub seed: u64,
    /// The folder where references are kept; nowhere, if there is none.
    pub cache: Option<PathBuf>,
}

impl Plan {
    /// Rows that are rendered in all: the steps of the progress.
    pub fn steps(&self) -> u64 {
        let pictures = 2 + self.methods.len() * (1 + self.repeats as usize * self.budgets.count());
        u64::from(self.size[1]) * pictures as u64
    }

    /// Bytes that the pictures take.
    pub fn bytes(&self) -> u64 {
        let pixels = u64::from(self.size[0]) * u64::from(self.size[1]);
        pixels * (300 + 120 * self.methods.len() as u64)
    }
}

/// The curves of one case.
#[derive(Clone, Debug)]
pub struct Comparison {
    pub scene: &'static str,
    pub material: String,
    pub environment: String,
    pub size: [u32; 2],
    pub curves: Vec<Curve>,
    pub reference: ReferenceReport,
}

/// The reference.
#[derive(Clone, Debug, Default)]
pub struct ReferenceReport {
    /// Samples a pixel.
    pub samples: u32,
    /// Its own error, estimated from its two halves; already taken off the curves.
    pub own: RelativeMse,
    /// Whether it was there already.
    pub was_kept: bool,
    /// Radiance, rows from the top.
    pub picture: Vec<Vec3>,
}

/// Measures the curves of a case. Prints a warning for the reference and each method that lost samples, which count as black.
///
/// # Errors
/// A sampler that cannot be fitted to the material; a reference that cannot be kept; radiance that is not finite.
pub fn measure(case: &Case<'_>, plan: &Plan, progress: &Progress) -> anyhow::Result<Comparison> {
    srbf_fit::check_memory(plan.bytes())?;
    let fitted = Fitted::new(case.cast, &plan.methods)?;
    let camera = case.scene.camera(plan.size);
    let stage = Stage { case, plan, camera: &camera, progress };
    let own = stage.scene(case.cast.object().truth(), fitted.of(OWN)?);
    let Reference { halves, was_kept, lost } = stage.reference(&own)?;
    let judge = Judge::new(&own, &camera, plan.size, &halves);

    let mut runs: Vec<Run<'_>> = plan
        .methods
        .iter()
        .map(|&method| Run::new(&stage, method, &fitted))
        .collect::<anyhow::Result<_>>()?;
    for run in &mut runs {
        run.warm_up(&stage)?;
    }
    for repeat in 0..plan.repeats {
        for run in &mut runs {
            run.start_over(&stage, repeat);
        }
        for step in 0..plan.budgets.count() {
            for run in &mut runs {
                run.go_on(&stage, step, &judge)?;
            }
        }
        for run in &mut runs {
            run.end(&judge);
        }
    }
    let picture = halves[0].iter().zip(&halves[1]).map(|(a, b)| (0.5 * (*a + *b)).as_vec3()).collect();
    let samples = plan.reference_samples.div_ceil(2) * 2;
    let pixels = u64::from(plan.size[0]) * u64::from(plan.size[1]);
    let of_reference = warning_of(lost, pixels * u64::from(samples)).map(|text| format!("reference: {text}"));
    for warning in of_reference.into_iter().chain(runs.iter().filter_map(Run::warning)) {
        eprintln!("{}, {} under {}, {warning}", case.cast.object().name(), case.scene.text(), case.light);
    }
    Ok(Comparison {
        scene: case.scene.text(),
        material: case.cast.object().name().to_owned(),
        environment: case.light.to_owned(),
        size: plan.size,
        curves: runs.into_iter().map(|run| run.into_curve(&judge)).collect(),
        reference: ReferenceReport { samples, own: judge.own, was_kept, picture },
    })
}

/// The method of the reference: the material itself by its own sampler, together with the light.
const OWN: Method = Method::of(Strategy::EVEN);

/// The samplers of all methods, each fitted once.
struct Fitted<'a> {
    cast: &'a Cast,
    samplers: Vec<(SamplerName, Reading, Vec<Sampler<'a>>)>,
}

impl<'a> Fitted<'a> {
    fn new(cast: &'a Cast, methods: &[Method]) -> anyhow::Result<Self> {
        let mut fitted = Self { cast, samplers: Vec::new() };
        for method in [OWN].iter().chain(methods) {
            let (name, reading) = (method.strategy.sampler, method.reading);
            if fitted.find(name, reading).is_none() {
                let samplers = match reading {
                    Reading::Itself => cast.fit(name)?,
                    Reading::Fit => cast.fit_to_lobes(name)?,
                };
                fitted.samplers.push((name, reading, samplers));
            }
        }
        Ok(fitted)
    }

    fn find(&self, name: SamplerName, reading: Reading) -> Option<&[Sampler<'a>]> {
        let found = self.samplers.iter().find(|entry| (entry.0, entry.1) == (name, reading));
        found.map(|entry| entry.2.as_slice())
    }

    fn of(&self, method: Method) -> anyhow::Result<&[Sampler<'a>]> {
        let found = self.find(method.strategy.sampler, method.reading);
        found.ok_or_else(|| anyhow::anyhow!("{method}: no sampler was fitted"))
    }

    fn truth(&self, reading: Reading) -> anyhow::Result<Truth<'a>> {
        match reading {
            Reading::Itself => Ok(self.cast.object().truth()),
            Reading::Fit => self.cast.lobes_as_material(),
        }
    }
}

/// The converged picture.
struct Reference {
    /// Two that do not depend on one another: their difference tells how far their mean is from the truth.
    halves: reference::Halves,
    was_kept: bool,
    /// Samples that were lost while it was made.
    lost: u64,
}

/// What all runs share.
struct Stage<'s> {
    case: &'s Case<'s>,
    plan: &'s Plan,
    camera: &'s Camera,
    progress: &'s Progress,
}

impl<'s> Stage<'s> {
    fn scene<'a>(&self, object: Truth<'a>, samplers: &'a [Sampler<'a>]) -> Scene<'a>
    where
        's: 'a,
    {
        let Case { scene, mesh, cast, environment, .. } = *self.case;
        Scene::build(scene.shapes(mesh.cloned()), |role| cast.shader(role, object, samplers), environment)
    }

    fn settings(&self, strategy: Strategy, split: u32, seed: u64) -> RenderSettings {
        RenderSettings {
            light: strategy.light,
            split,
            max_bounces: self.plan.max_bounces,
            points: self.plan.points,
            seed: self.plan.seed.wrapping_add(seed),
        }
    }

    /// Renders the reference, or reads one that is there already.
    fn reference(&self, own: &Scene<'_>) -> anyhow::Result<Reference> {
        let file = match &self.plan.cache {
            Some(folder) => Some(self.key()?.file(folder)),
            None => None,
        };
        let pixels = self.plan.size[0] as usize * self.plan.size[1] as usize;
        if let Some(halves) = file.as_ref().and_then(|file| reference::read(file, pixels)) {
            self.progress.advance(2 * u64::from(self.plan.size[1]));
            return Ok(Reference { halves, was_kept: true, lost: 0 });
        }
        let mut lost = 0;
        let mut half = |seed| -> anyhow::Result<Vec<DVec3>> {
            let mut film = Film::new(self.plan.size);
            let samples = self.plan.reference_samples.div_ceil(2);
            let settings =
                RenderSettings { points: PointsName::Sobol, ..self.settings(OWN.strategy, 1, seed) };
            add_samples(own, self.camera, &settings, &mut film, samples, self.progress)?;
            lost += film.lost;
            Ok((0..pixels).map(|i| film.mean(i)).collect())
        };
        let halves = [half(1)?, half(2)?];
        if let Some(file) = file {
            // A reference that is kept for the next run is no part of the result.
            if let Err(error) = reference::write(&file, &halves) {
                eprintln!("srbf: warning: the reference is not kept: {}", error_line(&error));
            }
        }
        Ok(Reference { halves, was_kept: false, lost })
    }

    /// All that decides the reference.
    fn key(&self) -> anyhow::Result<Key> {
        let Plan { size, reference_samples, max_bounces, seed, .. } = self.plan;
        let mut key = Key::new()?;
        let scene = self.case.scene.text();
        key.add(format!("{scene} {size:?} {reference_samples} {max_bounces} {seed}").as_bytes());
        self.case.sources.iter().try_for_each(|name| key.add_source(name))?;
        Ok(key)
    }
}

/// Seed of the first repeat; those before it are the reference's.
const FIRST_SEED: u64 = 16;

/// One method at work.
struct Run<'a> {
    method: Method,
    title: String,
    scene: Scene<'a>,
    film: Film,
    /// Directions that a ray of the film draws together.
    split: u32,
    /// Time of processors that the film took.
    seconds: f64,
    /// Samples of all films that were lost, and samples of all films.
    lost: [u64; 2],
    seed: u64,
    /// Rays of each time budget: found in the first repeat, the same in all.
    rays: Vec<u32>,
    /// Time of processors that a ray of all pixels takes.
    seconds_per_ray: f64,
    /// Samples, and for each repeat time and error, of each budget.
    measured: Vec<(u32, Vec<(f64, RelativeMse)>)>,
    repeats: Repeats,
    shown: Shown,
}

impl<'a> Run<'a> {
    fn new<'s: 'a>(stage: &Stage<'s>, method: Method, fitted: &'a Fitted<'a>) -> anyhow::Result<Self> {
        let (samplers, truth) = (fitted.of(method)?, fitted.truth(method.reading)?);
        let size = stage.plan.size;
        Ok(Self {
            method,
            title: match method.strategy.light {
                Light::Off => samplers[0].title(&truth),
                Light::Mis => format!("{}; and the light", samplers[0].title(&truth)),
                Light::Even => format!("{}, with the light by even sums", samplers[0].title(&truth)),
                Light::Product => format!("{}, together with the light", samplers[0].title(&truth)),
                Light::Only => "the light".to_owned(),
            },
            scene: stage.scene(truth, samplers),
            film: Film::new(size),
            split: if method.strategy.sampler.is_multi() { SPLIT } else { 1 },
            seconds: 0.0,
            lost: [0; 2],
            seed: FIRST_SEED,
            rays: Vec::new(),
            seconds_per_ray: 0.0,
            measured: vec![(0, Vec::new()); stage.plan.budgets.count()],
            repeats: Repeats::new(size[0] as usize * size[1] as usize),
            shown: Shown::default(),
        })
    }

    fn clear(&mut self, size: [u32; 2]) {
        self.film = Film::new(size);
        self.seconds = 0.0;
    }

    fn add(&mut self, stage: &Stage<'_>, rays: u32) -> anyhow::Result<()> {
        let settings = stage.settings(self.method.strategy, self.split, self.seed);
        let before = self.film.lost;
        let film = &mut self.film;
        let time = add_samples(&self.scene, stage.camera, &settings, film, rays, stage.progress)?;
        self.lost[0] += film.lost - before;
        self.lost[1] += film.pixels.len() as u64 * u64::from(rays);
        self.seconds += time.as_secs_f64();
        Ok(())
    }

    /// The warning of lost samples, if there are some.
    fn warning(&self) -> Option<String> {
        let [lost, of] = self.lost;
        warning_of(lost, of).map(|text| format!("{}: {text}", self.method))
    }

    /// Into a film that is thrown away: caches and clock speed settle, and the time of a ray is found.
    fn warm_up(&mut self, stage: &Stage<'_>) -> anyhow::Result<()> {
        self.add(stage, 1)?;
        if matches!(stage.plan.budgets, Budgets::Seconds(_)) {
            self.clear(stage.plan.size);
            let hidden = Progress::hidden();
            let stage = Stage { progress: &hidden, ..*stage };
            self.add(&stage, 1)?;
            let more = (WARM_UP / self.seconds.max(1e-9)).min(1e3) as u32;
            self.add(&stage, more)?;
        }
        self.seconds_per_ray = self.seconds / f64::from(self.film.samples);
        Ok(())
    }

    fn start_over(&mut self, stage: &Stage<'_>, repeat: u32) {
        self.clear(stage.plan.size);
        self.seed = FIRST_SEED + u64::from(repeat);
    }

    /// Renders on to a budget, and takes the error.
    fn go_on(&mut self, stage: &Stage<'_>, step: usize, judge: &Judge) -> anyhow::Result<()> {
        let rays = match &stage.plan.budgets {
            Budgets::Samples(samples) => {
                let together = if self.method.strategy.sampler.is_multi() { SPLIT } else { 1 };
                let split = samples[step].min(together);
                // Directions that are drawn together are worth more the more there are: such a film does not go on from one of fewer.
                if split != self.split {
                    self.clear(stage.plan.size);
                    self.split = split;
                }
                samples[step].div_ceil(split)
            }
            Budgets::Seconds(seconds) => {
                if self.rays.len() == step {
                    if self.film.samples > 0 {
                        self.seconds_per_ray = self.seconds / f64::from(self.film.samples);
                    }
                    let rays = (seconds[step] / self.seconds_per_ray).round().clamp(1.0, MAX_SAMPLES);
                    self.rays.push(rays as u32);
                }
                self.rays[step]
            }
        };
        self.add(stage, rays.saturating_sub(self.film.samples))?;
        self.measured[step].0 = self.film.samples * self.split;
        self.measured[step].1.push((self.seconds, judge.error(&self.film)));
        Ok(())
    }

    /// Ends a repeat.
    fn end(&mut self, judge: &Judge) {
        self.repeats.add(&self.film);
        if self.shown.picture.is_empty() {
            self.shown = Shown {
                samples: self.film.samples * self.split,
                seconds: self.seconds,
                picture: self.film.to_picture(),
                errors: judge.error_of_pixels(&self.film),
            };
        }
    }

    fn into_curve(self, judge: &Judge) -> Curve {
        let of = |values: &[(f64, RelativeMse)], what: fn(&RelativeMse) -> f64| {
            Estimate::of(&values.iter().map(|v| what(&v.1)).collect::<Vec<f64>>())
        };
        let point = |(samples, values): (u32, Vec<(f64, RelativeMse)>)| {
            let mse = of(&values, |e| e.trimmed);
            Point {
                samples,
                seconds: values.iter().map(|v| v.0).sum::<f64>() / values.len().max(1) as f64,
                mse,
                whole_mse: of(&values, |e| e.whole),
                is_below_reference: mse.mean < judge.own.trimmed,
            }
        };
        Curve {
            method: self.method,
            title: self.title,
            points: self.measured.into_iter().map(point).collect(),
            bias: judge.bias(&self.repeats),
            shown: self.shown,
        }
    }
}

/// How many times the first method's error another one's is, where both are known.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ratios {
    /// After the same time of processors.
    pub equal_time: Option<Estimate>,
    /// After the same samples, the last that were measured.
    pub equal_samples: Option<Estimate>,
    /// Time of a sample.
    pub time_of_sample: Option<f64>,
}

impl Comparison {
    /// The longest time that every method was run for.
    pub fn common_seconds(&self) -> f64 {
        let longest = self.curves.iter().filter_map(|c| c.points.last()).map(|p| p.seconds);
        longest.fold(f64::INFINITY, f64::min)
    }

    /// The largest number of samples that every method was run for.
    fn common_samples(&self) -> u32 {
        self.curves.iter().filter_map(|c| c.points.last()).map(|p| p.samples).min().unwrap_or(0)
    }

    /// Relative mean squared errors and times of a curve over those of the first.
    pub fn ratios(&self, curve: &Curve) -> Ratios {
        self.ratios_to(curve, &self.curves[0])
    }

    /// The same over those of any other curve.
    pub fn ratios_to(&self, curve: &Curve, first: &Curve) -> Ratios {
        let seconds = self.common_seconds();
        let samples = self.common_samples();
        // Seconds of a method after each number of samples.
        let at_samples = |curve: &Curve| curve.mse_at(curve.seconds_per_sample()? * f64::from(samples));
        let ratio = |mine: Option<Estimate>, first: Option<Estimate>| Some(mine?.over(first?));
        let same = curve.method == first.method;
        let exact = |ratio: Option<Estimate>| {
            if same { ratio.map(|_| Estimate { mean: 1.0, error: 0.0 }) } else { ratio }
        };
        Ratios {
            equal_time: exact(ratio(curve.mse_at(seconds), first.mse_at(seconds))),
            equal_samples: exact(ratio(at_samples(curve), at_samples(first))),
            time_of_sample: curve
                .seconds_per_sample()
                .zip(first.seconds_per_sample())
                .map(|(mine, first)| mine / first),
        }
    }

    /// The curve of a method.
    pub fn curve(&self, method: Method) -> Option<&Curve> {
        self.curves.iter().find(|curve| curve.method == method)
    }

    /// The scene, in words.
    pub fn title(&self) -> String {
        format!("{}, {} under {}", self.material, self.scene, self.environment)
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use crate::shade::shader::LoadedMaterial;
    use crate::truth::measured::tests::vivid;
    use crate::truth::stored::tests::lacquer;
    use curve::tests::{curve, point};

    /// A light without a sharp sun, so that small pictures are enough to estimate a slope.
    fn light() -> Environment {
        let pixels = (0..32 * 16).map(|i| glam::Vec3::splat(0.2 + ((i * 37) % 11) as f32)).collect();
        Environment::new(32, pixels).unwrap()
    }

    fn plan(side: u32, methods: &[&str]) -> Plan {
        Plan {
            methods: methods.iter().map(|text| text.parse().unwrap()).collect(),
            size: [side; 2],
            budgets: Budgets::Samples(vec![4, 8, 16, 32, 64, 128]),
            repeats: 2,
            reference_samples: 512,
            max_bounces: 1,
            points: PointsName::Random,
            seed: 7,
            cache: None,
        }
    }

    /// Compares on the sphere.
    fn on_sphere(plan: &Plan, object: LoadedMaterial, lobes: bool) -> Comparison {
        let environment = light();
        let cast = Cast::of(SceneName::Sphere, object, lobes.then(lacquer), None, None).unwrap();
        let case = Case {
            scene: SceneName::Sphere,
            mesh: None,
            cast: &cast,
            light: "test",
            environment: &environment,
            sources: &["test".to_owned()],
        };
        measure(&case, plan, &Progress::hidden()).unwrap()
    }

    #[test]
    fn error_falls_with_the_square_root_of_the_samples() {
        let matte = || LoadedMaterial::load("matte").unwrap();
        let result = on_sphere(&plan(48, &["lobes", "uniform", "cosine"]), matte(), false);
        for curve in &result.curves {
            let slope = curve.slope().unwrap();
            assert!((slope + 0.5).abs() < 0.03, "{}: {slope}", curve.method);
            assert_eq!(curve.bias.unwrap().certain(), None, "{}", curve.method);
        }
        // A sharp highlight is where lobes gain, and light sampled together with them more.
        let result = on_sphere(
            &plan(24, &["product", "lobes", "uniform", "cosine"]),
            LoadedMaterial::Lobes(lacquer()),
            false,
        );
        let ratio = |i: usize| result.ratios(&result.curves[i]).equal_samples.unwrap().mean;
        assert_eq!(ratio(0), 1.0);
        assert!(
            ratio(1) > 1.5 && ratio(2) > 1.4 * ratio(1) && ratio(3) > 1.4 * ratio(1),
            "{ratio:?}",
            ratio = [1, 2, 3].map(ratio)
        );
    }

    #[test]
    fn lobes_that_take_the_place_of_a_table_have_a_bias_and_lobes_that_sample_it_none() {
        let table = LoadedMaterial::Table(Box::new(vivid()));
        let result = on_sphere(&plan(24, &["lobes", "fit:lobes", "fit:product"]), table, true);
        let bias = |i: usize| result.curves[i].bias.unwrap();
        assert_eq!(bias(0).certain(), None, "{:?}", bias(0));
        for i in [1, 2] {
            assert!(bias(i).certain() > Some(0.1), "{:?}", bias(i));
        }
        // Error is variance and bias.
        let whole = result.curves[2].points.last().unwrap().whole_mse.mean;
        let parts = bias(2).square.mean + bias(2).variance;
        assert!((whole / parts - 1.0).abs() < 0.05, "{whole} {parts}");
    }

    #[test]
    fn a_time_budget_is_kept() {
        let methods = &["lobes", "uniform", "lobes-multi"];
        let budgets = Budgets::Seconds(vec![0.02, 0.06]);
        let some = Plan { budgets, ..plan(24, methods) };
        let result = on_sphere(&some, LoadedMaterial::Lobes(lacquer()), false);
        for curve in &result.curves {
            let seconds: Vec<f64> = curve.points.iter().map(|p| p.seconds).collect();
            // Within the rounding to whole rays, and the noise of times by other work.
            assert!(
                seconds[1] > 0.02 && seconds[1] < 0.2 && seconds[0] < seconds[1],
                "{}: {seconds:?}",
                curve.method
            );
        }
    }

    #[test]
    fn a_reference_that_was_kept_gives_the_same_errors() {
        let folder = std::env::temp_dir().join(format!("srbf-references-{}", std::process::id()));
        let kept = Plan { cache: Some(folder.clone()), reference_samples: 64, ..plan(12, &["lobes"]) };
        let [first, second] = [0, 1].map(|_| on_sphere(&kept, LoadedMaterial::Lobes(lacquer()), false));
        let other = on_sphere(&Plan { seed: 8, ..kept }, LoadedMaterial::Lobes(lacquer()), false);
        std::fs::remove_dir_all(&folder).unwrap();
        assert!(!first.reference.was_kept && second.reference.was_kept && !other.reference.was_kept);
        assert_eq!(first.reference.own, second.reference.own);
        assert_eq!(first.curves[0].points[5].mse, second.curves[0].points[5].mse);
    }

    #[test]
    fn a_reference_that_cannot_be_kept_fails_nothing() {
        let file = std::env::temp_dir().join(format!("srbf-no-folder-{}", std::process::id()));
        std::fs::write(&file, "").unwrap();
        let kept = Plan { cache: Some(file.clone()), reference_samples: 64, ..plan(12, &["lobes"]) };
        let result = on_sphere(&kept, LoadedMaterial::Lobes(lacquer()), false);
        std::fs::remove_file(&file).unwrap();
        assert!(!result.reference.was_kept && result.curves[0].points[5].mse.mean > 0.0);
    }

    #[test]
    fn ratios_of_what_is_not_known_are_not_known() {
        let points = |factor: f64| {
            [1u32, 4, 16].map(|n| point(n, 0.1 * f64::from(n), factor / f64::from(n).sqrt())).to_vec()
        };
        let mut unknown = curve(vec![point(16, 1.6, f64::NAN)]);
        unknown.method = "cosine".parse().unwrap();
        let mut poor = curve(points(2.0));
        poor.method = "uniform".parse().unwrap();
        let comparison = Comparison {
            scene: "sphere",
            material: String::new(),
            environment: String::new(),
            size: [1, 1],
            curves: vec![curve(points(1.0)), poor, unknown],
            reference: ReferenceReport::default(),
        };
        let ratios = |i: usize| comparison.ratios(&comparison.curves[i]);
        assert!((ratios(1).equal_time.unwrap().mean - 4.0).abs() < 1e-9);
        assert!((ratios(1).equal_samples.unwrap().mean - 4.0).abs() < 1e-9);
        assert!(ratios(2).equal_time.is_none() && ratios(2).equal_samples.is_none());
    }
}
