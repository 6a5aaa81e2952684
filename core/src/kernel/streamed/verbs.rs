//! The verbs of a material for n hits, by name: each is a [`Request`].

use super::super::request::{Draws, Request, Towards};
use super::super::slices::SamplesMut;
use crate::error::Error;
use crate::material::borrowed::Material;
#[cfg(doc)]
use crate::mixture::rows::Mixture;

/// One outgoing direction for each of n pairs; see [`ask`](Self::ask).
impl<B: AsRef<[u8]>> Material<B> {
    /// Evaluates `f cos` for n pairs of an outgoing and an incident direction; 1/sr.
    ///
    /// The same values as [`prepare`](Self::prepare) and [`Mixture::evaluate`], pair by pair. An outgoing
    /// direction below the horizon, or none at all (not finite, not of unit length), gives 0.
    ///
    /// Shapes: `wo` and `wi` x, y, z, each `[n]`; `value` red, green, blue, each `[n]`, overwritten.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn evaluate_pairs_into(
        &self,
        wo: [&[f32]; 3],
        wi: [&[f32]; 3],
        value: [&mut [f32]; 3],
    ) -> Result<(), Error> {
        self.ask(wo, Request { draw: None, evaluate: Some(Towards { wi, value: Some(value), pdf: None }) })
    }

    /// Evaluates `f cos` and the density for n pairs of an outgoing and an incident direction; 1/sr.
    ///
    /// Shapes: as in [`evaluate_pairs_into`](Self::evaluate_pairs_into), and `pdf` `[n]`, overwritten.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn evaluate_and_pdf_pairs_into(
        &self,
        wo: [&[f32]; 3],
        wi: [&[f32]; 3],
        value: [&mut [f32]; 3],
        pdf: &mut [f32],
    ) -> Result<(), Error> {
        let towards = Towards { wi, value: Some(value), pdf: Some(pdf) };
        self.ask(wo, Request { draw: None, evaluate: Some(towards) })
    }

    /// Evaluates the density alone for n pairs of an outgoing and an incident direction; 1/sr.
    ///
    /// One sum over the lobes in place of three: the densities of
    /// [`evaluate_and_pdf_pairs_into`](Self::evaluate_and_pdf_pairs_into) within rounding.
    ///
    /// Shapes: `wo` and `wi` x, y, z, each `[n]`; `pdf` `[n]`, overwritten.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn pdf_pairs_into(&self, wo: [&[f32]; 3], wi: [&[f32]; 3], pdf: &mut [f32]) -> Result<(), Error> {
        self.ask(wo, Request { draw: None, evaluate: Some(Towards { wi, value: None, pdf: Some(pdf) }) })
    }

    /// Draws an incident direction for each of n outgoing ones, with density and weight `f cos / pdf`.
    ///
    /// The same samples as [`prepare`](Self::prepare) and [`Mixture::sample`], one by one. Where nothing is
    /// reflected (and for an outgoing direction that is none) the sample is the normal with density 0 and
    /// weight 0.
    ///
    /// Shapes: `wo` x, y, z and `u` three uniform numbers in [0, 1), each `[n]`; `samples`, every slice
    /// `[n]`, overwritten.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn sample_pairs_into(
        &self,
        wo: [&[f32]; 3],
        u: [&[f32]; 3],
        samples: SamplesMut<'_>,
    ) -> Result<(), Error> {
        self.ask(wo, Request { draw: Some(samples.draws(u)), evaluate: None })
    }

    /// Draws an incident direction for each of n outgoing ones, with density, without a weight.
    ///
    /// One colour channel in place of three: the samples of [`sample_pairs_into`](Self::sample_pairs_into),
    /// for callers that take the value elsewhere. Where nothing is reflected the sample is the normal with
    /// density 0.
    ///
    /// Shapes: `wo` x, y, z and `u` three uniform numbers in [0, 1), each `[n]`; `direction` x, y, z, and
    /// `pdf`, each `[n]`, overwritten; 1/sr.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn sample_pdf_pairs_into(
        &self,
        wo: [&[f32]; 3],
        u: [&[f32]; 3],
        direction: [&mut [f32]; 3],
        pdf: &mut [f32],
    ) -> Result<(), Error> {
        let draw = Draws { u, direction, pdf: Some(pdf), weight: None };
        self.ask(wo, Request { draw: Some(draw), evaluate: None })
    }

    /// Draws an incident direction for each of n outgoing ones, and evaluates value and density towards another
    /// one, with one preparation: what next-event estimation needs at every hit.
    ///
    /// Shapes: as in [`sample_pairs_into`](Self::sample_pairs_into) and, of the other directions `wi`, in
    /// [`evaluate_and_pdf_pairs_into`](Self::evaluate_and_pdf_pairs_into).
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn sample_and_evaluate_pairs_into(
        &self,
        wo: [&[f32]; 3],
        u: [&[f32]; 3],
        samples: SamplesMut<'_>,
        wi: [&[f32]; 3],
        value: [&mut [f32]; 3],
        pdf: &mut [f32],
    ) -> Result<(), Error> {
        let towards = Towards { wi, value: Some(value), pdf: Some(pdf) };
        self.ask(wo, Request { draw: Some(samples.draws(u)), evaluate: Some(towards) })
    }
}
