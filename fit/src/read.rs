//! Readers: a table, or what can be evaluated anywhere, from a file.

pub mod astm;
pub mod cornell;
pub mod csv;
pub(crate) mod limit;
pub mod merl;
pub mod neural;
mod numbers;
pub mod rgl;
pub(crate) mod rows;
mod rusinkiewicz;
mod spectrum;

use crate::analytic;
use crate::table::{Brdf, MAX_VIEWS, Scattered, Table};
use crate::{FitError, ReadError};
use sha2::{Digest, Sha256};
use std::f64::consts::FRAC_PI_2;
use std::path::Path;

pub use limit::read_at_most;
use limit::{MAX_FILE, read_bytes};

/// What a file holds.
pub enum Content {
    /// Scattered samples.
    Samples(Table),
    /// Values at every pair of directions.
    Evaluable(Box<dyn Brdf + Send>),
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

/// Reads a measured file; the format follows from the end of its name. `model:...` in its place is an [`analytic`] model.
///
/// `.brdf`: see [`cornell`]; `.astm`: [`astm`]; `.csv`: [`csv`]; `.binary`: [`merl`]; `.bsdf`: [`rgl`].
///
/// # Errors
/// [`FitError::Io`]; [`FitError::Read`] with the place of the fault; [`FitError::Table`].
pub fn read(path: &Path) -> Result<Source, FitError> {
    if let Some(text) = path.to_str().and_then(|p| p.strip_prefix(analytic::PREFIX)) {
        let analytic::Named { brdf, name, identity } = analytic::parse(text)?;
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
