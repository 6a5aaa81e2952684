//! Slices that a batch reads and writes: structures of arrays, all of one length.

use crate::error::Error;

/// Where a batch of samples goes.
#[derive(Debug)]
pub struct SamplesMut<'a> {
    /// Incident directions, x, y, z, in the caller's shading frame.
    pub direction: [&'a mut [f32]; 3],
    /// Density at them; 1/sr.
    pub pdf: &'a mut [f32],
    /// `f cos / pdf`, linear sRGB.
    pub weight: [&'a mut [f32]; 3],
}

pub(crate) fn same_length(lengths: impl IntoIterator<Item = usize>) -> Result<(), Error> {
    let mut lengths = lengths.into_iter();
    let first = lengths.next().unwrap_or(0);
    if lengths.all(|n| n == first) { Ok(()) } else { Err(Error::Length) }
}
