//! How incident directions are chosen, apart from what is rendered and from samples of the light.
//!
//! A [`Sampler`] is fitted to one truth: lobes, or a table. For an outgoing direction it becomes a [`Proposal`], which draws incident
//! directions and has a density. Both sees no value: dividing one by the other is the part of who shades.
//!
//! | file | draws by |
//! |---|---|
//! | `plain` | nothing: uniform and cosine |
//! | `analytic` | the lobe of Phong, Ward or GGX beside a cosine |
//! | `lafortune` | Lafortune's generalised cosine lobes |
//! | `guided` | GGX lobes of fixed roughness beside a cosine |
//! | `half_angles`, `tabulated`, `factored` | a table over the half vector, whole or factored |
//! | `rgl` | the warps of a `.bsdf` file |
//! | `thesis` | round lobes blended by equation 9 |
//!
//! Lobes of this library are drawn from by `srbf_core` itself. Arrows: `strategy` <- `sampler` -> all others -> `seen`, `ggx`.

pub mod analytic;
pub mod factored;
pub mod ggx;
pub mod ggx_parts;
pub mod guided;
pub mod half_angles;
pub mod lafortune;
pub mod plain;
pub mod proposal;
pub mod rgl;
pub mod sampler;
pub mod seen;
pub mod strategy;
pub mod tabulated;
#[cfg(test)]
mod tests;
pub mod thesis;
pub mod views;

pub use sampler::Sampler;
pub use strategy::{Light, SamplerName, Strategy};
