//! Fitters and error metrics: makes `.srbf` materials, offline.
//!
//! Measurements are read, completed and written by `srbf-measured`, whose modules and functions stand here too.

mod anisotropic;
mod clock;
mod family;
mod fewest_lobes;
mod fit;
mod isotropic;
pub mod judge;
mod numeric;
pub mod pack;
mod settings;
mod sheet;

pub use anisotropic::judge_at;
pub use fit::{Tracked, fit, fit_content, fit_source};
pub use judge::fitted_material::view_angles;
pub use judge::report::Fit;
#[doc(hidden)]
pub use settings::range;
pub use settings::{FactorNodes, Settings};
pub use sheet::{
    Light, QuarterFit, SheetFit, encoded, fit_sheet, joined, klems_of, klems_of_sheet, light_of_sheet, stored,
};
#[doc(hidden)]
pub use srbf_measured::with_reasons;
pub use srbf_measured::{FitError, ReadError};
pub use srbf_measured::{Outputs, check_output, write_atomically};
pub use srbf_measured::{analytic, complete, export, look, patches, read, table};
pub use srbf_measured::{check_memory, in_threads, read_at_most, read_if};
