//! Linear algebra, minimisation and random numbers: knows nothing of BRDFs.

pub mod cholesky;
pub mod levenberg;
pub mod median;
pub mod random;
pub mod special;
pub mod vector;

/// Golden angle, radians: the turn from one point of an even spiral to the next.
pub const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
