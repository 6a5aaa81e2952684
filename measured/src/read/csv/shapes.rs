//! Tables of other shapes than a sample a line, made that: a matrix of one angle by another, and a sample a column.

use super::Made;
use super::cells::number;
use super::columns::Columns;
use super::layout::{Above, SEARCHED, SEPARATORS, fields};
use super::names::{Role, role};
use crate::read::Mirror;

/// Larger texts are no tables of these shapes. Each number becomes a row of its own, forty times as large.
const LARGEST: usize = 1 << 22;

/// Longest name.
const LONGEST: usize = 100;

/// Least columns of numbers.
const COLUMNS: usize = 2;

/// Makes a table of a text that has no line of names.
pub(super) fn find(text: &str) -> Option<Made> {
    if text.len() > LARGEST {
        return None;
    }
    SEPARATORS
        .into_iter()
        .find_map(|separator| matrix(text, separator).or_else(|| by_column(text, separator)))
}

/// The first field of a line, if it may be a name.
fn first(line: &str, separator: char) -> Option<&str> {
    let field =
        if separator == ' ' { line.split_whitespace().next()? } else { line.split(separator).next()? };
    let name = field.trim().trim_matches('"').trim();
    (name.len() <= LONGEST && name.starts_with(char::is_alphabetic)).then_some(name)
}

/// The fields of a line after the first, if they are numbers or empty.
fn numbers(fields: &[String]) -> Option<&[String]> {
    let rest = fields.get(1..)?;
    let rest = &rest[..rest.len() - rest.iter().rev().take_while(|field| field.trim().is_empty()).count()];
    let is_number = |field: &String| field.trim().is_empty() || number(field).is_some();
    (rest.len() >= COLUMNS && rest.iter().all(is_number)).then_some(rest)
}

/// `theta_o\\theta_i, 10, 25, 40` above rows that begin with an angle.
fn matrix(text: &str, separator: char) -> Option<Made> {
    let (at, head, names) = text.lines().take(SEARCHED).enumerate().find_map(|(at, line)| {
        let names: Vec<String> =
            first(line, separator)?.split(['\\', '/', '|']).map(|name| name.trim().to_owned()).collect();
        let is_angle = |name: &String| {
            matches!(role(name), Role::Theta(_) | Role::ThetaAlone | Role::Phi(_) | Role::DeltaPhi)
        };
        let is_corner = names.len() == 2 && names.iter().all(is_angle);
        let head = is_corner.then(|| fields(line, separator))?;
        numbers(&head).is_some().then_some((at, head, names))
    })?;
    let across = numbers(&head)?;
    let mut rows = Vec::new();
    for (n, line) in text.lines().enumerate().skip(at + 1).filter(|(_, line)| !line.trim().is_empty()) {
        let cells = fields(line, separator);
        number(cells.first()?)?;
        for (value, angle) in cells[1..].iter().zip(across) {
            rows.push((n + 1, vec![cells[0].clone(), angle.clone(), value.clone()]));
        }
    }
    let names = vec![names[0].clone(), names[1].clone(), "value".into()];
    let above = Above::of(text.lines().take(at));
    let columns = Columns::find(&names, &above.constants).ok()?;
    let note = format!("a matrix: rows are by {}, columns by {}", names[0], names[1]);
    Some(Made { columns, rows, angle_unit: above.angle_unit, notes: vec![note], mirror: None })
}

/// Lines of one name and numbers: a sample a column.
fn by_column(text: &str, separator: char) -> Option<Made> {
    let named: Vec<(usize, Vec<String>)> = text
        .lines()
        .enumerate()
        .take(SEARCHED)
        .filter(|(_, line)| first(line, separator).is_some_and(|name| role(name).words().is_some()))
        .map(|(at, line)| (at, fields(line, separator)))
        .filter(|(_, fields)| numbers(fields).is_some())
        .collect();
    let count = named.iter().map(|(_, fields)| fields.len()).max()?;
    let names: Vec<String> = named.iter().map(|(_, fields)| fields[0].clone()).collect();
    let first = named.first()?.0;
    let above = Above::of(text.lines().take(first));
    let columns = Columns::find(&names, &above.constants).ok()?;
    let cell = |fields: &[String], n: usize| fields.get(n).cloned().unwrap_or_default();
    let row = |n: usize| (n + 1, named.iter().map(|(_, fields)| cell(fields, n)).collect());
    let rows = (1..count).map(row).collect();
    let mut notes = vec!["a sample a column: the lines that are named here are columns".to_owned()];
    // The instrument counts azimuths from the mirror direction.
    let is_rt300 = names.iter().any(|name| name.trim().eq_ignore_ascii_case("receive"));
    let mirror = is_rt300.then_some(Mirror::Equal);
    if is_rt300 {
        notes.push(
            "the mirror direction is where Receive is above 0 at azimuth 0, as RT-300S exports have it"
                .into(),
        );
    }
    Some(Made { columns, rows, angle_unit: above.angle_unit, notes, mirror })
}
