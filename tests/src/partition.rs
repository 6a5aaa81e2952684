//! Bins for chi-square that follow a mixture: cells of the sphere, split in 3 by 3 until none holds much of the density,
//! each with its exact share. Fixed bins are blind to a sharp lobe inside one of them.

use crate::statistics::{ChiSquare, chi_square};
use glam::{DVec3, Vec3};
use srbf_core::{AnyMixture, Domain};
use std::f64::consts::PI;

/// Largest share of the density that a bin may hold.
const LARGEST: f64 = 0.01;
/// Deepest split: 3^13 cells along each side.
const DEEPEST: usize = 13;

/// A cell in polar angle and azimuth.
#[derive(Clone, Copy, Debug)]
struct Cell {
    theta: [f64; 2],
    phi: [f64; 2],
}

impl Cell {
    fn at(&self, x: f64, y: f64) -> DVec3 {
        let (r, z) = (self.theta[0] + x * (self.theta[1] - self.theta[0])).sin_cos();
        let phi = self.phi[0] + y * (self.phi[1] - self.phi[0]);
        DVec3::new(r * phi.cos(), r * phi.sin(), z)
    }
    fn child(&self, i: usize) -> Self {
        let part = |[a, b]: [f64; 2], i: usize| {
            let edge = |j: usize| if j == 3 { b } else { a + (b - a) * j as f64 / 3.0 };
            [edge(i), edge(i + 1)]
        };
        Self { theta: part(self.theta, i / 3), phi: part(self.phi, i % 3) }
    }
    fn area(&self) -> f64 {
        (self.theta[1] - self.theta[0]) * (self.phi[1] - self.phi[0])
    }
}

#[derive(Clone, Debug)]
enum Node {
    /// Nine children.
    Split(Box<[Node; 9]>),
    /// A bin by its number.
    Bin(usize),
}

/// The bins of one mixture.
#[derive(Clone, Debug)]
pub struct Partition {
    root: Cell,
    tree: Node,
    share: Vec<f64>,
}

/// The parts of the density, round which cells must be fine.
struct Feature {
    axis: DVec3,
    width: f64,
    /// Place of the frame that it is in.
    frame: usize,
}

/// How lobes see directions: turned, and squeezed along and across.
#[derive(Clone, Copy)]
struct Frame {
    azimuth: [f64; 2],
    squeeze: [f64; 2],
}

impl Frame {
    fn see(&self, d: DVec3) -> DVec3 {
        let ([c, s], [along, across]) = (self.azimuth, self.squeeze);
        DVec3::new((d.x * c + d.y * s) / along, (d.y * c - d.x * s) / across, d.z).normalize()
    }
}

struct Builder<'a, F> {
    pdf: F,
    features: Vec<Feature>,
    /// Of each mixture, for round lobes and for squeezed ones.
    frames: Vec<Frame>,
    share: &'a mut Vec<f64>,
}

impl<F: Fn(Vec3) -> f32> Builder<'_, F> {
    /// Which of the features reach into the cell, and whether the density may vary too fast over it for nine points.
    fn look(&self, cell: &Cell, near: &[usize]) -> (Vec<usize>, bool) {
        let rim =
            [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0), (0.5, 0.0), (0.0, 0.5), (1.0, 0.5), (0.5, 1.0)]
                .map(|(x, y)| cell.at(x, y));
        // Chords stand for angles: of a quarter turn and more they are too short.
        let chord = |frame: &Frame| {
            let middle = frame.see(cell.at(0.5, 0.5));
            let radius = rim.iter().map(|d| (middle - frame.see(*d)).length()).fold(0.0, f64::max);
            (middle, if radius > 1.0 { 4.0 } else { 1.1 * radius })
        };
        let seen: Vec<(DVec3, f64)> = self.frames.iter().map(chord).collect();
        let is_coarse = |(frame, (_, radius)): (&Frame, &(DVec3, f64))| {
            *radius > if frame.squeeze == [1.0; 2] { 0.3 } else { 0.2 }
        };
        let mut coarse = self.frames.iter().zip(&seen).any(is_coarse);
        let mut inside = Vec::with_capacity(near.len());
        for &k in near {
            let f = &self.features[k];
            let (middle, radius) = seen[f.frame];
            let reach = radius + 6.0 * f.width;
            if (middle - f.axis).length_squared() < reach * reach {
                inside.push(k);
                coarse |= radius > 0.6 * f.width;
            }
        }
        (inside, coarse)
    }

    fn mass(&self, cell: &Cell) -> f64 {
        const GAUSS: [(f64, f64); 3] =
            [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];
        let mut sum = 0.0;
        for (x, wx) in GAUSS {
            for (y, wy) in GAUSS {
                let d = cell.at(x, y);
                sum += wx * wy * d.x.hypot(d.y) * f64::from((self.pdf)(d.as_vec3()));
            }
        }
        sum * cell.area()
    }

    /// Splits, and gives the node and its share; a node of a small share becomes one bin whatever is below it.
    fn build(&mut self, cell: &Cell, near: &[usize], depth: usize) -> (Node, f64) {
        let first = self.share.len();
        let (near, coarse) = self.look(cell, near);
        let rough = if depth < DEEPEST && coarse { None } else { Some(self.mass(cell)) };
        if let Some(share) = rough
            && (share <= LARGEST || depth == DEEPEST)
        {
            self.share.push(share);
            return (Node::Bin(first), share);
        }
        let built: [(Node, f64); 9] = std::array::from_fn(|i| self.build(&cell.child(i), &near, depth + 1));
        let share = built.iter().map(|(_, share)| share).sum();
        if share <= LARGEST {
            self.share.truncate(first);
            self.share.push(share);
            return (Node::Bin(first), share);
        }
        (Node::Split(Box::new(built.map(|(node, _)| node))), share)
    }
}

impl Partition {
    /// Splits the domain of a mixture by its density.
    pub fn new(m: &AnyMixture<'_>, pdf: impl Fn(Vec3) -> f32) -> Self {
        Self::of_all(&[m], pdf)
    }

    /// Splits the domain of mixtures by a density that has features of all of them.
    pub fn of_all(mixtures: &[&AnyMixture<'_>], pdf: impl Fn(Vec3) -> f32) -> Self {
        let (mut frames, mut features) = (Vec::new(), Vec::new());
        for m in mixtures {
            let azimuth = m.azimuth_cos_sin().map(f64::from);
            let squeeze = [m.squeeze_along(), m.squeeze()].map(f64::from);
            let (turned, squeezed) = (frames.len(), frames.len() + 1);
            frames.extend([Frame { azimuth, squeeze: [1.0; 2] }, Frame { azimuth, squeeze }]);
            features.extend((0..m.len()).flat_map(|k| {
                let g = m.lobe(k).expect("lobe").gaussian;
                let width = (1.0 / f64::from(g.sharpness).sqrt()).min(0.5);
                let axis = g.axis.as_dvec3();
                let image = DVec3::new(axis.x, axis.y, -axis.z);
                let frame = if k < m.squeezed_len() { squeezed } else { turned };
                [axis, image].map(|axis| Feature { axis, width, frame })
            }));
            // The change of solid angle is steep where the squeeze gathers directions: where the direction is multiplied most.
            for (axis, c) in [(DVec3::X, squeeze[0]), (DVec3::Y, squeeze[1])] {
                if c < 1.0 {
                    features.extend([axis, -axis].map(|axis| Feature { axis, width: c, frame: squeezed }));
                }
            }
            let widest = squeeze[0].max(squeeze[1]);
            if widest > 1.0 {
                // Widened, the horizon's surroundings are gathered at the normal.
                features.push(Feature { axis: DVec3::Z, width: 1.0 / widest, frame: squeezed });
            }
        }
        let upper = mixtures.iter().all(|m| m.domain() == Domain::Hemisphere);
        let root = Cell { theta: [0.0, if upper { 0.5 * PI } else { PI }], phi: [-PI, PI] };
        let mut share = Vec::new();
        let all: Vec<usize> = (0..features.len()).collect();
        let (tree, _) = Builder { pdf, features, frames, share: &mut share }.build(&root, &all, 0);
        Self { root, tree, share }
    }

    /// Integral of the density over all bins: 1 for a density.
    pub fn total(&self) -> f64 {
        self.share.iter().sum()
    }

    /// Number of bins.
    pub fn len(&self) -> usize {
        self.share.len()
    }

    /// Whether there is no bin.
    pub fn is_empty(&self) -> bool {
        self.share.is_empty()
    }

    /// Number of the bin that holds a direction.
    pub fn locate(&self, d: Vec3) -> usize {
        let d = d.as_dvec3();
        let theta = d.x.hypot(d.y).atan2(d.z);
        let phi = d.y.atan2(d.x);
        let (mut node, mut cell) = (&self.tree, self.root);
        loop {
            match node {
                Node::Bin(i) => return *i,
                Node::Split(children) => {
                    // The edges of `child` decide, not a division that rounds differently.
                    let third = |x: f64, [a, b]: [f64; 2]| {
                        usize::from(x >= a + (b - a) * 1.0 / 3.0) + usize::from(x >= a + (b - a) * 2.0 / 3.0)
                    };
                    let i = 3 * third(theta, cell.theta) + third(phi, cell.phi);
                    (node, cell) = (&children[i], cell.child(i));
                }
            }
        }
    }

    /// Draws `n` directions and compares their counts with the shares.
    pub fn test(&self, n: usize, mut draw: impl FnMut() -> Vec3) -> ChiSquare {
        let mut observed = vec![0.0; self.len()];
        for _ in 0..n {
            observed[self.locate(draw())] += 1.0;
        }
        let expected: Vec<f64> = self.share.iter().map(|s| s * n as f64).collect();
        chi_square(&observed, &expected)
    }
}
