//! The picture while it is rendered: sums of samples, and sums of their squares for the standard error.

use crate::trace::integrator::even::Lighting;
use anyhow::Context;
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// Most pixels that a picture may have, 4096 x 4096: the sums then take 800 MB.
pub const MAX_PIXELS: u64 = 1 << 24;

/// Bytes that a pixel takes while a picture is rendered and written: sums, radiance, and the encoded picture.
const PIXEL_BYTES: u64 = 100;

/// Finds out whether there is memory for a picture.
///
/// # Errors
/// Says how much is needed.
pub fn check_memory([width, height]: [u32; 2]) -> anyhow::Result<()> {
    let bytes = PIXEL_BYTES * u64::from(width) * u64::from(height);
    srbf_fit::check_memory(bytes).with_context(|| format!("a picture of {width}x{height}"))
}

/// The warning of lost samples, out of all; `None` if none is lost.
pub fn warning_of(lost: u64, of: u64) -> Option<String> {
    (lost > 0).then(|| format!("warning: {lost} of {of} samples are not finite, and count as black"))
}

/// One pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pixel {
    sum: DVec3,
    squares: DVec3,
}

impl Pixel {
    /// Adds one sample.
    #[inline]
    pub fn add(&mut self, radiance: Vec3) {
        let radiance = radiance.as_dvec3();
        self.sum += radiance;
        self.squares += radiance * radiance;
    }
}

/// A picture of pixels with the same number of samples each.
#[derive(Clone)]
pub struct Film {
    width: u32,
    height: u32,
    /// Samples that every pixel holds.
    pub samples: u32,
    /// Samples of any pixel that were not finite, and count as black.
    pub lost: u64,
    /// Rows from the top.
    pub pixels: Vec<Pixel>,
    /// The tile of the last samples, with its seed and its number: the next ones may need it too.
    pub lighting: Option<([u64; 2], Arc<Lighting>)>,
}

impl PartialEq for Film {
    fn eq(&self, other: &Self) -> bool {
        (self.width, self.samples, &self.pixels) == (other.width, other.samples, &other.pixels)
    }
}

impl std::fmt::Debug for Film {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} x {} pixels of {} samples", self.width, self.height, self.samples)
    }
}

impl Film {
    /// A black picture without samples.
    pub fn new([width, height]: [u32; 2]) -> Self {
        let pixels = vec![Pixel::default(); width as usize * height as usize];
        Self { width, height, samples: 0, lost: 0, lighting: None, pixels }
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// The warning about lost samples, if there are some.
    pub fn warning(&self) -> Option<String> {
        warning_of(self.lost, u64::from(self.samples) * self.pixels.len() as u64)
    }

    /// Mean of the samples of a pixel.
    pub fn mean(&self, pixel: usize) -> DVec3 {
        self.pixels[pixel].sum / f64::from(self.samples.max(1))
    }

    /// Variance of the mean of a pixel, estimated from its samples; 0 from fewer than two.
    pub fn variance_of_mean(&self, pixel: usize) -> DVec3 {
        let n = f64::from(self.samples);
        if n < 2.0 {
            return DVec3::ZERO;
        }
        let mean = self.mean(pixel);
        ((self.pixels[pixel].squares / n - mean * mean) / (n - 1.0)).max(DVec3::ZERO)
    }

    /// The means of all pixels, rows from the top.
    pub fn to_picture(&self) -> Vec<Vec3> {
        (0..self.pixels.len()).map(|i| self.mean(i).as_vec3()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lost_samples_are_counted_in_words() {
        let mut film = Film::new([3, 2]);
        film.samples = 4;
        assert_eq!(film.warning(), None);
        film.lost = 2;
        let expected = "warning: 2 of 24 samples are not finite, and count as black";
        assert_eq!(film.warning().as_deref(), Some(expected));
    }

    #[test]
    fn mean_and_its_variance() {
        let mut film = Film::new([1, 1]);
        for value in [1.0, 2.0, 3.0, 6.0] {
            film.pixels[0].add(Vec3::splat(value));
            film.samples += 1;
        }
        assert_eq!(film.mean(0), DVec3::splat(3.0));
        // Sample variance 14/3, over 4 samples.
        assert!((film.variance_of_mean(0).x - 14.0 / 12.0).abs() < 1e-12);
    }
}
