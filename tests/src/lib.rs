//! What the tests share: oracle, tolerances, inputs, statistics.

pub mod header;
pub mod native;
