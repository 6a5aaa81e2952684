//! What leaves the program: text, pictures, pages, progress.
//!
//! May import: nothing.

// First, so that its macros take the place of the standard library's in all that follows.
#[macro_use]
pub mod print;

pub mod output;
pub mod page;
pub mod panel;
pub mod picture_file;
pub mod progress;
pub mod wrap;
