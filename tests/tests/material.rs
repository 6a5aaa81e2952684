//! Materials: written numbers are read again, and views in between are interpolated as the design says.

use glam::Vec3;
use srbf_core::{Draws, Level, Line, Material, Mixture, PlaneLobe, Towards, View, encoded_len};
use srbf_tests::inputs::{Random, levels};
use srbf_tests::oracle;
use std::process::Command;

#[test]
fn what_was_written_is_read_and_interpolated() {
    let mut random = Random(51);
    // The last of the five stands for two.
    let lobes: Vec<Vec<PlaneLobe>> = (0..4)
        .map(|view| {
            (0..5)
                .map(|k| PlaneLobe {
                    angle: if view == 0 { 0.0 } else { random.between(-1.0, 1.5) },
                    off_plane: if view == 0 || k < 4 { 0.0 } else { random.between(-1.4, 1.4) },
                    log2_sharpness: random.between(-3.0, 20.0),
                    log2_luminance: random.between(-5.0, 5.0),
                    color_differences: [random.between(-2.0, 4.0), random.between(-3.0, 12.0)],
                })
                .collect()
        })
        .collect();
    let views: Vec<View> = lobes
        .iter()
        .enumerate()
        .map(|(v, lobes)| View {
            theta: 0.45 * v as f32,
            log2_squeeze: -1.1 * v as f32,
            log2_diffuse: -2.0 - v as f32,
            diffuse_color_differences: [0.2 * v as f32, -1.3],
            lobes,
        })
        .collect();
    let text = "test, made by tests/material.rs";
    let line = Line { views: &views, squeezed: 2, mirrored: 1, factors: None };
    let mut bytes = vec![0; encoded_len(4, 5, 1, text)];
    assert_eq!(line.encoded_len(text), bytes.len());
    assert_eq!(line.encode(text, &mut bytes).unwrap(), bytes.len());
    let material = Material::from_bytes(&bytes).unwrap();
    assert_eq!(material.bytes(), bytes);
    assert_eq!((material.view_count(), material.lobe_count(), material.view_lobe_count()), (4, 6, 5));
    assert_eq!((material.squeezed_count(), material.mirrored_count()), (2, 1));
    assert_eq!(material.provenance(), text);
    for (v, view) in views.iter().enumerate() {
        assert_eq!(material.view_theta(v), Some(view.theta));
        assert_eq!(material.view_log2_squeeze(v), Some(view.log2_squeeze));
        assert_eq!(material.view_log2_diffuse(v), Some(view.log2_diffuse));
        assert_eq!(material.view_diffuse_color_differences(v), Some(view.diffuse_color_differences));
        for (k, lobe) in view.lobes.iter().enumerate() {
            assert_eq!(material.view_lobe(v, k), Some(*lobe));
        }
        assert_eq!(material.view_lobe(v, 5), None);
    }
    assert_eq!((material.view_theta(4), material.view_log2_squeeze(4)), (None, None));
    assert_eq!((material.view_lobe(4, 0), material.view_log2_diffuse(4)), (None, None));
    assert_eq!(material.view_diffuse_color_differences(4), None);

    for _ in 0..300 {
        let (theta, phi) = (random.between(0.0, 1.57), random.between(-3.1, 3.1));
        let wo = Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
        let mut m = Mixture::<16>::empty();
        material.prepare(wo, &mut m).unwrap();
        // In f64; beyond the last view the last one holds.
        let wo = wo.as_dvec3();
        let at = (wo.x.hypot(wo.y).atan2(wo.z) / f64::from(0.45f32)).min(3.0);
        let before = (at as usize).min(2);
        let t = at - before as f64;
        let blend = |f: &dyn Fn(&View) -> f32| {
            f64::from(f(&views[before])) * (1.0 - t) + f64::from(f(&views[before + 1])) * t
        };
        let close = |got: f32, want: f64, name: &str| {
            assert!((f64::from(got) / want - 1.0).abs() < 2e-5, "{name} at {theta}: {got}, {want}");
        };
        close(m.squeeze(), blend(&|v| v.log2_squeeze).exp2(), "squeeze");
        let differences = [0, 1].map(|i| blend(&|v| v.diffuse_color_differences[i]));
        let diffuse = oracle::color(blend(&|v| v.log2_diffuse).exp2(), differences);
        for c in 0..3 {
            close(m.diffuse()[c], diffuse[c], "diffuse");
        }
        for image in 0..6 {
            let (lobe, k) = (m.lobe(image).unwrap(), image.min(4));
            close(lobe.gaussian.sharpness, blend(&|v| v.lobes[k].log2_sharpness).exp2(), "sharpness");
            let luminance = blend(&|v| v.lobes[k].log2_luminance).exp2();
            let differences = [0, 1].map(|i| blend(&|v| v.lobes[k].color_differences[i]));
            let amplitude = oracle::color(luminance, differences);
            // A channel may pass through 0.
            assert!(
                (lobe.amplitude.as_dvec3() - amplitude).abs().max_element() < 2e-5 * luminance,
                "{theta}"
            );
            let angle = blend(&|v| v.lobes[k].angle);
            let (across, along) = blend(&|v| v.lobes[k].off_plane).sin_cos();
            let side = if image == 5 { -across } else { across };
            let want = glam::DVec3::new(angle.sin() * along, side, (angle.cos() * along).abs());
            assert!((lobe.gaussian.axis.as_dvec3() - want).length() < 1e-6, "axis at {theta}");
        }
    }
}

/// A small material, and as many outgoing directions, some below the horizon, some no direction.
fn small_material() -> Vec<u8> {
    let lobe = |angle, off_plane, log2_sharpness| PlaneLobe {
        angle,
        off_plane,
        log2_sharpness,
        log2_luminance: -0.4,
        color_differences: [0.3, 1.6],
    };
    let normal = [lobe(0.0, 0.0, 3.0), lobe(0.0, 0.0, 8.0), lobe(0.0, 0.0, 3.0)];
    let tilted = [lobe(0.4, 0.0, 2.0), lobe(1.2, 0.0, 9.0), lobe(0.9, 0.8, 4.0)];
    let view = |theta, log2_squeeze, lobes| View {
        theta,
        log2_squeeze,
        log2_diffuse: -2.0,
        diffuse_color_differences: [0.0; 2],
        lobes,
    };
    let views = [view(0.0, 0.0, &normal[..]), view(1.3, -2.0, &tilted[..])];
    let line = Line { views: &views, squeezed: 1, mirrored: 1, factors: None };
    let mut bytes = vec![0; line.encoded_len("")];
    line.encode("", &mut bytes).unwrap();
    bytes
}

#[test]
fn pairs_are_the_mixtures_one_by_one() {
    const N: usize = 61;
    let bytes = small_material();
    let material = Material::from_bytes(&bytes).unwrap();
    let mut random = Random(52);
    let mut wo: Vec<Vec3> = (0..N).map(|_| random.direction()).collect();
    wo[7] = Vec3::NAN;
    wo[8] = Vec3::ZERO;
    let wi: Vec<Vec3> = (0..N).map(|_| random.direction()).collect();
    let u: Vec<Vec3> = (0..N).map(|_| Vec3::from_array(random.three())).collect();
    let split = |v: &[Vec3]| [0, 1, 2].map(|i| v.iter().map(|d| d[i]).collect::<Vec<f32>>());
    let (wo_split, wi_split, u_split) = (split(&wo), split(&wi), split(&u));
    fn slices(v: &[Vec<f32>; 3]) -> [&[f32]; 3] {
        [&v[0], &v[1], &v[2]]
    }
    let (wo_slices, wi_slices, u_slices) = (slices(&wo_split), slices(&wi_split), slices(&u_split));

    let mut out = [(); 7].map(|()| vec![f32::NAN; N]);
    let [r, g, b, pdf, ..] = &mut out;
    material
        .ask(wo_slices, Towards { wi: wi_slices, value: Some([r, g, b]), pdf: Some(pdf) }.into())
        .unwrap();
    let evaluated = out.clone();
    let [x, y, z, pdf, wr, wg, wb] = &mut out;
    let samples = Draws { u: u_slices, direction: [x, y, z], pdf: Some(pdf), weight: Some([wr, wg, wb]) };
    material.ask(wo_slices, samples.into()).unwrap();
    let mut mixtures = vec![Mixture::<16>::empty(); N];
    material.prepare_into(wo_slices, &mut mixtures).unwrap();
    let close = |a: f32, b: f32| (a - b).abs() <= 1e-5 * b.abs() + 1e-30;
    for i in 0..N {
        let mut m = Mixture::<16>::empty();
        let known = material.prepare(wo[i], &mut m).is_ok();
        assert_eq!(known, i != 7 && i != 8);
        assert_eq!(mixtures[i].len(), m.len());
        assert!(close(mixtures[i].power(), m.power()));
        let value = m.evaluate(wi[i]);
        for c in 0..3 {
            assert!(close(evaluated[c][i], value[c]), "value {i}: {}, {}", evaluated[c][i], value[c]);
        }
        assert!(close(evaluated[3][i], m.pdf(wi[i])), "pdf {i}");
        let direction = Vec3::new(out[0][i], out[1][i], out[2][i]);
        match m.sample(u[i].to_array()) {
            Some(sample) => {
                assert!(
                    (sample.direction - direction).length() < 1e-5,
                    "{i}: {direction}, {}",
                    sample.direction
                );
                assert!((out[3][i] / sample.pdf - 1.0).abs() < 1e-3, "{i}");
                for c in 0..3 {
                    assert!((out[4 + c][i] / sample.weight[c] - 1.0).abs() < 1e-3, "{i}");
                    assert!(close(sample.weight[c], m.evaluate(sample.direction)[c] / sample.pdf), "{i}");
                }
            }
            None => assert_eq!((direction, out[3][i], out[4][i]), (Vec3::Z, 0.0, 0.0), "{i}"),
        }
    }
    let short = [&wo_slices[0][1..], wo_slices[1], wo_slices[2]];
    assert!(material.prepare_into(short, &mut mixtures).is_err());
    let [r, g, b, pdf, ..] = &mut out;
    assert!(
        material
            .ask(short, Towards { wi: wi_slices, value: Some([r, g, b]), pdf: Some(pdf) }.into())
            .is_err()
    );
}

/// In processes of their own, as a process asks for the variable once.
#[test]
fn the_variable_caps_the_level_and_a_word_that_names_none_is_refused() {
    let run = |word: &str| {
        let mut child = Command::new(std::env::current_exe().unwrap());
        child.args(["--exact", "material::levels_are_those_of_this_machine", "--nocapture"]);
        let output = child.env("SRBF_LEVEL", word).output().unwrap();
        let text = String::from_utf8([output.stdout, output.stderr].concat()).unwrap();
        (output.status.success(), text)
    };
    for level in levels() {
        let (is_ok, text) = run(level.name());
        assert!(is_ok && text.contains(&format!("the best level is {}\n", level.name())), "{text}");
    }
    for word in ["", "AVX2", "sse2"] {
        let (is_ok, text) = run(word);
        let message = format!("SRBF_LEVEL is {word:?}; it may be scalar, portable, avx2 or avx512");
        assert!(!is_ok && text.contains(&message), "{text}");
    }
}

#[test]
fn levels_are_those_of_this_machine() {
    let best = levels().last().copied().unwrap();
    assert_eq!(Mixture::<16>::empty().with_level(best).map(|m| m.level()), Ok(best));
    println!("the best level is {}", best.name());
}

#[test]
fn levels_have_names_and_a_current_one() {
    for level in Level::ALL {
        assert_eq!(Level::from_name(level.name()), Some(level));
    }
    assert_eq!(Level::from_name("none"), None);
    assert!(Level::current().is_available());
    let m = Mixture::<16>::hemisphere(&[]).unwrap().with_diffuse(Vec3::splat(0.5)).unwrap();
    assert_eq!(m.diffuse(), Vec3::splat(0.5));
    assert!(m.is_empty());
}
