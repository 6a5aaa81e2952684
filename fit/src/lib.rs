//! Readers, fitters and error metrics: makes `.srbf` materials, offline.

mod anisotropic;
mod banded;
mod choice;
mod content;
pub mod cross;
mod data_term;
mod error;
mod exchange;
mod initialize;
mod knots;
mod levenberg;
mod material;
mod model;
mod objective;
mod parameters;
mod random;
pub mod report;
mod settings;
pub mod table;
mod track;
mod vector;
mod write;

pub use content::fit_content;
pub use error::{FitError, ReadError};
pub use settings::Settings;
pub use track::{Fit, fit};
pub use write::write_atomically;
