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
mod shapes;

use super::conventions::{Conventions, Mirror, Values as Kind};
use super::intake::{Intake, Reading};
use super::reason::Reason;
use crate::ReadError;
use crate::file::decode::{decode, shortened};
use cells::{Cell, LARGEST};
use columns::{Columns, Directions, Values};
use geometry::Geometry;
use layout::{Layout, fields, is_comment, reader};
use names::{Beside, Unit};
use std::f64::consts::FRAC_1_PI;

/// Parses the bytes of a table of text.
///
/// # Errors
/// [`ReadError`], with the line, column or separator that stopped it.
pub fn parse(bytes: &[u8], conventions: &Conventions) -> Result<Intake, ReadError> {
    let text = decode(bytes)?;
    let layout = match Layout::find(&text) {
        Ok(layout) => layout,
        Err(error) => return of_made("table of text", shapes::find(&text).ok_or(error)?, conventions),
    };
    let (separator, first) = (layout.separator, layout.line + 1);
    let rows = Rows::Text { text: &text[layout.rows_at..], separator, first };
    let mut reading = Reading::new("table of text", conventions);
    reading.announced = layout.announced;
    table(reading, &layout.columns, rows, (layout.angle_unit, Unknown::IsAsked), conventions)
}

/// A table that was of another shape: a sample a row.
struct Made {
    columns: Columns,
    /// With the line of each, or the number of its entry.
    rows: Vec<(usize, Vec<String>)>,
    angle_unit: Option<Unit>,
    notes: Vec<String>,
    /// Where its program has the mirror direction.
    mirror: Option<Mirror>,
}

/// Rows of cells under names, as other formats hold them.
pub(super) fn parse_rows(
    format: &'static str,
    names: &[String],
    rows: Vec<(usize, Vec<String>)>,
    notes: Vec<String>,
    conventions: &Conventions,
) -> Result<Intake, ReadError> {
    let columns = Columns::find(names, &Vec::new())
        .map_err(|no| ReadError::Content(format!("names of the columns: {}", no.reason)))?;
    of_made(format, Made { columns, rows, angle_unit: None, notes, mirror: None }, conventions)
}

fn of_made(format: &'static str, made: Made, conventions: &Conventions) -> Result<Intake, ReadError> {
    let Made { columns, rows, angle_unit, notes, mirror } = made;
    let conventions = Conventions { mirror: conventions.mirror.or(mirror), ..*conventions };
    let mut reading = Reading::new(format, &conventions);
    notes.into_iter().for_each(|note| reading.note(note));
    table(reading, &columns, Rows::Made(rows), (angle_unit, Unknown::IsAsked), &conventions)
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
    let rows = Rows::Text { text, separator, first };
    let reading = Reading::new(format, conventions);
    let mut intake = table(reading, &columns, rows, (None, Unknown::IsRadians), conventions)?;
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

/// The rows.
enum Rows<'a> {
    /// Their text, and the line of the first.
    Text { text: &'a str, separator: char, first: usize },
    /// Their cells.
    Made(Vec<(usize, Vec<String>)>),
}

/// A row as numbers.
struct Numbers {
    line: usize,
    /// Of the directions, as [`Geometry`] takes them.
    directions: [f64; geometry::NUMBERS],
    values: Vec<f64>,
}

fn table(
    mut reading: Reading,
    columns: &Columns,
    rows: Rows<'_>,
    (said, unknown): (Option<Unit>, Unknown),
    conventions: &Conventions,
) -> Result<Intake, ReadError> {
    for note in &columns.notes {
        reading.note(note.clone());
    }
    if !columns.ignored.is_empty() {
        let names: Vec<String> = columns.ignored.iter().take(8).map(|name| shortened(name)).collect();
        let (s, are) = if columns.ignored.len() == 1 { ("", "is") } else { ("s", "are") };
        reading.note(format!("column{s} {} {are} not read", names.join(", ")));
    }
    // The caller knows better than a name.
    let beside =
        columns.beside.as_ref().filter(|_| conventions.values.is_none() && conventions.divide == 1.0);
    match columns.beside.as_ref().map(|beside| beside.0) {
        Some(Beside::CosineOutgoing) => reading.values_are(Kind::CosineOutgoing),
        Some(Beside::PiCosineIncident) => reading.values_are(Kind::CosineIncident),
        Some(Beside::Pi) | None => {}
    }
    let mut parsing = Parsing {
        columns,
        directions: columns.directions.clone(),
        places: columns.values.places(),
        found: Vec::new(),
        unit: said,
        names_again: Vec::new(),
        blocks: 1,
        above: Vec::new(),
        below: Vec::new(),
        odd: None,
    };
    rows.each(&mut |line, cells: &mut dyn Iterator<Item = &str>| parsing.row(line, cells, &mut reading))?;
    parsing.notes(&mut reading);
    let Parsing { found, unit, odd, .. } = parsing;
    if let (true, Some(odd)) = (found.is_empty(), odd) {
        return Err(odd);
    }
    let percent = columns.value_unit == Some(Unit::Percent);
    if percent {
        reading.note("values are in per cent");
    }
    let factor = beside.filter(|beside| beside.0 != Beside::CosineOutgoing);
    if let Some((_, name)) = factor {
        reading.note_option(
            format!("`{name}` is a reflectance factor, pi f, by its name: values are divided by pi"),
            "--values brdf",
        );
    }
    let share = if percent { 0.01 } else { 1.0 } * if factor.is_some() { FRAC_1_PI } else { 1.0 };
    let geometry = Geometry::new(columns, &found, (unit, unknown), conventions, &mut reading)?;
    if let Values::Long(_) = columns.values {
        // Rows of one pair of directions become one sample.
        reading.announced = None;
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
        let (text, separator, first) = match self {
            Self::Text { text, separator, first } => (*text, *separator, *first),
            Self::Made(rows) => {
                return rows
                    .iter()
                    .try_for_each(|(line, cells)| call(*line, &mut cells.iter().map(String::as_str)));
            }
        };
        if separator == ' ' {
            for (n, line) in text.lines().enumerate() {
                let line = line.trim();
                if !line.is_empty() {
                    call(first + n, &mut line.split_whitespace())?;
                }
            }
            return Ok(());
        }
        let mut reader = reader(text, separator);
        let mut record = csv::StringRecord::new();
        loop {
            let more = reader.read_record(&mut record);
            // A record begins where the last one ended, before the empty lines between them.
            let line = record.position().map_or(first, |p| {
                let rest = text.get(p.byte() as usize..).unwrap_or("").bytes();
                let empty = rest.take_while(|b| matches!(b, b'\r' | b'\n')).filter(|b| *b == b'\n').count();
                first + p.line() as usize - 1 + empty
            });
            match more {
                Ok(false) => return Ok(()),
                Ok(true) if record.iter().all(str::is_empty) => {}
                Ok(true) => call(line, &mut record.iter())?,
                Err(error) => return Err(ReadError::Content(format!("line {line}: {error}"))),
            }
        }
    }
}

/// Rows on their way to numbers.
struct Parsing<'a> {
    columns: &'a Columns,
    /// With the angles that stand above the rows of the block.
    directions: Directions,
    places: Vec<usize>,
    found: Vec<Numbers>,
    unit: Option<Unit>,
    /// Lines that name the columns again.
    names_again: Vec<usize>,
    /// Runs of rows under an angle.
    blocks: usize,
    /// Lines of words that stand between the names and the numbers, and below the numbers.
    above: Vec<usize>,
    below: Vec<usize>,
    /// The error that the first of the latter, or else of the former, is if numbers follow, or none do.
    odd: Option<ReadError>,
}

impl Parsing<'_> {
    fn row(
        &mut self,
        line: usize,
        cells: &mut dyn Iterator<Item = &str>,
        reading: &mut Reading,
    ) -> Result<(), ReadError> {
        let names = &self.columns.names;
        let mut cells: Vec<&str> = cells.collect();
        if self.is_between(line, &cells) || is_rule(&cells) {
            return Ok(());
        }
        // A separator at the end of a line makes an empty column more.
        let count = cells.len() - cells.iter().rev().take_while(|cell| cell.is_empty()).count();
        let last = self.places.iter().copied().max().unwrap_or(0);
        let turn = self.columns.turn.map_or(0, |turn| turn.0);
        let needed = 1 + last.max(turn).max(geometry::last_column(&self.directions));
        let is_remark = |cell: &&str| is_comment(cell) && Cell::of(cell) == Cell::Odd;
        let numbers = cells.len() - cells.iter().skip(needed).skip_while(|cell| !is_remark(cell)).count();
        let count = count.min(numbers);
        cells.truncate(numbers);
        let is_text = self.is_text(&cells, needed);
        if is_text && self.found.is_empty() && self.is_units(&cells) {
            let unit = cells.iter().find_map(|cell| names::unit(cell)).filter(|u| *u != Unit::Percent);
            self.unit = self.unit.or(unit);
            return Ok(());
        }
        if is_text {
            if self.found.is_empty() {
                reading.announced = layout::announced(&cells.join("\t")).or(reading.announced);
            }
            let lines = if self.found.is_empty() { &mut self.above } else { &mut self.below };
            lines.push(line);
            if self.odd.is_none() || lines.len() == 1 {
                self.odd = Some(ReadError::Content(format!(
                    "line {line}: `{}` where a row of {} columns was expected",
                    shortened(&cells.join(" ")),
                    self.columns.names.len()
                )));
            }
            return Ok(());
        }
        if let (false, Some(odd)) = (self.below.is_empty(), self.odd.take()) {
            return Err(odd);
        }
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
        let mut directions = [0.0; geometry::NUMBERS];
        let turn = self.columns.turn.map(|turn| turn.0);
        for (at, place) in geometry::places(&self.directions, turn).into_iter().enumerate() {
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

    /// Whether a line is none of numbers: a comment, the names again, or the angle of the rows below it.
    fn is_between(&mut self, line: usize, cells: &[&str]) -> bool {
        let Some(first) = cells.first() else { return true };
        if Cell::of(first) != Cell::Odd {
            return false;
        }
        let is_comment = is_comment(first);
        // An angle above a block may be a comment.
        let has_constants = !self.directions.constants().is_empty();
        if has_constants && (is_comment || cells.len() <= 3) {
            let joined = cells.join(if is_comment || cells.len() > 2 { " " } else { "," });
            if let Some((role, angle)) = layout::constant(&joined)
                && self.directions.set(&role, angle)
            {
                self.blocks += usize::from(!self.found.is_empty());
                return true;
            }
        }
        let bare = first.trim_start_matches(['#', '%', '!', '/', ' ']);
        let is_name = |(n, cell): (usize, &&str)| {
            let cell = if n == 0 { bare } else { cell };
            self.columns.names.get(n).is_some_and(|name| name == cell.trim().trim_matches('"'))
        };
        if !is_comment && cells.len() >= 2 && cells.iter().enumerate().all(is_name) {
            self.names_again.push(line);
            return true;
        }
        is_comment
    }

    /// Whether a line is words: it begins with one, and no number stands where a direction has one. Above the numbers it may be short, and
    /// hold one: `NUMBER_OF_SETS 75`.
    fn is_text(&self, cells: &[&str], needed: usize) -> bool {
        let is_odd = |cell: &&&str| Cell::of(cell) == Cell::Odd;
        if cells.iter().find(|cell| !cell.is_empty()).as_ref().is_none_or(|cell| !is_odd(cell)) {
            return false;
        }
        let column = |place: columns::Place| match place {
            columns::Place::Column(n) => cells.get(n),
            columns::Place::Constant(_) => None,
        };
        let directions = || geometry::places(&self.directions, None).into_iter().flatten().filter_map(column);
        let values = || self.places.iter().filter_map(|n| cells.get(*n));
        let is_short = cells.len() < needed;
        let has_number = directions().any(|cell| matches!(Cell::of(cell), Cell::Number(_)));
        (is_short || directions().chain(values()).any(|cell| is_odd(&cell)))
            && !(has_number && !(is_short && self.found.is_empty()))
    }

    /// Findings about the rows.
    fn notes(&self, reading: &mut Reading) {
        for (lines, place) in [
            (&self.above, "between the names of the columns and the numbers"),
            (&self.below, "below the numbers"),
        ] {
            if let Some(first) = lines.first() {
                let (s, is) = if lines.len() == 1 { ("", "is") } else { ("s", "are") };
                reading.note(format!(
                    "{} line{s} of words {place} {is} passed over, from line {first} on",
                    lines.len()
                ));
            }
        }
        if self.blocks > 1 {
            reading.note(format!("{} blocks of rows, each under the angle that it is of", self.blocks));
        } else {
            for angle in self.columns.directions.constants() {
                reading
                    .note(format!("one direction is the same in all rows: {angle}, from above the columns"));
            }
        }
        if let Some(line) = self.names_again.first() {
            reading.note(format!(
                "the names of the columns stand there {} times more, the first in line {line}: files were put together",
                self.names_again.len()
            ));
        }
    }

    /// Whether a row is one of units, below the names: words in place of numbers.
    fn is_units(&self, cells: &[&str]) -> bool {
        let places = geometry::places(&self.directions, None);
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

/// Whether a line is drawn: `|---|---|`.
fn is_rule(cells: &[&str]) -> bool {
    let is_drawn = |cell: &&str| cell.chars().all(|c| "-=+:|_ ".contains(c));
    cells.iter().all(is_drawn)
        && cells.iter().any(|cell| ["---", "==="].iter().any(|line| cell.contains(line)))
}

#[cfg(test)]
mod tests;
