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

use crate::lanes::{Lanes, scale};
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

/// Text that draws a direction from three uniform numbers.
pub(crate) trait Draw<State> {
    /// The direction, and what it is to be multiplied by to be of length 1, which it is but for rounding. The text; as in
    /// [`Routine`].
    fn run<L: Lanes>(state: &State, numbers: [f32; 3]) -> ([f32; 3], f32);
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

    /// Draws a direction, and runs a routine for it, in the instruction set of this level. The routine does not wait for the last step
    /// to the direction's length of 1.
    #[inline]
    #[allow(unsafe_code)]
    pub(crate) fn draw_one<S, D: Draw<S>, R: One<S>>(
        self,
        state: &S,
        [a, b, c]: [f32; 3],
    ) -> ([f32; 3], R::Output) {
        match self {
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            // SAFETY: a mixture's level, and what is passed here, is what `Level::current` gave or `is_available` allowed.
            Self::Avx512 => unsafe { draw_avx512::<S, D, R>(state, a, b, c) },
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            // SAFETY: as above.
            Self::Avx2 => unsafe { draw_avx2::<S, D, R>(state, a, b, c) },
            #[cfg(feature = "simd")]
            Self::Portable => draw_portable::<S, D, R>(state, a, b, c),
            _ => draw_scalar::<S, D, R>(state, a, b, c),
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

// The routine is a call of its own: in one function, both have too few registers.

/// Draws without vectors of 512 bits, as [`One::IS_WIDE`] says why.
#[cfg(all(feature = "simd", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma,popcnt,bmi1,bmi2")]
#[allow(unsafe_code)]
fn draw_avx512<S, D: Draw<S>, R: One<S>>(state: &S, a: f32, b: f32, c: f32) -> ([f32; 3], R::Output) {
    let (d, inverse) = D::run::<avx2::Avx2>(state, [a, b, c]);
    // SAFETY: `Level::draw_one` comes here for a level that has it.
    let then = unsafe { one_avx512::<S, R>(state, d[0], d[1], d[2]) };
    (scale(d, inverse), then)
}

#[cfg(all(feature = "simd", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma,popcnt,bmi1,bmi2")]
fn draw_avx2<S, D: Draw<S>, R: One<S>>(state: &S, a: f32, b: f32, c: f32) -> ([f32; 3], R::Output) {
    let (d, inverse) = D::run::<avx2::Avx2>(state, [a, b, c]);
    let then = one_avx2::<S, R>(state, d[0], d[1], d[2]);
    (scale(d, inverse), then)
}

#[cfg(feature = "simd")]
#[inline(never)]
fn draw_portable<S, D: Draw<S>, R: One<S>>(state: &S, a: f32, b: f32, c: f32) -> ([f32; 3], R::Output) {
    let (d, inverse) = D::run::<portable::Wide>(state, [a, b, c]);
    let then = one_portable::<S, R>(state, d[0], d[1], d[2]);
    (scale(d, inverse), then)
}

#[inline(never)]
fn draw_scalar<S, D: Draw<S>, R: One<S>>(state: &S, a: f32, b: f32, c: f32) -> ([f32; 3], R::Output) {
    let (d, inverse) = D::run::<f32>(state, [a, b, c]);
    let then = one_scalar::<S, R>(state, d[0], d[1], d[2]);
    (scale(d, inverse), then)
}
