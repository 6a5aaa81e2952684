//! A material asked directly: its lobes for one outgoing direction go from the rows of the file through
//! registers into sums and draws. No mixture is made.
//!
//! `lobes` has what summing and drawing need of the lobes. [`one`] is one hit, `small` the text for it without vectors; `block`
//! takes sixteen, and [`pairs`] any number, each with an outgoing direction and a material of its own.

#[cfg(feature = "simd")]
mod block;
#[cfg(feature = "simd")]
mod lobes;
mod one;
mod pairs;
mod question;
#[cfg(not(feature = "simd"))]
mod small;
