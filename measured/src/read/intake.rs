//! The result of a reader: samples, each with its line, and rows without a measurement, counted by reason.
//!
//! *Not measured* is one notion from here on. A cell that is empty or no number; a value that stands for nothing (-1, -999); an
//! exact 0 where all others are far from it; a direction at the horizon or behind the surface: none becomes a sample, none becomes
//! 0. Rows that are left out are counted and listed by line.
//!
//! Statements of the file about its values are held against them: a cosine that swapped samples deny, logarithms, saturation.

use super::conventions::{Conventions, Mirror, Values};
use super::reason::Reason;
use super::scatter;
use super::sentinels::{Cells, Sentinels};
use super::spectra::{Spectra, SpectralSamples};
use super::wavelengths::Wavelengths;
use crate::ReadError;
use crate::complete::Outlier;
use crate::complete::turned::Way;
use crate::isotropy::Isotropy;
use crate::reciprocity::Reciprocity;
use crate::reciprocity::pairs::Places;
use crate::row::{Row, thin, turned_over};
use crate::table::{BLACK, Scattered};
use std::collections::HashSet;

/// Cosine below which a direction is at the horizon: there no BRDF can be measured.
const HORIZON: f64 = 1e-5;

/// Least number of rows, and share of values below 0, by which they are logarithms.
const LOGARITHMS: usize = 10;
const NEGATIVE: f64 = 0.8;

/// Least number of places of a saturated value, and of times that it is as frequent as any of the next distinct values.
const OFTEN: usize = 5;
const NEXT: usize = 20;

/// Noise about 0: least number of values; share of them below 0. Their mean in standard errors, and the largest in deviations, at most.
const NOISY: usize = 20;
const NOISE_BELOW: f64 = 0.2;
const ERRORS: f64 = 3.0;
const STANDS_OUT: f64 = 5.0;

/// Samples whose swapped pairs are looked at.
const MOST_COMPARED: usize = 50_000;

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
    /// Whether it is, or may be, a fault.
    pub is_off: bool,
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
    /// The kind of values that the file was read by.
    pub values: Values,
    /// Where the mirror direction is, if an option or the format's program says it.
    pub mirror: Option<Mirror>,
    /// Whether the incident directions are the views, by reciprocity.
    pub is_light_fixed: bool,
    /// Whether no value is above 0, or above noise about 0: then all samples have the level of that noise, 1e-9 / sr at least.
    pub is_black: bool,
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
    /// The kind of values that the file itself states, if no option says another.
    stated: Option<Values>,
    /// How many rows the file announces.
    pub announced: Option<usize>,
    /// Rows, and those of them whose incident direction alone is behind the surface.
    rows: usize,
    behind: usize,
}

impl Reading {
    pub fn new(format: &'static str, conventions: &Conventions) -> Self {
        let mut conventions = *conventions;
        let mut intake = Intake { format, mirror: conventions.mirror, ..Intake::default() };
        if conventions.divide != 1.0 {
            let text = format!("values are divided by {}", conventions.divide);
            intake.notes.push(Note { text, option: None, is_off: false });
        }
        conventions.mirror.get_or_insert(Mirror::Opposite);
        Self {
            intake,
            conventions,
            cells: Vec::new(),
            spectra: None,
            share: 1.0,
            has_wavelengths: false,
            stated: None,
            announced: None,
            rows: 0,
            behind: 0,
        }
    }

    /// The kind of values that the file states, where the caller does not know better.
    pub fn values_are(&mut self, values: Values) {
        if self.conventions.values.is_none() {
            (self.conventions.values, self.stated) = (Some(values), Some(values));
        }
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
        self.intake.notes.push(Note { text: text.into(), option: None, is_off: false });
    }

    pub fn note_option(&mut self, text: impl Into<String>, option: &'static str) {
        self.intake.notes.push(Note { text: text.into(), option: Some(option), is_off: false });
    }

    fn fault(&mut self, text: String, option: impl Into<Option<&'static str>>) {
        self.intake.notes.push(Note { text, option: option.into(), is_off: true });
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
        let wi = if self.conventions.is_along_light { wi.map(|v| -v) } else { wi };
        let [wi, wo] = turned_over(self.conventions.quarter, [wi, wo]);
        self.rows += 1;
        self.behind += usize::from(wi[2] < -HORIZON && wo[2] > HORIZON);
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
        self.check_logarithms()?;
        let sentinels = Sentinels::of(&self.cells);
        let rows = std::mem::take(&mut self.intake.rows);
        let mut kept = Vec::with_capacity(rows.len());
        let reasons: Vec<Option<Reason>> = self.cells.iter().map(|cells| sentinels.reason(cells)).collect();
        for ((row, cells), reason) in rows.into_iter().zip(&self.cells).zip(&reasons) {
            match reason {
                Some(reason) => self.intake.leave_out(*reason, row.line),
                None => kept.push((row, cells.largest())),
            }
        }
        let left_out = self.saturation(&mut kept);
        self.intake.rows = kept.into_iter().map(|kept| kept.0).collect();
        self.check_cosine();
        self.blacken();
        self.check_count();
        self.intake.values = self.conventions.values.unwrap_or_default();
        if self.intake.rows.is_empty() && self.behind > 0 && self.behind == self.rows {
            return Err(ReadError::NoSamples(format!(
                "no samples: {}. In all of them it is the incident direction: either they are transmission, or do all incident directions \
                 point along the light? --incident along-light turns them",
                self.intake.left_out_text()
            )));
        }
        if self.intake.rows.is_empty() {
            let left_out = self.intake.left_out_text();
            let text =
                if left_out.is_empty() { "no samples".into() } else { format!("no samples: {left_out}") };
            return Err(ReadError::NoSamples(text));
        }
        self.intake.spectra = self.spectra.take().and_then(|found| {
            found.finish(|row| reasons[row].is_none() && Some(self.cells[row].largest()) != left_out)
        });
        self.intake.is_light_fixed = scatter::is_light_fixed(&self.intake.rows);
        Ok(self.intake)
    }
}

impl Reading {
    /// Refuses values most of which are below 0.
    fn check_logarithms(&self) -> Result<(), ReadError> {
        let below = self.cells.iter().filter(|cells| cells.is_negative()).count();
        if self.cells.len() < LOGARITHMS || below as f64 <= NEGATIVE * self.cells.len() as f64 {
            return Ok(());
        }
        Err(ReadError::Content(format!(
            "{below} of {} values are below 0: are they logarithms or decibels? The values of f themselves are expected",
            self.cells.len()
        )))
    }

    /// Holds the number of rows that the file announces against those that are there.
    fn check_count(&mut self) {
        let found = self.intake.rows.len() + self.intake.left_out_count();
        if let Some(announced) = self.announced.filter(|announced| *announced != found) {
            self.fault(format!("the file announces {announced} rows, and has {found}"), None);
        }
    }

    /// Takes samples that are 0, or noise about 0, for black: lobes need some brightness.
    fn blacken(&mut self) {
        let rows = &mut self.intake.rows;
        let count = rows.len() as f64;
        let mean_of = |of: &dyn Fn(&Row) -> f64| rows.iter().map(of).sum::<f64>() / count;
        let level = |row: &Row| row.rgb.iter().sum::<f64>() / 3.0;
        let mean = mean_of(&level);
        let deviation = libm::sqrt(mean_of(&|row| (level(row) - mean).powi(2)));
        let largest = rows.iter().map(level).fold(f64::NEG_INFINITY, f64::max);
        let below = rows.iter().filter(|row| level(row) < 0.0).count() as f64;
        let error = deviation / libm::sqrt(count);
        let is_zero = !rows.is_empty() && rows.iter().all(|row| row.rgb.iter().all(|v| *v <= 0.0));
        let is_noise = rows.len() >= NOISY
            && below > NOISE_BELOW * count
            && mean < ERRORS * error
            && largest < STANDS_OUT * deviation;
        if is_zero || is_noise {
            let black = mean.max(error).max(BLACK);
            rows.iter_mut().for_each(|row| row.rgb = [black; 3]);
            self.intake.is_black = true;
            let what = if is_zero { "no value is above 0" } else { "values are noise about 0" };
            self.note(format!("{what}: the surface is taken as black, with f of {black:.1e} / sr"));
        }
    }

    /// Asks about a largest value that is repeated, or leaves those rows out and gives it.
    fn saturation(&mut self, kept: &mut Vec<(Row, f64)>) -> Option<f64> {
        let largest = kept.iter().map(|row| row.1).fold(f64::NEG_INFINITY, f64::max);
        if self.conventions.is_saturated {
            for (row, _) in kept.iter().filter(|row| row.1 == largest) {
                self.intake.leave_out(Reason::Saturated(largest), row.line);
            }
            kept.retain(|row| row.1 < largest);
            return Some(largest);
        }
        if let Some(count) = saturated(kept) {
            self.fault(
                format!(
                    "the largest value, {largest}, stands there {count} times: is the detector saturated?"
                ),
                "--saturated leave-out",
            );
        }
        None
    }

    /// Holds a cosine that the file states against its swapped samples.
    fn check_cosine(&mut self) {
        let (which, option, denial) = match self.stated {
            Some(Values::CosineOutgoing) => ("viewer", "--values cosine-outgoing", Values::CosineIncident),
            Some(Values::CosineIncident) => ("light", "--values cosine-incident", Values::CosineOutgoing),
            Some(Values::Brdf) | None => return,
        };
        let few: Vec<Row> = thin(&self.intake.rows, MOST_COMPARED).into_iter().copied().collect();
        let found = Reciprocity::of(&Places::of(&few, false).swapped());
        // Divided by one cosine, f itself looks as if it were multiplied by the other.
        let Some(found) = found.filter(|found| found.cosine == Some(denial)) else {
            self.note_option(
                format!(
                    "values are f times the cosine of the {which}, as the file says, and are divided by it"
                ),
                "--values brdf",
            );
            return;
        };
        for row in &mut self.intake.rows {
            let cosine = if denial == Values::CosineIncident { row.wo[2] } else { row.wi[2] };
            row.rgb = row.rgb.map(|v| v * cosine);
        }
        self.conventions.values = Some(Values::Brdf);
        self.fault(
            format!(
                "the file says that values are f times the cosine of the {which}, but its {} swapped pairs of samples agree without \
                 dividing: they are read as f, as by --values brdf; as the file says",
                found.pairs
            ),
            option,
        );
    }
}

/// How often the largest value stands there, if it is too often for a measurement.
fn saturated(rows: &[(Row, f64)]) -> Option<usize> {
    let mut sorted: Vec<&(Row, f64)> = rows.iter().collect();
    sorted.sort_by(|a, b| b.1.total_cmp(&a.1));
    // At the normal one pair of directions has many names.
    let place = |row: &Row| {
        let dot = (0..3).map(|k| row.wi[k] * row.wo[k]).sum::<f64>();
        [row.wi[2], row.wo[2], dot].map(|v| libm::round(1e3 * v) as i64)
    };
    let places =
        |run: &[&(Row, f64)]| run.iter().map(|row| place(&row.0)).collect::<HashSet<[i64; 3]>>().len();
    let mut runs = sorted.chunk_by(|a, b| a.1 == b.1);
    let largest = runs.next()?;
    let next = runs.take(NEXT).map(places).max()?;
    let is_often = largest[0].1 > 0.0 && places(largest) >= OFTEN * next && 2 * largest.len() <= rows.len();
    is_often.then_some(largest.len())
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

    /// Without the rows that others contradict, which are numbered as they stand here.
    #[doc(hidden)]
    pub fn without(&self, outliers: &[Outlier]) -> Self {
        let gone: HashSet<usize> = outliers.iter().map(|outlier| outlier.sample).collect();
        let kept = self.rows.iter().enumerate().filter(|(n, _)| !gone.contains(n));
        Self { rows: kept.map(|(_, row)| *row).collect(), ..self.clone() }
    }

    /// With the samples of another.
    pub(super) fn with(mut self, other: Option<Self>) -> Self {
        if let Some(other) = other {
            self.rows.extend(other.rows);
            self.is_light_fixed = scatter::is_light_fixed(&self.rows);
        }
        self
    }

    /// The same of a quarter of a sheet whose other quarters are measurements too.
    pub(super) fn of_quarter(mut self) -> Self {
        self.left_out.retain(|left| !matches!(left.reason, Reason::Behind | Reason::Transmission));
        self
    }

    /// The samples as a completion takes them. `is_back`: of light the other way through a sheet.
    pub(super) fn way(&self, is_back: bool) -> Way<'_> {
        Way { rows: &self.rows, is_light_fixed: self.is_light_fixed, is_back }
    }

    /// The same samples with light and viewer exchanged.
    pub(super) fn exchanged(mut self) -> Self {
        self.rows.iter_mut().for_each(|row| *row = row.exchanged());
        self.is_light_fixed = !self.is_light_fixed;
        self
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
