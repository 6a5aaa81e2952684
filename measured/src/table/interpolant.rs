//! Scattered samples joined by triangles: values between them.

use crate::table::Sample;
use crate::table::interpolate::{LEAST, Net, Node, distance_squared, nearest, net, triangulate};

/// The values of scattered samples in between, linear in f over the same triangles that the weights integrate. Samples below
/// `FLOOR` count as that here, while the weights integrate them as they are.
pub struct Interpolant {
    nodes: Vec<Node>,
    triangles: Vec<Triangle>,
    places: Places,
}

/// Three nodes, and the rows that turn a direction into its coordinates in their directions.
struct Triangle {
    corners: [usize; 3],
    rows: [[f64; 3]; 3],
}

impl Interpolant {
    /// Joins the samples of a view.
    pub fn new(samples: &[Sample]) -> Self {
        let Net { nodes, .. } = net(samples);
        let corners = triangulate(&nodes);
        let triangle = |t: &[usize]| Triangle::new(&nodes, [t[0], t[1], t[2]]);
        let triangles: Vec<Triangle> = corners.chunks_exact(3).filter_map(triangle).collect();
        let places = Places::new(&nodes, &triangles);
        Self { nodes, triangles, places }
    }

    /// Values of f at directions. Of several triangles that hold one, the first is taken from that of the direction before on.
    pub fn values(&self, directions: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut last = 0;
        let value = |d: &[f64; 3]| {
            let near = self.places.near(d);
            let (before, after) = near.split_at(near.partition_point(|&n| n < last));
            let found =
                after.iter().chain(before).find_map(|&n| self.triangles[n].coordinates(d).map(|b| (n, b)));
            let mut rgb = [0.0; 3];
            if let Some((n, bary)) = found {
                last = n;
                for (corner, share) in self.triangles[n].corners.into_iter().zip(bary) {
                    (0..3).for_each(|c| rgb[c] += share * libm::exp(self.nodes[corner].log_rgb[c]));
                }
            } else if let Some(node) = nearest(d, &self.nodes) {
                // Between the ghosts and the horizon.
                rgb = node.log_rgb.map(libm::exp);
            }
            rgb.map(|v| if v > 2.0 * LEAST { v } else { 0.0 })
        };
        directions.iter().map(value).collect()
    }
}

/// The triangles that may reach into each square of a grid over x and y, numbers rising.
struct Places {
    /// Squares along an edge of [-1, 1].
    edge: usize,
    squares: Vec<Vec<usize>>,
}

impl Places {
    /// About as many squares as triangles.
    fn new(nodes: &[Node], triangles: &[Triangle]) -> Self {
        let edge = (libm::sqrt(triangles.len() as f64) as usize).clamp(1, 512);
        let mut places = Self { edge, squares: vec![Vec::new(); edge * edge] };
        for (n, triangle) in triangles.iter().enumerate() {
            let corners = triangle.corners.map(|corner| nodes[corner].direction);
            // No point of a triangle on the sphere is further from its middle than a corner is.
            let sum = [0, 1, 2].map(|k| corners[0][k] + corners[1][k] + corners[2][k]);
            let length = libm::sqrt(distance_squared(&sum, &[0.0; 3]));
            let middle = sum.map(|v| v / length);
            let far = corners.iter().map(|c| distance_squared(c, &middle)).fold(0.0, f64::max);
            let radius = libm::sqrt(far) + 1e-6;
            let [columns, rows] =
                [0, 1].map(|k| places.place(middle[k] - radius)..=places.place(middle[k] + radius));
            for row in rows {
                columns.clone().for_each(|column| places.squares[row * edge + column].push(n));
            }
        }
        places
    }

    /// The column or row of a coordinate.
    fn place(&self, x: f64) -> usize {
        ((0.5 * (x + 1.0) * self.edge as f64) as usize).min(self.edge - 1)
    }

    fn near(&self, d: &[f64; 3]) -> &[usize] {
        &self.squares[self.place(d[1]) * self.edge + self.place(d[0])]
    }
}

impl Triangle {
    fn new(nodes: &[Node], corners: [usize; 3]) -> Option<Self> {
        let [a, b, c] = corners.map(|n| nodes[n].direction);
        let cross = |p: [f64; 3], q: [f64; 3]| {
            [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
        };
        let rows = [cross(b, c), cross(c, a), cross(a, b)];
        let volume: f64 = (0..3).map(|k| a[k] * rows[0][k]).sum();
        (volume.abs() > 1e-12).then(|| Self { corners, rows: rows.map(|row| row.map(|v| v / volume)) })
    }

    /// Barycentric coordinates of a direction, if it lies within.
    fn coordinates(&self, d: &[f64; 3]) -> Option<[f64; 3]> {
        let raw = self.rows.map(|row| row[0] * d[0] + row[1] * d[1] + row[2] * d[2]);
        let sum: f64 = raw.iter().sum();
        raw.iter().all(|&v| v >= -1e-9).then(|| raw.map(|v| v / sum))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::direction;
    use crate::table::interpolate::tests::grid;

    #[test]
    fn values_in_between_are_those_of_the_samples_and_linear() {
        let samples = grid(|d| 0.2 + d[2] + 0.3 * d[0]);
        let interpolant = Interpolant::new(&samples);
        let at: Vec<[f64; 3]> = samples.iter().map(|s| s.direction).collect();
        for (s, v) in samples.iter().zip(interpolant.values(&at)) {
            assert!((v[1] - s.rgb[1]).abs() < 1e-9, "{s:?} {v:?}");
        }
        let between: Vec<[f64; 3]> =
            (0..500).map(|i| direction(1.2 * (0.618 * f64::from(i)).fract(), 0.1 * f64::from(i))).collect();
        for (d, v) in between.iter().zip(interpolant.values(&between)) {
            assert!((v[0] - (0.2 + d[2] + 0.3 * d[0])).abs() < 0.01, "{d:?} {v:?}");
        }
    }

    #[test]
    fn the_triangle_of_a_direction_is_found_wherever_it_lies() {
        for samples in [grid(|d| d[2]), grid(|d| d[2]).split_off(186)] {
            let interpolant = Interpolant::new(&samples);
            for i in 0..2000 {
                let d = direction(1.6 * (0.618 * f64::from(i)).fract(), 0.1 * f64::from(i));
                let holds = |n: &usize| interpolant.triangles[*n].coordinates(&d).is_some();
                let all: Vec<usize> = (0..interpolant.triangles.len()).filter(holds).collect();
                let near: Vec<usize> = interpolant.places.near(&d).iter().copied().filter(holds).collect();
                assert_eq!(near, all, "{d:?}");
            }
        }
    }
}
