//! Measured and analytic BRDFs: reads, looks at, completes, tabulates and writes them. It knows nothing of lobes that are fitted.
//!
//! [`read::read`] takes a file of any known format. [`look::Look`] lists the faults of its samples. [`complete::complete`] turns samples
//! into a BRDF with a value at every pair of directions. A [`table::Table`] has the samples of each view, to which `srbf-fit` fits lobes.
//!
//! Hidden modules and functions are shared with `srbf-fit`. They are no interface for others.

pub mod analytic;
pub mod complete;
mod error;
pub mod export;
#[doc(hidden)]
pub mod file;
mod isotropy;
pub mod look;
#[doc(hidden)]
pub mod numeric;
pub mod patches;
pub mod read;
mod reciprocity;
mod row;
pub mod table;
mod threads;
mod write;

#[doc(hidden)]
pub use error::with_reasons;
pub use error::{FitError, ReadError};
pub use read::{check_memory, read_at_most, read_if};
pub use threads::in_threads;
pub use write::{Outputs, check_output, write_atomically};
