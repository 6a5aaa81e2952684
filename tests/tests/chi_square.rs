//! Chi-square: the samples of mixtures follow their density; a density that is slightly wrong is rejected.

use glam::Vec3;
use srbf_core::{Domain, Level, Line, Lobe, Material, Mixture, PlaneLobe, View, encoded_len};
use srbf_tests::inputs::Random;
use srbf_tests::partition::Partition;
use srbf_tests::statistics::sidak;

const SAMPLES: usize = 160_000;
/// Samples of the negative controls: enough for 2 % in 12 lobes that overlap.
const CONTROL_SAMPLES: usize = 1_200_000;
const ALPHA: f64 = 0.01;

/// A material of random lobes at five views, those of a kind from view to view.
///
/// Of `lobes` lobes the last `2 mirrored` are pairs, `squeezed` see the squeezed direction.
fn material(random: &mut Random, lobes: usize, squeezed: usize, mirrored: usize) -> Vec<u8> {
    let lobes = lobes - mirrored;
    let start: Vec<PlaneLobe> = (0..lobes)
        .map(|_| {
            let log2_sharpness = random.between(0.0, 12.0);
            let level = log2_sharpness - 6.0 + random.between(-2.0, 2.0);
            PlaneLobe {
                angle: 0.0,
                off_plane: 0.0,
                log2_sharpness,
                log2_luminance: level,
                color_differences: [random.between(-1.5, 2.0), random.between(-1.0, 6.0)],
            }
        })
        .collect();
    let views: Vec<Vec<PlaneLobe>> = (0..5)
        .map(|view| {
            let mut lobes = start.clone();
            if view > 0 {
                for lobe in lobes.iter_mut().rev().take(mirrored) {
                    lobe.off_plane = 0.3 * view as f32;
                }
                for lobe in &mut lobes {
                    lobe.angle = 0.35 * view as f32 + random.between(-0.2, 0.2);
                    lobe.log2_sharpness += random.between(-0.5, 0.5);
                }
            }
            lobes
        })
        .collect();
    let views: Vec<View> = views
        .iter()
        .enumerate()
        .map(|(i, lobes)| View {
            theta: 0.38 * i as f32,
            log2_squeeze: -0.6 * i as f32,
            log2_diffuse: if squeezed > 0 { 0.4 } else { -126.0 },
            diffuse_color_differences: [0.5, -0.2],
            lobes,
        })
        .collect();
    let mut bytes = vec![0; encoded_len(views.len(), lobes, mirrored, "")];
    Line { views: &views, squeezed, mirrored, factors: None }.encode("", &mut bytes).unwrap();
    bytes
}

/// Ten outgoing directions, from the normal to almost grazing, all round.
fn outgoing() -> impl Iterator<Item = Vec3> {
    (0..10).map(|i| {
        let (theta, phi) = ((i as f32 * 9.9).to_radians(), i as f32 * 2.4);
        Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
    })
}

fn run(mixture: &Mixture<64>, seed: u64) -> (f64, f64, usize) {
    let mut random = Random(seed);
    let partition = Partition::new(mixture, |d| mixture.pdf(d));
    let result = partition.test(SAMPLES, || {
        loop {
            if let Some(sample) = mixture.sample(random.three()) {
                return sample.direction;
            }
        }
    });
    (result.p, partition.total(), partition.len())
}

#[test]
fn samples_of_mixtures_follow_their_density() {
    Level::current();
    let counts = [1usize, 2, 5, 12, 64];
    let mut jobs: Vec<(String, Mixture<64>)> = Vec::new();
    let mut random = Random(21);
    for count in counts {
        // Isotropic: axes in the plane of incidence or in pairs beside it, prepared for ten outgoing directions.
        for (squeezed, mirrored) in [(0, 0), (count.div_ceil(2), 0), (count / 3, count / 4)] {
            // The jobs below borrow it.
            let bytes = material(&mut random, count, squeezed, mirrored);
            let material: &_ = Box::leak(Box::new(Material::from_bytes(bytes).unwrap()));
            for wo in outgoing() {
                let mut m = Mixture::<64>::empty();
                material.prepare(wo, &mut m).unwrap();
                jobs.push((
                    format!("isotropic, {count} lobes, {squeezed} squeezed, {mirrored} pairs, wo {wo}"),
                    m,
                ));
            }
        }
        // Tilted: any axes, on the sphere and folded, squeezed or not.
        for (domain, squeeze) in [
            (Domain::Sphere, 1.0),
            (Domain::Sphere, 0.3),
            (Domain::Hemisphere, 1.0),
            (Domain::Hemisphere, 0.1),
            (Domain::Hemisphere, 2.0),
        ] {
            for _ in 0..2 {
                let m = random.mixture(domain, count, squeeze);
                jobs.push((format!("tilted, {count} lobes, {domain:?}, squeeze {squeeze}"), m));
            }
        }
    }
    let level = sidak(ALPHA, jobs.len());
    let (mut least, mut off) = (1f64, 0f64);
    for (seed, (name, m)) in jobs.iter().enumerate() {
        let (p, total, bins) = run(m, 1000 + seed as u64);
        assert!((total - 1.0).abs() < 2e-5, "{name}: the density integrates to {total}");
        assert!(p > level, "{name}: p = {p:e} in {bins} bins, level {level:e}");
        least = least.min(p);
        off = off.max((total - 1.0).abs());
    }
    println!(
        "{} mixtures: least p {least:.2e} (level {level:.1e}), densities integrate to 1 within {off:.1e}",
        jobs.len()
    );
}

#[test]
fn a_density_that_is_slightly_wrong_is_rejected() {
    let mut random = Random(22);
    for (count, squeeze) in [(1, 1.0), (1, 0.2), (5, 1.0), (12, 0.3)] {
        let lobes: Vec<Lobe> = (0..count).map(|_| random.lobe(0.0, 4.0)).collect();
        let squeezed = if squeeze == 1.0 { 0 } else { count };
        let make = |lobes: &[Lobe], squeeze| {
            Mixture::<64>::new(Domain::Hemisphere, squeeze, &lobes[..squeezed], &lobes[squeezed..]).unwrap()
        };
        let m = make(&lobes, squeeze);
        let p = |wrong: &Mixture<64>| {
            let mut random = Random(23);
            let partition = Partition::new(wrong, |d| wrong.pdf(d));
            partition.test(CONTROL_SAMPLES, || m.sample(random.three()).map_or(Vec3::Z, |s| s.direction)).p
        };
        let level = sidak(ALPHA, 150);
        // The integral of each lobe stays, so that only the shape is off.
        let sharper: Vec<Lobe> = lobes
            .iter()
            .map(|l| Lobe::new(l.gaussian.axis, l.gaussian.sharpness * 1.02, l.amplitude * 1.02).unwrap())
            .collect();
        let right = p(&m);
        assert!(right > level, "{count} lobes: the right density has p = {right:e}");
        let wrong = p(&make(&sharper, squeeze));
        println!(
            "{count} lobes, squeeze {squeeze}: p {right:.2e} for the density, {wrong:.2e} with sharpness 2 % off"
        );
        assert!(wrong < level, "{count} lobes: 2 % in sharpness has p = {wrong:e}");
        if squeezed > 0 {
            let wrong = p(&make(&lobes, squeeze * 1.02));
            assert!(wrong < level, "{count} lobes: 2 % in the squeeze has p = {wrong:e}");
        }
    }
}
