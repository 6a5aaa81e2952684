//! A material made ready for speed: rows of lobes for many outgoing directions, in memory of the caller.
//!
//! The [`table`] says how it lies there, and [`make`] makes it; [`between_rows`] interpolates two of its
//! rows. [`block`] fills the lobes of sixteen hits, and [`pairs`] asks any number, each with an outgoing direction of its own.

pub(crate) mod between_rows;
mod block;
mod make;
mod pairs;
pub(crate) mod table;
