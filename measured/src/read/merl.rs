//! Reader of MERL `.binary` files (Matusik et al. 2003): 90 x 90 x 180 cells of half angle, difference angle and azimuth.
//!
//! Three little-endian i32 (90, 90, 180), then three planes (red, green, blue) of f64, azimuth fastest. The half angle is cut
//! finer near 0, by the square root. Cells with a negative channel were not measured, nor were those that are 0 in all three, unless none is
//! brighter and half of all are 0: then the surface is black, and has f of 1e-9 / sr. Between the centres of the cells the value is interpolated linearly, among the cells that were measured; where there is none,
//! the value is no number. [`Filled`](super::Filled) says which ones.

use super::rusinkiewicz::{HalfAndDifference, half_and_difference};
use crate::ReadError;
use crate::table::{BLACK, Brdf, direction};
use std::f64::consts::{FRAC_PI_2, PI};

/// Cells along the half angle, the difference angle, and its azimuth.
pub(crate) const SIZE: [usize; 3] = [90, 90, 180];
pub(crate) const CELLS: usize = SIZE[0] * SIZE[1] * SIZE[2];
/// Factors on the numbers of each channel.
pub(crate) const SCALE: [f64; 3] = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];
/// Largest number of a cell; after scaling it is beyond any surface, and far from the largest f32.
const LARGEST: f64 = 1e30;

/// The first bytes of a file: its counts.
pub(super) const HEAD: [u8; 12] = [90, 0, 0, 0, 90, 0, 0, 0, 180, 0, 0, 0];

/// One MERL material.
#[derive(Clone, Debug, PartialEq)]
pub struct Merl {
    /// Scaled values, no numbers where nothing was measured.
    cells: Vec<[f32; 3]>,
}

/// The two directions at the centre of a cell, if both are above the horizon.
pub(crate) fn directions(cell: usize) -> Option<([f64; 3], [f64; 3])> {
    let centre = |index: usize, size: usize| (index as f64 + 0.5) / size as f64;
    let half = centre(cell / (SIZE[1] * SIZE[2]), SIZE[0]);
    let difference = centre(cell / SIZE[2] % SIZE[1], SIZE[1]) * FRAC_PI_2;
    let d = direction(difference, centre(cell % SIZE[2], SIZE[2]) * PI);
    let (across, along) = libm::sincos(half * half * FRAC_PI_2);
    // The difference vector, and its mirror image, seen from the normal in place of the half vector.
    let turned = |d: [f64; 3]| [along * d[0] + across * d[2], d[1], along * d[2] - across * d[0]];
    let (wi, wo) = (turned(d), turned([-d[0], -d[1], d[2]]));
    (wi[2] > 0.0 && wo[2] > 0.0).then_some((wi, wo))
}

impl Merl {
    /// Share of the cells with both directions above the horizon that were not measured.
    pub fn missing(&self) -> f64 {
        let (mut all, mut missing) = (0usize, 0usize);
        for (n, cell) in self.cells.iter().enumerate() {
            if directions(n).is_some() {
                all += 1;
                missing += usize::from(cell[0].is_nan());
            }
        }
        missing as f64 / all as f64
    }

    /// Samples at the centres of measured cells: incident direction, outgoing direction and f. About `count`, spread over the cells.
    pub(crate) fn samples(&self, count: usize) -> Vec<([f64; 3], [f64; 3], [f64; 3])> {
        let measured = || (0..CELLS).filter(|&n| !self.cells[n][0].is_nan());
        let every = (measured().count() / count.max(1)).max(1);
        // Not a divisor of the cells in a row, so that all azimuths are met.
        let every = every + usize::from(every.is_multiple_of(2));
        let sample = |n: usize| {
            let (wi, wo) = directions(n)?;
            Some((wi, wo, self.cells[n].map(f64::from)))
        };
        measured().step_by(every).filter_map(sample).collect()
    }
}

/// Refuses a file of another size than a MERL file has.
pub(crate) fn check_size(bytes: u64) -> Result<(), ReadError> {
    let expected = 12 + 3 * 8 * CELLS as u64;
    if bytes == expected {
        return Ok(());
    }
    Err(ReadError::Content(format!("{bytes} bytes; a MERL file has {expected}")))
}

/// Parses the bytes of a `.binary` file.
///
/// # Errors
/// [`ReadError::Content`] for another size, other counts, numbers that are not finite or above 1e30, and a file without a measured cell.
pub fn parse(bytes: &[u8]) -> Result<Merl, ReadError> {
    check_size(bytes.len() as u64)?;
    for (i, size) in SIZE.iter().enumerate() {
        let b = &bytes[4 * i..4 * i + 4];
        let count = i32::from_le_bytes([b[0], b[1], b[2], b[3]]);
        if usize::try_from(count) != Ok(*size) {
            return Err(ReadError::Content(format!("count {} is {count}; a MERL file has {size}", i + 1)));
        }
    }
    let mut cells = vec![[0f32; 3]; CELLS];
    for channel in 0..3 {
        let plane = &bytes[12 + 8 * CELLS * channel..];
        for (n, (cell, b)) in cells.iter_mut().zip(plane.chunks_exact(8)).enumerate() {
            let v = f64::from_le_bytes([b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]]);
            if !v.is_finite() || v > LARGEST {
                let text =
                    format!("channel {channel}, cell {n}: {v} where a number up to {LARGEST} was expected");
                return Err(ReadError::Content(text));
            }
            // Not measured is not measured, however far below 0.
            cell[channel] = (v.max(-1.0) * SCALE[channel]) as f32;
        }
    }
    let is_below = |cell: &[f32; 3]| cell.iter().any(|v| *v < 0.0);
    let is_zero = |cell: &[f32; 3]| *cell == [0.0; 3];
    let mut zero = f32::NAN;
    if cells.iter().all(|cell| is_below(cell) || is_zero(cell)) {
        if cells.iter().filter(|cell| is_zero(cell)).count() < CELLS / 2 {
            return Err(ReadError::Content(
                "no cell was measured: all are negative, or a few of them 0".into(),
            ));
        }
        zero = BLACK as f32;
    }
    for cell in &mut cells {
        if is_below(cell) {
            *cell = [f32::NAN; 3];
        } else if is_zero(cell) {
            *cell = [zero; 3];
        }
    }
    Ok(Merl { cells })
}

impl Merl {
    /// The value, if something was measured, and the share of it that was.
    fn interpolated(&self, wi: [f64; 3], wo: [f64; 3]) -> ([f64; 3], f64) {
        let HalfAndDifference { across, along, difference: d } = half_and_difference(wi, wo);
        let theta_h = libm::atan2(across, along);
        let theta_d = libm::atan2(libm::hypot(d[0], d[1]), d[2]);
        let mut phi_d = libm::atan2(d[1], d[0]);
        if phi_d < 0.0 {
            phi_d += PI;
        }

        // Places between the centres of cells; the azimuth goes round after 180 degrees.
        let at = [
            libm::sqrt(theta_h / FRAC_PI_2) * SIZE[0] as f64 - 0.5,
            theta_d / FRAC_PI_2 * SIZE[1] as f64 - 0.5,
            phi_d / PI * SIZE[2] as f64 - 0.5,
        ];
        let (mut sum, mut weights) = ([0.0; 3], 0.0);
        for corner in 0..8 {
            let mut index = 0;
            let mut weight = 1.0;
            for (axis, (&at, &size)) in at.iter().zip(&SIZE).enumerate() {
                let low = libm::floor(at);
                let up = corner >> axis & 1;
                weight *= if up == 1 { at - low } else { 1.0 - (at - low) };
                let cell = low as i64 + i64::from(up);
                let cell =
                    if axis == 2 { cell.rem_euclid(size as i64) } else { cell.clamp(0, size as i64 - 1) };
                index = index * size + cell as usize;
            }
            let cell = self.cells[index];
            if !cell[0].is_nan() {
                (0..3).for_each(|c| sum[c] += weight * f64::from(cell[c]));
                weights += weight;
            }
        }
        (sum.map(|v| v / weights), weights)
    }
}

impl Brdf for Merl {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        self.interpolated(wi, wo).0
    }

    fn measured(&self, wi: [f64; 3], wo: [f64; 3]) -> f64 {
        self.interpolated(wi, wo).1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(value: f64) -> Vec<u8> {
        let mut bytes: Vec<u8> = [90i32, 90, 180].iter().flat_map(|n| n.to_le_bytes()).collect();
        (0..3 * CELLS).for_each(|n| bytes.extend((value * (n % CELLS) as f64).to_le_bytes()));
        bytes
    }

    #[test]
    fn a_file_of_another_size_or_content_is_an_error() {
        let good = file(1.0);
        assert!(parse(&good).is_ok());
        assert!(parse(&good[..good.len() - 1]).is_err() && parse(&[]).is_err());
        let error = parse(&file(-1.0)[..]).unwrap_err().to_string();
        assert!(error.contains("no cell was measured"), "{error}");
        for (at, byte) in [(0, 91), (8, 181), (3, 0x80)] {
            let mut bad = good.clone();
            bad[at] = byte;
            assert!(parse(&bad).is_err(), "{at}");
        }
        for (value, is_read) in [(1e30, true), (1.1e30, false), (1e300, false), (-1e300, true)] {
            let mut file = good.clone();
            file[12..20].copy_from_slice(&f64::to_le_bytes(value));
            let read = parse(&file);
            assert_eq!(read.is_ok(), is_read, "{value}");
            let has_infinity = read.is_ok_and(|merl| merl.cells[0].iter().any(|v| v.is_infinite()));
            assert!(!has_infinity, "{value}");
        }
        let mut bad = good;
        bad[12 + 6..12 + 8].copy_from_slice(&[0xf8, 0x7f]);
        assert!(parse(&bad).is_err());
    }

    /// A trap for light is a measurement.
    #[test]
    fn a_file_of_zeros_is_black() {
        let merl = parse(&file(0.0)).unwrap();
        assert_eq!(merl.missing(), 0.0);
        let f = merl.evaluate(direction(0.7, 0.3), direction(0.4, 2.0));
        assert!(f.iter().all(|v| (v / BLACK - 1.0).abs() < 1e-6), "{f:?}");
    }

    /// Both marks, and how near to them a value is a number.
    #[test]
    fn cells_that_were_not_measured_are_no_values() {
        let mut bytes = file(1e-3);
        let cell = (40 * SIZE[1] + 10) * SIZE[2] + 30;
        for (channel, mark) in [(0, -1.0f64), (1, 0.0), (2, 0.0)] {
            let at = 12 + 8 * (CELLS * channel + cell);
            bytes[at..at + 8].copy_from_slice(&mark.to_le_bytes());
        }
        let merl = parse(&bytes).unwrap();
        // And cell 0, which is 0.
        let above = (0..CELLS).filter(|&n| directions(n).is_some()).count();
        assert!((merl.missing() * above as f64 - 2.0).abs() < 1e-6, "{}", merl.missing());
        let (wi, wo) = directions(cell).unwrap();
        assert!(merl.measured(wi, wo) < 1e-6);
        let (wi, wo) = directions(cell + 1).unwrap();
        assert!(merl.measured(wi, wo) > 0.99 && merl.evaluate(wi, wo)[0] > 0.0);
    }

    #[test]
    fn values_are_continuous_and_reciprocal() {
        let merl = parse(&file(1e-3)).unwrap();
        let (a, b) = (direction(0.7, 0.3), direction(0.4, 2.0));
        let (ab, ba) = (merl.evaluate(a, b), merl.evaluate(b, a));
        assert!((ab[0] - ba[0]).abs() < 1e-6 * ab[0], "{ab:?} {ba:?}");
        let near = merl.evaluate(direction(0.7 + 1e-6, 0.3), b);
        assert!((near[0] - ab[0]).abs() < 1e-3 * ab[0]);
    }
}
