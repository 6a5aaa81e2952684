//! Measurements: the error of samplers against time, and white furnaces.
//!
//! May import: `trace`, `shade`, `world`, `truth`, `numbers`, `out`.

#[cfg(test)]
mod agreement;
pub mod comparison;
pub mod furnace;
