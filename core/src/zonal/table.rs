//! Any zonal kernel as a table: sampled by inversion, with the density that its samples really have.

use super::around::unit;
use super::kernel::Kernel;
use crate::error::Error;
use crate::float;
use core::f32::consts::PI;
use glam::Vec3;

/// A kernel given as a function, tabulated at `N` angles: linear in `w = 1 - cos theta` between them.
///
/// The knots are `w = 0` and then a geometric row from 2^-36 to 2. So a kernel of any sharpness up to 1e8 is met in its own scale;
/// with N = 256 they are 10 % apart and a Gaussian is followed within 0.2 % of its peak. Value, density, integral and samples are
/// all those of the tabulated kernel: an estimator that divides by [`Kernel::pdf`] has no bias.
///
/// ```
/// use srbf_core::{Kernel, KernelTable, Vec3};
///
/// // A cosine lobe to the tenth power.
/// let table = KernelTable::<256>::new(Vec3::Z, |w| (1.0 - w).max(0.0).powi(10))?;
/// assert!((table.integral() / (2.0 * std::f32::consts::PI / 11.0) - 1.0).abs() < 0.01);
/// assert!(table.sample([0.5, 0.2]).z > 0.5);
/// # Ok::<(), srbf_core::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct KernelTable<const N: usize> {
    axis: Vec3,
    /// `1 - cos theta` of the knots.
    knot: [f32; N],
    value: [f32; N],
    /// Share of the integral up to a knot.
    cumulative: [f32; N],
    integral: f32,
}

impl<const N: usize> KernelTable<N> {
    /// Tabulates a kernel, given as a function of `w = 1 - cos theta` in [0, 2], round an axis.
    ///
    /// # Errors
    /// [`Error::Axis`]; [`Error::Kernel`] if a value is negative or not finite, or a slope, or the integral
    /// is 0 or infinite.
    pub fn new(axis: impl Into<Vec3>, kernel: impl Fn(f32) -> f32) -> Result<Self, Error> {
        const { assert!(N >= 3) };
        let axis = unit(axis.into()).ok_or(Error::Axis)?;
        let mut table = Self { axis, knot: [0.0; N], value: [0.0; N], cumulative: [0.0; N], integral: 0.0 };
        let octaves = 37.0 / (N - 2) as f32;
        for i in 0..N {
            let w = match i {
                0 => 0.0,
                _ if i == N - 1 => 2.0,
                _ => 2.0 * float::exp2(octaves * i as f32 - octaves * (N - 1) as f32),
            };
            let value = kernel(w);
            if !(0.0..f32::INFINITY).contains(&value) {
                return Err(Error::Kernel);
            }
            (table.knot[i], table.value[i]) = (w, value);
        }
        let mut sum = 0.0;
        for i in 1..N {
            let width = table.knot[i] - table.knot[i - 1];
            if !table.line(i - 1).1.is_finite() {
                return Err(Error::Kernel);
            }
            sum += width * (0.5 * table.value[i] + 0.5 * table.value[i - 1]);
            table.cumulative[i] = sum;
        }
        table.integral = 2.0 * PI * sum;
        if !(sum > 0.0 && table.integral.is_finite()) {
            return Err(Error::Kernel);
        }
        table.cumulative.iter_mut().for_each(|c| *c = (*c / sum).min(1.0));
        Ok(table)
    }

    /// Last knot whose entry does not exceed `x`, never the very last one.
    fn cell(entries: &[f32; N], x: f32) -> usize {
        entries.partition_point(|&e| e <= x).clamp(1, N - 1) - 1
    }

    /// Kernel at a knot and its slope after it.
    fn line(&self, cell: usize) -> (f32, f32) {
        let width = self.knot[cell + 1] - self.knot[cell];
        (self.value[cell], (self.value[cell + 1] - self.value[cell]) / width)
    }
}

impl<const N: usize> Kernel for KernelTable<N> {
    fn axis(&self) -> Vec3 {
        self.axis
    }

    fn value_at(&self, chord_squared: f32) -> f32 {
        let w = (0.5 * chord_squared).min(2.0);
        let cell = Self::cell(&self.knot, w);
        let (value, slope) = self.line(cell);
        (value + slope * (w - self.knot[cell])).max(0.0)
    }

    fn integral(&self) -> f32 {
        self.integral
    }

    fn one_minus_cos(&self, u: f32) -> f32 {
        let cell = Self::cell(&self.cumulative, u);
        let (value, slope) = self.line(cell);
        // Solves mass = value x + slope x^2 / 2 in the form whose parts do not cancel.
        let mass = (u - self.cumulative[cell]) * (self.integral / (2.0 * PI));
        let root = float::sqrt((value * value + 2.0 * slope * mass).max(0.0));
        let x = if mass > 0.0 { 2.0 * mass / (value + root) } else { 0.0 };
        (self.knot[cell] + x).min(self.knot[cell + 1])
    }

    fn share_within(&self, one_minus_cos: f32) -> f32 {
        let cell = Self::cell(&self.knot, one_minus_cos);
        let (value, slope) = self.line(cell);
        let x = one_minus_cos - self.knot[cell];
        let mass = x * (value + 0.5 * slope * x);
        (self.cumulative[cell] + mass * (2.0 * PI / self.integral)).min(1.0)
    }
}
