//! How a material is shaded, and how incident directions are chosen for it.
//!
//! A [`Sampler`] is fitted to one truth: lobes, or a table. For an outgoing direction it becomes a [`Proposal`], which draws incident
//! directions and has a density. Both sees no value: dividing one by the other is the part of who shades.
//!
//! | file | draws by |
//! |---|---|
//! | `analytic` | the lobe of Phong, Ward or GGX beside a cosine |
//! | `lafortune` | Lafortune's generalised cosine lobes |
//! | `half_angles`, `tabulated`, `factored` | a table over the half vector, whole or factored |
//! | `rgl` | the warps of a `.bsdf` file |
//! | `thesis` | round lobes blended by equation 9 |
//!
//! Lobes of this library are drawn from by `srbf_core` itself. The densities that the fits of
//! samplers share stand in `truth`. Arrows: `shader` -> `sampler` -> `proposal` -> all others.
//!
//! May import: `truth`, `numbers`.

pub mod analytic;
pub mod factored;
pub mod half_angles;
pub mod lafortune;
pub mod proposal;
pub mod rgl;
pub mod sampler;
pub mod shader;
pub mod strategy;
pub mod tabulated;
#[cfg(test)]
mod tests;
pub mod thesis;
pub mod views;

pub use sampler::Sampler;
pub use strategy::{Light, SamplerName, Strategy};
