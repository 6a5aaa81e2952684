//! A pinhole camera.

use crate::world::ray::Ray;
use glam::Vec3;

/// A pinhole camera that looks from a place to a target, +z of the world up in the picture.
#[derive(Clone, Debug)]
pub struct Camera {
    origin: Vec3,
    forward: Vec3,
    /// Per pixel to the right and per pixel down, at distance 1.
    right: Vec3,
    down: Vec3,
    centre: [f32; 2],
}

impl Camera {
    /// Makes a camera for a picture of `size` pixels; `view_angle` is the angle that the shorter side sees, radians. Of one that looks
    /// straight up or down, +y is up in the picture.
    pub fn new(origin: Vec3, target: Vec3, view_angle: f32, size: [u32; 2]) -> Self {
        let forward = (target - origin).normalize();
        let right = forward.cross(Vec3::Z).try_normalize().unwrap_or(Vec3::X);
        let [width, height] = size.map(|n| n as f32);
        let pixel = 2.0 * (0.5 * view_angle).tan() / width.min(height);
        Self {
            origin,
            forward,
            right: right * pixel,
            down: forward.cross(right) * pixel,
            centre: [0.5 * width, 0.5 * height],
        }
    }

    /// The ray through a point of the picture, in pixels from the upper left corner.
    #[inline]
    pub fn ray(&self, x: f32, y: f32) -> Ray {
        let across = self.right * (x - self.centre[0]) + self.down * (y - self.centre[1]);
        Ray { origin: self.origin, direction: (self.forward + across).normalize() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::vec3;

    #[test]
    fn centre_looks_at_the_target_and_edges_are_where_they_belong() {
        let camera = Camera::new(vec3(0.0, -5.0, 0.0), Vec3::ZERO, 1.0, [200, 100]);
        assert!((camera.ray(100.0, 50.0).direction - Vec3::Y).length() < 1e-6);
        // The shorter side sees one radian: half of it above the centre.
        let top = camera.ray(100.0, 0.0).direction;
        assert!((top.dot(Vec3::Y).acos() - 0.5).abs() < 1e-5 && top.z > 0.0 && top.x.abs() < 1e-6);
        // Facing +y with +z up, right is +x.
        assert!(camera.ray(200.0, 50.0).direction.x > 0.0);
    }

    #[test]
    fn one_may_look_straight_down() {
        let camera = Camera::new(vec3(0.0, 0.0, 5.0), Vec3::ZERO, 1.0, [100, 100]);
        let [up, right] = [(50.0, 0.0), (100.0, 50.0)].map(|(x, y)| camera.ray(x, y).direction);
        assert!(up.y > 0.1 && up.x.abs() < 1e-6 && right.x > 0.1 && right.y.abs() < 1e-6, "{up} {right}");
    }
}
