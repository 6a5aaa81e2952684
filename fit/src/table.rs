//! A table: samples of a BRDF, whatever the file format, in the frame of each view.
//!
//! Frame: +z the normal, outgoing direction `(-sin theta, 0, cos theta)`, mirror direction `(sin theta, 0, cos theta)`.
//! The materials are isotropic, so every sample is mirrored to y >= 0: a sample and its mirror image are one.

pub mod astm;
pub mod cornell;
pub mod csv;
pub mod evaluable;
pub(crate) mod interpolate;
pub mod merl;
pub mod model;
pub mod neural;
mod numbers;
pub mod rgl;
pub(crate) mod rows;
mod rusinkiewicz;
mod spectrum;

use crate::{FitError, ReadError};
use sha2::{Digest, Sha256};
use std::f64::consts::FRAC_PI_2;
use std::path::Path;

/// Largest albedo that is believed: no surface reflects more than it receives.
const ALBEDO_LIMIT: f64 = 0.95;

/// Largest file that is read, bytes: the largest measured files are a tenth of it.
const MAX_FILE: u64 = 1 << 30;

/// Brightest f of a table that lobes can be fitted to, 1/sr: the least amplitude that is stored is a thousandth of it in all lobes.
pub(crate) const DARKEST: f64 = 1e-15;

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
    /// The same as the samples have it, which may be more than the 0.95 that lobes are held to.
    pub uncut_albedo: [f64; 3],
}

/// Samples of an isotropic BRDF for a number of outgoing directions.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The views, theta rising.
    pub views: Vec<View>,
}

/// What a file holds.
pub enum Content {
    /// Scattered samples.
    Samples(Table),
    /// Values at every pair of directions.
    Evaluable(Box<dyn evaluable::Brdf + Send>),
}

/// A measurement and the file that it came from.
pub struct Source {
    /// The measurement.
    pub content: Content,
    /// Name of the file, without its folder, or of the model.
    pub name: String,
    /// SHA-256 of the file, hexadecimal; of a model, that of its name and parameters.
    pub sha256: String,
}

/// Reads a measured file; the format follows from the end of its name. `model:...` in its place is an analytic [`model`].
///
/// `.brdf`: see [`cornell`]; `.astm`: [`astm`]; `.csv`: [`csv`]; `.binary`: [`merl`]; `.bsdf`: [`rgl`].
///
/// # Errors
/// [`FitError::Io`]; [`FitError::Read`] with the place of the fault; [`FitError::Table`].
pub fn read(path: &Path) -> Result<Source, FitError> {
    if let Some(text) = path.to_str().and_then(|p| p.strip_prefix(model::PREFIX)) {
        let model::Named { brdf, name, identity } = model::parse(text)?;
        return Ok(Source { content: Content::Evaluable(brdf), name, sha256: sha256(&identity) });
    }
    let bytes = read_bytes(path, MAX_FILE)?;
    let fault = |source| FitError::Read { path: path.to_path_buf(), source };
    let scattered = |views| Table::from_scattered(views).map(Content::Samples);
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let content = match ending.as_str() {
        "brdf" => scattered(cornell::parse(&bytes).map_err(fault)?)?,
        "astm" => scattered(astm::parse(&bytes).map_err(fault)?)?,
        "csv" => scattered(csv::parse(&bytes).map_err(fault)?)?,
        "binary" => Content::Evaluable(Box::new(merl::parse(&bytes).map_err(fault)?)),
        "bsdf" => Content::Evaluable(Box::new(rgl::parse(&bytes).map_err(fault)?)),
        _ => {
            let text = "the name has to end in .brdf, .astm, .csv, .binary or .bsdf".to_owned();
            return Err(fault(ReadError::Content(text)));
        }
    };
    Ok(Source {
        content,
        name: path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        sha256: sha256(&bytes),
    })
}

/// The SHA-256 of bytes, hexadecimal.
pub(crate) fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect()
}

/// The bytes of a file that has at most so many.
pub(crate) fn read_bytes(path: &Path, most: u64) -> Result<Vec<u8>, FitError> {
    crate::read_at_most(path, most).map_err(FitError::io(path))
}

/// Refuses what has no brightness.
pub(crate) fn check_bright(is_bright: bool) -> Result<(), FitError> {
    if is_bright { Ok(()) } else { Err(FitError::Table("no sample has any brightness".into())) }
}

/// Refuses samples that are black, or darker than lobes can be.
pub(crate) fn check_storable<'a>(samples: impl Iterator<Item = &'a Sample>) -> Result<(), FitError> {
    let brightest = samples.flat_map(|s| s.rgb).fold(0.0, f64::max);
    check_bright(brightest > 0.0)?;
    if brightest < DARKEST {
        return Err(FitError::Table(format!(
            "the largest f is {brightest:e} / sr; lobes can be stored from {DARKEST:e} / sr on"
        )));
    }
    Ok(())
}

/// Samples grouped by the angle of the outgoing direction.
#[derive(Debug, Default)]
pub(crate) struct Scatter {
    views: Vec<(f64, Scattered)>,
}

/// Angles of the outgoing direction closer than this are one view, radians; files print six decimals.
const SAME_VIEW: f64 = 1e-3;

impl Scatter {
    /// Adds a sample: angle of the outgoing direction, incident direction in the frame of the view and its angle from the
    /// normal, f. The error says what is out of range.
    pub fn push(&mut self, theta: f64, wi: [f64; 3], theta_i: f64, rgb: [f64; 3]) -> Result<(), String> {
        if !(0.0..FRAC_PI_2).contains(&theta) {
            return Err(format!(
                "outgoing direction {theta} radians from the normal; at least 0, less than pi / 2"
            ));
        }
        if !(0.0..=FRAC_PI_2 + 1e-5).contains(&theta_i) {
            return Err(format!("incident direction {theta_i} radians from the normal; from 0 to pi / 2"));
        }
        match self.views.iter().position(|(t, _)| (*t - theta).abs() < SAME_VIEW) {
            Some(view) => self.views[view].1.push((wi, rgb)),
            None if self.views.len() == MAX_VIEWS => return Err(format!("more than {MAX_VIEWS} views")),
            None => self.views.push((theta, vec![(wi, rgb)])),
        }
        Ok(())
    }

    /// The views, theta rising.
    pub fn finish(mut self) -> Result<Vec<(f64, Scattered)>, ReadError> {
        if self.views.is_empty() {
            return Err(ReadError::Content("no samples".into()));
        }
        self.views.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(self.views)
    }
}

/// Samples of one view before they have weights: incident direction and f.
pub type Scattered = Vec<([f64; 3], [f64; 3])>;

impl Table {
    /// Makes a table of scattered samples: mirrors them, weighs them, and integrates the albedo of each view.
    ///
    /// The weights integrate linearly between samples, the albedo its logarithm, and is held to at most 0.95: see the source of
    /// `interpolate`.
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
            let uncut_albedo = interpolate::weigh(&mut samples);
            let albedo = uncut_albedo.map(|a| a.min(ALBEDO_LIMIT));
            made.push(View { theta, samples, albedo, uncut_albedo });
        }
        made.sort_by(|a, b| a.theta.total_cmp(&b.theta));
        Ok(Self { views: made })
    }
}

impl Table {
    /// Every n-th sample of each view, such that about `count` are left; all, if there are no more.
    pub(crate) fn thinned(&self, count: usize) -> Self {
        let total: usize = self.views.iter().map(|v| v.samples.len()).sum();
        let every = total.div_ceil(count.max(1)).max(1);
        let thin = |view: &View| {
            let mut samples: Vec<Sample> = view.samples.iter().step_by(every).copied().collect();
            let sum = |s: &[Sample]| s.iter().map(|s| s.weight).sum::<f64>();
            let share = sum(&view.samples) / sum(&samples);
            samples.iter_mut().for_each(|s| s.weight *= share);
            View { samples, ..*view }
        };
        Self { views: self.views.iter().map(thin).collect() }
    }
}

/// Unit vector at an angle from the normal and an azimuth from the mirror direction's.
pub(crate) fn direction(theta: f64, azimuth: f64) -> [f64; 3] {
    let (st, ct) = libm::sincos(theta);
    let (sp, cp) = libm::sincos(azimuth);
    [st * cp, st * sp, ct]
}
