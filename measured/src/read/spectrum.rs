//! From spectra to linear sRGB.

use crate::ReadError;

/// First wavelength and spacing of [`WEIGHTS`], nm.
const FIRST: f64 = 400.0;
const STEP: f64 = 10.0;

/// How far inside 400 to 700 nm a spectrum may begin or end, nm: the eye sees almost nothing there.
const MISSING_ENDS: f64 = 20.0;

/// Weights to linear sRGB at 400, 410, ... 700 nm: CIE 1931 2 degree colour matching functions times illuminant D65, by
/// the sRGB matrix, such that a reflectance of 1 everywhere gives (1, 1, 1).
#[rustfmt::skip]
pub(super) const WEIGHTS: [[f64; 3]; 31] = [
    [0.000937431, -0.0008066125, 0.005685561],
    [0.003102608, -0.002706366, 0.01921179],
    [0.009527193, -0.008474236, 0.06106546],
    [0.01738715, -0.01605183, 0.121521],
    [0.02211882, -0.02199649, 0.1851388],
    [0.01638667, -0.02001942, 0.2091017],
    [0.002006512, -0.01113327, 0.1975995],
    [-0.01621087, 0.003783292, 0.1474435],
    [-0.0339989, 0.02213008, 0.09194982],
    [-0.04625351, 0.03895001, 0.04655173],
    [-0.0639478, 0.06333636, 0.02301534],
    [-0.0840831, 0.09594321, 0.006659829],
    [-0.09202051, 0.1262297, -0.005824294],
    [-0.08275066, 0.1485164, -0.01246806],
    [-0.05305856, 0.1489852, -0.01554636],
    [-0.01275329, 0.1423424, -0.01673672],
    [0.03748969, 0.1220361, -0.01572328],
    [0.09188968, 0.09540914, -0.01366732],
    [0.1482678, 0.06739495, -0.01133393],
    [0.1819148, 0.03567697, -0.008088725],
    [0.2111158, 0.01312752, -0.005871521],
    [0.2104884, -0.00238404, -0.003949102],
    [0.1816835, -0.009405807, -0.002494019],
    [0.1323353, -0.009885025, -0.001442928],
    [0.09391579, -0.008376159, -0.0008541107],
    [0.05727638, -0.005603909, -0.0004595828],
    [0.03353822, -0.003443285, -0.000248743],
    [0.01827282, -0.001920272, -0.0001299584],
    [0.009317806, -0.0009949344, -6.428997e-05],
    [0.004031931, -0.000435148, -2.7237e-05],
    [0.002072881, -0.0002244474, -1.391106e-05],
];

/// Turns spectra sampled at given wavelengths into linear sRGB.
#[derive(Clone, Debug)]
pub(crate) struct ToRgb {
    weights: Vec<[f64; 3]>,
}

impl ToRgb {
    /// Prepares weights for wavelengths in nm, rising; a spectrum is interpolated linearly between them.
    pub fn new(wavelengths: &[f64]) -> Result<Self, ReadError> {
        let (Some(&low), Some(&high)) = (wavelengths.first(), wavelengths.last()) else {
            return Err(ReadError::Content("no wavelengths".into()));
        };
        let last = FIRST + STEP * (WEIGHTS.len() - 1) as f64;
        if low > FIRST + MISSING_ENDS || high < last - MISSING_ENDS {
            return Err(ReadError::Content(format!(
                "wavelengths from {low} to {high} nm; {} to {} nm are needed for a colour",
                FIRST + MISSING_ENDS,
                last - MISSING_ENDS
            )));
        }
        Self::extended(wavelengths)
    }

    /// [`new`](Self::new) of wavelengths that may begin and end anywhere: beyond, a spectrum continues its ends.
    pub fn extended(wavelengths: &[f64]) -> Result<Self, ReadError> {
        if let Some(w) = wavelengths.windows(2).find(|w| w[1] <= w[0]) {
            return Err(ReadError::Content(format!(
                "wavelength {} nm after {} nm; they must rise",
                w[1], w[0]
            )));
        }
        Ok(Self { weights: resampled(&WEIGHTS, wavelengths) })
    }

    /// Contributions of each wavelength to red, green and blue.
    pub fn weights(&self) -> &[[f64; 3]] {
        &self.weights
    }

    /// Linear sRGB of a spectrum. Colours outside the gamut have negative channels.
    pub fn convert(&self, spectrum: &[f64]) -> [f64; 3] {
        let mut rgb = [0.0; 3];
        for (weights, value) in self.weights.iter().zip(spectrum) {
            rgb.iter_mut().zip(weights).for_each(|(c, w)| *c += w * value);
        }
        rgb
    }
}

/// Weights of a spectrum at 400, 410, ... 700 nm as those of rising wavelengths, between which it is linear, and beyond which it
/// continues its ends.
pub(super) fn resampled(table: &[[f64; 3]; 31], wavelengths: &[f64]) -> Vec<[f64; 3]> {
    let mut weights = vec![[0.0; 3]; wavelengths.len()];
    let mut add = |n: usize, share: f64, rgb: &[f64; 3]| {
        weights[n].iter_mut().zip(rgb).for_each(|(w, v)| *w += share * v);
    };
    for (i, rgb) in table.iter().enumerate() {
        let wavelength = FIRST + STEP * i as f64;
        let after = wavelengths.partition_point(|&w| w < wavelength);
        if after == 0 || after == wavelengths.len() {
            add(after.min(wavelengths.len() - 1), 1.0, rgb);
        } else {
            let (a, b) = (wavelengths[after - 1], wavelengths[after]);
            let share = (wavelength - a) / (b - a);
            add(after - 1, 1.0 - share, rgb);
            add(after, share, rgb);
        }
    }
    weights
}

/// Linear sRGB of CIE 1931 X, Y, Z under illuminant D65.
pub(crate) fn rgb_of_xyz([x, y, z]: [f64; 3]) -> [f64; 3] {
    [
        3.2404542 * x - 1.5371385 * y - 0.4985314 * z,
        -0.969266 * x + 1.8760108 * y + 0.041556 * z,
        0.0556434 * x - 0.2040259 * y + 1.0572252 * z,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: [f64; 3], b: [f64; 3]) -> bool {
        a.iter().zip(b).all(|(x, y)| (x - y).abs() < 1e-6)
    }

    #[test]
    fn white_is_white_at_any_spacing() {
        for step in [2.5, 5.0, 10.0, 20.0, 50.0] {
            let wavelengths: Vec<f64> =
                (0..).map(|i| 380.0 + step * i as f64).take_while(|w| *w <= 780.0).collect();
            let rgb = ToRgb::new(&wavelengths).unwrap().convert(&vec![1.0; wavelengths.len()]);
            assert!(close(rgb, [1.0; 3]), "{step}: {rgb:?}");
        }
    }

    #[test]
    fn finer_sampling_of_the_same_spectrum_gives_the_same_colour() {
        let coarse: Vec<f64> = (0..31).map(|i| 400.0 + 10.0 * i as f64).collect();
        let fine: Vec<f64> = (0..301).map(|i| 400.0 + i as f64).collect();
        let red = |w: &f64| 0.1 + (w - 400.0) / 400.0;
        let a = ToRgb::new(&coarse).unwrap().convert(&coarse.iter().map(red).collect::<Vec<_>>());
        let b = ToRgb::new(&fine).unwrap().convert(&fine.iter().map(red).collect::<Vec<_>>());
        assert!(close(a, b), "{a:?} {b:?}");
    }

    #[test]
    fn wavelengths_that_cannot_make_a_colour_are_refused() {
        for w in
            [&[][..], &[500.0], &[400.0, 400.0, 700.0], &[450.0, 700.0], &[400.0, 600.0], &[700.0, 400.0]]
        {
            assert!(ToRgb::new(w).is_err(), "{w:?}");
        }
    }
}
