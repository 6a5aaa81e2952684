//! Triangles with interpolated normals.

mod build;
pub mod file;
mod ply;

use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// Triangles that share vertices.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    pub positions: Vec<Vec3>,
    /// Unit normals, one a vertex.
    pub normals: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
    /// Coordinates on maps, to the right and up, at the corners of the first triangles; none where the mesh has none.
    pub coordinates: Vec<[Vec2; 3]>,
}

impl Mesh {
    /// The corners of a triangle.
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|v| self.positions[v as usize])
    }

    /// The normal of a triangle's plane and the interpolated normal at a point on it; both unit vectors.
    pub fn normals_at(&self, triangle: usize, point: Vec3) -> (Vec3, Vec3) {
        let [a, b, c] = self.corners(triangle);
        let flat = (b - a).cross(c - a).normalize_or(Vec3::Z);
        let [of_b, of_c] = self.shares(triangle, point);
        let [na, nb, nc] = self.triangles[triangle].map(|v| self.normals[v as usize]);
        let smooth = na * (1.0 - of_b - of_c) + nb * of_b + nc * of_c;
        (flat, if smooth.is_finite() { smooth.normalize_or(flat) } else { flat })
    }

    /// Barycentric coordinates of a point on a triangle by areas: the shares of its second and third corner.
    fn shares(&self, triangle: usize, point: Vec3) -> [f32; 2] {
        let [a, b, c] = self.corners(triangle);
        let across = (b - a).cross(c - a);
        let area = across.length_squared();
        let of_b = (point - a).cross(c - a).dot(across) / area;
        let of_c = (b - a).cross(point - a).dot(across) / area;
        [of_b, of_c]
    }

    /// The coordinates on maps of a point on a triangle; `None` where it has none.
    pub fn coordinates_at(&self, triangle: usize, point: Vec3) -> Option<Vec2> {
        let [a, b, c] = *self.coordinates.get(triangle)?;
        let [of_b, of_c] = self.shares(triangle, point);
        let found = a * (1.0 - of_b - of_c) + b * of_b + c * of_c;
        Some(if found.is_finite() { found } else { a })
    }

    /// Gives it coordinates on maps where it has none: to the right round the vertical +z through its middle, up by the height.
    pub fn wrap(&mut self) {
        if !self.coordinates.is_empty() {
            return;
        }
        let [low, high] = self.bounds();
        let middle = 0.5 * (low + high);
        let place = |p: Vec3| {
            let from = p - middle;
            Vec2::new(
                from.y.atan2(from.x) / TAU + 0.5,
                (p.z - low.z) / (high.z - low.z).max(f32::MIN_POSITIVE),
            )
        };
        self.coordinates = (0..self.triangles.len())
            .map(|i| {
                let mut corners = self.corners(i).map(place);
                // Where a turn ends, one begins.
                let most = corners.iter().fold(0f32, |a, b| a.max(b.x));
                corners.iter_mut().filter(|uv| most - uv.x > 0.5).for_each(|uv| uv.x += 1.0);
                corners
            })
            .collect();
    }

    /// Adds the triangles of another mesh.
    pub fn append(&mut self, other: &Mesh) {
        if !other.coordinates.is_empty() {
            self.coordinates.resize(self.triangles.len(), [Vec2::ZERO; 3]);
            self.coordinates.extend(&other.coordinates);
        }
        let offset = self.positions.len() as u32;
        self.positions.extend(&other.positions);
        self.normals.extend(&other.normals);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + offset)));
    }

    /// Replaces the normals by the mean of those of the triangles round each vertex, weighted by area.
    pub fn smooth_normals(&mut self) {
        self.normals = vec![Vec3::ZERO; self.positions.len()];
        for i in 0..self.triangles.len() {
            let [a, b, c] = self.corners(i);
            let normal = (b - a).cross(c - a);
            self.triangles[i].iter().for_each(|&v| self.normals[v as usize] += normal);
        }
        self.normals.iter_mut().for_each(|n| *n = n.normalize_or(Vec3::Z));
    }

    /// Turns a mesh with +y up into one with +z up.
    pub fn turn_y_up(&mut self) {
        let turn = |v: &mut Vec3| *v = Vec3::new(v.x, -v.z, v.y);
        self.positions.iter_mut().chain(&mut self.normals).for_each(turn);
    }

    /// Scales and moves so that it stands on z = 0 over the origin, its largest side `size`.
    pub fn stand(&mut self, size: f32) {
        let [low, high] = self.bounds();
        let scale = size / (high - low).max_element();
        let foot = Vec3::new(0.5 * (low.x + high.x), 0.5 * (low.y + high.y), low.z);
        self.positions.iter_mut().for_each(|p| *p = (*p - foot) * scale);
    }

    /// The smallest box round the vertices, lower and upper corner.
    pub fn bounds(&self) -> [Vec3; 2] {
        self.positions
            .iter()
            .fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[low, high], &p| [low.min(p), high.max(p)])
    }

    /// A square in the plane z = `height`, of two triangles, seen from above.
    pub fn square(half_side: f32, height: f32) -> Self {
        let corner = |x: f32, y: f32| Vec3::new(x * half_side, y * half_side, height);
        Self::quadrilateral([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)])
    }

    /// A flat quadrilateral, of two triangles; its corners turn left for one who looks at its front.
    pub fn quadrilateral(corners: [Vec3; 4]) -> Self {
        let normal = (corners[1] - corners[0]).cross(corners[3] - corners[0]).normalize();
        Self {
            positions: corners.to_vec(),
            normals: vec![normal; 4],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Self::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::vec3;

    #[test]
    fn normals_are_interpolated_linearly() {
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            normals: vec![Vec3::Z, Vec3::X, Vec3::Y],
            triangles: vec![[0, 1, 2]],
            coordinates: vec![[Vec2::ZERO, Vec2::X, Vec2::Y]],
        };
        let (flat, smooth) = mesh.normals_at(0, vec3(0.25, 0.5, 0.0));
        assert_eq!(flat, Vec3::Z);
        assert!((smooth - vec3(0.25, 0.5, 0.25).normalize()).length() < 1e-6);
        let found = mesh.coordinates_at(0, vec3(0.25, 0.5, 0.0)).unwrap();
        assert!((found - Vec2::new(0.25, 0.5)).length() < 1e-6);
        assert_eq!(mesh.coordinates_at(1, Vec3::ZERO), None);
        let mut both = Mesh::square(1.0, 0.0);
        both.append(&mesh);
        assert_eq!(both.coordinates.len(), 3);
        assert_eq!(both.coordinates_at(2, Vec3::X).unwrap(), Vec2::X);
    }

    #[test]
    fn a_mesh_without_coordinates_is_wrapped_once_round() {
        let mut mesh = Mesh {
            positions: vec![
                vec3(-1.0, 0.01, 0.0),
                vec3(-1.0, -0.01, 0.0),
                vec3(-1.0, 0.0, 2.0),
                vec3(1.0, 0.0, 2.0),
            ],
            triangles: vec![[0, 1, 2], [1, 2, 3]],
            ..Mesh::default()
        };
        mesh.wrap();
        // Across the end of the turn the coordinates go on.
        let [a, b, c] = mesh.coordinates[0].map(|uv| uv.x);
        assert!((a - b).abs() < 0.01 && (c - a).abs() < 0.01, "{a} {b} {c}");
        assert_eq!(mesh.coordinates[0].map(|uv| uv.y), [0.0, 0.0, 1.0]);
    }

    #[test]
    fn stands_upright_in_the_size_asked_for() {
        let mut mesh = Mesh {
            positions: vec![Vec3::new(5.0, 1.0, 0.0), Vec3::new(7.0, 1.0, 0.0), Vec3::new(6.0, 9.0, 0.5)],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        mesh.smooth_normals();
        mesh.turn_y_up();
        mesh.stand(4.0);
        let [low, high] = mesh.bounds();
        assert!((low - vec3(-0.5, -0.125, 0.0)).length() < 1e-6, "{low}");
        assert!((high - vec3(0.5, 0.125, 4.0)).length() < 1e-6, "{high}");
        let (flat, smooth) = mesh.normals_at(0, mesh.positions[0]);
        assert!((flat - smooth).length() < 1e-6);
    }

    #[test]
    fn triangle_without_area_gives_unit_normals() {
        let mesh = Mesh {
            positions: vec![Vec3::ONE; 3],
            normals: vec![Vec3::X; 3],
            triangles: vec![[0, 1, 2]],
            coordinates: vec![[Vec2::X; 3]],
        };
        assert_eq!(mesh.coordinates_at(0, Vec3::ONE), Some(Vec2::X));
        let (flat, smooth) = mesh.normals_at(0, Vec3::ONE);
        assert!((flat.length() - 1.0).abs() < 1e-6 && (smooth.length() - 1.0).abs() < 1e-6);
    }
}
