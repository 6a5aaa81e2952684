//! Tables of other shapes than a sample a line, made that: matrices of one angle by another, a sample a column, and names beside all
//! numbers.

use super::Made;
use super::cells::number;
use super::columns::Columns;
use super::layout::{Above, SEARCHED, SEPARATORS, constant, fields};
use super::names::{Role, role};
use crate::read::Mirror;
use std::collections::BTreeMap;

/// Larger texts are no tables of these shapes. Each number becomes a row of its own, forty times as large.
const LARGEST: usize = 1 << 22;

/// Longest name.
const LONGEST: usize = 100;

/// Least columns of numbers.
const COLUMNS: usize = 2;

/// Least records of names beside numbers, and most names of one.
const RECORDS: usize = 2;
const NAMES: usize = 100;

/// Makes a table of a text that has no line of names.
pub(super) fn find(text: &str) -> Option<Made> {
    if text.len() > LARGEST {
        return None;
    }
    SEPARATORS
        .into_iter()
        .find_map(|separator| matrices(text, separator).or_else(|| by_column(text, separator)))
        .or_else(|| pairs(text))
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

/// `theta_o\\theta_i, 10, 25, 40` above rows that begin with an angle: both names, and the angles of the columns.
fn corner(line: &str, separator: char) -> Option<(Vec<String>, Vec<String>)> {
    let names: Vec<String> =
        first(line, separator)?.split(['\\', '/', '|']).map(|name| name.trim().to_owned()).collect();
    let is_angle = |name: &String| {
        matches!(role(name), Role::Theta(_) | Role::ThetaAlone | Role::Phi(_) | Role::DeltaPhi)
    };
    let is_corner = names.len() == 2 && names.iter().all(is_angle);
    if is_corner {
        return Some((names, numbers(&fields(line, separator))?.to_vec()));
    }
    // `Detector angle, AOI=10, AOI=30`.
    let cells = fields(line, separator);
    let parts: Option<Vec<(&str, &str)>> = cells.get(1..)?.iter().map(|cell| cell.split_once('=')).collect();
    let parts = parts.filter(|parts| parts.len() >= COLUMNS)?;
    let across = parts[0].0.trim().to_owned();
    let is_series = parts.iter().all(|part| part.0.trim() == across && number(part.1).is_some());
    let names: Vec<String> = names.into_iter().chain([across]).collect();
    let are_angles = is_series && names.len() == 2 && names.iter().all(is_angle);
    are_angles.then(|| (names, parts.iter().map(|part| part.1.trim().to_owned()).collect()))
}

/// Matrices of one angle by another, each below the angles that are the same in all of it.
fn matrices(text: &str, separator: char) -> Option<Made> {
    let at = text.lines().take(SEARCHED).position(|line| corner(line, separator).is_some())?;
    let above = Above::of(text.lines().take(at));
    // Names of the angles above matrices, and the angles above the one that is read.
    let mut fixed: Vec<(Role, String, f64)> = Vec::new();
    let fix = |line: &str, fixed: &mut Vec<(Role, String, f64)>| {
        let Some((role, angle)) = constant(line) else { return false };
        match fixed.iter_mut().find(|known| known.0 == role) {
            Some(known) => known.2 = angle,
            None => {
                let name = line.split([':', '=', ',', ';', '\t']).next().unwrap_or(line);
                fixed.push((role, name.trim_start_matches(['#', '%', '!', '/', ' ']).to_owned(), angle));
            }
        }
        true
    };
    text.lines().take(at).for_each(|line| {
        fix(line, &mut fixed);
    });
    let count = fixed.len();
    let (mut rows, mut blocks) = (Vec::new(), 0);
    let mut head: Option<(Vec<String>, Vec<String>)> = None;
    let mut names = Vec::new();
    for (n, line) in text.lines().enumerate().skip(at).filter(|(_, line)| !line.trim().is_empty()) {
        if let Some(found) = corner(line, separator) {
            if !names.is_empty() && names != found.0 {
                return None;
            }
            names.clone_from(&found.0);
            (head, blocks) = (Some(found), blocks + 1);
            continue;
        }
        let cells = fields(line, separator);
        if number(cells.first()?).is_none() {
            if !fix(line, &mut fixed) && rows.is_empty() || fixed.len() != count {
                return None;
            }
            // Numbers belong to the matrix whose names stand above them.
            head = None;
            continue;
        }
        let across = &head.as_ref()?.1;
        for (value, angle) in cells[1..].iter().zip(across) {
            let angles = fixed.iter().map(|known| known.2.to_string());
            rows.push((n + 1, [&cells[0], angle, value].into_iter().cloned().chain(angles).collect()));
        }
    }
    let all: Vec<String> =
        names.iter().cloned().chain(["value".to_owned()]).chain(fixed.into_iter().map(|f| f.1)).collect();
    let columns = Columns::find(&all, &above.constants).ok()?;
    let which = if blocks == 1 { "a matrix".to_owned() } else { format!("{blocks} matrices") };
    let note = format!("{which}: rows are by {}, columns by {}", names[0], names[1]);
    Some(Made { columns, rows, angle_unit: above.angle_unit, notes: vec![note], mirror: None })
}

/// A name beside its number: `theta_i=10`, `"theta_i": 10`.
struct Pair<'a> {
    line: usize,
    name: &'a str,
    value: &'a str,
}

/// The names beside numbers of a line.
fn named(line: usize, text: &str) -> Vec<Pair<'_>> {
    let is_mark = |c: char| ",;{}[]()|\"'\t".contains(c);
    let mut found = Vec::new();
    let mut rest = text;
    while let Some(at) = rest.find([':', '=']) {
        let before = rest[..at].trim_end_matches(|c: char| is_mark(c) || c == ' ');
        let name = before.rsplit(is_mark).next().unwrap_or("").trim_start_matches(['-', ' ', '#']);
        let after = rest[at + 1..].trim_start_matches([' ', '"', '\'']);
        let end = after.find(|c: char| is_mark(c) || c == ' ').unwrap_or(after.len());
        let (value, left) = after.split_at(end);
        if name.starts_with(char::is_alphabetic) && name.len() <= LONGEST && number(value).is_some() {
            found.push(Pair { line, name, value });
        }
        rest = left;
    }
    found
}

/// Records whose numbers have their names beside them, as in YAML and in the logs of programs.
fn pairs(text: &str) -> Option<Made> {
    let all: Vec<Pair<'_>> = text.lines().enumerate().flat_map(|(n, line)| named(n + 1, line)).collect();
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    all.iter().for_each(|pair| *counts.entry(pair.name).or_default() += 1);
    let most = counts.values().copied().max().filter(|most| *most >= RECORDS)?;
    let is_repeated = |pair: &&Pair<'_>| 2 * counts[pair.name] > most;
    let start = all.iter().filter(is_repeated).find(|pair| role(pair.name).words().is_some())?;
    let mut names: Vec<String> = Vec::new();
    let mut records: Vec<(usize, Vec<String>)> = Vec::new();
    for pair in all.iter().filter(is_repeated).skip_while(|pair| !std::ptr::eq(*pair, start)) {
        if pair.name == start.name {
            records.push((pair.line, vec![String::new(); names.len()]));
        }
        let place = names.iter().position(|name| name == pair.name).unwrap_or(names.len());
        if place == names.len() {
            if names.len() == NAMES {
                return None;
            }
            names.push(pair.name.to_owned());
        }
        let record = &mut records.last_mut()?.1;
        record.resize(names.len(), String::new());
        pair.value.clone_into(&mut record[place]);
    }
    records.iter_mut().for_each(|record| record.1.resize(names.len(), String::new()));
    let above = Above::of(text.lines().take(start.line.saturating_sub(1)));
    let columns = Columns::find(&names, &above.constants).ok()?;
    let notes = vec!["records: each number has its name beside it".to_owned()];
    Some(Made { columns, rows: records, angle_unit: above.angle_unit, notes, mirror: None })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_begins_with_a_letter_and_is_short() {
        let longest = "a".repeat(LONGEST);
        assert_eq!(first(&format!(" \"{longest}\" ,1"), ','), Some(longest.as_str()));
        assert_eq!(first(&format!("{longest}a,1"), ','), None);
        assert_eq!(first("10,1", ','), None);
    }
}
