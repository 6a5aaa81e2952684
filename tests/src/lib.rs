//! What the tests share: oracle, tolerances, inputs, statistics.

pub mod inputs;
pub mod native;
pub mod oracle;
pub mod partition;
pub mod reference;
pub mod statistics;
pub mod tolerance;
