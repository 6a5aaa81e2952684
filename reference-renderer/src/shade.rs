//! How a material is shaded, and how incident directions are chosen for it.
//!
//! A [`Sampler`] is fitted to one truth: lobes, or a table. For an outgoing direction it becomes a [`Proposal`], which draws incident
//! directions and has a density. Neither uses a value: `shader` divides the value by the density.
//!
//! Lobes of this library are drawn from by `srbf_core` itself; the samplers of others are in `srbf_thesis::samplers`.
//! Arrows: `shader` -> `sampler` -> `proposal`.
//!
//! May import: `truth`, `numbers`.

pub mod proposal;
pub mod sampler;
pub mod shader;
pub mod strategy;
#[cfg(test)]
mod tests;

pub use sampler::Sampler;
pub use strategy::{Light, SamplerName, Strategy};
