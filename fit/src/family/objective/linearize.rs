//! Gradient and Gauss-Newton matrix of the objective.
//!
//! A view depends on the stored views round it. Its matrix is summed over its samples first (`data_term`), by derivatives of
//! unit lobes. It is then spread over its unknowns, and at last over those of the stored views.

use super::data_term;
use super::{Data, Objective, Weights};
use crate::family::layout::{COLOR_SLOPES, Layout, Views, rgb};
use crate::family::lobes::Lobes;
use crate::family::matrix::{Block, Matrix};
use crate::family::unit::dot;
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
    fn add(&mut self, layout: &Layout<V>, block: Block<V::Place>) {
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
            let row = |a: f64| {
                let excess = self.excess(a);
                (excess, if excess > 0.0 { self.excess(a + 1.0) - excess } else { 0.0 })
            };
            self.add_albedo(&mut block, &q, None, albedo.map(row));
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

        let data_term::Sums { cost, gram, moment } = data_term::sums(&lobes, &amplitude, &view.panels);

        // From derivatives of unit lobes to derivatives by the unknowns.
        let width = lobes.slopes_len();
        let mut block = Block { cost, ..Block::zeros(view.place, p) };
        let targets = self.columns(width, &q);
        for &(a, i, by) in &targets {
            block.gradient[a] += (0..3).map(|c| by[c] * moment[c][i]).sum::<f64>();
            let (from, to) = (&gram[i * width..(i + 1) * width], &mut block.matrix[a * p..(a + 1) * p]);
            // Several derivatives may be of one unknown: the squeeze is shared.
            for &(b, j, other) in &targets {
                to[b] += dot(&by, &other) * from[j];
            }
        }
        (0..p).for_each(|i| block.scale[i] = block.matrix[i * p + i]);
        let albedo = layout.albedo(&q, view.factors.as_deref());
        let residuals = self.energy_residuals(albedo, view, energy);
        self.add_albedo(&mut block, &q, view.factors.as_deref(), residuals);
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

    /// Adds the squares of residuals of the channels' albedos, each with its derivative by the albedo, to a view.
    fn add_albedo(
        &self,
        block: &mut Block<V::Place>,
        q: &[f64],
        factors: Option<&[[f64; 3]]>,
        residuals: [(f64, f64); 3],
    ) {
        let layout = &self.layout;
        let p = layout.stride();
        let mut row = Vec::with_capacity(4 * layout.lobes + 3);
        for k in 0..=layout.lobes {
            let [luminance, red, blue] = layout.tint(k);
            let factor = factors.map_or([1.0; 3], |factors| factors[k]);
            let color = rgb([luminance, red, blue].map(|i| q[i]));
            let (integral, slope) =
                if k < layout.lobes { sphere_integral(q[layout.sharpness(k)]) } else { (1.0, 0.0) };
            let copies = if k < layout.lobes { layout.copies(k) } else { 1.0 };
            let by = |size: f64, color: [f64; 3]| {
                [0, 1, 2].map(|c| residuals[c].1 * factor[c] * copies * size * color[c])
            };
            if k < layout.lobes {
                row.push((layout.sharpness(k), by(slope, color)));
            }
            let y = libm::exp(q[luminance]) * integral;
            row.push((luminance, by(integral, color)));
            row.push((red, by(y, COLOR_SLOPES[0])));
            row.push((blue, by(y, COLOR_SLOPES[1])));
        }
        let residuals = residuals.map(|r| r.0);
        block.cost += dot(&residuals, &residuals);
        for &(i, a) in &row {
            block.gradient[i] += dot(&a, &residuals);
            let to = &mut block.matrix[i * p..(i + 1) * p];
            row.iter().for_each(|&(j, b)| to[j] += dot(&a, &b));
        }
    }
}
