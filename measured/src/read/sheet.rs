//! The quarters of a sheet: of a file of a window, or of samples on both sides.

use super::format::Format;
use super::intake::Intake;
use super::window::Window;
use super::{Conventions, Source, ending, intake, name_of, opened, sha256, window_of};
use crate::analytic;
use crate::file::{MAX_FILE, read_bytes};
use crate::{FitError, ReadError};
use srbf_core::Quarter;
use std::path::{Path, PathBuf};

/// A sheet with all its quarters.
pub struct SheetSource {
    /// The measurement of each, in the order of [`Quarter::ALL`]; `None`: black, not in the file, or the second transmission where both
    /// are [one](Self::is_one_way).
    pub quarters: [Option<Source>; 4],
    /// Name of the file, without its folder; printable.
    pub name: String,
    /// SHA-256 of the file, hexadecimal.
    pub sha256: String,
    origin: Origin,
}

enum Origin {
    /// Patches, whose values are means.
    Window(Window),
    /// A file that is read again where its values have to be lower.
    Samples { file: PathBuf, bytes: Vec<u8>, conventions: Conventions },
}

impl SheetSource {
    /// The patches of a file of a window; `None` of samples.
    pub fn window(&self) -> Option<&Window> {
        match &self.origin {
            Origin::Window(window) => Some(window),
            Origin::Samples { .. } => None,
        }
    }

    /// Whether both transmissions are one measurement, which is that seen from the front: of samples, whose completion is reciprocal.
    pub fn is_one_way(&self) -> bool {
        self.window().is_none()
    }

    /// Samples of this share of the values; `None` of a window, whose values are lowered when it is read.
    ///
    /// # Errors
    /// As [`sheet_of`].
    pub fn dimmed(&self, share: f64) -> Result<Option<Self>, FitError> {
        let Origin::Samples { file, bytes, conventions } = &self.origin else { return Ok(None) };
        let conventions = Conventions { divide: conventions.divide / share, ..*conventions };
        of_samples(file, bytes.clone(), &conventions).map(Some)
    }
}

/// The sheet of a file with all its quarters: of a file of a window, and, `with_samples`, of samples, whose rows in front and behind are told
/// apart. `None` of any other file. [`read_with`](super::read_with) reads one quarter ([`Conventions::quarter`]).
///
/// Transmission is taken as one function of both directions, which light follows either way: samples of both ways are one measurement,
/// and those of one way tell the other.
///
/// # Errors
/// As [`read_with`](super::read_with); samples of one quarter that make no table are an error, and those that are missing are not.
pub fn sheet_of(
    path: &Path,
    conventions: &Conventions,
    with_samples: bool,
) -> Result<Option<SheetSource>, FitError> {
    if path.to_str().is_some_and(|p| p.starts_with(analytic::PREFIX)) {
        return Ok(None);
    }
    let bytes = read_bytes(path, MAX_FILE, |size| ending::check(&ending(path), path, size))?;
    // Whatever is wrong with another file, its reader says.
    let Ok((unpacked, Format::Window)) = opened(path, &bytes) else {
        return with_samples.then(|| of_samples(path, bytes, conventions)).transpose();
    };
    let window = window_of(path, unpacked.as_deref().unwrap_or(&bytes), conventions)?;
    let (name, sha256) = (name_of(path), sha256(&bytes));
    let source = |quarter| {
        let brdf = window.brdf(quarter)?;
        Some(Source::evaluable(Box::new(brdf), name.clone(), sha256.clone()))
    };
    let quarters = Quarter::ALL.map(source);
    Ok(Some(SheetSource { quarters, name, sha256, origin: Origin::Window(window) }))
}

fn of_samples(path: &Path, bytes: Vec<u8>, conventions: &Conventions) -> Result<SheetSource, FitError> {
    let (name, sha256) = (name_of(path), sha256(&bytes));
    let (unpacked, format) = opened(path, &bytes)?;
    let content = unpacked.as_deref().unwrap_or(&bytes);
    let (mut missing, mut is_black) = (None, false);
    let mut found: [Option<Intake>; 4] = [const { None }; 4];
    for quarter in Quarter::ALL {
        match intake(path, content, format, &Conventions { quarter, ..*conventions }) {
            Ok(intake) if intake.is_black => is_black = true,
            Ok(intake) => found[quarter as usize] = Some(intake),
            Err(error @ FitError::Read { source: ReadError::NoSamples(_), .. }) => {
                missing.get_or_insert(error);
            }
            Err(error) => return Err(error),
        }
    }
    if found.iter().all(Option::is_none) {
        let black = || FitError::Read {
            path: path.to_path_buf(),
            source: ReadError::Content(
                "all quarters are black: no value is above 0, or above noise about 0".into(),
            ),
        };
        return Err(missing.filter(|_| !is_black).unwrap_or_else(black));
    }
    let [front, through, back, other_way] = found;
    let (through, other_way) = if through.is_some() { (through, other_way) } else { (other_way, None) };
    let source = |intake: Option<Intake>, other| {
        let of = |intake: Intake| Source::of_samples(intake.of_quarter(other), name.clone(), sha256.clone());
        intake.map(of).transpose()
    };
    let quarters = [source(front, None)?, source(through, other_way)?, source(back, None)?, None];
    let origin = Origin::Samples { file: path.to_path_buf(), bytes, conventions: *conventions };
    Ok(SheetSource { quarters, name, sha256, origin })
}
