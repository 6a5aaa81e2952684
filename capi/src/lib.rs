//! The C interface: translates, computes nothing.
//!
//! `include/srbf.h` is generated from these files. The pointer mechanics stand in `pointers`, `streams` and `storage`,
//! the panic mechanics in `guard`; every exported function is a guard round a few lines of translation.
#![no_std]
#![allow(non_camel_case_types, reason = "the same identifier in Rust and in C")]
#![allow(
    clippy::missing_safety_doc,
    reason = "the contract for pointers stands once, at the top of include/srbf.h"
)]

#[cfg(feature = "std")]
extern crate std;

mod arguments;
mod arrays;
mod ask;
mod blend;
mod convert;
mod defensive;
mod environment;
mod expanded;
mod factors;
#[cfg(feature = "fit")]
mod fit;
mod guard;
#[cfg(feature = "std")]
mod heap;
mod hit;
mod layout;
mod light;
mod lobe;
mod material;
#[cfg(feature = "std")]
mod message;
mod mixture;
mod mixtures;
#[cfg(feature = "planted-panic")]
mod planted;
mod pointers;
mod product;
mod reflect;
mod request;
mod sheet;
mod simd;
mod single;
mod spectrum;
mod status;
mod storage;
mod streams;
mod version;

pub use ask::*;
pub use blend::*;
pub use defensive::*;
pub use environment::*;
pub use expanded::*;
pub use factors::*;
#[cfg(feature = "fit")]
pub use fit::*;
#[cfg(feature = "std")]
pub use heap::{srbf_material_free, srbf_material_from_bytes, srbf_material_load};
pub use hit::*;
pub use light::*;
pub use lobe::*;
pub use material::*;
#[cfg(feature = "std")]
pub use message::srbf_last_message;
pub use mixture::*;
#[cfg(feature = "planted-panic")]
pub use planted::srbf_status_panic;
pub use product::*;
pub use reflect::*;
pub use request::*;
pub use sheet::*;
pub use simd::*;
pub use single::*;
pub use spectrum::*;
pub use status::*;
pub use storage::{
    SRBF_MIXTURE_ALIGNMENT, SRBF_MIXTURE_SIZE_16, SRBF_MIXTURE_SIZE_32, SRBF_MIXTURE_SIZE_64, srbf_mixture,
};
pub use streams::{srbf_numbers_out, srbf_samples_out, srbf_vectors, srbf_vectors_out};
pub use version::*;
