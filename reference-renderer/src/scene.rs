//! What is rendered: one object under an environment, with or without a ground. +z is up.

use crate::camera::{Camera, Ray};
use crate::environment::Environment;
use crate::intersect::TriangleTree;
use crate::mesh::Mesh;
use crate::shader::Shader;
use crate::teapot;
use glam::{Vec3, vec3};

/// Quadrilaterals along each side of a patch of the teapot: at 24 the outline shows no corners in 4096 pixels.
const TEAPOT_STEPS: u32 = 24;

/// Height of the ground below the teapot, whose bottom touches z = 0: so that no two surfaces coincide.
const GROUND_HEIGHT: f32 = -1e-3;

/// Half the side of the ground.
const GROUND_HALF_SIDE: f32 = 60.0;

/// Which scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum SceneName {
    /// A sphere of radius 1 that floats in the environment.
    Sphere,
    /// The Utah teapot on a plane.
    Teapot,
}

impl SceneName {
    /// The camera that shows the scene.
    pub fn camera(self, size: [u32; 2]) -> Camera {
        match self {
            Self::Sphere => Camera::new(vec3(0.0, -6.0, 0.6), Vec3::ZERO, 24f32.to_radians(), size),
            Self::Teapot => {
                Camera::new(vec3(3.6, -9.6, 5.2), vec3(0.15, 0.0, 1.25), 27f32.to_radians(), size)
            }
        }
    }
}

/// Surfaces, materials and light.
pub struct Scene<'a> {
    /// Whether the unit sphere at the origin is there.
    sphere: bool,
    mesh: Mesh,
    tree: TriangleTree,
    /// Triangles from this one on are the ground.
    ground_from: usize,
    object: Shader<'a>,
    ground: Shader<'a>,
    /// The light.
    pub environment: &'a Environment,
}

/// A point of a surface that a ray meets.
pub struct Surface<'s, 'a> {
    pub point: Vec3,
    /// Unit normal of the surface as it is, on either side.
    pub flat: Vec3,
    /// Unit normal of the smooth surface that the triangles stand for.
    pub smooth: Vec3,
    pub material: &'s Shader<'a>,
}

impl<'a> Scene<'a> {
    /// Builds a scene of the object's material and the ground's, which the sphere's scene does not have.
    pub fn new(
        name: SceneName,
        object: impl Into<Shader<'a>>,
        ground: impl Into<Shader<'a>>,
        environment: &'a Environment,
    ) -> Self {
        let mesh = match name {
            SceneName::Sphere => Mesh::default(),
            SceneName::Teapot => teapot::tessellate(TEAPOT_STEPS),
        };
        Self::with_mesh(name, mesh, object, ground, environment)
    }

    /// Builds a scene with a mesh in place of the teapot.
    pub fn with_mesh(
        name: SceneName,
        mut mesh: Mesh,
        object: impl Into<Shader<'a>>,
        ground: impl Into<Shader<'a>>,
        environment: &'a Environment,
    ) -> Self {
        let ground_from = mesh.triangles.len();
        if name == SceneName::Teapot {
            mesh.append(&Mesh::square(GROUND_HALF_SIDE, GROUND_HEIGHT));
        }
        let tree = TriangleTree::new(&mesh);
        let (object, ground) = (object.into(), ground.into());
        Self { sphere: name == SceneName::Sphere, mesh, tree, ground_from, object, ground, environment }
    }

    /// The nearest surface along a ray.
    pub fn hit(&self, ray: &Ray) -> Option<Surface<'_, 'a>> {
        let at = |distance: f32| ray.origin + ray.direction * distance;
        let sphere = if self.sphere { unit_sphere(ray) } else { None };
        if let Some(hit) = self.tree.nearest(ray, sphere.unwrap_or(f32::INFINITY)) {
            let point = at(hit.distance);
            let (flat, smooth) = self.mesh.normals_at(hit.triangle, point);
            let material = if hit.triangle < self.ground_from { &self.object } else { &self.ground };
            return Some(Surface { point, flat, smooth, material });
        }
        sphere.map(|distance| {
            let point = at(distance).normalize();
            Surface { point, flat: point, smooth: point, material: &self.object }
        })
    }

    /// Whether a ray meets nothing.
    pub fn is_clear(&self, ray: &Ray) -> bool {
        !(self.sphere && unit_sphere(ray).is_some()) && self.tree.is_clear(ray)
    }

    /// The object's material.
    pub fn object(&self) -> &Shader<'a> {
        &self.object
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

    #[test]
    fn sphere_is_met_from_outside_only() {
        let ray = |origin, direction| Ray { origin, direction };
        assert_eq!(unit_sphere(&ray(vec3(0.0, 0.0, 3.0), Vec3::NEG_Z)), Some(2.0));
        assert_eq!(unit_sphere(&ray(vec3(0.0, 0.0, 3.0), Vec3::Z)), None);
        assert_eq!(unit_sphere(&ray(vec3(1.1, 0.0, 3.0), Vec3::NEG_Z)), None);
    }
}
