//! The materials of the thesis's Table 5.1, from the measurements: `cargo test -p srbf-fit -- --ignored`.

use srbf_core::{MAX_LOBES, Material, Mixture, Vec3};
use srbf_fit::complete::complete;
use srbf_fit::table::Brdf;
use srbf_fit::{FactorNodes, Fit, Settings, fit};
use std::f64::consts::PI;
use std::path::PathBuf;
use std::sync::LazyLock;

fn data(file: &str) -> PathBuf {
    let folder = std::env::var_os("SRBF_DATA_DIR").expect("SRBF_DATA_DIR names the data folder");
    PathBuf::from(folder).join(file)
}

const NAMES: [&str; 3] = ["garnet_red", "krylon_blue", "cayman"];

/// The fits with the default settings, each made once for all tests.
static FITS: [LazyLock<Fit>; 3] = [
    LazyLock::new(|| fitted_with(NAMES[0], Settings::default())),
    LazyLock::new(|| fitted_with(NAMES[1], Settings::default())),
    LazyLock::new(|| fitted_with(NAMES[2], Settings::default())),
];

fn fitted(name: &str) -> &'static Fit {
    &FITS[NAMES.iter().position(|n| *n == name).expect("one of the three")]
}

fn fitted_with(name: &str, settings: Settings) -> Fit {
    let source = srbf_fit::read::read(&data(&format!("cornell/{name}.brdf"))).unwrap();
    let srbf_fit::read::Content::Samples(table) = source.content else { panic!("{name} is scattered") };
    fit(&table, &settings, |_| {}).unwrap()
}

fn prepared(material: &Material<Vec<u8>>, degrees: f32, azimuth: f32) -> Mixture<'_, MAX_LOBES> {
    let mut mixture = Mixture::empty();
    let (sin, cos) = degrees.to_radians().sin_cos();
    let wo = Vec3::new(-sin * azimuth.cos(), -sin * azimuth.sin(), cos);
    material.prepare(wo, &mut mixture).unwrap();
    mixture
}

/// Mean relative L2 error over the views, within a tenth of the figures in docs/figures.md: worse fails, and so does better, as
/// then the statement is stale. Albedo at most 1 everywhere; energy near the data's.
#[test]
#[ignore = "needs SRBF_DATA_DIR"]
fn materials_of_table_5_1() {
    let stated = [("garnet_red", 0.0104), ("krylon_blue", 0.0179), ("cayman", 0.0110)];
    let fits = stated.map(|(name, _)| fitted(name));
    for ((name, _), fit) in stated.iter().zip(&fits) {
        println!("{name}: {:.2} %", 100.0 * fit.report.mean_error());
    }
    for ((name, stated), Fit { bytes, report, .. }) in stated.into_iter().zip(fits) {
        let error = report.mean_error();
        assert!((error / stated - 1.0).abs() < 0.1, "{name}: {error}, stated {stated}");
        assert!(bytes.len() <= 8500, "{name}: {} bytes", bytes.len());
        for view in &report.views {
            for c in 0..3 {
                let difference = (view.albedo[c] - view.data_albedo[c]).abs();
                assert!(difference <= 0.01 + 0.03 * view.data_albedo[c], "{name}: {view:?}");
            }
        }
        let material = Material::from_bytes(bytes.clone()).unwrap();
        for tenth in 0..=900 {
            let albedo = prepared(&material, tenth as f32 / 10.0, 0.0).albedo();
            assert!(albedo.max_element() <= 1.0, "{name} at {} degrees: {albedo}", tenth as f32 / 10.0);
        }
    }
}

/// A step of a hundredth of a degree changes the value by little, at the normal too, where the azimuth turns.
#[test]
#[ignore = "needs SRBF_DATA_DIR"]
fn values_are_continuous_in_the_outgoing_direction() {
    for name in NAMES {
        let material = Material::from_bytes(fitted(name).bytes.clone()).unwrap();
        let direction = Vec3::new(0.3, 0.2, 1.0).normalize();
        for tenth in 0..900 {
            let degrees = tenth as f32 / 10.0;
            let (a, b) = (prepared(&material, degrees, 0.4), prepared(&material, degrees + 0.01, 0.4));
            let (a, b) = (a.evaluate(direction), b.evaluate(direction));
            assert!(
                (a - b).abs().max_element() <= 0.02 * a.max_element() + 1e-6,
                "{name} at {degrees}: {a} {b}"
            );
        }
        let values: Vec<Vec3> =
            (0..8).map(|i| prepared(&material, 0.0, i as f32).evaluate(direction)).collect();
        assert!(values.iter().all(|v| *v == values[0]), "{name}: {values:?}");
    }
}

/// A committed preset follows from its measurement, so the same input gives the same bytes, whatever the threads do. All of them:
/// `cargo lab presets --check`.
#[test]
#[ignore = "needs SRBF_DATA_DIR"]
fn a_preset_is_the_fit_of_its_measurement() {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../presets/garnet_red.srbf");
    let preset = std::fs::read(&path).unwrap();
    let settings = Settings { factors: FactorNodes::None, ..Settings::default() };
    let (preset, again) = (Material::from_bytes(&preset).unwrap(), fitted_with("garnet_red", settings).bytes);
    let again = Material::from_bytes(&again).unwrap();
    assert_eq!((preset.view_count(), preset.lobe_count()), (again.view_count(), again.lobe_count()));
    for view in 0..preset.view_count() {
        for lobe in 0..preset.view_lobe_count() {
            assert_eq!(preset.view_lobe(view, lobe), again.view_lobe(view, lobe), "{view} {lobe}");
        }
    }
}

/// Between the views of the samples the value at a fixed half angle has no wiggles that the completion lacks: the logarithm of their
/// ratio, over 6 degrees on each side, stays at its mean. In the plane of incidence, the half angle towards the normal.
#[test]
#[ignore = "needs SRBF_DATA_DIR"]
fn there_are_no_rings_between_the_views() {
    // Cayman's worst is 2 degrees beside its clear coat, whose flank is steep: 0.55. Garnet red's is at 25 degrees: 0.154.
    for (name, most) in [("garnet_red", 0.16), ("krylon_blue", 0.15), ("cayman", 0.6)] {
        let source = srbf_fit::read::read(&data(&format!("cornell/{name}.brdf"))).unwrap();
        let srbf_fit::read::Content::Samples(table) = source.content else { panic!("{name} is scattered") };
        let completion = complete(&table).unwrap();
        let material = Material::from_bytes(fitted(name).bytes.clone()).unwrap();
        let level: f64 = table.views.iter().map(|v| luminance(v.uncut_albedo)).sum::<f64>() / 8.0 / PI;
        let mut wiggles = Vec::new();
        for half in [0.0f64, 2.0, 4.0, 7.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0] {
            let ratio = |degrees: f64| {
                let theta = degrees.to_radians();
                let angle = theta - 2.0 * half.to_radians();
                let wi = [angle.sin(), 0.0, angle.cos()];
                let wo = [-theta.sin(), 0.0, theta.cos()];
                let mixture = prepared(&material, degrees as f32, 0.0);
                let value = mixture.evaluate(Vec3::from(wi.map(|v| v as f32))).to_array().map(f64::from);
                let fitted = luminance(value) / wi[2];
                ((fitted.max(0.0) + 0.02 * level)
                    / (luminance(completion.evaluate(wi, wo)).max(0.0) + 0.02 * level))
                    .ln()
            };
            let ratios: Vec<f64> = (10..=80).map(|d| ratio(f64::from(d))).collect();
            let wiggle = |at: usize| {
                let around = &ratios[at - 6..=at + 6];
                (ratios[at] - around.iter().sum::<f64>() / around.len() as f64).abs()
            };
            wiggles.push((6..ratios.len() - 6).map(wiggle).fold(0.0, f64::max));
        }
        let worst = wiggles.iter().copied().fold(0.0, f64::max);
        println!("{name}: {worst:.3}, by half angle {wiggles:.3?}");
        assert!(worst <= most, "{name}: {wiggles:?}");
    }
}

fn luminance(rgb: [f64; 3]) -> f64 {
    0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]
}
