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

impl SamplesMut<'_> {
    /// The lengths of all slices.
    pub(crate) fn lengths(&self) -> impl Iterator<Item = usize> {
        let Self { direction, pdf, weight } = self;
        direction.iter().chain(weight).map(|s| s.len()).chain([pdf.len()])
    }
}

/// The one length of all slices.
pub(crate) fn same_length(lengths: impl IntoIterator<Item = usize>) -> Result<usize, Error> {
    let mut lengths = lengths.into_iter();
    let first = lengths.next().unwrap_or(0);
    if lengths.all(|n| n == first) { Ok(first) } else { Err(Error::Length) }
}
