//! Zonal kernels: functions on the sphere that depend on the angle to an axis alone, and their folded
//! forms.
//!
//! [`kernel::Kernel`] is their interface; the Gaussian, which all else of this crate is made of, lives in
//! `lobe`. Abel-Poisson kernels, Legendre series, tables and the Metropolis walk come with the feature
//! `zonal`.
//! May import: `squeeze`, `special`, `float`, `quadrature`, `simd`, `error`.

#[cfg(feature = "zonal")]
pub(crate) mod abel_poisson;
pub(crate) mod around;
pub(crate) mod folded;
pub(crate) mod kernel;
#[cfg(feature = "zonal")]
pub(crate) mod legendre;
#[cfg(feature = "zonal")]
pub(crate) mod metropolis;
#[cfg(feature = "zonal")]
pub(crate) mod table;
