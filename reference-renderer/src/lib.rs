//! The rooms of the program `srbf`, for the program itself and for the project's laboratory (`lab/`).
//!
//! This library is no interface for others: nothing of it is promised from one version to the next.

// First, so that its macros take the place of the standard library's in all that follows.
#[doc(hidden)]
#[macro_use]
pub mod out;

#[doc(hidden)]
pub mod command;
#[doc(hidden)]
pub mod numbers;
#[doc(hidden)]
pub mod shade;
#[doc(hidden)]
pub mod show;
#[doc(hidden)]
pub mod study;
#[doc(hidden)]
pub mod trace;
#[doc(hidden)]
pub mod truth;
#[doc(hidden)]
pub mod world;
