//! One direction at a time, as a megakernel renderer calls: `operation.level/lobes/1`.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use srbf_benches::baseline::{evaluate_libm, sample_libm};
use srbf_benches::{GARNET_RED, Triples, garnet_mixture, general_lobes, general_mixture, levels};
use srbf_core::{Material, Mixture, Vec3};
use std::hint::black_box;
use std::time::Duration;

/// Calls with the numbers from 0 to 1023 over and over.
fn counter() -> impl FnMut() -> usize {
    let mut i = 0;
    move || {
        i = (i + 1) & 1023;
        i
    }
}

fn single(c: &mut Criterion) {
    let (directions, uniforms) = (Triples::directions(1024, 1), Triples::uniforms(1024, 2));
    let directions: Vec<Vec3> = (0..1024).map(|i| directions.at(i)).collect();
    let uniforms: Vec<[f32; 3]> = (0..1024).map(|i| uniforms.at(i).to_array()).collect();
    let material = Material::from_bytes(GARNET_RED).expect("the preset is valid");
    let mut next = counter();
    for level in levels() {
        level.set().expect("an available level");
        for (name, mixture) in [("12", general_mixture(12)), ("garnet", garnet_mixture())] {
            let mut measure = |operation: &str, run: &mut dyn FnMut(usize) -> f32| {
                let mut group = c.benchmark_group(format!("{operation}.{}", level.name()));
                group.bench_function(BenchmarkId::new(name, 1), |b| b.iter(|| run(next())));
                group.finish();
            };
            measure("one-pdf", &mut |i| mixture.pdf(black_box(directions[i])));
            measure("one-evaluate", &mut |i| mixture.evaluate(black_box(directions[i])).x);
            measure("one-sample", &mut |i| {
                mixture.sample_direction(black_box(uniforms[i])).map_or(0.0, |d| d.x)
            });
            measure("one-sample-value", &mut |i| {
                mixture.sample(black_box(uniforms[i])).map_or(0.0, |s| s.direction.x + s.pdf + s.weight.x)
            });
        }
        let mut mixture = Mixture::<16>::empty();
        let mut group = c.benchmark_group(format!("one-prepare.{}", level.name()));
        group.bench_function(BenchmarkId::new("garnet", 1), |b| {
            b.iter(|| {
                material.prepare(black_box(directions[next()]), &mut mixture).unwrap();
                mixture.power()
            });
        });
        group.finish();
        // A hit of a path: colours, and values at the path's four wavelengths.
        let primaries = material.primaries(&[440.0, 515.0, 590.0, 665.0]);
        let mut hit = |i: usize| {
            material.prepare(black_box(directions[i]), &mut mixture).unwrap();
            let (value, pdf) = mixture.evaluate_and_pdf(black_box(directions[i ^ 1]));
            let weight = mixture.sample(black_box(uniforms[i])).map_or(Vec3::ZERO, |s| s.weight * s.pdf);
            (value * pdf, weight)
        };
        let mut group = c.benchmark_group(format!("one-hit.{}", level.name()));
        group.bench_function(BenchmarkId::new("garnet", "colours"), |b| {
            b.iter(|| {
                let (value, weight) = hit(next());
                black_box(value);
                black_box(weight);
            });
        });
        group.bench_function(BenchmarkId::new("garnet", "wavelengths"), |b| {
            b.iter(|| {
                let (value, weight) = hit(next());
                black_box(primaries.of(value));
                black_box(primaries.of(weight));
            });
        });
        group.finish();
    }
    let (lobes, mixture) = (general_lobes(12), general_mixture(12));
    let mut group = c.benchmark_group("one-evaluate.rust-libm");
    group.bench_function(BenchmarkId::new("12", 1), |b| {
        b.iter(|| evaluate_libm(&lobes, black_box(directions[next()])));
    });
    group.finish();
    let mut group = c.benchmark_group("one-sample-pdf.rust-libm");
    group.bench_function(BenchmarkId::new("12", 1), |b| {
        b.iter(|| sample_libm(&lobes, &mixture, Vec3::from_array(black_box(uniforms[next()]))));
    });
    group.finish();
}

fn configured() -> Criterion {
    println!("processor: {}", srbf_core::Processor::this());
    Criterion::default()
        .sample_size(12)
        .warm_up_time(Duration::from_millis(60))
        .measurement_time(Duration::from_millis(160))
        .without_plots()
}

criterion_group! { name = benches; config = configured(); targets = single }
criterion_main!(benches);
