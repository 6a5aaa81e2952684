//! Shared by the tests: oracle, tolerances, inputs, statistics.

extern crate alloc;

pub mod attack;

/// The examples of the documentation: blocks of code in Markdown.
pub mod documents;
pub mod inputs;
pub mod kinds;
pub mod maps;
pub mod native;
pub mod oracle;
pub mod partition;
pub mod reference;
pub mod seeds;
pub mod statistics;
pub mod tolerance;
