//! Texts that run at any level, as types: the work that a back end is given, and the functions by which it runs it.

use super::lanes::Lanes;

/// Text that can run at any level.
pub(crate) trait Routine {
    /// Its result.
    type Output;
    /// The text; must be `#[inline(always)]`, and so must all that it calls with vectors.
    fn run<L: Lanes>(self) -> Self::Output;
}

/// Text for one direction (or three numbers): its numbers travel in registers, where a struct would go
/// through memory.
pub(crate) trait One<State> {
    /// Its result.
    type Output;
    /// Whether it gains by vectors of 512 bits: while those are at work, an Intel core has one port less for
    /// numbers alone.
    #[cfg_attr(not(all(feature = "simd", target_arch = "x86_64")), allow(dead_code))]
    const IS_WIDE: bool;
    /// The text; as in [`Routine`].
    fn run<L: Lanes>(state: State, numbers: [f32; 3]) -> Self::Output;
}

/// Text that draws a direction from three uniform numbers.
pub(crate) trait Draw<State> {
    /// The direction, and the factor that makes its length 1, which it is but for rounding. The
    /// text; as in [`Routine`].
    fn run<L: Lanes>(state: State, numbers: [f32; 3]) -> ([f32; 3], f32);
}

/// The functions of a back end that run a text in its instruction set, which is `$attribute`. A back end that
/// draws in another way leaves out `draw`. None is inlined, so that a program has each text once, whatever
/// crates it is called from.
macro_rules! entries {
    ($lanes:ident $(, #[$attribute:meta])?) => {
        $crate::simd::routine::entries!($lanes $(, #[$attribute])? without draw);

        /// Draws a direction and runs a routine for it, which is a call of its own: in one function, both
        /// have too few registers.
        #[inline(never)]
        $(#[$attribute])?
        pub(super) fn draw<S: Copy, D: $crate::simd::routine::Draw<S>, R: $crate::simd::routine::One<S>>(
            state: S,
            a: f32,
            b: f32,
            c: f32,
        ) -> ([f32; 3], R::Output) {
            let (d, inverse) = D::run::<$lanes>(state, [a, b, c]);
            let then = one::<S, R>(state, d[0], d[1], d[2]);
            ($crate::simd::lanes::scale(d, inverse), then)
        }
    };
    ($lanes:ident $(, #[$attribute:meta])? without draw) => {
        /// Runs a routine.
        #[inline(never)]
        $(#[$attribute])?
        pub(super) fn run<R: $crate::simd::routine::Routine>(routine: R) -> R::Output {
            routine.run::<$lanes>()
        }

        /// Runs a routine for one direction.
        #[inline(never)]
        $(#[$attribute])?
        pub(super) fn one<S, R: $crate::simd::routine::One<S>>(state: S, a: f32, b: f32, c: f32) -> R::Output {
            R::run::<$lanes>(state, [a, b, c])
        }
    };
}

pub(super) use entries;
