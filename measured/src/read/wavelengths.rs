//! A spectrum in whatever wavelengths a file has, made a colour where it is one, and grey where it is none.

use super::chosen::ChosenWavelengths;
use super::spectra::{LONGEST, SpectralSamples};
use super::spectrum::ToRgb;
use crate::ReadError;
use crate::file::spectrum::unit_of;
use std::ops::Range;

/// The visible range, nm.
const VISIBLE: [f64; 2] = [360.0, 830.0];

/// Least number of spectral lines that make a colour; they have to begin in blue and end in red, nm.
const FEW: usize = 3;
const BLUE: f64 = 500.0;
const RED: f64 = 600.0;

/// Turns the values of wavelengths, in the order of a file, into linear sRGB.
#[derive(Clone, Debug)]
pub(crate) struct Wavelengths {
    /// As the file has them.
    numbers: Vec<f64>,
    /// Places of the values that are read, by rising wavelength, and these wavelengths, nm.
    places: Vec<usize>,
    nm: Vec<f64>,
    /// Those of the places that make the colour.
    visible: Range<usize>,
    /// `None`: their mean is grey.
    to_rgb: Option<ToRgb>,
    /// Their use, where it is not plain.
    pub note: Option<String>,
}

impl Wavelengths {
    /// For wavelengths in nm, micrometres or metres, in any order.
    ///
    /// # Errors
    /// [`ReadError::Content`] for a number that is no wavelength, and for one that stands there twice.
    pub fn new(numbers: &[f64]) -> Result<Self, ReadError> {
        Self::of(numbers, None)
    }

    /// The same with those alone that a caller chooses.
    ///
    /// # Errors
    /// [`ReadError::Content`] where no wavelength is chosen.
    pub fn chosen(self, chosen: Option<ChosenWavelengths>) -> Result<Self, ReadError> {
        if chosen.is_some() { Self::of(&self.numbers, chosen) } else { Ok(self) }
    }

    fn of(numbers: &[f64], chosen: Option<ChosenWavelengths>) -> Result<Self, ReadError> {
        let fail = |text: String| Err(ReadError::Content(text));
        if let Some(odd) = numbers.iter().find(|w| !w.is_finite() || **w <= 0.0) {
            return fail(format!("{odd} is no wavelength"));
        }
        let Some(largest) = numbers.iter().copied().reduce(f64::max) else {
            return fail("no wavelengths".into());
        };
        let (unit, unit_name) = unit_of(largest);
        let nm: Vec<f64> = numbers.iter().map(|w| w * unit).collect();
        if let Some(odd) = nm.iter().find(|w| !(100.0..=1e5).contains(*w)) {
            return fail(format!("{odd} nm is no wavelength; 100 to 100000 nm is expected"));
        }
        let mut order: Vec<usize> = (0..nm.len()).collect();
        order.sort_by(|&a, &b| nm[a].total_cmp(&nm[b]));
        if let Some(twice) = order.windows(2).find(|pair| nm[pair[0]] == nm[pair[1]]) {
            return fail(format!("wavelength {} nm stands there twice", nm[twice[0]]));
        }
        let range = |order: &[usize]| match order {
            [first, .., last] => format!("{} to {} nm", nm[*first], nm[*last]),
            _ => format!("{} nm", nm[order[0]]),
        };
        if let Some(chosen) = chosen {
            let all = range(&order);
            order.retain(|place| chosen.has(nm[*place]));
            if order.is_empty() {
                return fail(format!("--wavelengths: none of the file's is chosen; it has {all}"));
            }
        }
        let unit_note = unit_name.map(|name| format!("wavelengths are in {name}"));
        let (low, high) = (nm[order[0]], nm[order[order.len() - 1]]);
        let nm: Vec<f64> = order.iter().map(|&place| nm[place]).collect();
        let ends = [nm.partition_point(|w| *w < VISIBLE[0]), nm.partition_point(|w| *w <= VISIBLE[1])];
        let visible = ends[0]..ends[1];
        let made = |to_rgb: Option<ToRgb>, text: Option<String>| {
            let is_long = (high > LONGEST).then(|| {
                format!("no spectra are kept, which end at {LONGEST} nm: --wavelengths chooses those below")
            });
            let notes: Vec<String> = unit_note.iter().cloned().chain(text).chain(is_long).collect();
            let note = (!notes.is_empty()).then(|| notes.join("; "));
            let visible = if to_rgb.is_some() { visible.clone() } else { 0..0 };
            Self { numbers: numbers.to_vec(), places: order.clone(), nm: nm.clone(), visible, to_rgb, note }
        };
        let grey = |text: String| made(None, Some(text));
        if nm.len() == 1 {
            return Ok(grey(format!("one wavelength, {low} nm, is taken as grey")));
        }
        if visible.is_empty() {
            return Ok(grey(format!(
                "wavelengths from {low} to {high} nm, which the eye does not see: their mean is taken as grey"
            )));
        }
        let lines = &nm[visible.clone()];
        let (first, last) = (lines[0], lines[lines.len() - 1]);
        if let Ok(to_rgb) = ToRgb::new(lines) {
            return Ok(made(Some(to_rgb), None));
        }
        if lines.len() >= FEW && first <= BLUE && last >= RED {
            let text = format!("{} wavelengths from {first} to {last} nm make the colour", lines.len());
            return Ok(made(Some(ToRgb::extended(lines)?), Some(text)));
        }
        Ok(grey(format!("wavelengths from {low} to {high} nm make no colour: their mean is taken as grey")))
    }

    /// How many of them are read.
    pub fn count(&self) -> usize {
        self.places.len()
    }

    /// A place for spectra of samples; `None` for wavelengths that are too long to be stored.
    pub fn samples(&self) -> Option<SpectralSamples> {
        let is_stored = self.nm.last().is_some_and(|nm| *nm <= LONGEST);
        is_stored.then(|| SpectralSamples::new(&self.nm, &self.places, self.visible.clone()))?
    }

    /// Linear sRGB of the values in the order of the file.
    pub fn rgb(&self, values: &[f64]) -> [f64; 3] {
        let used = if self.to_rgb.is_some() { self.visible.clone() } else { 0..self.places.len() };
        let ordered: Vec<f64> = self.places[used].iter().map(|&place| values[place]).collect();
        match &self.to_rgb {
            Some(to_rgb) => to_rgb.convert(&ordered),
            None => [ordered.iter().sum::<f64>() / ordered.len() as f64; 3],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spectra_of_any_order_and_unit_are_the_same_colour() {
        let nm: Vec<f64> = (0..31).map(|i| 400.0 + 10.0 * f64::from(i)).collect();
        let value = |w: f64| 0.1 + (w - 400.0) / 400.0;
        let rgb = |w: &[f64]| {
            let in_nm = |w: f64| {
                if w > 100.0 {
                    w
                } else if w > 1e-3 {
                    w * 1e3
                } else {
                    w * 1e9
                }
            };
            Wavelengths::new(w).unwrap().rgb(&w.iter().map(|w| value(in_nm(*w))).collect::<Vec<_>>())
        };
        let falling: Vec<f64> = nm.iter().rev().copied().collect();
        let expected = rgb(&nm);
        for unit in [1.0, 1e-3, 1e-9] {
            let found = rgb(&falling.iter().map(|w| w * unit).collect::<Vec<_>>());
            assert!((0..3).all(|c| (found[c] - expected[c]).abs() < 1e-9), "{unit}: {found:?} {expected:?}");
        }
        let wide: Vec<f64> = nm.iter().copied().chain([900.0, 2000.0]).collect();
        assert_eq!(rgb(&wide), expected);
    }

    #[test]
    fn what_is_no_colour_is_grey_and_said() {
        for (w, word) in [
            (&[532.0][..], "one wavelength"),
            (&[905.0, 1550.0], "does not see"),
            (&[532.0, 633.0], "no colour"),
            (&[0.905], "micrometres; one wavelength"),
        ] {
            let found = Wavelengths::new(w).unwrap();
            assert!(found.note.as_ref().unwrap().contains(word), "{found:?}");
            assert_eq!(found.rgb(&vec![0.5; w.len()]), [0.5; 3]);
        }
        let lines = Wavelengths::new(&[450.0, 532.0, 633.0]).unwrap();
        let white = lines.rgb(&[0.5; 3]);
        assert!(lines.note.is_some() && white.iter().all(|v| (v - 0.5).abs() < 1e-6), "{white:?}");
        for odd in [&[][..], &[f64::NAN], &[500.0, 500.0], &[-400.0], &[f64::INFINITY, 500.0], &[50.0]] {
            assert!(Wavelengths::new(odd).is_err(), "{odd:?}");
        }
    }
}
