//! f64, in which files are read for fits, and f32, in which they are drawn from: one text for both.

use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, Neg, Sub};

/// A number.
pub(super) trait Real:
    Copy
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + DivAssign
    + Sum
{
    /// Above it, a quotient by a cosine does not overflow.
    const LEAST_COSINE: Self;

    /// The nearest number.
    fn of(v: f64) -> Self;
    /// The whole number below one that is not negative.
    fn index(self) -> usize;
    fn sqrt(self) -> Self;
    fn floor(self) -> Self;
    fn hypot(self, other: Self) -> Self;
    fn atan2(self, x: Self) -> Self;

    /// The larger of two; a NaN is left out.
    fn most(self, other: Self) -> Self {
        if self >= other { self } else { other }
    }
    fn least(self, other: Self) -> Self {
        if self <= other { self } else { other }
    }
    /// Within 0 to 1.
    fn within_one(self) -> Self {
        self.most(Self::of(0.0)).least(Self::of(1.0))
    }
}

impl Real for f64 {
    const LEAST_COSINE: Self = f64::MIN_POSITIVE;

    fn of(v: f64) -> Self {
        v
    }
    fn index(self) -> usize {
        self as usize
    }
    fn sqrt(self) -> Self {
        libm::sqrt(self)
    }
    fn floor(self) -> Self {
        libm::floor(self)
    }
    fn hypot(self, other: Self) -> Self {
        libm::hypot(self, other)
    }
    fn atan2(self, x: Self) -> Self {
        libm::atan2(self, x)
    }
}

impl Real for f32 {
    const LEAST_COSINE: Self = f32::MIN_POSITIVE;

    fn of(v: f64) -> Self {
        v as f32
    }
    fn index(self) -> usize {
        self as usize
    }
    fn sqrt(self) -> Self {
        f32::sqrt(self)
    }
    fn floor(self) -> Self {
        f32::floor(self)
    }
    fn hypot(self, other: Self) -> Self {
        // Components of unit vectors: no square overflows.
        f32::sqrt(self * self + other * other)
    }
    fn atan2(self, x: Self) -> Self {
        f32::atan2(self, x)
    }
}
