//! What the tests share: oracle, tolerances, inputs, statistics.

pub mod native;
