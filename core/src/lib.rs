//! Mixtures of spherical Gaussian lobes for rendering with measured BRDFs: evaluate, integrate,
//! importance-sample.
//!
//! A [`Material`] is read in place from `.srbf` bytes, offline work of `srbf-fit`. [`Material::prepare`]
//! makes the [`Mixture`] of lobes for one outgoing direction; the mixture gives the value `f cos`, the
//! albedo, the density and the samples, all of the same lobes, so that `value / pdf` has constant luminance.
//!
//! Directions are unit vectors in the caller's shading frame, +z the surface normal. Outgoing `wo` points
//! towards the viewer and is fixed, incident `wi` points towards the light and is sampled. Values are linear
//! sRGB.
//!
//! Not-a-number policy: constructors refuse what has no meaning; evaluation and sampling of what was
//! constructed never make a NaN from unit directions. Any other vector gives an unspecified value, never a
//! panic.
//!
//! ```
//! use glam::vec3;
//! use srbf_core::{Lobe, Mixture};
//!
//! let lobe = Lobe::new(vec3(0.6, 0.0, 0.8), 40.0, vec3(1.0, 0.5, 0.2))?;
//! let mixture = Mixture::<16>::hemisphere(&[lobe])?;
//! let sample = mixture.sample([0.5, 0.25, 0.75]).expect("the mixture is not black");
//! assert!((sample.pdf - mixture.pdf(sample.direction)).abs() <= 1e-6 * sample.pdf);
//! # Ok::<(), srbf_core::Error>(())
//! ```
#![no_std]

mod color;
mod error;
mod estimator;
mod float;
mod kernel;
mod lobe;
mod material;
mod mixture;
mod quadrature;
mod simd;
pub mod special;
mod squeeze;
mod zonal;

pub use color::{LUMINANCE, color_differences, luminance};
pub use error::Error;
pub use estimator::{Defensive, balance_heuristic, power_heuristic};
pub use glam::Vec3;
pub use kernel::slices::SamplesMut;
pub use lobe::gaussian::{Gaussian, Lobe, MAX_SHARPNESS};
pub use lobe::product::GaussianProduct;
pub use material::borrowed::Material;
pub use material::encode::encoded_len;
pub use material::factor_table::FactorTable;
#[cfg(feature = "std")]
pub use material::file::{FileError, read_file};
pub use material::format_error::{FORMAT_VERSION, FormatError};
pub use material::layout::MAX_LOBES;
pub use material::views::{Grid, GridView, Line, PlaneLobe, TiltedLobe, View};
pub use mixture::leave_out::LeaveOut;
pub use mixture::rows::{Domain, Mixture, Sample};
pub use simd::detect::Level;
#[cfg(feature = "kernels")]
pub use zonal::abel_poisson::AbelPoisson;
pub use zonal::folded::Folded;
pub use zonal::kernel::Kernel;
#[cfg(feature = "kernels")]
pub use zonal::legendre::{
    abel_poisson_coefficients_into, gaussian_coefficients_into, legendre_coefficients_into, legendre_series,
    legendre_singular_integral,
};
#[cfg(feature = "kernels")]
pub use zonal::metropolis::Metropolis;
#[cfg(feature = "kernels")]
pub use zonal::table::KernelTable;
