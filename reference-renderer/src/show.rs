//! Pictures of materials: a fit beside its table, and balls under a map of light.
//!
//! May import: `shade`, `trace`, `world`, `out`.

pub mod ball_sheet;
pub mod fit_sheet;
