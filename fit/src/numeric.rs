//! Linear algebra, minimisation and random numbers: knows nothing of BRDFs.

pub(crate) mod banded;
pub(crate) mod blocks;
pub(crate) mod cholesky;
#[cfg(feature = "baselines")]
pub(crate) mod lbfgsb;
pub(crate) mod levenberg;
pub(crate) mod median;
pub(crate) mod random;
pub(crate) mod special;
pub(crate) mod vector;

/// Golden angle, radians: the turn from one point of an even spiral to the next.
pub(crate) const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
