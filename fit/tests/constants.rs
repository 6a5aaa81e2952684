//! BRDFs that are one number everywhere, of any size: each gives a sound material, or is refused as a table.

use srbf_core::{MAX_LOBES, Material, Mixture, Vec3};
use srbf_fit::read::Content;
use srbf_fit::table::{Brdf, Scattered, Symmetry, Table};
use srbf_fit::{FactorNodes, Fit, FitError, Settings, fit, fit_content};

/// Where a fit can begin and end, 1/sr: below, nothing can be stored; beyond, nothing is a surface.
const STORABLE: std::ops::RangeInclusive<f64> = 1e-15..=1e30;

/// Numbers of every decade at the ends, where a step of the arithmetic overflows or is lost, and some between.
const SIZES: [f64; 20] = [
    f64::MIN_POSITIVE / 4.0,
    1e-308,
    1e-300,
    1e-155,
    1e-30,
    0.99e-15,
    1.01e-15,
    1e-9,
    1e-2,
    0.3,
    1.0,
    1e12,
    1e14,
    1e15,
    1e20,
    0.99e30,
    1.01e30,
    1e100,
    1e300,
    f64::MAX,
];

struct Constant {
    f: [f64; 3],
    symmetry: Symmetry,
}

impl Brdf for Constant {
    fn evaluate(&self, _: [f64; 3], _: [f64; 3]) -> [f64; 3] {
        self.f
    }
    fn symmetry(&self) -> Symmetry {
        self.symmetry
    }
}

fn settings(lobes: usize) -> Settings {
    Settings {
        lobes,
        starts: 2,
        steps: 12,
        exchanges: 0,
        views: Some(3),
        factors: FactorNodes::None,
        ..Settings::default()
    }
}

/// The same for a surface of a symmetry: an anisotropic one has no exchanges and places its own views.
fn settings_for(symmetry: Symmetry, isotropic: Settings) -> Settings {
    let Settings { exchanges, views, .. } = Settings::default();
    if symmetry == Symmetry::Isotropic { isotropic } else { Settings { exchanges, views, ..isotropic } }
}

/// Fits of storable tables: finite at every angle, and no brighter than a surface is.
fn check(found: Result<Fit, FitError>, f: [f64; 3], what: &str) {
    let largest = f.into_iter().fold(0.0, f64::max);
    let fit = match found {
        Err(FitError::Table(_)) if !STORABLE.contains(&largest) => return,
        Err(error) => panic!("{what} {f:?}: {error}"),
        Ok(_) if !STORABLE.contains(&largest) => panic!("{what} {f:?}: it was fitted"),
        Ok(fit) => fit,
    };
    let material = Material::from_bytes(&fit.bytes).unwrap();
    let mut mixture = Mixture::<MAX_LOBES>::empty();
    for degrees in 0..=90 {
        let (sin, cos) = (degrees as f32).to_radians().sin_cos();
        material.prepare(Vec3::new(-sin, 0.0, cos.max(0.0)), &mut mixture).unwrap();
        let albedo = mixture.albedo();
        assert!(albedo.is_finite() && albedo.max_element() <= 1.0, "{what} {f:?} at {degrees}: {albedo}");
    }
    // Values of a real surface are met; brighter ones are held to its limit.
    let error = fit.report.mean_error();
    let most = if largest < 0.95 / std::f64::consts::PI { 0.02 } else { 1.001 };
    assert!(error < most, "{what} {f:?}: {error}");
}

#[test]
fn any_constant_of_a_function_is_fitted_or_refused() {
    for size in SIZES {
        for symmetry in [Symmetry::Isotropic, Symmetry::Quadrant] {
            let constant = Constant { f: [size; 3], symmetry };
            let f = constant.f;
            let settings = settings_for(symmetry, settings(3));
            let found = fit_content(&Content::Evaluable(Box::new(constant)), &settings, |_| {});
            check(found, f, &format!("{symmetry:?}"));
        }
    }
}

#[test]
fn any_constant_of_samples_is_fitted_or_refused() {
    for size in SIZES {
        let direction = |i: i32| {
            let (theta, phi) = (0.05 + 0.17 * f64::from(i / 10), 0.35 * f64::from(i % 10));
            [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]
        };
        let view = |theta| (theta, (0..90).map(|i| (direction(i), [size; 3])).collect());
        let views: Vec<(f64, Scattered)> = [0.2, 0.6, 1.0].map(view).into();
        let found = Table::from_scattered(views).and_then(|table| fit(&table, &settings(3), |_| {}));
        check(found, [size; 3], "samples");
    }
}

/// As a caller has it who sets nothing: lobes that are kept wide, mirrored ones, factors.
#[test]
fn constants_beyond_any_surface_are_held_to_what_one_reflects() {
    for (size, symmetry) in [(1e15, Symmetry::Isotropic), (1e20, Symmetry::Isotropic), (1e16, Symmetry::None)]
    {
        let few = Settings { starts: 2, exchanges: 1, steps: 12, ..Settings::default() };
        let settings = settings_for(symmetry, few);
        let constant = Constant { f: [size, 0.1 * size, 0.5 * size], symmetry };
        let f = constant.f;
        check(fit_content(&Content::Evaluable(Box::new(constant)), &settings, |_| {}), f, "12 lobes");
    }
}

/// A number whose square is none, beside one that a surface has: no sum of squares can be fitted.
#[test]
fn huge_negative_values_are_refused() {
    let constant = Constant { f: [0.2, -1e200, 0.2], symmetry: Symmetry::Isotropic };
    let found = fit_content(&Content::Evaluable(Box::new(constant)), &settings(3), |_| {});
    assert!(matches!(&found, Err(FitError::Table(text)) if text.contains("e200 / sr; at most")), "{found:?}");
}
