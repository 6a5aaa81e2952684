//! Gradient and Gauss-Newton matrix of the objective.
//!
//! A view depends on the two stored views round it. Its matrix is summed over its samples first (`data_term`), by derivatives of
//! unit lobes. It is then spread over its unknowns, and at last over those of the stored views.

use super::data_term;
use super::{Data, Objective, Weights};
use crate::family::layout::{COLOR_SLOPES, rgb};
use crate::family::lobes::Lobes;
use crate::numeric::banded::Banded;
use crate::numeric::special::sphere_integral;
use rayon::prelude::*;

/// Linearisation in one view: half the gradient, and the upper half of the Gauss-Newton matrix, by its unknowns.
struct Block {
    place: (usize, f64),
    /// Diagonal of the data term.
    scale: Vec<f64>,
    cost: f64,
    gradient: Vec<f64>,
    matrix: Vec<f64>,
}

impl Block {
    /// Makes the lower half of the matrix that of the upper.
    fn mirror(&mut self) {
        let p = self.gradient.len();
        for i in 0..p {
            for j in 0..i {
                self.matrix[i * p + j] = self.matrix[j * p + i];
            }
        }
    }
}

/// Views of which the matrices are there at a time: with 64 lobes each has 0.8 MB.
const TOGETHER: usize = 16;

/// The whole problem linearised at a point.
pub(crate) struct Linearized {
    pub cost: f64,
    pub gradient: Vec<f64>,
    pub matrix: Banded,
    /// Diagonal of the matrix without the albedo terms, to which damping is relative: those terms are stiff in one direction
    /// and must not hold up the others.
    pub scale: Vec<f64>,
    /// Room for the matrix with damping, from the first step on. Matrices of 64 lobes have 28 MB each, and an allocator that gets
    /// and gives them at every step keeps some times as much.
    pub damped: Option<Banded>,
}

impl Linearized {
    /// Zeros for unknowns of which a view has `p`.
    fn zeros(unknowns: usize, p: usize) -> Self {
        Self {
            cost: 0.0,
            gradient: vec![0.0; unknowns],
            scale: vec![0.0; unknowns],
            matrix: Banded::zeros(unknowns, (2 * p).min(unknowns - 1)),
            damped: None,
        }
    }

    /// Zeros again, in the same memory.
    pub fn cleared(mut self) -> Self {
        self.cost = 0.0;
        self.gradient.fill(0.0);
        self.scale.fill(0.0);
        self.matrix.clear();
        self
    }

    /// Adds a view to the stored views round it.
    fn add(&mut self, mut block: Block) {
        block.mirror();
        let p = block.gradient.len();
        self.cost += block.cost;
        let (stored, blend) = block.place;
        let ends = [(stored, 1.0 - blend), (stored + 1, blend)];
        for (a, (stored_a, share_a)) in ends.into_iter().enumerate().filter(|e| e.1.1 > 0.0) {
            for i in 0..p {
                self.gradient[stored_a * p + i] += share_a * block.gradient[i];
                self.scale[stored_a * p + i] += share_a * share_a * block.scale[i];
            }
            for (stored_b, share_b) in ends.into_iter().take(a + 1).filter(|e| e.1 > 0.0) {
                let share = share_a * share_b;
                for j in 0..p {
                    let start = if stored_a == stored_b { j } else { 0 };
                    let row = &block.matrix[j * p + start..(j + 1) * p];
                    self.matrix.add_run(stored_a * p + start, stored_b * p + j, share, row);
                }
            }
        }
    }
}

impl Objective {
    /// The problem linearised at a point. The cost is that of [`cost`](Self::cost).
    pub fn linearize(&self, x: &[f64], weights: Weights) -> Linearized {
        self.linearize_onto(x, weights, Linearized::zeros(self.layout.len(), self.layout.stride()))
    }

    /// The same, summed on zeros.
    pub fn linearize_onto(&self, x: &[f64], weights: Weights, mut sum: Linearized) -> Linearized {
        let layout = &self.layout;
        let p = layout.stride();
        for views in self.views.chunks(TOGETHER) {
            let view = |view| self.linearize_view(view, x, weights.energy);
            let blocks: Vec<Block> = views.par_iter().map(view).collect();
            blocks.into_iter().for_each(|block| sum.add(block));
        }
        for &place in &self.watched {
            let mut q = vec![0.0; p];
            layout.interpolate(x, place, &mut q);
            let albedo = layout.albedo(&q, None);
            if albedo.iter().all(|a| self.excess(*a) == 0.0) {
                continue;
            }
            let mut block = Block {
                place,
                scale: vec![0.0; p],
                cost: 0.0,
                gradient: vec![0.0; p],
                matrix: vec![0.0; p * p],
            };
            for (channel, &a) in albedo.iter().enumerate() {
                let excess = self.excess(a);
                if excess > 0.0 {
                    let slope = self.excess(a + 1.0) - excess;
                    self.add_albedo_row(&mut block, &q, (channel, None), (excess, slope));
                }
            }
            sum.add(block);
        }
        self.for_each_difference(weights.smoothness, |terms| {
            let r: f64 = terms.iter().map(|&(index, factor)| factor * x[index]).sum();
            sum.cost += r * r;
            for (a, &(i, fi)) in terms.iter().enumerate() {
                sum.gradient[i] += fi * r;
                sum.scale[i] += fi * fi;
                for &(j, fj) in &terms[..=a] {
                    sum.matrix.add(i, j, fi * fj);
                }
            }
        });
        sum
    }

    fn linearize_view(&self, view: &Data, x: &[f64], energy: f64) -> Block {
        let layout = &self.layout;
        let p = layout.stride();
        let mut q = vec![0.0; p];
        layout.interpolate(x, view.place, &mut q);
        let lobes = Lobes::new(layout, &q);
        let amplitude = layout.amplitudes(&q);

        let data_term::Sums { cost, gram, moment } = data_term::sums(&lobes, &amplitude, &view.points);

        // From derivatives of unit lobes to derivatives by the unknowns.
        let width = lobes.slopes_len();
        let mut block = Block {
            place: view.place,
            scale: vec![0.0; p],
            cost,
            gradient: vec![0.0; p],
            matrix: vec![0.0; p * p],
        };
        let columns = self.columns(width, &q);
        for c in 0..3 {
            let targets: Vec<(usize, usize, f64)> =
                columns.iter().map(|&(a, i, by)| (a, i, by[c])).filter(|target| target.2 != 0.0).collect();
            for (n, &(a, i, by)) in targets.iter().enumerate() {
                block.gradient[a] += by * moment[c][i];
                for (m, &(b, j, other)) in targets[..=n].iter().enumerate() {
                    let value = by * other * gram[i.max(j) * width + i.min(j)];
                    // Both (i, j) and (j, i) of the Gram matrix may fall on one element: the squeeze is shared.
                    let both = if a == b && m < n { 2.0 } else { 1.0 };
                    block.matrix[a.min(b) * p + a.max(b)] += both * value;
                }
            }
        }
        (0..p).for_each(|i| block.scale[i] = block.matrix[i * p + i]);
        let albedo = layout.albedo(&q, view.factors.as_deref());
        for (c, row) in self.energy_residuals(albedo, view, energy).into_iter().enumerate() {
            self.add_albedo_row(&mut block, &q, (c, view.factors.as_deref()), row);
        }
        block
    }

    /// For every unknown of a view the derivative of unit lobes that it goes with, and the colour that this is multiplied by.
    fn columns(&self, width: usize, q: &[f64]) -> Vec<(usize, usize, [f64; 3])> {
        let layout = &self.layout;
        let k = layout.lobes;
        let off_plane = 3 * k + layout.squeezed;
        let color = |lobe: usize| rgb(layout.tint(lobe).map(|i| q[i]));
        let mut columns = Vec::with_capacity(width + 2 * k + 2);
        for i in 0..width {
            let lobe = match i {
                _ if i == width - 1 => k,
                _ if i >= off_plane => layout.first_mirrored() + i - off_plane,
                _ => i % k,
            };
            match i / k {
                _ if i != width - 1 && i >= off_plane => {
                    columns.push((layout.off_plane(i - off_plane), i, color(lobe)))
                }
                0 if i != width - 1 => columns.push((layout.angle(lobe), i, color(lobe))),
                1 if i != width - 1 => columns.push((layout.sharpness(lobe), i, color(lobe))),
                3.. if i != width - 1 => columns.push((0, i, color(lobe))),
                // The value itself: luminance and colour.
                _ => {
                    let [luminance, red, blue] = layout.tint(lobe);
                    let y = libm::exp(q[luminance]);
                    columns.push((luminance, i, color(lobe)));
                    columns.push((red, i, COLOR_SLOPES[0].map(|s| y * s)));
                    columns.push((blue, i, COLOR_SLOPES[1].map(|s| y * s)));
                }
            }
        }
        columns
    }

    /// Adds the square of a residual of one channel's albedo, of which the derivative by the albedo is given, to a view.
    fn add_albedo_row(
        &self,
        block: &mut Block,
        q: &[f64],
        (channel, factors): (usize, Option<&[[f64; 3]]>),
        (residual, by_albedo): (f64, f64),
    ) {
        let layout = &self.layout;
        let p = layout.stride();
        let mut row = Vec::with_capacity(4 * layout.lobes + 3);
        for k in 0..=layout.lobes {
            let [luminance, red, blue] = layout.tint(k);
            let by = by_albedo * factors.map_or(1.0, |factors| factors[k][channel]);
            let color = by * rgb([luminance, red, blue].map(|i| q[i]))[channel];
            let (integral, slope) =
                if k < layout.lobes { sphere_integral(q[layout.sharpness(k)]) } else { (1.0, 0.0) };
            let copies = if k < layout.lobes { layout.copies(k) } else { 1.0 };
            if k < layout.lobes {
                row.push((layout.sharpness(k), color * copies * slope));
            }
            row.push((luminance, color * copies * integral));
            let y = by * libm::exp(q[luminance]) * copies * integral;
            row.push((red, y * COLOR_SLOPES[0][channel]));
            row.push((blue, y * COLOR_SLOPES[1][channel]));
        }
        block.cost += residual * residual;
        for &(i, a) in &row {
            block.gradient[i] += a * residual;
            for &(j, b) in row.iter().filter(|e| e.0 <= i) {
                block.matrix[j * p + i] += a * b;
            }
        }
    }
}
