//! How good a fit is: a material as the run-time library evaluates the bytes that were written, and other methods' fits.
//!
//! Scattered samples are a coarse quadrature: the sum of a density over them may be far from 1, and a variance made of it below 0.
//! So a density counts relative to its own sum over the same samples: then no variance is below 0 and no largest weight below 1.

use crate::FitError;
use crate::complete::{CompletionReport, Gaps};
use crate::judge::appearance::Appearance;
use crate::judge::cross::CrossValidation;
use crate::judge::energy::EnergyError;
use crate::judge::fitted_material::TrackedView;
use crate::judge::measure::{RegionErrors, away, negatives, region_errors};
use crate::judge::method::{Fitted, FittedView};
use crate::judge::norm::{Norm, relative, squares, values};
use crate::judge::spectral::SpectralReport;
use crate::look::Look;
#[doc(inline)]
pub use crate::numeric::levenberg::Ending;
use crate::table::{DARKEST, Sample, View, luminance};
use serde_json::{Value, json};
use srbf_core::Material;

/// Error of a view that is worth a note.
pub(super) const LARGE_ERROR: f64 = 0.5;

/// One view of a table against the material.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewReport {
    /// Angle of the outgoing direction from the normal, radians.
    pub theta: f64,
    /// Azimuth of the outgoing direction, radians; 0 in an isotropic material.
    pub azimuth: f64,
    /// Relative L2 error of `f cos` over the samples and channels, with the quadrature weights of the table. Where the table is
    /// black, the L2 norm of the fit, 1/sr: no share of anything, and in no mean.
    pub error: f64,
    /// The measure that the fit makes small: the root of the squared relative L2 error and the squared error away from the peak, see
    /// [`measure`](crate::judge::measure). Of a black table as `error`.
    pub measure: f64,
    /// Whether every sample of the table is 0.
    pub is_black: bool,
    /// Whether its samples contradict those with light and viewer exchanged, see [`Contradicted`](crate::look::Contradicted): no fit is
    /// judged by these.
    pub is_contradicted: bool,
    /// Albedo of the lobes: closed form where the method has one, otherwise the sum over the samples.
    pub albedo: [f64; 3],
    /// Albedo of the table, by its own quadrature if that of the lobes is a closed form, otherwise the sum over the samples too.
    pub data_albedo: [f64; 3],
    /// Whether lobes were fitted to a smaller albedo than that, 0.95: no surface reflects more.
    pub is_albedo_cut: bool,
    /// Sum of the density over the samples, over its integral there: 1 where the samples are a fine quadrature of it; NaN for a
    /// method that does not sample.
    pub density: f64,
    /// Relative variance of `f cos / pdf` in luminance, sampled by the lobes, the density made to sum to its integral; NaN as above.
    pub variance: f64,
    /// Largest `f cos / pdf` in luminance at a sample, over the mean: the weight of the worst path. Density and NaN as above.
    pub largest_weight: f64,
    /// Errors at the peak, and away from it.
    pub regions: RegionErrors,
    /// Least relative L2 error that a fit can have there, see [`View::floor`].
    pub floor: f64,
    /// Share of the hemisphere where the table has a negative channel, and the relative L2 norm of those.
    pub negatives: (f64, f64),
}

/// A fitted material.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The material, as `.srbf` bytes.
    pub bytes: Vec<u8>,
    /// How good it is.
    pub report: Report,
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
    /// Evaluations of the objective, over all starts.
    pub evaluations: usize,
    /// Why the last stage of the fit ended, if that is known.
    pub ending: Option<Ending>,
    /// Bytes of the material with each table of factors that was tried, and the share of the error off the peak that is left. The error is
    /// that in directions that the table has not seen. Empty where none was tried.
    pub factor_sizes: Vec<(usize, f64)>,
    /// Errors of samples and views left out, if they were asked for.
    pub cross_validation: Option<CrossValidation>,
    /// The report of the completion of samples.
    pub completion: Option<CompletionReport>,
    /// How it looks beside the table, where that can be evaluated anywhere.
    pub appearance: Option<Appearance>,
    /// Where nothing was measured, if that is known.
    pub gaps: Option<Gaps>,
    /// Findings about the samples before the fit, if they were looked for.
    pub look: Option<Look>,
    /// The spectra of its colours, of samples that have some.
    pub spectra: Option<SpectralReport>,
}

/// Angles of a view and of contradicted samples that are one, radians.
const SAME_ANGLE: f64 = 0.087;

impl Report {
    /// Marks the views of samples that contradict those with light and viewer exchanged.
    pub(crate) fn mark_contradicted(&mut self) {
        let Some(look) = &self.look else { return };
        let is_so = |theta: f64| look.contradicted.iter().any(|c| (c.theta - theta).abs() < SAME_ANGLE);
        self.views.iter_mut().for_each(|view| view.is_contradicted = is_so(view.theta));
    }
}

/// Added to an albedo before errors are divided by it: errors of nearly black surfaces do not matter.
const BLACK: f64 = 1e-3;

impl ViewReport {
    /// Largest relative error of the albedo over the channels.
    pub fn energy_error(&self) -> f64 {
        let errors = EnergyError::beside(BLACK).errors(self.albedo, self.data_albedo);
        errors.iter().fold(0.0, |most: f64, e| most.max(e.abs()))
    }

    /// Whether the view is as dark as the darkest lobes.
    pub(crate) fn is_too_dark(&self) -> bool {
        !self.is_black && self.error > LARGE_ERROR && self.data_albedo.iter().all(|a| *a < DARKEST)
    }

    /// The largest weight with the density as it is, whatever its sum over the samples.
    pub(crate) fn largest_weight_as_summed(&self) -> f64 {
        self.largest_weight / self.density
    }

    pub(super) fn to_json(&self) -> Value {
        json!({
            "theta_degrees": self.theta.to_degrees(),
            "azimuth_degrees": self.azimuth.to_degrees(),
            "is_contradicted": self.is_contradicted,
            "relative_l2": (!self.is_black).then_some(self.error),
            "measure": (!self.is_black).then_some(self.measure),
            "is_black": self.is_black,
            "albedo": self.albedo,
            "data_albedo": self.data_albedo,
            "is_data_albedo_cut": self.is_albedo_cut,
            "energy_error": self.energy_error(),
            "density_over_samples": number(self.density),
            "relative_variance": number(self.variance),
            "largest_weight_over_mean": number(self.largest_weight),
            "relative_l2_peak": number(self.regions.peak),
            "relative_l2_off_peak": number(self.regions.off_peak),
            "median_luminance_error_off_peak": number(self.regions.luminance),
            "median_chroma_error_off_peak": number(self.regions.chroma),
            "least_relative_l2": self.floor,
            "negative_share": self.negatives.0,
            "negative_relative_l2": self.negatives.1,
        })
    }

    /// Compares a material with one view of a table.
    ///
    /// # Errors
    /// [`FitError::Format`] and [`FitError::Core`] for bytes that are no material.
    pub fn new(bytes: &[u8], view: &View) -> Result<Self, FitError> {
        Ok(Self::of(&TrackedView::new(&Material::from_bytes(bytes)?, view.theta, 0.0)?, view))
    }

    /// Compares any fit with one view of a table.
    ///
    /// # Errors
    /// As [`Fitted::view`].
    pub fn judge(fit: &dyn Fitted, view: &View) -> Result<Self, FitError> {
        Ok(Self::of(fit.view(view.theta)?.as_ref(), view))
    }

    pub(crate) fn of(fitted: &dyn FittedView, view: &View) -> Self {
        let mut sums = Sums::default();
        let values = values(fitted, view);
        view.samples.iter().zip(&values).for_each(|(s, value)| sums.add(s, *value, fitted));
        let density = sums.density / fitted.share_above_horizon();
        let (albedo, data_albedo) = match fitted.albedo() {
            Some(albedo) => (albedo, view.uncut_albedo),
            None => (sums.albedo, sums.data_albedo),
        };
        let square = squares(&values, view, Norm::FCos);
        Self {
            theta: view.theta,
            azimuth: 0.0,
            error: relative(square),
            measure: libm::sqrt(relative(square).powi(2) + away(&values, view)),
            is_black: square.1 <= 0.0,
            is_contradicted: false,
            albedo,
            data_albedo,
            is_albedo_cut: fitted.albedo().is_some() && view.albedo != view.uncut_albedo,
            density,
            largest_weight: sums.largest_weight(density),
            variance: sums.variance(density),
            regions: region_errors(&values, view),
            floor: view.floor,
            negatives: negatives(&view.samples),
        }
    }
}

/// Sums over the samples of a view: of the albedos, and of the luminance as the lobes sample it.
#[derive(Default)]
struct Sums {
    albedo: [f64; 3],
    data_albedo: [f64; 3],
    luminance: f64,
    /// Of the squared luminance over the density.
    square: f64,
    /// Largest luminance over the density; not a sum.
    largest: f64,
    density: f64,
}

impl Sums {
    fn add(&mut self, s: &Sample, value: [f64; 3], fitted: &dyn FittedView) {
        let data = s.rgb.map(|v| v * s.direction[2]);
        for c in 0..3 {
            self.albedo[c] += s.weight * value[c];
            self.data_albedo[c] += s.weight * data[c];
        }
        // A negative luminance is noise, and nothing that could be sampled.
        let luminance = luminance(data).max(0.0);
        let pdf = fitted.pdf(s.direction).unwrap_or(f64::NAN);
        self.luminance += s.weight * luminance;
        self.density += s.weight * pdf;
        if luminance > 0.0 {
            self.square += s.weight * luminance * luminance / pdf;
            self.largest = if pdf.is_nan() { f64::NAN } else { self.largest.max(luminance / pdf) };
        }
    }

    /// Relative variance, 0 where all is black; infinite where light comes from where no sample is drawn.
    fn variance(&self, density: f64) -> f64 {
        let mean = self.luminance;
        let variance = self.square * density / (mean * mean) - 1.0;
        if mean == 0.0 || variance < 0.0 {
            // Below 0 by rounding alone.
            0.0
        } else if self.square.is_infinite() {
            f64::INFINITY
        } else {
            variance
        }
    }

    /// Largest weight over the mean, as [`variance`](Self::variance).
    fn largest_weight(&self, density: f64) -> f64 {
        match self.luminance {
            0.0 => 0.0,
            _ if self.largest.is_infinite() => f64::INFINITY,
            mean => self.largest * density / mean,
        }
    }
}

/// A number for JSON, which has no infinity; NaN is null.
fn number(v: f64) -> Value {
    if v.is_infinite() { "inf".into() } else { v.into() }
}

impl Report {
    /// Mean over the views of the relative L2 error, black ones left out.
    pub fn mean_error(&self) -> f64 {
        mean_error(&self.views)
    }
}

/// The nodes of a table of factors in words, `24 x 6 x 5 nodes, signed`; `None` without one.
pub fn factor_words(material: &Material<impl AsRef<[u8]>>) -> Option<String> {
    let [half, difference, azimuth] = material.factor_nodes()?;
    let sign = if material.has_signed_factors() { ", signed" } else { "" };
    Some(format!("{half} x {difference} x {azimuth} nodes{sign}"))
}

/// Bytes that a material has for its table of factors, the albedo differences of the views included; 0 if it has none.
pub fn factor_bytes(material: &Material<impl AsRef<[u8]>>) -> usize {
    material.factor_len()
}

/// The input of a fit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Input {
    /// Name of the file or material.
    pub name: String,
    /// SHA-256 of the file, hexadecimal.
    pub sha256: String,
}

/// Mean of the relative L2 error over the views that are not black, 0 if there is none.
pub fn mean_error(views: &[ViewReport]) -> f64 {
    let errors: Vec<f64> = views.iter().filter(|v| !v.is_black).map(|v| v.error).collect();
    errors.iter().sum::<f64>() / errors.len().max(1) as f64
}
