//! A material made ready for speed: rows of lobes for many outgoing directions, in memory of the caller.
//!
//! The [`table`] says how it lies there, and [`make`] makes it; [`between_rows`] interpolates two of its
//! rows. [`pairs`] evaluates and draws, each pair with an outgoing direction of its own, a [`block`] of pairs
//! at a time.

pub(crate) mod between_rows;
mod block;
mod make;
mod pairs;
pub(crate) mod table;
