//! The C interface, seen from C and C++.

mod header;
mod material;
mod programs;
mod symbols;
