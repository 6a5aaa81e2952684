//! Numbers that samples are made of: generators and sequences of points.
//!
//! Imports nothing of the crate.

pub mod points;
pub mod random;
