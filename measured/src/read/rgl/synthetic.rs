//! A writer of `.bsdf` files tabulated from a microfacet model, for tests: no anisotropic or spectral measurement is at hand.
//!
//! The warp need not be that of the model's own visible normals: any density of the half vectors will do, and the picture then
//! holds what evaluates to the model. It is made from the same definitions as the reader's, in the other direction: a point of
//! the picture goes through the warp to a half vector, found by bisection.

use super::container::Fields;
use super::warp::{Grid, Warp};
use crate::analytic::ggx::Ggx;
use crate::table::Brdf;
use std::f64::consts::{FRAC_PI_2, PI};

/// The content that is written.
pub struct Written {
    /// Azimuths, from -pi on over `range`; one or two for an isotropic file.
    pub phis: usize,
    pub range: f64,
    pub thetas: usize,
    /// Rows and columns of the warps and of the pictures.
    pub warp: usize,
    pub picture: usize,
    pub jacobian: bool,
    /// Wavelengths and a spectrum that the red channel is multiplied by; `None` writes RGB.
    pub spectrum: Option<(Vec<f64>, Vec<f64>)>,
}

impl Default for Written {
    fn default() -> Self {
        Self { phis: 1, range: 0.0, thetas: 9, warp: 32, picture: 32, jacobian: true, spectrum: None }
    }
}

fn from_square(u: [f64; 2], isotropic: bool, phi_o: f64) -> [f64; 3] {
    let phi = (2.0 * u[1] - 1.0) * PI + if isotropic { phi_o } else { 0.0 };
    crate::table::direction(u[0] * u[0] * FRAC_PI_2, phi)
}

/// The fields of a file tabulated from a model.
pub fn fields(model: &Ggx, s: &Written) -> Fields {
    let isotropic = s.phis <= 2;
    let phis: Vec<f64> = match s.phis {
        1 => vec![0.0],
        2 => vec![-PI, PI],
        n => (0..n).map(|i| -PI + s.range * i as f64 / (n - 1) as f64).collect(),
    };
    let thetas: Vec<f64> = (0..s.thetas).map(|i| 1.35 * i as f64 / (s.thetas - 1) as f64).collect();

    // Not those of the model, but smooth, positive, and different along x and y.
    let density = |u: [f64; 2], wo: [f64; 3], phi_o: f64| {
        let h = from_square(u, isotropic, phi_o);
        let visible: f64 = (0..3).map(|k| h[k] * wo[k]).sum::<f64>().max(0.0);
        0.15 + model_normals(model, h) * (0.2 + visible) * u[0]
    };
    let mut ndf = Vec::new();
    for row in 0..64 {
        for column in 0..64 {
            let u = [f64::from(column) / 63.0, f64::from(row) / 63.0];
            ndf.push(0.5 + model_normals(model, from_square(u, false, 0.0)));
        }
    }
    let ndf_grid = Grid::new(ndf.clone(), 64, 64).unwrap();
    // 1.5 to 0.5 over theta, smooth in it as an area is, the same at every azimuth.
    let area = |theta: f64| 1.5 - theta / FRAC_PI_2;
    let column = |c: i32| f64::from(c) / 31.0;
    let sigma: Vec<f64> =
        (0..32).flat_map(|_| (0..32).map(|c| area(FRAC_PI_2 * column(c) * column(c)))).collect();

    let (mut vndf, mut pictures) = (Vec::new(), Vec::new());
    for &phi in &phis {
        for &theta in &thetas {
            let wo = crate::table::direction(theta, phi);
            let n = s.warp;
            let at = |i: usize| i as f64 / (n - 1) as f64;
            let values: Vec<f64> = (0..n * n)
                .map(|i| density([at(i % n), at(i / n)], wo, phi))
                .map(|v| f64::from(v as f32))
                .collect();
            let warp = Warp::new(Grid::new(values.clone(), n, n).unwrap()).unwrap();
            vndf.extend(values);
            let n = s.picture;
            let at = |i: usize| i as f64 / (n - 1) as f64;
            let mut channels = [vec![], vec![], vec![]];
            for i in 0..n * n {
                let u = forward(&warp, [at(i % n), at(i / n)]);
                let h = from_square(u, isotropic, phi);
                let cosine: f64 = (0..3).map(|k| h[k] * wo[k]).sum();
                let mut wi = [0, 1, 2].map(|k| 2.0 * cosine * h[k] - wo[k]);
                // Values below the horizon matter for interpolation only: they continue smoothly.
                wi[2] = wi[2].max(0.02);
                let length = libm::sqrt(wi.iter().map(|v| v * v).sum());
                wi.iter_mut().for_each(|v| *v /= length);
                let scale = if s.jacobian { ndf_grid.value(u) / (4.0 * area(theta)) } else { 1.0 };
                let f = model.evaluate(wi, wo);
                (0..3).for_each(|c| channels[c].push(f[c] * wi[2] / scale));
            }
            match &s.spectrum {
                None => pictures.extend(channels.into_iter().flatten()),
                Some((_, spectrum)) => {
                    pictures.extend(spectrum.iter().flat_map(|v| channels[0].iter().map(move |r| r * v)));
                }
            }
        }
    }
    let mut fields = Fields::default();
    fields.push_bytes("description", b"test");
    fields.push("phi_i", &[phis.len()], &phis);
    fields.push("theta_i", &[thetas.len()], &thetas);
    fields.push("ndf", &[64, 64], &ndf);
    fields.push("sigma", &[32, 32], &sigma);
    fields.push("vndf", &[phis.len(), thetas.len(), s.warp, s.warp], &vndf);
    let shape = |channels| [phis.len(), thetas.len(), channels, s.picture, s.picture];
    match &s.spectrum {
        None => fields.push("rgb", &shape(3), &pictures),
        Some((wavelengths, _)) => {
            fields.push("wavelengths", &[wavelengths.len()], wavelengths);
            fields.push("spectra", &shape(wavelengths.len()), &pictures);
        }
    }
    fields.push_bytes("jacobian", &[u8::from(s.jacobian)]);
    fields
}

/// A file tabulated from a model.
pub fn write(model: &Ggx, settings: &Written) -> Vec<u8> {
    fields(model, settings).encode()
}

/// GGX over the hemisphere, without its constant.
fn model_normals(model: &Ggx, h: [f64; 3]) -> f64 {
    let q = (h[0] / model.alpha[0]).powi(2) + (h[1] / model.alpha[1]).powi(2) + h[2] * h[2];
    1.0 / (q * q)
}

/// Where a warp takes a point: first its row, which the second number alone gives, then the place in it.
fn forward(warp: &Warp, target: [f64; 2]) -> [f64; 2] {
    let bisect = |below: &dyn Fn(f64) -> bool| {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..52 {
            let middle = 0.5 * (low + high);
            if below(middle) { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    };
    let at = |p: [f64; 2]| Warp::invert(&[(warp, 1.0)], p);
    let y = bisect(&|y| at([0.5, y])[1] < target[1]);
    [bisect(&|x| at([x, y])[0] < target[0]), y]
}
