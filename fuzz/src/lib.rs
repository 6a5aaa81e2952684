//! The attacks of `tests/src/attack.rs` and what they stand on, without the rest of that package: it would be compiled with
//! sanitizers for nothing.

extern crate alloc;

#[path = "../../tests/src/attack.rs"]
pub mod attack;
#[path = "../../tests/src/inputs.rs"]
pub mod inputs;
