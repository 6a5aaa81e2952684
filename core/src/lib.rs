//! Mixtures of spherical Gaussian lobes for rendering with measured BRDFs: evaluate, integrate, importance-sample.
//!
//! A [`Material`] is read in place from `.srbf` bytes, offline work of `srbf-fit`. [`Material::prepare`] makes the
//! [`Mixture`] of lobes for one outgoing direction; the mixture gives the value `f cos`, the albedo, the density and
//! the samples, all of the same lobes, so that `value / pdf` has constant luminance.
//!
//! Directions are unit vectors in the caller's shading frame, +z the surface normal. Outgoing `wo` points towards the
//! viewer and is fixed, incident `wi` points towards the light and is sampled. Values are linear sRGB.
//!
//! Not-a-number policy: constructors refuse what has no meaning; evaluation and sampling of what was constructed never
//! make a NaN from unit directions. Any other vector gives an unspecified value, never a panic.
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

mod anisotropic;
mod batch;
#[cfg(feature = "simd")]
mod block;
mod checksum;
mod color;
mod error;
mod estimator;
mod factors;
#[cfg(feature = "std")]
mod file;
mod float;
mod folded;
mod format;
mod horizon;
mod kernel;
mod lanes;
mod leave_out;
mod lobe;
mod material;
mod mixture;
mod pairs;
mod prepare;
mod product;
mod quadrature;
mod simd;
mod single;
pub mod special;
mod squeeze;
mod two;

pub use batch::SamplesMut;
pub use color::color_differences;
pub use error::{Error, FormatError};
pub use estimator::{Defensive, balance_heuristic, power_heuristic};
#[cfg(feature = "std")]
pub use file::{FileError, read_file};
pub use folded::Folded;
pub use format::grid::{Grid, GridView, TiltedLobe};
pub use format::{FORMAT_VERSION, FactorTable, Line, PlaneLobe, View, encoded_len};
pub use glam::Vec3;
pub use kernel::Kernel;
#[cfg(feature = "kernels")]
pub use kernel::{
    abel_poisson::AbelPoisson,
    legendre::{
        abel_poisson_coefficients_into, gaussian_coefficients_into, legendre_coefficients_into,
        legendre_series, legendre_singular_integral,
    },
    metropolis::Metropolis,
    table::KernelTable,
};
pub use leave_out::LeaveOut;
pub use lobe::{Gaussian, Lobe, MAX_SHARPNESS};
pub use material::Material;
pub use mixture::{Domain, LUMINANCE, MAX_LOBES, Mixture, Sample, luminance};
pub use product::GaussianProduct;
pub use simd::Level;
