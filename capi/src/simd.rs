//! The SIMD level: which instruction set the kernels run in.
#![allow(unsafe_code)]

use crate::guard::guard;
use crate::status::{SRBF_STATUS_SIMD_LEVEL, srbf_status};
use srbf_core::Level;

/// The best level of this processor and build.
pub const SRBF_SIMD_AUTOMATIC: u32 = 0;
/// One number at a time: the reference for every other level.
pub const SRBF_SIMD_SCALAR: u32 = 1;
/// SSE2, NEON, or the instructions that the whole library was compiled for.
pub const SRBF_SIMD_PORTABLE: u32 = 2;
/// x86-64 with AVX2 and FMA.
pub const SRBF_SIMD_AVX2: u32 = 3;
/// x86-64 with AVX-512 F, VL, DQ and BW.
pub const SRBF_SIMD_AVX512: u32 = 4;

const _: () = assert!(
    Level::Scalar as u32 == SRBF_SIMD_SCALAR
        && Level::Portable as u32 == SRBF_SIMD_PORTABLE
        && Level::Avx2 as u32 == SRBF_SIMD_AVX2
        && Level::Avx512 as u32 == SRBF_SIMD_AVX512
);

/// Returns the level that mixtures prepared from now on use: `SRBF_SIMD_SCALAR` to `SRBF_SIMD_AVX512`.
#[unsafe(no_mangle)]
pub extern "C" fn srbf_simd_level() -> u32 {
    Level::current() as u32
}

/// Chooses the level of every mixture prepared from now on, in all threads; for tests and comparisons.
///
/// A mixture keeps the level that it was prepared at. `SRBF_SIMD_AUTOMATIC` goes back to the best.
/// Status: `SRBF_STATUS_SIMD_LEVEL` if the processor or the build lacks the level; nothing changes then.
#[unsafe(no_mangle)]
pub extern "C" fn srbf_simd_set_level(level: u32) -> srbf_status {
    guard(|| {
        let mut levels = Level::ALL.into_iter();
        let wanted = match level {
            SRBF_SIMD_AUTOMATIC => levels.rfind(|level| level.is_available()),
            _ => levels.find(|&known| known as u32 == level),
        };
        wanted.ok_or(SRBF_STATUS_SIMD_LEVEL)?.set()?;
        Ok(())
    })
}
