//! The light of a spectral picture: wavelengths drawn from it, and the colours that they are seen in.

use anyhow::Context;
use glam::Vec3;
use srbf_fit::read::SpectralCurve;
use srbf_fit::read::illuminants::{self, Illuminant as Cie};
use std::path::Path;

/// Wavelengths, 400, 410, ... 700 nm: the tables of the eye have these.
const COUNT: usize = 31;

/// Wavelengths that a path carries.
pub const HEROES: usize = 4;

/// A light, to which the eye is used: a reflectance of 1 is white.
#[derive(Clone, Debug)]
pub struct Illuminant {
    /// `D65`, `A`, `F11`, or the name of a file.
    pub name: String,
    /// For each wavelength, nm, linear sRGB of a reflectance of 1 there, over the probability that it is drawn.
    seen: [(f32, Vec3); COUNT],
    /// Probability of each wavelength and those before it.
    sums: [f32; COUNT],
}

impl Illuminant {
    /// `D65`, `A` or `F11`; or reads a file of text, with a wavelength and a power on each line.
    ///
    /// # Errors
    /// Names the file, the place in it, and the expected form.
    pub fn load(name: &str) -> anyhow::Result<Self> {
        if let Some(light) = Cie::ALL.into_iter().find(|light| light.name().eq_ignore_ascii_case(name)) {
            return Ok(Self::new(light.name(), &light.weights(&illuminants::wavelengths())));
        }
        let path = Path::new(name);
        let expected =
            || format!("light {name}: D65, A, F11, or a file of wavelengths and powers is expected");
        anyhow::ensure!(path.extension().is_some() || path.exists(), expected());
        let curve = SpectralCurve::read(path).with_context(expected)?;
        Ok(Self::new(name, &illuminants::under(&curve).with_context(expected)?))
    }

    /// Whether it is the light in which linear sRGB is white.
    pub fn is_daylight(&self) -> bool {
        self.name == Cie::D65.name()
    }

    /// Of weights to X, Y, Z of each wavelength.
    fn new(name: &str, weights: &[[f64; 3]]) -> Self {
        let seen = illuminants::seen(weights);
        // A wavelength is drawn by the size of its colour, so that all that are drawn bring about the same.
        let size = |rgb: &[f64; 3]| rgb.iter().map(|v| v.abs()).sum::<f64>();
        let all: f64 = seen.iter().map(size).sum();
        let mut sum = 0.0;
        let mut sums = [0.0; COUNT];
        let mut by_wavelength = [(0.0, Vec3::ZERO); COUNT];
        for (n, (rgb, nm)) in seen.iter().zip(illuminants::wavelengths()).enumerate() {
            let probability = size(rgb) / all;
            sum += probability;
            sums[n] = sum as f32;
            let over = if probability > 0.0 { probability.recip() } else { 0.0 };
            by_wavelength[n] = (nm as f32, Vec3::from_array(rgb.map(|v| (v * over) as f32)));
        }
        Self { name: name.to_owned(), seen: by_wavelength, sums }
    }

    /// Draws four wavelengths, nm, with one number in [0, 1): a quarter of the probability lies between one and the next. With each comes the
    /// colour that its value is to be multiplied by; the mean of the four products is an estimate of the colour.
    pub fn draw(&self, u: f32) -> [(f32, Vec3); HEROES] {
        std::array::from_fn(|k| {
            let at = (u + k as f32 / HEROES as f32).fract();
            let n = self.sums.partition_point(|sum| *sum <= at);
            self.seen[n.min(COUNT - 1)]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use srbf_core::SpectralMap;

    /// The mean over all draws is the sum over the wavelengths; colours become spectra and come back under D65.
    #[test]
    fn draws_have_the_colour_of_the_spectrum() {
        for name in ["D65", "a", "F11"] {
            let light = Illuminant::load(name).unwrap();
            let n = 1 << 16;
            let mut means = [Vec3::ZERO; 2];
            let rgb = [0.7f32, 0.2, 0.4];
            for i in 0..n {
                for (nm, seen) in light.draw((i as f32 + 0.5) / n as f32) {
                    let [a, b, c] = SpectralMap::FIXED.column_at(nm);
                    let value = a * rgb[0] + b * rgb[1] + c * rgb[2];
                    for (mean, value) in means.iter_mut().zip([1.0, value]) {
                        *mean += seen * value / (HEROES * n) as f32;
                    }
                }
            }
            assert!((means[0] - Vec3::ONE).abs().max_element() < 2e-3, "{name}: {}", means[0]);
            let apart = (means[1] - Vec3::from_array(rgb)).abs().max_element();
            assert_eq!(apart < 2e-3, name == "D65", "{name}: {}", means[1]);
        }
    }

    #[test]
    fn lights_that_are_none_are_refused() {
        for name in ["D50", "no.csv", ""] {
            let error = format!("{:#}", Illuminant::load(name).err().unwrap());
            assert!(error.contains("F11"), "{error}");
        }
    }
}
