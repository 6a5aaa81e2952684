//! The fit of isotropic materials: one family of lobes, followed along the angle of the outgoing direction.

mod balance;
mod effort;
mod encode;
mod factors;
mod knots;
pub(crate) mod model;
pub(crate) mod objective;
pub(crate) mod search;
mod seen_by;
mod source;

pub(crate) use source::{fit_evaluable, fit_samples};
