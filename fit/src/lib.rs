//! Readers, fitters and error metrics: makes `.srbf` materials, offline.

mod banded;
pub mod cross;
mod data_term;
mod error;
mod initialize;
mod levenberg;
mod material;
mod model;
mod objective;
mod parameters;
mod random;
pub mod report;
pub mod table;
mod track;
mod vector;
mod write;

pub use error::{FitError, ReadError};
pub use track::{Fit, Settings, fit, fit_content};
pub use write::write_atomically;
