//! Tables of fitted parameters: a header that names the columns, then a row a material, its name first.

use crate::ReadError;
use crate::file::rows::text;

/// Finds the row of a material; the header has to be exactly the one given.
pub(super) fn find(bytes: &[u8], header: &str, material: &str) -> Result<Vec<f64>, ReadError> {
    let fail = |text: String| Err(ReadError::Content(text));
    let mut lines = text(bytes)?.lines();
    if lines.next().map(str::trim) != Some(header) {
        return fail(format!("the first line has to be {header}"));
    }
    let columns = header.split(',').count() - 1;
    let mut near = Vec::new();
    for (n, line) in lines.enumerate() {
        let mut words = line.trim().split(',');
        let name = words.next().unwrap_or_default();
        if name != material {
            if name.contains(material) || near.len() < 3 {
                near.insert(if name.contains(material) { 0 } else { near.len() }, name);
            }
            continue;
        }
        let line = n + 2;
        let mut values = Vec::with_capacity(columns);
        for (index, word) in words.enumerate() {
            let value: f64 =
                word.parse().ok().filter(|v: &f64| v.is_finite()).ok_or_else(|| ReadError::Word {
                    line,
                    index: index + 1,
                    found: word.chars().take(40).collect(),
                    expected: "a finite number".to_owned(),
                })?;
            values.push(value);
        }
        if values.len() != columns {
            return fail(format!("line {line}: {} numbers where {columns} were expected", values.len()));
        }
        return Ok(values);
    }
    near.truncate(5);
    fail(format!("no material `{material}`; there are, among others, {}", near.join(", ")))
}
