//! Gradient and Gauss-Newton matrix of the objective.
//!
//! A view depends on the stored views round it. Its matrix is summed over its samples first (`data_term`), by derivatives of
//! unit lobes. It is then spread over its unknowns, and at last over those of the stored views.

use super::data_term;
use super::{Data, Objective, Weights};
use crate::family::layout::{COLOR_SLOPES, Layout, Views, rgb};
use crate::family::lobes::Lobes;
use crate::family::matrix::{Block, Matrix};
use crate::numeric::special::sphere_integral;
use rayon::prelude::*;

/// Views of which the matrices are there at a time: with 64 lobes each has 0.8 MB.
const TOGETHER: usize = 16;

/// The whole problem linearised at a point.
pub(crate) struct Linearized<V: Views> {
    pub cost: f64,
    pub gradient: Vec<f64>,
    pub matrix: V::Matrix,
}

impl<V: Views> Linearized<V> {
    fn zeros(layout: &Layout<V>) -> Self {
        Self { cost: 0.0, gradient: vec![0.0; layout.len()], matrix: V::Matrix::zeros(layout) }
    }

    /// Zeros again.
    pub fn cleared(mut self, layout: &Layout<V>) -> Self {
        self.gradient.fill(0.0);
        Self { cost: 0.0, gradient: self.gradient, matrix: self.matrix.cleared(layout) }
    }

    /// Adds a view to the stored views round it.
    fn add(&mut self, layout: &Layout<V>, mut block: Block<V::Place>) {
        block.mirror();
        self.cost += block.cost;
        self.matrix.add_view(layout, &block, &mut self.gradient);
    }
}

impl<V: Views> Objective<V> {
    /// The problem linearised at a point. The cost is that of [`cost`](Self::cost).
    pub fn linearize(&self, x: &[f64], weights: Weights) -> Linearized<V> {
        self.linearize_onto(x, weights, Linearized::zeros(&self.layout))
    }

    /// The same, summed on zeros.
    pub fn linearize_onto(&self, x: &[f64], weights: Weights, mut sum: Linearized<V>) -> Linearized<V> {
        let layout = &self.layout;
        let p = layout.stride();
        for views in self.views.chunks(TOGETHER) {
            let view = |view| self.linearize_view(view, x, weights.energy);
            let blocks: Vec<Block<V::Place>> = views.par_iter().map(view).collect();
            blocks.into_iter().for_each(|block| sum.add(layout, block));
        }
        for &place in &self.watched {
            let mut q = vec![0.0; p];
            layout.interpolate(x, place, &mut q);
            let albedo = layout.albedo(&q, None);
            if albedo.iter().all(|a| self.excess(*a) == 0.0) {
                continue;
            }
            let mut block = Block::zeros(place, p);
            for (channel, &a) in albedo.iter().enumerate() {
                let excess = self.excess(a);
                if excess > 0.0 {
                    let slope = self.excess(a + 1.0) - excess;
                    self.add_albedo_row(&mut block, &q, (channel, None), (excess, slope));
                }
            }
            sum.add(layout, block);
        }
        V::differences(layout, weights.smoothness, |terms| {
            let r: f64 = terms.iter().map(|&(index, factor)| factor * x[index]).sum();
            sum.cost += r * r;
            terms.iter().for_each(|&(i, factor)| sum.gradient[i] += factor * r);
            sum.matrix.add_row(terms);
        });
        sum
    }

    fn linearize_view(&self, view: &Data<V>, x: &[f64], energy: f64) -> Block<V::Place> {
        let layout = &self.layout;
        let p = layout.stride();
        let mut q = vec![0.0; p];
        layout.interpolate(x, view.place, &mut q);
        let lobes = Lobes::new(layout, &q);
        let amplitude = layout.amplitudes(&q);

        let data_term::Sums { cost, gram, moment } = data_term::sums(&lobes, &amplitude, &view.points);

        // From derivatives of unit lobes to derivatives by the unknowns.
        let width = lobes.slopes_len();
        let mut block = Block { cost, ..Block::zeros(view.place, p) };
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
        let (k, squeezes) = (layout.lobes, layout.squeezes());
        let colors: Vec<[f64; 3]> = (0..=k).map(|lobe| rgb(layout.tint(lobe).map(|i| q[i]))).collect();
        // Luminance and colour go with the value itself.
        let tint = |lobe: usize, column: usize| {
            let [luminance, red, blue] = layout.tint(lobe);
            let y = libm::exp(q[luminance]);
            let slopes = COLOR_SLOPES.map(|slopes| slopes.map(|slope| y * slope));
            [(luminance, column, colors[lobe]), (red, column, slopes[0]), (blue, column, slopes[1])]
        };
        let mut columns = Vec::with_capacity(width + 2 * k + 2);
        columns.extend((0..k).map(|lobe| (layout.angle(lobe), lobe, colors[lobe])));
        columns.extend((0..k).map(|lobe| (layout.sharpness(lobe), k + lobe, colors[lobe])));
        columns.extend((0..k).flat_map(|lobe| tint(lobe, 2 * k + lobe)));
        let squeezed = 0..squeezes * layout.squeezed;
        columns.extend(squeezed.map(|n| (n % squeezes, 3 * k + n, colors[n / squeezes])));
        let off_plane = 3 * k + squeezes * layout.squeezed;
        let first = layout.first_aside();
        columns.extend((0..layout.aside).map(|m| (layout.off_plane(m), off_plane + m, colors[first + m])));
        columns.extend(tint(k, width - 1));
        columns
    }

    /// Adds the square of a residual of one channel's albedo, of which the derivative by the albedo is given, to a view.
    fn add_albedo_row(
        &self,
        block: &mut Block<V::Place>,
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
