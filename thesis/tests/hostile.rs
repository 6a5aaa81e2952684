//! Tables that no measurement should be, but some are: each gives a sound material, or says why not.

use srbf_core::{MAX_LOBES, Material, Mixture, Vec3, luminance};
use srbf_fit::analytic::lambert::Lambert;
use srbf_fit::judge::method::Fitted;
use srbf_fit::judge::report::ViewReport;
use srbf_fit::table::{Scattered, Table};
use srbf_fit::{FactorNodes, Settings, fit};
use srbf_thesis::lafortune::{self, Lafortune};
use srbf_thesis::thesis;

const FLAT: f64 = 0.2;

/// Such a fit takes a few seconds; a machine may be busy.
const MOST_SECONDS: u64 = 60;

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
    let settings = Settings {
        lobes: 6,
        starts: 2,
        steps: 12,
        exchanges: 1,
        views: Some(4),
        factors: FactorNodes::None,
        ..Settings::default()
    };
    let start = std::time::Instant::now();
    let fit = fit(&table, &settings, |share| assert!((0.0..=1.0).contains(&share)))?;
    assert!(start.elapsed().as_secs() < MOST_SECONDS, "{:?}", start.elapsed());
    let material = Material::from_bytes(&fit.bytes).unwrap();
    for (view, lobe) in
        (0..material.view_count()).flat_map(|v| (0..material.view_lobe_count()).map(move |k| (v, k)))
    {
        let lobe = material.view_lobe(view, lobe).unwrap();
        let finite = lobe.log2_luminance.is_finite() && lobe.color_differences.iter().all(|a| a.is_finite());
        assert!(
            finite && (lobe.angle + lobe.off_plane).is_finite() && lobe.log2_sharpness.is_finite(),
            "{view}: {lobe:?}"
        );
    }
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
            // Channels of saturated colours may be below 0, the luminance is not, but for rounding.
            let value = mixture.evaluate(Vec3::from(d));
            let rounding = 1e-6 * value.abs().max_element();
            assert!(value.is_finite() && luminance(value) >= -rounding, "{degrees}: {value}");
        }
    }
    for v in &fit.report.views {
        assert!(v.error.is_finite() && v.variance >= 0.0, "{v:?}");
        assert!(v.is_black || v.largest_weight > 0.999, "{v:?}");
    }
    sound_baselines(&table);
    Ok(fit.report.mean_error())
}

/// The baselines have lobes of finite numbers too, whatever becomes of ours.
fn sound_baselines(table: &Table) {
    let settings =
        thesis::ThesisSettings { lobes: 3, edge: 8, iterations: 3, ..thesis::ThesisSettings::default() };
    let thesis = thesis::fit_table(table, &settings).unwrap();
    let settings = lafortune::LafortuneSettings { lobes: 1, starts: 3, steps: 5 };
    let lafortune = Lafortune::fit(table, &settings).unwrap();
    for view in &table.views {
        for fitted in [&thesis as &dyn Fitted, &lafortune] {
            let value = fitted.view(view.theta).unwrap().f_cos([0.6, 0.0, 0.8]);
            assert!(value.iter().all(|v| v.is_finite() && *v >= 0.0), "{}: {value:?}", view.theta);
            let report = ViewReport::judge(fitted, view).unwrap();
            let variance = report.variance;
            assert!(report.error.is_finite() && (variance.is_nan() || variance >= 0.0), "{report:?}");
        }
    }
}

/// Of a BRDF, where no interpolation has a floor: squares that are 0 or infinite, and numbers that are no normal ones.
#[test]
fn the_thesis_method_survives_values_of_any_size() {
    for albedo in [f64::from_bits(100), 1e-310, 1e-300, 1e-155, 1e-30, 1e30, 1e155, 1e300] {
        let settings = thesis::ThesisSettings { lobes: 2, edge: 8, ..thesis::ThesisSettings::default() };
        let found = thesis::fit_brdf(&Lambert { albedo: [albedo; 3] }, &[0.0, 0.7], &settings).unwrap();
        for view in &found.views {
            assert!(view.error < 0.5, "{albedo:e}: {view:?}");
        }
    }
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

/// One sample that is not zero, at one view or at each.
#[test]
fn a_mirror_of_one_sample_gives_a_sound_material() {
    for mirrors in [1, 4] {
        let mut views = table(|_, _| 0.0);
        for (theta, samples) in views.iter_mut().take(mirrors) {
            samples.push((direction(*theta, 0.0), [1e4, 1e4, 1e4]));
        }
        sound(views).unwrap();
    }
}

/// Every value the same number, in every channel.
#[test]
fn equal_values_are_fitted_as_constants_are() {
    let all = |value: f64| {
        let mut views = table(|_, _| value);
        views.iter_mut().for_each(|(_, samples)| samples.iter_mut().for_each(|(_, rgb)| *rgb = [value; 3]));
        sound(views).unwrap()
    };
    assert!(all(0.1) < 0.01 && all(1e-6) < 0.01);
    // An albedo of 1 is held a little below it.
    assert!(all(1.0 / std::f64::consts::PI) < 0.06);
    // This cannot be met: brighter than anything.
    all(1e30);
}

/// Too dark for the amplitudes of a material, which says so; the baselines have no such bound.
#[test]
fn what_is_too_dark_to_be_stored_is_refused() {
    for value in [1e-300, 1e-155, 1e-30, 1e-16] {
        let error = sound(table(|_, _| value)).unwrap_err().to_string();
        assert!(error.contains("1e-15"), "{value:e}: {error}");
        if value > 1e-29 {
            sound_baselines(&Table::from_scattered(table(|_, _| value)).unwrap());
        }
    }
}

/// Values over twelve decades within a view, and from one view to the next.
#[test]
fn twelve_decades_give_sound_materials() {
    let noise = |d: [f64; 3]| (1e5 * (d[0] + 2.0 * d[1])).sin();
    sound(table(|_, d| 1e6f64.powf(noise(d)))).unwrap();
    sound(table(|t, _| 1e-6 * 1e12f64.powf(t / 1.3))).unwrap();
    sound(table(|t, d| if t > 1.2 { 1e6 } else { 1e-6 * d[2] })).unwrap();
}

#[test]
fn noise_of_five_per_cent_is_not_fitted_as_if_it_were_lobes() {
    let noise = |d: [f64; 3]| 1.0 + 0.05 * 1.7 * (1e5 * (d[0] + 2.0 * d[1])).sin();
    let gloss = |t: f64, d: [f64; 3]| {
        let mirror = direction(t, 0.0);
        let chord: f64 = (0..3).map(|k| (d[k] - mirror[k]).powi(2)).sum();
        0.05 + (-10.0 * chord).exp()
    };
    let error = sound(table(|t, d| gloss(t, d) * noise(d))).unwrap();
    assert!((0.01..0.12).contains(&error), "{error}");
}

/// The same directions with different values: the fit goes between them.
#[test]
fn directions_given_twice_with_different_values_are_averaged() {
    let mut views = table(|_, _| 0.5 * FLAT);
    let twice = table(|_, _| 1.5 * FLAT);
    for ((_, samples), (_, more)) in views.iter_mut().zip(twice) {
        samples.extend(more);
    }
    let error = sound(views).unwrap();
    // Half of the difference over the root mean square of 0.5 and 1.5: 0.447.
    assert!((error - 0.447).abs() < 0.02, "{error}");
}

/// A view with a hole in it: nothing is known of a quarter of the hemisphere, round the mirror direction.
#[test]
fn a_highlight_that_was_not_measured_gives_a_sound_material() {
    let mut views = table(|t, d| if near_mirror(t, d) { 50.0 } else { FLAT });
    views[1].1.retain(|(d, _)| d[0] < 0.2);
    sound(views).unwrap();
}

#[test]
fn any_number_of_lobes_and_of_views_gives_a_sound_material() {
    let table = Table::from_scattered(table(|t, d| if near_mirror(t, d) { 5.0 } else { FLAT })).unwrap();
    for (lobes, squeezed) in [(1, None), (1, Some(1)), (2, None), (3, Some(0)), (3, Some(3)), (20, None)] {
        let settings = Settings {
            lobes,
            squeezed,
            starts: 2,
            steps: 8,
            exchanges: 1,
            views: Some(4),
            factors: FactorNodes::None,
            ..Settings::default()
        };
        let fit = fit(&table, &settings, |_| {}).unwrap();
        assert!(fit.report.views.iter().all(|v| v.error < 1.0), "{lobes} {squeezed:?}: {:?}", fit.report);
    }
}

/// As few lobes as reach an error, or why there are none. Two highlights, one in the other: a lobe is not enough.
#[test]
fn an_error_that_is_asked_for_is_reached_or_refused() {
    let highlights = |theta: f64, d: [f64; 3]| {
        let mirror = direction(theta, 0.0);
        let chord: f64 = (0..3).map(|k| (d[k] - mirror[k]).powi(2)).sum();
        FLAT + 3.0 * (-25.0 * chord).exp() + 1.0 * (-3.0 * chord).exp()
    };
    let table = Table::from_scattered(table(highlights)).unwrap();
    let settings = Settings {
        lobes: 4,
        starts: 2,
        steps: 20,
        exchanges: 1,
        views: Some(4),
        factors: FactorNodes::None,
        ..Settings::default()
    };
    let with = |error| fit(&table, &Settings { error: Some(error), ..settings.clone() }, |_| {});
    let lobes = |bytes: &[u8]| Material::from_bytes(bytes).unwrap().lobe_count();
    let easy = with(0.9).unwrap();
    assert_eq!(lobes(&easy.bytes), 1);
    let best = fit(&table, &settings, |_| {}).unwrap().report.mean_error();
    let close = with(1.02 * best).unwrap();
    let reached = close.report.mean_error();
    assert!(
        reached <= 1.02 * best && lobes(&close.bytes) > 1,
        "{reached} with {}, {best} with 4, {} with 1",
        lobes(&close.bytes),
        easy.report.mean_error()
    );
    let refused = with(1e-6).unwrap_err().to_string();
    assert!(refused.contains("4 lobes reach"), "{refused}");
}

#[test]
fn negative_values_give_sound_materials() {
    sound(table(|_, d| if d[1] > 0.3 { -1.0 } else { FLAT })).unwrap();
}

#[test]
fn few_repeated_and_one_sided_samples_give_sound_materials() {
    let one = |theta| (theta, vec![(direction(0.4, 0.1), [FLAT; 3])]);
    for few in [
        vec![one(0.5)],
        vec![one(0.1), one(0.1000001), one(1.5)],
        vec![one(0.1), one(0.1000001), one(0.5), one(1.0), one(1.5)],
        vec![(0.5, vec![(direction(0.4, 0.1), [FLAT; 3]); 200])],
    ] {
        assert!(sound(few).unwrap_err().to_string().contains("need 5 at least"));
    }
    sound(vec![one(0.1), one(0.1000001), one(0.3), one(0.5), one(1.0), one(1.5)]).unwrap();
    let mut half = table(|_, _| FLAT);
    half.iter_mut().for_each(|(_, samples)| samples.retain(|(d, _)| d[0] > 0.0));
    sound(half).unwrap();
    let mut gap = table(|_, _| FLAT);
    gap.remove(2);
    sound(gap).unwrap();
}

#[test]
fn a_table_without_light_is_black() {
    for value in [0.0, -1.0] {
        sound(table(|_, _| value)).unwrap();
    }
}

#[test]
fn tables_that_hold_nothing_are_refused() {
    assert!(sound(vec![]).is_err());
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
        Settings { error: Some(0.0), ..default() },
        Settings { error: Some(f64::NAN), ..default() },
        Settings { views: Some(1), ..default() },
        Settings { exchanges: 1001, ..default() },
        Settings { squeezed: Some(13), ..default() },
        Settings { smoothness: f64::NAN, ..default() },
        Settings { starts: 0, ..default() },
        Settings { steps: 0, ..default() },
        Settings { view_angles: Some(vec![]), ..default() },
        Settings { view_angles: Some(vec![0.1, 0.5]), ..default() },
        Settings { view_angles: Some(vec![0.0, f64::NAN]), ..default() },
        Settings { view_angles: Some(vec![0.0, 2.0]), ..default() },
    ] {
        assert!(fit(&table, &settings, |_| {}).is_err(), "{settings:?}");
    }
}
