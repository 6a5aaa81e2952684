//! The error of a picture: relative mean squared error, and how much of it is bias.
//!
//! Of a pixel, the squared difference from the reference, the mean of three channels, over the square of the pixel's own brightness and of
//! a tenth of the picture's: so that dark parts count as bright ones do, and black ones do not count without end.

use crate::trace::camera::Camera;
use crate::trace::film::Film;
use crate::trace::scene::Scene;
use glam::DVec3;

/// Where the error is taken: the outgoing direction at most 80 degrees from the normal.
///
/// Gonioreflectometers end there, and beyond it a material is extrapolation. With the spikes that it has there a few
/// pixels of the outline would decide.
const LEAST_COSINE: f32 = 0.173_648_18;

/// Share of the pixels that are set apart: those that are worst, as where a single bright sample fell.
const APART: f64 = 1e-3;

/// Brightness, relative to the picture's, below which a pixel counts less.
const DARK: f64 = 0.1;

/// A mean over repeats, and its standard error; the latter is 0 of a single one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    pub mean: f64,
    pub error: f64,
}

impl Estimate {
    /// Of repeats.
    pub fn of(values: &[f64]) -> Self {
        let n = values.len().max(1) as f64;
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
        Self { mean, error: if values.len() < 2 { 0.0 } else { (squares / (n * (n - 1.0))).sqrt() } }
    }

    /// The ratio of two that do not depend on one another.
    pub fn over(self, other: Self) -> Self {
        let mean = self.mean / other.mean;
        let relative = |e: Self| e.error / e.mean;
        Self { mean, error: mean * relative(self).hypot(relative(other)) }
    }
}

/// Relative mean squared error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RelativeMse {
    /// Over all pixels.
    pub whole: f64,
    /// Without the 0.1 % of the pixels that are worst.
    pub trimmed: f64,
}

/// A pixel at which the error is taken.
struct Judged {
    index: usize,
    value: DVec3,
    /// Factor on a squared difference.
    weight: f64,
    /// Variance of the reference, relative as the error is.
    noise: f64,
}

/// Compares pictures with a reference.
pub struct Judge {
    pixels: Vec<Judged>,
    /// Error of the reference itself, from its two halves.
    pub own: RelativeMse,
}

impl Judge {
    /// A judge of the pixels of a scene's object; `halves` are two pictures that do not depend on one another, and their mean is the
    /// reference.
    pub fn new(scene: &Scene<'_>, camera: &Camera, size: [u32; 2], halves: &[Vec<DVec3>; 2]) -> Self {
        let [width, height] = size;
        let counts = |i: usize| {
            let ray = camera.ray((i as u32 % width) as f32 + 0.5, (i as u32 / width) as f32 + 0.5);
            scene.hit(&ray).is_some_and(|surface| surface.smooth.dot(ray.direction).abs() >= LEAST_COSINE)
        };
        let indices: Vec<usize> = (0..width as usize * height as usize).filter(|&i| counts(i)).collect();
        let value = |i: usize| 0.5 * (halves[0][i] + halves[1][i]);
        let brightness = |i: usize| value(i).abs().element_sum() / 3.0;
        let mean = indices.iter().map(|&i| brightness(i)).sum::<f64>() / indices.len().max(1) as f64;
        let dark = (DARK * mean).max(f64::MIN_POSITIVE.sqrt());
        let judged = |index: usize| {
            let weight = 1.0 / (brightness(index).powi(2) + dark * dark);
            // The mean of two independent halves has half their difference as error.
            let noise = mean_square(0.5 * (halves[0][index] - halves[1][index])) * weight;
            Judged { index, value: value(index), weight, noise }
        };
        let pixels: Vec<Judged> = indices.into_iter().map(judged).collect();
        let own = summed(pixels.iter().map(|p| p.noise).collect());
        Self { pixels, own }
    }

    /// The error of a picture, without the part that is the reference's own: independent errors add.
    pub fn error(&self, film: &Film) -> RelativeMse {
        let squares = self.pixels.iter().map(|p| mean_square(film.mean(p.index) - p.value) * p.weight);
        let RelativeMse { whole, trimmed } = summed(squares.collect());
        RelativeMse { whole: whole - self.own.whole, trimmed: trimmed - self.own.trimmed }
    }

    /// The relative error of each pixel of a picture, 0 where none is taken.
    pub fn error_of_pixels(&self, film: &Film) -> Vec<f32> {
        let mut errors = vec![0.0; film.pixels.len()];
        for p in &self.pixels {
            errors[p.index] = (mean_square(film.mean(p.index) - p.value) * p.weight).sqrt() as f32;
        }
        errors
    }

    /// Bias of a method from repeats of its picture; `None` of fewer than two.
    pub fn bias(&self, repeats: &Repeats) -> Option<Bias> {
        let n = f64::from(repeats.count);
        if repeats.count < 2 || self.pixels.is_empty() {
            return None;
        }
        let (mut squares, mut variances) = (Vec::new(), 0.0);
        for p in &self.pixels {
            let (sum, sum_of_squares) = repeats.pixels[p.index];
            let mean = sum / n;
            let variance =
                ((sum_of_squares - n * mean * mean) / (n - 1.0)).element_sum().max(0.0) / 3.0 * p.weight;
            // The expected noise of both is taken off: without bias the rest is 0 in the mean.
            squares.push(mean_square(mean - p.value) * p.weight - variance / n - p.noise);
            variances += variance;
        }
        Some(Bias { square: Estimate::of(&squares), variance: variances / self.pixels.len() as f64 })
    }
}

/// Sums over repeats of a picture: of the mean of each pixel, and of its square.
pub struct Repeats {
    count: u32,
    pixels: Vec<(DVec3, DVec3)>,
}

impl Repeats {
    /// No error yet, of pictures of `pixels` pixels.
    pub fn new(pixels: usize) -> Self {
        Self { count: 0, pixels: vec![Default::default(); pixels] }
    }

    /// Adds one.
    pub fn add(&mut self, film: &Film) {
        self.count += 1;
        for (i, (sum, squares)) in self.pixels.iter_mut().enumerate() {
            let mean = film.mean(i);
            *sum += mean;
            *squares += mean * mean;
        }
    }
}

/// The parts of the error of a method.
#[derive(Clone, Copy, Debug)]
pub struct Bias {
    /// Square of the bias, which no number of samples removes; its standard error is over the pixels.
    pub square: Estimate,
    /// What falls with the samples, as much as one repeat has of it.
    pub variance: f64,
}

impl Bias {
    /// Standard errors above 0 at which a bias is taken to be one.
    const CERTAIN: f64 = 4.0;

    /// The bias, relative to the brightness, if it is certain that there is one.
    pub fn certain(&self) -> Option<f64> {
        let Estimate { mean, error } = self.square;
        (mean > Self::CERTAIN * error && mean > 0.0).then(|| mean.sqrt())
    }

    /// Upper bound of the bias, where none is certain.
    pub fn bound(&self) -> f64 {
        (self.square.mean.max(0.0) + Self::CERTAIN * self.square.error).sqrt()
    }
}

fn mean_square(difference: DVec3) -> f64 {
    difference.length_squared() / 3.0
}

/// Means over pixels.
fn summed(mut squares: Vec<f64>) -> RelativeMse {
    let apart = (APART * squares.len() as f64).round() as usize;
    let kept = squares.len() - apart;
    if apart > 0 {
        squares.select_nth_unstable_by(kept, f64::total_cmp);
    }
    let sum = |part: &[f64]| part.iter().sum::<f64>();
    let (low, high) = squares.split_at(kept);
    RelativeMse {
        whole: (sum(low) + sum(high)) / squares.len().max(1) as f64,
        trimmed: sum(low) / kept.max(1) as f64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_pixels_are_apart() {
        let mut squares = vec![2.0; 1999];
        squares.push(1e6);
        squares.push(1e7);
        let RelativeMse { whole, trimmed } = summed(squares);
        assert!((trimmed - 2.0).abs() < 1e-9 && whole > 5000.0, "{trimmed} {whole}");
        assert_eq!(summed(vec![3.0; 10]), RelativeMse { whole: 3.0, trimmed: 3.0 });
        assert_eq!(summed(vec![]), RelativeMse::default());
    }

    #[test]
    fn mean_of_repeats_and_ratio() {
        let e = Estimate::of(&[1.0, 2.0, 3.0]);
        assert!((e.mean - 2.0).abs() < 1e-12 && (e.error - (1.0f64 / 3.0).sqrt()).abs() < 1e-12);
        assert_eq!(Estimate::of(&[4.0]), Estimate { mean: 4.0, error: 0.0 });
        let ratio = Estimate { mean: 6.0, error: 0.6 }.over(Estimate { mean: 2.0, error: 0.0 });
        assert!((ratio.mean - 3.0).abs() < 1e-12 && (ratio.error - 0.3).abs() < 1e-12);
    }
}
