//! The BxDF for pbrt-v4, compiled beside a stand-in for pbrt's header, and compared with the library.

use crate::driver::{compiler, root};
use crate::values::{AT_DRAW, Random, VALUE, brushed, spectral};
use glam::Vec3;
use srbf_core::{MAX_LOBES, Material, Mixture};
use srbf_evaluator::Language;
use std::io::Write;
use std::path::Path;
use std::process::Stdio;

const N: usize = 2000;

/// Numbers that the program reads and writes of each pair.
const NUMBERS: usize = 13;

fn largest(values: &[f32]) -> f32 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}

#[test]
fn the_bxdf_of_pbrt_has_the_values_of_the_library() {
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join("pbrt");
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pbrt");
    let mut compiler = compiler(Language::Cpp);
    compiler.args(["-O2", "-I"]).arg(root().join("include")).arg("-I").arg(&here).arg("-o").arg(&program);
    assert!(compiler.arg(here.join("values.cpp")).status().expect("g++ is installed").success());
    let preset = std::fs::read(root().join("presets/krylon_blue.srbf")).expect("a preset");
    for bytes in [preset, spectral(false), spectral(true), brushed()] {
        let material = Material::from_bytes(&bytes[..]).expect("a material");
        let mut random = Random(88_172_645_463_325_252);
        let given: Vec<[f32; NUMBERS]> = (0..N)
            .map(|_| {
                let nm = [0.0, 0.25, 0.5, 0.75].map(|at| 380.0 + 400.0 * (at + 0.25 * random.next()));
                let ([a, b, c], [x, y, z]) = (random.direction(), random.direction());
                // One in four is seen from below.
                let side = if random.next() < 0.25 { -1.0 } else { 1.0 };
                let u = [(); 3].map(|()| random.next());
                [nm[0], nm[1], nm[2], nm[3], a, b, side * c, x, y, side * z, u[0], u[1], u[2]]
            })
            .collect();
        let mut child = std::process::Command::new(&program)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the program runs");
        let mut sent = (bytes.len() as u32).to_le_bytes().to_vec();
        sent.extend(&bytes);
        sent.extend((N as u32).to_le_bytes());
        sent.extend(given.iter().flatten().flat_map(|v| v.to_le_bytes()));
        // The answers are as many: another thread takes the questions away.
        let mut stdin = child.stdin.take().expect("a pipe");
        let sender = std::thread::spawn(move || stdin.write_all(&sent));
        let output = child.wait_with_output().expect("it ends");
        sender.join().expect("no panic").expect("all is read");
        assert!(output.status.success());
        let found: Vec<f32> = output.stdout.as_chunks().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
        assert_eq!(found.len(), N * NUMBERS);

        let (mut worst, mut elsewhere) = ([0f32; 4], 0);
        let mut mixture = Mixture::<MAX_LOBES>::empty();
        for (given, found) in given.iter().zip(found.chunks(NUMBERS)) {
            let [wo, wi] = [4, 7].map(|at| Vec3::new(given[at], given[at + 1], given[at + 2].abs()));
            let primaries = material.primaries(&[given[0], given[1], given[2], given[3]]);
            material.prepare(wo, &mut mixture).expect("a direction");
            let (value, pdf) = mixture.evaluate_and_pdf(wi);
            let expected = primaries.of(value / wi.z);
            let apart =
                |found: &[f32], expected: &[f32; 4]| largest(&[0, 1, 2, 3].map(|k| found[k] - expected[k]));
            // A value is as exact as its colour, which it may be a small difference of.
            let size = largest(&value.to_array()).max(pdf * mixture.power()) / wi.z;
            worst[0] = worst[0].max(apart(&found[..4], &expected) / size);
            worst[1] = worst[1].max((found[4] - pdf).abs() / pdf);
            let Some(drawn) = mixture.sample([given[10], given[11], given[12]]) else { continue };
            let side = given[6].signum();
            let at = Vec3::new(found[5], found[6], side * found[7]);
            if (at - drawn.direction).abs().max_element() > 1e-4 {
                elsewhere += 1;
                continue;
            }
            let f = drawn.weight * drawn.pdf / drawn.direction.z;
            let size = largest(&f.to_array()).max(drawn.pdf * mixture.power() / drawn.direction.z);
            worst[2] = worst[2].max(apart(&found[8..12], &primaries.of(f)) / size);
            worst[3] = worst[3].max((found[12] - drawn.pdf).abs() / drawn.pdf);
        }
        println!("value, density, value and density at a draw: {worst:?}, other lobe {elsewhere}");
        // Columns are up to three, by which errors of three channels add up.
        assert!(worst[0] < 4.0 * VALUE && worst[1] < VALUE, "{worst:?}");
        assert!(worst[2] < 4.0 * AT_DRAW && worst[3] < AT_DRAW && elsewhere <= 2, "{worst:?} {elsewhere}");
    }
}
