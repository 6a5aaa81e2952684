//! The materials of the thesis's Table 5.1, from the measurements: `cargo test -p srbf-fit -- --ignored`.

use srbf_core::{MAX_LOBES, Material, Mixture, Vec3};
use srbf_fit::{Fit, Settings, fit, table};
use std::path::PathBuf;

fn data(file: &str) -> PathBuf {
    let folder = std::env::var_os("SRBF_DATA_DIR").expect("SRBF_DATA_DIR names the data folder");
    PathBuf::from(folder).join(file)
}

fn fitted(name: &str) -> Fit {
    let source = table::read(&data(&format!("cornell/{name}.brdf"))).unwrap();
    let table::Content::Samples(table) = source.content else { panic!("{name} is scattered") };
    fit(&table, &Settings::default(), |_| {}).unwrap()
}

fn prepared(bytes: &[u8], degrees: f32, azimuth: f32) -> Mixture<'_, MAX_LOBES> {
    let mut mixture = Mixture::empty();
    let (sin, cos) = degrees.to_radians().sin_cos();
    let wo = Vec3::new(-sin * azimuth.cos(), -sin * azimuth.sin(), cos);
    Material::from_bytes(bytes).unwrap().prepare(wo, &mut mixture).unwrap();
    mixture
}

/// Mean relative L2 error over the views, the thesis's own figures; albedo at most 1 everywhere; energy near the data's.
#[test]
#[ignore = "needs SRBF_DATA_DIR"]
fn materials_of_table_5_1() {
    for (name, limit) in [("garnet_red", 0.04), ("krylon_blue", 0.059), ("cayman", 0.059)] {
        let Fit { bytes, report } = fitted(name);
        assert!(report.mean_error() <= limit, "{name}: {} > {limit}", report.mean_error());
        assert!(bytes.len() <= 6000, "{name}: {} bytes", bytes.len());
        for view in &report.views {
            for c in 0..3 {
                let difference = (view.albedo[c] - view.data_albedo[c]).abs();
                assert!(difference <= 0.01 + 0.03 * view.data_albedo[c], "{name}: {view:?}");
            }
        }
        for tenth in 0..=900 {
            let albedo = prepared(&bytes, tenth as f32 / 10.0, 0.0).albedo();
            assert!(albedo.max_element() <= 1.0, "{name} at {} degrees: {albedo}", tenth as f32 / 10.0);
        }
    }
}

/// A step of a hundredth of a degree changes the value by little, at the normal too, where the azimuth turns.
#[test]
#[ignore = "needs SRBF_DATA_DIR"]
fn values_are_continuous_in_the_outgoing_direction() {
    for name in ["garnet_red", "krylon_blue", "cayman"] {
        let bytes = fitted(name).bytes;
        let direction = Vec3::new(0.3, 0.2, 1.0).normalize();
        for tenth in 0..900 {
            let degrees = tenth as f32 / 10.0;
            let (a, b) = (prepared(&bytes, degrees, 0.4), prepared(&bytes, degrees + 0.01, 0.4));
            let (a, b) = (a.evaluate(direction), b.evaluate(direction));
            assert!(
                (a - b).abs().max_element() <= 0.02 * a.max_element() + 1e-6,
                "{name} at {degrees}: {a} {b}"
            );
        }
        let values: Vec<Vec3> = (0..8).map(|i| prepared(&bytes, 0.0, i as f32).evaluate(direction)).collect();
        assert!(values.iter().all(|v| *v == values[0]), "{name}: {values:?}");
    }
}

/// The same input gives the same bytes, whatever the threads do.
#[test]
#[ignore = "needs SRBF_DATA_DIR"]
fn fits_repeat() {
    assert_eq!(fitted("cayman").bytes, fitted("cayman").bytes);
}

/// The committed presets are what the measurements give; `srbf presets` makes them.
#[test]
#[ignore = "needs SRBF_DATA_DIR"]
fn presets_are_fits_of_the_measurements() {
    for name in ["garnet_red", "krylon_blue", "cayman"] {
        let path =
            PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../presets").join(name).with_extension("srbf");
        let preset = std::fs::read(&path).unwrap();
        let (preset, again) = (Material::from_bytes(&preset).unwrap(), fitted(name).bytes);
        let again = Material::from_bytes(&again).unwrap();
        assert_eq!((preset.view_count(), preset.lobe_count()), (again.view_count(), again.lobe_count()));
        for view in 0..preset.view_count() {
            for lobe in 0..preset.view_lobe_count() {
                assert_eq!(preset.view_lobe(view, lobe), again.view_lobe(view, lobe), "{name} {view} {lobe}");
            }
        }
    }
}
