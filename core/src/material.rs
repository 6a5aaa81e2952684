//! A material as bytes: where everything stands in a `.srbf` file ([`layout`]), the input of its writer
//! ([`views`], [`factor_table`]), writing, checking, and reading in place ([`borrowed`]).
//!
//! Nothing here computes a mixture; `kernel/prepare.rs` does.
//! May import: `color`, `simd`.

pub(crate) mod borrowed;
pub(crate) mod bytes;
pub(crate) mod checksum;
pub(crate) mod codes;
pub(crate) mod encode;
pub(crate) mod factor_table;
#[cfg(feature = "std")]
pub(crate) mod file;
pub(crate) mod format_error;
pub(crate) mod layout;
pub(crate) mod pack;
mod spectra;
pub(crate) mod spectral_map;
pub(crate) mod validate;
pub(crate) mod views;
