//! Even sums of light and lobes, corrected by two rays: against a plain text, and their means against multiple importance sampling,
//! in the open and where things are in the way.

use glam::{DVec3, Vec3};
use srbf_core::{
    Environment, Error, LIGHT_BLOCK, LightBlock, Lobe, Material, Mixture, Reflection, luminance,
};
use srbf_tests::inputs::{Random, levels};
use srbf_tests::kinds::turned_materials;
use srbf_tests::maps::{Map, Moments, both_ways, bright, frame, to_local, to_world};
use std::path::Path;

type Numbers = [[f32; 16]; 3];

fn numbers(random: &mut Random) -> Numbers {
    let mut u = [[0.0; 16]; 3];
    u.as_flattened_mut().fill_with(|| random.uniform());
    u
}

fn block(environment: &Environment<Vec<u32>>, random: &mut Random) -> LightBlock {
    let u = numbers(random);
    LightBlock::new(environment, u.each_ref())
}

/// Presets with and without factors, a brushed surface, and lobes of one's own.
fn mixtures() -> Vec<(String, Mixture<'static, 64>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../presets");
    let mut all = Vec::new();
    for (name, wo) in [
        ("cayman", Vec3::new(0.36, 0.48, 0.8)),
        ("garnet_red", Vec3::new(0.0, 0.0, 1.0)),
        ("krylon_blue", Vec3::new(0.0, -0.96, 0.28)),
    ] {
        let bytes = std::fs::read(folder.join(name).with_extension("srbf")).unwrap();
        let material: &'static Material<Vec<u8>> = Box::leak(Box::new(Material::from_bytes(bytes).unwrap()));
        let mut m = Mixture::empty();
        material.prepare(wo, &mut m).unwrap();
        all.push((name.to_owned(), m));
    }
    // A brushed surface at three of its turns.
    let (_, bytes) = turned_materials().swap_remove(0);
    let material: &'static Material<Vec<u8>> = Box::leak(Box::new(Material::from_bytes(bytes).unwrap()));
    for wo in [Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.36, 0.48, 0.8), Vec3::new(0.1, -0.7, 0.707).normalize()]
    {
        let mut m = Mixture::empty();
        material.prepare(wo, &mut m).unwrap();
        all.push((format!("brushed {wo}"), m));
    }
    let sharp = Lobe::new(Vec3::new(0.5, 0.2, 1.0).normalize(), 400.0, Vec3::new(20.0, 15.0, -1.0)).unwrap();
    let wide = Lobe::new(Vec3::Z, 2.0, Vec3::splat(0.1)).unwrap();
    all.push(("lobes".into(), Mixture::hemisphere(&[sharp, wide]).unwrap()));
    all
}

fn maps() -> [Map; 3] {
    [Map::sky(), Map::noise(64, 33), Map::pixel(128, 64, 70, 20)]
}

/// The two sums in f64, in their plainest form, and the factors on the two rays.
fn plain(
    m: &Mixture<'_, 64>,
    environment: &Environment<Vec<u32>>,
    block: &LightBlock,
    axes: &[Vec3; 3],
    flat: Vec3,
    u: &Numbers,
    count: usize,
) -> ([DVec3; 2], DVec3) {
    let (mut of_block, mut of_lobes, mut own) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
    for i in 0..LIGHT_BLOCK {
        let at = |rows: &Numbers| Vec3::new(rows[0][i], rows[1][i], rows[2][i]);
        let (value, p_b) = m.evaluate_and_pdf(to_local(axes, at(&block.direction)));
        let (p_b, p_e) = (f64::from(p_b), f64::from(block.pdf[i]));
        let weight = p_e * p_e / (p_e * p_e + p_b * p_b);
        if at(&block.direction).dot(flat) > 0.0 {
            of_block += value.as_dvec3() * at(&block.light).as_dvec3() * weight / 16.0;
        }
    }
    #[allow(clippy::needless_range_loop)] // three rows are read at a time
    for i in 0..count {
        let sample = m.sample([u[0][i], u[1][i], u[2][i]]).unwrap();
        let world = to_world(axes, sample.direction);
        let (radiance, p_e) = environment.radiance_and_pdf(world);
        let (p_b, p_e) = (f64::from(sample.pdf), f64::from(p_e));
        let weight = p_b * p_b / (p_b * p_b + p_e * p_e);
        let above = if world.dot(flat) > 0.0 { 1.0 } else { 0.0 };
        let brought = sample.weight.as_dvec3() * radiance.as_dvec3() * weight * above;
        own = if i == 0 { brought } else { own };
        of_lobes += brought / count as f64;
    }
    ([of_block, of_lobes], own)
}

#[test]
fn every_level_sums_what_a_plain_text_sums() {
    let mut random = Random(171);
    let (mut worst, mut dark) = (0f64, 0);
    for (name, m) in mixtures() {
        for map in [Map::noise(16, 8), Map::sky()] {
            let environment = map.environment().turned(0.4);
            for level in levels() {
                let m = m.clone().with_level(level).unwrap();
                for round in 0..60 {
                    let axes = frame(random.direction());
                    let flat = (axes[2] + 0.3 * random.direction()).normalize();
                    let (block, u) = (block(&environment, &mut random), numbers(&mut random));
                    let count = [1, 2, 7, 8, 9, 15, 16][round % 7];
                    let choice = random.uniform();
                    let given = u.each_ref().map(|u| &u[..count]);
                    let got = m.reflect(&environment, &block, &axes, flat, given, choice).unwrap();
                    let (sums, own) = plain(&m, &environment, &block, &axes, flat, &u, count);
                    let ray = got.ray.unwrap();
                    let one = m.sample([u[0][0], u[1][0], u[2][0]]).unwrap();
                    assert!((ray.direction - one.direction).length() < 2e-6, "{name} {level:?}");
                    let largest = sums[0].abs().max_element() + sums[1].abs().max_element();
                    let parts = [
                        (got.block_sum, sums[0]),
                        (got.ray_sum, sums[1]),
                        (got.ray_light * got.ray_value, own),
                    ];
                    for (got, want) in parts {
                        let error = (got.as_dvec3() - want).abs().max_element() / largest.max(1e-12);
                        worst = worst.max(error);
                        assert!(error < 2e-3, "{name}, {level:?}, {}: {got} {want} {largest}", map.name);
                    }
                    // In the open it is the sums alone; where nothing is seen, nothing.
                    let open = got.light(true, true);
                    let apart = (open - got.block_sum - got.ray_sum).abs().max_element();
                    assert!(
                        f64::from(apart) <= 1e-5 * (largest + f64::from(open.abs().max_element())),
                        "{got:?}"
                    );
                    if got.shadow.is_some() {
                        assert_eq!(got.light(false, false), Vec3::ZERO);
                    } else {
                        // No direction of the block brings light. A shadow ray that does not exist hides none of the lobes' sum.
                        dark += 1;
                        assert_eq!(got.light(true, false), open, "{got:?}");
                        assert_eq!(got.light(false, false), got.light(false, true), "{got:?}");
                    }
                }
            }
        }
    }
    println!("largest difference: {worst:.1e} of the sums; {dark} blocks without light");
    assert!(dark > 10, "{dark}");
}

/// Where nothing is in the way, below an object that hides half of the sky, and nearly everywhere.
const HIDDEN: [fn(Vec3) -> bool; 3] =
    [|_| false, |d| (7.0 * d.x + 3.0 * d.z).sin() > 0.2, |d| (9.0 * d.y).cos() < 0.8];

/// The light of many draws, and by multiple importance sampling.
fn means(
    m: &Mixture<'_, 64>,
    map: &Map,
    is_hidden: fn(Vec3) -> bool,
    planted: f64,
    draws: usize,
    seed: u64,
) -> [Moments; 2] {
    let environment = map.environment();
    let mut random = Random(seed);
    let axes = frame(Vec3::new(0.2, -0.3, 0.9).normalize());
    let flat = axes[2];
    let seen = |d: Vec3| d.dot(flat) > 0.0 && !is_hidden(d);
    let (mut ours, mut theirs) = (Moments::default(), Moments::default());
    for _ in 0..draws {
        let (block, choice) = (block(&environment, &mut random), random.uniform());
        // The own direction and its shifts along a lattice.
        let own = random.three();
        let shift =
            |k: usize, i: usize| (own[k] + i as f32 * [1.0, 3.0, 5.0][k] / 8.0).fract().min(0.999_999_9);
        let u: [[f32; 8]; 3] = [0, 1, 2].map(|k| std::array::from_fn(|i| shift(k, i)));
        let u = u.each_ref().map(|u| &u[..]);
        let drawn: Reflection = m.reflect(&environment, &block, &axes, flat, u, choice).unwrap();
        let ray = drawn.ray.is_some_and(|ray| seen(to_world(&axes, ray.direction)));
        let shadow = drawn.shadow.is_some_and(seen);
        ours.see(bright(drawn.light(ray, shadow)) * planted);
    }
    for _ in 0..16 * draws {
        let sum = both_ways(m, &environment, &axes, seen, [random.three(), random.three()]);
        theirs.see(bright(sum));
    }
    [ours, theirs]
}

fn apart([ours, theirs]: &[Moments; 2]) -> f64 {
    (ours.mean() - theirs.mean())
        / ours.error().hypot(theirs.error()).max(2e-5 * theirs.mean().abs()).max(1e-30)
}

#[test]
fn means_are_those_of_multiple_importance_sampling_and_a_planted_bias_is_found() {
    let mut cases = Vec::new();
    for (i, (name, m)) in mixtures().into_iter().enumerate() {
        for (j, map) in maps().into_iter().enumerate() {
            for (k, is_hidden) in HIDDEN.into_iter().enumerate() {
                // A third of all, each with each.
                if (i + j + k) % 3 == 0 {
                    cases.push((
                        format!("{name}, {}, hidden {k}", map.name),
                        m.clone(),
                        map.clone(),
                        is_hidden,
                    ));
                }
            }
        }
    }
    let run = |from: usize| {
        let own = cases.iter().enumerate().skip(from).step_by(2);
        own.map(|(n, (name, m, map, is_hidden))| {
            let z = apart(&means(m, map, *is_hidden, 1.0, 60_000, 900 + n as u64));
            println!("{name}: {z:.2} standard errors");
            z
        })
        .collect::<Vec<f64>>()
    };
    let z: Vec<f64> = std::thread::scope(|scope| {
        let other = scope.spawn(|| run(1));
        let own = run(0);
        own.into_iter().chain(other.join().expect("no panic")).collect()
    });
    let worst = z.iter().fold(0f64, |a, b| a.max(b.abs()));
    let rms = (z.iter().map(|z| z * z).sum::<f64>() / z.len() as f64).sqrt();
    println!("{} cases: rms {rms:.2}, worst {worst:.2}", z.len());
    assert!(worst < 4.0 && rms < 1.6, "{worst} {rms}");
    let (_, m) = &mixtures()[0];
    let planted = apart(&means(m, &maps()[1], HIDDEN[0], 1.01, 200_000, 5));
    assert!(planted > 4.0, "a bias of 1 % is {planted:.2} standard errors");
}

/// Where the lobes sample another function, its own mean is found.
#[test]
fn another_truth_keeps_its_mean() {
    let (_, m) = &mixtures()[0];
    let environment = Map::noise(64, 33).environment();
    let axes = frame(Vec3::Z);
    let truth = |d: Vec3, value: Vec3| value * (1.0 + 0.5 * (5.0 * d.x).sin());
    let seen = |d: Vec3| d.z > 0.0 && !HIDDEN[1](d);
    let mut random = Random(77);
    let (mut ours, mut theirs) = (Moments::default(), Moments::default());
    for _ in 0..200_000 {
        let (block, choice, u) = (block(&environment, &mut random), random.uniform(), numbers(&mut random));
        let u = u.each_ref().map(|u| &u[..8]);
        let drawn = m.reflect(&environment, &block, &axes, axes[2], u, choice).unwrap();
        let ray = drawn.ray.unwrap();
        let shadow = drawn.shadow.unwrap_or(-axes[2]);
        let values =
            [truth(ray.direction, drawn.ray_value), truth(to_local(&axes, shadow), drawn.shadow_value)];
        let escapes = seen(to_world(&axes, ray.direction));
        ours.see(bright(drawn.light_of(escapes, drawn.shadow.is_some_and(seen), values[0], values[1])));
        let sample = environment.sample(random.three());
        let (value, pdf) = m.evaluate_and_pdf(to_local(&axes, sample.direction));
        let mut sum = truth(to_local(&axes, sample.direction), value) * sample.radiance / (sample.pdf + pdf);
        sum = if seen(sample.direction) { sum } else { Vec3::ZERO };
        if let Some(ray) = m.sample(random.three()) {
            let world = to_world(&axes, ray.direction);
            let (radiance, pdf) = environment.radiance_and_pdf(world);
            let brought = truth(ray.direction, ray.weight) * radiance * (ray.pdf / (ray.pdf + pdf));
            sum += if seen(world) { brought } else { Vec3::ZERO };
        }
        theirs.see(bright(sum));
    }
    let z = apart(&[ours, theirs]);
    assert!(z.abs() < 4.0, "{z}");
}

#[test]
fn a_cell_is_drawn_from_with_the_density_of_the_map() {
    let environment = Map::noise(16, 8).environment();
    let (mut random, mut sums) = (Random(15), [0.0f64; 2]);
    let shares: Vec<f64> =
        (0..environment.cell_count()).map(|i| environment.cell(i).unwrap().share).collect();
    for _ in 0..200_000 {
        let mut left = f64::from(random.uniform());
        let cell = shares.iter().position(|share| {
            left -= share;
            left < 0.0
        });
        let u = random.three();
        let sample = environment.sample_cell(cell.unwrap_or(shares.len() - 1), [u[0], u[1]]).unwrap();
        environment.prefetch_cell(cell.unwrap_or(0));
        let ratio = luminance(sample.radiance / sample.pdf) / environment.power();
        assert!((ratio - 1.0).abs() < 1e-4, "{sample:?}");
        assert!((environment.pdf(sample.direction) / sample.pdf - 1.0).abs() < 2e-2, "{sample:?}");
        sums[0] += f64::from(sample.direction.z);
        sums[1] += f64::from(environment.sample(random.three()).direction.z);
    }
    assert!((sums[0] - sums[1]).abs() < 5.0 * (2.0 * 200_000f64 / 3.0).sqrt(), "{sums:?}");
    assert_eq!(environment.sample_cell(environment.cell_count(), [0.5; 2]), None);
    assert_eq!(Map::pixel(16, 8, 3, 3).environment().sample_cell(0, [0.5; 2]), None);
    environment.prefetch_cell(usize::MAX);
    let block = block(&environment, &mut random);
    block.prefetch();
    let again = LightBlock::of(|i| srbf_core::EnvironmentSample {
        direction: Vec3::new(block.direction[0][i], block.direction[1][i], block.direction[2][i]),
        pdf: block.pdf[i],
        radiance: Vec3::new(block.light[0][i], block.light[1][i], block.light[2][i]) * block.pdf[i],
    });
    assert_eq!((again.direction, again.pdf), (block.direction, block.pdf));
}

#[test]
fn numbers_that_are_none_are_refused() {
    let (_, m) = &mixtures()[0];
    let environment = Map::noise(16, 8).environment();
    let block = block(&environment, &mut Random(3));
    let axes = frame(Vec3::Z);
    let refused =
        |u: [&[f32]; 3]| m.reflect(&environment, &block, &axes, Vec3::Z, u, 0.5).err() == Some(Error::Length);
    assert!(
        refused([&[], &[], &[]]) && refused([&[0.5; 17]; 3]) && refused([&[0.5; 2], &[0.5; 3], &[0.5; 2]])
    );
    let black = Mixture::<16>::empty();
    let drawn = black.reflect(&environment, &block, &axes, Vec3::Z, [&[0.5]; 3], 0.5).unwrap();
    assert!(drawn.ray.is_none() && drawn.shadow.is_none() && drawn.light(true, true) == Vec3::ZERO);
}
