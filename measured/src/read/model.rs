//! Analytic models whose colours may be spectra of files.

use super::of_brdf;
use super::spectrum::ToRgb;
use super::wavelengths::Wavelengths;
use super::{Source, sha256};
use crate::analytic::{self, Given};
use crate::file::spectrum::SpectralCurve;
use crate::{FitError, ReadError, with_reasons};
use srbf_core::{Primaries, SpectralMap};
use std::path::{Path, PathBuf};

/// A spectrum that is a colour begins and ends here or beyond, nm.
const ENDS: [f64; 2] = [500.0, 600.0];

/// Pairs of directions whose spectra are looked at.
const PAIRS: usize = 3000;

/// Makes the model that a text names, the prefix cut off.
///
/// # Errors
/// [`FitError`] with the parameter, and the file that it names.
pub fn read(text: &str) -> Result<Source, FitError> {
    let fault =
        |source| FitError::Read { path: PathBuf::from(format!("{}{text}", analytic::PREFIX)), source };
    let mut curves: Vec<(PathBuf, SpectralCurve)> = Vec::new();
    let named = analytic::parse(text, &mut |given| match given {
        Given::Rgb(rgb) => Ok(rgb),
        Given::File(path) => {
            let curve = curve(path)?;
            let nodes = super::illuminants::wavelengths();
            let rgb = ToRgb::extended(&nodes)?.convert(&nodes.map(|nm| curve.at(nm)));
            curves.push((path.to_path_buf(), curve));
            Ok(rgb)
        }
    })?;
    let mut nm: Vec<f64> = curves.iter().flat_map(|(_, curve)| curve.wavelengths()).collect();
    nm.sort_by(f64::total_cmp);
    nm.dedup();
    let spectra = if nm.is_empty() {
        None
    } else {
        let wavelengths = Wavelengths::new(&nm).map_err(fault)?;
        let pairs: Vec<_> = of_brdf::pairs(PAIRS, named.brdf.symmetry()).collect();
        let found = of_brdf::spectra(&wavelengths, &pairs, |three| {
            let nm = three.map(|n| nm[n]);
            let brdf = analytic::parse(text, &mut |given| match given {
                Given::Rgb(rgb) => Ok(smooth(rgb, nm)),
                Given::File(path) => {
                    let known = curves.iter().find(|(known, _)| known == path);
                    Ok(nm.map(|nm| known.map_or(0.0, |(_, curve)| curve.at(nm))))
                }
            });
            let brdf = brdf.map_err(|error| ReadError::Content(with_reasons(&error)))?.brdf;
            Ok(pairs.iter().map(|[wi, wo]| brdf.evaluate(*wi, *wo)).collect())
        });
        found.map_err(fault)?
    };
    let mut identity = named.identity;
    curves.iter().for_each(|(_, curve)| identity.extend(curve.bytes()));
    Ok(Source::evaluable(named.brdf, named.name, sha256(&identity)).with_spectra(spectra))
}

/// Reads the spectrum of a reflectance.
fn curve(path: &Path) -> Result<SpectralCurve, ReadError> {
    let fault = |text: &str| ReadError::Content(format!("{}: {text}", path.display()));
    let curve = SpectralCurve::read(path).map_err(|error| ReadError::Content(with_reasons(&error)))?;
    if curve.largest() > 1.0 {
        return Err(fault("values of a reflectance, 0 to 1, are expected"));
    }
    let [first, last] = curve.ends();
    if first > ENDS[0] || last < ENDS[1] {
        return Err(fault(
            "wavelengths from 500 nm or less to 600 nm or more are expected, which make a colour",
        ));
    }
    Ok(curve)
}

/// Values of the smoothest spectrum of a colour.
fn smooth(rgb: [f64; 3], nm: [f64; 3]) -> [f64; 3] {
    let columns = nm.map(|nm| SpectralMap::FIXED.column_at(nm as f32));
    Primaries::from_columns(columns).of(rgb.map(|v| v as f32)).map(f64::from)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read::Content;

    fn file(name: &str, text: &str) -> PathBuf {
        let path = std::env::temp_dir().join(format!("srbf-spectrum-{}-{name}", std::process::id()));
        std::fs::write(&path, text).unwrap();
        path
    }

    /// A body of a measured spectrum below a grey gloss, and beside it a colour of three numbers.
    #[test]
    fn a_model_takes_colours_from_files() {
        let shape = |nm: f64| 0.1 + 0.6 / (1.0 + libm::exp((560.0 - nm) / 15.0));
        let lines: Vec<String> =
            (0..36).map(|n| 380.0 + 10.0 * f64::from(n)).map(|nm| format!("{nm},{}", shape(nm))).collect();
        let path = file("body.csv", &lines.join("\n"));
        let source = read(&format!("ggx:alpha=0.3,f0=0.04,diffuse={}", path.display())).unwrap();
        let spectra = source.spectra().unwrap();
        assert_eq!((spectra.wavelengths.len(), spectra.is_grey), (36, false));
        assert!(spectra.errors.error < 2e-3, "{:?}", spectra.errors);
        let Content::Evaluable(brdf) = &source.content else { panic!("a model") };
        let (wi, wo) = ([0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]);
        let gloss =
            analytic::parse("ggx:alpha=0.3,f0=0.04", &mut |_| Ok([0.04; 3])).unwrap().brdf.evaluate(wi, wo)
                [0];
        for (nm, value) in spectra.wavelengths.iter().zip(spectra.of(brdf.evaluate(wi, wo))) {
            let expected = gloss + shape(*nm) / std::f64::consts::PI;
            assert!((value / expected - 1.0).abs() < 0.01, "{nm}: {value} {expected}");
        }
        let mixed = read(&format!("ggx:f0=0.9/0.5/0.2,diffuse={}", path.display())).unwrap();
        assert!(mixed.spectra().is_some_and(|spectra| spectra.errors.error < 0.1));
        assert!(read("ggx:f0=0.9/0.5/0.2").unwrap().spectra().is_none());
        let other =
            read(&format!("lambert:albedo={}", file("body.csv", "400 0.1\n700 0.2").display())).unwrap();
        assert_ne!(other.sha256, read(&format!("lambert:albedo={}", path.display())).unwrap().sha256 + "x");
        for (text, word) in
            [("400,1.5\n700,0.2", "0 to 1"), ("900,0.5\n1000,0.2", "600 nm"), ("400,0.5", "two wavelengths")]
        {
            let path = file("odd.csv", text);
            let error = read(&format!("lambert:albedo={}", path.display())).err().unwrap();
            assert!(
                with_reasons(&error).contains(word) && with_reasons(&error).contains("odd.csv"),
                "{}",
                with_reasons(&error)
            );
        }
        let error = with_reasons(&read("lambert:albedo=no.csv").err().unwrap());
        assert!(error.contains("no.csv") && error.contains("spectrum"), "{error}");
    }
}
