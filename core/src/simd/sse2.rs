//! SSE2, which every x86-64 processor has: the operations that a scalar inside an AVX function needs.
#![allow(unsafe_code)]

#[cfg(any(feature = "environment", feature = "simd"))]
use core::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
use core::arch::x86_64::{_mm_cvtss_f32, _mm_set_ss, _mm_sqrt_ss};

/// Square root, correctly rounded, in the encoding of the function that it is inlined into.
///
/// libm's is assembly in the encoding of SSE, which stalls between AVX instructions.
#[inline(always)]
pub(crate) fn sqrt(x: f32) -> f32 {
    // SAFETY: this file is compiled only where the whole build targets SSE2.
    unsafe { _mm_cvtss_f32(_mm_sqrt_ss(_mm_set_ss(x))) }
}

/// Asks for the cache line at a place, which may be any.
#[cfg(any(feature = "environment", feature = "simd"))]
#[inline(always)]
pub(crate) fn prefetch(place: *const i8) {
    // SAFETY: this file is compiled only where the whole build targets SSE2; nothing is read that a program could see.
    unsafe { _mm_prefetch::<_MM_HINT_T0>(place) }
}
