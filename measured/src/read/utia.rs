//! Reader of the binary tables of the UTIA BRDF database: three planes of 288 by 288 numbers, without a head.
//!
//! Rows are directions of the light, columns those of the viewer: zeniths from 0 to 75 degrees by 15, each at 48 azimuths of 7.5 degrees.

use super::conventions::Conventions;
use super::intake::{Intake, Reading};
use crate::ReadError;
use crate::table::direction;

/// Zeniths and azimuths of a direction, and their steps in degrees.
const ZENITHS: usize = 6;
const AZIMUTHS: usize = 48;
const STEPS: [f64; 2] = [15.0, 7.5];

/// Numbers of a channel.
const PLANE: usize = ZENITHS * AZIMUTHS * ZENITHS * AZIMUTHS;

/// Bytes of a file.
pub(super) const SIZE: usize = 3 * PLANE * 8;

/// Parses the bytes of a file.
///
/// # Errors
/// [`ReadError`] for another size, and for a value that is no BRDF.
pub fn parse(bytes: &[u8], conventions: &Conventions) -> Result<Intake, ReadError> {
    let (numbers, rest) = bytes.as_chunks();
    let values: Vec<f64> = numbers.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
    if !rest.is_empty() || values.len() != 3 * PLANE {
        return Err(ReadError::Content(format!("UTIA: {SIZE} bytes are expected, not {}", bytes.len())));
    }
    if let Some(odd) = values.iter().position(|v| !(v.is_finite() && v.abs() < 1e9)) {
        return Err(ReadError::Content(format!(
            "UTIA: number {odd} is no value of a BRDF; or the file is of another kind"
        )));
    }
    let mut reading = Reading::new("UTIA", conventions);
    reading.note("by its size the file is of the UTIA database: three planes of 288 by 288 numbers, zeniths by 15 degrees");
    let towards = |n: usize| {
        let (theta, phi) = ((n / AZIMUTHS) as f64 * STEPS[0], (n % AZIMUTHS) as f64 * STEPS[1]);
        direction(theta.to_radians(), phi.to_radians())
    };
    let viewers = ZENITHS * AZIMUTHS;
    for at in 0..PLANE {
        let rgb = [0, 1, 2].map(|channel| values[channel * PLANE + at]);
        reading.push(at + 1, [towards(at / viewers), towards(at % viewers)], rgb, &rgb);
    }
    reading.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bytes of a file of a function of zeniths and azimuths, degrees, of light and viewer.
    fn file(f: impl Fn([f64; 2], [f64; 2]) -> f64) -> Vec<u8> {
        let at = |n: usize| [(n / AZIMUTHS) as f64 * STEPS[0], (n % AZIMUTHS) as f64 * STEPS[1]];
        let viewers = ZENITHS * AZIMUTHS;
        let plane: Vec<u8> =
            (0..PLANE).flat_map(|n| f(at(n / viewers), at(n % viewers)).to_le_bytes()).collect();
        plane.repeat(3)
    }

    #[test]
    fn numbers_are_at_their_directions_and_odd_ones_are_errors() {
        let parse = |bytes: &[u8]| parse(bytes, &Conventions::default());
        // No two directions of a kind have the same value.
        let bytes = file(|light, viewer| {
            0.1 + 1e-3 * light[0] + 1e-5 * viewer[0] + 1e-7 * light[1] + 1e-9 * viewer[1]
        });
        let intake = parse(&bytes).unwrap();
        assert_eq!(intake.rows.len(), PLANE);
        for row in intake.rows.iter().step_by(997) {
            let (theta, phi) = (
                |d: [f64; 3]| d[2].acos().to_degrees(),
                |d: [f64; 3]| d[1].atan2(d[0]).to_degrees().rem_euclid(360.0),
            );
            let value = |phi_i: f64, phi_o: f64| {
                0.1 + 1e-3 * theta(row.wi) + 1e-5 * theta(row.wo) + 1e-7 * phi_i + 1e-9 * phi_o
            };
            // At the normal there is no azimuth.
            let most = if theta(row.wi) < 1.0 || theta(row.wo) < 1.0 { 4e-5 } else { 1e-10 };
            let expected = value(phi(row.wi), phi(row.wo));
            assert!((row.rgb[0] - expected).abs() < most, "{row:?}, not {expected}");
        }
        assert!(parse(&bytes[1..]).is_err());
        for odd in [f64::NAN, f64::INFINITY, 1e10] {
            assert!(parse(&file(|_, _| odd)).unwrap_err().to_string().contains("number 0"));
        }
        // Black, and nothing but marks.
        assert!(parse(&file(|_, _| 0.0)).unwrap().is_black);
        assert!(parse(&file(|_, _| -999.0)).is_err());
    }
}
