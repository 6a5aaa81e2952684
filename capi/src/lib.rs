//! The C interface: translates, computes nothing.
//!
//! `include/srbf.h` is generated from these files. The pointer mechanics stand in `pointers`, the panic mechanics in
//! `guard`; every exported function is a guard round a few lines of translation.
#![no_std]
#![allow(non_camel_case_types, reason = "the same identifier in Rust and in C")]
#![allow(
    clippy::missing_safety_doc,
    reason = "the contract for pointers stands once, at the top of include/srbf.h"
)]

#[cfg(feature = "std")]
extern crate std;

mod guard;
#[cfg(feature = "std")]
mod message;
mod status;
mod version;

pub use status::*;
pub use version::*;
