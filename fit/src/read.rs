//! Readers: a table, or what can be evaluated anywhere, from a file.

pub mod astm;
pub mod cornell;
pub mod csv;
mod filled;
pub(crate) mod limit;
pub mod merl;
pub mod neural;
mod numbers;
pub mod rgl;
pub(crate) mod rows;
mod rusinkiewicz;
mod scatter;
mod spectrum;

use crate::analytic;
use crate::table::{Brdf, Table};
use crate::{FitError, ReadError};
pub use filled::Filled;
pub(crate) use scatter::Scatter;
use sha2::{Digest, Sha256};
use srbf_core::printable;
use std::path::Path;

use limit::{MAX_FILE, read_bytes};
pub use limit::{check_memory, read_at_most, read_if};

/// Memory that the samples of a text take, over its own: nine numbers of two bytes or more become two samples of 50.
const TEXT: u64 = 6;

/// Refuses a file by its size.
type CheckSize = fn(u64) -> Result<(), ReadError>;

/// What a file holds.
pub enum Content {
    /// Scattered samples.
    Samples(Table),
    /// Values at every pair of directions.
    Evaluable(Box<dyn Brdf + Send>),
}

/// A measurement and the file that it came from.
///
/// # Examples
/// ```
/// use srbf_fit::read::{Content, read};
///
/// let source = read("model:ggx:alpha=0.2,f0=0.9".as_ref())?;
/// let Content::Evaluable(brdf) = source.content else { unreachable!("a model is known everywhere") };
/// assert!(brdf.evaluate([-0.6, 0.0, 0.8], [0.6, 0.0, 0.8])[0] > 1.0);
/// # Ok::<(), srbf_fit::FitError>(())
/// ```
pub struct Source {
    /// The measurement.
    pub content: Content,
    /// Name of the file, without its folder, or of the model; [`printable`].
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
    let fault = |source| FitError::Read { path: path.to_path_buf(), source };
    let scattered = |views| Table::from_scattered(views).map(Content::Samples);
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let (fits, parsed): (CheckSize, u64) = match ending.as_str() {
        "brdf" | "astm" | "csv" => (|_| Ok(()), TEXT),
        "binary" => (merl::check_size, 1),
        "bsdf" => (rgl::check_size, 1),
        _ => {
            let text = "the name has to end in .brdf, .astm, .csv, .binary or .bsdf".to_owned();
            return Err(fault(ReadError::Content(text)));
        }
    };
    let bytes = read_bytes(path, MAX_FILE, fits)?;
    check_memory(parsed * bytes.len() as u64).map_err(FitError::io(path))?;
    let content = match ending.as_str() {
        "brdf" => scattered(cornell::parse(&bytes).map_err(fault)?)?,
        "astm" => scattered(astm::parse(&bytes).map_err(fault)?)?,
        "csv" => scattered(csv::parse(&bytes).map_err(fault)?)?,
        "binary" => Content::Evaluable(filled(merl::parse(&bytes).map_err(fault)?)?),
        _ => Content::Evaluable(Box::new(rgl::parse(&bytes).map_err(fault)?)),
    };
    Ok(Source {
        content,
        name: printable(&path.file_name().unwrap_or_default().to_string_lossy()).to_string(),
        sha256: sha256(&bytes),
    })
}

/// A MERL material with what its holes are filled by, if it has some above the horizon.
fn filled(grid: merl::Merl) -> Result<Box<dyn Brdf + Send>, FitError> {
    if grid.missing() > 0.0 { Ok(Box::new(Filled::new(grid)?)) } else { Ok(Box::new(grid)) }
}

/// The SHA-256 of bytes, hexadecimal.
pub(crate) fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect()
}
