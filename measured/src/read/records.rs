//! Tables as JSON: records, columns, or rows beside their names, as pandas and others write them.

use super::conventions::Conventions;
use super::csv;
use super::intake::Intake;
use crate::ReadError;
use crate::file::decode::decode;
use serde_json::Value;

/// Parses the bytes of a file.
///
/// # Errors
/// [`ReadError`], with what stopped it.
pub fn parse(bytes: &[u8], conventions: &Conventions) -> Result<Intake, ReadError> {
    let text = decode(bytes)?;
    let json: Value =
        serde_json::from_str(&text).map_err(|error| ReadError::Content(format!("JSON: {error}")))?;
    of_json(&json, conventions)?.ok_or_else(|| {
        ReadError::Content(
            "JSON: records such as [{\"theta_i\": 10, ...}, ...] or columns {\"theta_i\": [10, ...], ...} are expected".into(),
        )
    })
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
            let names: Vec<String> = rows.first()?.as_object()?.keys().cloned().collect();
            let mut all = Vec::with_capacity(rows.len());
            for record in rows {
                let record = record.as_object()?;
                all.push(names.iter().map(|name| record.get(name).unwrap_or(&Value::Null)).collect());
            }
            Some((names, all))
        }
        Value::Array(rows) => named(rows.first()?, &rows[1..]),
        Value::Object(parts) => match (parts.get("columns"), parts.get("data")) {
            (Some(names), Some(data)) => named(names, data.as_array()?),
            (None, Some(data)) => table(data),
            _ => {
                let names: Vec<String> = parts.keys().cloned().collect();
                let columns: Vec<Vec<&Value>> = parts.values().map(cells).collect::<Option<_>>()?;
                let count = columns.first()?.len();
                if columns.iter().any(|column| column.len() != count) {
                    return None;
                }
                Some((names, (0..count).map(|n| columns.iter().map(|column| column[n]).collect()).collect()))
            }
        },
        _ => None,
    }
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
