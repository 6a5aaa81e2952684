//! Readers, fitters and error metrics: makes `.srbf` materials, offline.

mod anisotropic;
mod banded;
pub mod blend;
mod choice;
pub mod compare;
mod content;
pub mod cross;
mod data_term;
pub mod dense;
mod error;
mod exchange;
mod initialize;
mod knots;
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
mod settings;
pub mod table;
pub mod thesis;
mod track;
mod tracked;
mod vector;
mod write;

pub use content::fit_content;
pub use error::{FitError, ReadError};
pub use settings::Settings;
pub use track::{Fit, fit};
pub use tracked::{Tracked, TrackedLobes};
pub use write::write_atomically;
