//! Batches, named `operation.level/lobes/directions`; baselines in the same run.
//!
//! `cargo bench --bench batch`; `cargo lab bench-report` then prints the ratios.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use srbf_benches::baseline::{C, PackedLobes, evaluate_libm, sample_libm};
use srbf_benches::{
    DIRECTIONS, GARNET_RED, LOBES, Triples, general_lobes, general_mixture, levels, mild_lobes,
    named_mixtures,
};
use srbf_core::{Draws, Material, Mixture, Request, Towards, Vec3};
use std::hint::black_box;
use std::time::Duration;

/// Room for the outputs of the largest batch.
struct Outputs([Vec<f32>; 7]);

impl Outputs {
    fn new() -> Self {
        Self([(); 7].map(|()| vec![0.0; DIRECTIONS[DIRECTIONS.len() - 1]]))
    }
    /// Draws of directions; with weights or without.
    fn draws<'a>(&'a mut self, u: &'a Triples, weights: bool) -> Request<'a> {
        let (u, n) = (black_box(u.slices()), u.slices()[0].len());
        let [x, y, z, pdf, colors @ ..] = self.0.each_mut().map(|s| &mut s[..n]);
        Draws { u, direction: [x, y, z], pdf: Some(pdf), weight: weights.then_some(colors) }.into()
    }
    /// Values, densities, or both.
    fn towards<'a>(&'a mut self, wi: &'a Triples, values: bool, densities: bool) -> Request<'a> {
        let (wi, n) = (black_box(wi.slices()), wi.slices()[0].len());
        let [_, _, _, pdf, colors @ ..] = self.0.each_mut().map(|s| &mut s[..n]);
        Towards { wi, value: values.then_some(colors), pdf: densities.then_some(pdf) }.into()
    }
    fn colors(&mut self, n: usize) -> [&mut [f32]; 3] {
        let [_, _, _, _, colors @ ..] = self.0.each_mut().map(|s| &mut s[..n]);
        colors
    }
}

/// Which (lobes, directions) a baseline is measured at: all batch sizes at 12 lobes, all lobes at 1024.
fn is_on_the_cross(lobes: usize, n: usize) -> bool {
    lobes == 12 || n == 1024
}

fn evaluate(c: &mut Criterion) {
    let mut out = Outputs::new();
    for level in levels() {
        level.set().expect("an available level");
        let mut group = c.benchmark_group(format!("evaluate.{}", level.name()));
        for lobes in LOBES {
            let mixture = general_mixture(lobes);
            for n in DIRECTIONS.into_iter().filter(|&n| is_on_the_cross(lobes, n)) {
                let directions = Triples::directions(n, 1);
                group.throughput(Throughput::Elements((lobes * n) as u64));
                group.bench_function(BenchmarkId::new(lobes.to_string(), n), |b| {
                    b.iter(|| mixture.ask(out.towards(&directions, true, false)).unwrap());
                });
            }
        }
        measure_named(&mut group, true, |mixture, n| {
            let directions = Triples::directions(n, 1);
            let mut out = Outputs::new();
            move || mixture.ask(out.towards(&directions, true, false)).unwrap()
        });
        group.finish();
    }
    for baseline in C::ALL {
        let mut group = c.benchmark_group(format!("evaluate.{}", baseline.name()));
        let (packed, directions) = (PackedLobes::new(&mild_lobes()), Triples::directions(1024, 1));
        group.throughput(Throughput::Elements(12 * 1024));
        group.bench_function(BenchmarkId::new("mild", 1024), |b| {
            b.iter(|| {
                baseline.evaluate(black_box(&packed), black_box(directions.slices()), out.colors(1024));
            });
        });
        for lobes in LOBES {
            let packed = PackedLobes::new(&general_lobes(lobes));
            for n in DIRECTIONS.into_iter().filter(|&n| is_on_the_cross(lobes, n)) {
                let directions = Triples::directions(n, 1);
                group.throughput(Throughput::Elements((lobes * n) as u64));
                group.bench_function(BenchmarkId::new(lobes.to_string(), n), |b| {
                    b.iter(|| {
                        let colors = out.colors(n);
                        baseline.evaluate(black_box(&packed), black_box(directions.slices()), colors);
                    });
                });
            }
        }
        group.finish();
    }
    let mut group = c.benchmark_group("evaluate.rust-libm");
    let (lobes, n) = (general_lobes(12), 1024);
    let directions = Triples::directions(n, 1);
    group.throughput(Throughput::Elements(12 * n as u64));
    group.bench_function(BenchmarkId::new("12", n), |b| {
        b.iter(|| (0..n).fold(Vec3::ZERO, |sum, i| sum + evaluate_libm(black_box(&lobes), directions.at(i))));
    });
    group.finish();
}

/// Each form of lobe alone, and the preset as it really is: a name in place of the number of lobes. `per_lobe`: a direction and a
/// lobe count as one element, as in the rest of the group.
fn measure_named<F: FnMut()>(
    group: &mut criterion::BenchmarkGroup<'_, criterion::measurement::WallTime>,
    per_lobe: bool,
    make: impl Fn(Mixture<'static, 64>, usize) -> F,
) {
    let n = 1024;
    for (name, mixture) in named_mixtures() {
        group.throughput(Throughput::Elements((if per_lobe { mixture.len() * n } else { n }) as u64));
        let mut run = make(mixture, n);
        group.bench_function(BenchmarkId::new(name, n), |b| b.iter(&mut run));
    }
}

fn pdf(c: &mut Criterion) {
    let mut out = Outputs::new();
    for level in levels() {
        level.set().expect("an available level");
        let mut group = c.benchmark_group(format!("pdf.{}", level.name()));
        for lobes in LOBES {
            let mixture = general_mixture(lobes);
            for n in DIRECTIONS.into_iter().filter(|&n| is_on_the_cross(lobes, n)) {
                let directions = Triples::directions(n, 1);
                group.throughput(Throughput::Elements((lobes * n) as u64));
                group.bench_function(BenchmarkId::new(lobes.to_string(), n), |b| {
                    b.iter(|| mixture.ask(out.towards(&directions, false, true)).unwrap());
                });
            }
        }
        group.finish();
    }
}

fn sample(c: &mut Criterion) {
    let mut out = Outputs::new();
    for level in levels() {
        level.set().expect("an available level");
        let mut group = c.benchmark_group(format!("sample.{}", level.name()));
        for lobes in LOBES {
            let mixture = general_mixture(lobes);
            for n in DIRECTIONS.into_iter().filter(|&n| is_on_the_cross(lobes, n)) {
                let uniforms = Triples::uniforms(n, 2);
                group.throughput(Throughput::Elements(n as u64));
                group.bench_function(BenchmarkId::new(lobes.to_string(), n), |b| {
                    b.iter(|| mixture.ask(out.draws(&uniforms, true)).unwrap());
                });
            }
        }
        measure_named(&mut group, false, |mixture, n| {
            let uniforms = Triples::uniforms(n, 2);
            let mut out = Outputs::new();
            move || mixture.ask(out.draws(&uniforms, true)).unwrap()
        });
        group.finish();
    }
    let mut group = c.benchmark_group("sample.rust-libm");
    let (lobes, mixture, n) = (general_lobes(12), general_mixture(12), 1024);
    let uniforms = Triples::uniforms(n, 2);
    group.throughput(Throughput::Elements(n as u64));
    group.bench_function(BenchmarkId::new("12", n), |b| {
        b.iter(|| (0..n).map(|i| sample_libm(black_box(&lobes), &mixture, uniforms.at(i)).1).sum::<f32>());
    });
    group.finish();
}

/// Every pair its own mixture, and the mixtures alone, of the garnet red preset.
fn pairs(c: &mut Criterion) {
    let material = Material::from_bytes(GARNET_RED).expect("the preset is valid");
    let mut out = Outputs::new();
    for level in levels() {
        level.set().expect("an available level");
        for n in [1, 7, 64, 1024] {
            let (wo, wi) = (Triples::directions(n, 3), Triples::directions(n, 4));
            let uniforms = Triples::uniforms(n, 5);
            let mut mixtures = vec![Mixture::<16>::empty(); n];
            let mut measure = |operation: &str, run: &mut dyn FnMut()| {
                let mut group = c.benchmark_group(format!("{operation}.{}", level.name()));
                group.throughput(Throughput::Elements(n as u64));
                group.bench_function(BenchmarkId::new("garnet", n), |b| b.iter(&mut *run));
                group.finish();
            };
            measure("prepare", &mut || {
                material.prepare_into(black_box(wo.slices()), &mut mixtures).unwrap();
            });
            measure("evaluate-pairs", &mut || {
                material.ask(black_box(wo.slices()), out.towards(&wi, true, true)).unwrap();
            });
            measure("pdf-pairs", &mut || {
                material.ask(black_box(wo.slices()), out.towards(&wi, false, true)).unwrap();
            });
            measure("sample-pdf-pairs", &mut || {
                material.ask(black_box(wo.slices()), out.draws(&uniforms, false)).unwrap();
            });
            measure("sample-pairs", &mut || {
                material.ask(black_box(wo.slices()), out.draws(&uniforms, true)).unwrap();
            });
        }
    }
}

fn configured() -> Criterion {
    println!("processor: {}", srbf_core::Processor::this());
    Criterion::default()
        .sample_size(12)
        .warm_up_time(Duration::from_millis(60))
        .measurement_time(Duration::from_millis(160))
        .without_plots()
}

criterion_group! { name = batch; config = configured(); targets = evaluate, pdf, sample, pairs }
criterion_main!(batch);
