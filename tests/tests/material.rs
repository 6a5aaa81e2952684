//! Materials: what was written is what is read, and views in between are interpolated as the design says.

use glam::Vec3;
use srbf_core::{Material, Mixture, PlaneLobe, View, encode, encoded_len};
use srbf_tests::inputs::Random;

#[test]
fn what_was_written_is_read_and_interpolated() {
    let mut random = Random(51);
    let lobes: Vec<Vec<PlaneLobe>> = (0..4)
        .map(|view| {
            (0..5)
                .map(|_| PlaneLobe {
                    angle: if view == 0 { 0.0 } else { random.between(-1.0, 1.5) },
                    log2_sharpness: random.between(-3.0, 20.0),
                    log2_amplitude: [random.between(-5.0, 5.0), random.between(-5.0, 5.0), 0.5],
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
            log2_diffuse: [-2.0 - v as f32, -3.0, -1.0 - 0.5 * v as f32],
            lobes,
        })
        .collect();
    let text = "test, made by tests/material.rs";
    let mut bytes = vec![0; encoded_len(4, 5, text)];
    assert_eq!(encode(&views, 2, text, &mut bytes).unwrap(), bytes.len());
    let material = Material::from_bytes(&bytes).unwrap();
    assert_eq!(material.bytes(), bytes);
    assert_eq!((material.view_count(), material.lobe_count(), material.squeezed_count()), (4, 5, 2));
    assert_eq!(material.provenance(), text);
    for (v, view) in views.iter().enumerate() {
        assert_eq!(material.view_theta(v), Some(view.theta));
        assert_eq!(material.view_log2_squeeze(v), Some(view.log2_squeeze));
        assert_eq!(material.view_log2_diffuse(v), Some(view.log2_diffuse));
        for (k, lobe) in view.lobes.iter().enumerate() {
            assert_eq!(material.view_lobe(v, k), Some(*lobe));
        }
        assert_eq!(material.view_lobe(v, 5), None);
    }
    assert_eq!((material.view_theta(4), material.view_log2_squeeze(4)), (None, None));
    assert_eq!((material.view_lobe(4, 0), material.view_log2_diffuse(4)), (None, None));

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
        for c in 0..3 {
            close(m.diffuse()[c], blend(&|v| v.log2_diffuse[c]).exp2(), "diffuse");
        }
        for k in 0..5 {
            let lobe = m.lobe(k).unwrap();
            close(lobe.gaussian.sharpness, blend(&|v| v.lobes[k].log2_sharpness).exp2(), "sharpness");
            for c in 0..3 {
                close(lobe.amplitude[c], blend(&|v| v.lobes[k].log2_amplitude[c]).exp2(), "amplitude");
            }
            let angle = blend(&|v| v.lobes[k].angle);
            let want = glam::DVec3::new(angle.sin(), 0.0, angle.cos().abs());
            assert!((lobe.gaussian.axis.as_dvec3() - want).length() < 1e-6, "axis at {theta}");
        }
    }
}
