//! The Utah teapot: 32 bicubic Bezier patches (Newell 1975), tessellated, with the normals of the surface itself.

mod control_points;

use crate::world::mesh::Mesh;
use control_points::{PATCHES, POINTS};
use glam::{DVec3, Vec3, dvec3};

/// Values of the four cubic Bernstein polynomials, and their derivatives.
fn bernstein(t: f64) -> ([f64; 4], [f64; 4]) {
    let s = 1.0 - t;
    (
        [s * s * s, 3.0 * t * s * s, 3.0 * t * t * s, t * t * t],
        [-3.0 * s * s, 3.0 * s * (s - 2.0 * t), 3.0 * t * (2.0 * s - t), 3.0 * t * t],
    )
}

/// A point of a patch and its two derivatives.
fn evaluate(patch: &[u16; 16], u: f64, v: f64) -> [DVec3; 3] {
    let ((bu, du), (bv, dv)) = (bernstein(u), bernstein(v));
    let mut sums = [DVec3::ZERO; 3];
    for (k, &index) in patch.iter().enumerate() {
        let [x, y, z] = POINTS[usize::from(index)];
        let (row, column) = (k / 4, k % 4);
        let weights = [bu[row] * bv[column], du[row] * bv[column], bu[row] * dv[column]];
        for (sum, weight) in sums.iter_mut().zip(weights) {
            *sum += dvec3(x, y, z) * weight;
        }
    }
    sums
}

/// The surface normal; at the poles of lid and bottom, where a whole edge is one point, its limit.
fn normal(patch: &[u16; 16], u: f64, v: f64) -> DVec3 {
    // A step into the patch is far above f64 rounding and far below what f32 normals show.
    for step in [0.0, 1e-5] {
        let inside = |t: f64| t + step * (0.5 - t);
        let [_, along_u, along_v] = evaluate(patch, inside(u), inside(v));
        let normal = along_u.cross(along_v);
        if normal.length() > 1e-9 * along_u.length().max(along_v.length()) {
            return normal.normalize();
        }
    }
    DVec3::Z
}

/// Makes triangles of the teapot, `steps` x `steps` quadrilaterals a patch.
///
/// It stands on z = 0, handle towards -x, spout towards +x, 3.15 high.
pub fn tessellate(steps: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for patch in &PATCHES {
        let first = mesh.positions.len() as u32;
        for i in 0..=steps {
            for j in 0..=steps {
                let (u, v) = (f64::from(i) / f64::from(steps), f64::from(j) / f64::from(steps));
                mesh.positions.push(evaluate(patch, u, v)[0].as_vec3());
                mesh.normals.push(normal(patch, u, v).as_vec3());
            }
        }
        let vertex = |i, j| first + i * (steps + 1) + j;
        for i in 0..steps {
            for j in 0..steps {
                let quad = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
                for triangle in [[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]] {
                    // At a pole two corners coincide: such a triangle has no area.
                    let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
                    if (b - a).cross(c - a) != Vec3::ZERO {
                        mesh.triangles.push(triangle);
                    }
                }
            }
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_of_patches_are_control_points() {
        for patch in &PATCHES {
            for (u, v, k) in [(0.0, 0.0, 0), (0.0, 1.0, 3), (1.0, 0.0, 12), (1.0, 1.0, 15)] {
                let [x, y, z] = POINTS[usize::from(patch[k])];
                assert!((evaluate(patch, u, v)[0] - dvec3(x, y, z)).length() < 1e-12);
            }
        }
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let h = 1e-6;
        for patch in &PATCHES {
            let [_, along_u, along_v] = evaluate(patch, 0.3, 0.7);
            let du = (evaluate(patch, 0.3 + h, 0.7)[0] - evaluate(patch, 0.3 - h, 0.7)[0]) / (2.0 * h);
            let dv = (evaluate(patch, 0.3, 0.7 + h)[0] - evaluate(patch, 0.3, 0.7 - h)[0]) / (2.0 * h);
            assert!((du - along_u).length() < 1e-7 && (dv - along_v).length() < 1e-7);
        }
    }

    #[test]
    fn extent_is_the_published_one() {
        let [low, high] = tessellate(16).bounds();
        // The spout's lip reaches x = 3.434, not the control point at 3.525.
        assert!((low - Vec3::new(-3.0, -2.0, 0.0)).length() < 1e-3, "{low}");
        assert!((high - Vec3::new(3.4339, 2.0, 3.15)).length() < 2e-3, "{high}");
    }

    #[test]
    fn normals_are_unit_and_agree_with_the_triangles() {
        let mesh = tessellate(24);
        for (i, triangle) in mesh.triangles.iter().enumerate() {
            let [a, b, c] = mesh.corners(i);
            let flat = (b - a).cross(c - a).normalize();
            for &v in triangle {
                let n = mesh.normals[v as usize];
                assert!((n.length() - 1.0).abs() < 1e-5);
                // The knob and the handle's joint bend most: 35 degrees within a triangle of 1/24 of a patch.
                assert!(n.dot(flat) > 0.8, "triangle {i} vertex {v}: {}", n.dot(flat));
            }
        }
    }
}
