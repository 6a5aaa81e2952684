//! The path tracer: scenes, cameras, the integrator, the film.
//!
//! May import: `shade`, `world`, `truth`, `numbers`, `out`.

pub mod ball;
pub mod camera;
pub mod carried;
pub mod cast;
pub mod film;
pub mod frame;
pub mod integrator;
pub mod openness;
pub mod path;
pub mod render;
pub mod scene;
pub mod settings;
#[cfg(test)]
mod tests;
