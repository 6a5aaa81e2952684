//! The quarters of a sheet: of a file of a window, or of samples on both sides.

use super::format::Format;
use super::intake::Intake;
use super::window::Window;
use super::{Conventions, Source, ending, intake, name_of, opened, sha256, window_of};
use crate::analytic;
use crate::complete::turned::{Found, Way, complete_sides, complete_turned};
use crate::file::{MAX_FILE, read_bytes};
use crate::isotropy::Isotropy;
use crate::row::Row;
use crate::{FitError, ReadError};
use srbf_core::Quarter;
use std::ops::Range;
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
    Window(Box<Window>),
    /// A file that is read again where its values have to be lower.
    Samples { file: PathBuf, bytes: Vec<u8>, conventions: Box<Conventions> },
}

impl SheetSource {
    /// The patches of a file of a window; `None` of samples.
    pub fn window(&self) -> Option<&Window> {
        match &self.origin {
            Origin::Window(window) => Some(window),
            Origin::Samples { .. } => None,
        }
    }

    /// Whether both transmissions are one measurement, which is that seen from the front: of samples of a sheet whose sides do not differ.
    pub fn is_one_way(&self) -> bool {
        self.window().is_none() && self.quarters[Quarter::BackTransmission as usize].is_none()
    }

    /// Samples of this share of the values; `None` of a window, whose values are lowered when it is read.
    ///
    /// # Errors
    /// As [`sheet_of`].
    pub fn dimmed(&self, share: f64) -> Result<Option<Self>, FitError> {
        let Origin::Samples { file, bytes, conventions } = &self.origin else { return Ok(None) };
        let conventions = Conventions { divide: conventions.divide / share, ..**conventions };
        of_samples(file, bytes.clone(), &conventions).map(Some)
    }
}

/// The sheet of a file with all its quarters: of a file of a window, and, `with_samples`, of samples, whose rows in front and behind are told
/// apart. `None` of any other file. [`read_with`](super::read_with) reads one quarter ([`Conventions::quarter`]).
///
/// Transmission is one function of the directions in front and behind, which light follows either way: samples of both ways are one
/// measurement, and those of one way tell the other. Unless left-out samples tell the sides apart, both directions may change places too.
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
        Some(Source::evaluable(brdf, name.clone(), sha256.clone()))
    };
    let quarters = Quarter::ALL.map(source);
    Ok(Some(SheetSource { quarters, name, sha256, origin: Origin::Window(Box::new(window)) }))
}

/// One transmission by its own samples: that of which light the other way was not measured.
pub(super) fn transmission(
    quarter: Quarter,
    intake: Intake,
    name: &str,
    sha256: &str,
) -> Result<Source, FitError> {
    let ways = if quarter.is_back() { [None, Some(intake)] } else { [Some(intake), None] };
    let [front, back] = transmissions(ways, name, sha256)?;
    let own = if quarter.is_back() { back.or(front) } else { front };
    own.ok_or_else(|| FitError::Table("no samples of the transmission".into()))
}

/// The transmission seen from the front, and from the back, of the samples of both; the latter is `None` where the sides do not differ: then both
/// are one.
fn transmissions(
    [front, back]: [Option<Intake>; 2],
    name: &str,
    sha256: &str,
) -> Result<[Option<Source>; 2], FitError> {
    let mut ways: Vec<Way<'_>> = front.iter().map(|intake| intake.way(false)).collect();
    ways.extend(back.iter().map(|intake| intake.way(true)));
    if ways.is_empty() {
        return Ok([None, None]);
    }
    let rows: Vec<Row> = ways.iter().flat_map(Way::rows).collect();
    let mut isotropy = Isotropy::of(&rows);
    let mut completion = None;
    if let Some(found) = isotropy.filter(Isotropy::is_anisotropic) {
        match complete_turned(&ways, true, found.is_steady())? {
            Found::Anisotropic(found) => completion = Some(*found),
            Found::Isotropic => isotropy = Some(Isotropy { explained: true, ..found }),
        }
    }
    if completion.is_none() {
        completion = complete_sides(&ways)?;
    }
    let first = ways[0].rows.len();
    let (name, sha256) = (name.to_owned(), sha256.to_owned());
    match completion {
        Some(completion) if completion.report.sides => {
            let source = |is_back: bool| {
                let (intake, numbers) = seen_from(is_back, [&front, &back], first)?;
                let mut own = if is_back { completion.reversed() } else { completion.clone() };
                own.report.outliers.retain(|outlier| numbers.contains(&outlier.sample));
                own.report.outliers.iter_mut().for_each(|outlier| outlier.sample -= numbers.start);
                let intake = Intake { isotropy, ..intake };
                Some(Source::completed(own, intake, name.clone(), sha256.clone()))
            };
            Ok([source(false), source(true)])
        }
        found => {
            let intake = match (front, back) {
                (Some(front), back) => front.with(back.map(Intake::exchanged)),
                (None, back) => back.unwrap_or_default().exchanged(),
            };
            let intake = Intake { isotropy, ..intake };
            let source = match found {
                Some(completion) => Source::completed(completion, intake, name, sha256),
                None => Source::even(intake, name, sha256)?,
            };
            Ok([Some(source), None])
        }
    }
}

/// The samples that a transmission is compared with, the viewer on one side, and which ones they are of all: those of which the instrument held
/// the viewer, by an exchange of both directions those of the light.
fn seen_from(
    is_back: bool,
    [front, back]: [&Option<Intake>; 2],
    first: usize,
) -> Option<(Intake, Range<usize>)> {
    let candidate = |intake: &Option<Intake>, of_back: bool| {
        let intake = intake.clone()?;
        let start = if of_back && front.is_some() { first } else { 0 };
        let numbers = start..start + intake.rows.len();
        Some((if of_back == is_back { intake } else { intake.exchanged() }, numbers))
    };
    let [own, other] = if is_back { [(back, true), (front, false)] } else { [(front, false), (back, true)] };
    let all = [candidate(own.0, own.1), candidate(other.0, other.1)];
    let best = all.iter().position(|c| c.as_ref().is_some_and(|(intake, _)| !intake.is_light_fixed));
    let [own, other] = all;
    let (intake, numbers) = if best == Some(1) { other } else { own.or(other) }?;
    Some((Intake { is_light_fixed: false, ..intake }, numbers))
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
    let source = |intake: Option<Intake>| {
        let of = |intake: Intake| Source::of_samples(intake.of_quarter(), name.clone(), sha256.clone());
        intake.map(of).transpose()
    };
    let ways = [through, other_way].map(|intake| intake.map(Intake::of_quarter));
    let [through, other_way] = transmissions(ways, &name, &sha256)?;
    let quarters = [source(front)?, through, source(back)?, other_way];
    let origin = Origin::Samples { file: path.to_path_buf(), bytes, conventions: Box::new(*conventions) };
    Ok(SheetSource { quarters, name, sha256, origin })
}
