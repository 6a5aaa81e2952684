//! A material asked directly: its lobes for one outgoing direction go from the rows of the file through
//! registers into sums and draws. No mixture is made.
//!
//! `lobes` fills groups of sixteen lobes. [`one`] is one hit, `small` the text for it without vectors; `block` fills those of
//! sixteen hits, and [`pairs`] asks any number, each with an outgoing direction and a material of its own.

#[cfg(feature = "simd")]
pub(crate) mod block;
#[cfg(feature = "simd")]
pub(super) mod lobes;
pub(crate) mod one;
pub(crate) mod pairs;
pub(crate) mod question;
#[cfg(not(feature = "simd"))]
mod small;
