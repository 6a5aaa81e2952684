//! Numbers that samples are made of: generators and sequences of points.
//!
//! May import: nothing.

pub mod points;
pub mod random;
