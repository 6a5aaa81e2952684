//! Writer of MERL `.binary` files.

use super::{check_isotropic, finite};
use crate::FitError;
use crate::read::merl::{CELLS, SCALE, SIZE};
use crate::table::{Brdf, direction};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

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
/// A cell has one value for a pair of directions and the same exchanged: the mean of both is stored. Where a direction is below the horizon,
/// -1 stands, as in the measured files. The caller's threads of rayon are used.
///
/// # Errors
/// [`FitError::Table`] for an anisotropic BRDF.
pub fn merl(brdf: &dyn Brdf) -> Result<MerlFile, FitError> {
    check_isotropic(brdf)?;
    let cells: Vec<Option<[f64; 3]>> = (0..CELLS).into_par_iter().map(|cell| value(brdf, cell)).collect();
    let mut bytes = Vec::with_capacity(12 + 24 * CELLS);
    SIZE.iter().for_each(|&size| bytes.extend((size as i32).to_le_bytes()));
    let (mut all, mut negatives) = (0, 0);
    for (channel, scale) in SCALE.iter().enumerate() {
        for cell in &cells {
            let stored = match cell {
                Some(rgb) => {
                    all += 1;
                    negatives += usize::from(rgb[channel] < 0.0);
                    rgb[channel].max(0.0) / scale
                }
                None => -1.0,
            };
            bytes.extend(stored.to_le_bytes());
        }
    }
    Ok(MerlFile { bytes, negatives: negatives as f64 / f64::from(all.max(1)) })
}

/// The value at the centre of a cell, if both directions are above the horizon.
fn value(brdf: &dyn Brdf, cell: usize) -> Option<[f64; 3]> {
    let centre = |index: usize, size: usize| (index as f64 + 0.5) / size as f64;
    let half = centre(cell / (SIZE[1] * SIZE[2]), SIZE[0]);
    let difference = centre(cell / SIZE[2] % SIZE[1], SIZE[1]) * FRAC_PI_2;
    let d = direction(difference, centre(cell % SIZE[2], SIZE[2]) * PI);
    let (across, along) = libm::sincos(half * half * FRAC_PI_2);
    // The difference vector, and its mirror image, seen from the normal in place of the half vector.
    let turned = |d: [f64; 3]| [along * d[0] + across * d[2], d[1], along * d[2] - across * d[0]];
    let (wi, wo) = (turned(d), turned([-d[0], -d[1], d[2]]));
    if wi[2] <= 0.0 || wo[2] <= 0.0 {
        return None;
    }
    let (a, b) = (finite(brdf.evaluate(wi, wo)), finite(brdf.evaluate(wo, wi)));
    Some([0, 1, 2].map(|c| 0.5 * (a[c] + b[c])))
}
