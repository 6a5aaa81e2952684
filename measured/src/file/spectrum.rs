//! A spectrum as text: a wavelength and a value on each line.

use super::decode::decode;
use super::rows::fill;
use crate::{FitError, ReadError};
use std::path::Path;

/// Largest file of a spectrum, bytes: a value for each hundredth of a nanometre takes less.
const MAX_SPECTRUM: u64 = 4 << 20;

/// Wavelengths up to this are micrometres, and up to that metres.
const MICROMETRES: f64 = 20.0;
const METRES: f64 = 1e-4;

/// The unit of wavelengths whose largest is this, told by its size: how many nm it has, and its name where it is not nm.
pub(crate) fn unit_of(largest: f64) -> (f64, Option<&'static str>) {
    match largest {
        w if w < METRES => (1e9, Some("metres")),
        w if w < MICROMETRES => (1e3, Some("micrometres")),
        _ => (1.0, None),
    }
}

/// A value at any wavelength: linear between those of a file, constant beyond.
///
/// ```
/// use srbf_measured::read::SpectralCurve;
///
/// let curve = SpectralCurve::parse(b"nm,reflectance\n400,0.2\n500,0.4\n")?;
/// assert_eq!([300.0, 450.0, 700.0].map(|nm| curve.at(nm)).map(|v| (10.0 * v).round()), [2.0, 3.0, 4.0]);
/// # Ok::<(), srbf_measured::ReadError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SpectralCurve {
    /// Wavelengths, nm and rising, with their values.
    points: Vec<[f64; 2]>,
}

impl SpectralCurve {
    /// Reads a file of text, see [`parse`](Self::parse).
    ///
    /// # Errors
    /// [`FitError::Io`]; [`FitError::Read`] with the line of the fault.
    pub fn read(path: &Path) -> Result<Self, FitError> {
        let bytes = super::read_bytes(path, MAX_SPECTRUM, |_| Ok(()))?;
        Self::parse(&bytes).map_err(|source| FitError::Read { path: path.to_path_buf(), source })
    }

    /// Of text: a wavelength and a value on each line, with a comma, a semicolon or white space between. Wavelengths are nm, micrometres or
    /// metres, in any order. Lines that begin with `#` are comments, and the first line may have names.
    ///
    /// # Errors
    /// [`ReadError`] with the line: no two numbers, a value below 0, a wavelength that is none or stands there twice; fewer than two lines.
    pub fn parse(bytes: &[u8]) -> Result<Self, ReadError> {
        let text = decode(bytes)?;
        let lines = text.lines().enumerate().map(|(n, line)| (n + 1, line.trim()));
        let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#')).peekable();
        let words = |line: &'_ str| -> Vec<String> {
            let parts = line.split([',', ';', ' ', '\t']).map(str::trim).filter(|word| !word.is_empty());
            parts.map(str::to_owned).collect()
        };
        if lines.peek().is_some_and(|(_, line)| words(line).iter().all(|word| word.parse::<f64>().is_err())) {
            lines.next();
        }
        let mut points = Vec::new();
        for (n, line) in lines {
            let words = words(line);
            let fault = |text: String| ReadError::Content(format!("line {n}: {text}"));
            if words.len() != 2 {
                return Err(fault(format!(
                    "{} numbers where a wavelength and a value are expected",
                    words.len()
                )));
            }
            let mut point = [0.0; 2];
            fill(n, words.iter().map(String::as_str), &mut point)?;
            if point[1] < 0.0 {
                return Err(fault(format!("{}: a value of at least 0 is expected", point[1])));
            }
            points.push(point);
        }
        if points.len() < 2 {
            return Err(ReadError::Content("a spectrum of two wavelengths or more is expected".into()));
        }
        let (unit, _) = unit_of(points.iter().map(|point| point[0]).fold(0.0, f64::max));
        points.iter_mut().for_each(|point| point[0] *= unit);
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        if let Some([nm, _]) = points.iter().find(|point| !(100.0..=1e5).contains(&point[0])) {
            return Err(ReadError::Content(format!(
                "{nm} nm is no wavelength; 100 to 100000 nm is expected"
            )));
        }
        if let Some(twice) = points.windows(2).find(|pair| pair[0][0] == pair[1][0]) {
            return Err(ReadError::Content(format!("wavelength {} nm stands there twice", twice[0][0])));
        }
        Ok(Self { points })
    }

    /// The value at a wavelength in nm.
    pub fn at(&self, nm: f64) -> f64 {
        let after = self.points.partition_point(|point| point[0] < nm);
        match (after.checked_sub(1).map(|before| self.points[before]), self.points.get(after)) {
            (Some([a, low]), Some([b, high])) => low + (high - low) * (nm - a) / (b - a),
            (Some([_, last]), None) => last,
            (None, first) => first.map_or(0.0, |point| point[1]),
        }
    }

    /// Its wavelengths, nm and rising.
    pub(crate) fn wavelengths(&self) -> impl Iterator<Item = f64> + '_ {
        self.points.iter().map(|point| point[0])
    }

    /// The first and the last of them.
    pub(crate) fn ends(&self) -> [f64; 2] {
        let end = |point: Option<&[f64; 2]>| point.map_or(0.0, |point| point[0]);
        [end(self.points.first()), end(self.points.last())]
    }

    /// What identifies it.
    pub(crate) fn bytes(&self) -> impl Iterator<Item = u8> + '_ {
        self.points.iter().flatten().flat_map(|number| number.to_le_bytes())
    }

    /// The largest value.
    pub fn largest(&self) -> f64 {
        self.points.iter().map(|point| point[1]).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn separators_units_order_and_names_are_understood() {
        let expected = SpectralCurve { points: vec![[400.0, 0.1], [500.0, 0.3]] };
        for text in [
            "400,0.1\n500,0.3",
            "500;0.3\r\n400;0.1\r\n",
            "# a lamp\nwavelength power\n0.4 0.1\n\n0.5 0.3\n",
            "nm\tvalue\n400\t0.1\n500\t0.3\n",
            "4e-7, 1e-1\n5e-7, 3e-1",
        ] {
            let found = SpectralCurve::parse(text.as_bytes()).unwrap();
            let apart = found.points.iter().flatten().zip(expected.points.iter().flatten());
            assert!(apart.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) < 1e-9, "{text}: {found:?}");
        }
        assert_eq!([0.0, 450.0, 9e9].map(|nm| expected.at(nm)), [0.1, 0.2, 0.3]);
    }

    #[test]
    fn faults_are_named_with_their_line() {
        for (text, words) in [
            ("", "two wavelengths"),
            ("nm,value\n", "two wavelengths"),
            ("400,0.1", "two wavelengths"),
            ("400,0.1\n500", "line 2: 1 numbers"),
            ("400,0.1\n500,0.3,0.2", "line 2: 3 numbers"),
            ("400,0.1\n500,x", "line 2, number 2"),
            ("400,0.1\n500,nan", "line 2, number 2"),
            ("400,0.1\n500,-1", "line 2: -1"),
            ("400,0.1\n400,0.2", "twice"),
            ("-400,0.1\n500,0.2", "no wavelength"),
            ("0,0\n0,0", "no wavelength"),
        ] {
            let error = SpectralCurve::parse(text.as_bytes()).unwrap_err().to_string();
            assert!(error.contains(words), "{text:?}: {error}");
        }
        assert!(SpectralCurve::parse(b"400,0.1\n\xff\xfe,2").is_err());
        assert!(SpectralCurve::read(Path::new("/nowhere.csv")).is_err());
    }
}
