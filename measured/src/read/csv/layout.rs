//! How a table of text is laid out: where the names of the columns stand, and what separates the columns.

use super::columns::{Columns, Constants, NoColumns, fault};
use super::names::{Role, Unit, role, unit};
use crate::ReadError;
use crate::file::decode::shortened;

/// Lines among which the names are looked for, and fields of all separators that are tried: other content ends the search.
pub(super) const SEARCHED: usize = 1000;
const FIELDS: usize = 1 << 18;

/// Lines below the names that may hold angles of the first rows.
const BELOW: usize = 8;

/// Known names that make a line one of names.
const NAMES: usize = 2;

/// Marks of comments; a line of names may be one.
const COMMENTS: [&str; 5] = ["//", "#", "%", "!", "$"];

/// What separates columns, in the order in which it is tried: `' '` is any white space.
pub(super) const SEPARATORS: [char; 5] = ['\t', ';', ',', '|', ' '];

/// The layout of a table.
#[derive(Debug)]
pub(super) struct Layout {
    pub columns: Columns,
    pub separator: char,
    /// Line of the names, from 1, and the byte after it.
    pub line: usize,
    pub rows_at: usize,
    /// A unit of angles that is said above the columns.
    pub angle_unit: Option<Unit>,
    /// How many rows are announced there.
    pub announced: Option<usize>,
}

impl Layout {
    /// Finds the names of the columns.
    ///
    /// # Errors
    /// [`ReadError::Content`] with the line that comes closest, and the columns that it lacks.
    pub fn find(text: &str) -> Result<Self, ReadError> {
        let mut above = Above::default();
        let mut closest: Option<(usize, NoColumns)> = None;
        let mut found: Option<Self> = None;
        let mut at = 0;
        let mut before = String::new();
        for (n, line) in text.split_inclusive('\n').enumerate().take(SEARCHED) {
            at += line.len();
            let (plain, is_comment) = without_mark(line.trim());
            if plain.is_empty() {
                continue;
            }
            if found.is_some() && is_comment {
                continue;
            }
            if let Some(separator) = said_separator(plain) {
                above.separator = Some(separator);
                continue;
            }
            if is_statement(plain) && found.is_none() {
                above.read(plain);
                continue;
            }
            let named = above.columns(plain).or_else(|no| {
                if no.known == 0 {
                    return Err(no);
                }
                let below = constants_below(&text[at..]);
                let count = above.constants.len();
                above.constants.extend(below);
                let found = if above.constants.len() > count { above.columns(plain).ok() } else { None };
                found.or_else(|| above.in_two_lines(&before, plain)).ok_or_else(|| {
                    above.constants.truncate(count);
                    no
                })
            });
            before = plain.to_owned();
            match named {
                Ok((columns, separator)) => {
                    let columns = with_row_names(columns, &above.constants, separator, &text[at..]);
                    let Above { angle_unit, announced, .. } = above;
                    found =
                        Some(Self { columns, separator, line: n + 1, rows_at: at, angle_unit, announced });
                    // Names in a comment may be those of an example; the line after it knows better.
                    if !is_comment {
                        break;
                    }
                }
                Err(_) if found.is_some() => break,
                Err(reason) => {
                    let rank = |no: &NoColumns| 2 * no.known + usize::from(no.has_values);
                    let is_number = |parts: (&str, &str)| {
                        parts
                            .1
                            .split_whitespace()
                            .next()
                            .is_some_and(|word| super::cells::number(word).is_some())
                    };
                    // `Wavelength (um): 0.6328`.
                    let is_of_all_rows = plain.split_once(':').is_some_and(is_number);
                    if rank(&reason) > 0
                        && !is_of_all_rows
                        && closest.as_ref().is_none_or(|c| rank(&reason) > rank(&c.1))
                    {
                        closest = Some((n + 1, reason));
                    }
                    if above.fields > FIELDS {
                        break;
                    }
                    above.read(plain);
                }
            }
        }
        found.ok_or_else(|| match closest {
            Some((line, reason)) if reason.known >= NAMES => fault(line, &reason.reason),
            Some((line, reason)) => ReadError::Content(format!(
                "no line names the columns; line {line} comes closest: {}",
                reason.reason
            )),
            None => no_names(text, above.fields > FIELDS),
        })
    }
}

/// What stands above the names.
#[derive(Debug, Default)]
pub(super) struct Above {
    separator: Option<char>,
    pub constants: Constants,
    pub angle_unit: Option<Unit>,
    announced: Option<usize>,
    /// Fields that were looked at.
    fields: usize,
}

impl Above {
    /// The columns that a line names, and what separates them; else the attempt that knows most names.
    fn columns(&mut self, line: &str) -> Result<(Columns, char), NoColumns> {
        let none = NoColumns { known: 0, has_values: false, reason: String::new() };
        let mut best: Result<(Columns, char), NoColumns> = Err(none);
        let said = self.separator.into_iter();
        for separator in said.chain(SEPARATORS.into_iter().filter(|_| self.separator.is_none())) {
            let count = if separator == ' ' {
                line.split_whitespace().count()
            } else {
                1 + line.matches(separator).count()
            };
            if count < 2 {
                continue;
            }
            // White space separates the words of names.
            if separator == ' ' && best.as_ref().err().is_some_and(|no| no.known >= NAMES) {
                break;
            }
            self.fields += count;
            if self.fields > FIELDS {
                break;
            }
            let names = fields(line, separator);
            if names.len() < 2 {
                continue;
            }
            let mut found = Columns::find(&names, &self.constants).map(|columns| (columns, separator));
            if let (' ', Err(no)) = (separator, &mut found) {
                // Any word of a sentence may be that of a value.
                no.has_values = false;
            }
            let is_better = match (&best, &found) {
                (Err(best), Err(found)) => (found.known, found.has_values) > (best.known, best.has_values),
                (Err(_), Ok(_)) => true,
                // White space separates words of a name too.
                (Ok(best), Ok(found)) => separator != ' ' && found.0.names.len() > best.0.names.len(),
                (Ok(_), Err(_)) => false,
            };
            if is_better {
                best = found;
            }
        }
        best
    }

    /// The columns of names in two lines, of which the first has the groups: `incident,,outgoing,,BRDF` above `theta,phi,theta,phi,value`.
    fn in_two_lines(&mut self, first: &str, second: &str) -> Option<(Columns, char)> {
        let separators =
            SEPARATORS.into_iter().filter(|separator| *separator != ' ' && first.contains(*separator));
        for separator in self.separator.into_iter().chain(separators) {
            let (groups, names) = (fields(first, separator), fields(second, separator));
            self.fields += groups.len() + names.len();
            let is_odd = |name: &String| super::cells::number(name).is_some();
            if self.fields > FIELDS || groups.len() != names.len() || groups.iter().any(is_odd) {
                continue;
            }
            let mut group = String::new();
            let both = groups.into_iter().zip(names).map(|(of, name)| {
                if !of.is_empty() {
                    group = of;
                }
                format!("{group} {name}").trim().to_owned()
            });
            let both: Vec<String> = both.collect();
            if let Ok(columns) = Columns::find(&both, &self.constants) {
                return Some((columns, separator));
            }
        }
        None
    }

    /// `name: number` is a direction or wavelength of all rows; a word tells the unit of angles.
    fn read(&mut self, line: &str) {
        let lower = line.to_lowercase();
        if lower.contains("angle") || lower.contains("unit") {
            self.angle_unit = unit(line).filter(|u| *u != Unit::Percent).or(self.angle_unit);
        }
        self.announced = announced(line).or(self.announced);
        if let Some(constant) = constant(line) {
            self.angle_unit = unit(line).filter(|u| *u != Unit::Percent).or(self.angle_unit);
            // The last one above the names is that of the rows.
            self.constants.retain(|known| known.0 != constant.0);
            self.constants.push(constant);
        }
    }
}

/// Whether a line is `AOI: 30`, and no line of names.
fn is_statement(line: &str) -> bool {
    let value = line.split_once([':', '=']).map(|parts| parts.1.trim_start());
    value.is_some_and(|value| value.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)))
        && (constant(line).is_some()
            || line.split([':', '=']).next().is_some_and(|name| role(name).words().is_some()))
}

/// The angles that stand between the names and the numbers.
fn constants_below(rows: &str) -> Constants {
    let lines = rows.lines().map(|line| without_mark(line.trim()).0).filter(|line| !line.is_empty());
    lines.take(BELOW).map_while(|line| constant(line).filter(|_| is_statement(line))).collect()
}

/// The columns under names that lack one: that of the numbers or names of rows, as R writes them.
fn with_row_names(columns: Columns, constants: &Constants, separator: char, rows: &str) -> Columns {
    let first = rows.lines().map(str::trim).find(|line| !line.is_empty() && !is_comment(line));
    let cells = first.map_or_else(Vec::new, |line| fields(line, separator));
    let is_number = |cell: &String| super::cells::number(cell).is_some();
    let is_name = |cell: &String| matches!(cell.as_str(), "0" | "1") || !is_number(cell);
    let has_names =
        cells.len() == columns.names.len() + 1 && is_name(&cells[0]) && cells[1..].iter().all(is_number);
    let moved = || {
        let names: Vec<String> =
            std::iter::once(String::new()).chain(columns.names.iter().cloned()).collect();
        Columns::find(&names, constants).ok()
    };
    if has_names { moved().unwrap_or(columns) } else { columns }
}

/// The number of rows that a line announces: `points: 75`.
pub(super) fn announced(line: &str) -> Option<usize> {
    let (name, value) = line.split_once([':', '=', ',', ';', '\t', ' '])?;
    let bare = name.to_lowercase().replace(|c: char| !c.is_alphanumeric(), "");
    let is_count = matches!(
        bare.as_str(),
        "numpoints"
            | "npoints"
            | "points"
            | "numberofpoints"
            | "datapoints"
            | "rows"
            | "numrows"
            | "numberofrows"
            | "numberofmeasurements"
            | "numberofsets"
    );
    is_count.then(|| value.trim_matches([' ', ',', ';', '\t']).parse().ok())?
}

/// The direction that a line names, with its angle: `AOI: 30`.
pub(super) fn constant(line: &str) -> Option<(Role, f64)> {
    let (plain, _) = without_mark(line.trim());
    let (name, value) = plain.split_once([':', '=', ',', ';', '\t'])?;
    let first = value.split([',', ';', '\t', ' ']).find(|word| !word.trim().is_empty())?;
    let (role, number) = (role(name), super::cells::number(first)?);
    matches!(role, Role::Theta(_) | Role::Phi(_)).then_some((role, number))
}

impl Above {
    /// From the lines above a place.
    pub fn of<'a>(lines: impl Iterator<Item = &'a str>) -> Self {
        let mut above = Self::default();
        lines.for_each(|line| above.read(without_mark(line.trim()).0));
        above
    }
}

/// The fields of a line; quotes keep a separator that stands within.
pub(super) fn fields(line: &str, separator: char) -> Vec<String> {
    if separator == ' ' {
        return line.split_whitespace().map(|field| field.trim_matches('"').to_owned()).collect();
    }
    // Most lines have no quotes, and a reader of its own costs a line some microseconds.
    if separator.is_ascii() && !line.is_empty() && !line.contains(['"', '\r', '\n']) {
        return line.split(separator).map(|field| field.trim().to_owned()).collect();
    }
    let mut reader = reader(line, separator);
    let mut record = csv::StringRecord::new();
    match reader.read_record(&mut record) {
        Ok(true) => record.iter().map(str::to_owned).collect(),
        _ => Vec::new(),
    }
}

/// A reader of separated columns.
pub(super) fn reader(text: &str, separator: char) -> csv::Reader<&[u8]> {
    csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .delimiter(u8::try_from(separator).unwrap_or(b','))
        .from_reader(text.as_bytes())
}

fn without_mark(line: &str) -> (&str, bool) {
    let bare = COMMENTS.iter().find_map(|mark| line.strip_prefix(mark));
    (bare.unwrap_or(line).trim_start_matches(['#', '/', '%', '!']).trim(), bare.is_some())
}

/// Whether a line is a comment.
pub(super) fn is_comment(line: &str) -> bool {
    COMMENTS.iter().any(|mark| line.starts_with(mark))
}

/// Excel's `sep=,`.
fn said_separator(line: &str) -> Option<char> {
    let said = line.trim_matches('"');
    let rest = said.get(..4).filter(|start| start.eq_ignore_ascii_case("sep=")).map(|_| &said[4..])?;
    rest.chars().next().or(Some('\t'))
}

fn no_names(text: &str, is_cut: bool) -> ReadError {
    let first = text.lines().find(|line| !line.trim().is_empty() && !is_comment(line.trim()));
    let found = first
        .map_or_else(|| "the file is empty".to_owned(), |line| format!("the first is `{}`", shortened(line)));
    let cut = if is_cut { format!("; the first {FIELDS} fields are looked at") } else { String::new() };
    ReadError::Content(format!(
        "no line names the columns, such as theta_i,phi_i,theta_o,phi_o,r,g,b above the rows; {found}{cut}"
    ))
}
