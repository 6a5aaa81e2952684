//! Readers, fitters and error metrics: makes `.srbf` materials, offline.

pub mod analytic;
mod anisotropic;
#[cfg(feature = "baselines")]
pub mod baselines;
mod clock;
pub mod complete;
mod error;
pub mod export;
mod family;
mod fewest_lobes;
mod fit;
mod isotropic;
pub mod judge;
pub mod look;
mod numeric;
pub mod pack;
pub mod read;
mod settings;
pub mod table;
mod threads;
mod write;

pub use error::{FitError, ReadError};
pub use fit::{Tracked, fit, fit_content};
pub use judge::fitted_material::view_angles;
pub use judge::report::Fit;
pub use read::{check_memory, read_at_most, read_if};
pub use settings::{FactorNodes, Settings};
pub use threads::in_threads;
pub use write::{Outputs, check_output, write_atomically};
