//! How good a fit is: a material as the run-time library evaluates the bytes that were written, and other methods' fits.

use crate::FitError;
use crate::method::{Fitted, FittedView};
use crate::reciprocity::{Reciprocity, reciprocity};
use crate::table::View;
use crate::tracked::{TrackedLobes, TrackedView};
use srbf_core::{LUMINANCE, Material};

/// One view of a table against the material.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewReport {
    /// Angle of the outgoing direction from the normal, radians.
    pub theta: f64,
    /// Azimuth of the outgoing direction, radians; 0 in an isotropic material.
    pub azimuth: f64,
    /// Relative L2 error of `f cos` over the samples and channels, with the quadrature weights of the table.
    pub error: f64,
    /// Albedo of the lobes: closed form where the method has one, otherwise the sum over the samples.
    pub albedo: [f64; 3],
    /// Albedo of the table.
    pub data_albedo: [f64; 3],
    /// Relative variance of `f cos / pdf` in luminance, sampled by the lobes; NaN for a method that does not sample.
    pub variance: f64,
    /// Largest `f cos / pdf` in luminance at a sample, over the mean: what the worst path is worth; NaN as above.
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
    /// Evaluations of what the fit makes small, over all starts.
    pub evaluations: usize,
}

/// Added to an albedo of which errors are a share: of what is nearly black it does not matter.
const BLACK: f64 = 1e-3;

impl ViewReport {
    /// Largest relative error of the albedo over the channels.
    pub fn energy_error(&self) -> f64 {
        let off = |c: usize| (self.albedo[c] - self.data_albedo[c]).abs() / (self.data_albedo[c] + BLACK);
        off(0).max(off(1)).max(off(2))
    }

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
        Ok(Self::of(&TrackedView::new(&Material::from_bytes(bytes)?, view.theta)?, view))
    }

    /// Compares any fit with one view of a table.
    ///
    /// # Errors
    /// As [`Fitted::view`].
    pub fn judge(fit: &dyn Fitted, view: &View) -> Result<Self, FitError> {
        Ok(Self::of(fit.view(view.theta)?.as_ref(), view))
    }

    fn of(fitted: &dyn FittedView, view: &View) -> Self {
        let (mut second, mut first, mut largest) = (0.0, 0.0, 0.0f64);
        let mut albedo = [0.0; 3];
        for s in &view.samples {
            let value = fitted.f_cos(s.direction);
            (0..3).for_each(|c| albedo[c] += s.weight * value[c]);
            let data = s.rgb.map(|v| v * s.direction[2]);
            let luminance: f64 = (0..3).map(|c| f64::from(LUMINANCE[c]) * data[c]).sum();
            first += s.weight * luminance;
            if luminance > 0.0 {
                let pdf = fitted.pdf(s.direction).unwrap_or(f64::NAN);
                second += s.weight * luminance * luminance / pdf;
                largest = if pdf.is_nan() { f64::NAN } else { largest.max(luminance / pdf) };
            }
        }
        Self {
            theta: view.theta,
            azimuth: 0.0,
            error: relative_l2(fitted, view, Norm::FCos),
            albedo: fitted.albedo().unwrap_or(albedo),
            data_albedo: view.albedo,
            largest_weight: if first > 0.0 { largest / first } else { 0.0 },
            variance: if first > 0.0 { second / (first * first) - 1.0 } else { 0.0 },
        }
    }
}

/// What errors are measured in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Norm {
    /// `f cos`: what a renderer integrates.
    FCos,
    /// f alone: what the thesis's equation 7 makes small.
    F,
}

/// Relative L2 error over the samples of a view and the channels, with the quadrature weights of the table.
pub fn relative_l2(fitted: &dyn FittedView, view: &View, norm: Norm) -> f64 {
    let (difference, data) = squares(fitted, view, norm);
    if data > 0.0 { libm::sqrt(difference / data) } else { libm::sqrt(difference) }
}

/// Sums of squares over a view: of the difference, and of the data.
pub(crate) fn squares(fitted: &dyn FittedView, view: &View, norm: Norm) -> (f64, f64) {
    let (mut difference, mut sum) = (0.0, 0.0);
    for s in &view.samples {
        let value = fitted.f_cos(s.direction);
        let cosine = match norm {
            Norm::FCos => 1.0,
            Norm::F => s.direction[2],
        };
        for (value, f) in value.into_iter().zip(s.rgb) {
            let data = f * s.direction[2] / cosine;
            let off = value / cosine - data;
            difference += s.weight * off * off;
            sum += s.weight * data * data;
        }
    }
    (difference, sum)
}

impl Report {
    /// Mean over the views of the relative L2 error.
    pub fn mean_error(&self) -> f64 {
        mean_error(&self.views)
    }

    /// The report as JSON, with the provenance of the material and its reciprocity error.
    ///
    /// # Errors
    /// As [`Fitted::view`].
    pub fn to_json(&self, material: &Material<'_>, input: &Input) -> Result<String, FitError> {
        let lobes = TrackedLobes { bytes: material.bytes().to_vec() };
        let mut json = self.to_json_of(&lobes, "tracked", input)?;
        let more = serde_json::json!({
            "provenance": material.provenance(),
            "settings": material.provenance().lines().last(),
            "bytes": material.bytes().len(),
            "lobes": material.lobe_count(),
            "squeezed": material.squeezed_count(),
            "mirrored": material.mirrored_count(),
            "knots": material.view_count(),
        });
        if let (Some(json), serde_json::Value::Object(more)) = (json.as_object_mut(), more) {
            json.extend(more);
        }
        Ok(format!("{json:#}\n"))
    }

    /// What the reports of all methods say.
    ///
    /// # Errors
    /// As [`Fitted::view`].
    pub fn to_json_of(
        &self,
        fitted: &dyn Fitted,
        method: &str,
        input: &Input,
    ) -> Result<serde_json::Value, FitError> {
        let views = |views: &[ViewReport]| views.iter().map(ViewReport::to_json).collect::<Vec<_>>();
        let held_out = (!self.held_out.is_empty()).then(|| mean_error(&self.held_out));
        let Reciprocity { median, worst, pairs } = reciprocity(fitted)?;
        Ok(serde_json::json!({
            "method": method,
            "version": env!("CARGO_PKG_VERSION"),
            "input": {"name": input.name, "sha256": input.sha256},
            "seconds": self.seconds,
            "evaluations": self.evaluations,
            "mean_relative_l2": self.mean_error(),
            "mean_relative_l2_held_out": held_out,
            "reciprocity": {"median_abs_log_ratio": median, "worst_abs_log_ratio": worst, "pairs": pairs},
            "views": views(&self.views),
            "held_out": views(&self.held_out),
        }))
    }
}

/// What a fit was made from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Input {
    /// Name of the file or material.
    pub name: String,
    /// SHA-256 of the file, hexadecimal.
    pub sha256: String,
}

/// Mean of the relative L2 error, 0 for no view.
pub fn mean_error(views: &[ViewReport]) -> f64 {
    views.iter().map(|v| v.error).sum::<f64>() / views.len().max(1) as f64
}
