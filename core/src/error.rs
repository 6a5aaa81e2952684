//! Errors, as plain values.

use core::fmt;

/// Why a lobe, a mixture or a prepared material was refused.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// The axis is not a finite vector of length 1 within 1e-3.
    Axis,
    /// The sharpness is NaN, negative, or above [`MAX_SHARPNESS`](crate::MAX_SHARPNESS).
    Sharpness,
    /// An amplitude is NaN or infinite, its luminance negative or a channel more than 32 times that; or an
    /// integral is infinite; or the mixture has no room for a diffuse term.
    Amplitude,
    /// The squeeze is NaN or outside [0.01, 2].
    Squeeze,
    /// The operation has no closed form for squeezed lobes, nor for a diffuse term, nor for factors.
    Squeezed,
    /// A parameter of a kernel is out of its range.
    Kernel,
    /// A share is NaN or outside [0, 1].
    Share,
    /// The mixture has room for fewer lobes than are needed.
    Capacity {
        /// Lobes that were to be stored.
        needed: usize,
        /// Lobes that the storage holds.
        available: usize,
    },
    /// An expanded material has at least 2 rows and at most
    /// [`MAX_ROWS`](crate::Expanded::MAX_ROWS).
    Rows,
    /// There is less memory than an expanded material or an environment takes, counted in numbers of four
    /// bytes.
    Memory {
        /// The number that is needed.
        needed: usize,
        /// What there is.
        available: usize,
    },
    /// The operation is for isotropic materials alone.
    Anisotropic,
    /// The direction is not a finite vector of length 1 within 1e-3.
    Direction,
    /// The slices of a batch are not all of one length.
    Length,
    /// This processor or this build lacks the instruction set.
    Level,
    /// A map has width and height from 1 to 65535, at most 2^25 pixels, and that many values.
    MapSize,
    /// A value of a map is NaN, negative, or above 1e30.
    Radiance {
        /// Its pixel, from the left.
        column: usize,
        /// From the top.
        row: usize,
    },
    /// A map is black all over: there is nothing to draw.
    BlackMap,
    /// The words are no table of an environment, or damaged.
    Table,
    /// The number of candidates is outside 2 to 32.
    Candidates,
    /// The weight of the path's own ray is NaN or below 1e-3.
    Kappa,
    /// A blend has 1 to [`MAX_BLEND`](crate::MAX_BLEND) parts.
    Parts,
    /// A weight or a tint of a blend is NaN or outside [0, 1000], no weight is above 0, or the index of a coat is outside [1, 10].
    Weight,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Axis => f.write_str("the axis of a lobe must be a finite unit vector"),
            Self::Sharpness => f.write_str("the sharpness of a lobe must be within [0, 1e8]"),
            Self::Amplitude => f.write_str(
                "an amplitude and its integrals must be finite, its luminance not negative, \
                 and no channel beyond 32 times that",
            ),
            Self::Squeeze => f.write_str("a squeeze must be within [0.01, 2]"),
            Self::Squeezed => {
                f.write_str("squeezed lobes, diffuse terms and factors have no product in closed form")
            }
            Self::Kernel => f.write_str("a parameter of the kernel is out of range"),
            Self::Share => f.write_str("a share must be within [0, 1]"),
            Self::Capacity { needed, available } => {
                write!(f, "the mixture has room for {available} lobes, {needed} are needed")
            }
            Self::Rows => f.write_str("an expanded material must have 2 to 16384 rows"),
            Self::Memory { needed, available } => {
                write!(f, "{needed} numbers are to be stored, there is memory for {available}")
            }
            Self::Anisotropic => f.write_str("the material must be isotropic"),
            Self::Length => f.write_str("the slices of a batch must all have one length"),
            Self::Level => f.write_str("this processor or this build lacks the instruction set"),
            Self::MapSize => {
                f.write_str("a map must have 1 to 65535 columns and rows, all full, and at most 2^25 pixels")
            }
            Self::Radiance { column, row } => {
                write!(f, "the pixel in column {column}, row {row} must have values within [0, 1e30]")
            }
            Self::BlackMap => f.write_str("the map is black all over"),
            Self::Table => f.write_str("this is no sound table of an environment"),
            Self::Candidates => f.write_str("the number of candidates must be within [2, 32]"),
            Self::Kappa => f.write_str("kappa must be at least 1e-3, or infinite"),
            Self::Parts => f.write_str("a blend must have 1 to 8 parts"),
            Self::Weight => f.write_str(
                "weights and tints must be within [0, 1000], one weight above 0, the index of a coat within [1, 10]",
            ),
            Self::Direction => f.write_str("a direction must be a finite unit vector"),
        }
    }
}

impl core::error::Error for Error {}
