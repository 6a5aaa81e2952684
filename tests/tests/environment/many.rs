//! Very many draws of every sampler: none has density 0 or is no number.
//!
//!     cargo test --release -p srbf-tests --test environment -- --ignored --nocapture a_hundred_million

use crate::edges::{hostile, hostile_mixtures};
use glam::Vec3;
use srbf_core::{Draws, Expanded, LightBlock, Material, Mixture, ProductSampling, Request, Sample};
use srbf_tests::inputs::{Random, UNIFORM};
use srbf_tests::kinds::upper;
use srbf_tests::maps::frame;
use std::path::Path;
use std::time::Instant;

/// Draws of each sampler, unless `SRBF_DRAWS` says how many.
const DRAWS: f64 = 1e8;

/// A uniform number; one in sixteen is an end of the range, or next to it.
fn number(random: &mut Random) -> f32 {
    let u = random.uniform();
    if u < 1.0 / 16.0 { UNIFORM[random.below(UNIFORM.len())] } else { u }
}

fn three(random: &mut Random) -> [f32; 3] {
    [(); 3].map(|()| number(random))
}

fn check(sample: &Sample, place: impl Fn() -> String) {
    let is_whole = sample.pdf > 0.0 && sample.pdf.is_finite() && sample.weight.is_finite();
    assert!(is_whole && sample.direction.is_finite(), "{}: {sample:?}", place());
}

/// Prints how long a sampler took, and that it has passed.
fn report(name: &str, draws: u64, start: Instant) {
    println!("{name}: {draws} draws, none of density 0, in {:.1} s", start.elapsed().as_secs_f64());
}

/// Presets, each for a direction from the normal to the horizon.
fn materials() -> Vec<Material<Vec<u8>>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../presets");
    let load = |name| Material::from_bytes(std::fs::read(folder.join(name)).unwrap()).unwrap();
    ["cayman.srbf", "garnet_red.srbf", "krylon_blue.srbf"].map(load).into()
}

#[test]
#[ignore = "draws 1e8 directions by each of six samplers: two and a half minutes on a shared processor"]
fn a_hundred_million_draws_of_every_sampler_have_a_density() {
    let asked = std::env::var("SRBF_DRAWS").ok().and_then(|n| n.parse::<f64>().ok());
    let draws = asked.unwrap_or(DRAWS) as u64;
    of_maps(draws);
    of_mixtures(draws);
    of_materials(draws);
    of_light_and_material(draws);
}

/// Of `Environment::sample`.
fn of_maps(draws: u64) {
    let (start, mut random, maps) = (Instant::now(), Random(43), hostile());
    let each = draws.div_ceil(maps.len() as u64);
    for map in &maps {
        let environment = map.environment();
        for _ in 0..each {
            let sample = environment.sample(three(&mut random));
            let weight = sample.radiance / sample.pdf;
            assert!(sample.pdf > 0.0 && weight.is_finite(), "{}: {sample:?}", map.name);
        }
    }
    report("maps", each * maps.len() as u64, start);
}

/// Of `Mixture::sample`, of mixtures of one's own.
fn of_mixtures(draws: u64) {
    let (start, mut random, mixtures) = (Instant::now(), Random(44), hostile_mixtures());
    let each = draws.div_ceil(mixtures.len() as u64);
    for (i, m) in mixtures.iter().enumerate() {
        for _ in 0..each {
            let u = three(&mut random);
            let sample = m.sample(u).expect("a mixture that reflects");
            check(&sample, || format!("mixture {i}, {u:?}"));
        }
    }
    report("mixtures", each * mixtures.len() as u64, start);
}

/// Of mixtures that materials make ready, and of expanded materials in batches.
fn of_materials(draws: u64) {
    const BATCH: usize = 64;
    let (mut random, materials) = (Random(45), materials());
    let start = Instant::now();
    let rounds = draws.div_ceil((materials.len() * BATCH) as u64);
    let mut mixture = Mixture::<64>::empty();
    for (i, material) in materials.iter().enumerate() {
        for _ in 0..rounds {
            let wo = upper(&mut random);
            material.prepare(wo, &mut mixture).unwrap();
            for _ in 0..BATCH {
                let u = three(&mut random);
                let sample = mixture.sample(u).expect("a material that reflects");
                check(&sample, || format!("material {i}, {wo}, {u:?}"));
            }
        }
    }
    report("prepared materials", rounds * (materials.len() * BATCH) as u64, start);

    let start = Instant::now();
    for (i, material) in materials.iter().enumerate() {
        let mut memory = vec![0.0; material.expanded_len(Expanded::DEFAULT_ROWS)];
        let expanded = Expanded::new(material, Expanded::DEFAULT_ROWS, &mut memory).unwrap();
        let [mut wo, mut u, mut direction, mut weight] = [[[0f32; BATCH]; 3]; 4];
        let mut pdf = [0f32; BATCH];
        for _ in 0..rounds {
            for k in 0..BATCH {
                let (outgoing, numbers) = (upper(&mut random), three(&mut random));
                (0..3).for_each(|c| (wo[c][k], u[c][k]) = (outgoing[c], numbers[c]));
            }
            let [x, y, z] = &mut direction;
            let [red, green, blue] = &mut weight;
            let [wo, u] = [&wo, &u].map(|rows| rows.each_ref().map(|row| &row[..]));
            let (direction_rows, weight_rows) =
                ([&mut x[..], &mut y[..], &mut z[..]], [&mut red[..], &mut green[..], &mut blue[..]]);
            let draw = Draws { u, direction: direction_rows, pdf: Some(&mut pdf), weight: Some(weight_rows) };
            expanded.ask(wo, Request { draw: Some(draw), evaluate: None }).unwrap();
            for (k, &pdf) in pdf.iter().enumerate() {
                let of = |rows: &[[f32; BATCH]; 3]| Vec3::new(rows[0][k], rows[1][k], rows[2][k]);
                let sample = Sample { direction: of(&direction), pdf, weight: of(&weight) };
                check(&sample, || format!("expanded material {i}, {k}"));
            }
        }
    }
    report("expanded materials", rounds * (materials.len() * BATCH) as u64, start);
}

/// Of light and material together, by candidates and by even sums.
fn of_light_and_material(draws: u64) {
    const COUNT: usize = 16;
    let (mut random, maps, mixtures) = (Random(46), hostile(), hostile_mixtures());
    let sampling = ProductSampling::new(COUNT, 0.5, 4.0).unwrap();
    let cases = (maps.len() * mixtures.len()) as u64;
    let rows = |random: &mut Random| {
        let mut rows = [[0.0; COUNT]; 3];
        rows.as_flattened_mut().fill_with(|| number(random));
        rows
    };

    let (start, each) = (Instant::now(), draws.div_ceil(cases * COUNT as u64));
    for map in &maps {
        let environment = map.environment();
        for m in &mixtures {
            for _ in 0..each {
                let (u, axes, choice) = (rows(&mut random), frame(random.direction()), number(&mut random));
                let u = u.each_ref().map(|row| &row[..]);
                let drawn = m.sample_product(&environment, &axes, &sampling, u, choice).unwrap();
                let is_whole =
                    drawn.is_none_or(|sample| sample.weight.is_finite() && sample.direction.is_finite());
                assert!(is_whole, "{}: {drawn:?}", map.name);
            }
        }
    }
    report("candidates", each * cases * COUNT as u64, start);

    // Sixteen directions of the map and eight of the lobes.
    let (start, each) = (Instant::now(), draws.div_ceil(cases * (COUNT as u64 + 8)));
    for map in &maps {
        let environment = map.environment();
        for m in &mixtures {
            for _ in 0..each {
                let (u, axes, choice) = (rows(&mut random), frame(random.direction()), number(&mut random));
                let block = LightBlock::new(&environment, rows(&mut random).each_ref());
                assert!(block.pdf.iter().all(|&pdf| pdf > 0.0), "{}: {block:?}", map.name);
                let u = u.each_ref().map(|row| &row[..8]);
                let drawn = m.reflect(&environment, &block, &axes, axes[2], u, choice).unwrap();
                if let Some(ray) = drawn.ray {
                    check(&ray, || format!("{}, by even sums", map.name));
                }
                for (escapes, clear) in [(false, false), (false, true), (true, false), (true, true)] {
                    let light = drawn.light(escapes, clear);
                    assert!(light.is_finite(), "{}: {drawn:?}", map.name);
                }
            }
        }
    }
    report("even sums", each * cases * (COUNT as u64 + 8), start);
}
