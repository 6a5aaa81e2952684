//! From measurements to the vector of a view: f at the centres of the measured texels.
//!
//! A BRDF that can be evaluated is evaluated there. Scattered samples are interpolated, linear in f over the Delaunay
//! triangles of `table::interpolate`: the vector holds the values that the quadrature weights of the samples integrate. Samples
//! darker than a thousandth of their view's mean count as that, as they do in the albedo.

use super::cube::Cube;
use rayon::prelude::*;
use srbf_fit::FitError;
use srbf_fit::table::Brdf;
use srbf_fit::table::interpolant::Interpolant;
use srbf_fit::table::{Table, View};
use std::f64::consts::FRAC_PI_2;

/// The data of one outgoing direction.
#[derive(Clone, Debug)]
pub(crate) struct Vector {
    /// Angle of the outgoing direction from the normal, radians.
    pub theta: f64,
    /// f at the measured texels, linear sRGB.
    pub values: Vec<[f64; 3]>,
}

/// The vectors of a table's views.
pub(crate) fn from_table(table: &Table, cube: &Cube) -> Vec<Vector> {
    let vector = |view: &View| Vector {
        theta: view.theta,
        values: Interpolant::new(&view.samples).values(&cube.directions),
    };
    table.views.par_iter().map(vector).collect()
}

/// The vectors of a BRDF at angles of the outgoing direction, radians.
pub(crate) fn from_brdf(brdf: &dyn Brdf, thetas: &[f64], cube: &Cube) -> Result<Vec<Vector>, FitError> {
    if let Some(theta) = thetas.iter().find(|t| !(0.0..FRAC_PI_2).contains(*t)) {
        return Err(FitError::Table(format!(
            "view at {} degrees; at least 0 and less than 90",
            theta.to_degrees()
        )));
    }
    let vector = |&theta: &f64| {
        let (sin, cos) = libm::sincos(theta);
        let value = |d: &[f64; 3]| {
            brdf.evaluate(*d, [-sin, 0.0, cos]).map(|v| if v.is_finite() { v.max(0.0) } else { 0.0 })
        };
        Vector { theta, values: cube.directions.iter().map(value).collect() }
    };
    Ok(thetas.par_iter().map(vector).collect())
}
