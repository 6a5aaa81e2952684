//! Environments against f64, their samples against their density; light and material sampled together against multiple
//! importance sampling, and against a scalar text.

mod any;
mod edges;
mod many;
mod map;
mod product;
mod reflect;
mod same_bits;
