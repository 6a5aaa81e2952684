//! Zonal kernels: functions on the sphere that depend on the angle to an axis alone, and what is folded of
//! them.
//!
//! [`kernel::Kernel`] is what they share; the Gaussian, which all else of this crate is made of, lives in
//! `lobe`. Abel-Poisson kernels, Legendre series, tables and the Metropolis walk come with the feature
//! `kernels`.
//! May import: `squeeze`, `special`, `float`, `quadrature`, `simd`, `error`.

#[cfg(feature = "kernels")]
pub(crate) mod abel_poisson;
pub(crate) mod around;
pub(crate) mod folded;
pub(crate) mod kernel;
#[cfg(feature = "kernels")]
pub(crate) mod legendre;
#[cfg(feature = "kernels")]
pub(crate) mod metropolis;
#[cfg(feature = "kernels")]
pub(crate) mod table;
