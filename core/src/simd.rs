//! Back ends of the kernels and the choice among them.

#[cfg(all(feature = "simd", target_arch = "x86_64"))]
mod avx2;
#[cfg(all(feature = "simd", target_arch = "x86_64"))]
mod avx512;
mod detect;
#[cfg(all(feature = "simd", target_arch = "x86_64"))]
mod fused;
#[cfg(feature = "simd")]
mod portable;
#[cfg(all(target_arch = "x86_64", target_feature = "sse2"))]
pub(crate) mod sse2;

use crate::lanes::Lanes;
pub use detect::Level;

/// Text that can run at any level.
pub(crate) trait Routine {
    /// What it gives.
    type Output;
    /// The text; must be `#[inline(always)]`, and so must all that it calls with vectors.
    fn run<L: Lanes>(self) -> Self::Output;
}

/// Text for one direction (or three numbers): its numbers travel in registers, where a struct would go through memory.
pub(crate) trait One<State> {
    /// What it gives.
    type Output;
    /// Whether it gains by vectors of 512 bits: while those are at work, an Intel core has one port less for numbers alone.
    #[cfg_attr(not(all(feature = "simd", target_arch = "x86_64")), allow(dead_code))]
    const IS_WIDE: bool;
    /// The text; as in [`Routine`].
    fn run<L: Lanes>(state: &State, numbers: [f32; 3]) -> Self::Output;
}

impl Level {
    /// Runs a routine in the instruction set of this level.
    #[inline]
    #[allow(unsafe_code)]
    pub(crate) fn run<R: Routine>(self, routine: R) -> R::Output {
        match self {
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            // SAFETY: a mixture's level, and what is passed here, is what `Level::current` gave or `is_available` allowed.
            Self::Avx512 => unsafe { run_avx512(routine) },
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            // SAFETY: as above.
            Self::Avx2 => unsafe { run_avx2(routine) },
            #[cfg(feature = "simd")]
            Self::Portable => run_portable(routine),
            _ => run_scalar(routine),
        }
    }

    /// Runs a routine for one direction in the instruction set of this level.
    #[inline]
    #[allow(unsafe_code)]
    pub(crate) fn run_one<S, R: One<S>>(self, state: &S, [a, b, c]: [f32; 3]) -> R::Output {
        match self {
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            // SAFETY: a mixture's level, and what is passed here, is what `Level::current` gave or `is_available` allowed.
            Self::Avx512 if R::IS_WIDE => unsafe { one_avx512::<S, R>(state, a, b, c) },
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            // SAFETY: as above; who has AVX-512 has AVX2.
            Self::Avx2 | Self::Avx512 => unsafe { one_avx2::<S, R>(state, a, b, c) },
            #[cfg(feature = "simd")]
            Self::Portable => one_portable::<S, R>(state, a, b, c),
            _ => one_scalar::<S, R>(state, a, b, c),
        }
    }
}

#[cfg(all(feature = "simd", target_arch = "x86_64"))]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,fma,avx2,popcnt,bmi1,bmi2")]
fn run_avx512<R: Routine>(routine: R) -> R::Output {
    routine.run::<avx512::Avx512>()
}

#[cfg(all(feature = "simd", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma,popcnt,bmi1,bmi2")]
fn run_avx2<R: Routine>(routine: R) -> R::Output {
    routine.run::<avx2::Avx2>()
}

#[cfg(feature = "simd")]
#[inline(never)]
fn run_portable<R: Routine>(routine: R) -> R::Output {
    routine.run::<portable::Wide>()
}

#[inline(never)]
fn run_scalar<R: Routine>(routine: R) -> R::Output {
    routine.run::<f32>()
}

#[cfg(all(feature = "simd", target_arch = "x86_64"))]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,fma,avx2,popcnt,bmi1,bmi2")]
fn one_avx512<S, R: One<S>>(state: &S, a: f32, b: f32, c: f32) -> R::Output {
    R::run::<avx512::Avx512>(state, [a, b, c])
}

#[cfg(all(feature = "simd", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma,popcnt,bmi1,bmi2")]
fn one_avx2<S, R: One<S>>(state: &S, a: f32, b: f32, c: f32) -> R::Output {
    R::run::<avx2::Avx2>(state, [a, b, c])
}

#[cfg(feature = "simd")]
#[inline(never)]
fn one_portable<S, R: One<S>>(state: &S, a: f32, b: f32, c: f32) -> R::Output {
    R::run::<portable::Wide>(state, [a, b, c])
}

#[inline(never)]
fn one_scalar<S, R: One<S>>(state: &S, a: f32, b: f32, c: f32) -> R::Output {
    R::run::<f32>(state, [a, b, c])
}
