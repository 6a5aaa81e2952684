//! Reader of RGL `.bsdf` tensor files, RGB (Dupuy and Jakob 2018, "An Adaptive Parameterization for Efficient Material
//! Acquisition and Rendering").
//!
//! The measurement is stored in the unit square that a warp of the visible normals maps to the half vectors: to evaluate, the
//! half vector goes back through the warp, and the colour found there is multiplied by `D / (4 sigma)`. What is
//! stored is `f cos`. Isotropic files only; anisotropic ones, and spectral ones, are refused by name.

mod tensor;
mod warp;

use super::evaluable::Brdf;
use crate::ReadError;
use std::f64::consts::{FRAC_PI_2, PI};
use warp::{Grid, Warp};

/// One RGL material.
#[derive(Clone, Debug)]
pub struct Rgl {
    /// Angles of the measured outgoing directions, radians, rising.
    thetas: Vec<f64>,
    /// Distribution of normals over (theta, phi).
    ndf: Grid,
    /// Projected area of the normals.
    sigma: Grid,
    /// Visible normals, one warp for each angle.
    visible: Vec<Warp>,
    /// Colour, for each angle and channel.
    rgb: Vec<[Grid; 3]>,
    /// Whether the colour is without `D / (4 sigma)`.
    jacobian: bool,
}

/// Parses the bytes of a `.bsdf` file.
///
/// # Errors
/// [`ReadError::Content`], with the field.
pub fn parse(bytes: &[u8]) -> Result<Rgl, ReadError> {
    let file = tensor::parse(bytes)?;
    let fail = |text: &str| Err(ReadError::Content(text.to_owned()));
    if file.find("rgb").is_none() && file.find("spectra").is_some() {
        return fail("a spectral file; only RGB files are read yet");
    }
    let (phi, theta) = (file.numbers("phi_i", 1)?, file.numbers("theta_i", 1)?);
    if phi.values.len() > 2 {
        return fail("an anisotropic file (several phi_i); only isotropic ones are read yet");
    }
    let thetas = theta.values;
    if thetas.windows(2).any(|w| w[1] <= w[0])
        || thetas[0] < 0.0
        || thetas[thetas.len() - 1] > FRAC_PI_2 + 1e-3
    {
        return fail("theta_i has to rise from at least 0 to at most pi / 2");
    }
    let slices = phi.values.len() * thetas.len();
    let grid = |name: &str| {
        let field = file.numbers(name, 2)?;
        Grid::new(field.values, field.shape[1], field.shape[0]).ok_or_else(|| small(name))
    };
    let (ndf, sigma) = (grid("ndf")?, grid("sigma")?);

    let vndf = file.numbers("vndf", 4)?;
    let [rows, columns] = [vndf.shape[2], vndf.shape[3]];
    if vndf.shape[0] * vndf.shape[1] != slices {
        return fail("vndf has another number of slices than phi_i and theta_i");
    }
    // Isotropic: the slices of a second phi_i repeat the first.
    let warp = |values: &[f64]| {
        Grid::new(values.to_vec(), columns, rows).and_then(Warp::new).ok_or_else(|| small("vndf"))
    };
    let slice = |n: usize| &vndf.values[n * rows * columns..(n + 1) * rows * columns];
    let visible = (0..thetas.len()).map(|n| warp(slice(n))).collect::<Result<Vec<_>, _>>()?;

    let colour = file.numbers("rgb", 5)?;
    let [rows, columns] = [colour.shape[3], colour.shape[4]];
    if colour.shape[0] * colour.shape[1] != slices || colour.shape[2] != 3 {
        return fail("rgb has another number of slices than phi_i and theta_i, or not three channels");
    }
    let channel = |n: usize, c: usize| {
        let at = (3 * n + c) * rows * columns;
        Grid::new(colour.values[at..at + rows * columns].to_vec(), columns, rows).ok_or_else(|| small("rgb"))
    };
    let rgb = (0..thetas.len())
        .map(|n| Ok([channel(n, 0)?, channel(n, 1)?, channel(n, 2)?]))
        .collect::<Result<Vec<_>, ReadError>>()?;
    let jacobian = file.find("jacobian").is_none_or(|f| f.bytes.first().is_some_and(|b| *b != 0));
    Ok(Rgl { thetas, ndf, sigma, visible, rgb, jacobian })
}

fn small(name: &str) -> ReadError {
    ReadError::Content(format!("{name}: a grid of at least 2 x 2 numbers, not all of them 0, was expected"))
}

impl Rgl {
    /// `f cos` of the incident direction, and not clamped: what the file holds.
    pub fn f_cos(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let mut h = [wi[0] + wo[0], wi[1] + wo[1], wi[2] + wo[2]];
        let length = libm::sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
        h.iter_mut().for_each(|v| *v /= length);
        let angles = |d: [f64; 3]| (libm::atan2(libm::hypot(d[0], d[1]), d[2]), libm::atan2(d[1], d[0]));
        let ((theta_o, phi_o), (theta_m, phi_m)) = (angles(wo), angles(h));
        let turn = |phi: f64| {
            let u = (phi + PI) / (2.0 * PI);
            u - libm::floor(u)
        };
        let square = |theta: f64| libm::sqrt(theta / FRAC_PI_2);
        let normal = [square(theta_m), turn(phi_m - phi_o)];

        // The two measured angles round the outgoing one.
        let last = self.thetas.len() - 1;
        let after = self.thetas.partition_point(|&t| t <= theta_o).clamp(last.min(1), last);
        let before = after.saturating_sub(1);
        let step = self.thetas[after] - self.thetas[before];
        let blend = if step > 0.0 { ((theta_o - self.thetas[before]) / step).clamp(0.0, 1.0) } else { 0.0 };

        let sample = Warp::invert([&self.visible[before], &self.visible[after]], blend, normal);
        let scale = if self.jacobian {
            self.ndf.value(normal) / (4.0 * self.sigma.value([square(theta_o), turn(phi_o)]))
        } else {
            1.0
        };
        [0, 1, 2].map(|c| {
            let (a, b) = (self.rgb[before][c].value(sample), self.rgb[after][c].value(sample));
            scale * (a + blend * (b - a))
        })
    }
}

impl Brdf for Rgl {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        self.f_cos(wi, wo).map(|v| v / wi[2])
    }
}
