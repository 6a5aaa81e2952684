//! Reader of tables of text: anybody's isotropic measurement, a sample a line, in whatever layout a program wrote it.
//!
//! A line names the columns, in any order and usual spelling: the two directions as unit vectors or as angles, and the BRDF, 1/sr, not
//! multiplied by the cosine, as colour, grey or spectrum. What stands above it, comments, and columns that have no meaning here are
//! passed over. `docs/csv.md` has the whole. Any number of samples is enough, in any pattern.
//!
//! What reads one way is read, and said where it is not plain; what reads two ways is asked back, with the option that decides it.

mod cells;
mod columns;
mod geometry;
mod layout;
mod long;
mod names;

use super::conventions::Conventions;
use super::intake::{Intake, Reading};
use super::reason::Reason;
use crate::ReadError;
use crate::file::decode::{decode, shortened};
use cells::{Cell, LARGEST};
use columns::{Columns, Values};
use geometry::Geometry;
use layout::{Layout, fields, is_comment, reader};
use names::Unit;

/// Parses the bytes of a table of text.
///
/// # Errors
/// [`ReadError`], with the line, column or separator that stopped it.
pub fn parse(bytes: &[u8], conventions: &Conventions) -> Result<Intake, ReadError> {
    let text = decode(bytes)?;
    let layout = Layout::find(&text)?;
    let rows = Rows { text: &text[layout.rows_at..], separator: layout.separator, first: layout.line + 1 };
    let said = layout.angle_unit;
    table("table of text", &layout.columns, rows, (said, Unknown::IsAsked), conventions)
}

/// Parses rows whose names a format of its own has: in radians, where the numbers do not show that they are degrees.
pub(super) fn parse_named(
    format: &'static str,
    names: &str,
    (text, first): (&str, usize),
    conventions: &Conventions,
    scale: [f64; 3],
) -> Result<Intake, ReadError> {
    let separator = if names.contains(',') { ',' } else { ' ' };
    let columns = Columns::find(&fields(names, separator), &Vec::new())
        .map_err(|no| ReadError::Content(format!("VARS names the columns: {}", no.reason)))?;
    let separator = if text.contains(',') { ',' } else { ' ' };
    let rows = Rows { text, separator, first };
    let mut intake = table(format, &columns, rows, (None, Unknown::IsRadians), conventions)?;
    for row in &mut intake.rows {
        row.rgb = [0, 1, 2].map(|c| row.rgb[c] / scale[c]);
    }
    Ok(intake)
}

/// What angles are that may be either.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Unknown {
    IsAsked,
    IsRadians,
}

/// The text of the rows, and the line of the first.
struct Rows<'a> {
    text: &'a str,
    separator: char,
    first: usize,
}

/// A row as numbers.
struct Numbers {
    line: usize,
    /// Of the directions, as [`Geometry`] takes them.
    directions: [f64; 6],
    values: Vec<f64>,
}

fn table(
    format: &'static str,
    columns: &Columns,
    rows: Rows<'_>,
    (said, unknown): (Option<Unit>, Unknown),
    conventions: &Conventions,
) -> Result<Intake, ReadError> {
    let mut reading = Reading::new(format, conventions);
    for note in &columns.notes {
        reading.note(note.clone());
    }
    if !columns.ignored.is_empty() {
        let names: Vec<String> = columns.ignored.iter().take(8).map(|name| shortened(name)).collect();
        let (s, are) = if columns.ignored.len() == 1 { ("", "is") } else { ("s", "are") };
        reading.note(format!("column{s} {} {are} not read", names.join(", ")));
    }
    let mut parsing = Parsing { columns, places: columns.values.places(), found: Vec::new(), unit: said };
    rows.each(&mut |line, cells: &mut dyn Iterator<Item = &str>| parsing.row(line, cells, &mut reading))?;
    let Parsing { found, unit, .. } = parsing;
    let percent = columns.value_unit == Some(Unit::Percent);
    if percent {
        reading.note("values are in per cent");
    }
    let share = if percent { 0.01 } else { 1.0 };
    let geometry = Geometry::new(columns, &found, (unit, unknown), conventions, &mut reading)?;
    if let Values::Long(_) = columns.values {
        return long::finish(&geometry, found, share, reading);
    }
    let spectrum = match &columns.values {
        Values::Spectrum(_, wavelengths) => Some(reading.wavelengths_are(wavelengths.clone(), share)?),
        _ => None,
    };
    for row in &found {
        let directions = geometry.directions(row)?;
        let rgb =
            spectrum.as_ref().map_or_else(|| columns.values.rgb(&row.values), |lines| lines.rgb(&row.values));
        let rgb = rgb.map(|v| share * v);
        reading.push(row.line, directions, rgb, &row.values);
    }
    reading.finish()
}

/// A function of the line and the fields of a row.
type CallWithRow<'a> = dyn FnMut(usize, &mut dyn Iterator<Item = &str>) -> Result<(), ReadError> + 'a;

impl Rows<'_> {
    /// Calls with the line and the fields of each row.
    fn each(&self, call: &mut CallWithRow<'_>) -> Result<(), ReadError> {
        if self.separator == ' ' {
            for (n, line) in self.text.lines().enumerate() {
                let line = line.trim();
                if !line.is_empty() && !is_comment(line) {
                    call(self.first + n, &mut line.split_whitespace())?;
                }
            }
            return Ok(());
        }
        let mut reader = reader(self.text, self.separator);
        let mut record = csv::StringRecord::new();
        loop {
            let more = reader.read_record(&mut record);
            // A record begins where the last one ended, before the empty lines between them.
            let line = record.position().map_or(self.first, |p| {
                let rest = self.text.get(p.byte() as usize..).unwrap_or("").bytes();
                let empty = rest.take_while(|b| matches!(b, b'\r' | b'\n')).filter(|b| *b == b'\n').count();
                self.first + p.line() as usize - 1 + empty
            });
            match more {
                Ok(false) => return Ok(()),
                Ok(true) if record.iter().all(str::is_empty) => {}
                Ok(true) if record.get(0).is_some_and(is_comment) => {}
                Ok(true) => call(line, &mut record.iter())?,
                Err(error) => return Err(ReadError::Content(format!("line {line}: {error}"))),
            }
        }
    }
}

/// Rows on their way to numbers.
struct Parsing<'a> {
    columns: &'a Columns,
    places: Vec<usize>,
    found: Vec<Numbers>,
    unit: Option<Unit>,
}

impl Parsing<'_> {
    fn row(
        &mut self,
        line: usize,
        cells: &mut dyn Iterator<Item = &str>,
        reading: &mut Reading,
    ) -> Result<(), ReadError> {
        let names = &self.columns.names;
        let cells: Vec<&str> = cells.collect();
        // A separator at the end of a line makes an empty column more.
        let count = cells.len() - cells.iter().rev().take_while(|cell| cell.is_empty()).count();
        let last = self.places.iter().copied().max().unwrap_or(0);
        let needed = 1 + last.max(geometry::last_column(&self.columns.directions));
        if count > names.len() || cells.len() < needed {
            let hint = if count > names.len() && self.commas(&cells) {
                "; with decimal commas, columns have to be separated by ; or tabs"
            } else {
                ""
            };
            return Err(ReadError::Content(format!(
                "line {line}: {} columns where {} were expected{hint}",
                cells.len(),
                names.len()
            )));
        }
        let cell = |place: usize| cells.get(place).copied().unwrap_or("");
        let odd = |place: usize| ReadError::Word {
            line,
            index: place + 1,
            found: shortened(cell(place)),
            expected: format!(
                "a number, at most {LARGEST:e} in size, of column {}",
                shortened(&names[place])
            ),
        };
        if self.found.is_empty() && self.is_units(&cells) {
            let unit = cells.iter().find_map(|cell| names::unit(cell)).filter(|u| *u != Unit::Percent);
            self.unit = self.unit.or(unit);
            return Ok(());
        }
        let mut directions = [0.0; 6];
        for (at, place) in geometry::places(&self.columns.directions).into_iter().enumerate() {
            directions[at] = match place {
                None => continue,
                Some(columns::Place::Constant(number)) => number,
                Some(columns::Place::Column(place)) => match Cell::of(cell(place)) {
                    Cell::Number(number) => number,
                    Cell::Nothing => {
                        reading.leave_out(Reason::NoNumber, line);
                        return Ok(());
                    }
                    Cell::Odd => return Err(odd(place)),
                },
            };
        }
        let mut values = Vec::with_capacity(self.places.len());
        for &place in &self.places {
            match Cell::of(cell(place)) {
                Cell::Number(number) => values.push(number),
                Cell::Nothing => {
                    reading.leave_out(Reason::NoNumber, line);
                    return Ok(());
                }
                Cell::Odd => return Err(odd(place)),
            }
        }
        self.found.push(Numbers { line, directions, values });
        Ok(())
    }

    /// Whether a row is one of units, below the names: words in place of numbers.
    fn is_units(&self, cells: &[&str]) -> bool {
        let places = geometry::places(&self.columns.directions);
        let cell = |place: &columns::Place| match place {
            columns::Place::Column(place) => cells.get(*place).copied(),
            columns::Place::Constant(_) => None,
        };
        let mut all = places.iter().flatten().filter_map(cell).peekable();
        all.peek().is_some() && all.all(|cell| Cell::of(cell) == Cell::Odd && names::unit(cell).is_some())
    }

    /// Whether columns are separated by commas, and there are about twice as many as there should be.
    fn commas(&self, cells: &[&str]) -> bool {
        let is_whole = |cell: &&str| cell.trim_start_matches('-').chars().all(|c| c.is_ascii_digit());
        cells.iter().filter(|cell| is_whole(cell)).count() + 1 >= cells.len()
    }
}

#[cfg(test)]
mod tests;
