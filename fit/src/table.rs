//! A table: samples of a BRDF, whatever the file format, in the frame of each view.
//!
//! Frame: +z the normal, outgoing direction `(-sin theta, 0, cos theta)`, mirror direction `(sin theta, 0, cos theta)`.
//! The materials are isotropic, so every sample is mirrored to y >= 0: a sample and its mirror image are one.

pub mod cornell;
pub mod evaluable;
mod interpolate;
pub mod neural;
mod numbers;
mod spectrum;

use crate::FitError;
use sha2::{Digest, Sha256};
use std::f64::consts::FRAC_PI_2;
use std::path::Path;

/// Largest file that is read, bytes: the largest measured files are a tenth of it.
const MAX_FILE: u64 = 1 << 30;

/// Most views that a table may have.
pub const MAX_VIEWS: usize = 1024;

/// One value of the BRDF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Incident direction, unit vector in the frame of the view, y >= 0, z > 0.
    pub direction: [f64; 3],
    /// The BRDF f, linear sRGB, not negative; 1/sr.
    pub rgb: [f64; 3],
    /// Quadrature weight over the hemisphere, such that the sum of `weight f cos` is an albedo; sr.
    pub weight: f64,
}

/// The samples for one outgoing direction.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Angle of the outgoing direction from the normal, radians, [0, pi / 2).
    pub theta: f64,
    /// The samples.
    pub samples: Vec<Sample>,
    /// Directional albedo, linear sRGB: what the lobes' energy is held to.
    pub albedo: [f64; 3],
}

/// Samples of an isotropic BRDF for a number of outgoing directions.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The views, theta rising.
    pub views: Vec<View>,
}

/// A table and the file that it came from.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// The samples.
    pub table: Table,
    /// Name of the file, without its folder.
    pub name: String,
    /// SHA-256 of the file, hexadecimal.
    pub sha256: String,
}

/// Reads a measured file; the format follows from the end of its name. `.brdf`: see [`cornell`].
///
/// # Errors
/// [`FitError::Io`]; [`FitError::Read`] with the place of the fault; [`FitError::Table`].
pub fn read(path: &Path) -> Result<Source, FitError> {
    let size = std::fs::metadata(path).map_err(FitError::io(path))?.len();
    if size > MAX_FILE {
        return Err(FitError::Table(format!(
            "{}: {size} bytes; at most {MAX_FILE} are read",
            path.display()
        )));
    }
    let bytes = std::fs::read(path).map_err(FitError::io(path))?;
    let views =
        cornell::parse(&bytes).map_err(|source| FitError::Read { path: path.to_path_buf(), source })?;
    Ok(Source {
        table: Table::from_scattered(views)?,
        name: path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        sha256: Sha256::digest(&bytes).iter().map(|b| format!("{b:02x}")).collect(),
    })
}

/// Samples of one view before they have weights: incident direction and f.
pub type Scattered = Vec<([f64; 3], [f64; 3])>;

impl Table {
    /// Makes a table of scattered samples: mirrors them, weighs them, and integrates the albedo of each view.
    ///
    /// See [`interpolate`](self#) for both; an albedo is held to at most `ALBEDO_LIMIT`.
    ///
    /// # Errors
    /// [`FitError::Table`] for no view, too many, angles outside [0, pi / 2), views without a sample above the
    /// horizon, and numbers that are not finite.
    pub fn from_scattered(views: Vec<(f64, Scattered)>) -> Result<Self, FitError> {
        let fail = |text: String| Err(FitError::Table(text));
        if views.is_empty() || views.len() > MAX_VIEWS {
            return fail(format!("{} views; from 1 to {MAX_VIEWS} are possible", views.len()));
        }
        let mut made: Vec<View> = Vec::with_capacity(views.len());
        for (theta, scattered) in views {
            let degrees = theta.to_degrees();
            if !(0.0..FRAC_PI_2).contains(&theta) {
                return fail(format!("view at {degrees} degrees; at least 0 and less than 90 are possible"));
            }
            let mut samples = Vec::with_capacity(scattered.len());
            for (n, (d, rgb)) in scattered.into_iter().enumerate() {
                let length = libm::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
                if !(length.is_finite() && length > 0.5 && rgb.iter().all(|v| v.is_finite())) {
                    return fail(format!(
                        "view at {degrees:.2} degrees, sample {n}: {d:?} -> {rgb:?} is not finite"
                    ));
                }
                // A sample at the horizon says nothing of f cos.
                if d[2] > 1e-6 * length {
                    let direction = [d[0] / length, (d[1] / length).abs(), d[2] / length];
                    samples.push(Sample { direction, rgb: rgb.map(|v| v.max(0.0)), weight: 0.0 });
                }
            }
            if samples.is_empty() {
                return fail(format!("view at {degrees:.2} degrees: no sample above the horizon"));
            }
            let albedo = interpolate::weigh(&mut samples);
            made.push(View { theta, samples, albedo });
        }
        made.sort_by(|a, b| a.theta.total_cmp(&b.theta));
        Ok(Self { views: made })
    }
}

/// Unit vector at an angle from the normal and an azimuth from the mirror direction's.
pub(crate) fn direction(theta: f64, azimuth: f64) -> [f64; 3] {
    let (st, ct) = libm::sincos(theta);
    let (sp, cp) = libm::sincos(azimuth);
    [st * cp, st * sp, ct]
}
