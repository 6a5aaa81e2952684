//! A half line.

use glam::Vec3;

/// A half line; the direction is a unit vector.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    pub origin: Vec3,
    pub direction: Vec3,
}
