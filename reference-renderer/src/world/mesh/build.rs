//! A mesh of positions and polygons.

use super::Mesh;
use anyhow::ensure;
use glam::{Vec2, Vec3};
use std::collections::HashSet;

/// Largest coordinate: with larger ones areas overflow.
const MAX_COORDINATE: f32 = 1e9;

/// Makes a mesh of positions and triangles, with coordinates on maps for each of them, or none.
pub(super) fn build(
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    coordinates: Vec<[Vec2; 3]>,
) -> anyhow::Result<Mesh> {
    ensure!(!triangles.is_empty(), "the mesh has no faces");
    let mut mesh = Mesh { positions, triangles, coordinates, ..Mesh::default() };
    // A triangle without area cannot be seen, and has no normal.
    let visible: Vec<bool> = (0..mesh.triangles.len())
        .map(|i| {
            let [a, b, c] = mesh.corners(i);
            (b - a).cross(c - a).length_squared() > 0.0
        })
        .collect();
    keep(&mut mesh, &visible);
    ensure!(!mesh.triangles.is_empty(), "every face of the mesh has zero area");
    mesh.smooth_normals();
    drop_repeated(&mut mesh);
    Ok(mesh)
}

/// Leaves of the triangles those alone that are marked.
fn keep(mesh: &mut Mesh, marks: &[bool]) {
    let mut left = marks.iter();
    mesh.triangles.retain(|_| left.next().copied().unwrap_or(false));
    let mut left = marks.iter();
    mesh.coordinates.retain(|_| left.next().copied().unwrap_or(false));
}

/// Leaves of triangles with the same corners, in any order, the first only: a ray could not tell them apart.
fn drop_repeated(mesh: &mut Mesh) {
    // Adding 0 makes one zero of two.
    let bits = |corner: Vec3| corner.to_array().map(|v| (v + 0.0).to_bits());
    let mut seen = HashSet::with_capacity(mesh.triangles.len());
    let is_new: Vec<bool> = (0..mesh.triangles.len())
        .map(|i| {
            let mut corners = mesh.corners(i).map(bits);
            corners.sort_unstable();
            seen.insert(corners)
        })
        .collect();
    keep(mesh, &is_new);
}

/// Checks a vertex.
pub(super) fn vertex(position: [f32; 3]) -> anyhow::Result<Vec3> {
    // False for a NaN too.
    let fits = position.iter().all(|v| v.abs() <= MAX_COORDINATE);
    ensure!(fits, "a vertex of three coordinates within 1e9 of 0 is expected, found {position:?}");
    Ok(position.into())
}

/// Checks coordinates on a map.
pub(super) fn coordinates(uv: [f32; 2]) -> anyhow::Result<Vec2> {
    let fits = uv.iter().all(|v| v.abs() <= MAX_COORDINATE);
    ensure!(fits, "two coordinates on a map within 1e9 of 0 are expected, found {uv:?}");
    Ok(uv.into())
}

/// Splits a polygon into a fan of triangles.
pub(super) fn add_fan<T: Copy>(polygon: &[T], triangles: &mut Vec<[T; 3]>) {
    triangles.extend(polygon.windows(2).skip(1).map(|pair| [polygon[0], pair[0], pair[1]]));
}
