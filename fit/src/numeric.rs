//! Linear algebra, minimisation and random numbers: knows nothing of BRDFs.

pub(crate) mod banded;
pub(crate) mod blocks;
pub(crate) mod cholesky;
#[cfg(feature = "baselines")]
pub(crate) mod lbfgsb;
pub(crate) mod levenberg;
pub(crate) mod random;
pub(crate) mod special;
pub(crate) mod vector;
