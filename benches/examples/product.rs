//! The cost of sampling light and material together: one draw of 8, 16 and 32 candidates, even sums over a block of light and 8
//! directions of the lobes, and 8 candidates of a light of 16 lobes, which is no map, relative to one draw by multiple importance sampling, which is a lobe's and the environment's direction, both
//! evaluated and weighed.
//!
//! `cargo run --release -p srbf-benches --example product [LEVEL...]`, five seconds a level. Times are the least of many rounds,
//! all in turn, over mixtures of garnet red for 64 outgoing directions; random numbers are drawn within, as a renderer would.

use srbf_benches::harness::{Table, arguments, least_of, levels_of};
use srbf_benches::{GARNET_RED, Random, Triples};
use srbf_core::{
    Domain, Draws, Environment, Level, LightBlock, LightRows, LightSource, Lobe, Material, Mixture,
    ProductSampling, Towards, Vec3, environment_len,
};
use std::process::ExitCode;
use std::time::Instant;

const DRAWS: usize = 512;
const ROUNDS: usize = 400;
const CANDIDATES: [usize; 3] = [8, 16, 32];
/// Directions of the lobes in even sums.
const RAYS: usize = 8;

fn main() -> ExitCode {
    let levels = match levels_of("product", &arguments()) {
        Ok(levels) => levels,
        Err(status) => return status,
    };
    let material = Material::from_bytes(GARNET_RED).expect("a valid material");
    let heads = ["mis".to_owned()]
        .into_iter()
        .chain(CANDIDATES.map(|n| format!("{n} candidates")))
        .chain(["even sums", "8 of a light of lobes"].map(str::to_owned));
    let mut table = Table::new("ns a draw, and relative to one by multiple importance sampling", heads);
    for level in levels {
        level.set().expect("an available level");
        for width in [256, 1024] {
            let environment = environment(width);
            report(level, &Work::new(&material), &environment, &mut table);
        }
    }
    table.print();
    ExitCode::SUCCESS
}

/// A map of noise with a small sun.
fn environment(width: usize) -> Environment<Vec<u32>> {
    let mut random = Random(5);
    let mut map: Vec<[f32; 3]> = (0..width * width / 2).map(|_| [random.uniform(); 3]).collect();
    let sun = width * width / 10;
    map[sun..sun + width / 100].fill([5e3; 3]);
    let memory = vec![1; environment_len(width, width / 2).expect("a size of a map")];
    let start = Instant::now();
    let environment = Environment::new(width, &map, memory).expect("a map with light");
    println!(
        "a table of {width} columns is made in {:.0} ns a pixel",
        start.elapsed().as_secs_f64() * 1e9 / map.len() as f64
    );
    environment
}

/// A light of lobes over the sphere, as a path guider learns it.
struct OfLobes(Mixture<'static, 16>);

impl OfLobes {
    fn new() -> Self {
        let axes = Triples::directions(16, 3);
        let lobe =
            |i| Lobe::new(axes.at(i), 3.0 * (1 + i) as f32, [0.1 + i as f32; 3]).expect("a unit vector");
        let lobes: Vec<Lobe> = (0..16).map(lobe).collect();
        Self(Mixture::new(Domain::Sphere, 1.0, &[], &lobes).expect("room for them"))
    }

    fn estimate(&self, to: &mut LightRows) {
        to.radiance = [to.pdf.map(|pdf| self.0.power() * pdf + 0.1); 3];
    }
}

impl LightSource for OfLobes {
    fn sample_into(&self, u: [&[f32]; 3], to: &mut LightRows) {
        let n = u[0].len();
        let direction = to.direction.each_mut().map(|row| &mut row[..n]);
        let draws = Draws { u, direction, pdf: Some(&mut to.pdf[..n]), weight: None };
        self.0.ask(draws.into()).expect("slices of one length");
        self.estimate(to);
    }

    fn evaluate_into(&self, n: usize, to: &mut LightRows) {
        let wi = to.direction.each_ref().map(|row| &row[..n]);
        self.0
            .ask(Towards { wi, value: None, pdf: Some(&mut to.pdf[..n]) }.into())
            .expect("slices of one length");
        self.estimate(to);
    }
}

struct Work<'m> {
    mixtures: Vec<Mixture<'m, 16>>,
    frames: Vec<[Vec3; 3]>,
}

impl<'m> Work<'m> {
    fn new(material: &'m Material<&'static [u8]>) -> Self {
        let (wo, normals) = (Triples::directions(64, 1), Triples::directions(64, 2));
        let mixtures = (0..64).map(|i| {
            let mut mixture = Mixture::empty();
            material.prepare(wo.at(i), &mut mixture).expect("a direction");
            mixture
        });
        let frame = |normal: Vec3| {
            let tangent = normal.any_orthonormal_vector();
            [tangent, normal.cross(tangent), normal]
        };
        Self { mixtures: mixtures.collect(), frames: (0..64).map(|i| frame(normals.at(i))).collect() }
    }

    /// All draws, by `one`.
    fn run(&self, mut one: impl FnMut(&Mixture<'_, 16>, &[Vec3; 3]) -> Vec3) {
        let mut sum = Vec3::ZERO;
        for i in 0..DRAWS {
            sum += one(&self.mixtures[i % 64], &self.frames[i % 64]);
        }
        assert!(std::hint::black_box(sum).is_finite());
    }
}

/// One direction of each, weighed by the balance heuristic.
fn both_ways(
    mixture: &Mixture<'_, 16>,
    environment: &Environment<Vec<u32>>,
    frame: &[Vec3; 3],
    random: &mut Random,
) -> Vec3 {
    let mut three = || [random.uniform(), random.uniform(), random.uniform()];
    let mut sum = Vec3::ZERO;
    if let Some(sample) = mixture.sample(three()) {
        let d = sample.direction;
        let (radiance, pdf) = environment.radiance_and_pdf(frame[0] * d.x + frame[1] * d.y + frame[2] * d.z);
        sum += sample.weight * radiance * (sample.pdf / (sample.pdf + pdf));
    }
    let sample = environment.sample(three());
    let d = sample.direction;
    let (value, pdf) = mixture.evaluate_and_pdf(Vec3::new(frame[0].dot(d), frame[1].dot(d), frame[2].dot(d)));
    sum + value * sample.radiance / (sample.pdf + pdf)
}

/// Sixteen samples of the light.
fn block(environment: &Environment<Vec<u32>>, random: &mut Random) -> LightBlock {
    LightBlock::of(|_| environment.sample([(); 3].map(|()| random.uniform())))
}

fn report(level: Level, work: &Work<'_>, environment: &Environment<Vec<u32>>, table: &mut Table) {
    let mut random = Random(9);
    let mut u = [[0.0; 32]; 3];
    let blocks: Vec<_> = (0..64).map(|_| block(environment, &mut random)).collect();
    let lobes = OfLobes::new();
    let least = least_of(ROUNDS, 3 + CANDIDATES.len(), DRAWS, |way| {
        if way == 0 {
            return work.run(|m, frame| both_ways(m, environment, frame, &mut random));
        }
        if way == 2 + CANDIDATES.len() {
            let sampling = ProductSampling::new(8, 0.5, f32::INFINITY).expect("in range");
            return work.run(|m, frame| {
                u.iter_mut().for_each(|u| u[..8].fill_with(|| random.uniform()));
                let drawn = m.sample_product(
                    &lobes,
                    frame,
                    &sampling,
                    u.each_ref().map(|u| &u[..8]),
                    random.uniform(),
                );
                drawn.expect("equal lengths").map_or(Vec3::ZERO, |drawn| drawn.weight)
            });
        }
        if way > CANDIDATES.len() {
            let mut next = 0;
            return work.run(|m, frame| {
                next = (next + 1) % blocks.len();
                u.iter_mut().for_each(|u| u[..RAYS].fill_with(|| random.uniform()));
                let u = u.each_ref().map(|u| &u[..RAYS]);
                let drawn = m.reflect(environment, &blocks[next], frame, frame[2], u, random.uniform());
                drawn.expect("equal lengths").light(true, true)
            });
        }
        let candidates = CANDIDATES[way - 1];
        let sampling = ProductSampling::new(candidates, 0.5, f32::INFINITY).expect("in range");
        work.run(|m, frame| {
            u.iter_mut().for_each(|u| u[..candidates].fill_with(|| random.uniform()));
            let u = u.each_ref().map(|u| &u[..candidates]);
            let drawn = m.sample_product(environment, frame, &sampling, u, random.uniform());
            drawn.expect("equal lengths").map_or(Vec3::ZERO, |drawn| drawn.weight)
        });
    });
    let name = format!("{} {} x {}", level.name(), environment.width(), environment.height());
    table.row(&name, least.iter().map(|ns| format!("{ns:.1} ({:.2})", ns / least[0])));
}
