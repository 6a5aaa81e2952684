//! The fit of isotropic materials: one family of lobes, followed along the angle of the outgoing direction.
//!
//! May import: `clock`, `family`, `judge`, `numeric`, `settings`.

mod balance;
mod effort;
mod encode;
pub(crate) mod line;
mod resample;
pub(crate) mod search;
mod source;
mod stored_views;
pub(crate) mod tuning;

pub(crate) use source::{fit_evaluable, fit_samples};
