//! Slices that a batch reads and writes: structures of arrays, all of one length.

use super::request::Draws;
use crate::error::Error;

/// Where a batch of samples goes.
///
/// # Examples
/// ```
/// use srbf_core::{Lobe, Mixture, SamplesMut};
///
/// let mixture = Mixture::<16>::hemisphere(&[Lobe::new([0.0, 0.0, 1.0], 40.0, [0.2; 3])?])?;
/// let u = [[0.1, 0.5, 0.9], [0.2, 0.4, 0.6], [0.3, 0.3, 0.3]];
/// let (mut direction, mut pdf, mut weight) = ([[0.0; 3]; 3], [0.0; 3], [[0.0; 3]; 3]);
/// let samples = SamplesMut {
///     direction: direction.each_mut().map(|component| &mut component[..]),
///     pdf: &mut pdf,
///     weight: weight.each_mut().map(|channel| &mut channel[..]),
/// };
/// mixture.sample_into(u.each_ref().map(|numbers| &numbers[..]), samples)?;
/// assert!(pdf.iter().all(|&p| p > 0.0));
/// # Ok::<(), srbf_core::Error>(())
/// ```
#[derive(Debug)]
pub struct SamplesMut<'a> {
    /// Incident directions, x, y, z, in the caller's shading frame.
    pub direction: [&'a mut [f32]; 3],
    /// Density at them; 1/sr.
    pub pdf: &'a mut [f32],
    /// `f cos / pdf`, linear sRGB.
    pub weight: [&'a mut [f32]; 3],
}

impl<'a> SamplesMut<'a> {
    /// As a part of a request.
    pub(crate) fn draws(self, u: [&'a [f32]; 3]) -> Draws<'a> {
        let Self { direction, pdf, weight } = self;
        Draws { u, direction, pdf: Some(pdf), weight: Some(weight) }
    }

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
