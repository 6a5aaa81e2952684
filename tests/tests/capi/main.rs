//! The C interface, seen from C and C++.

mod header;
mod programs;
