//! Back ends of the kernels and the choice among them.

#[cfg(all(feature = "simd", target_arch = "x86_64"))]
mod avx2;
#[cfg(all(feature = "simd", target_arch = "x86_64"))]
mod avx512;
mod detect;
#[cfg(feature = "simd")]
mod portable;

use crate::lanes::Lanes;
pub use detect::Level;

/// A kernel: text that can run at any level.
pub(crate) trait Kernel {
    /// What it gives.
    type Output;
    /// The text; must be `#[inline(always)]`, and so must all that it calls with vectors.
    fn run<L: Lanes>(self) -> Self::Output;
}

impl Level {
    /// Runs a kernel in the instruction set of this level.
    #[inline]
    #[allow(unsafe_code)]
    pub(crate) fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self {
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            // SAFETY: a level above Portable exists only where the processor has been seen to have it.
            Self::Avx512 => unsafe { run_avx512(kernel) },
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            // SAFETY: as above.
            Self::Avx2 => unsafe { run_avx2(kernel) },
            #[cfg(feature = "simd")]
            Self::Portable => run_portable(kernel),
            _ => run_scalar(kernel),
        }
    }
}

#[cfg(all(feature = "simd", target_arch = "x86_64"))]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,fma,avx2")]
fn run_avx512<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<avx512::Avx512>()
}

#[cfg(all(feature = "simd", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma")]
fn run_avx2<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<avx2::Avx2>()
}

#[cfg(feature = "simd")]
#[inline(never)]
fn run_portable<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<portable::Wide>()
}

#[inline(never)]
fn run_scalar<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<f32>()
}
