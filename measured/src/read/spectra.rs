//! The spectra of a measurement, as a linear map from its colours.
//!
//! Surfaces mix few spectra: that of the body, of a gloss, of flakes. So three numbers say most of a sample's spectrum. The map that
//! says it with the least squared error keeps the colour, which the error is orthogonal to. Where colours of samples
//! span less than three dimensions, the smoothest spectrum of a colour takes the rest.

use super::spectrum::ToRgb;
use crate::numeric::cholesky::Square;

/// Most wavelengths that are kept.
const MOST: usize = 64;

/// Share of the mean square of colours that the smoothest spectra count as.
const SMOOTH: f64 = 1e-4;

/// Keeps the matrix of squared differences from being singular.
const LEVEL: f64 = 1e-6;

/// Spectra of colours.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectra {
    /// Wavelengths, nm, rising.
    pub wavelengths: Vec<f64>,
    /// For each wavelength, the value of linear sRGB (1, 0, 0), (0, 1, 0) and (0, 0, 1).
    pub of_rgb: Vec<[f64; 3]>,
    /// Relative L2 distance of the samples' own spectra from those of their colours; each sample counts the same.
    pub error: f64,
}

impl Spectra {
    /// The spectrum of a colour.
    pub fn of(&self, rgb: [f64; 3]) -> impl Iterator<Item = f64> + '_ {
        self.of_rgb.iter().map(move |by| by[0] * rgb[0] + by[1] * rgb[1] + by[2] * rgb[2])
    }
}

/// Sums over samples, from which [`Spectra`] follow.
#[derive(Clone, Debug)]
pub(crate) struct SpectralSums {
    wavelengths: Vec<f64>,
    /// Places of these among the values of a row.
    places: Vec<usize>,
    to_rgb: ToRgb,
    /// Sums of products of two channels; of a channel and a wavelength; of squares of values.
    colours: [[f64; 3]; 3],
    mixed: Vec<[f64; 3]>,
    squares: f64,
    count: usize,
}

impl SpectralSums {
    /// For values of rising wavelengths, nm, at these places of a row; `None` where they do not rise.
    pub fn new(wavelengths: &[f64], places: &[usize]) -> Option<Self> {
        let every = wavelengths.len().div_ceil(MOST).max(1);
        let wavelengths: Vec<f64> = wavelengths.iter().copied().step_by(every).collect();
        let places = places.iter().copied().step_by(every).collect();
        let to_rgb = ToRgb::extended(&wavelengths).ok()?;
        let mixed = vec![[0.0; 3]; wavelengths.len()];
        Some(Self { wavelengths, places, to_rgb, colours: [[0.0; 3]; 3], mixed, squares: 0.0, count: 0 })
    }

    /// Adds a row of values. Marks of values that are missing are no spectra.
    pub fn add(&mut self, row: &[f64]) {
        let spectrum: Vec<f64> = self.places.iter().map(|&place| row[place]).collect();
        let rgb = self.to_rgb.convert(&spectrum);
        let square: f64 = rgb.iter().map(|v| v * v).sum();
        if square <= 0.0 || spectrum.iter().any(|v| *v <= 0.0) {
            return;
        }
        let weight = 1.0 / square;
        for (a, sums) in self.colours.iter_mut().enumerate() {
            sums.iter_mut().zip(rgb).for_each(|(sum, b)| *sum += weight * rgb[a] * b);
        }
        for (sums, value) in self.mixed.iter_mut().zip(&spectrum) {
            sums.iter_mut().zip(rgb).for_each(|(sum, c)| *sum += weight * c * value);
            self.squares += weight * value * value;
        }
        self.count += 1;
    }

    /// The map; `None` without samples.
    pub fn finish(self) -> Option<Spectra> {
        if self.count == 0 {
            return None;
        }
        let smooth = smoothest(&self.to_rgb)?;
        let share = SMOOTH * (0..3).map(|c| self.colours[c][c]).sum::<f64>() / 3.0;
        let mut matrix = Square::zeros(3);
        for (a, sums) in self.colours.iter().enumerate() {
            matrix.row_mut(a).copy_from_slice(sums);
            matrix.row_mut(a)[a] += share;
        }
        let factor = matrix.cholesky()?;
        let mut unsaid = self.squares;
        let mut of_rgb = Vec::with_capacity(self.wavelengths.len());
        for (mixed, smooth) in self.mixed.iter().zip(&smooth) {
            let right: Vec<f64> = (0..3).map(|c| mixed[c] + share * smooth[c]).collect();
            let solved = factor.solve(&right);
            let by = [solved[0], solved[1], solved[2]];
            for a in 0..3 {
                let said: f64 = (0..3).map(|b| self.colours[a][b] * by[b]).sum();
                unsaid += by[a] * (said - 2.0 * mixed[a]);
            }
            of_rgb.push(by);
        }
        let error = libm::sqrt(unsaid.max(0.0) / self.squares);
        Some(Spectra { wavelengths: self.wavelengths, of_rgb, error })
    }
}

/// For each wavelength, the smoothest spectra of the three channels: those with the least squares of differences.
fn smoothest(to_rgb: &ToRgb) -> Option<Vec<[f64; 3]>> {
    let weights = to_rgb.weights();
    let n = weights.len();
    let mut differences = Square::zeros(n);
    for i in 0..n {
        let row = differences.row_mut(i);
        row[i] = LEVEL + if i == 0 || i + 1 == n { 1.0 } else { 2.0 };
        if i > 0 {
            row[i - 1] = -1.0;
        }
        if i + 1 < n {
            row[i + 1] = -1.0;
        }
    }
    let factor = differences.cholesky()?;
    let channel = |c: usize| factor.solve(&weights.iter().map(|w| w[c]).collect::<Vec<f64>>());
    let solved = [channel(0), channel(1), channel(2)];
    let mut matrix = Square::zeros(3);
    for a in 0..3 {
        for (b, spectrum) in solved.iter().enumerate() {
            matrix.row_mut(a)[b] = weights.iter().zip(spectrum).map(|(w, s)| w[a] * s).sum();
        }
    }
    let factor = matrix.cholesky()?;
    let shares = [0, 1, 2].map(|c| {
        let mut right = [0.0; 3];
        right[c] = 1.0;
        factor.solve(&right)
    });
    let of = |i: usize| shares.each_ref().map(|share| (0..3).map(|a| share[a] * solved[a][i]).sum());
    Some((0..n).map(of).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wavelengths() -> Vec<f64> {
        (0..31).map(|i| 400.0 + 10.0 * f64::from(i)).collect()
    }

    fn close(a: [f64; 3], b: [f64; 3]) -> bool {
        a.iter().zip(b).all(|(x, y)| (x - y).abs() < 1e-9 * (1.0 + y.abs()))
    }

    /// Mixtures of three spectra come back as they were; samples of one hue as spectra of their colour.
    #[test]
    fn spectra_of_mixtures_come_back() {
        let wavelengths = wavelengths();
        let to_rgb = ToRgb::new(&wavelengths).unwrap();
        let places: Vec<usize> = (0..31).collect();
        let bump = |w: f64, at: f64, wide: f64| libm::exp(-((w - at) / wide).powi(2));
        let mixture = |a: f64, b: f64, c: f64| -> Vec<f64> {
            let value = |w: &f64| a * bump(*w, 620.0, 50.0) + b + c * bump(*w, 480.0, 40.0) + 0.01;
            wavelengths.iter().map(value).collect()
        };
        let mut sums = SpectralSums::new(&wavelengths, &places).unwrap();
        let mut one_hue = sums.clone();
        for n in 0..60 {
            let n = f64::from(n);
            let spectrum = mixture((0.3 * n).fract(), 0.01 + (0.618 * n).fract(), (0.755 * n).fract());
            sums.add(&spectrum);
            let spectrum: Vec<f64> = mixture(0.5, 0.1, 0.1).iter().map(|v| v * (1.0 + n)).collect();
            one_hue.add(&spectrum);
            // Marks of missing values.
            one_hue.add(&[-1.0; 31]);
        }
        let spectra = sums.finish().unwrap();
        assert!(spectra.error < 0.01, "{}", spectra.error);
        let truth = mixture(0.4, 0.2, 0.7);
        let found: Vec<f64> = spectra.of(to_rgb.convert(&truth)).collect();
        let apart = found.iter().zip(&truth).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 0.02, "{apart}");
        for spectra in [spectra, one_hue.finish().unwrap()] {
            for rgb in [[0.5, 0.2, 0.1], [1.0; 3], [-0.1, 0.4, 0.2]] {
                let back = to_rgb.convert(&spectra.of(rgb).collect::<Vec<_>>());
                assert!(close(back, rgb), "{back:?} {rgb:?}");
            }
        }
    }

    #[test]
    fn the_smoothest_spectrum_of_white_is_even() {
        let smooth = smoothest(&ToRgb::new(&wavelengths()).unwrap()).unwrap();
        assert!(smooth.iter().all(|by| (by.iter().sum::<f64>() - 1.0).abs() < 1e-3), "{smooth:?}");
        assert_eq!(SpectralSums::new(&[500.0, 600.0], &[0, 1]).unwrap().finish(), None);
    }
}
