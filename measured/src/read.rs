//! Readers: samples, or a BRDF, from a file.
//!
//! May import: `analytic`, `complete`, `error`, `file`, `isotropy`, `numeric`, `patches`, `reciprocity`, `row`, `table`.

pub mod alta;
pub mod astm;
mod chosen;
mod conventions;
pub mod cornell;
pub mod csv;
mod ending;
mod filled;
mod format;
pub mod fred;
mod gzip;
pub mod illuminants;
pub(crate) mod intake;
pub mod merl;
mod model;
pub mod neural;
mod numbers;
pub mod numpy;
mod of_brdf;
pub mod openmaterial;
pub mod pab_opto;
mod reason;
pub mod records;
pub mod rgl;
mod rusinkiewicz;
pub(crate) mod scatter;
pub mod scatter_tables;
mod sentinels;
mod sheet;
mod spectra;
mod spectrum;
pub mod speos;
pub mod ssdd;
pub mod utia;
mod wavelengths;
pub mod window;
mod words;

use crate::analytic;
use crate::complete::turned::{Found, complete_turned};
use crate::complete::{Completion, CompletionReport};
use crate::file::{MAX_FILE, read_bytes};
use crate::isotropy::Isotropy;
use crate::table::{Brdf, Table};
use crate::{FitError, ReadError};
pub use filled::Filled;
use format::Format;
use sha2::{Digest, Sha256};
use srbf_core::printable;
use std::path::Path;

pub use crate::file::spectrum::SpectralCurve;
pub use crate::file::{check_memory, read_at_most, read_if};
pub use crate::row::Row;
pub use chosen::ChosenWavelengths;
pub use conventions::{Angles, Conventions, Mirror, Values};
pub use intake::{Intake, LeftOut, Note};
pub use reason::Reason;
pub use sheet::{SheetSource, sheet_of};
pub use spectra::{BandError, Spectra, SpectralErrors, SpectralSample};

/// Memory that the samples of a text take, over its own: nine numbers of two bytes or more become two samples of 50, and stay with their
/// lines.
const TEXT: u64 = 16;

/// The content of a file.
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
/// use srbf_measured::read::{Content, read};
///
/// let source = read("model:ggx:alpha=0.2,f0=0.9".as_ref())?;
/// let Content::Evaluable(brdf) = source.content else { unreachable!("a model is known everywhere") };
/// assert!(brdf.evaluate([-0.6, 0.0, 0.8], [0.6, 0.0, 0.8])[0] > 1.0);
/// # Ok::<(), srbf_measured::FitError>(())
/// ```
pub struct Source {
    /// The measurement.
    pub content: Content,
    /// Name of the file, without its folder, or of the model; [`printable`].
    pub name: String,
    /// SHA-256 of the file, hexadecimal; of a model, that of its name and parameters.
    pub sha256: String,
    /// Samples as they stand in the file, and rows that were left out. `None` for a BRDF.
    pub intake: Option<Intake>,
    /// The quality of the completion, if the BRDF is one of samples: of a surface that a turn changes, or of a sheet whose sides differ.
    pub completion: Option<CompletionReport>,
    /// The spectra of the colours of a BRDF.
    of_brdf: Option<Spectra>,
}

impl Source {
    /// A BRDF.
    pub fn evaluable(brdf: Box<dyn Brdf + Send>, name: String, sha256: String) -> Self {
        Self {
            content: Content::Evaluable(brdf),
            name,
            sha256,
            intake: None,
            of_brdf: None,
            completion: None,
        }
    }

    /// The same with spectra of its colours.
    #[must_use]
    pub fn with_spectra(self, spectra: Option<Spectra>) -> Self {
        Self { of_brdf: spectra, ..self }
    }

    /// The spectra of its samples, if each of these has kept its own.
    pub fn own_spectra(&self) -> Option<&Spectra> {
        let intake = self.intake.as_ref()?;
        intake.spectra.as_ref().filter(|spectra| spectra.samples.len() == intake.rows.len())
    }

    /// The spectra of its colours, if it has some.
    pub fn spectra(&self) -> Option<&Spectra> {
        self.of_brdf.as_ref().or_else(|| self.intake.as_ref()?.spectra.as_ref())
    }

    /// Samples that were completed.
    fn completed(completion: Completion, intake: Intake, name: String, sha256: String) -> Self {
        let (report, intake) = (Some(completion.report.clone()), Some(intake));
        let content = Content::Evaluable(Box::new(completion));
        Self { content, name, sha256, intake, of_brdf: None, completion: report }
    }

    /// Samples. Those of a surface that a turn changes are completed at once, and are a BRDF from then on; so is light through a sheet whose
    /// sides differ ([`sheet_of`]).
    ///
    /// # Errors
    /// [`FitError::Table`] for samples that make no table.
    pub fn of_samples(intake: Intake, name: String, sha256: String) -> Result<Self, FitError> {
        let mut intake = Intake { isotropy: Isotropy::of(&intake.rows), ..intake };
        if let Some(found) = intake.isotropy.filter(Isotropy::is_anisotropic) {
            if let Found::Anisotropic(completion) =
                complete_turned(&[intake.way(false)], false, found.is_steady())?
            {
                return Ok(Self::completed(*completion, intake, name, sha256));
            }
            intake.isotropy = Some(Isotropy { explained: true, ..found });
        }
        Self::even(intake, name, sha256)
    }

    /// Samples of a surface that no turn changes.
    fn even(intake: Intake, name: String, sha256: String) -> Result<Self, FitError> {
        let content = Content::Samples(Table::from_scattered(intake.views())?);
        Ok(Self { content, name, sha256, intake: Some(intake), of_brdf: None, completion: None })
    }
}

/// Reads a measured file; the format follows from its first bytes, not from its name. `model:...` in its place is an
/// [`analytic`] model.
///
/// Tables of text: [`csv`]; Cornell's: [`cornell`], [`astm`]; MERL's: [`merl`]; RGL's: [`rgl`]; of optics programs: [`scatter_tables`]
/// (Zemax, LightTools), [`speos`], [`fred`], [`openmaterial`], [`alta`], [`pab_opto`], [`ssdd`], [`utia`], [`window`]; of programs: [`numpy`],
/// [`records`]. A file that gzip compressed is opened.
///
/// # Errors
/// [`FitError::Io`]; [`FitError::Read`] with the place of the fault; [`FitError::Table`].
pub fn read(path: &Path) -> Result<Source, FitError> {
    read_with(path, &Conventions::default())
}

/// [`read()`] of a file of which one knows more than stands in it.
///
/// # Errors
/// As `read`; conventions for a file that has no samples are an error.
pub fn read_with(path: &Path, conventions: &Conventions) -> Result<Source, FitError> {
    check_conventions(path, conventions)?;
    if let Some(text) = path.to_str().and_then(|p| p.strip_prefix(analytic::PREFIX)) {
        if *conventions != Conventions::default() {
            return Err(needless(path));
        }
        return model::read(text);
    }
    let bytes = read_bytes(path, MAX_FILE, |size| ending::check(&ending(path), path, size))?;
    of_bytes(path, &bytes, conventions)
}

/// [`read_with`] of the bytes of a file, where no file can be opened: in a browser. `name` is the file's, of which the ending counts.
///
/// # Errors
/// As `read_with`.
pub fn read_from(name: &str, bytes: &[u8], conventions: &Conventions) -> Result<Source, FitError> {
    let path = Path::new(name);
    check_conventions(path, conventions)?;
    of_bytes(path, bytes, conventions)
}

/// The end of a file's name in lower case, but for `.gz`.
fn ending(path: &Path) -> String {
    let is_packed = path.extension().is_some_and(|end| end.eq_ignore_ascii_case("gz"));
    let path = if is_packed { Path::new(path.file_stem().unwrap_or_default()) } else { path };
    path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase()
}

/// Refuses conventions that are out of range.
fn check_conventions(path: &Path, conventions: &Conventions) -> Result<(), FitError> {
    let fault = |text| FitError::Read { path: path.to_path_buf(), source: ReadError::Content(text) };
    conventions.check().map_err(fault)
}

/// The error of conventions that a file leaves no room for.
fn needless(path: &Path) -> FitError {
    let text = "conventions of angles, mirror, values and units are for samples; this file states its own";
    FitError::Read { path: path.to_path_buf(), source: ReadError::Content(text.into()) }
}

/// The measurement in the bytes of a file; `path` is for its name, its ending and messages.
fn of_bytes(path: &Path, bytes: &[u8], conventions: &Conventions) -> Result<Source, FitError> {
    let fault = |source| FitError::Read { path: path.to_path_buf(), source };
    let sha256 = sha256(bytes);
    let (unpacked, format) = opened(path, bytes)?;
    let bytes = unpacked.as_deref().unwrap_or(bytes);
    let name = name_of(path);
    match format {
        Format::Merl | Format::Rgl if *conventions != Conventions::default() => Err(needless(path)),
        Format::Merl => {
            let grid = merl::parse(bytes).map_err(fault)?;
            Ok(Source::evaluable(filled(grid)?, name, sha256))
        }
        Format::Rgl => {
            let file = rgl::parse(bytes).map_err(fault)?;
            let spectra = file.spectra().cloned();
            let brdf: Box<dyn Brdf + Send> =
                if file.has_holes() { Box::new(Filled::of_rgl(file)?) } else { Box::new(file) };
            Ok(Source::evaluable(brdf, name, sha256).with_spectra(spectra))
        }
        Format::Window => {
            let window = window_of(path, bytes, conventions)?;
            let quarter = conventions.quarter;
            let words = window::words(quarter);
            let black = || format!("nothing is seen there: the {words} is black, or not in the file");
            let brdf = window.brdf(quarter).ok_or_else(|| fault(ReadError::Content(black())))?;
            Ok(Source::evaluable(brdf, name, sha256))
        }
        format => {
            let intake = intake(path, bytes, format, conventions)?;
            if conventions.quarter.is_transmission() && !intake.is_black {
                return sheet::transmission(conventions.quarter, intake, &name, &sha256);
            }
            Source::of_samples(intake, name, sha256)
        }
    }
}

/// The samples of a file.
fn intake(path: &Path, bytes: &[u8], format: Format, conventions: &Conventions) -> Result<Intake, FitError> {
    let fault = |source| FitError::Read { path: path.to_path_buf(), source };
    if !conventions.band.is_visible() {
        let text = "a band of the spectrum is one of a file of a window; --wavelengths chooses of spectra";
        return Err(fault(ReadError::Content(text.into())));
    }
    match format {
        Format::Merl | Format::Rgl | Format::Window => return Err(needless(path)),
        Format::Cornell => cornell::parse(bytes, conventions),
        Format::Astm => astm::parse(bytes, conventions),
        Format::Zemax => scatter_tables::zemax(bytes, conventions),
        Format::LightTools => scatter_tables::lighttools(bytes, conventions),
        Format::OpenMaterial => openmaterial::parse(bytes, conventions),
        Format::Alta => alta::parse(bytes, conventions),
        Format::SpeosAnisotropic => speos::anisotropic(bytes, conventions),
        Format::SpeosSpectral => speos::spectral(bytes, conventions),
        Format::PabOpto => pab_opto::parse(bytes, conventions),
        Format::Ssdd => ssdd::parse(bytes, conventions),
        Format::Fred => fred::parse(bytes, conventions),
        Format::NumPy => numpy::parse(bytes, conventions),
        Format::Utia => utia::parse(bytes, conventions),
        Format::Records => records::parse(bytes, conventions),
        Format::Text => csv::parse(bytes, conventions),
    }
    .map_err(fault)
}

/// The bytes of a file that gzip compressed, and the format; refuses what takes more memory than there is.
fn opened(path: &Path, bytes: &[u8]) -> Result<(Option<Vec<u8>>, Format), FitError> {
    let unpacked = bytes.starts_with(gzip::HEAD).then(|| gzip::unpacked(bytes)).transpose();
    let unpacked = unpacked.map_err(FitError::io(path))?;
    let content = unpacked.as_deref().unwrap_or(bytes);
    let format = format::recognise(content, &ending(path));
    let format = format.map_err(|source| FitError::Read { path: path.to_path_buf(), source })?;
    let growth = if matches!(format, Format::Merl | Format::Rgl) { 1 } else { TEXT };
    check_memory(growth * content.len() as u64).map_err(FitError::io(path))?;
    Ok((unpacked, format))
}

/// The quarters of a file of a window.
fn window_of(path: &Path, bytes: &[u8], conventions: &Conventions) -> Result<window::Window, FitError> {
    let Conventions { quarter, band, .. } = *conventions;
    if *conventions != (Conventions { quarter, band, ..Conventions::default() }) {
        return Err(needless(path));
    }
    let fault = |source| FitError::Read { path: path.to_path_buf(), source };
    window::Window::parse(bytes, band).map_err(fault)
}

/// The name of a file, without its folder.
fn name_of(path: &Path) -> String {
    printable(&path.file_name().unwrap_or_default().to_string_lossy()).to_string()
}

/// A MERL material with what its holes are filled by, if it has some above the horizon.
fn filled(grid: merl::Merl) -> Result<Box<dyn Brdf + Send>, FitError> {
    if grid.missing() > 0.0 { Ok(Box::new(Filled::new(grid)?)) } else { Ok(Box::new(grid)) }
}

/// The SHA-256 of bytes, hexadecimal.
#[doc(hidden)]
pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect()
}
