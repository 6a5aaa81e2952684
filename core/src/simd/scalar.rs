//! The scalar back end: one f32 at a time, as `libm` and the language have it.

use super::{Draw, One, Routine};
use crate::lanes::scale;

/// Runs a routine.
#[inline(never)]
pub(super) fn run<R: Routine>(routine: R) -> R::Output {
    routine.run::<f32>()
}

/// Runs a routine for one direction.
#[inline(never)]
pub(super) fn one<S, R: One<S>>(state: &S, a: f32, b: f32, c: f32) -> R::Output {
    R::run::<f32>(state, [a, b, c])
}

/// Draws a direction and runs a routine for it, which is a call of its own: in one function, both have too few registers.
#[inline(never)]
pub(super) fn draw<S, D: Draw<S>, R: One<S>>(state: &S, a: f32, b: f32, c: f32) -> ([f32; 3], R::Output) {
    let (d, inverse) = D::run::<f32>(state, [a, b, c]);
    let then = one::<S, R>(state, d[0], d[1], d[2]);
    (scale(d, inverse), then)
}
