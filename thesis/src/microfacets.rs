//! Two GGX lobes and a diffuse term: what most renderers have in place of a measurement.
//!
//! `f = d / pi + sum over two roughnesses of D G / (4 cos_i cos_o) (F0 (1 - s) + F90 s)`, s Schlick's fifth power, is linear in d, F0 and F90.
//! So for each pair of roughnesses of a ladder the best colours, none below 0, are a small problem; the pair is then refined. The objective
//! is the measure of our own fits (`srbf_fit::judge::measure`).

use rayon::prelude::*;
use srbf_fit::FitError;
use srbf_fit::analytic::ggx::{Facets, Ggx};
use srbf_fit::judge::measure::{beside_highlight, brightness, floor, level, weight};
use srbf_fit::judge::method::{Fitted, FittedView};
use srbf_fit::table::{Brdf, Table};
use std::f64::consts::{FRAC_1_PI, FRAC_PI_2};

/// Least and largest roughness, and how many there are at first, even in the logarithm.
const ROUGHNESS: (f64, f64) = (0.004, 0.9);
const LADDER: usize = 14;
/// Times that both roughnesses are refined, each by half the step of before.
const REFINED: usize = 5;
/// Sweeps of the coordinate descent.
const SWEEPS: usize = 300;
/// Samples of a table, about.
const SAMPLES: usize = 12_000;

/// Coefficients: the diffuse term, then F0 and F90 of each lobe.
const TERMS: usize = 5;

/// The model.
#[derive(Clone, Debug, PartialEq)]
pub struct Microfacets {
    /// Roughness of either lobe.
    pub roughness: [f64; 2],
    /// Diffuse albedo, then reflectance at normal incidence and at grazing of the first lobe, then of the second; by channel.
    pub coefficients: [[f64; 5]; 3],
}

/// Factor on every coefficient.
fn terms(roughness: [f64; 2], wi: [f64; 3], wo: [f64; 3]) -> [f64; TERMS] {
    let lobe = |alpha: f64, grazing: bool| {
        // Schlick's reflectance is F0 + (1 - F0) s: of F0 = 0 it is s, of 1 it is 1.
        let of = |f0: f64| Ggx { diffuse: [0.0; 3], alpha: [alpha; 2], facets: Facets::Schlick([f0; 3]) };
        let s = of(0.0).evaluate(wi, wo)[0];
        if grazing { s } else { of(1.0).evaluate(wi, wo)[0] - s }
    };
    let [a, b] = roughness;
    [FRAC_1_PI, lobe(a, false), lobe(a, true), lobe(b, false), lobe(b, true)]
}

impl Brdf for Microfacets {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let terms = terms(self.roughness, wi, wo);
        self.coefficients.map(|channel| channel.iter().zip(&terms).map(|(c, t)| c * t).sum())
    }
}

impl Microfacets {
    /// Fits the model to a table.
    ///
    /// # Errors
    /// [`FitError::Table`] for a table without a sample.
    pub fn fit(table: &Table) -> Result<Self, FitError> {
        let thinned = table.thinned(SAMPLES);
        let mut samples = Vec::new();
        for view in &thinned.views {
            let (sin, cos) = libm::sincos(view.theta);
            let norm: f64 = view
                .samples
                .iter()
                .map(|s| s.weight * (0..3).map(|c| (s.rgb[c] * s.direction[2]).powi(2)).sum::<f64>())
                .sum();
            let level = level(view.albedo);
            for s in view.samples.iter().filter(|s| s.direction[2] > 0.02) {
                let z = s.direction[2];
                let seen = weight(brightness(s.rgb), level, z) * beside_highlight(s.direction, view.theta);
                let weight = s.weight * (1.0 / norm.max(1e-12) + seen) * z * z;
                if weight.is_finite() && floor(level) > 0.0 {
                    samples.push((s.direction, [-sin, 0.0, cos], s.rgb, weight));
                }
            }
        }
        if samples.is_empty() {
            return Err(FitError::Table("no sample to fit microfacets to".into()));
        }
        let solve = |roughness: [f64; 2]| {
            let mut gram = [[0.0; TERMS]; TERMS];
            let mut moments = [[0.0; TERMS]; 3];
            let mut square = 0.0;
            for (wi, wo, rgb, weight) in &samples {
                let terms = terms(roughness, *wi, *wo);
                for i in 0..TERMS {
                    (0..TERMS).for_each(|j| gram[i][j] += weight * terms[i] * terms[j]);
                    (0..3).for_each(|c| moments[c][i] += weight * terms[i] * rgb[c]);
                }
                square += weight * rgb.iter().map(|v| v * v).sum::<f64>();
            }
            let coefficients = moments.map(|moment| not_below_zero(&gram, &moment));
            let left: f64 = (0..3)
                .map(|c| {
                    let x = &coefficients[c];
                    let quadratic: f64 =
                        (0..TERMS).map(|i| (0..TERMS).map(|j| x[i] * gram[i][j] * x[j]).sum::<f64>()).sum();
                    quadratic - 2.0 * (0..TERMS).map(|i| x[i] * moments[c][i]).sum::<f64>()
                })
                .sum();
            (square + left, Self { roughness, coefficients })
        };
        let best = |pairs: Vec<[f64; 2]>| {
            pairs.into_par_iter().map(solve).min_by(|a, b| a.0.total_cmp(&b.0)).map(|found| found.1)
        };
        let mut step = libm::pow(ROUGHNESS.1 / ROUGHNESS.0, 1.0 / (LADDER - 1) as f64);
        let rung = |n: usize| ROUGHNESS.0 * libm::pow(step, n as f64);
        let pairs = (0..LADDER).flat_map(|i| (0..i).map(move |j| [rung(j), rung(i)])).collect();
        let mut model = best(pairs).ok_or_else(|| FitError::Table("no microfacets".into()))?;
        for _ in 0..REFINED {
            step = libm::sqrt(step);
            let [a, b] = model.roughness;
            let near = [1.0 / step, 1.0, step];
            let pairs = near.iter().flat_map(|x| near.map(|y| [a * x, (b * y).min(1.0)])).collect();
            model = best(pairs).unwrap_or(model);
        }
        Ok(model)
    }
}

/// The best coefficients of which none is below 0, by coordinate descent.
fn not_below_zero(gram: &[[f64; TERMS]; TERMS], moment: &[f64; TERMS]) -> [f64; TERMS] {
    let mut x = [0.0; TERMS];
    for _ in 0..SWEEPS {
        for i in 0..TERMS {
            let product: f64 = (0..TERMS).map(|j| gram[i][j] * x[j]).sum();
            x[i] = f64::max(0.0, x[i] + (moment[i] - product) / gram[i][i].max(1e-300));
        }
    }
    x
}

impl Fitted for Microfacets {
    fn view(&self, theta: f64) -> Result<Box<dyn FittedView + '_>, FitError> {
        if !(0.0..=FRAC_PI_2).contains(&theta) {
            return Err(FitError::Table(format!("view at {} degrees; from 0 to 90", theta.to_degrees())));
        }
        let (sin, cos) = libm::sincos(theta);
        Ok(Box::new(MicrofacetsView { model: self, wo: [-sin, 0.0, cos] }))
    }
}

struct MicrofacetsView<'a> {
    model: &'a Microfacets,
    wo: [f64; 3],
}

impl FittedView for MicrofacetsView<'_> {
    fn f_cos(&self, direction: [f64; 3]) -> [f64; 3] {
        self.model.evaluate(direction, self.wo).map(|v| v * direction[2])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use srbf_fit::table::Density;

    #[test]
    fn a_model_of_its_own_kind_is_found_again() {
        let coefficients =
            [[0.3, 0.05, 0.8, 0.02, 0.5], [0.1, 0.05, 0.8, 0.02, 0.5], [0.05, 0.05, 0.8, 0.02, 0.5]];
        let truth = Microfacets { roughness: [0.08, 0.35], coefficients };
        let views = [0.1, 0.5, 0.9, 1.2];
        let table = Table::from_brdf(&truth, &views, Density::default()).unwrap();
        let found = Microfacets::fit(&table).unwrap();
        for view in &table.views {
            let report = srbf_fit::judge::report::ViewReport::judge(&found, view).unwrap();
            assert!(report.error < 0.1 && report.regions.chroma < 0.03, "{found:?} {report:?}");
        }
    }
}
