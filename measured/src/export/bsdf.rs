//! Writer of RGL `.bsdf` files, isotropic ones in RGB, and where the input has spectra, in these too.
//!
//! A measured file has a warp that spreads visible normals over its pictures. Here the warp is the identity, so that a picture is `f cos`
//! over the half vectors themselves: the square root of their angle from the normal, which is dense where highlights are, and
//! their azimuth. Pictures are square, as most readers ask for. A reader draws by `f cos` times the solid angle of a pixel's incident
//! directions, so that its samples have nearly the same weight.

use super::{check_isotropic, finite};
use crate::FitError;
use crate::read::Spectra;
use crate::read::rgl::container::Fields;
use crate::table::{Brdf, direction, luminance};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

/// Outgoing directions, from the normal to 87 degrees.
const VIEWS: usize = 59;
const LAST: f64 = 87.0;

/// Half vectors of a picture along the angle from the normal, and along the azimuth, of which the last is the first again.
const COLUMNS: usize = 128;
const ROWS: usize = 128;

/// Least height of an incident direction: interpolation reaches below the horizon, where values continue smoothly.
const LEAST_HEIGHT: f64 = 1e-3;

/// Writes an isotropic BRDF as a `.bsdf` file: `f cos` at 59 outgoing directions by 128 x 128 half vectors. The caller's threads of rayon are
/// used.
///
/// With `spectra`, these of the colours stand beside them: readers take the colours or the spectra, as they need.
///
/// # Errors
/// [`FitError::Table`] for an anisotropic BRDF.
pub fn rgl(brdf: &dyn Brdf, spectra: Option<&Spectra>) -> Result<Vec<u8>, FitError> {
    check_isotropic(brdf)?;
    let thetas: Vec<f64> = (0..VIEWS).map(|n| LAST.to_radians() * n as f64 / (VIEWS - 1) as f64).collect();
    let pictures: Vec<Vec<[f64; 3]>> = thetas.par_iter().map(|&theta| picture(brdf, theta)).collect();
    let channels = |picture: &Vec<[f64; 3]>| -> Vec<f64> {
        (0..3).flat_map(|c| picture.iter().map(move |rgb| rgb[c])).collect()
    };
    // Density over the picture: times solid angle of incident directions per pixel, `8 pi^2 u sin(h) (h . wo)`.
    let bright = |(picture, &theta): (&Vec<[f64; 3]>, &f64)| -> Vec<f64> {
        let wo = direction(theta, 0.0);
        let weighed = picture.iter().enumerate().map(|(n, &rgb)| {
            let (along, h) = half(n);
            let towards = (h[0] * wo[0] + h[2] * wo[2]).max(0.0);
            let below = 2.0 * towards * h[2] - wo[2] <= 0.0;
            let jacobian = along * libm::hypot(h[0], h[1]) * towards;
            if below { 0.0 } else { luminance(rgb).max(0.0) * jacobian }
        });
        weighed.collect()
    };
    let mut fields = Fields::default();
    fields.push_bytes("description", b"written by srbf convert");
    fields.push("phi_i", &[1], &[0.0]);
    fields.push("theta_i", &[VIEWS], &thetas);
    fields.push("ndf", &[2, 2], &[1.0; 4]);
    fields.push("sigma", &[2, 2], &[1.0; 4]);
    fields.push("vndf", &[1, VIEWS, 2, 2], &[1.0; 4 * VIEWS]);
    fields.push(
        "luminance",
        &[1, VIEWS, ROWS, COLUMNS],
        &pictures.iter().zip(&thetas).flat_map(bright).collect::<Vec<_>>(),
    );
    fields.push(
        "rgb",
        &[1, VIEWS, 3, ROWS, COLUMNS],
        &pictures.iter().flat_map(channels).collect::<Vec<_>>(),
    );
    if let Some(spectra) = spectra {
        let count = spectra.wavelengths.len();
        let value = |by: &[f64; 3], rgb: &[f64; 3]| by[0] * rgb[0] + by[1] * rgb[1] + by[2] * rgb[2];
        let values = pictures.iter().flat_map(|picture| {
            spectra.of_rgb.iter().flat_map(move |by| picture.iter().map(move |rgb| value(by, rgb)))
        });
        fields.push("wavelengths", &[count], &spectra.wavelengths);
        fields.push_each("spectra", &[1, VIEWS, count, ROWS, COLUMNS], values);
    }
    // The picture is not to be multiplied by a density of normals.
    fields.push_bytes("jacobian", &[0]);
    Ok(fields.encode())
}

/// A half vector of a picture: place along the angle from the normal, and direction.
fn half(n: usize) -> (f64, [f64; 3]) {
    let along = (n % COLUMNS) as f64 / (COLUMNS - 1) as f64;
    let turn = (n / COLUMNS) as f64 / (ROWS - 1) as f64;
    (along, direction(along * along * FRAC_PI_2, (2.0 * turn - 1.0) * PI))
}

/// `f cos` over the half vectors, towards one outgoing direction.
fn picture(brdf: &dyn Brdf, theta: f64) -> Vec<[f64; 3]> {
    let wo = direction(theta, 0.0);
    let pixel = |n: usize| {
        let (_, h) = half(n);
        let twice = 2.0 * (h[0] * wo[0] + h[2] * wo[2]);
        let mut wi = [twice * h[0] - wo[0], twice * h[1] - wo[1], (twice * h[2] - wo[2]).max(LEAST_HEIGHT)];
        let length = libm::sqrt(wi[0] * wi[0] + wi[1] * wi[1] + wi[2] * wi[2]);
        wi.iter_mut().for_each(|v| *v /= length);
        finite(brdf.evaluate(wi, wo)).map(|f| f * wi[2])
    };
    (0..COLUMNS * ROWS).map(pixel).collect()
}
