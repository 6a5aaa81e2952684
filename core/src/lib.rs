//! Mixtures of spherical Gaussian lobes for rendering with measured BRDFs: evaluate, integrate,
//! importance-sample.
//!
//! A [`Material`] is read in place from `.srbf` bytes, offline work of `srbf-fit`. [`Material::prepare`]
//! makes the [`Mixture`] of lobes for one outgoing direction; the mixture gives the value `f cos`, the
//! albedo, the density and the samples, all of the same lobes, so that `value / pdf` has constant luminance.
//!
//! Directions are unit vectors in the caller's shading frame, +z the surface normal. Outgoing `wo` points
//! towards the viewer and is fixed, incident `wi` points towards the light and is sampled. Values are linear
//! sRGB. Where one direction or colour goes in, it may be `[f32; 3]` or a [`Vec3`]; results are a `Vec3`, which is
//! `Into<[f32; 3]>`: no client needs `glam`.
//!
//! Not-a-number policy: constructors refuse numbers without a meaning; evaluation and sampling of constructed objects never make a
//! NaN from unit directions. Any other vector gives an unspecified value, never a panic.
//!
//! # Features
//!
//! Every feature only adds. Without any the crate is scalar f32, `no_std`, without allocation, in which form it runs on
//! microcontrollers: `docs/small-targets.md` has instructions, bytes and stack.
//!
//! | feature | by default | adds | brings |
//! |---|---|---|---|
//! | `simd` | yes | SIMD levels: portable vectors, and on x86-64 AVX2 and AVX-512, chosen at run time ([`Level`]) | `wide` |
//! | `std` | yes | [`read_file`]; the one thing here that allocates | |
//! | `environment` | no | light from a map of the surroundings (`Environment`), or of any kind (`LightSource`); light and material sampled together (`Mixture::sample_product`) | |
//! | `level-from-environment` | no | for tests and benches: the variable `SRBF_LEVEL` names the best [`Level`] that is found | |
//! | `zonal` | no | zonal kernels beside the Gaussian: Abel-Poisson, tables, Legendre series, the Metropolis walk | `rand_core` |
//!
//! # A material
//!
//! ```
//! use srbf_core::{Line, Material, Mixture, PlaneLobe, View, power_heuristic};
//!
//! // Bytes of a `.srbf` file; here one view of one lobe above a diffuse term, written on the spot.
//! let grey = [0.0; 2];
//! let lobe = PlaneLobe {
//!     angle: 0.0,
//!     off_plane: 0.0,
//!     log2_sharpness: 5.0,
//!     log2_luminance: -1.0,
//!     color_differences: grey,
//! };
//! let view = View {
//!     theta: 0.0,
//!     log2_squeeze: 0.0,
//!     log2_diffuse: -3.0,
//!     diffuse_color_differences: grey,
//!     lobes: &[lobe],
//! };
//! let line = Line { views: &[view], squeezed: 0, mirrored: 0, factors: None };
//! let mut bytes = [0; 256];
//! let length = line.encode("an example", &mut bytes)?;
//!
//! // Once: the bytes are checked, and borrowed; without `&` the material owns them.
//! let material = Material::from_bytes(&bytes[..length])?;
//! // At every hit: the mixture for its outgoing direction, in storage that is used again.
//! let mut mixture = Mixture::<16>::empty();
//! material.prepare([0.6, 0.0, 0.8], &mut mixture)?;
//!
//! // Where the path goes on, and the factor on its throughput.
//! let sample = mixture.sample([0.3, 0.6, 0.1]).expect("the material reflects");
//! let throughput = sample.weight;
//! assert!(throughput.max_element() < 1.0);
//!
//! // Light from a direction that was drawn otherwise, with density 2: value, and the weight of that sample.
//! let (value, pdf) = mixture.evaluate_and_pdf([0.0, 0.28, 0.96]);
//! let light = value / 2.0 * power_heuristic(1.0, 2.0, 1.0, pdf);
//! assert!(light.min_element() > 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Lobes of one's own
//!
//! ```
//! use srbf_core::{Lobe, Mixture};
//!
//! let lobe = Lobe::new([0.6, 0.0, 0.8], 40.0, [1.0, 0.5, 0.2])?;
//! let mixture = Mixture::<16>::hemisphere(&[lobe])?;
//! let sample = mixture.sample([0.5, 0.25, 0.75]).expect("the mixture is not black");
//! assert!((sample.pdf - mixture.pdf(sample.direction)).abs() <= 1e-6 * sample.pdf);
//! // Folded at the horizon, a lobe has the same integral over the hemisphere as over the sphere.
//! assert!((mixture.albedo() - lobe.integral()).abs().max_element() < 1e-6);
//! # Ok::<(), srbf_core::Error>(())
//! ```
#![no_std]

mod blend;
mod color;
#[cfg(feature = "environment")]
mod environment;
mod error;
mod estimator;
mod float;
mod kernel;
mod lobe;
mod material;
mod mixture;
mod printable;
mod quadrature;
mod sheet;
mod simd;
pub mod special;
mod squeeze;
mod zonal;

pub use blend::coat::fresnel;
pub use blend::part::BlendPart;
pub use blend::{Blend, MAX_BLEND};
pub use color::{LUMINANCE, color_differences, luminance};
#[cfg(feature = "environment")]
pub use environment::cell::EnvironmentCell;
#[cfg(feature = "environment")]
pub use environment::draw::EnvironmentSample;
#[cfg(feature = "environment")]
pub use environment::light::{LIGHT_BLOCK, LightRows, LightSource};
#[cfg(feature = "environment")]
pub use environment::light_block::LightBlock;
#[cfg(feature = "environment")]
pub use environment::product::ProductSample;
#[cfg(feature = "environment")]
pub use environment::reflect::Reflection;
#[cfg(feature = "environment")]
pub use environment::sampling::ProductSampling;
#[cfg(feature = "environment")]
pub use environment::table::{Environment, MAX_ENVIRONMENT_PIXELS, environment_len};
#[cfg(feature = "environment")]
pub use environment::together::MAX_REFLECT_RAYS;
pub use error::Error;
pub use estimator::{Defensive, power_heuristic};
pub use glam::Vec3;
pub use kernel::expanded::table::Expanded;
pub use kernel::prepare::PrepareOptions;
pub use kernel::request::{Draws, Request, Towards};
pub use lobe::gaussian::{Gaussian, Lobe, MAX_SHARPNESS};
pub use lobe::product::GaussianProduct;
pub use material::borrowed::Material;
pub use material::encode::encoded_len;
pub use material::factor_table::FactorTable;
#[cfg(feature = "std")]
pub use material::file::{FileError, read_file};
pub use material::format_error::{FORMAT_VERSION, FormatError};
pub use material::layout::MAX_LOBES;
pub use material::pack::PackOptions;
pub use material::spectral_map::{MAX_WAVELENGTHS, Primaries, SpectralColumns, SpectralMap};
pub use material::views::{Grid, GridView, Line, PlaneLobe, TiltedLobe, View};
pub use mixture::leave_out::LeaveOut;
pub use mixture::rows::{AnyMixture, Domain, Groups, Mixture, Room, Sample};
pub use printable::{Printable, printable, printable_lines};
pub use sheet::quarter::Quarter;
pub use sheet::{Sheet, SheetMixture};
pub use simd::detect::Level;
pub use simd::processor::Processor;
#[cfg(feature = "zonal")]
pub use zonal::abel_poisson::AbelPoisson;
pub use zonal::folded::Folded;
pub use zonal::kernel::Kernel;
#[cfg(feature = "zonal")]
pub use zonal::legendre::{
    abel_poisson_coefficients_into, gaussian_coefficients_into, legendre_coefficients_into, legendre_series,
    legendre_singular_integral,
};
#[cfg(feature = "zonal")]
pub use zonal::metropolis::Metropolis;
#[cfg(feature = "zonal")]
pub use zonal::table::KernelTable;
