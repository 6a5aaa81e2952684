//! A ball, which rays meet in closed form.

use crate::world::ray::Ray;
use glam::Vec3;

/// A ball.
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    pub centre: Vec3,
    pub radius: f32,
}

impl Ball {
    /// Distance at which a ray from outside enters it.
    #[inline]
    pub fn hit(&self, ray: &Ray) -> Option<f32> {
        let origin = (ray.origin - self.centre) / self.radius;
        unit_sphere(&Ray { origin, direction: ray.direction }).map(|distance| distance * self.radius)
    }
}

/// Distance at which a ray from outside enters the unit sphere.
fn unit_sphere(ray: &Ray) -> Option<f32> {
    let along = ray.origin.dot(ray.direction);
    // The discriminant by the point nearest to the centre: `along^2 - |o|^2 + 1` would cancel far away.
    let nearest = ray.origin - ray.direction * along;
    let half_chord_squared = 1.0 - nearest.length_squared();
    if half_chord_squared < 0.0 {
        return None;
    }
    let distance = -along - half_chord_squared.sqrt();
    (distance > 0.0).then_some(distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::vec3;

    #[test]
    fn sphere_is_met_from_outside_only() {
        let ray = |origin, direction| Ray { origin, direction };
        assert_eq!(unit_sphere(&ray(vec3(0.0, 0.0, 3.0), Vec3::NEG_Z)), Some(2.0));
        assert_eq!(unit_sphere(&ray(vec3(0.0, 0.0, 3.0), Vec3::Z)), None);
        assert_eq!(unit_sphere(&ray(vec3(1.1, 0.0, 3.0), Vec3::NEG_Z)), None);
        let ball = Ball { centre: vec3(5.0, 0.0, 1.0), radius: 2.0 };
        assert_eq!(ball.hit(&ray(vec3(5.0, 0.0, 7.0), Vec3::NEG_Z)), Some(4.0));
    }
}
