//! One lobe: the spherical Gaussian and its amplitude, what of it lies above the horizon, and the product of
//! two.
//!
//! May import: `zonal` (a Gaussian is a zonal kernel), `simd` for exact sums, `special`, `float`, `color`,
//! `quadrature`, `error`.

pub(crate) mod gaussian;
mod horizon;
pub(crate) mod product;
