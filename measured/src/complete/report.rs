//! The quality of a completion.

use super::gaps::Gaps;
use super::held_out::HeldOut;
use super::microfacet::Family;
use super::robust::Outlier;
use super::turn::Turn;
use serde_json::{Value, json};

/// The report of a completion.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CompletionReport {
    /// Samples.
    pub samples: usize,
    /// How many points it is made of: fewer than samples, if close ones were taken together.
    pub points: usize,
    /// Samples that are left out, as the others predict something else; they are not among `samples`.
    pub outliers: Vec<Outlier>,
    /// The part of the model beside a diffuse term and a lobe.
    pub family: Family,
    /// Angles of the outgoing direction, radians, and the albedo before it is held to at most 0.98, linear sRGB.
    pub albedo: Vec<(f64, [f64; 3])>,
    /// Width of the model's lobe: tangent of the angle of facets at which they have become few.
    pub width: f64,
    /// Exponent with which they become fewer; 2 is GGX.
    pub exponent: f64,
    /// Lengths over which the residual of the model is alike, in the coordinates of the process.
    pub lengths: [f64; 4],
    /// Variance of the noise of the logarithm of a sample.
    pub noise: f64,
    /// Errors of samples that are left out one by one.
    pub samples_left_out: HeldOut,
    /// Errors of views that are left out; neighbours are taken together where there are many. `None` with fewer than three.
    pub views_left_out: Option<HeldOut>,
    /// Errors of the model alone, at the samples.
    pub model_alone: HeldOut,
    /// The axis of a surface that a turn changes.
    pub turn: Option<Turn>,
    /// Whether an exchange of both directions changes values: of the transmission of a sheet whose sides differ.
    pub sides: bool,
    /// Where there are no samples.
    pub gaps: Gaps,
}

impl CompletionReport {
    #[doc(hidden)]
    pub fn to_json(&self) -> Value {
        let held_out =
            |h: &HeldOut| json!({"mean_relative_l2": h.error, "root_mean_square_of_logarithms": h.logarithm});
        let outlier = |o: &Outlier| json!({"view": o.view, "sample": o.sample, "over_what_others_say": o.ratio, "is_wrong": o.is_wrong});
        let albedo = |a: &(f64, [f64; 3])| json!({"theta_degrees": a.0.to_degrees(), "albedo": a.1});
        json!({
            "samples": self.samples,
            "points": self.points,
            "outliers": self.outliers.iter().map(outlier).collect::<Vec<_>>(),
            "albedo_before_cap": self.albedo.iter().map(albedo).collect::<Vec<_>>(),
            "model": {"family": self.family.name(), "width": self.width, "exponent": self.exponent},
            "turn": self.turn.map(|turn| json!({
                "axis_degrees": turn.axis.to_degrees(),
                "wider_along": turn.along * turn.along,
                "symmetry": turn.kept.text(),
            })),
            "sides_differ": self.sides,
            "lengths": self.lengths,
            "noise": self.noise,
            "samples_left_out": held_out(&self.samples_left_out),
            "views_left_out": self.views_left_out.as_ref().map(held_out),
            "model_alone": held_out(&self.model_alone),
            "share_without_samples_within_20_degrees": self.gaps.mean(),
            "empty_views_degrees": self.gaps.empty().iter().map(|run| [run.0, run.1]).collect::<Vec<_>>(),
        })
    }
}
