//! Tables that no measurement should be, but some are: each gives a sound material, or says why not.

use srbf_core::{MAX_LOBES, Material, Mixture, Vec3};
use srbf_fit::table::{Scattered, Table};
use srbf_fit::{Settings, fit};

const FLAT: f64 = 0.2;

fn direction(theta: f64, phi: f64) -> [f64; 3] {
    [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]
}

/// A table over a grid: f of the angle of the view and the incident direction.
fn table(f: impl Fn(f64, [f64; 3]) -> f64) -> Vec<(f64, Scattered)> {
    let view = |theta: f64| {
        let grid = (0..9).flat_map(|t| (0..10).map(move |p| (t, p)));
        let sample = |(t, p): (i32, i32)| {
            let d = direction(0.05 + 0.17 * f64::from(t), 0.35 * f64::from(p));
            (d, [f(theta, d), 0.5 * f(theta, d), 0.1 * f(theta, d)])
        };
        (theta, grid.map(sample).collect())
    };
    [0.2, 0.6, 1.0, 1.3].into_iter().map(view).collect()
}

/// Fits with few steps, and checks that the material is sound at every view; returns the mean error.
fn sound(views: Vec<(f64, Scattered)>) -> Result<f64, srbf_fit::FitError> {
    let table = Table::from_scattered(views)?;
    let settings = Settings { lobes: 6, starts: 3, steps: 20, ..Settings::default() };
    let fit = fit(&table, &settings, |share| assert!((0.0..=1.0).contains(&share)))?;
    let material = Material::from_bytes(&fit.bytes).unwrap();
    let mut mixture = Mixture::<MAX_LOBES>::empty();
    for degrees in 0..=90 {
        let (sin, cos) = (degrees as f32).to_radians().sin_cos();
        material.prepare(Vec3::new(-sin, 0.0, cos.max(0.0)), &mut mixture).unwrap();
        assert!(
            mixture.albedo().is_finite() && mixture.albedo().max_element() <= 1.0,
            "{degrees}: {}",
            mixture.albedo()
        );
        for i in 0..20 {
            let d = direction(0.08 * f64::from(i), 0.7 * f64::from(i)).map(|v| v as f32);
            assert!(
                mixture.evaluate(Vec3::from(d)).is_finite()
                    && mixture.evaluate(Vec3::from(d)).min_element() >= 0.0
            );
        }
    }
    assert!(fit.report.views.iter().all(|v| v.error.is_finite()), "{:?}", fit.report);
    Ok(fit.report.mean_error())
}

fn near_mirror(theta: f64, d: [f64; 3]) -> bool {
    let mirror = direction(theta, 0.0);
    (0..3).map(|k| (d[k] - mirror[k]).powi(2)).sum::<f64>() < 0.02
}

#[test]
fn a_constant_is_fitted_exactly() {
    assert!(sound(table(|_, _| FLAT)).unwrap() < 0.01);
}

#[test]
fn stiff_tables_give_sound_materials() {
    sound(table(|t, d| if near_mirror(t, d) { 1e5 } else { 0.0 })).unwrap();
    sound(table(|t, d| if near_mirror(t, d) { 1e6 } else { 1e-6 })).unwrap();
    sound(table(|_, d| 1e-6 * 1e12f64.powf(d[0].abs()))).unwrap();
    sound(table(|_, d| if d[0] > 0.0 { FLAT } else { 0.0 })).unwrap();
    sound(table(|_, d| (1e4 * (d[0] + 3.0 * d[1])).sin().abs())).unwrap();
    sound(table(|_, _| 1e8)).unwrap();
    sound(table(|_, _| 1e-12)).unwrap();
}

#[test]
fn negative_values_count_as_nothing() {
    sound(table(|_, d| if d[1] > 0.3 { -1.0 } else { FLAT })).unwrap();
}

#[test]
fn few_repeated_and_one_sided_samples_give_sound_materials() {
    let one = |theta| (theta, vec![(direction(0.4, 0.1), [FLAT; 3])]);
    sound(vec![one(0.5)]).unwrap();
    sound(vec![one(0.1), one(0.1000001), one(1.5)]).unwrap();
    sound(vec![(0.5, vec![(direction(0.4, 0.1), [FLAT; 3]); 200])]).unwrap();
    let mut half = table(|_, _| FLAT);
    half.iter_mut().for_each(|(_, samples)| samples.retain(|(d, _)| d[0] > 0.0));
    sound(half).unwrap();
    let mut gap = table(|_, _| FLAT);
    gap.remove(2);
    sound(gap).unwrap();
}

#[test]
fn tables_that_hold_nothing_are_refused() {
    assert!(sound(vec![]).is_err());
    assert!(sound(table(|_, _| 0.0)).is_err());
    assert!(sound(table(|_, _| -1.0)).is_err());
    assert!(sound(table(|_, _| f64::NAN)).is_err());
    assert!(sound(table(|_, _| f64::INFINITY)).is_err());
    assert!(sound(vec![(0.5, vec![])]).is_err());
    assert!(sound(vec![(-0.5, vec![(direction(0.4, 0.1), [FLAT; 3])])]).is_err());
    assert!(sound(vec![(1.6, vec![(direction(0.4, 0.1), [FLAT; 3])])]).is_err());
    assert!(sound(vec![(f64::NAN, vec![(direction(0.4, 0.1), [FLAT; 3])])]).is_err());
    assert!(sound(vec![(0.5, vec![([f64::NAN, 0.0, 1.0], [FLAT; 3])])]).is_err());
    assert!(sound(vec![(0.5, vec![([0.0, 0.0, -1.0], [FLAT; 3])])]).is_err());
}

#[test]
fn settings_out_of_range_are_refused() {
    let table = Table::from_scattered(table(|_, _| FLAT)).unwrap();
    let default = Settings::default;
    for settings in [
        Settings { lobes: 0, ..default() },
        Settings { lobes: 65, ..default() },
        Settings { squeezed: Some(13), ..default() },
        Settings { smoothness: f64::NAN, ..default() },
        Settings { starts: 0, ..default() },
        Settings { steps: 0, ..default() },
        Settings { knots: Some(vec![]), ..default() },
        Settings { knots: Some(vec![0.1, 0.5]), ..default() },
        Settings { knots: Some(vec![0.0, f64::NAN]), ..default() },
        Settings { knots: Some(vec![0.0, 2.0]), ..default() },
    ] {
        assert!(fit(&table, &settings, |_| {}).is_err(), "{settings:?}");
    }
}
