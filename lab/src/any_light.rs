//! `srbf-lab any-light`: one of eight candidates of lobes and a learnt light, against multiple importance sampling of the two.
//!
//! | file | holds |
//! |---|---|
//! | `learnt` | the light, learnt from samples |

mod learnt;

use crate::equal_time;
use anyhow::Context;
use glam::Vec3;
use learnt::{Followed, LearntLight};
use srbf_core::{Mixture, Processor, ProductSampling, luminance};
use srbf_reference_renderer::command::argument;
use srbf_reference_renderer::numbers::points::{Points, PointsName};
use srbf_reference_renderer::numbers::random::Random;
use srbf_reference_renderer::out::output;
use srbf_reference_renderer::shade::Light;
use srbf_reference_renderer::trace::frame::Frame;
use srbf_reference_renderer::trace::integrator::{self, Workspace};
use srbf_reference_renderer::trace::scene::{Scene, SceneName};
use srbf_reference_renderer::trace::settings::RenderSettings;
use srbf_reference_renderer::truth::stored::StoredMaterial;
use srbf_reference_renderer::world::environment::Environment;
use srbf_reference_renderer::world::mesh::{self, Mesh};
use srbf_reference_renderer::world::ray::Ray;
use std::f32::consts::PI;
use std::fmt::Write;
use std::hint::black_box;
use std::path::PathBuf;
use std::time::Instant;

/// Compares candidates of lobes and a learnt light with multiple importance sampling of the two, in error times time.
///
/// SRBF_DATA_DIR names the folder of the measurements, maps and meshes. Six materials, three scenes, three maps. Hits are those of random
/// pixels. At each a light of sixteen lobes is learnt from paths that go away from there. A sample is a path: a ray of the camera, the
/// mixture, a draw, and the rest of the path along the direction, by the renderer. Some minutes on one processor that nothing else uses.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The folder of fits, NAME.srbf; missing ones are made and kept there
    #[arg(long, default_value = "out/fits", value_name = "DIR")]
    fits: PathBuf,
    /// Hits of each material, scene and map
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=100_000), value_name = "N")]
    hits: u32,
    /// Samples of each hit and method; 256 for each timed round
    #[arg(long, default_value_t = 4096, value_parser = clap::value_parser!(u32).range(512..=1 << 24), value_name = "N")]
    samples: u32,
    /// Only the materials whose names contain this
    #[arg(long, value_name = "NAME")]
    only: Option<String>,
    /// Every ratio, .csv
    #[arg(short, long, default_value = "out/any-light.csv", value_name = "OUT.csv")]
    output: PathBuf,
}

const MAPS: [&str; 3] = ["cc0_forest_512", "cc0_hall_512", "uffizi_latlong"];
const SCENES: [SceneName; 3] = [SceneName::Teapot, SceneName::Statue, SceneName::Room];
const STATUE: &str = "meshes/happy_buddha_20k.ply";

/// Samples that a light is learnt from.
const FOLLOWED: usize = 32_768;

/// Samples of a timed round.
const ROUND: usize = 256;

/// Numbers of candidates; 0 is multiple importance sampling.
const METHODS: [usize; 4] = [0, 4, 8, 16];

/// The light in truth, in the order of [`truths`].
const TRUTHS: [&str; 3] = ["clean", "occluded", "noisy"];

/// The truths of one direction: the radiance that the light was learnt from; half of it, to one side of the surface, hidden behind
/// something dim, which the light does not know; with noise, as that of a path that goes on by chance.
fn truths(radiance: Vec3, is_occluded: bool, random: &mut Random) -> [Vec3; 3] {
    let noise = -(1.0 - random.unit()).ln();
    [radiance, if is_occluded { Vec3::splat(DIM) } else { radiance }, radiance * noise]
}

/// Radiance of the occluder.
const DIM: f32 = 0.05;

/// How the rest of a path is followed.
const SETTINGS: RenderSettings =
    RenderSettings { light: Light::Mis, split: 1, max_bounces: 5, points: PointsName::Random, seed: 0 };

/// A point of a scene that the camera sees.
struct Hit<'a> {
    scene: &'a Scene<'a>,
    material: &'a StoredMaterial,
    ray: Ray,
    frame: Frame,
    wo: Vec3,
    /// In the plane of the surface, towards the middle of the hidden half.
    occluder: Vec3,
}

/// Storage of paths, and their numbers.
struct Walker<'a> {
    workspace: Workspace<'a>,
    mixture: Mixture<'a, 64>,
    random: Random,
}

impl Walker<'_> {
    fn three(&mut self) -> [f32; 3] {
        [(); 3].map(|()| self.random.unit())
    }
}

/// A drawn direction, in the world, and what its radiance is multiplied by.
type Drawn = Option<(Vec3, Vec3)>;

impl<'a> Hit<'a> {
    /// Draws a direction; `candidates` 0: by multiple importance sampling, lobes or light with the same probability.
    fn draw(&self, light: &LearntLight, candidates: usize, walker: &mut Walker<'a>) -> Drawn {
        // As a renderer for each sample: the ray of the camera, and the mixture.
        black_box(self.scene.hit(&self.ray));
        self.material.material.prepare(self.wo, &mut walker.mixture).expect("room, and a unit vector");
        let Frame { tangent, bitangent, normal, .. } = self.frame;
        if candidates > 0 {
            let sampling = ProductSampling::new(candidates, 0.5, f32::INFINITY).expect("in range");
            let mut u = [[0.0; 16]; 3];
            u.iter_mut().for_each(|u| u[..candidates].fill_with(|| walker.random.unit()));
            let u = u.each_ref().map(|u| &u[..candidates]);
            let axes = [tangent, bitangent, normal];
            let drawn = walker.mixture.sample_product(light, &axes, &sampling, u, walker.random.unit());
            return drawn.expect("equal lengths").map(|drawn| (drawn.direction, drawn.factor));
        }
        let u = walker.three();
        let (direction, value, pdf) = if walker.random.unit() < 0.5 {
            let sample = walker.mixture.sample(u)?;
            let direction = self.frame.to_world(sample.direction);
            (direction, sample.weight * sample.pdf, sample.pdf + light.pdf(direction))
        } else {
            let (direction, of_light) = light.sample(u)?;
            let (value, pdf) = walker.mixture.evaluate_and_pdf(self.frame.to_local(direction));
            (direction, value, pdf + of_light)
        };
        (pdf > 0.0).then(|| (direction, value * (2.0 / pdf)))
    }

    /// The radiance that a path finds along a direction; black below the surface.
    fn radiance(&self, direction: Vec3, walker: &mut Walker<'a>) -> Vec3 {
        if !self.frame.leaves(direction) {
            return Vec3::ZERO;
        }
        let points = Points::new(PointsName::Random, walker.random.key(), walker.random.bits().into(), 0);
        let ray = self.frame.ray(direction);
        integrator::radiance(self.scene, &ray, &SETTINGS, None, &points, &mut walker.workspace)
    }

    /// The luminance of one estimate for each truth.
    fn estimates(
        &self,
        light: &LearntLight,
        candidates: usize,
        walker: &mut Walker<'a>,
    ) -> [f64; TRUTHS.len()] {
        let Some((direction, factor)) = self.draw(light, candidates, walker) else {
            return [0.0; TRUTHS.len()];
        };
        let is_above = self.frame.leaves(direction);
        let is_occluded = is_above && direction.dot(self.occluder) > 0.0;
        let radiance = self.radiance(direction, walker);
        truths(radiance, is_occluded, &mut walker.random).map(|l| f64::from(luminance(factor * l)))
    }

    /// Learns the light from paths, half of them even over the sphere, half towards the map.
    fn learn(&self, map: &Environment, walker: &mut Walker<'a>) -> anyhow::Result<LearntLight> {
        let followed: Vec<Followed> = (0..FOLLOWED)
            .map(|i| {
                let [u, v, w] = walker.three();
                let direction = if i % 2 == 0 {
                    let (z, (sin, cos)) = (1.0 - 2.0 * u, (2.0 * PI * v).sin_cos());
                    let radius = (1.0 - z * z).max(0.0).sqrt();
                    Vec3::new(radius * cos, radius * sin, z)
                } else {
                    map.sample([u, v, w]).direction
                };
                let bright = luminance(self.radiance(direction, walker)).max(0.0);
                Followed { direction, weight: bright / (0.5 * map.pdf(direction) + 0.125 / PI) }
            })
            .collect();
        LearntLight::learn(&followed, &mut walker.random)
    }
}

/// Mean and variance of numbers.
#[derive(Clone, Copy, Default)]
struct Moments {
    count: f64,
    mean: f64,
    squares: f64,
}

impl Moments {
    fn see(&mut self, x: f64) {
        self.count += 1.0;
        let off = x - self.mean;
        self.mean += off / self.count;
        self.squares += off * (x - self.mean);
    }
    fn variance(&self) -> f64 {
        self.squares / self.count
    }
}

/// Ratios at one hit: of the variance, and of variance times time, for each truth and each number of candidates.
struct Row {
    material: String,
    scene: &'static str,
    map: &'static str,
    angle: f32,
    variance: [[f64; METHODS.len()]; TRUTHS.len()],
    /// Seconds a sample.
    time: [f64; METHODS.len()],
    /// Standard errors between the means.
    apart: f64,
}

impl Row {
    /// Error times time of multiple importance sampling over that of a method.
    fn gain(&self, truth: usize, method: usize) -> f64 {
        self.variance[truth][0] * self.time[0] / (self.variance[truth][method] * self.time[method])
    }
}

/// Measures one hit; `None` where some estimate is always 0.
fn measure<'a>(hit: &Hit<'a>, light: &LearntLight, samples: u32, walker: &mut Walker<'a>) -> Option<Row> {
    let mut moments = [[Moments::default(); METHODS.len()]; TRUTHS.len()];
    let mut time = [f64::INFINITY; METHODS.len()];
    // Methods take turns, so that what else the machine does is the same for all.
    for _ in 0..(samples as usize).div_ceil(ROUND) {
        for (m, candidates) in METHODS.into_iter().enumerate() {
            let mut found = [[0.0; TRUTHS.len()]; ROUND];
            let start = Instant::now();
            for found in &mut found {
                *found = hit.estimates(light, candidates, walker);
            }
            time[m] = time[m].min(start.elapsed().as_secs_f64() / ROUND as f64);
            for found in found {
                (0..TRUTHS.len()).for_each(|t| moments[t][m].see(found[t]));
            }
        }
    }
    let is_lit = moments.iter().flatten().all(|m| m.mean > 0.0 && m.variance() > 0.0);
    let apart = moments.iter().flat_map(|of| {
        of[1..].iter().map(|m| {
            let error = ((m.variance() / m.count) + (of[0].variance() / of[0].count)).sqrt();
            (m.mean - of[0].mean).abs() / error
        })
    });
    is_lit.then(|| Row {
        material: hit.material.name.clone(),
        scene: "",
        map: "",
        angle: hit.wo.z.min(1.0).acos().to_degrees(),
        apart: apart.fold(0.0, f64::max),
        variance: moments.map(|of| of.map(|m| m.variance())),
        time,
    })
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<()> {
    output::check_extension(&args.output, "csv")?;
    let data = argument::data_folder()?;
    let mut statue = mesh::file::read(&data.join(STATUE))?;
    statue.turn_y_up();
    let mut materials = Vec::new();
    for (name, file) in equal_time::MATERIALS.into_iter().chain([("krylon_blue", ""), ("matte", "")]) {
        if args.only.as_ref().is_none_or(|part| name.contains(part.as_str())) {
            let place = data.join(file).to_string_lossy().into_owned();
            materials.push(if file.is_empty() {
                StoredMaterial::load(name)?
            } else {
                equal_time::lobes(&args.fits, name, &place)?
            });
        }
    }
    let mut rows = Vec::new();
    for map_name in MAPS {
        let file = data.join("envmaps").join(map_name).with_extension("hdr");
        let map = argument::environment(&file.to_string_lossy())?;
        for material in &materials {
            for name in SCENES {
                let own: Option<Mesh> = (name == SceneName::Statue).then(|| statue.clone());
                let scene = Scene::build(name.shapes(own), |_| (&material.material).into(), &map);
                let random = Random::new(0, rows.len() as u64, 0);
                let (workspace, mixture) = (Workspace::default(), Mixture::empty());
                let mut walker = Walker { workspace, mixture, random };
                let mut found = 0;
                for attempt in 0.. {
                    anyhow::ensure!(attempt < 1000 * args.hits, "{}: no lit surface is seen", name.text());
                    let size = [512, 512];
                    let [x, y, turn] = walker.three();
                    let ray = name.camera(size).ray(512.0 * x, 512.0 * y);
                    let Some(surface) = scene.hit(&ray) else { continue };
                    let frame = Frame::new(&surface, -ray.direction);
                    let wo = frame.to_local(-ray.direction);
                    let (sin, cos) = (2.0 * PI * turn).sin_cos();
                    let occluder = frame.tangent * cos + frame.bitangent * sin;
                    let hit = Hit { scene: &scene, material, ray, frame, wo, occluder };
                    let Ok(light) = hit.learn(&map, &mut walker) else { continue };
                    if let Some(row) = measure(&hit, &light, args.samples, &mut walker) {
                        rows.push(Row { scene: name.text(), map: map_name, ..row });
                        found += 1;
                    }
                    if found == args.hits {
                        break;
                    }
                }
            }
        }
    }
    print(&rows);
    let text = csv(&rows).context("a number as text")?;
    output::write(&args.output, text.as_bytes())?;
    println!("wrote {}", args.output.display());
    Ok(())
}

/// Every hit on a line.
fn csv(rows: &[Row]) -> Result<String, std::fmt::Error> {
    let mut text = "material,scene,map,angle of wo".to_owned();
    for truth in TRUTHS {
        for candidates in &METHODS[1..] {
            write!(text, ",{truth} {candidates}")?;
        }
    }
    text.push_str(",ns of mis");
    for candidates in &METHODS[1..] {
        write!(text, ",ns of {candidates}")?;
    }
    text.push('\n');
    for row in rows {
        write!(text, "{},{},{},{:.1}", row.material, row.scene, row.map, row.angle)?;
        for truth in 0..TRUTHS.len() {
            for method in 1..METHODS.len() {
                write!(text, ",{:.3}", row.gain(truth, method))?;
            }
        }
        for time in row.time {
            write!(text, ",{:.0}", 1e9 * time)?;
        }
        text.push('\n');
    }
    Ok(text)
}

/// Geometric mean of numbers, and the one that a tenth is below.
fn summary(numbers: impl Iterator<Item = f64>) -> [f64; 2] {
    let mut all: Vec<f64> = numbers.collect();
    all.sort_by(f64::total_cmp);
    let mean = (all.iter().map(|x| x.ln()).sum::<f64>() / all.len() as f64).exp();
    [mean, all[all.len() / 10]]
}

fn print(rows: &[Row]) {
    println!("processor: {}", Processor::this());
    println!(
        "error times time of multiple importance sampling, over that of N candidates: geometric mean over hits\n"
    );
    println!("{:<42}{:>6}{:>8}{:>8}{:>8}{:>14}", "", "hits", "N = 4", "8", "16", "tenth of 8");
    let line = |name: &str, truth: usize, of: &dyn Fn(&Row) -> bool| {
        let own: Vec<&Row> = rows.iter().filter(|row| of(row)).collect();
        let of = |m: usize| summary(own.iter().map(|row| row.gain(truth, m)));
        println!(
            "{name:<42}{:>6}{:>8.2}{:>8.2}{:>8.2}{:>14.2}",
            own.len(),
            of(1)[0],
            of(2)[0],
            of(3)[0],
            of(2)[1]
        );
        of(2)[0]
    };
    let mut least = (f64::INFINITY, String::new());
    for (t, truth) in TRUTHS.into_iter().enumerate() {
        line(truth, t, &|_| true);
        let groups: [fn(&Row) -> &str; 3] = [|row| &row.material, |row| row.scene, |row| row.map];
        for key in groups {
            let mut names: Vec<&str> = rows.iter().map(key).collect();
            names.sort_unstable();
            names.dedup();
            for name in names {
                let mean = line(&format!("    {name}"), t, &|row| key(row) == name);
                if mean < least.0 {
                    least = (mean, format!("{truth}, {name}"));
                }
            }
        }
    }
    println!("\nthe least of these means of 8: {:.2}, {}", least.0, least.1);
    let time = |m: usize| 1e9 * rows.iter().map(|row| row.time[m]).sum::<f64>() / rows.len() as f64;
    println!(
        "ns a sample: {:.0}; of 4, 8, 16 candidates {:.0}, {:.0}, {:.0}",
        time(0),
        time(1),
        time(2),
        time(3)
    );
    let worst = rows.iter().map(|row| row.apart).fold(0.0, f64::max);
    let count = rows.len() * TRUTHS.len() * (METHODS.len() - 1);
    println!("means of {count} pairs: at most {worst:.1} standard errors apart");
}
