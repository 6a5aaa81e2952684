//! Back ends of the kernels and the choice among them.
//!
//! The functions that run a text in an instruction set stand with its back end: the compiler makes the machine code of several
//! modules side by side, that of one module on one core.

#[cfg(all(feature = "simd", target_arch = "x86_64"))]
mod avx2;
#[cfg(all(feature = "simd", target_arch = "x86_64"))]
mod avx512;
mod detect;
#[cfg(all(feature = "simd", target_arch = "x86_64"))]
mod fused;
#[cfg(feature = "simd")]
mod portable;
mod scalar;
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
            Self::Avx512 => unsafe { avx512::run(routine) },
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            // SAFETY: as above.
            Self::Avx2 => unsafe { avx2::run(routine) },
            #[cfg(feature = "simd")]
            Self::Portable => portable::run(routine),
            _ => scalar::run(routine),
        }
    }

    /// Runs a routine for one direction in the instruction set of this level.
    #[inline]
    #[allow(unsafe_code)]
    pub(crate) fn run_one<S, R: One<S>>(self, state: &S, [a, b, c]: [f32; 3]) -> R::Output {
        match self {
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            // SAFETY: a mixture's level, and what is passed here, is what `Level::current` gave or `is_available` allowed.
            Self::Avx512 if R::IS_WIDE => unsafe { avx512::one::<S, R>(state, a, b, c) },
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            // SAFETY: as above; who has AVX-512 has AVX2.
            Self::Avx2 | Self::Avx512 => unsafe { avx2::one::<S, R>(state, a, b, c) },
            #[cfg(feature = "simd")]
            Self::Portable => portable::one::<S, R>(state, a, b, c),
            _ => scalar::one::<S, R>(state, a, b, c),
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
            Self::Avx512 => unsafe { avx512::draw::<S, D, R>(state, a, b, c) },
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            // SAFETY: as above.
            Self::Avx2 => unsafe { avx2::draw::<S, D, R>(state, a, b, c) },
            #[cfg(feature = "simd")]
            Self::Portable => portable::draw::<S, D, R>(state, a, b, c),
            _ => scalar::draw::<S, D, R>(state, a, b, c),
        }
    }
}

/// The functions of a back end that run a text in its instruction set, which is `$attribute`. A back end that draws in another way
/// leaves out `draw`.
macro_rules! entries {
    ($lanes:ty, #[$($attribute:tt)*]) => {
        $crate::simd::entries!($lanes, #[$($attribute)*] without draw);

        /// Draws a direction and runs a routine for it, which is a call of its own: in one function, both have too few registers.
        #[$($attribute)*]
        pub(super) fn draw<S, D: super::Draw<S>, R: super::One<S>>(
            state: &S,
            a: f32,
            b: f32,
            c: f32,
        ) -> ([f32; 3], R::Output) {
            let (d, inverse) = D::run::<$lanes>(state, [a, b, c]);
            let then = one::<S, R>(state, d[0], d[1], d[2]);
            ($crate::lanes::scale(d, inverse), then)
        }
    };
    ($lanes:ty, #[$($attribute:tt)*] without draw) => {
        /// Runs a routine.
        #[$($attribute)*]
        pub(super) fn run<R: super::Routine>(routine: R) -> R::Output {
            routine.run::<$lanes>()
        }

        /// Runs a routine for one direction.
        #[$($attribute)*]
        pub(super) fn one<S, R: super::One<S>>(state: &S, a: f32, b: f32, c: f32) -> R::Output {
            R::run::<$lanes>(state, [a, b, c])
        }
    };
}
use entries;
