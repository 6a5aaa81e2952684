//! The kernels: what turns a material into a mixture, and a mixture into values, densities and samples, with
//! the methods of both.
//!
//! [`prepare`] makes mixtures ([`between_views`], or [`prepare_anisotropic`]). [`one_direction`],
//! [`one_mixture`] (many directions) and [`each_mixture`] (pairs of directions, a [`block`] at a time)
//! evaluate and draw, all by [`draw`]; in batches by [`lobe_sums`]. A material that is asked directly
//! ([`streamed`]), and an [`expanded`] one, do so without mixtures. A [`request`] holds the inputs and wanted outputs of a batch.
//! May import: `mixture`, `material`, `squeeze`, `color`, `simd`, `error`; nothing but `estimator` and
//! `environment` imports from here.

mod answers;
pub(crate) mod between_views;
pub(crate) mod block;
pub(crate) mod draw;
mod each_mixture;
pub(crate) mod expanded;
pub(crate) mod lobe_sums;
pub(crate) mod multiply_factors;
pub(crate) mod one_direction;
mod one_lobe;
mod one_mixture;
pub(crate) mod outgoing;
pub(crate) mod prepare;
pub(crate) mod prepare_anisotropic;
pub(crate) mod request;
pub(crate) mod sights;
pub(crate) mod slices;
mod streamed;
