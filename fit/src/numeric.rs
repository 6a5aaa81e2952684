//! Linear algebra for the normal equations of a fit, beside that which `srbf-measured` has.

pub(crate) mod banded;
pub(crate) mod blocks;

pub(crate) use srbf_measured::numeric::{GOLDEN_ANGLE, cholesky, levenberg, median, random, special, vector};
