//! The thesis's own algorithm (section 4.1), as the baseline of comparisons.
//!
//! Each view has a vector of f over a cube map, an initial guess from its peaks, and a fit of round lobes by L-BFGS-B; between
//! views equation 9. The fit is of f, not of `f cos`; nothing is folded or squeezed; each view is on its own. Open points of the
//! thesis are decided in its favour, and noted: texels below the horizon take no part (`cube`), colours share axes and sharpness
//! (`optimize`), unknowns are scaled for the solver. So are these:
//!
//! * the amplitudes are solved for once before the first step of the axes: those of the guess are the values at the axes, and
//!   lobes that overlap are too bright by then;
//! * the intensity of the guess is the luminance (`guess`);
//! * the sharpness, its bandwidth, is kept from 0.05 to that of a lobe as wide as a texel, 8192 with faces of 64 texels. The fit
//!   ends at the upper bound on some materials with sharp highlights: the map does not see a narrower one.

mod cube;
mod guess;
mod kernel;
mod lobes;
mod optimize;
mod resample;

pub use lobes::RoundLobe;

use crate::blend::{self, Neighbours};
use cube::Cube;
use rayon::prelude::*;
use resample::Vector;
use srbf_core::LUMINANCE;
use srbf_fit::FitError;
use srbf_fit::judge::method::{Fitted, FittedView, Method};
use srbf_fit::judge::report::Ending;
use srbf_fit::range;
use srbf_fit::table::{Brdf, Symmetry};
use srbf_fit::table::{Table, check_bright};

/// How the thesis's algorithm is run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThesisSettings {
    /// Lobes of every view.
    pub lobes: usize,
    /// Texels along the edge of a face of the cube map, even.
    pub edge: usize,
    /// First threshold of the initial guess: a coverage ends where the intensity differs by more than this share of the
    /// largest.
    pub coverage: f64,
    /// Most iterations over axes, sharpness and amplitudes.
    pub iterations: usize,
    /// Relative change of the squared error in an iteration below which the fit ends.
    pub threshold: f64,
    /// Most steps of L-BFGS-B for one kind of unknowns in one iteration.
    pub steps: u64,
}

impl Default for ThesisSettings {
    fn default() -> Self {
        Self { lobes: 12, edge: 64, coverage: 0.25, iterations: 60, threshold: 5e-3, steps: 10 }
    }
}

/// One view's lobes.
#[derive(Clone, Debug, PartialEq)]
pub struct RoundView {
    /// Angle of the outgoing direction from the normal, radians.
    pub theta: f64,
    /// Its lobes.
    pub lobes: Vec<RoundLobe>,
    /// Relative L2 error of f over the measured texels, which the fit made small.
    pub error: f64,
    /// Why its iterations ended.
    pub ending: Ending,
}

/// A fit by the thesis's algorithm.
#[derive(Clone, Debug, PartialEq)]
pub struct ThesisFit {
    /// The views, theta rising.
    pub views: Vec<RoundView>,
    /// Views that are blended in between.
    pub neighbours: Neighbours,
    /// Evaluations of the squared error of a view over all texels, all views together.
    pub evaluations: usize,
}

/// Fits a table of samples: its views, resampled on the cube map.
///
/// # Errors
/// [`FitError::Setting`]; [`FitError::Table`] for a table without views or brightness.
pub fn fit_table(table: &Table, settings: &ThesisSettings) -> Result<ThesisFit, FitError> {
    check(settings)?;
    let cube = Cube::new(settings.edge);
    fit(resample::from_table(table, &cube), &cube, settings)
}

/// Fits a BRDF at angles of the outgoing direction, radians.
///
/// # Errors
/// [`FitError::Setting`]; [`FitError::Table`] for no angle, one outside [0, pi / 2), no brightness, and an anisotropic BRDF.
pub fn fit_brdf(brdf: &dyn Brdf, thetas: &[f64], settings: &ThesisSettings) -> Result<ThesisFit, FitError> {
    check(settings)?;
    if brdf.symmetry() != Symmetry::Isotropic {
        return Err(FitError::Table("it is anisotropic: this method fits isotropic surfaces".into()));
    }
    let cube = Cube::new(settings.edge);
    fit(resample::from_brdf(brdf, thetas, &cube)?, &cube, settings)
}

fn fit(vectors: Vec<Vector>, cube: &Cube, settings: &ThesisSettings) -> Result<ThesisFit, FitError> {
    if vectors.is_empty() {
        return Err(FitError::Table("no view".into()));
    }
    check_bright(vectors.iter().flat_map(|v| &v.values).flatten().any(|v| *v > 0.0))?;
    let optimized: Vec<_> = vectors.par_iter().map(|v| optimize::fit(cube, &v.values, settings)).collect();
    let evaluations = optimized.iter().map(|o| o.evaluations).sum();
    let view = |(v, o): (&Vector, optimize::Optimized)| RoundView {
        theta: v.theta,
        lobes: o.lobes,
        error: libm::sqrt(o.cost),
        ending: o.ending,
    };
    let mut views: Vec<RoundView> = vectors.iter().zip(optimized).map(view).collect();
    views.sort_by(|a, b| a.theta.total_cmp(&b.theta));
    Ok(ThesisFit { views, neighbours: Neighbours::ThreeOrFour, evaluations })
}

fn check(settings: &ThesisSettings) -> Result<(), FitError> {
    range("lobes", (1..=srbf_core::MAX_LOBES).contains(&settings.lobes), "from 1 to 64")?;
    range(
        "edge",
        (2..=512).contains(&settings.edge) && settings.edge.is_multiple_of(2),
        "even, from 2 to 512",
    )?;
    range("coverage", settings.coverage > 0.0 && settings.coverage <= 1.0, "above 0, at most 1")?;
    range("iterations", (1..=10_000).contains(&settings.iterations), "from 1 to 10000")?;
    range("steps", (1..=10_000).contains(&settings.steps), "from 1 to 10000")?;
    range("threshold", (0.0..1.0).contains(&settings.threshold), "at least 0 and less than 1")
}

impl ThesisFit {
    /// Why the fit ended: with its most iterations if any view did.
    pub fn ending(&self) -> Ending {
        let any = self.views.iter().any(|view| view.ending == Ending::Steps);
        if any { Ending::Steps } else { Ending::Converged }
    }

    /// The same lobes, blended over other views.
    pub fn blended_over(&self, neighbours: Neighbours) -> Self {
        Self { neighbours, ..self.clone() }
    }

    /// The lobes as JSON, a list of views.
    pub fn to_json(&self) -> serde_json::Value {
        let lobe = |l: &RoundLobe| serde_json::json!({"axis": l.axis, "sharpness": l.sharpness, "amplitude": l.amplitude});
        let view = |v: &RoundView| {
            let lobes: Vec<_> = v.lobes.iter().map(lobe).collect();
            serde_json::json!({
                "theta_degrees": v.theta.to_degrees(),
                "relative_l2_of_f_on_the_cube_map": v.error,
                "lobes": lobes,
            })
        };
        self.views.iter().map(view).collect()
    }
}

impl Method for ThesisSettings {
    fn fit(&self, table: &Table) -> Result<Box<dyn Fitted>, FitError> {
        Ok(Box::new(fit_table(table, self)?))
    }
}

impl ThesisFit {
    /// The lobes at an angle of the outgoing direction, radians: those of the views that equation 9 blends, each with the amplitude
    /// that its view's weight leaves it.
    pub fn lobes_at(&self, theta: f64) -> Vec<RoundLobe> {
        let thetas: Vec<f64> = self.views.iter().map(|v| v.theta).collect();
        let mut lobes = Vec::new();
        for (n, weight) in blend::weights(&thetas, theta, self.neighbours) {
            let blended = |l: &RoundLobe| RoundLobe { amplitude: l.amplitude.map(|a| weight * a), ..*l };
            lobes.extend(self.views[n].lobes.iter().map(blended));
        }
        lobes
    }
}

impl Fitted for ThesisFit {
    fn view(&self, theta: f64) -> Result<Box<dyn FittedView + '_>, FitError> {
        let lobes = self.lobes_at(theta);
        // Equation 14: a lobe is chosen by its integral.
        let power: Vec<f64> = lobes
            .iter()
            .map(|l| (0..3).map(|c| f64::from(LUMINANCE[c]) * l.amplitude[c]).sum::<f64>())
            .collect();
        let total: f64 = power.iter().zip(&lobes).map(|(p, l)| p * l.unit_integral()).sum();
        Ok(Box::new(BlendedViews { lobes, power, total }))
    }
}

/// The lobes of the views that are blended at one outgoing direction.
struct BlendedViews {
    lobes: Vec<RoundLobe>,
    /// Luminance of each lobe's amplitude.
    power: Vec<f64>,
    total: f64,
}

impl FittedView for BlendedViews {
    fn f_cos(&self, direction: [f64; 3]) -> [f64; 3] {
        lobes::evaluate(&self.lobes, &direction).map(|v| v * direction[2])
    }

    /// Over the sphere: the part below the horizon is lost.
    fn pdf(&self, direction: [f64; 3]) -> Option<f64> {
        let sum: f64 = self.lobes.iter().zip(&self.power).map(|(l, p)| p * l.unit(&direction)).sum();
        Some(if self.total > 0.0 { sum / self.total } else { 0.0 })
    }

    fn share_above_horizon(&self) -> f64 {
        let above: f64 =
            self.lobes.iter().zip(&self.power).map(|(l, p)| p * l.unit_integral_above_horizon()).sum();
        if self.total > 0.0 { above / self.total } else { 1.0 }
    }
}
