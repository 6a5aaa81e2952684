//! Where a ray meets triangles: a bounding volume hierarchy by `obvhs`, whose types stay in this file.

use crate::world::mesh::Mesh;
use crate::world::ray::Ray;
use obvhs::aabb::Aabb;
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh_from_tris};
use obvhs::triangle::Triangle;
use obvhs::{Boundable, BvhBuildParams, ray};
use rayon::prelude::*;
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
        let triangles: Vec<Triangle> = (0..mesh.triangles.len()).map(|i| triangle(mesh, i)).collect();
        if triangles.is_empty() {
            return Self { tree: CwBvh::default(), triangles };
        }
        let build =
            if is_pile(&triangles) { BvhBuildParams::fastest_build() } else { BvhBuildParams::slow_build() };
        let tree = build_cwbvh_from_tris(&triangles, build, &mut Duration::default());
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

/// Triangles that are looked at to find out whether a mesh is a pile.
const LOOKED_AT: usize = 128;

/// Mean number of triangles near one from which on a mesh is a pile. A smooth surface has below a hundred.
const CROWD: usize = 1000;

/// Whether most triangles lie in a heap, nested or in layers.
///
/// The builder joins a triangle and its neighbour when each is the best for the other. In a heap all are as good, few such pairs
/// are found in a pass, and the time grows with the square of the number: 25 times as fast for the fastest build.
fn is_pile(triangles: &[Triangle]) -> bool {
    let boxes: Vec<Aabb> = triangles.iter().map(Boundable::aabb).collect();
    let step = boxes.len().div_ceil(LOOKED_AT);
    let near = |one: &Aabb| {
        let reach = 0.5 * one.diagonal().max_element();
        let wide = Aabb::new(one.min - reach, one.max + reach);
        boxes.iter().filter(|other| wide.intersect_aabb(other)).count()
    };
    let looked_at = boxes.len().div_ceil(step);
    boxes.len() > CROWD && boxes.par_iter().step_by(step).map(near).sum::<usize>() > CROWD * looked_at
}

fn triangle(mesh: &Mesh, i: usize) -> Triangle {
    let [v0, v1, v2] = mesh.corners(i).map(Into::into);
    Triangle { v0, v1, v2 }
}

fn to_obvhs(ray: &Ray, limit: f32) -> ray::Ray {
    ray::Ray::new(ray.origin.into(), ray.direction.into(), 0.0, limit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::random::Random;
    use crate::world::sphere_sampling;
    use crate::world::teapot;
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
                .map(|i| triangle(&mesh, i).intersect(&to_obvhs(&ray, f32::INFINITY)))
                .fold(f32::INFINITY, f32::min);
            let found = tree.nearest(&ray, f32::INFINITY);
            assert_eq!(found.map_or(f32::INFINITY, |hit| hit.distance), best, "{ray:?}");
            assert_eq!(tree.is_clear(&ray), found.is_none(), "{ray:?}");
            hits += usize::from(found.is_some());
        }
        assert!(hits > 200, "{hits} hits say little");
    }

    fn all(mesh: &Mesh) -> Vec<Triangle> {
        (0..mesh.triangles.len()).map(|i| triangle(mesh, i)).collect()
    }

    #[test]
    #[ignore = "needs SRBF_DATA_DIR"]
    fn published_meshes_are_no_piles() {
        let folder = std::env::var_os("SRBF_DATA_DIR").expect("SRBF_DATA_DIR names the folder of the data");
        for name in ["happy_buddha_100k.ply", "stanford_dragon_res3.ply", "stanford_bunny_small.obj"] {
            let path = std::path::Path::new(&folder).join("meshes").join(name);
            assert!(!is_pile(&all(&crate::world::mesh::file::read(&path).unwrap())), "{name}");
        }
    }

    #[test]
    fn piles_are_told_from_surfaces() {
        let pile = |corners: fn(f32) -> [glam::Vec3; 3]| {
            let corner = |i: u32| corners(1.0 + 1e-3 * i as f32).map(Into::into);
            (0..3000u32).map(corner).map(|[v0, v1, v2]| Triangle { v0, v1, v2 }).collect::<Vec<_>>()
        };
        let nested = pile(|s| [vec3(s, s, 0.0), vec3(-s, -s, 0.0), vec3(-s, s, 0.0)]);
        let layers = pile(|z| [vec3(9.0, 9.0, z), vec3(-9.0, -9.0, z), vec3(-9.0, 9.0, z)]);
        assert!(is_pile(&nested) && is_pile(&layers));
        for steps in [1, 24, 60] {
            let mesh = teapot::tessellate(steps);
            assert!(!is_pile(&all(&mesh)), "{steps}");
        }
        assert!(!is_pile(&nested[..1]));
    }

    #[test]
    fn empty_mesh_is_never_hit() {
        let tree = TriangleTree::new(&Mesh::default());
        let ray = Ray { origin: glam::Vec3::ZERO, direction: glam::Vec3::Z };
        assert_eq!(tree.nearest(&ray, f32::INFINITY), None);
        assert!(tree.is_clear(&ray));
    }
}
