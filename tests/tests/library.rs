//! The tests of `core` that can share a process.

mod arrays;
mod chi_square;
mod dependencies;
mod estimators;
mod extremes;
mod factors;
mod leave_out;
mod material;
mod oracle_coverage;
mod presets;
mod properties;
mod room;
mod sampling;
mod spectra;
