//! Albedos of materials with factors, which have no closed form: those of a mixture against the mean over its own samples.

use srbf_core::{Level, MAX_LOBES, Material, Mixture, Vec3, luminance};
use srbf_fit::read::Content;
use srbf_fit::table::Brdf;
use srbf_fit::{FactorNodes, Settings, fit_content};
use std::path::{Path, PathBuf};

/// Samples of which the mean is the albedo to about a thousandth.
const DRAWN: u32 = 30_000;

/// Places between two views.
const BETWEEN: usize = 8;

/// The mean of `f cos / pdf` over directions that the lobes draw, evenly spread.
fn drawn(mixture: &Mixture<MAX_LOBES>) -> Vec3 {
    let sample = |i| {
        let n = f64::from(i);
        // The R2 sequence (Roberts 2018) beside even steps.
        let u = [(n + 0.5) / f64::from(DRAWN), 0.754_877_666_246_693 * n, 0.569_840_290_998_053 * n];
        mixture.sample(u.map(|u| u.fract() as f32)).map_or(Vec3::ZERO, |s| s.weight)
    };
    let mut sum = [0.0; 3];
    for weight in (0..DRAWN).map(sample) {
        (0..3).for_each(|c| sum[c] += f64::from(weight[c]) / f64::from(DRAWN));
    }
    Vec3::from(sum.map(|v| v as f32))
}

/// Mean and largest error of the albedo at the views and between them, to 89 degrees, over the channels, in percent of the luminance.
fn errors(bytes: &[u8]) -> [f32; 2] {
    let material = Material::from_bytes(bytes).unwrap();
    assert!(material.factor_nodes().is_some());
    let thetas: Vec<f32> = (0..material.view_count()).map(|v| material.view_theta(v).unwrap()).collect();
    let between = |i| i as f32 / BETWEEN as f32;
    let places = thetas.windows(2).flat_map(|t| (0..BETWEEN).map(|i| t[0] + between(i) * (t[1] - t[0])));
    let error = |theta: f32| {
        let mut mixture = Mixture::empty();
        let wo = Vec3::new(-theta.sin(), 0.0, theta.cos());
        material.prepare_with(wo, Level::Scalar.into(), &mut mixture).unwrap();
        let want = drawn(&mixture);
        100.0 * (mixture.albedo() - want).abs().max_element() / luminance(want)
    };
    let errors: Vec<f32> = places.filter(|theta| *theta < 89f32.to_radians()).map(error).collect();
    let worst = errors.iter().copied().fold(0.0, f32::max);
    [errors.iter().sum::<f32>() / errors.len() as f32, worst]
}

/// A flake paint: over a grey base a ring of colours round a highlight.
struct Ring;

impl Brdf for Ring {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let sum = [0, 1, 2].map(|k| wi[k] + wo[k]);
        let half = sum[2] / sum.iter().map(|v| v * v).sum::<f64>().sqrt();
        let angle = half.min(1.0).acos();
        let highlight = 2.0 * (400.0 * (half - 1.0)).exp();
        [0.30, 0.38, 0.46].map(|at: f64| 0.05 + highlight + 0.15 * (-(angle - at).powi(2) / 0.004).exp())
    }
}

fn check(name: &str, content: &Content, settings: &Settings, [mean, worst]: [f32; 2]) {
    let found = errors(&fit_content(content, settings, |_| {}).unwrap().bytes);
    println!("{name}: mean {:.2} %, worst {:.2} %", found[0], found[1]);
    assert!(found[0] < mean && found[1] < worst, "{name}: {found:?}, at most {mean}, {worst}");
}

#[test]
fn stored_albedos_hold_at_the_views_and_between_them() {
    let settings = Settings { lobes: 6, views: Some(8), starts: 4, exchanges: 6, ..Settings::default() };
    for (name, factors, bounds) in [
        ("ring, 24x6x3", FactorNodes::Given([24, 6, 3]), [0.4, 1.1]),
        ("ring, 24x6x5s", FactorNodes::Signed([24, 6, 5]), [0.45, 1.2]),
    ] {
        let settings = Settings { factors, ..settings.clone() };
        check(name, &Content::Evaluable(Box::new(Ring)), &settings, bounds);
    }
}

#[test]
#[ignore = "needs SRBF_DATA_DIR"]
fn stored_albedos_of_measured_materials_hold() {
    let folder =
        PathBuf::from(std::env::var_os("SRBF_DATA_DIR").expect("SRBF_DATA_DIR names the data folder"));
    let bounds = [
        ("vch_golden_yellow", [0.09, 0.3]),
        // At 62 degrees, where the true albedo bends between views, and no bytes are left for one more.
        ("cc_green_malachite", [0.65, 2.1]),
        ("irid_flake_paint1", [0.25, 0.8]),
    ];
    for (name, bounds) in bounds {
        let file = folder.join("rgl").join(format!("{name}_rgb.bsdf"));
        let content = srbf_fit::read::read(Path::new(&file)).unwrap().content;
        check(name, &content, &Settings::default(), bounds);
    }
}
