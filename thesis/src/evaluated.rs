//! Samples without lobes: completed, by the model of a completion alone, and joined by straight lines.

use srbf_fit::FitError;
use srbf_fit::complete::{Model, complete};
use srbf_fit::judge::method::{Fitted, FittedView, Method};
use srbf_fit::table::interpolant::Interpolant;
use srbf_fit::table::{Brdf, Table};

/// Samples as `srbf_fit::complete` completes them: what our lobes are fitted to.
pub struct Completed;

/// The model of a completion alone: a microfacet lobe and a diffuse term.
pub struct Microfacet;

/// Samples of a view joined by triangles (Delaunay), linear in f between them; between views, the two neighbours, each turned so that
/// its mirror direction is where it has to be.
pub struct Nearest;

impl Method for Completed {
    fn fit(&self, table: &Table) -> Result<Box<dyn Fitted>, FitError> {
        Ok(Box::new(Evaluated(complete(table)?)))
    }
}

impl Method for Microfacet {
    fn fit(&self, table: &Table) -> Result<Box<dyn Fitted>, FitError> {
        Ok(Box::new(Evaluated(Model::fit(table)?)))
    }
}

impl Method for Nearest {
    fn fit(&self, table: &Table) -> Result<Box<dyn Fitted>, FitError> {
        let views = table.views.iter().map(|view| (view.theta, Interpolant::new(&view.samples)));
        Ok(Box::new(Joined { views: views.collect() }))
    }
}

/// A BRDF, judged as if it were a fit.
pub struct Evaluated<B>(pub B);

impl<B: Brdf> Fitted for Evaluated<B> {
    fn view(&self, theta: f64) -> Result<Box<dyn FittedView + '_>, FitError> {
        let (sin, cos) = libm::sincos(theta);
        Ok(Box::new(EvaluatedView { brdf: &self.0, wo: [-sin, 0.0, cos] }))
    }
}

struct EvaluatedView<'a> {
    brdf: &'a dyn Brdf,
    wo: [f64; 3],
}

impl FittedView for EvaluatedView<'_> {
    fn f_cos(&self, direction: [f64; 3]) -> [f64; 3] {
        self.brdf.evaluate(direction, self.wo).map(|f| f * direction[2])
    }
}

struct Joined {
    /// Angles, rising, and the samples there.
    views: Vec<(f64, Interpolant)>,
}

impl Fitted for Joined {
    fn view(&self, theta: f64) -> Result<Box<dyn FittedView + '_>, FitError> {
        let after = self.views.partition_point(|view| view.0 < theta).min(self.views.len() - 1);
        let before = if self.views[after].0 > theta { after.saturating_sub(1) } else { after };
        let apart = self.views[after].0 - self.views[before].0;
        let share = if apart > 0.0 { (theta - self.views[before].0) / apart } else { 0.0 };
        Ok(Box::new(JoinedView {
            theta,
            parts: [(&self.views[before], 1.0 - share), (&self.views[after], share)],
        }))
    }
}

struct JoinedView<'a> {
    theta: f64,
    parts: [(&'a (f64, Interpolant), f64); 2],
}

impl FittedView for JoinedView<'_> {
    fn f_cos(&self, direction: [f64; 3]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for ((theta, samples), share) in self.parts.iter().filter(|part| part.1 > 0.0) {
            let (sin, cos) = libm::sincos(theta - self.theta);
            let [x, y, z] = direction;
            let turned = [x * cos + z * sin, y.abs(), (z * cos - x * sin).max(1e-4)];
            let f = samples.values(&[turned])[0];
            (0..3).for_each(|c| sum[c] += share * f[c] * direction[2]);
        }
        sum
    }
}
