//! The inputs of a batch and its wanted outputs: outputs that are given are wanted.

use crate::error::Error;
use crate::mixture::rows::Sample;
use glam::Vec3;

/// The request of a batch for each of its n hits: draws, values and densities, or both.
///
/// Every slice is `[n]`; outputs are overwritten. An output that is `None` is not wanted, and its work is left out where that
/// saves time. [`Draws`] alone and [`Towards`] alone are requests too, by `into()`.
///
/// # Examples
/// ```
/// use srbf_core::{Draws, Lobe, Mixture, Request, Towards};
///
/// let mixture = Mixture::<16>::hemisphere(&[Lobe::new([0.0, 0.0, 1.0], 40.0, [0.2; 3])?])?;
/// let u = [[0.1, 0.5, 0.9], [0.2, 0.4, 0.6], [0.3, 0.3, 0.3]];
/// let wi = [[0.0, 0.6, 0.0], [0.0, 0.0, 0.6], [1.0, 0.8, 0.8]];
/// let (mut direction, mut pdf, mut value) = ([[0.0; 3]; 3], [0.0; 3], [[0.0; 3]; 3]);
/// mixture.ask(Request {
///     // Directions with their densities; no weights.
///     draw: Some(Draws {
///         u: u.each_ref().map(|s| &s[..]),
///         direction: direction.each_mut().map(|s| &mut s[..]),
///         pdf: Some(&mut pdf),
///         weight: None,
///     }),
///     // And values towards other directions.
///     evaluate: Some(Towards {
///         wi: wi.each_ref().map(|s| &s[..]),
///         value: Some(value.each_mut().map(|s| &mut s[..])),
///         pdf: None,
///     }),
/// })?;
/// assert!(pdf.iter().all(|&p| p > 0.0) && value[0][0] > value[0][1]);
/// # Ok::<(), srbf_core::Error>(())
/// ```
#[derive(Debug, Default)]
pub struct Request<'a> {
    /// Directions to be drawn.
    pub draw: Option<Draws<'a>>,
    /// Directions to be evaluated towards.
    pub evaluate: Option<Towards<'a>>,
}

/// Directions that are drawn. Where nothing is reflected it is the normal, with density 0 and weight 0.
#[derive(Debug)]
pub struct Draws<'a> {
    /// Three uniform numbers in [0, 1) a draw.
    pub u: [&'a [f32]; 3],
    /// Incident directions, x, y, z, in the caller's shading frame.
    pub direction: [&'a mut [f32]; 3],
    /// Density at them; 1/sr.
    pub pdf: Option<&'a mut [f32]>,
    /// `f cos / pdf`, linear sRGB.
    pub weight: Option<[&'a mut [f32]; 3]>,
}

/// Values and densities towards incident directions.
#[derive(Debug)]
pub struct Towards<'a> {
    /// Incident directions, x, y, z, unit vectors.
    pub wi: [&'a [f32]; 3],
    /// `f cos`, linear sRGB; 1/sr.
    pub value: Option<[&'a mut [f32]; 3]>,
    /// The density of drawing them; 1/sr.
    pub pdf: Option<&'a mut [f32]>,
}

impl<'a> From<Draws<'a>> for Request<'a> {
    fn from(draw: Draws<'a>) -> Self {
        Self { draw: Some(draw), evaluate: None }
    }
}

impl<'a> From<Towards<'a>> for Request<'a> {
    fn from(towards: Towards<'a>) -> Self {
        Self { draw: None, evaluate: Some(towards) }
    }
}

impl Request<'_> {
    /// Refuses slices that are not of length `n`.
    #[inline(always)]
    pub(crate) fn check(&self, n: usize) -> Result<(), Error> {
        self.check_each(n, n)
    }

    /// Refuses slices that are not of the lengths of the draws and of the directions to evaluate.
    #[inline(always)]
    pub(crate) fn check_each(&self, drawn: usize, towards: usize) -> Result<(), Error> {
        // Without branches: a bit of any length that is another one.
        let three = |[a, b, c]: [&[f32]; 3], n| (a.len() ^ n) | (b.len() ^ n) | (c.len() ^ n);
        let three_out = |[a, b, c]: &[&mut [f32]; 3], n| (a.len() ^ n) | (b.len() ^ n) | (c.len() ^ n);
        let mut other = 0;
        if let Some(Draws { u, direction, pdf, weight }) = &self.draw {
            other |= three(*u, drawn) | three_out(direction, drawn);
            other |= pdf.as_ref().map_or(0, |pdf| pdf.len() ^ drawn);
            other |= weight.as_ref().map_or(0, |weight| three_out(weight, drawn));
        }
        if let Some(Towards { wi, value, pdf }) = &self.evaluate {
            other |= three(*wi, towards) | value.as_ref().map_or(0, |value| three_out(value, towards));
            other |= pdf.as_ref().map_or(0, |pdf| pdf.len() ^ towards);
        }
        if other == 0 { Ok(()) } else { Err(Error::Length) }
    }
}

/// One direction, or three uniform numbers.
pub(crate) fn at(vectors: &[&[f32]; 3], i: usize) -> Vec3 {
    Vec3::new(vectors[0][i], vectors[1][i], vectors[2][i])
}

/// Stores a direction or a colour.
#[inline(always)]
fn put([x, y, z]: &mut [&mut [f32]; 3], i: usize, v: &Vec3) {
    x[i] = v.x;
    y[i] = v.y;
    z[i] = v.z;
}

impl Draws<'_> {
    /// Stores a draw; `None` where nothing is reflected.
    #[inline(always)]
    pub(crate) fn put(&mut self, i: usize, sample: &Option<Sample>) {
        // By references: a copy of a struct waits for its numbers, which have just been stored one by one.
        match sample {
            Some(Sample { direction, pdf, weight }) => self.put_numbers(i, direction, *pdf, weight),
            None => self.put_numbers(i, &Vec3::Z, 0.0, &Vec3::ZERO),
        }
    }

    #[inline(always)]
    fn put_numbers(&mut self, i: usize, direction: &Vec3, density: f32, colour: &Vec3) {
        put(&mut self.direction, i, direction);
        if let Some(pdf) = &mut self.pdf {
            pdf[i] = density;
        }
        if let Some(weight) = &mut self.weight {
            put(weight, i, colour);
        }
    }
}

impl Towards<'_> {
    /// Stores a value and a density.
    #[inline(always)]
    pub(crate) fn put(&mut self, i: usize, value: &Vec3, density: f32) {
        if let Some(to) = &mut self.value {
            put(to, i, value);
        }
        if let Some(pdf) = &mut self.pdf {
            pdf[i] = density;
        }
    }
}
