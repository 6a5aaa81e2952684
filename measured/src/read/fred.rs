//! Reader of FRED's scatter data as text: blocks of a direction of incidence, and rows of theta, phi and value.
//!
//! `type bsdf_data`, then `format angles=deg bsdf=value scale=1`. The mirror direction is at phi 0.

use super::conventions::Conventions;
use super::intake::{Intake, Reading};
use crate::ReadError;
use crate::file::decode::{decode, shortened};
use crate::file::rows::numbers;
use crate::table::direction;
use std::f64::consts::PI;

/// Parses the bytes of a file.
///
/// # Errors
/// [`ReadError`], with the line of the fault.
pub fn parse(bytes: &[u8], conventions: &Conventions) -> Result<Intake, ReadError> {
    let fail = |line: usize, text: String| Err(ReadError::Content(format!("line {line}: {text}")));
    let text = decode(bytes)?;
    let mut reading = Reading::new("FRED", conventions);
    let (mut radians, mut scale) = (PI / 180.0, 1.0);
    let mut incident = None;
    for (n, line) in text.lines().enumerate().skip(1).map(|(n, line)| (n + 1, line.trim())) {
        if line.is_empty() || line.starts_with(['!', '#', '/']) {
            continue;
        }
        if line.starts_with(|c: char| c.is_ascii_alphabetic()) {
            for (key, value) in line.split_whitespace().filter_map(|word| word.split_once('=')) {
                match (key, value) {
                    ("angles", "deg") => radians = PI / 180.0,
                    ("angles", "rad") => radians = 1.0,
                    ("bsdf", "value") => {}
                    ("scale", number) => match number.parse::<f64>() {
                        Ok(number) if number > 0.0 && number < 1e9 => scale = number,
                        _ => {
                            return fail(
                                n,
                                format!("scale `{}`: a number above 0 is expected", shortened(number)),
                            );
                        }
                    },
                    ("angles" | "bsdf", other) => {
                        let read = "angles=deg, angles=rad and bsdf=value are read";
                        return fail(n, format!("`{key}={}`: {read}", shortened(other)));
                    }
                    _ => {}
                }
            }
            continue;
        }
        if line.split_whitespace().count() == 2 {
            let mut pair = [0.0; 2];
            numbers(n, line, &mut pair)?;
            incident = Some(pair.map(|angle| angle * radians));
            continue;
        }
        let Some([theta_i, phi_i]) = incident else {
            return fail(n, "the angle and azimuth of incidence are expected above the rows".into());
        };
        let mut row = [0.0; 3];
        numbers(n, line, &mut row)?;
        let [theta, phi] = [row[0], row[1]].map(|angle| angle * radians);
        if theta.abs() > PI + 1e-3 || theta_i.abs() > PI + 1e-3 {
            return fail(n, "an angle from the normal is beyond 180 degrees".into());
        }
        let value = row[2] * scale;
        reading.push(n, [direction(theta_i, phi_i), direction(theta, phi + PI)], [value; 3], &[value]);
    }
    reading.note("FRED: phi 0 is the side of the mirror direction");
    reading.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_format_is_followed_or_refused() {
        let of = |format: &str, numbers: &str| {
            let text = format!("type bsdf_data\nformat {format}\n{numbers}");
            parse(text.as_bytes(), &Conventions::default())
        };
        let degrees = "10 0\n30 90 0.25\n";
        for (format, word) in [
            ("angles=grad bsdf=value", "angles=grad"),
            ("angles=deg bsdf=log", "bsdf=log"),
            ("angles=deg bsdf=value scale=-1", "scale `-1`"),
        ] {
            let error = of(format, degrees).unwrap_err().to_string();
            assert!(error.contains("line 2") && error.contains(word), "{format}: {error}");
        }
        let row = |format: &str, numbers: &str| of(format, numbers).unwrap().rows[0];
        let [plain, twice] =
            ["scale=1", "scale=2"].map(|s| row(&format!("angles=deg bsdf=value {s}"), degrees));
        assert_eq!((plain.wi, plain.wo, 2.0 * plain.rgb[0]), (twice.wi, twice.wo, twice.rgb[0]));
        let radians = row("angles=rad bsdf=value", "0.174532925 0\n0.523598776 1.570796327 0.25\n");
        assert!((0..3).all(|k| (radians.wo[k] - plain.wo[k]).abs() < 1e-8), "{radians:?} {plain:?}");
    }
}
