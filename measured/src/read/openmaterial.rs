//! Reader of ASAM OpenMATERIAL BRDF files (`.xompt`, JSON): rows of wavelength, three angles in radians, and a value.
//!
//! Angles are those of the incident and the outgoing direction from the normal, and the azimuth of the outgoing one from the incident.

use super::conventions::Conventions;
use super::intake::{Intake, Reading};
use super::reason::Reason;
use super::wavelengths::Wavelengths;
use crate::ReadError;
use crate::file::decode::decode;
use crate::table::direction;
use serde_json::Value;
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Parses the bytes of a file.
///
/// # Errors
/// [`ReadError::Content`], with the row of the table that stopped it.
pub fn parse(bytes: &[u8], conventions: &Conventions) -> Result<Intake, ReadError> {
    let fail = |text: String| Err(ReadError::Content(text));
    let text = decode(bytes)?;
    let json = super::records::document(text.trim_start_matches('\u{feff}'))?;
    let Some(table) = json.pointer("/brdf/lookupTable").and_then(Value::as_array) else {
        if let Some(intake) = super::records::of_json(&json, conventions)? {
            return Ok(intake);
        }
        return fail(
            "JSON without brdf.lookupTable of OpenMATERIAL, and without records such as [{\"theta_i\": 10, ...}, ...]: a BRDF is expected"
                .into(),
        );
    };
    let mut reading = Reading::new("ASAM OpenMATERIAL", conventions);
    // A pair of directions, its first row, and its values by wavelength.
    let mut pairs: BTreeMap<[u64; 3], (usize, BTreeMap<u64, f64>)> = BTreeMap::new();
    let mut wavelengths: Vec<f64> = Vec::new();
    for (n, row) in table.iter().enumerate() {
        let cells = row.as_array().map_or(&[][..], Vec::as_slice);
        // The schema allows values that are null.
        let is_null = |n: usize, cell: &Value| n == 4 && cell.is_null();
        let number = |(n, cell): (usize, &Value)| cell.as_f64().or(is_null(n, cell).then_some(f64::NAN));
        let numbers: Vec<f64> = cells.iter().enumerate().filter_map(number).collect();
        let Ok([wavelength, theta_i, theta_o, phi_o, value]) = <[f64; 5]>::try_from(numbers) else {
            return fail(format!(
                "brdf.lookupTable, row {}: five numbers are expected, wavelength, theta_in, theta_out, phi_out and value",
                n + 1
            ));
        };
        let is_angle = |theta: f64| (0.0..=PI + 1e-3).contains(&theta);
        if !is_angle(theta_i) || !is_angle(theta_o) || phi_o.abs() > 100.0 || value.abs() > 1e9 {
            return fail(format!(
                "brdf.lookupTable, row {}: angles in radians and a value up to 1e9 are expected",
                n + 1
            ));
        }
        wavelengths.push(wavelength);
        let key = [theta_i, theta_o, phi_o].map(f64::to_bits);
        let (_, spectrum) = pairs.entry(key).or_insert_with(|| (n + 1, BTreeMap::new()));
        // A wavelength is above 0, so that its bits are in its order.
        if !value.is_nan() {
            spectrum.insert(wavelength.to_bits(), value);
        }
    }
    wavelengths.sort_by(f64::total_cmp);
    wavelengths.dedup();
    let to_rgb = reading.wavelengths_are(Wavelengths::new(&wavelengths)?, 1.0)?;
    let mut pairs: Vec<_> = pairs.into_iter().collect();
    pairs.sort_by_key(|(_, (row, _))| *row);
    for (key, (row, spectrum)) in pairs {
        let [theta_i, theta_o, phi_o] = key.map(f64::from_bits);
        let values: Vec<f64> = spectrum.into_values().collect();
        if values.len() < wavelengths.len() {
            reading.leave_out(Reason::NoNumber, row);
            continue;
        }
        reading.push(row, [direction(theta_i, 0.0), direction(theta_o, phi_o)], to_rgb.rgb(&values), &values);
    }
    reading.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_samples_and_faults_have_their_row() {
        let file =
            |rows: &str| format!("{{\"brdf\": {{\"wavelengths\": [9.05e-7], \"lookupTable\": [{rows}]}}}}");
        let parse = |text: &str| parse(text.as_bytes(), &Conventions::default());
        let intake =
            parse(&file("[9.05e-7, 0.5, 0.5, 3.14159, 0.2], [9.05e-7, 0.5, 1.570796, 0, 0.2]")).unwrap();
        assert_eq!((intake.rows.len(), intake.left_out[0].reason), (1, Reason::Horizon));
        assert!(intake.rows[0].wi[0] > 0.0 && intake.rows[0].wo[0] < 0.0);
        assert!(intake.notes[0].text.contains("905"), "{:?}", intake.notes);
        for (text, word) in [
            (file("[9.05e-7, 0.5, 0.5, 0.2]"), "row 1"),
            (file("[9.05e-7, 0.5, 0.5, 0.2, 1], [9.05e-7, 45, 0.5, 0.2, 1]"), "row 2"),
            ("{\"a\": 1}".into(), "lookupTable"),
            ("{\"brdf\": ".into(), "JSON"),
            (file(""), "no wavelengths"),
        ] {
            let error = parse(&text).unwrap_err().to_string();
            assert!(error.contains(word), "{text}: {error}");
        }
    }
}
