//! The generalised cosine lobes of Lafortune, Foo, Torrance and Greenberg (1997): the thesis's equation 15.
//!
//! `f = rho / pi + sum max(0, Cxy (wo.x wi.x + wo.y wi.y) + Cz wo.z wi.z)^n`, every coefficient per colour channel, as
//! in the published fits. `Cxy < 0` is a lobe round the mirror direction, `Cxy > 0` one back to where the light comes from. The
//! model is reciprocal, and global: one set of coefficients for all outgoing directions.

mod published;
mod search;

pub use published::{names, parse, read};
pub use search::LafortuneSettings;

use srbf_fit::FitError;
use srbf_fit::judge::method::{Fitted, FittedView};
use srbf_fit::table::Brdf;
use srbf_fit::table::Table;
use std::f64::consts::{FRAC_1_PI, FRAC_PI_2};

/// A generalised cosine lobe of one channel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CosineLobe {
    /// Coefficient of the tangential part.
    pub cxy: f64,
    /// Coefficient of the normal part.
    pub cz: f64,
    /// Exponent.
    pub n: f64,
}

/// One colour channel of the model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Channel {
    /// Albedo of the diffuse term.
    pub diffuse: f64,
    /// The lobes.
    pub lobes: Vec<CosineLobe>,
}

/// The model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lafortune {
    /// Red, green, blue.
    pub channels: [Channel; 3],
    /// Evaluations of all residuals of a channel that its fit took; 0 for a model that was read.
    pub evaluations: usize,
}

impl Channel {
    /// f, from the tangential and the normal part of the product of the directions.
    fn value(&self, tangential: f64, normal: f64) -> f64 {
        let lobe = |l: &CosineLobe| {
            let t = l.cxy * tangential + l.cz * normal;
            if t > 0.0 { libm::pow(t, l.n) } else { 0.0 }
        };
        self.diffuse * FRAC_1_PI + self.lobes.iter().map(lobe).sum::<f64>()
    }
}

impl Brdf for Lafortune {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|c| self.channels[c].value(wi[0] * wo[0] + wi[1] * wo[1], wi[2] * wo[2]))
    }
}

impl Fitted for Lafortune {
    fn view(&self, theta: f64) -> Result<Box<dyn FittedView + '_>, FitError> {
        if !(0.0..=FRAC_PI_2).contains(&theta) {
            return Err(FitError::Table(format!("view at {} degrees; from 0 to 90", theta.to_degrees())));
        }
        let (sin, cos) = libm::sincos(theta);
        Ok(Box::new(LafortuneView { model: self, wo: [-sin, 0.0, cos] }))
    }
}

struct LafortuneView<'a> {
    model: &'a Lafortune,
    wo: [f64; 3],
}

impl FittedView for LafortuneView<'_> {
    fn f_cos(&self, direction: [f64; 3]) -> [f64; 3] {
        self.model.evaluate(direction, self.wo).map(|v| v * direction[2])
    }
}

impl Lafortune {
    /// Fits the model to a table.
    ///
    /// # Errors
    /// [`FitError::Setting`]; [`FitError::Table`] for a table without brightness.
    pub fn fit(table: &Table, settings: &LafortuneSettings) -> Result<Self, FitError> {
        search::fit(table, settings)
    }

    /// The coefficients as JSON, a list of channels.
    pub fn to_json(&self) -> serde_json::Value {
        let lobe = |l: &CosineLobe| serde_json::json!({"cxy": l.cxy, "cz": l.cz, "n": l.n});
        let channel = |c: &Channel| serde_json::json!({"diffuse": c.diffuse, "lobes": c.lobes.iter().map(lobe).collect::<Vec<_>>()});
        self.channels.iter().map(channel).collect()
    }
}
