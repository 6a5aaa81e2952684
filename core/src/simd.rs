//! The processor: vectors of numbers, the functions of one lane, the back ends, and the choice among
//! them.
//!
//! Nothing here knows of lobes. A kernel is a text over [`lanes::Lanes`], wrapped as a [`routine::Routine`];
//! a [`detect::Level`] runs it ([`dispatch`]) in the instruction set of one back end: `scalar`, `portable`,
//! `avx2` (with `fused` for a number alone), `avx512`.
//! May import: `error`.

#[cfg(all(feature = "simd", target_arch = "x86_64"))]
mod avx2;
#[cfg(all(feature = "simd", target_arch = "x86_64"))]
mod avx512;
pub(crate) mod detect;
mod dispatch;
pub(crate) mod elementary;
pub(crate) mod error_free;
#[cfg(all(feature = "simd", target_arch = "x86_64"))]
mod fused;
#[cfg(feature = "simd")]
mod lane_pair;
pub(crate) mod lanes;
#[cfg(feature = "simd")]
mod portable;
pub(crate) mod processor;
pub(crate) mod routine;
pub(crate) mod scalar;
#[cfg(all(target_arch = "x86_64", target_feature = "sse2"))]
mod sse2;

/// Asks for what will be read soon, so that waiting for memory and working go side by side.
#[inline(always)]
pub(crate) fn prefetch<T>(place: &T) {
    #[cfg(all(target_arch = "x86_64", target_feature = "sse2"))]
    sse2::prefetch(place);
    #[cfg(not(all(target_arch = "x86_64", target_feature = "sse2")))]
    let _ = place;
}
