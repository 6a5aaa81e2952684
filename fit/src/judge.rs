//! How good a fit is, whoever made it.
//!
//! May import: `clock`, `settings`.

pub mod appearance;
pub mod compare;
pub mod cross;
pub(crate) mod energy;
pub(crate) mod fitted_material;
pub mod measure;
pub mod method;
pub mod mirror_asymmetry;
pub mod norm;
pub mod reciprocity;
pub mod report;
mod report_json;
pub mod spectral;
pub mod verdict;
