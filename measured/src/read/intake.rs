//! The result of a reader: samples, each with its line, and rows without a measurement, counted by reason.
//!
//! *Not measured* is one notion from here on. A cell that is empty or no number; a value that stands for nothing (-1, -999); an
//! exact 0 where all others are far from it; a direction at the horizon or behind the surface: none becomes a sample, none becomes
//! 0. Rows that are left out are counted and listed by line.

use super::conventions::{Conventions, Mirror, Values};
use super::reason::Reason;
use super::scatter;
use super::sentinels::{Cells, Sentinels};
use super::spectra::{Spectra, SpectralSamples};
use super::wavelengths::Wavelengths;
use crate::ReadError;
use crate::isotropy::Isotropy;
use crate::row::Row;
use crate::table::Scattered;

/// Cosine below which a direction is at the horizon: there no BRDF can be measured.
const HORIZON: f64 = 1e-5;

/// Most listed lines of rows that are left out.
const LISTED: usize = 8;

/// Rows that are left out for one reason.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOut {
    /// Why.
    pub reason: Reason,
    /// How many.
    pub count: usize,
    /// Lines of the first of them.
    pub lines: Vec<usize>,
}

/// Something that was taken for granted, or found out.
#[derive(Clone, Debug, PartialEq)]
pub struct Note {
    /// A sentence.
    pub text: String,
    /// The option of the command line that reads it otherwise.
    pub option: Option<&'static str>,
}

/// Samples as a file has them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Intake {
    /// Name of the format.
    pub format: &'static str,
    /// The samples.
    pub rows: Vec<Row>,
    /// Rows that are no samples.
    pub left_out: Vec<LeftOut>,
    /// Assumptions.
    pub notes: Vec<Note>,
    /// Reflectance that the file itself states: angle of incidence, degrees, and share of the light.
    pub stated: Vec<(f64, f64)>,
    /// Whether the incident directions are the views, by reciprocity.
    pub is_light_fixed: bool,
    /// The result of a turn of the sample; `None` where it was not turned.
    pub isotropy: Option<Isotropy>,
    /// The spectra of its colours, if it has some.
    pub spectra: Option<Spectra>,
}

/// Samples on their way.
pub(crate) struct Reading {
    intake: Intake,
    conventions: Conventions,
    cells: Vec<Cells>,
    spectra: Option<SpectralSamples>,
    /// The quotient of a value and a number of a spectrum.
    share: f64,
    has_wavelengths: bool,
}

impl Reading {
    pub fn new(format: &'static str, conventions: &Conventions) -> Self {
        let mut conventions = *conventions;
        let mut intake = Intake { format, ..Intake::default() };
        if conventions.divide != 1.0 {
            intake
                .notes
                .push(Note { text: format!("values are divided by {}", conventions.divide), option: None });
        }
        conventions.mirror.get_or_insert(Mirror::Opposite);
        Self { intake, conventions, cells: Vec::new(), spectra: None, share: 1.0, has_wavelengths: false }
    }

    /// The kind of values in the format, where the caller does not state it.
    pub fn values_are(&mut self, values: Values) {
        self.conventions.values.get_or_insert(values);
    }

    /// States that the numbers of each row are a spectrum, and says how it is used; gives the wavelengths that are. A value is `share` of
    /// such a number.
    ///
    /// # Errors
    /// [`ReadError`] where none of them is chosen.
    pub fn wavelengths_are(
        &mut self,
        wavelengths: Wavelengths,
        share: f64,
    ) -> Result<Wavelengths, ReadError> {
        let wavelengths = wavelengths.chosen(self.conventions.wavelengths)?;
        if let Some(note) = &wavelengths.note {
            self.note(note.clone());
        }
        (self.spectra, self.share, self.has_wavelengths) = (wavelengths.samples(), share, true);
        Ok(wavelengths)
    }

    pub fn note(&mut self, text: impl Into<String>) {
        self.intake.notes.push(Note { text: text.into(), option: None });
    }

    pub fn note_option(&mut self, text: impl Into<String>, option: &'static str) {
        self.intake.notes.push(Note { text: text.into(), option: Some(option) });
    }

    pub fn state(&mut self, degrees: f64, reflectance: f64) {
        self.intake.stated.push((degrees, reflectance));
    }

    pub fn leave_out(&mut self, reason: Reason, line: usize) {
        self.intake.leave_out(reason, line);
    }

    /// Adds a sample; `cells`: its numbers before they became a colour, for values that stand for nothing.
    pub fn push(&mut self, line: usize, pair: [[f64; 3]; 2], rgb: [f64; 3], cells: &[f64]) {
        self.push_spectrum(line, pair, rgb, [cells, cells]);
    }

    /// The same of a spectrum that is not what stands in the file.
    pub fn push_spectrum(
        &mut self,
        line: usize,
        [wi, wo]: [[f64; 3]; 2],
        rgb: [f64; 3],
        [cells, spectrum]: [&[f64]; 2],
    ) {
        let (below, at) = (|d: &[f64; 3]| d[2] < -HORIZON, |d: &[f64; 3]| d[2].abs() <= HORIZON);
        let reason = match (below(&wi), below(&wo)) {
            _ if at(&wi) || at(&wo) => Some(Reason::Horizon),
            (true, true) => Some(Reason::Behind),
            (false, false) => None,
            _ => Some(Reason::Transmission),
        };
        if let Some(reason) = reason {
            return self.leave_out(reason, line);
        }
        let wo = match self.conventions.mirror {
            Some(Mirror::Equal) => [-wo[0], -wo[1], wo[2]],
            _ => wo,
        };
        let cosine = match self.conventions.values {
            Some(Values::CosineOutgoing) => wo[2],
            Some(Values::CosineIncident) => wi[2],
            _ => 1.0,
        };
        let divisor = self.conventions.divide * cosine;
        let rgb = rgb.map(|v| v / divisor);
        if let Some(spectra) = &mut self.spectra {
            spectra.add(spectrum, self.share / divisor, [wi, wo]);
        }
        self.cells.push(Cells::of(cells));
        self.intake.rows.push(Row { line, wi, wo, rgb });
    }

    /// All samples, without rows that were not measured.
    ///
    /// # Errors
    /// [`ReadError`] where no sample is left.
    pub fn finish(mut self) -> Result<Intake, ReadError> {
        if self.conventions.wavelengths.is_some() && !self.has_wavelengths {
            let text = "--wavelengths: the file has none; spectra or a column of wavelengths are expected";
            return Err(ReadError::Content(text.into()));
        }
        let sentinels = Sentinels::of(&self.cells);
        let rows = std::mem::take(&mut self.intake.rows);
        let reasons: Vec<Option<Reason>> = self.cells.iter().map(|cells| sentinels.reason(cells)).collect();
        for (row, reason) in rows.into_iter().zip(&reasons) {
            match reason {
                Some(reason) => self.intake.leave_out(*reason, row.line),
                None => self.intake.rows.push(row),
            }
        }
        if self.intake.rows.is_empty() {
            let left_out = self.intake.left_out_text();
            let text =
                if left_out.is_empty() { "no samples".into() } else { format!("no samples: {left_out}") };
            return Err(ReadError::Content(text));
        }
        self.intake.spectra =
            self.spectra.take().and_then(|found| found.finish(|row| reasons[row].is_none()));
        self.intake.is_light_fixed = scatter::is_light_fixed(&self.intake.rows);
        Ok(self.intake)
    }
}

impl Intake {
    fn leave_out(&mut self, reason: Reason, line: usize) {
        let known = self.left_out.iter().position(|left| left.reason == reason);
        let place = known.unwrap_or_else(|| {
            self.left_out.push(LeftOut { reason, count: 0, lines: Vec::new() });
            self.left_out.len() - 1
        });
        let left = &mut self.left_out[place];
        left.count += 1;
        if left.lines.len() < LISTED {
            left.lines.push(line);
        }
    }

    /// How many rows are no samples.
    pub fn left_out_count(&self) -> usize {
        self.left_out.iter().map(|left| left.count).sum()
    }

    /// The rows that are left out, in words; empty for none.
    pub fn left_out_text(&self) -> String {
        let text = |left: &LeftOut| {
            let lines: Vec<String> = left.lines.iter().map(usize::to_string).collect();
            let more = if left.count > left.lines.len() { ", ..." } else { "" };
            let (rows, s) = if left.count == 1 { ("row", "") } else { ("rows", "s") };
            let lines = lines.join(", ");
            format!("{} {rows} {} (line{s} {lines}{more})", left.count, left.reason.text())
        };
        self.left_out.iter().map(text).collect::<Vec<_>>().join("; ")
    }

    /// The samples of each view in its frame, theta rising.
    pub fn views(&self) -> Vec<(f64, Scattered)> {
        let groups = scatter::views(&self.rows, self.is_light_fixed);
        groups.into_iter().map(|group| (group.theta, group.samples)).collect()
    }

    /// Which of the rows the samples of each view are, in the order of [`views`](Self::views).
    pub fn placed(&self) -> Vec<Vec<usize>> {
        scatter::views(&self.rows, self.is_light_fixed).into_iter().map(|group| group.rows).collect()
    }
}
