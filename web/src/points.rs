//! Points of a measurement in the plane of incidence, which the page draws beside the lobes.

use serde_json::{Value, json};
use srbf_fit::read::Content;
use srbf_fit::table::{Brdf, Symmetry, Table};

/// Most sine of the angle out of the plane of incidence of a sample that is shown: of two degrees.
const OFF_PLANE: f64 = 0.035;

/// Degrees between outgoing directions at which a BRDF is shown, and the last of them.
const STEP: usize = 5;
const LAST: usize = 85;

/// Degrees between its points, and between those up to `NEAR` degrees from the mirror direction.
const COARSE: f64 = 2.0;
const FINE: f64 = 0.25;
const NEAR: f64 = 4.0;

/// Largest angle of a point, degrees.
const WIDEST: f64 = 88.0;

/// The views of a measurement: angle of the outgoing direction in degrees, and points. A point is the angle of the incident direction,
/// positive towards the mirror direction, and `f cos` in luminance.
pub(crate) fn points(content: &Content) -> Value {
    match content {
        Content::Samples(table) => json!({"are": "samples", "views": of_samples(table)}),
        Content::Evaluable(brdf) if brdf.symmetry() == Symmetry::Isotropic => {
            json!({"are": "table", "views": of_brdf(brdf.as_ref())})
        }
        Content::Evaluable(_) => Value::Null,
    }
}

/// A number as short as a plot needs.
fn short(value: f64) -> f64 {
    let scale = if value == 0.0 { 1.0 } else { libm::pow(10.0, 4.0 - libm::floor(libm::log10(value.abs()))) };
    let rounded = libm::round(value * scale) / scale;
    if rounded.is_finite() { rounded } else { 0.0 }
}

fn luminance(rgb: [f64; 3]) -> f64 {
    0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]
}

fn of_samples(table: &Table) -> Vec<Value> {
    let view = |view: &srbf_fit::table::View| {
        let near = view.samples.iter().filter(|sample| sample.direction[1].abs() <= OFF_PLANE);
        let mut points: Vec<[f64; 2]> = near
            .map(|sample| {
                let [x, _, z] = sample.direction;
                [short(libm::atan2(x, z).to_degrees()), short(luminance(sample.rgb) * z)]
            })
            .collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        json!({"degrees": short(view.theta.to_degrees()), "points": points})
    };
    table.views.iter().map(view).collect()
}

fn of_brdf(brdf: &dyn Brdf) -> Vec<Value> {
    let view = |degrees: usize| {
        let theta = (degrees as f64).to_radians();
        let wo = [-libm::sin(theta), 0.0, libm::cos(theta)];
        let points: Vec<[f64; 2]> = angles(degrees as f64)
            .into_iter()
            .filter_map(|angle| {
                let at = angle.to_radians();
                let wi = [libm::sin(at), 0.0, libm::cos(at)];
                let value = luminance(brdf.evaluate(wi, wo)) * wi[2];
                (brdf.measured(wi, wo) > 0.5 && value.is_finite()).then(|| [short(angle), short(value)])
            })
            .collect();
        json!({"degrees": degrees, "points": points})
    };
    (0..=LAST).step_by(STEP).map(view).collect()
}

/// Angles of incident directions, degrees, rising: denser round the mirror direction.
fn angles(mirror: f64) -> Vec<f64> {
    let even = |from: f64, to: f64, step: f64| {
        let count = libm::floor((to - from) / step + 1e-9) as usize;
        (0..=count).map(move |n| from + step * n as f64)
    };
    let coarse = even(-WIDEST, WIDEST, COARSE).filter(|angle| (angle - mirror).abs() > NEAR);
    let fine = even(mirror - NEAR, mirror + NEAR, FINE).filter(|angle| angle.abs() <= WIDEST);
    let mut all: Vec<f64> = coarse.chain(fine).collect();
    all.sort_by(f64::total_cmp);
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use srbf_fit::read::read;

    #[test]
    fn a_lambertian_surface_is_a_cosine() {
        let found = points(&read("model:lambert:albedo=0.5".as_ref()).unwrap().content);
        assert_eq!(found["are"], "table");
        let views = found["views"].as_array().unwrap();
        assert_eq!(views.len(), 18);
        for view in views {
            let points = view["points"].as_array().unwrap();
            assert!(points.len() > 80, "{view}");
            for point in points {
                let (angle, value) = (point[0].as_f64().unwrap(), point[1].as_f64().unwrap());
                let expected = 0.5 * libm::cos(angle.to_radians()) * std::f64::consts::FRAC_1_PI;
                assert!((value - expected).abs() < 1e-4 * expected + 1e-9, "{angle}: {value} {expected}");
            }
        }
    }

    #[test]
    fn samples_off_the_plane_are_left_out() {
        let grey = [0.2; 3];
        let samples = vec![([0.0, 0.0, 1.0], grey), ([0.6, 0.0, 0.8], grey), ([0.0, 0.6, 0.8], grey)];
        let table = Table::from_scattered(vec![(0.5, samples)]).unwrap();
        let found = points(&Content::Samples(table));
        assert_eq!(found["views"][0]["points"].to_string(), "[[0.0,0.2],[36.87,0.16]]");
    }

    #[test]
    fn an_anisotropic_surface_has_no_one_plane() {
        let content = read("model:ward:alpha_x=0.1,alpha_y=0.4".as_ref()).unwrap().content;
        assert!(points(&content).is_null());
    }
}
