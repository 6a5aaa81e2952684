//! Tables as JSON: records, columns, or rows beside their names, as pandas and others write them.

use super::conventions::Conventions;
use super::csv;
use super::intake::Intake;
use crate::ReadError;
use crate::file::decode::decode;
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// Parses the bytes of a file.
///
/// # Errors
/// [`ReadError`], with what stopped it.
pub fn parse(bytes: &[u8], conventions: &Conventions) -> Result<Intake, ReadError> {
    let text = decode(bytes)?;
    let json = document(&text)?;
    of_json(&json, conventions)?.ok_or_else(|| {
        ReadError::Content(
            "JSON: records such as [{\"theta_i\": 10, ...}, ...] or columns {\"theta_i\": [10, ...], ...} are expected".into(),
        )
    })
}

/// The document of a text. Of several, such as a record a line, an array.
pub(super) fn document(text: &str) -> Result<Value, ReadError> {
    let all = serde_json::Deserializer::from_str(text).into_iter().collect::<Result<Vec<Value>, _>>();
    let mut all = all.map_err(|error| ReadError::Content(format!("JSON: {error}")))?;
    Ok(if all.len() == 1 { all.swap_remove(0) } else { Value::Array(all) })
}

/// The table of a document; `None` where it holds none.
pub(super) fn of_json(json: &Value, conventions: &Conventions) -> Result<Option<Intake>, ReadError> {
    let Some((names, rows)) = table(json) else { return Ok(None) };
    let text = |value: &Value| match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    };
    let rows = rows.into_iter().enumerate();
    let rows = rows.map(|(n, row)| (n + 1, row.into_iter().map(text).collect())).collect();
    csv::parse_rows("table as JSON", &names, rows, Vec::new(), conventions).map(Some)
}

/// Names, and rows of cells.
type Rows<'a> = (Vec<String>, Vec<Vec<&'a Value>>);

fn table(json: &Value) -> Option<Rows<'_>> {
    match json {
        Value::Array(rows) if rows.first()?.is_object() => {
            let names: Vec<String> = flat(rows.first()?).into_iter().map(|part| part.0).collect();
            let mut all = Vec::with_capacity(rows.len());
            for record in rows {
                record.as_object()?;
                let parts: BTreeMap<String, &Value> = flat(record).into_iter().collect();
                all.push(names.iter().map(|name| parts.get(name).copied().unwrap_or(&Value::Null)).collect());
            }
            Some((names, all))
        }
        Value::Array(rows) => named(rows.first()?, &rows[1..]),
        Value::Object(parts) => match (parts.get("columns"), parts.get("data")) {
            (Some(names), Some(data)) => named(names, data.as_array()?),
            (None, Some(data)) => table(data),
            _ => columns(parts).or_else(|| {
                // The one part that is records, beside facts about them.
                let is_records =
                    |part: &&Value| part.as_array().is_some_and(|rows| rows.len() > 1 && rows[0].is_object());
                let mut records = parts.values().filter(is_records);
                records.next().filter(|_| records.next().is_none()).and_then(table)
            }),
        },
        _ => None,
    }
}

/// Columns of one length, by their names.
fn columns(parts: &Map<String, Value>) -> Option<Rows<'_>> {
    let names: Vec<String> = parts.keys().cloned().collect();
    let columns: Vec<Vec<&Value>> = parts.values().map(cells).collect::<Option<_>>()?;
    let count = columns.first()?.len();
    if columns.iter().any(|column| column.len() != count) {
        return None;
    }
    Some((names, (0..count).map(|n| columns.iter().map(|column| column[n]).collect()).collect()))
}

/// The numbers and words of a record, those of parts within it by the names of both: `incident theta`.
fn flat(record: &Value) -> Vec<(String, &Value)> {
    let parts = record.as_object().into_iter().flatten();
    parts
        .flat_map(|(name, value)| match value {
            Value::Object(within) => {
                within.iter().map(|(part, value)| (format!("{name} {part}"), value)).collect()
            }
            Value::Array(three) if three.len() == 3 => {
                let is_color =
                    ["rgb", "color", "colour", "brdf", "value"].contains(&name.to_lowercase().as_str());
                let parts = if is_color { ["r", "g", "b"] } else { ["x", "y", "z"] };
                let named = |part: &str| if is_color { part.to_owned() } else { format!("{name} {part}") };
                parts.into_iter().map(named).zip(three).collect()
            }
            value => vec![(name.clone(), value)],
        })
        .collect()
}

/// Rows beside their names.
fn named<'a>(names: &Value, rows: &'a [Value]) -> Option<Rows<'a>> {
    let names: Option<Vec<String>> =
        names.as_array()?.iter().map(|name| name.as_str().map(str::to_owned)).collect();
    let rows: Option<Vec<Vec<&Value>>> =
        rows.iter().map(|row| Some(row.as_array()?.iter().collect())).collect();
    Some((names?, rows?))
}

/// The cells of a column, which pandas numbers.
fn cells(column: &Value) -> Option<Vec<&Value>> {
    match column {
        Value::Array(cells) => Some(cells.iter().collect()),
        Value::Object(cells) => Some(cells.values().collect()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Records of an array, a record a line, and columns are the same; null was not measured.
    #[test]
    fn records_in_any_shape_are_rows_and_null_is_no_value() {
        let record = |o: &str, value: f64| {
            format!("{{\"theta_i\": 10, \"theta_o\": {o}, \"dphi\": 180, \"value\": {value}}}")
        };
        let [a, b, c] = [record("20", 0.25), record("null", 0.4), record("60", 0.5)];
        let columns = "{\"theta_i\": [10, 10, 10], \"theta_o\": [20, null, 60], \"dphi\": [180, 180, 180], \"value\": [0.25, 0.4, 0.5]}";
        for text in [format!("[{a}, {b}, {c}]"), format!("{a}\n{b}\n{c}\n"), columns.to_owned()] {
            let intake = parse(text.as_bytes(), &Conventions::default()).unwrap();
            let found: Vec<(usize, f64)> = intake.rows.iter().map(|row| (row.line, row.rgb[1])).collect();
            assert_eq!((found, intake.left_out_count()), (vec![(1, 0.25), (3, 0.5)], 1), "{text}");
        }
        let nested =
            "{\"wi\": [0, 0.6, 0.8], \"out\": {\"x\": 0.6, \"y\": 0, \"z\": 0.8}, \"rgb\": [0.1, 0.2, 0.3]}";
        let intake = parse(
            format!("{{\"by\": \"us\", \"all\": [{nested}, {nested}]}}").as_bytes(),
            &Conventions::default(),
        )
        .unwrap();
        assert_eq!(
            (intake.rows.len(), intake.rows[1].wi, intake.rows[1].rgb),
            (2, [0.0, 0.6, 0.8], [0.1, 0.2, 0.3])
        );
        for text in ["[]", "[1, 2]", "{\"a\": 1}", "[{}", "{\"theta_i\": 10}\n{\"theta_i\": "] {
            assert!(parse(text.as_bytes(), &Conventions::default()).is_err(), "{text}");
        }
    }
}
