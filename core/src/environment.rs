//! Light from infinitely far away or of any kind, and light and material sampled together.
//!
//! A [`table`] holds a map of radiance and what draws from it, in memory of the caller; [`make`] makes one,
//! [`read`] checks one that was stored. [`look_up`] finds the radiance of a direction, [`draw`] draws one;
//! [`cell`] says how draws are shared out. Any other [`light`] draws and tells its density by code of the caller.
//! A [`product`] draws from the light and a mixture together, among [`candidates`], as a [`sampling`] says. [`reflect`] sums what both would bring [`together`], over a
//! [`light_block`] that serves many surfaces, and corrects the sums by two rays. Both work on [`directions`].
//! May import: `kernel`, `mixture`, `color`, `float`, `simd`, `error`; nothing imports from here.

pub(crate) mod candidates;
pub(crate) mod cell;
mod directions;
pub(crate) mod draw;
pub(crate) mod light;
pub(crate) mod light_block;
mod look_up;
mod make;
pub(crate) mod product;
mod read;
pub(crate) mod reflect;
pub(crate) mod sampling;
pub(crate) mod table;
pub(crate) mod together;
