//! Readers, fitters and error metrics: makes `.srbf` materials, offline.

mod banded;
pub mod blend;
pub mod compare;
pub mod cross;
pub mod dense;
mod error;
mod initialize;
pub mod lafortune;
mod levenberg;
mod material;
pub mod method;
mod model;
mod objective;
mod parameters;
mod random;
pub mod reciprocity;
pub mod report;
pub mod table;
pub mod thesis;
mod track;
mod tracked;
mod write;

pub use error::{FitError, ReadError};
pub use track::{Fit, Settings, fit, fit_content};
pub use tracked::{Tracked, TrackedLobes};
pub use write::write_atomically;
