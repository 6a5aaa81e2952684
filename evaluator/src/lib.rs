//! One evaluator text for every language: a material is evaluated and drawn from without the library, in a shader, on a GPU, in C++.
//!
//! [`srbf.inc`](https://docs.rs/crate/srbf-evaluator/latest/source/src/srbf.inc) is the text. It reads the words of a `.srbf` file in place.
//! [`text`] writes it out for a [`Language`] by replacing tokens, so that comments and names stay; [`export`] adds the words of one
//! material. `include/srbf_device.hpp` is [`text`] of C++, and a test holds it to that.
//! [`sheet_text`] has the functions of a sheet too, and [`blend_text`] those of a blend as well. Each begins with its calls, [`usage`]. [`Surface`] is either, by the bytes of a file.

mod calls;
mod export;
mod language;
mod rewrite;
mod surface;
mod usage;
mod wgsl;

pub use export::{can_read, comments, export, json, plain_bytes};
pub use language::Language;
pub use rewrite::{blend_text, functions, sheet_text, text};
pub use surface::{QUARTERS, Surface};
pub use usage::{Content, is_name, renamed, usage};
