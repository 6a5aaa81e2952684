//! The methods that ours is compared with, from a table to errors and JSON.

use srbf_fit::analytic::ward::Ward;
use srbf_fit::judge::compare::score;
use srbf_fit::judge::method::{Fitted, FittedView, Method};
use srbf_fit::judge::report::{Ending, Input, Report, ViewReport, mean_error};
use srbf_fit::read::Content;
use srbf_fit::table::Brdf;
use srbf_fit::table::evaluation_views;
use srbf_fit::table::{self, Table};
use srbf_fit::{FactorNodes, FitError, Settings, Tracked, fit};
use srbf_thesis::lafortune::{self, Channel, CosineLobe, Lafortune};
use srbf_thesis::thesis;
use std::path::PathBuf;

fn planted() -> Lafortune {
    let lobes = vec![CosineLobe { cxy: -1.0, cz: 0.98, n: 25.0 }];
    let channel = |diffuse| Channel { diffuse, lobes: lobes.clone() };
    Lafortune { channels: [channel(0.3), channel(0.2), channel(0.1)], evaluations: 0 }
}

/// The planted model at 5 views, 12 by 13 directions.
fn small_table() -> Table {
    sampled(12, 13)
}

fn sampled(polar: u32, azimuths: u32) -> Table {
    let model = planted();
    let view = |theta: f64| {
        let mut samples = vec![];
        for t in 0..polar {
            for p in 0..azimuths {
                let theta_i = 0.02 + 1.44 * f64::from(t) / f64::from(polar);
                let phi = 3.12 * f64::from(p) / f64::from(azimuths - 1);
                let wi = [theta_i.sin() * phi.cos(), theta_i.sin() * phi.sin(), theta_i.cos()];
                samples.push((wi, model.evaluate(wi, [-theta.sin(), 0.0, theta.cos()])));
            }
        }
        (theta, samples)
    };
    Table::from_scattered([0.1, 0.35, 0.6, 0.85, 1.1].map(view).to_vec()).unwrap()
}

fn scattered(view: &table::View) -> table::Scattered {
    view.samples.iter().map(|s| (s.direction, s.rgb)).collect()
}

fn quick_thesis() -> thesis::ThesisSettings {
    thesis::ThesisSettings { lobes: 4, edge: 16, ..thesis::ThesisSettings::default() }
}

/// The model that made the table has no error, fitted or held out; the others have some, and a fold is worse than the fit.
#[test]
fn every_method_is_judged_by_what_it_has_seen_and_what_not() {
    let table = small_table();
    let lafortune =
        lafortune::LafortuneSettings { lobes: 1, starts: 10, ..lafortune::LafortuneSettings::default() };
    let found = score(&table, &lafortune, true).unwrap();
    let held_out = found.held_out.unwrap();
    assert!(
        found.mean < 1e-4 && found.mean_of_f < 1e-4 && found.whole < 1e-4,
        "{found:?}",
        found = found.mean
    );
    assert_eq!((held_out.folds.len(), held_out.left_out.len()), (5, 3));
    assert!(held_out.folds.iter().chain(held_out.left_out.iter().map(|v| &v.1)).all(|e| *e < 1e-3));

    let ours = Settings {
        lobes: 4,
        starts: 2,
        steps: 30,
        exchanges: 1,
        views: Some(6),
        factors: FactorNodes::None,
        ..Settings::default()
    };
    for method in [&quick_thesis() as &dyn Method, &Tracked(&ours)] {
        let found = score(&table, method, true).unwrap();
        assert!(found.mean > 1e-4 && found.mean < 0.3, "{found:?}");
        let held_out = found.held_out.unwrap();
        assert_eq!((held_out.folds.len(), held_out.left_out.len()), (5, 3));
        // At the same three views: the fit that has seen them, and those that have not.
        let fitted = method.fit(&table).unwrap();
        let seen = |v: &table::View| ViewReport::judge(fitted.as_ref(), v).unwrap().error;
        let seen: f64 = table.views[1..4].iter().map(seen).sum();
        let unseen: f64 = held_out.left_out.iter().map(|v| v.1).sum();
        assert!(unseen > seen, "{unseen} {seen}");
    }
}

/// The lobes of a view are its own at the view, and equation 9 in between.
#[test]
fn the_thesis_method_blends_between_its_views() {
    let model = planted();
    let thetas = evaluation_views::even_views(5);
    assert!((thetas[4] - 87f64.to_radians()).abs() < 1e-12);
    let found = thesis::fit_brdf(&model, &thetas, &quick_thesis()).unwrap();
    assert!(found.evaluations > 5 * 10);
    let d = [0.36, 0.48, 0.8];
    let at = |theta: f64| found.view(theta).unwrap().f_cos(d);
    let between = evaluation_views::halfway(&thetas)[1];
    // The second of four intervals: distances 1/2, 1/2, 3/2, 3/2.
    for c in 0..3 {
        let [a, b, e, f] = [0, 1, 2, 3].map(|n| at(thetas[n])[c]);
        let expected = 0.125 * a + 0.375 * b + 0.375 * e + 0.125 * f;
        assert!((at(between)[c] - expected).abs() < 1e-9 * expected, "{c}");
    }
    let json = found.to_json();
    assert_eq!(json.as_array().unwrap().len(), 5);
    assert_eq!(json[0]["lobes"][0]["axis"].as_array().unwrap().len(), 3);
    assert_eq!(found, thesis::fit_brdf(&model, &thetas, &quick_thesis()).unwrap());
}

/// Samples interpolated onto the cube map and the values themselves lead to about the same fit.
#[test]
fn scattered_samples_are_resampled() {
    let table = sampled(48, 49);
    let thetas: Vec<f64> = table.views.iter().map(|v| v.theta).collect();
    let resampled = thesis::fit_table(&table, &quick_thesis()).unwrap();
    let evaluated = thesis::fit_brdf(&planted(), &thetas, &quick_thesis()).unwrap();
    for view in &table.views[..4] {
        let error = |f: &dyn Fitted| ViewReport::judge(f, view).unwrap().error;
        let (a, b) = (error(&resampled), error(&evaluated));
        assert!((a - b).abs() < 0.02, "{}: {a} {b}", view.theta);
    }
}

/// The same input gives the same fit, whatever the number of threads.
#[test]
fn threads_do_not_matter() {
    let table = small_table();
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let lafortune = lafortune::LafortuneSettings { starts: 6, ..lafortune::LafortuneSettings::default() };
        pool.install(|| {
            let thesis = thesis::fit_table(&table, &quick_thesis()).unwrap();
            (thesis, Lafortune::fit(&table, &lafortune).unwrap())
        })
    };
    assert_eq!(on(1), on(3));
}

/// Nothing to see, and settings out of range, are no panic.
#[test]
fn black_and_bad_settings_are_survived() {
    let directions = [[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [-0.6, 0.0, 0.8], [0.0, 0.6, 0.8], [0.0, -0.8, 0.6]];
    let mut black = Table::from_scattered(vec![(0.3, directions.map(|d| (d, [0.0; 3])).to_vec())]).unwrap();
    black.views[0].samples.iter_mut().for_each(|sample| sample.rgb = [0.0; 3]);
    let methods: [&dyn Method; 3] =
        [&quick_thesis(), &lafortune::LafortuneSettings::default(), &Tracked(&Settings::default())];
    for method in methods {
        let error = method.fit(&black).err().map(|e| e.to_string()).unwrap();
        assert!(error.contains("no sample has any brightness"), "{error}");
    }
    // One black view among others has no lobes.
    let mut views: Vec<_> = small_table().views.iter().map(|v| (v.theta, scattered(v))).collect();
    views[0].1.iter_mut().for_each(|(_, rgb)| *rgb = [0.0; 3]);
    let table = Table::from_scattered(views).unwrap();
    let found = thesis::fit_table(&table, &quick_thesis()).unwrap();
    assert!(found.views[0].lobes.is_empty());
    assert_eq!(found.view(0.1).unwrap().f_cos([0.0, 0.0, 1.0]), [0.0; 3]);
    assert_eq!(found.view(0.1).unwrap().pdf([0.0, 0.0, 1.0]), Some(0.0));
    let bad = |s: thesis::ThesisSettings| thesis::fit_table(&black, &s).unwrap_err().to_string();
    assert!(bad(thesis::ThesisSettings { lobes: 0, ..quick_thesis() }).contains("lobes"));
    assert!(bad(thesis::ThesisSettings { edge: 7, ..quick_thesis() }).contains("edge"));
    assert!(bad(thesis::ThesisSettings { edge: 1 << 20, ..quick_thesis() }).contains("edge"));
    assert!(bad(thesis::ThesisSettings { coverage: f64::NAN, ..quick_thesis() }).contains("coverage"));
    let bright = small_table();
    let starts = lafortune::LafortuneSettings { starts: 0, ..lafortune::LafortuneSettings::default() };
    assert!(Lafortune::fit(&bright, &starts).is_err());
    assert!(thesis::fit_brdf(&planted(), &[], &quick_thesis()).is_err());
    assert!(thesis::fit_brdf(&planted(), &[2.0], &quick_thesis()).is_err());
}

/// The report has its input, the number of evaluations, and the reciprocity of the fit.
#[test]
fn reports_are_complete() {
    let settings = Settings {
        lobes: 3,
        starts: 2,
        steps: 10,
        views: Some(6),
        provenance: "a line\n".into(),
        ..Settings::default()
    };
    let found = fit(&small_table(), &settings, |_| {}).unwrap();
    assert!(found.report.evaluations > 5, "{}", found.report.evaluations);
    let material = srbf_core::Material::from_bytes(&found.bytes).unwrap();
    let input = Input { name: "some.csv".into(), sha256: "0123".into() };
    let json: serde_json::Value =
        serde_json::from_str(&found.report.to_json(&material, &input, &settings).unwrap()).unwrap();
    assert_eq!(json["input"]["name"], "some.csv");
    assert_eq!(json["input"]["sha256"], "0123");
    assert_eq!(json["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(json["settings"]["lobes"], 3);
    assert_eq!(json["settings"]["smoothness"], settings.smoothness);
    assert!(json["settings"]["view_angles_degrees"].is_null() && json["settings"]["views"] == 6, "{json}");
    assert!(["steps", "improvement"].contains(&json["stopped"].as_str().unwrap()), "{json}");
    assert_eq!(json["views"][1]["energy_error"], found.report.views[1].energy_error());
    assert!(json["provenance"].as_str().unwrap().starts_with("a line\n"), "{json}");
    assert_eq!(json["evaluations"], found.report.evaluations);
    let median = json["reciprocity"]["median_abs_log_ratio"].as_f64().unwrap();
    let worst = json["reciprocity"]["worst_abs_log_ratio"].as_f64().unwrap();
    assert!(median > 0.0 && median <= worst && worst < 10.0, "{median} {worst}");

    // Lafortune's model is reciprocal, and has no density.
    let report = Report {
        views: vec![ViewReport::judge(&planted(), &small_table().views[1]).unwrap()],
        ..Report::default()
    };
    assert!(report.views[0].error < 1e-12);
    let json = report.to_json_of(&planted(), "lafortune", &input).unwrap();
    assert!(json["reciprocity"]["worst_abs_log_ratio"].as_f64().unwrap() < 1e-9);
    assert!(json["views"][0]["relative_variance"].is_null());
}

/// A fit that never draws some directions, that is black at the first view, and whose albedo nothing can have.
struct Odd;
struct OddView;
impl Fitted for Odd {
    fn view(&self, _: f64) -> Result<Box<dyn FittedView + '_>, FitError> {
        Ok(Box::new(OddView))
    }
}
impl FittedView for OddView {
    fn f_cos(&self, d: [f64; 3]) -> [f64; 3] {
        [d[2]; 3]
    }
    fn pdf(&self, d: [f64; 3]) -> Option<f64> {
        Some(if d[0] > 0.0 { 1.0 } else { 0.0 })
    }
}

#[test]
fn what_has_no_number_is_said_and_not_averaged() {
    let mut views: Vec<_> = small_table().views.iter().map(|v| (v.theta, scattered(v))).collect();
    views[0].1.iter_mut().for_each(|(_, rgb)| *rgb = [0.0; 3]);
    views[1].1.iter_mut().for_each(|(_, rgb)| *rgb = [1.0; 3]);
    let table = Table::from_scattered(views).unwrap();
    let reports: Vec<_> = table.views.iter().map(|v| ViewReport::judge(&Odd, v).unwrap()).collect();
    let report = Report { views: reports, ending: Some(Ending::Steps), ..Report::default() };
    assert!(report.views[0].is_black && report.views[0].error > 0.0);
    let bright = &report.views[1..];
    let mean = bright.iter().map(|v| v.error).sum::<f64>() / bright.len() as f64;
    assert!((report.mean_error() - mean).abs() < 1e-12 && report.views[1].error < 1e-12);
    // The albedo is a sum over the same samples on both sides.
    assert!(report.views[1].energy_error() < 1e-12, "{:?}", report.views[1]);
    let notes = report.notes().join("\n");
    assert!(notes.contains("black") && notes.contains("50 %"), "{notes}");

    let json = report.to_json_of(&Odd, "odd", &Input::default()).unwrap();
    assert!(json["views"][0]["relative_l2"].is_null() && json["views"][0]["is_black"] == true, "{json}");
    assert_eq!(json["views"][1]["largest_weight_over_mean"], "inf");
    assert_eq!(json["views"][1]["relative_variance"], "inf");
    assert_eq!(json["notes"].as_array().unwrap().len(), report.notes().len());

    // Lobes were held to less than what no surface reflects, and the report says so.
    let settings =
        Settings { lobes: 3, starts: 2, steps: 10, views: Some(4), exchanges: 1, ..Settings::default() };
    let fit = fit(&table, &settings, |_| {}).unwrap();
    let view = &fit.report.views[1];
    assert!(view.is_albedo_cut && view.data_albedo[0] > 3.0 && view.energy_error() > 0.5, "{view:?}");
    assert!(fit.report.notes().iter().any(|note| note.contains("0.95")), "{:?}", fit.report.notes());
}

/// The loss of the thesis's lobes below the horizon is a part of their variance.
#[test]
fn samples_that_are_lost_count() {
    let table = sampled(48, 49);
    let found = thesis::fit_table(&table, &quick_thesis()).unwrap();
    for view in &table.views {
        let fitted = found.view(view.theta).unwrap();
        let share = fitted.share_above_horizon();
        let report = ViewReport::judge(&found, view).unwrap();
        assert!(share < 0.99 && (report.density - 1.0).abs() < 0.05, "{share} {report:?}");
        assert!(report.largest_weight > 1.0 / share - 0.01 && report.variance >= 1.0 / share - 1.01);
    }
}

/// Evaluations are those of all fits, not of the one that was chosen alone.
#[test]
fn all_fits_of_an_error_that_is_asked_for_count() {
    let settings = Settings {
        lobes: 4,
        starts: 2,
        steps: 20,
        exchanges: 1,
        views: Some(4),
        factors: FactorNodes::None,
        ..Settings::default()
    };
    let table = small_table();
    let with = |settings: &Settings| fit(&table, settings, |_| {}).unwrap();
    let reached = |report: &Report| report.mean_error().max(mean_error(&report.held_out));
    let error = Some(1.02 * reached(&with(&settings).report));
    let all = with(&Settings { error, ..settings.clone() });
    let lobes = srbf_core::Material::from_bytes(&all.bytes).unwrap().lobe_count();
    let last = with(&settings.with_lobes(lobes));
    assert_eq!(last.bytes, all.bytes);
    assert!(lobes > 1 && all.report.evaluations > last.report.evaluations, "{lobes}");
}

/// A view at one azimuth does not say what an anisotropic surface is, so no method pretends that it does.
#[test]
fn methods_for_isotropic_surfaces_refuse_others() {
    let ward = Ward { diffuse: [0.2; 3], specular: [0.3; 3], alpha: [0.1, 0.4] };
    let of_thesis = thesis::fit_brdf(&ward, &[0.3], &quick_thesis()).err().map(|e| e.to_string());
    let of_table = evaluation_views::judging_table(&ward, &[0.3]).err().map(|e| e.to_string());
    for error in [of_thesis, of_table] {
        assert!(error.as_ref().is_some_and(|e| e.contains("anisotropic")), "{error:?}");
    }
}

/// Cornell's garnet red: the thesis reports 4 % for its method; ours is better than both baselines.
#[test]
#[ignore = "needs the measured data in SRBF_DATA_DIR"]
fn garnet_red_as_in_table_5_1() {
    let folder = std::env::var_os("SRBF_DATA_DIR").expect("SRBF_DATA_DIR names the data folder");
    let path = PathBuf::from(folder).join("cornell/garnet_red.brdf");
    let Content::Samples(table) = srbf_fit::read::read(&path).unwrap().content else { panic!("scattered") };
    let thesis = score(&table, &thesis::ThesisSettings::default(), false).unwrap();
    let lafortune = score(&table, &lafortune::LafortuneSettings::default(), false).unwrap();
    let ours = score(&table, &Tracked(&Settings::default()), false).unwrap();
    assert!(thesis.mean < 0.06, "{thesis:?}");
    assert!(lafortune.mean < 0.22, "{lafortune:?}");
    assert!(ours.mean < 0.5 * thesis.mean && ours.mean < 0.2 * lafortune.mean, "{ours:?}");
}

/// The published fit of blue paint has the albedo that the data's description gives.
#[test]
#[ignore = "needs the measured data in SRBF_DATA_DIR"]
fn the_published_fit_of_blue_paint_is_a_material() {
    let folder = std::env::var_os("SRBF_DATA_DIR").expect("SRBF_DATA_DIR names the data folder");
    let path = PathBuf::from(folder).join("cornell/lafortune_fits.csv");
    let Content::Evaluable(model) = lafortune::read(&path, "bluepaint").unwrap().content else { panic!() };
    let table =
        evaluation_views::judging_table(model.as_ref(), &[0.0, 60f64.to_radians(), 75f64.to_radians()])
            .unwrap();
    for (view, expected) in
        table.views.iter().zip([[0.312, 0.399, 0.725], [0.338, 0.426, 0.741], [0.382, 0.463, 0.764]])
    {
        let off = view.albedo.iter().zip(expected).map(|(a, e)| (a - e).abs()).fold(0.0, f64::max);
        assert!(off < 0.003, "{}: {:?}", view.theta, view.albedo);
    }
    let error = lafortune::read(&path, "greenpaint").err().map(|e| format!("{e:?}")).unwrap();
    assert!(error.contains("bluepaint"), "{error}");
}
