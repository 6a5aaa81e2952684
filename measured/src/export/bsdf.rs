//! Writer of RGL `.bsdf` files in RGB, and where the input has spectra, in these too.
//!
//! A measured file has a warp that spreads visible normals over its pictures. Here the warp is the identity, so that a picture is `f cos`
//! over the half vectors themselves: the square root of their angle from the normal, which is dense where highlights are, and
//! their azimuth. Pictures are square, as most readers ask for. A reader draws by `f cos` times the solid angle of a pixel's incident
//! directions, so that its samples have nearly the same weight.

use super::finite;
use crate::FitError;
use crate::read::Spectra;
use crate::read::rgl::container::Fields;
use crate::table::{Brdf, Symmetry, direction, luminance};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

/// Outgoing directions, from the normal to 87 degrees.
const VIEWS: usize = 59;
const LAST: f64 = 87.0;

/// Half vectors of a picture along the angle from the normal, and along the azimuth, of which the last is the first again.
const SIDE: usize = 128;

/// The same of an anisotropic surface, and azimuths of the outgoing direction over half a turn, both ends among them.
const TURNED_VIEWS: usize = 22;
const TURNED_SIDE: usize = 64;
const AZIMUTHS: usize = 13;

/// Least height of an incident direction: interpolation reaches below the horizon, where values continue smoothly.
const LEAST_HEIGHT: f64 = 1e-3;

/// Writes a BRDF as a `.bsdf` file: `f cos` at 59 outgoing directions by 128 x 128 half vectors; of an anisotropic surface at 22 angles by
/// 13 azimuths over half a turn, and 64 x 64 half vectors. The caller's threads of rayon are used.
///
/// With `spectra`, these of the colours stand beside them: readers take the colours or the spectra, as they need.
///
/// # Errors
/// None so far.
pub fn rgl(brdf: &dyn Brdf, spectra: Option<&Spectra>) -> Result<Vec<u8>, FitError> {
    let is_isotropic = brdf.symmetry() == Symmetry::Isotropic;
    let (views, side) = if is_isotropic { (VIEWS, SIDE) } else { (TURNED_VIEWS, TURNED_SIDE) };
    let thetas: Vec<f64> = (0..views).map(|n| LAST.to_radians() * n as f64 / (views - 1) as f64).collect();
    // Half a turn says the rest where it leaves the surface as it is.
    let (azimuths, range) = match brdf.symmetry() {
        Symmetry::Isotropic => (1, 0.0),
        Symmetry::Quadrant | Symmetry::HalfTurn => (AZIMUTHS, PI),
        Symmetry::None => (2 * AZIMUTHS - 1, 2.0 * PI),
    };
    let first = if is_isotropic { 0.0 } else { -PI };
    let phis: Vec<f64> =
        (0..azimuths).map(|n| first + range * n as f64 / (azimuths - 1).max(1) as f64).collect();
    let at: Vec<(f64, f64)> = phis.iter().flat_map(|phi| thetas.iter().map(|theta| (*phi, *theta))).collect();
    let pictures: Vec<Vec<[f64; 3]>> =
        at.par_iter().map(|&(phi, theta)| picture(brdf, direction(theta, phi), side)).collect();
    let channels = |picture: &Vec<[f64; 3]>| -> Vec<f64> {
        (0..3).flat_map(|c| picture.iter().map(move |rgb| rgb[c])).collect()
    };
    // Density over the picture: times solid angle of incident directions per pixel, `8 pi^2 u sin(h) (h . wo)`.
    let bright = |(picture, &(phi, theta)): (&Vec<[f64; 3]>, &(f64, f64))| -> Vec<f64> {
        let wo = direction(theta, phi);
        let weighed = picture.iter().enumerate().map(|(n, &rgb)| {
            let (along, h) = half(n, side);
            let towards = (h[0] * wo[0] + h[1] * wo[1] + h[2] * wo[2]).max(0.0);
            let below = 2.0 * towards * h[2] - wo[2] <= 0.0;
            let jacobian = along * libm::hypot(h[0], h[1]) * towards;
            if below { 0.0 } else { luminance(rgb).max(0.0) * jacobian }
        });
        weighed.collect()
    };
    let mut fields = Fields::default();
    fields.push_bytes("description", b"written by srbf convert");
    fields.push("phi_i", &[azimuths], &phis);
    fields.push("theta_i", &[views], &thetas);
    fields.push("ndf", &[2, 2], &[1.0; 4]);
    fields.push("sigma", &[2, 2], &[1.0; 4]);
    fields.push("vndf", &[azimuths, views, 2, 2], &vec![1.0; 4 * at.len()]);
    fields.push(
        "luminance",
        &[azimuths, views, side, side],
        &pictures.iter().zip(&at).flat_map(bright).collect::<Vec<_>>(),
    );
    fields.push(
        "rgb",
        &[azimuths, views, 3, side, side],
        &pictures.iter().flat_map(channels).collect::<Vec<_>>(),
    );
    if let Some(spectra) = spectra {
        let count = spectra.wavelengths.len();
        let value = |by: &[f64; 3], rgb: &[f64; 3]| by[0] * rgb[0] + by[1] * rgb[1] + by[2] * rgb[2];
        let values = pictures.iter().flat_map(|picture| {
            spectra.of_rgb.iter().flat_map(move |by| picture.iter().map(move |rgb| value(by, rgb)))
        });
        fields.push("wavelengths", &[count], &spectra.wavelengths);
        fields.push_each("spectra", &[azimuths, views, count, side, side], values);
    }
    // The picture is not to be multiplied by a density of normals.
    fields.push_bytes("jacobian", &[0]);
    Ok(fields.encode())
}

/// A half vector of a picture: place along the angle from the normal, and direction.
fn half(n: usize, side: usize) -> (f64, [f64; 3]) {
    let along = (n % side) as f64 / (side - 1) as f64;
    let turn = (n / side) as f64 / (side - 1) as f64;
    (along, direction(along * along * FRAC_PI_2, (2.0 * turn - 1.0) * PI))
}

/// `f cos` over the half vectors, towards one outgoing direction.
fn picture(brdf: &dyn Brdf, wo: [f64; 3], side: usize) -> Vec<[f64; 3]> {
    let pixel = |n: usize| {
        let (_, h) = half(n, side);
        let twice = 2.0 * (h[0] * wo[0] + h[1] * wo[1] + h[2] * wo[2]);
        let mut wi = [twice * h[0] - wo[0], twice * h[1] - wo[1], (twice * h[2] - wo[2]).max(LEAST_HEIGHT)];
        let length = libm::sqrt(wi[0] * wi[0] + wi[1] * wi[1] + wi[2] * wi[2]);
        wi.iter_mut().for_each(|v| *v /= length);
        finite(brdf.evaluate(wi, wo)).map(|f| f * wi[2])
    };
    (0..side * side).map(pixel).collect()
}
