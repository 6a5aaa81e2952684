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
pub(crate) mod tables;
#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
mod vfp;

/// Whether a choice that is a parameter of a text, compiled once for each value, is a branch in one text: small processors have
/// little room for code, and no vectors that would wait for a branch. The digits are the same.
pub(crate) const ONE_TEXT: bool = !cfg!(feature = "simd");

/// Bytes that a processor fetches from memory at a time.
#[cfg(feature = "simd")]
const CACHE_LINE: usize = 64;

/// Asks for what will be read soon, so that waiting for memory and working go side by side.
#[cfg(any(feature = "environment", feature = "simd"))]
#[inline(always)]
pub(crate) fn prefetch<T>(place: &T) {
    #[cfg(all(target_arch = "x86_64", target_feature = "sse2"))]
    sse2::prefetch(core::ptr::from_ref(place).cast());
    #[cfg(not(all(target_arch = "x86_64", target_feature = "sse2")))]
    let _ = place;
}

/// The same for a number of cache lines of bytes from an offset on, which need not be within them.
#[cfg(feature = "simd")]
#[inline(always)]
pub(crate) fn prefetch_lines<const LINES: usize>(bytes: &[u8], from: usize) {
    for line in 0..LINES {
        let _place = bytes.as_ptr().wrapping_add(from + CACHE_LINE * line);
        #[cfg(all(target_arch = "x86_64", target_feature = "sse2"))]
        sse2::prefetch(_place.cast());
    }
}
