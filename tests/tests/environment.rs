//! Environments against f64, their samples against their density; light and material sampled together against multiple
//! importance sampling, and against a scalar text.

#[path = "environment/map.rs"]
mod map;
#[path = "environment/product.rs"]
mod product;
