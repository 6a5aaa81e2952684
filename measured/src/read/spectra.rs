//! The spectra of a measurement, as a linear map from its colours.
//!
//! Surfaces mix few spectra: that of the body, of a gloss, of flakes. So three numbers say most of a sample's spectrum. The map that
//! says it with the least squared error keeps the colour, which the error is orthogonal to. Where colours of samples
//! span less than three dimensions, the smoothest spectrum of a colour takes the rest.
//!
//! Wavelengths that make no colour have a map of their mean: it takes grey to a spectrum.

use super::chosen::ChosenWavelengths;
use super::illuminants::{Illuminant, difference_2000, weighed};
use super::spectrum::ToRgb;
use crate::ReadError;
use crate::numeric::cholesky::Square;
use srbf_core::{FormatError, SpectralColumns, SpectralMap};
use std::ops::Range;

/// Most wavelengths that are kept.
const MOST: usize = 64;

/// Most samples whose spectra are kept.
const MOST_SAMPLES: usize = 4096;

/// The longest wavelength that a material stores, nm.
pub(super) const LONGEST: f64 = 6553.5;

/// Share of the mean square of colours that the smoothest spectra count as.
const SMOOTH: f64 = 1e-4;

/// Keeps the matrix of squared differences from being singular.
const LEVEL: f64 = 1e-6;

/// Luminance of the brighter of two colours that are compared.
const COMPARED: f64 = 0.5;

/// Ends of the bands that errors are said of, nm.
const BANDS: [f64; 5] = [0.0, 490.0, 580.0, 780.0, f64::INFINITY];

/// A measured sample with its spectrum.
#[derive(Clone, Debug, PartialEq)]
pub struct SpectralSample {
    /// Unit vectors, as those of [`Row`](crate::read::Row).
    pub wi: [f64; 3],
    /// The other.
    pub wo: [f64; 3],
    /// The BRDF in linear sRGB.
    pub rgb: [f64; 3],
    /// The BRDF at the wavelengths, 1/sr.
    pub values: Vec<f64>,
}

/// Spectra of colours.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectra {
    /// Wavelengths, nm, rising.
    pub wavelengths: Vec<f64>,
    /// For each wavelength, the value of linear sRGB (1, 0, 0), (0, 1, 0) and (0, 0, 1).
    pub of_rgb: Vec<[f64; 3]>,
    /// Whether the wavelengths make no colour: then the spectrum is that of a luminance.
    pub is_grey: bool,
    /// How far the samples' own spectra are from those of their colours.
    pub errors: SpectralErrors,
    /// Samples with their spectra, from which the map follows: all, or of many every second, fourth, and so on.
    pub samples: Vec<SpectralSample>,
    /// Places of the wavelengths that make the colour.
    visible: Range<usize>,
}

/// How far spectra are from those of samples.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SpectralErrors {
    /// Relative L2 error of `f cos` over samples and wavelengths.
    pub error: f64,
    /// The same of each wavelength.
    pub of_wavelength: Vec<f64>,
    /// Differences of colour (dE of CIE 2000, both as bright as half of white) under D65, A and F11: the median, and that of which 95 % are
    /// within. `None` for grey.
    pub colour: Option<[[f64; 2]; 3]>,
}

/// The error of a band of wavelengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandError {
    /// First and last wavelength, nm.
    pub ends: [f64; 2],
    /// Root of the mean squared relative error.
    pub error: f64,
}

impl Spectra {
    /// The spectrum of a colour, as a renderer has it: nowhere below 0.
    pub fn of(&self, rgb: [f64; 3]) -> impl Iterator<Item = f64> + '_ {
        self.of_rgb.iter().map(move |by| (by[0] * rgb[0] + by[1] * rgb[1] + by[2] * rgb[2]).max(0.0))
    }

    /// Those of a map that a material stores, at its own wavelengths or those that are chosen of them: without samples.
    ///
    /// # Errors
    /// [`ReadError::Content`] where no wavelength is chosen.
    pub fn of_map(map: SpectralMap<'_>, chosen: Option<ChosenWavelengths>) -> Result<Self, ReadError> {
        let all: Vec<f64> = (0..map.len()).filter_map(|n| map.wavelength(n)).map(tenths).collect();
        let has = |nm: &f64| chosen.is_none_or(|chosen| chosen.has(*nm));
        let wavelengths: Vec<f64> = all.iter().copied().filter(has).collect();
        if wavelengths.is_empty() {
            let ends = [all.first(), all.last()].map(|nm| nm.copied().unwrap_or_default());
            return Err(ReadError::Content(format!(
                "--wavelengths: none of the material's is chosen; it has {} from {} to {} nm",
                all.len(),
                ends[0],
                ends[1]
            )));
        }
        let of_rgb = wavelengths.iter().map(|nm| map.column_at(*nm as f32).map(f64::from)).collect();
        let errors = SpectralErrors { error: map.error().into(), ..SpectralErrors::default() };
        Ok(Self { wavelengths, of_rgb, is_grey: map.is_grey(), errors, samples: Vec::new(), visible: 0..0 })
    }

    /// The map as a material stores it.
    ///
    /// # Errors
    /// [`FormatError`] for numbers that have no place there.
    pub fn to_map(&self) -> Result<Vec<u8>, FormatError> {
        let wavelengths: Vec<f32> = self.wavelengths.iter().map(|w| *w as f32).collect();
        let of_rgb: Vec<[f32; 3]> = self.of_rgb.iter().map(|by| by.map(|v| v as f32)).collect();
        let of_grey: Vec<f32> = self.of_rgb.iter().map(|by| by.iter().sum::<f64>() as f32).collect();
        let columns =
            if self.is_grey { SpectralColumns::Luminance(&of_grey) } else { SpectralColumns::Rgb(&of_rgb) };
        let mut bytes = vec![0; SpectralMap::encoded_len(wavelengths.len(), self.is_grey)];
        SpectralMap::encode(&wavelengths, columns, self.errors.error as f32, &mut bytes)?;
        Ok(bytes)
    }

    /// How far the spectra of colours are from those of the samples; `rgb` has the colour of a sample's BRDF.
    pub fn errors_of(&self, mut rgb: impl FnMut(&SpectralSample) -> [f64; 3]) -> SpectralErrors {
        let count = self.wavelengths.len();
        let (mut apart, mut whole) = (vec![0.0; count], vec![0.0; count]);
        let lines = &self.wavelengths[self.visible.clone()];
        let lights =
            Illuminant::ALL.map(|light| if self.is_grey { Vec::new() } else { light.weights(lines) });
        let mut colours: [Vec<f64>; 3] = Default::default();
        let mut greens: Vec<f64> = self.samples.iter().map(|sample| sample.rgb[1]).collect();
        greens.sort_by(f64::total_cmp);
        // The darkest twentieth is noise.
        let darkest = greens.get(greens.len() / 20).copied().unwrap_or_default();
        for sample in &self.samples {
            let found: Vec<f64> = self.of(rgb(sample)).collect();
            let square = sample.wi[2] * sample.wi[2];
            for (n, (found, value)) in found.iter().zip(&sample.values).enumerate() {
                apart[n] += square * (found - value) * (found - value);
                whole[n] += square * value * value;
            }
            if sample.rgb[1] >= darkest && !self.is_grey {
                for (weights, colours) in lights.iter().zip(&mut colours) {
                    let seen =
                        |spectrum: &[f64]| weighed(weights, spectrum[self.visible.clone()].iter().copied());
                    colours.push(difference(weights, [seen(&sample.values), seen(&found)]));
                }
            }
        }
        let relative = |apart: f64, whole: f64| if whole > 0.0 { libm::sqrt(apart / whole) } else { 0.0 };
        SpectralErrors {
            error: relative(apart.iter().sum(), whole.iter().sum()),
            of_wavelength: apart.iter().zip(&whole).map(|(a, w)| relative(*a, *w)).collect(),
            colour: (!self.is_grey).then(|| colours.map(spread)),
        }
    }

    /// The wavelength with the largest error, nm, and that error.
    pub fn worst(&self, errors: &SpectralErrors) -> (f64, f64) {
        let all = self.wavelengths.iter().copied().zip(errors.of_wavelength.iter().copied());
        all.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default()
    }

    /// Errors by band: blue, green, red, and infrared.
    pub fn bands(&self, errors: &SpectralErrors) -> Vec<BandError> {
        let of = |band: &[f64]| {
            let first = self.wavelengths.partition_point(|w| *w < band[0]);
            let end = self.wavelengths.partition_point(|w| *w < band[1]);
            let square: f64 = errors.of_wavelength[first..end].iter().map(|e| e * e).sum();
            let error = libm::sqrt(square / (end - first).max(1) as f64);
            (end > first)
                .then(|| BandError { ends: [self.wavelengths[first], self.wavelengths[end - 1]], error })
        };
        BANDS.windows(2).filter_map(of).collect()
    }

    /// The wavelengths in words: `905 nm`, or `31 wavelengths from 400 to 700 nm`.
    pub fn text(&self) -> String {
        match self.wavelengths.as_slice() {
            [] => "no wavelengths".into(),
            [one] => format!("{one} nm"),
            [first, .., last] => {
                format!("{} wavelengths from {first} to {last} nm", self.wavelengths.len())
            }
        }
    }
}

/// A wavelength of a map, which has tenths of nm.
fn tenths(nm: f32) -> f64 {
    (10.0 * f64::from(nm)).round() / 10.0
}

/// The difference of two colours under a light, of which the first is that of a sample.
fn difference(weights: &[[f64; 3]], xyz: [[f64; 3]; 2]) -> f64 {
    let scale = COMPARED / xyz[0][1].max(1e-9);
    let white = weighed(weights, std::iter::repeat(1.0));
    difference_2000(xyz.map(|xyz| xyz.map(|v| scale * v)), white)
}

/// The median, and the number that 95 % are within.
fn spread(mut all: Vec<f64>) -> [f64; 2] {
    all.sort_by(f64::total_cmp);
    let last = all.len().saturating_sub(1);
    [last / 2, last * 19 / 20].map(|n| all.get(n).copied().unwrap_or_default())
}

/// Spectra of samples, from which [`Spectra`] follow.
#[derive(Clone, Debug)]
pub(crate) struct SpectralSamples {
    wavelengths: Vec<f64>,
    /// Places of these among the values of a row.
    places: Vec<usize>,
    /// Weights of the wavelengths to the channels: red, green and blue, or a grey one alone.
    weights: Vec<[f64; 3]>,
    visible: Range<usize>,
    /// Samples with the numbers of their rows.
    kept: Vec<(usize, SpectralSample)>,
    /// Every sample whose number this divides is kept.
    every: usize,
    count: usize,
}

impl SpectralSamples {
    /// For values of rising wavelengths, nm, at these places of a row. Those from one place to another make the colour; none: their mean
    /// is grey. `None` where they do not rise.
    pub fn new(wavelengths: &[f64], places: &[usize], visible: Range<usize>) -> Option<Self> {
        let every = wavelengths.len().div_ceil(MOST).max(1);
        let wavelengths: Vec<f64> = wavelengths.iter().copied().step_by(every).collect();
        let places: Vec<usize> = places.iter().copied().step_by(every).collect();
        let visible = visible.start.div_ceil(every)..visible.end.div_ceil(every);
        let mut weights = vec![[0.0; 3]; wavelengths.len()];
        if visible.is_empty() {
            weights.fill([1.0 / wavelengths.len() as f64, 0.0, 0.0]);
        } else {
            let to_rgb = ToRgb::extended(&wavelengths[visible.clone()]).ok()?;
            weights[visible.clone()].copy_from_slice(to_rgb.weights());
        }
        Some(Self { wavelengths, places, weights, visible, kept: Vec::new(), every: 1, count: 0 })
    }

    /// Places of the wavelengths that are kept among the values of a row.
    pub fn places(&self) -> &[usize] {
        &self.places
    }

    /// Adds the sample of the next row, whose own values are `times` those of the row.
    pub fn add(&mut self, row: &[f64], times: f64, [wi, wo]: [[f64; 3]; 2]) {
        let number = self.count;
        self.count += 1;
        if !number.is_multiple_of(self.every) {
            return;
        }
        if self.kept.len() == MOST_SAMPLES {
            self.every *= 2;
            self.kept.retain(|(number, _)| number.is_multiple_of(self.every));
            if !number.is_multiple_of(self.every) {
                return;
            }
        }
        let values: Vec<f64> =
            self.places.iter().filter_map(|&place| row.get(place)).map(|v| times * v).collect();
        if values.len() == self.places.len() {
            let rgb = self.channels(weighed(&self.weights, values.iter().copied()));
            self.kept.push((number, SpectralSample { wi, wo, rgb, values }));
        }
    }

    /// The colour that channels are.
    fn channels(&self, channels: [f64; 3]) -> [f64; 3] {
        if self.visible.is_empty() { [channels[0]; 3] } else { channels }
    }

    /// The map of the rows that are samples; `None` without any.
    pub fn finish(mut self, is_sample: impl Fn(usize) -> bool) -> Option<Spectra> {
        self.kept.retain(|(number, _)| is_sample(*number));
        let channels = if self.visible.is_empty() { 1 } else { 3 };
        let mut matrix = Square::zeros(channels);
        let mut mixed = vec![[0.0; 3]; self.wavelengths.len()];
        for (_, sample) in &self.kept {
            let square: f64 = sample.rgb.iter().map(|v| v * v).sum();
            if square <= 0.0 {
                continue;
            }
            // A compromise between the highlight, whose squares are all there is without it, and the dark samples, which are noisy.
            let weight = sample.wi[2].abs() / libm::sqrt(square);
            for a in 0..channels {
                let row = matrix.row_mut(a).iter_mut();
                row.zip(sample.rgb).for_each(|(sum, b)| *sum += weight * sample.rgb[a] * b);
            }
            for (sums, value) in mixed.iter_mut().zip(&sample.values) {
                sums.iter_mut().zip(sample.rgb).for_each(|(sum, c)| *sum += weight * c * value);
            }
        }
        let smooth = smoothest(&self.weights, channels)?;
        // One channel is never without a spread.
        let smoothed = if channels == 1 { 0.0 } else { SMOOTH };
        let share = smoothed * (0..channels).map(|c| matrix.row(c)[c]).sum::<f64>() / channels as f64;
        (0..channels).for_each(|c| matrix.row_mut(c)[c] += share);
        let factor = matrix.cholesky()?;
        let is_grey = channels == 1;
        let of_rgb = mixed.iter().zip(&smooth).map(|(mixed, smooth)| {
            let right: Vec<f64> = (0..channels).map(|c| mixed[c] + share * smooth[c]).collect();
            let solved = factor.solve(&right);
            // A grey one is the luminance.
            [0, 1, 2]
                .map(|c| if is_grey { f64::from(srbf_core::LUMINANCE[c]) * solved[0] } else { solved[c] })
        });
        let mut spectra = Spectra {
            of_rgb: of_rgb.collect(),
            wavelengths: self.wavelengths,
            is_grey,
            errors: SpectralErrors::default(),
            samples: self.kept.into_iter().map(|(_, sample)| sample).collect(),
            visible: self.visible,
        };
        spectra.errors = spectra.errors_of(|sample| sample.rgb);
        Some(spectra)
    }
}

/// For each wavelength, the smoothest spectra of the channels: those with the least squares of differences.
fn smoothest(weights: &[[f64; 3]], channels: usize) -> Option<Vec<[f64; 3]>> {
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
    let solved: Vec<Vec<f64>> =
        (0..channels).map(|c| factor.solve(&weights.iter().map(|w| w[c]).collect::<Vec<f64>>())).collect();
    let mut matrix = Square::zeros(channels);
    for a in 0..channels {
        for (b, spectrum) in solved.iter().enumerate() {
            matrix.row_mut(a)[b] = weights.iter().zip(spectrum).map(|(w, s)| w[a] * s).sum();
        }
    }
    let factor = matrix.cholesky()?;
    let shares: Vec<Vec<f64>> = (0..channels)
        .map(|c| factor.solve(&(0..channels).map(|a| f64::from(u8::from(a == c))).collect::<Vec<f64>>()))
        .collect();
    let of = |i: usize, c: usize| (0..channels).map(|a| shares[c][a] * solved[a][i]).sum();
    Some((0..n).map(|i| [0, 1, 2].map(|c| if c < channels { of(i, c) } else { 0.0 })).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    const UP: [[f64; 3]; 2] = [[0.0, 0.0, 1.0]; 2];

    fn wavelengths() -> Vec<f64> {
        (0..31).map(|i| 400.0 + 10.0 * f64::from(i)).collect()
    }

    fn close(a: [f64; 3], b: [f64; 3]) -> bool {
        a.iter().zip(b).all(|(x, y)| (x - y).abs() < 1e-9 * (1.0 + y.abs()))
    }

    #[test]
    fn the_worst_wavelength_is_that_of_the_largest_error() {
        let of_wavelength = vec![0.1, 0.3, 0.2];
        let spectra = Spectra {
            wavelengths: vec![450.0, 550.0, 650.0],
            of_rgb: vec![[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]],
            is_grey: false,
            errors: SpectralErrors::default(),
            samples: Vec::new(),
            visible: 0..0,
        };
        let errors = SpectralErrors { of_wavelength, ..SpectralErrors::default() };
        assert_eq!(spectra.worst(&errors), (550.0, 0.3));
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
        let mut sums = SpectralSamples::new(&wavelengths, &places, 0..31).unwrap();
        let mut one_hue = sums.clone();
        for n in 0..60 {
            let n = f64::from(n);
            let spectrum = mixture((0.3 * n).fract(), 0.01 + (0.618 * n).fract(), (0.755 * n).fract());
            sums.add(&spectrum, 2.0, UP);
            let spectrum: Vec<f64> = mixture(0.5, 0.1, 0.1).iter().map(|v| v * (1.0 + n)).collect();
            one_hue.add(&spectrum, 1.0, UP);
            // Marks of missing values are no samples.
            one_hue.add(&[-1.0; 31], 1.0, UP);
        }
        let spectra = sums.finish(|_| true).unwrap();
        let SpectralErrors { error, of_wavelength, colour } = &spectra.errors;
        assert!(*error < 0.01 && of_wavelength.iter().all(|e| *e < 0.03), "{error} {of_wavelength:?}");
        let [[exact, _], [lamp, most], _] = colour.unwrap();
        assert!(exact < 1e-6 && lamp > exact && most < 1.0, "{colour:?}");
        assert_eq!((spectra.samples.len(), spectra.bands(&spectra.errors).len()), (60, 3));
        let truth = mixture(0.4, 0.2, 0.7);
        let found: Vec<f64> = spectra.of(to_rgb.convert(&truth)).collect();
        let apart = found.iter().zip(&truth).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 0.02, "{apart}");
        for spectra in [spectra, one_hue.finish(|row| row % 2 == 0).unwrap()] {
            for rgb in [[0.5, 0.2, 0.1], [1.0; 3], [-0.1, 0.4, 0.2]] {
                let of = |by: &[f64; 3]| by[0] * rgb[0] + by[1] * rgb[1] + by[2] * rgb[2];
                let back = to_rgb.convert(&spectra.of_rgb.iter().map(of).collect::<Vec<_>>());
                assert!(close(back, rgb), "{back:?} {rgb:?}");
            }
        }
    }

    #[test]
    fn the_smoothest_spectrum_of_white_is_even() {
        let smooth = smoothest(ToRgb::new(&wavelengths()).unwrap().weights(), 3).unwrap();
        assert!(smooth.iter().all(|by| (by.iter().sum::<f64>() - 1.0).abs() < 1e-3), "{smooth:?}");
        assert_eq!(SpectralSamples::new(&[500.0, 600.0], &[0, 1], 0..2).unwrap().finish(|_| true), None);
    }

    /// One wavelength is itself; two have their shares of the mean, and the infrared beside a colour has columns too.
    #[test]
    fn wavelengths_that_are_no_colour_have_a_map_too() {
        let laser = |times: f64, count: usize| {
            let nm: Vec<f64> = (0..count).map(|n| 905.0 + 645.0 * n as f64).collect();
            let mut sums = SpectralSamples::new(&nm, &(0..count).collect::<Vec<_>>(), 0..0).unwrap();
            for n in 0..2 * MOST_SAMPLES {
                let values: Vec<f64> = (0..count).map(|w| (1.0 + n as f64) * (1.0 + w as f64)).collect();
                sums.add(&values, times, UP);
            }
            sums.finish(|_| true).unwrap()
        };
        let one = laser(0.5, 1);
        assert!(one.is_grey && one.errors.error < 1e-6 && one.errors.colour.is_none(), "{:?}", one.errors);
        assert_eq!((one.samples.len(), one.samples[1].values[0]), (MOST_SAMPLES, 1.5));
        let map = one.to_map().unwrap();
        assert_eq!(SpectralMap::from_bytes(&map).unwrap().column(0), Some(srbf_core::LUMINANCE));
        let two: Vec<f64> = laser(1.0, 2).of([3.0; 3]).collect();
        assert!((two[0] - 2.0).abs() < 1e-6 && (two[1] - 4.0).abs() < 1e-6, "{two:?}");

        let mut nm = wavelengths();
        nm.extend([905.0, 1550.0]);
        let mut sums = SpectralSamples::new(&nm, &(0..33).collect::<Vec<_>>(), 0..31).unwrap();
        for n in 0..40 {
            let n = f64::from(n);
            let [a, b, c] = [0.3, 0.618, 0.755].map(|step: f64| 0.1 + (step * n).fract());
            let value = |w: &f64| a + b * (w - 300.0) / 400.0 + c * libm::exp(-((w - 550.0) / 60.0).powi(2));
            sums.add(&nm.iter().map(value).collect::<Vec<_>>(), 1.0, UP);
        }
        let spectra = sums.finish(|_| true).unwrap();
        let bands = spectra.bands(&spectra.errors);
        assert_eq!((bands.len(), bands[3].ends), (4, [905.0, 1550.0]));
        assert!(bands.iter().all(|band| band.error < 0.01), "{bands:?}");
        let map = spectra.to_map().unwrap();
        assert!(map.len() < 300 && SpectralMap::from_bytes(&map).unwrap().wavelength(32) == Some(1550.0));
    }
}
