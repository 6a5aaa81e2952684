//! A row for each wavelength: rows of one pair of directions are a spectrum.

use super::super::intake::{Intake, Reading};
use super::super::reason::Reason;
use super::super::wavelengths::Wavelengths;
use super::Numbers;
use super::geometry::{Geometry, NUMBERS};
use crate::ReadError;
use std::collections::BTreeMap;

/// Puts the rows of each pair of directions together; `share`: of a value.
pub(super) fn finish(
    geometry: &Geometry,
    rows: Vec<Numbers>,
    share: f64,
    mut reading: Reading,
) -> Result<Intake, ReadError> {
    let mut wavelengths: Vec<f64> = rows.iter().map(|row| row.values[0]).collect();
    wavelengths.sort_by(f64::total_cmp);
    wavelengths.dedup();
    let to_rgb = reading.wavelengths_are(Wavelengths::new(&wavelengths)?, share)?;
    let mut groups: BTreeMap<[u64; NUMBERS], Vec<Numbers>> = BTreeMap::new();
    for row in rows {
        groups.entry(row.directions.map(f64::to_bits)).or_default().push(row);
    }
    let mut groups: Vec<Vec<Numbers>> = groups.into_values().collect();
    groups.sort_by_key(|group| group[0].line);
    for group in groups {
        let line = group[0].line;
        // Too few rows lack a wavelength: the work is that of the rows, however many wavelengths there are.
        if group.len() < wavelengths.len() {
            reading.leave_out(Reason::NoNumber, line);
            continue;
        }
        let mut spectrum = vec![(0.0, 0usize); wavelengths.len()];
        for row in &group {
            let at = wavelengths.partition_point(|w| *w < row.values[0]);
            spectrum[at].0 += row.values[1];
            spectrum[at].1 += 1;
        }
        if spectrum.iter().any(|(_, count)| *count == 0) {
            reading.leave_out(Reason::NoNumber, line);
            continue;
        }
        let spectrum: Vec<f64> = spectrum.into_iter().map(|(sum, count)| sum / count as f64).collect();
        let directions = geometry.directions(&group[0])?;
        reading.push(line, directions, to_rgb.rgb(&spectrum).map(|v| share * v), &spectrum);
    }
    reading.finish()
}
