//! Measurements: the error of samplers against time, figures of the thesis, white furnaces, rounding errors.
//!
//! May import: `trace`, `shade`, `world`, `truth`, `numbers`, `out`.

#[cfg(test)]
mod agreement;
pub mod comparison;
pub mod figures;
pub mod furnace;
pub mod stability;
