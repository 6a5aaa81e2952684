//! How good a material is, as the run-time library evaluates the bytes that were written.

use crate::FitError;
use crate::table::View;
use srbf_core::{MAX_LOBES, Material, Mixture, Vec3};

/// One view of a table against the material.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewReport {
    /// Angle of the outgoing direction from the normal, radians.
    pub theta: f64,
    /// Azimuth of the outgoing direction, radians; 0 in an isotropic material.
    pub azimuth: f64,
    /// Relative L2 error of `f cos` over the samples and channels, with the quadrature weights of the table.
    pub error: f64,
    /// Closed-form albedo of the lobes.
    pub albedo: [f64; 3],
    /// Albedo of the table.
    pub data_albedo: [f64; 3],
    /// Relative variance of `f cos / pdf` in luminance, sampled by the lobes.
    pub variance: f64,
    /// Largest `f cos / pdf` in luminance at a sample, over the mean: what the worst path is worth.
    pub largest_weight: f64,
}

/// A material against its table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// View by view, as fitted.
    pub views: Vec<ViewReport>,
    /// Views between those, where the BRDF can be evaluated there.
    pub held_out: Vec<ViewReport>,
    /// Time of the fit.
    pub seconds: f64,
}

impl ViewReport {
    fn to_json(&self) -> serde_json::Value {
        serde_json::json!({
            "theta_degrees": self.theta.to_degrees(),
            "azimuth_degrees": self.azimuth.to_degrees(),
            "relative_l2": self.error,
            "albedo": self.albedo,
            "data_albedo": self.data_albedo,
            "relative_variance": self.variance,
            "largest_weight_over_mean": self.largest_weight,
        })
    }

    /// Compares a material with one view of a table.
    ///
    /// # Errors
    /// [`FitError::Format`] and [`FitError::Core`] for bytes that are no material.
    pub fn new(bytes: &[u8], view: &View) -> Result<Self, FitError> {
        let material = Material::from_bytes(bytes)?;
        let mut mixture = Mixture::<MAX_LOBES>::empty();
        let (sin, cos) = libm::sincos(view.theta);
        material.prepare(Vec3::new(-sin as f32, 0.0, cos as f32), &mut mixture)?;
        let (mut difference, mut norm) = (0.0, 0.0);
        let (mut second, mut first, mut largest) = (0.0, 0.0, 0.0f64);
        for s in &view.samples {
            let d = Vec3::from(s.direction.map(|v| v as f32));
            let (value, pdf) = mixture.evaluate_and_pdf(d);
            let value = value.to_array().map(f64::from);
            let data = s.rgb.map(|v| v * s.direction[2]);
            for c in 0..3 {
                difference += s.weight * (value[c] - data[c]) * (value[c] - data[c]);
                norm += s.weight * data[c] * data[c];
            }
            let luminance = 0.2126 * data[0] + 0.7152 * data[1] + 0.0722 * data[2];
            first += s.weight * luminance;
            if luminance > 0.0 {
                second += s.weight * luminance * luminance / f64::from(pdf);
                largest = largest.max(luminance / f64::from(pdf));
            }
        }
        Ok(Self {
            theta: view.theta,
            azimuth: 0.0,
            error: if norm > 0.0 { libm::sqrt(difference / norm) } else { libm::sqrt(difference) },
            albedo: mixture.albedo().to_array().map(f64::from),
            data_albedo: view.albedo,
            largest_weight: if first > 0.0 { largest / first } else { 0.0 },
            variance: if first > 0.0 { second / (first * first) - 1.0 } else { 0.0 },
        })
    }
}

impl Report {
    /// Mean over the views of the relative L2 error.
    pub fn mean_error(&self) -> f64 {
        mean_error(&self.views)
    }

    /// The report as JSON, with the provenance of the material.
    pub fn to_json(&self, material: &Material<'_>) -> String {
        let views = |views: &[ViewReport]| views.iter().map(ViewReport::to_json).collect::<Vec<_>>();
        let held_out = (!self.held_out.is_empty()).then(|| mean_error(&self.held_out));
        let json = serde_json::json!({
            "provenance": material.provenance(),
            "bytes": material.bytes().len(),
            "lobes": material.lobe_count(),
            "squeezed": material.squeezed_count(),
            "knots": material.view_count(),
            "seconds": self.seconds,
            "mean_relative_l2": self.mean_error(),
            "mean_relative_l2_held_out": held_out,
            "views": views(&self.views),
            "held_out": views(&self.held_out),
        });
        format!("{json:#}\n")
    }
}

/// Mean of the relative L2 error, 0 for no view.
pub fn mean_error(views: &[ViewReport]) -> f64 {
    views.iter().map(|v| v.error).sum::<f64>() / views.len().max(1) as f64
}
