//! Curves that tests are made of.

use srbf_reference_renderer::study::comparison::{Curve, Estimate, Point, Shown};

/// A point of no error bars: samples, seconds, and the root of the error.
pub fn point(samples: u32, seconds: f64, rmse: f64) -> Point {
    let mse = Estimate { mean: rmse * rmse, error: 0.0 };
    Point { samples, seconds, mse, whole_mse: mse, is_below_reference: false }
}

/// A curve of points.
pub fn curve(points: Vec<Point>) -> Curve {
    let method = "lobes".parse().expect("a name of a method");
    Curve { method, title: "lobes".into(), points, bias: None, shown: Shown::default() }
}
