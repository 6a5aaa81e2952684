//! Runs a text in the instruction set of a level.
//!
//! The functions that do so stand with their back end: the compiler makes the machine code of several modules
//! side by side, that of one module on one core.

#[cfg(feature = "simd")]
use super::detect::HAS_SCALAR;
use super::detect::Level;
#[cfg(feature = "simd")]
use super::portable;
use super::routine::{Draw, One, Routine};
use super::scalar;
#[cfg(all(feature = "simd", target_arch = "x86_64"))]
use super::{avx2, avx512};

impl Level {
    /// Runs a routine in the instruction set of this level.
    #[inline]
    #[allow(unsafe_code)]
    pub(crate) fn run<R: Routine>(self, routine: R) -> R::Output {
        match self {
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            // SAFETY: a mixture's level, and a level passed here, came from `Level::current` or passed `is_available`.
            Self::Avx512 => unsafe { avx512::run(routine) },
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            // SAFETY: as above.
            Self::Avx2 => unsafe { avx2::run(routine) },
            #[cfg(feature = "simd")]
            level if level == Self::Portable || !HAS_SCALAR => portable::run(routine),
            _ => scalar::run(routine),
        }
    }

    /// The same where there are vectors: no text is compiled of one number at a time, if the build has others.
    #[inline]
    #[allow(unsafe_code)]
    pub(crate) fn run_vectors<R: Routine>(self, routine: R) -> R::Output {
        match self {
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            // SAFETY: as above.
            Self::Avx512 => unsafe { avx512::run(routine) },
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            // SAFETY: as above.
            Self::Avx2 => unsafe { avx2::run(routine) },
            #[cfg(feature = "simd")]
            _ => portable::run(routine),
            #[cfg(not(feature = "simd"))]
            _ => scalar::run(routine),
        }
    }

    /// Runs the text of a special case. A level without fused operations has none, and gives it back: the general
    /// text is to run.
    #[inline]
    #[allow(unsafe_code)]
    pub(crate) fn run_special<R: Routine>(self, routine: R) -> Result<R::Output, R> {
        match self {
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            // SAFETY: as above.
            Self::Avx512 => Ok(unsafe { avx512::run(routine) }),
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            // SAFETY: as above.
            Self::Avx2 => Ok(unsafe { avx2::run(routine) }),
            #[cfg(all(feature = "simd", not(target_arch = "x86_64")))]
            Self::Portable if <portable::Wide as super::lanes::Lanes>::FUSED => Ok(portable::run(routine)),
            _ => Err(routine),
        }
    }

    /// Runs a routine for one direction in the instruction set of this level.
    #[inline]
    #[allow(unsafe_code)]
    pub(crate) fn run_one<S, R: One<S>>(self, state: S, [a, b, c]: [f32; 3]) -> R::Output {
        match self {
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            // SAFETY: a mixture's level, and a level passed here, came from `Level::current` or passed `is_available`.
            Self::Avx512 if R::IS_WIDE => unsafe { avx512::one::<S, R>(state, a, b, c) },
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            // SAFETY: as above; who has AVX-512 has AVX2.
            Self::Avx2 | Self::Avx512 => unsafe { avx2::one::<S, R>(state, a, b, c) },
            #[cfg(feature = "simd")]
            level if level == Self::Portable || !HAS_SCALAR => portable::one::<S, R>(state, a, b, c),
            _ => scalar::one::<S, R>(state, a, b, c),
        }
    }

    /// Draws a direction, and runs a routine for it, in the instruction set of this level. The routine does
    /// not wait for the last step to the direction's length of 1.
    #[inline]
    #[allow(unsafe_code)]
    pub(crate) fn draw_one<S: Copy, D: Draw<S>, R: One<S>>(
        self,
        state: S,
        [a, b, c]: [f32; 3],
    ) -> ([f32; 3], R::Output) {
        match self {
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            // SAFETY: a mixture's level, and a level passed here, came from `Level::current` or passed `is_available`.
            Self::Avx512 => unsafe { avx512::draw::<S, D, R>(state, a, b, c) },
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            // SAFETY: as above.
            Self::Avx2 => unsafe { avx2::draw::<S, D, R>(state, a, b, c) },
            #[cfg(feature = "simd")]
            level if level == Self::Portable || !HAS_SCALAR => portable::draw::<S, D, R>(state, a, b, c),
            _ => scalar::draw::<S, D, R>(state, a, b, c),
        }
    }
}
