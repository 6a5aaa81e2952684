//! The cube map: a vector of values over the sphere, in the order of the thesis's section 4.1.1.
//!
//! The pixels of each face row by row; the faces in the order +x, -x, +y, -y, +z, -z, each seen from inside as in OpenGL's cube
//! textures. Texels whose centre lies above the horizon are *measured*; texels below have no value, and no part in a fit.

use std::f64::consts::PI;

/// Directions, solid angles and neighbours of the texels of a cube map.
#[derive(Clone, Debug)]
pub(crate) struct Cube {
    edge: usize,
    /// Centres of the measured texels, unit vectors, in the order of the vector.
    pub directions: Vec<[f64; 3]>,
    /// Their solid angles, sr.
    pub solid_angles: Vec<f64>,
    /// Their neighbours on the four sides, where those are measured.
    pub neighbours: Vec<Vec<u32>>,
}

impl Cube {
    /// A cube map with faces of `edge` by `edge` texels.
    pub fn new(edge: usize) -> Self {
        let center = |i: usize| (2.0 * i as f64 + 1.0) / edge as f64 - 1.0;
        let texels: Vec<(usize, usize, usize)> = (0..6)
            .flat_map(|face| (0..edge).flat_map(move |row| (0..edge).map(move |column| (face, row, column))))
            .collect();
        let place =
            |&(face, row, column): &(usize, usize, usize)| normalized(ray(face, center(column), center(row)));

        // Number of a texel among the measured ones.
        let mut measured = vec![None; texels.len()];
        let mut cube = Self { edge, directions: vec![], solid_angles: vec![], neighbours: vec![] };
        for (n, texel) in texels.iter().enumerate() {
            let direction = place(texel);
            if direction[2] > 0.0 {
                measured[n] = Some(cube.directions.len() as u32);
                cube.directions.push(direction);
                let bounds = |i: usize| [i, i + 1].map(|i| 2.0 * i as f64 / edge as f64 - 1.0);
                let ([u0, u1], [v0, v1]) = (bounds(texel.2), bounds(texel.1));
                cube.solid_angles.push(corner(u1, v1) - corner(u0, v1) - corner(u1, v0) + corner(u0, v0));
            }
        }
        let step = 2.0 / edge as f64;
        for (face, row, column) in texels.iter().filter(|t| place(t)[2] > 0.0) {
            let (u, v) = (center(*column), center(*row));
            let sides = [(u - step, v), (u + step, v), (u, v - step), (u, v + step)];
            // One step over the edge of a face lands in the first row of the next one.
            let beside = sides.map(|(u, v)| measured[index_of(ray(*face, u, v), edge)]);
            cube.neighbours.push(beside.into_iter().flatten().collect());
        }
        cube
    }

    /// Width of a texel at the middle of a face, radians.
    pub fn texel_width(&self) -> f64 {
        2.0 / self.edge as f64
    }
}

/// Direction of a point of a face, `u` to the right and `v` downwards in [-1, 1]; not normalised.
fn ray(face: usize, u: f64, v: f64) -> [f64; 3] {
    match face {
        0 => [1.0, -v, -u],
        1 => [-1.0, -v, u],
        2 => [u, 1.0, v],
        3 => [u, -1.0, -v],
        4 => [u, -v, 1.0],
        _ => [-u, -v, -1.0],
    }
}

/// Number of the texel in the vector that a direction falls into.
fn index_of(d: [f64; 3], edge: usize) -> usize {
    let size = d.map(f64::abs);
    let (face, major, u, v) = if size[0] >= size[1] && size[0] >= size[2] {
        if d[0] > 0.0 { (0, size[0], -d[2], -d[1]) } else { (1, size[0], d[2], -d[1]) }
    } else if size[1] >= size[2] {
        if d[1] > 0.0 { (2, size[1], d[0], d[2]) } else { (3, size[1], d[0], -d[2]) }
    } else if d[2] > 0.0 {
        (4, size[2], d[0], -d[1])
    } else {
        (5, size[2], -d[0], -d[1])
    };
    let pixel = |t: f64| ((0.5 * (t / major + 1.0) * edge as f64) as usize).min(edge - 1);
    (face * edge + pixel(v)) * edge + pixel(u)
}

/// Solid angle of the rectangle from the middle of a face to (u, v).
fn corner(u: f64, v: f64) -> f64 {
    libm::atan2(u * v, libm::sqrt(u * u + v * v + 1.0))
}

fn normalized(d: [f64; 3]) -> [f64; 3] {
    let length = libm::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    d.map(|v| v / length)
}

/// Solid angle of the cap of a unit sphere whose edge is at an angle with this cosine from its middle.
pub(crate) fn cap(cosine: f64) -> f64 {
    2.0 * PI * (1.0 - cosine)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_come_in_the_order_of_the_thesis() {
        let axes = [
            [1.0, 0.0, 0.0],
            [-1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, -1.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.0, 0.0, -1.0],
        ];
        for (face, axis) in axes.into_iter().enumerate() {
            // With one texel a face, its number is the face's.
            assert_eq!(index_of(axis, 1), face);
            for (row, column) in [(0, 0), (0, 2), (1, 1), (2, 0)] {
                let place = |i: usize| (2.0 * i as f64 + 1.0) / 3.0 - 1.0;
                assert_eq!(index_of(ray(face, place(column), place(row)), 3), 9 * face + 3 * row + column);
            }
        }
    }

    #[test]
    fn solid_angles_of_the_measured_texels_fill_the_hemisphere() {
        for edge in [2, 8, 32] {
            let cube = Cube::new(edge);
            assert_eq!(cube.directions.len(), 3 * edge * edge);
            let sum: f64 = cube.solid_angles.iter().sum();
            assert!((sum - 2.0 * PI).abs() < 1e-12, "{edge}: {sum}");
            let moment: f64 = cube.directions.iter().zip(&cube.solid_angles).map(|(d, w)| d[2] * w).sum();
            assert!((moment - PI).abs() < 2.0 / (edge * edge) as f64, "{edge}: {moment}");
        }
    }

    #[test]
    fn neighbours_are_next_to_each_other_over_the_edges_too() {
        let cube = Cube::new(16);
        for (n, beside) in cube.neighbours.iter().enumerate() {
            let d = cube.directions[n];
            assert!(beside.len() == 4 || (beside.len() >= 2 && d[2] < 0.1), "{n}: {beside:?}");
            for &other in beside {
                let e = cube.directions[other as usize];
                let distance = libm::sqrt((0..3).map(|k| (d[k] - e[k]) * (d[k] - e[k])).sum());
                assert!(distance < 1.1 * cube.texel_width(), "{n} {other}: {distance}");
            }
        }
    }
}
