//! The attacks of `tests/src/attack.rs` and the modules that they need, without the rest of that package: it would be compiled with
//! sanitizers for nothing.

extern crate alloc;

#[cfg(feature = "scene")]
pub mod scene;
pub mod view;

#[path = "../../tests/src/attack.rs"]
pub mod attack;
#[path = "../../tests/src/inputs.rs"]
pub mod inputs;
