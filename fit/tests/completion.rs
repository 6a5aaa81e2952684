//! What samples are completed to: outliers, marks of what was not measured, peaks about the back direction.

use srbf_fit::analytic;
use srbf_fit::complete::{Completion, Family, complete};
use srbf_fit::table::{Brdf, Table};
use std::f64::consts::PI;

fn direction(theta: f64, phi: f64) -> [f64; 3] {
    let ((st, ct), (sp, cp)) = (theta.to_radians().sin_cos(), phi.to_radians().sin_cos());
    [st * cp, st * sp, ct]
}

/// A gonioreflectometer's grid: nine views, lights every 10 degrees from the normal and every 45 of azimuth, one half of the hemisphere;
/// and what it measures, by view, light and number.
fn grid(value: &dyn Fn(f64, [f64; 3], usize) -> f64) -> Table {
    let mut number = 0;
    let mut view = |theta: f64| {
        let lights = (0..9).flat_map(|t| (0..5).map(move |p| (10.0 * f64::from(t), 45.0 * f64::from(p))));
        let samples = lights.map(|(t, p)| {
            let wi = direction(t, p);
            number += 1;
            (wi, [value(theta, wi, number - 1); 3])
        });
        (theta.to_radians(), samples.collect())
    };
    Table::from_scattered((0..9).map(|n| view(10.0 * f64::from(n))).collect()).unwrap()
}

fn paint() -> Box<dyn Brdf + Send> {
    analytic::parse("ggx:alpha=0.3,f0=0.05,diffuse=0.3").unwrap().brdf
}

fn measured(paint: &dyn Brdf, theta: f64, wi: [f64; 3]) -> f64 {
    paint.evaluate(wi, direction(theta, 180.0))[1]
}

/// Worst ratio of what a completion says to the truth, halfway between the samples.
fn worst(completion: &Completion, paint: &dyn Brdf) -> f64 {
    let between = (0..8).flat_map(|v| (0..7).flat_map(move |t| (0..4).map(move |p| (v, t, p))));
    let off = between.map(|(v, t, p)| {
        let wi = direction(5.0 + 10.0 * f64::from(t), 22.5 + 45.0 * f64::from(p));
        let wo = direction(5.0 + 10.0 * f64::from(v), 180.0);
        (completion.evaluate(wi, wo)[1] / paint.evaluate(wi, wo)[1]).ln().abs()
    });
    off.fold(0.0, f64::max)
}

#[test]
fn one_hot_sample_is_found_and_says_nothing() {
    let (paint, hot) = (paint(), 4 * 45 + 3 * 5 + 2);
    let table = grid(&|theta, wi, n| measured(paint.as_ref(), theta, wi) * if n == hot { 50.0 } else { 1.0 });
    let completion = complete(&table).unwrap();
    let outliers = &completion.report.outliers;
    assert!(outliers.len() == 1 && outliers[0].view == 4 && outliers[0].sample == 17, "{outliers:?}");
    assert!((outliers[0].ratio / 50.0 - 1.0).abs() < 0.2, "{outliers:?}");
    assert!(worst(&completion, paint.as_ref()) < 0.05);
    let left = completion.without_outliers(&table).unwrap();
    assert_eq!(left.views[4].samples.len() + 1, table.views[4].samples.len());
    assert_eq!(left.views[3], table.views[3]);
}

#[test]
fn marks_of_what_was_not_measured_say_nothing() {
    let paint = paint();
    let table = grid(&|theta, wi, n| if n % 37 == 5 { -1.0 } else { measured(paint.as_ref(), theta, wi) });
    let completion = complete(&table).unwrap();
    assert_eq!(completion.report.outliers.len(), (0..405).filter(|n| n % 37 == 5).count());
    assert!(worst(&completion, paint.as_ref()) < 0.05);
}

#[test]
fn what_is_smooth_has_no_outlier() {
    let paint = paint();
    let completion = complete(&grid(&|theta, wi, _| measured(paint.as_ref(), theta, wi))).unwrap();
    assert!(completion.report.outliers.is_empty(), "{:?}", completion.report.outliers);
    // The albedo before it is held to what a surface can reflect.
    let (_, albedo) = completion.report.albedo[0];
    assert!((albedo[1] - 0.33).abs() < 0.05, "{albedo:?}");
}

/// As high at every view, and sampled to 60 degrees: between the views as well.
#[test]
fn a_peak_about_the_back_direction_is_there_between_the_views() {
    let value = |wi: [f64; 3], wo: [f64; 3]| {
        let apart = (0..3).map(|k| (wi[k] - wo[k]).powi(2)).sum::<f64>().sqrt().min(2.0);
        let degrees = (2.0 * (0.5 * apart).asin()).to_degrees();
        0.05 + 20.0 * (-(degrees / 2.0).powi(2)).exp()
    };
    let view = |theta: f64| {
        let wo = direction(theta, 180.0);
        let mut lights: Vec<[f64; 3]> = Vec::new();
        for off in [0.0, 1.0, -1.0, 2.0, -2.0, 3.0, -3.0, 5.0, -5.0] {
            lights.push(direction(theta + off, 180.0));
        }
        lights.extend((0..8).flat_map(|t| (0..5).map(move |p| direction(5.0 + 10.0 * f64::from(t), 45.0 * f64::from(p)))));
        (theta.to_radians(), lights.into_iter().map(|wi| (wi, [value(wi, wo); 3])).collect::<Vec<_>>())
    };
    let table = Table::from_scattered([5.0, 20.0, 40.0, 60.0].map(view).to_vec()).unwrap();
    let completion = complete(&table).unwrap();
    assert_eq!(completion.report.family, Family::Retro);
    for theta in [10.0, 30.0, 50.0] {
        let wo = direction(theta, 180.0);
        let said = completion.evaluate(wo, wo)[1];
        assert!((said / 20.05 - 1.0).abs() < 0.1, "{theta}: {said}");
        let beside = completion.evaluate(direction(theta, 90.0), wo)[1];
        assert!((beside / 0.05 - 1.0).abs() < 0.1, "{theta}: {beside}");
    }
    assert!(completion.report.albedo.iter().all(|a| a.1[1] < 0.1 * PI));
}
