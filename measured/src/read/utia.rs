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
