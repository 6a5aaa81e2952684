//! Where a ray meets triangles: a bounding volume hierarchy by `obvhs`, whose types stay in this file.

use crate::camera::Ray;
use crate::mesh::Mesh;
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh_from_tris};
use obvhs::triangle::Triangle;
use obvhs::{BvhBuildParams, ray};
use std::time::Duration;

/// A triangle that a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleHit {
    /// Distance from the ray's origin.
    pub distance: f32,
    /// Index of the triangle in the mesh.
    pub triangle: usize,
}

/// The triangles of a mesh, ordered for fast search.
pub struct TriangleTree {
    tree: CwBvh,
    /// In the order of the tree's leaves.
    triangles: Vec<Triangle>,
}

impl TriangleTree {
    /// Builds the tree; an empty mesh is never hit.
    pub fn new(mesh: &Mesh) -> Self {
        let triangles: Vec<Triangle> = (0..mesh.triangles.len())
            .map(|i| {
                let [v0, v1, v2] = mesh.corners(i).map(Into::into);
                Triangle { v0, v1, v2 }
            })
            .collect();
        if triangles.is_empty() {
            return Self { tree: CwBvh::default(), triangles };
        }
        let tree = build_cwbvh_from_tris(&triangles, BvhBuildParams::slow_build(), &mut Duration::default());
        let triangles = tree.primitive_indices.iter().map(|&i| triangles[i as usize]).collect();
        Self { tree, triangles }
    }

    /// Finds the nearest triangle along the ray, nearer than `limit`.
    pub fn nearest(&self, ray: &Ray, limit: f32) -> Option<TriangleHit> {
        if self.triangles.is_empty() {
            return None;
        }
        let mut hit = ray::RayHit::none();
        let found = self
            .tree
            .ray_traverse(to_obvhs(ray, limit), &mut hit, |ray, leaf| self.triangles[leaf].intersect(ray));
        found.then(|| TriangleHit {
            distance: hit.t,
            triangle: self.tree.primitive_indices[hit.primitive_id as usize] as usize,
        })
    }

    /// Whether the ray meets no triangle.
    pub fn is_clear(&self, ray: &Ray) -> bool {
        self.triangles.is_empty()
            || self.tree.ray_traverse_miss(to_obvhs(ray, f32::INFINITY), |ray, leaf| {
                self.triangles[leaf].intersect(ray)
            })
    }
}

fn to_obvhs(ray: &Ray, limit: f32) -> ray::Ray {
    ray::Ray::new(ray.origin.into(), ray.direction.into(), 0.0, limit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use crate::{sphere_sampling, teapot};
    use glam::vec3;

    #[test]
    fn tree_agrees_with_every_triangle_tried() {
        let mesh = teapot::tessellate(6);
        let tree = TriangleTree::new(&mesh);
        let mut random = Random::new(5, 0, 0);
        let mut hits = 0;
        for _ in 0..2000 {
            let origin = vec3(random.unit() * 8.0 - 4.0, random.unit() * 6.0 - 3.0, random.unit() * 4.0);
            let direction = sphere_sampling::uniform([random.unit(), random.unit()]);
            let ray = Ray { origin, direction };
            let best = (0..mesh.triangles.len())
                .map(|i| {
                    let [v0, v1, v2] = mesh.corners(i).map(Into::into);
                    Triangle { v0, v1, v2 }.intersect(&to_obvhs(&ray, f32::INFINITY))
                })
                .fold(f32::INFINITY, f32::min);
            let found = tree.nearest(&ray, f32::INFINITY);
            assert_eq!(found.map_or(f32::INFINITY, |hit| hit.distance), best, "{ray:?}");
            assert_eq!(tree.is_clear(&ray), found.is_none(), "{ray:?}");
            hits += usize::from(found.is_some());
        }
        assert!(hits > 200, "{hits} hits say little");
    }

    #[test]
    fn empty_mesh_is_never_hit() {
        let tree = TriangleTree::new(&Mesh::default());
        let ray = Ray { origin: glam::Vec3::ZERO, direction: glam::Vec3::Z };
        assert_eq!(tree.nearest(&ray, f32::INFINITY), None);
        assert!(tree.is_clear(&ray));
    }
}
