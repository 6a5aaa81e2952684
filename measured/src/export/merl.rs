//! Writer of MERL `.binary` files.

use super::{check_isotropic, finite};
use crate::FitError;
use crate::read::merl::{CELLS, SCALE, SIZE, directions};
use crate::table::Brdf;
use rayon::prelude::*;

/// Least f that is written; 1/sr.
const LEAST: f64 = 1e-30;

/// The last eight bytes of a file that is written here: as a number, -1.0000004. That cell lies below the horizon, where any negative number
/// says the same. The format has no other place for a name.
pub const MERL_MARK: [u8; 8] = *b"srbf\0\0\xf0\xbf";

/// A MERL file.
#[derive(Clone, Debug)]
pub struct MerlFile {
    /// Its bytes.
    pub bytes: Vec<u8>,
    /// Share of the numbers above the horizon that were negative, and are 0: a negative number says that nothing was measured.
    pub negatives: f64,
}

/// Writes an isotropic BRDF as a MERL `.binary` file: its values at the centres of 90 x 90 x 180 cells.
///
/// A cell has one value for a pair of directions and the same exchanged: the mean of both is stored. Where a direction is below the horizon, or
/// where nothing was measured, -1 stands, as in the measured files; at the end of the file [`MERL_MARK`]. The caller's threads of rayon are used.
///
/// # Errors
/// [`FitError::Table`] for an anisotropic BRDF.
pub fn merl(brdf: &dyn Brdf) -> Result<MerlFile, FitError> {
    check_isotropic(brdf)?;
    let cells: Vec<Option<[f64; 3]>> = (0..CELLS).into_par_iter().map(|cell| value(brdf, cell)).collect();
    let mut bytes = Vec::with_capacity(12 + 24 * CELLS);
    SIZE.iter().for_each(|&size| bytes.extend((size as i32).to_le_bytes()));
    let (mut all, mut negatives) = (0usize, 0usize);
    for (channel, scale) in SCALE.iter().enumerate() {
        for cell in &cells {
            let stored = match cell {
                Some(rgb) => {
                    all += 1;
                    negatives += usize::from(rgb[channel] < 0.0);
                    // All three 0 would say that nothing was measured.
                    rgb[channel].max(LEAST) / scale
                }
                None => -1.0,
            };
            bytes.extend(stored.to_le_bytes());
        }
    }
    let end = bytes.len() - MERL_MARK.len();
    bytes[end..].copy_from_slice(&MERL_MARK);
    Ok(MerlFile { bytes, negatives: negatives as f64 / all.max(1) as f64 })
}

/// The value at the centre of a cell, if both directions are above the horizon and most of it was measured.
fn value(brdf: &dyn Brdf, cell: usize) -> Option<[f64; 3]> {
    let (wi, wo) = directions(cell)?;
    if brdf.measured(wi, wo) + brdf.measured(wo, wi) < 1.0 {
        return None;
    }
    let (a, b) = (finite(brdf.evaluate(wi, wo)), finite(brdf.evaluate(wo, wi)));
    Some([0, 1, 2].map(|c| 0.5 * (a[c] + b[c])))
}
