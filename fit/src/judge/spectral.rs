//! The spectra of a fit: how far those of its colours are from the samples' own, by the map that the material keeps.

use crate::FitError;
use crate::read::illuminants::Illuminant;
use crate::read::{BandError, Spectra, SpectralErrors};
use serde_json::{Value, json};
use srbf_core::{Level, MAX_LOBES, Material, Mixture, SpectralMap};

/// Errors of a map that is good, and of one that is off.
const GOOD: f64 = 0.03;
const MOST: f64 = 0.05;

/// A bound of a verdict.
pub(super) enum Grade {
    Good,
    Fair,
    Off,
}

/// How far the spectra of colours are from those of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct SpectralReport {
    /// The wavelengths in words.
    pub text: String,
    /// Wavelengths, nm.
    pub wavelengths: Vec<f64>,
    /// Whether they make no colour.
    pub is_grey: bool,
    /// By the samples' own colours: the errors of the map alone, also by band; and its worst wavelength, nm.
    pub of_map: SpectralErrors,
    /// By band.
    pub bands: Vec<BandError>,
    /// The wavelength with the largest error of the map, nm, and that error.
    pub worst: (f64, f64),
    /// By the fit's colours.
    pub of_fit: SpectralErrors,
    /// The wavelength with the largest of these errors, nm, and that error.
    pub worst_of_fit: (f64, f64),
}

/// The bytes of a material with the map from its colours to spectra.
///
/// # Errors
/// [`FitError::Format`] for a map that has no place in a material.
pub(crate) fn with_map(bytes: &[u8], map: &[u8]) -> Result<Vec<u8>, FitError> {
    let (material, map) = (Material::from_bytes(bytes)?, SpectralMap::from_bytes(map)?);
    let mut out = vec![0; material.with_spectral_map_len(map)];
    material.with_spectral_map(map, &mut out)?;
    Ok(out)
}

impl SpectralReport {
    /// Compares a material with the spectra of the samples that it was fitted to; `is_light_fixed`: a view of the fit is the direction of
    /// their light.
    ///
    /// # Errors
    /// [`FitError::Core`] never for unit vectors.
    pub fn new(
        spectra: &Spectra,
        is_light_fixed: bool,
        material: &Material<impl AsRef<[u8]>>,
    ) -> Result<Self, FitError> {
        let mut mixture = Mixture::<MAX_LOBES>::empty();
        let mut failed = None;
        let of_fit = spectra.errors_of(|sample| {
            let (view, light) = if is_light_fixed { (sample.wi, sample.wo) } else { (sample.wo, sample.wi) };
            // Scalar on every processor, as all that is reported.
            let prepared = material.prepare_with(view.map(|v| v as f32), Level::Scalar.into(), &mut mixture);
            failed = failed.take().or(prepared.err());
            mixture.evaluate(light.map(|v| v as f32)).to_array().map(|v| f64::from(v) / light[2])
        });
        if let Some(error) = failed {
            return Err(error.into());
        }
        Ok(Self {
            text: spectra.text(),
            wavelengths: spectra.wavelengths.clone(),
            is_grey: spectra.is_grey,
            bands: spectra.bands(&spectra.errors),
            worst: spectra.worst(&spectra.errors),
            worst_of_fit: spectra.worst(&of_fit),
            of_map: spectra.errors.clone(),
            of_fit,
        })
    }

    /// The sentence of a verdict, and its grade.
    pub(super) fn sentence(&self) -> (Grade, String) {
        let (error, of_fit) = (self.of_map.error, self.of_fit.error);
        if self.wavelengths.len() == 1 {
            return (Grade::Good, format!("spectrum: one wavelength, {}; colours are its value", self.text));
        }
        let colour = self.of_fit.colour.map_or_else(String::new, |of| {
            let median = of.map(|[median, _]| format!("{median:.1}"));
            format!("; dE under D65, A, F11 {}", median.join(", "))
        });
        let bands: Vec<String> = self
            .bands
            .iter()
            .map(|band| format!("{:.1} at {:.0}-{:.0}", 100.0 * band.error, band.ends[0], band.ends[1]))
            .collect();
        let bands = if bands.len() > 1 { format!(" ({} nm)", bands.join(", ")) } else { String::new() };
        let (nm, most) = self.worst;
        let text = format!(
            "spectra: {}; by the samples' colours off by {:.1} %{bands}, by the fit's {:.1} %{colour}",
            self.text,
            100.0 * error,
            100.0 * of_fit
        );
        match error {
            e if e <= GOOD => (Grade::Good, text),
            e if e <= MOST => (Grade::Fair, text),
            _ => {
                let three = if self.is_grey { "one number does" } else { "three colours do" };
                (Grade::Off, format!("{text}; {three} not tell them, worst {:.0} % at {nm} nm", 100.0 * most))
            }
        }
    }

    pub(super) fn to_json(&self) -> Value {
        let colour = |errors: &SpectralErrors| {
            errors.colour.map(|of| {
                let spread = |[median, most]: [f64; 2]| json!({"median": median, "of_95_percent": most});
                Illuminant::ALL
                    .iter()
                    .zip(of)
                    .map(|(light, of)| (light.name().to_owned(), spread(of)))
                    .collect::<serde_json::Map<_, _>>()
            })
        };
        let errors = |errors: &SpectralErrors, (nm, worst): (f64, f64)| {
            json!({
                "relative_l2": errors.error,
                "worst_nm": nm,
                "worst_relative_l2": worst,
                "relative_l2_by_wavelength": errors.of_wavelength,
                "delta_e_2000": colour(errors),
            })
        };
        let band = |band: &BandError| json!({"from_nm": band.ends[0], "to_nm": band.ends[1], "relative_l2": band.error});
        json!({
            "wavelengths_nm": self.wavelengths,
            "columns": if self.is_grey { 1 } else { 3 },
            "bands": self.bands.iter().map(band).collect::<Vec<_>>(),
            "map": errors(&self.of_map, self.worst),
            "fit": errors(&self.of_fit, self.worst_of_fit),
        })
    }
}
