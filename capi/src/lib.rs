//! The C interface: translates, computes nothing.
