//! Every preset: samples follow the density, value and density are continuous in the outgoing direction, damaged bytes
//! are refused.

use glam::Vec3;
use srbf_core::{Material, Mixture, read_file};
use srbf_tests::inputs::Random;
use srbf_tests::oracle;
use srbf_tests::partition::Partition;
use srbf_tests::statistics::sidak;
use std::path::Path;

fn presets() -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../presets");
    let mut all: Vec<(String, Vec<u8>)> = std::fs::read_dir(&folder)
        .unwrap_or_else(|e| panic!("{}: {e}", folder.display()))
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "srbf"))
        .map(|path| (path.file_stem().unwrap().to_string_lossy().into_owned(), std::fs::read(&path).unwrap()))
        .collect();
    all.sort();
    assert!(all.len() >= 3, "{} presets in {}", all.len(), folder.display());
    all
}

fn wo(theta: f32, phi: f32) -> Vec3 {
    Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
}

fn prepare<'m>(material: &'m Material<impl AsRef<[u8]>>, wo: Vec3) -> Mixture<'m, 64> {
    let mut m = Mixture::empty();
    material.prepare(wo, &mut m).unwrap();
    m
}

#[test]
fn every_preset_is_read_as_it_is() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../presets");
    for (name, bytes) in presets() {
        assert_eq!(read_file(&folder.join(&name).with_extension("srbf")).unwrap(), bytes, "{name}");
    }
}

/// Bytes of version 1 hold the logarithms of red, green and blue, and are interpolated in these.
#[test]
fn version_1_is_read_as_it_was() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus/version1.srbf");
    let bytes = std::fs::read(path).unwrap();
    let material = Material::from_bytes(&bytes).unwrap();
    assert_eq!((bytes[8], material.factor_nodes(), material.largest_factor()), (1, None, 1.0));
    let number = |at: usize| f32::from_le_bytes(bytes[48 + 4 * at..][..4].try_into().unwrap());
    let (views, lobes, mirrored) =
        (material.view_count(), material.view_lobe_count(), material.mirrored_count());
    let head = |view: usize, i: usize| f64::from(number(views + 4 * view + i));
    let row = |view: usize, row: usize, lobe: usize| {
        f64::from(number(5 * views + (5 * view + row) * lobes + view * mirrored + lobe))
    };
    // An amplitude that is stored as 0 is 0.
    let power = |log2: f64| if log2 <= -125.5 { 0.0 } else { log2.exp2() };
    let close = |got: f64, want: f64, scale: f64, name: &str| {
        assert!((got - want).abs() <= 3e-6 * scale, "{name}: {got}, {want}");
    };
    for view in 0..views {
        for k in 0..lobes {
            let lobe = material.view_lobe(view, k).unwrap();
            let got =
                oracle::color(f64::from(lobe.log2_luminance).exp2(), lobe.color_differences.map(f64::from));
            for c in 0..3 {
                close(got[c], power(row(view, 2 + c, k)), got.max_element(), "lobe of a view");
            }
        }
        let diffuse = f64::from(material.view_log2_diffuse(view).unwrap()).exp2();
        let got =
            oracle::color(diffuse, material.view_diffuse_color_differences(view).unwrap().map(f64::from));
        for c in 0..3 {
            close(got[c], power(head(view, 1 + c)), got.max_element(), "diffuse term of a view");
        }
        let next = view + 1;
        for t in if next < views { &[0.0, 0.3, 0.75][..] } else { &[] } {
            let (from, to) = (f64::from(number(view)), f64::from(number(next)));
            let wo = wo((from * (1.0 - t) + to * t).min(1.57) as f32, 0.8);
            let m = prepare(&material, wo);
            // Where that lies once it has been rounded.
            let theta = f64::from(wo.x).hypot(f64::from(wo.y)).atan2(f64::from(wo.z));
            let t = ((theta - from) / (to - from)).clamp(0.0, 1.0);
            let blend = |a: f64, b: f64| a * (1.0 - t) + b * t;
            for c in 0..3 {
                let want = power(blend(head(view, 1 + c), head(next, 1 + c)));
                close(f64::from(m.diffuse()[c]), want, want + 1e-30, "diffuse term");
                for k in 0..lobes {
                    let want = power(blend(row(view, 2 + c, k), row(next, 2 + c, k)));
                    let amplitude = m.lobe(k).unwrap().amplitude;
                    close(f64::from(amplitude[c]), want, 10.0 * want + 1e-30, "amplitude");
                }
            }
        }
    }
}

#[test]
fn samples_of_every_preset_follow_the_density() {
    let presets = presets();
    let angles = [0f32, 30.0, 60.0, 85.0];
    let level = sidak(0.01, presets.len() * angles.len());
    for (name, bytes) in &presets {
        let material = Material::from_bytes(bytes).unwrap();
        for (i, degrees) in angles.into_iter().enumerate() {
            let wo = wo(degrees.to_radians(), 1.0 + i as f32);
            let m = prepare(&material, wo);
            let partition = Partition::new(&m, |d| m.pdf(d));
            let mut random = Random(41 + i as u64);
            let result = partition.test(200_000, || {
                loop {
                    if let Some(sample) = m.sample(random.three()) {
                        return sample.direction;
                    }
                }
            });
            println!(
                "{name} at {degrees} degrees: p = {:.3}, {} bins, integral of the density {:.6}",
                result.p,
                partition.len(),
                partition.total()
            );
            assert!((partition.total() - 1.0).abs() < 2e-5, "{name} at {degrees}: {}", partition.total());
            assert!(result.p > level, "{name} at {degrees} degrees: p = {:e}, level {level:e}", result.p);
        }
    }
}

#[test]
fn value_and_density_are_continuous_in_the_outgoing_direction() {
    for (name, bytes) in presets() {
        let material = Material::from_bytes(&bytes).unwrap();
        let mut random = Random(42);
        // Where formulas change: the normal, the stored views, the last stored view, grazing; and anywhere.
        let mut thetas: Vec<f32> =
            (0..material.view_count()).map(|v| material.view_theta(v).unwrap()).collect();
        thetas.extend([0.0, 1e-4, 1.55]);
        thetas.extend((0..20).map(|_| random.between(0.0, 1.57)));
        for theta in thetas {
            // Not below the horizon, where the mixture is empty.
            let theta = theta.min(1.57);
            let phi = random.between(0.0, std::f32::consts::TAU);
            let here = prepare(&material, wo(theta, phi));
            let mut directions: Vec<Vec3> =
                (0..40).map(|_| random.direction()).map(|d| d.with_z(d.z.abs())).collect();
            directions.extend((0..80).filter_map(|_| here.sample(random.three())).map(|s| s.direction));
            let largest = directions.iter().map(|&d| here.pdf(d)).fold(0.0, f32::max);
            let step = |m: &Mixture<64>| {
                directions.iter().map(|&d| (m.pdf(d) - here.pdf(d)).abs() / largest).fold(0.0, f32::max)
            };
            let value_step = |m: &Mixture<64>| {
                let peak = directions.iter().map(|&d| here.evaluate(d).max_element()).fold(0.0, f32::max);
                directions
                    .iter()
                    .map(|&d| (m.evaluate(d) - here.evaluate(d)).abs().max_element() / peak)
                    .fold(0.0, f32::max)
            };
            // At the normal the azimuth of wo must not matter; elsewhere a small turn and tilt change little.
            for around in [1e-4, 1.0, 3.0] {
                for tilt in [1e-4f32, 1e-5, 1e-6] {
                    let turn = if theta == 0.0 { around } else { tilt * around };
                    let m = prepare(&material, wo((theta + tilt).min(1.5705), phi + turn));
                    // Lipschitz: a tilt of 1 % of the width of the sharpest lobe moves 1 % of its slope.
                    let sharpest =
                        (0..m.len()).map(|k| m.lobe(k).unwrap().gaussian.sharpness).fold(1.0, f32::max);
                    let moved = tilt + if theta == 0.0 { 0.0 } else { turn };
                    let allowed = 6.0 * moved * sharpest.sqrt() / m.squeeze().min(1.0) + 1e-4;
                    let (pdf, value) = (step(&m), value_step(&m));
                    assert!(
                        pdf < allowed && value < allowed,
                        "{name}, theta {theta}, tilt {tilt}, turn {turn}: pdf {pdf:e}, value {value:e}, allowed {allowed:e}"
                    );
                }
            }
        }
    }
}

#[test]
fn damaged_bytes_are_refused_or_valid_and_never_panic() {
    for (name, bytes) in presets() {
        assert!(Material::from_bytes(&bytes).is_ok(), "{name} itself");
        for length in 0..bytes.len() {
            assert!(Material::from_bytes(&bytes[..length]).is_err(), "{name} cut at {length}");
        }
        let mut damaged = bytes.clone();
        for at in 0..bytes.len() {
            // Every single bit, and all of them.
            for flip in [1, 2, 4, 8, 16, 32, 64, 128, 255] {
                damaged[at] ^= flip;
                assert!(
                    Material::from_bytes(&damaged).is_err(),
                    "{name}: flipped {flip} at {at} passes the checksum"
                );
                damaged[at] ^= flip;
            }
        }
    }
}

#[test]
fn damaged_bytes_with_a_right_checksum_are_refused_or_usable() {
    // The same flips behind a checksum that fits: what validates must prepare, evaluate and sample without a NaN.
    let (name, bytes) = presets().remove(0);
    let (mut refused, mut valid) = (0, 0);
    let mut damaged = bytes.clone();
    let end = bytes.len() - 4;
    for at in 0..end {
        for flip in [1u8, 0x10, 0x40, 0x80, 0xff] {
            damaged[at] ^= flip;
            let sum = crc32fast::hash(&damaged[..end]);
            damaged[end..].copy_from_slice(&sum.to_le_bytes());
            match Material::from_bytes(&damaged) {
                Err(_) => refused += 1,
                Ok(material) => {
                    valid += 1;
                    for theta in [0.0, 0.7, 1.5] {
                        let m = prepare(&material, wo(theta, 1.0));
                        let value = m.evaluate(Vec3::new(0.6, 0.0, 0.8));
                        assert!(!value.is_nan() && !m.pdf(Vec3::Z).is_nan(), "{name}: {flip} at {at}");
                        if let Some(s) = m.sample([0.3, 0.6, 0.9]) {
                            assert!(!s.direction.is_nan() && s.pdf > 0.0, "{name}: {flip} at {at}");
                        }
                    }
                }
            }
            damaged[at] ^= flip;
        }
    }
    println!("{name}: {refused} refused, {valid} valid");
    assert!(refused > 0 && valid > 0);
}
