//! The kernels: what turns a material into a mixture, and a mixture into values, densities and samples, with
//! the methods of both.
//!
//! [`prepare`] makes mixtures ([`between_views`]; of anisotropic materials [`among_rings`], without vectors [`prepare_anisotropic`]). [`one_direction`] and [`one_mixture`] (many
//! directions) evaluate them and draw from them, all by [`draw`]; in batches by [`lobe_sums`].
//!
//! Many hits, each with lobes of its own, are taken in blocks of sixteen. *Sources* fill the lobes: from the file of a material that is
//! asked directly ([`streamed`]), from the rows of an [`expanded`] one, from mixtures ([`each_mixture`]). A [`block`] draws and
//! sums, whatever the source, and [`answers`] puts that into the outputs of a [`request`].
//!
//! May import: `mixture`, `material`, `squeeze`, `color`, `float`, `simd`, `error`; nothing but `estimator`,
//! `sheet`, `blend` and `environment` imports from here.

#[cfg(feature = "simd")]
mod among_rings;
pub(crate) mod answers;
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
pub(crate) mod streamed;
