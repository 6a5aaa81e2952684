//! The lobes of a view together: their values and derivatives at panels of directions.

use crate::family::layout::{Layout, Views};
use crate::family::unit::{Column, Directions, PANEL, Unit, ViewSqueeze};
use crate::numeric::vector::{exp_f32, fused_f32};
use std::f64::consts::FRAC_1_PI;

/// The lobes of one view, ready to be evaluated at many directions.
pub(crate) struct Lobes {
    squeezed: usize,
    aside: usize,
    squeeze: ViewSqueeze,
    lobes: Vec<Unit>,
}

/// Directions side by side.
pub(crate) struct Panel {
    round: Directions,
    squeezed: Directions,
}

impl Lobes {
    /// Prepares the interpolated unknowns `q` of a view.
    pub fn new<V: Views>(layout: &Layout<V>, q: &[f64]) -> Self {
        let squeeze = V::squeeze(q);
        let lobes = (0..layout.lobes).map(|k| V::unit(layout, q, k, &squeeze)).collect();
        Self { squeezed: layout.squeezed, aside: layout.aside, squeeze, lobes }
    }

    /// One lobe of a view alone, as number 0.
    pub fn alone<V: Views>(layout: &Layout<V>, q: &[f64], k: usize) -> Self {
        let squeeze = V::squeeze(q);
        let lobes = vec![V::unit(layout, q, k, &squeeze)];
        let aside = usize::from(k >= layout.first_aside());
        Self { squeezed: usize::from(k < layout.squeezed), aside, squeeze, lobes }
    }

    /// How many lobes there are, the diffuse term not counted.
    pub fn len(&self) -> usize {
        self.lobes.len()
    }

    /// Squeezed direction and change of solid angle.
    #[inline(always)]
    fn squeeze(&self, d: &[f64; 3]) -> ([f64; 3], f64) {
        let [xx, xy, yy] = self.squeeze.matrix;
        let (x, y) = (xx * d[0] + xy * d[1], xy * d[0] + yy * d[1]);
        let inverse = 1.0 / (x * x + y * y + d[2] * d[2]).sqrt();
        ([x * inverse, y * inverse, d[2] * inverse], self.squeeze.determinant * inverse * inverse * inverse)
    }

    /// Values of the unit lobes, and of the diffuse term of albedo 1, `cos / pi`. Shapes: `out` [K + 1], overwritten.
    #[inline(always)]
    pub fn values(&self, d: &[f64; 3], out: &mut [f64]) {
        let (u, j) = self.squeeze(d);
        for (k, (lobe, out)) in self.lobes.iter().zip(&mut *out).enumerate() {
            *out = if k < self.squeezed { j * lobe.value(&u) } else { lobe.value(d) };
        }
        out[self.len()] = d[2] * FRAC_1_PI;
    }

    /// Directions as the lobes see them.
    #[inline(always)]
    pub fn panel(&self, at: &[Column; 3]) -> Panel {
        let round = Directions { at: *at, jacobian: [1.0; PANEL] };
        let mut squeezed = Directions { at: *at, jacobian: [0.0; PANEL] };
        if self.squeezed > 0 {
            let [x, y, z] = at;
            for n in 0..PANEL {
                let (u, j) = self.squeeze(&[x[n], y[n], z[n]].map(f64::from));
                (0..3).for_each(|axis| squeezed.at[axis][n] = u[axis] as f32);
                squeezed.jacobian[n] = j as f32;
            }
        }
        Panel { round, squeezed }
    }

    /// Values of one unit lobe at a panel of directions; none if it is 0 at all of them.
    #[inline(always)]
    pub fn column(&self, k: usize, panel: &Panel) -> Option<Column> {
        let directions = if k < self.squeezed { &panel.squeezed } else { &panel.round };
        let lobe = &self.lobes[k];
        let mut sums = [0.0; PANEL];
        let mut exponents = [0.0; PANEL];
        let mut is_near = false;
        for axis in lobe.axes() {
            if lobe.exponents(axis, directions, &mut exponents) {
                is_near = true;
                for n in 0..PANEL {
                    sums[n] += directions.jacobian[n] * exp_f32(lobe.sharpness as f32 * exponents[n]);
                }
            }
        }
        is_near.then_some(sums)
    }

    /// [`values`](Self::values) at a panel of directions, summed over the lobes. Shapes: `amplitudes` [K + 1] per channel.
    #[inline(always)]
    pub fn sums(&self, panel: &Panel, amplitudes: &[Vec<f64>; 3]) -> [Column; 3] {
        let diffuse = |a: &Vec<f64>| {
            let radiance = (a[self.len()] * FRAC_1_PI) as f32;
            panel.round.at[2].map(|cos| radiance * cos)
        };
        let mut sums = [diffuse(&amplitudes[0]), diffuse(&amplitudes[1]), diffuse(&amplitudes[2])];
        for k in (0..self.len()).filter(|&k| amplitudes.iter().any(|a| a[k] != 0.0)) {
            let Some(value) = self.column(k, panel) else { continue };
            for (sum, amplitudes) in sums.iter_mut().zip(amplitudes) {
                let amplitude = amplitudes[k] as f32;
                sum.iter_mut().zip(&value).for_each(|(sum, v)| *sum = fused_f32(amplitude, *v, *sum));
            }
        }
        sums
    }

    /// Numbers of the squeeze, Q.
    fn squeezes(&self) -> usize {
        if self.squeeze.growth.is_some() { 3 } else { 1 }
    }

    /// How many columns [`slopes`](Self::slopes) gives.
    pub fn slopes_len(&self) -> usize {
        3 * self.len() + self.squeezes() * self.squeezed + self.aside + 1
    }

    /// Values and derivatives of the unit lobes and of the diffuse term at a panel of directions, each times its `scale`.
    ///
    /// Shapes: `out` and `is_used` [3 K + Q S + M + 1] for S squeezed lobes and M with an angle out of the plane: K derivatives by
    /// angle, K by ln sharpness; K values; of each squeezed lobe Q derivatives by the squeeze; M by the angle out of the plane; the
    /// value of the diffuse term of albedo 1. Where a lobe is 0 at the whole panel `is_used` is false, and its columns are undefined.
    #[inline(always)]
    pub fn slopes(&self, panel: &Panel, scale: &Column, out: &mut [Column], is_used: &mut [bool]) {
        let count = self.len();
        for (k, lobe) in self.lobes.iter().enumerate() {
            let is_squeezed = k < self.squeezed;
            let directions = if is_squeezed { &panel.squeezed } else { &panel.round };
            let by_squeeze = |q| is_squeezed.then_some(3 * count + self.squeezes() * k + q);
            let off_plane = k.checked_sub(count - self.aside);
            let off_plane = off_plane.map(|m| 3 * count + self.squeezes() * self.squeezed + m);
            let [angle, sharpness, value] = [Some(k), Some(count + k), Some(2 * count + k)];
            let growth = self.squeeze.growth.as_ref();
            if growth.is_none() {
                let slopes = lobe.slopes::<4>(directions, scale, growth, is_squeezed);
                let either = off_plane.or(by_squeeze(0));
                put([angle, sharpness, value, either], slopes.as_ref(), out, is_used);
            } else {
                let slopes = lobe.slopes::<7>(directions, scale, growth, is_squeezed);
                let [first, second, third] = [0, 1, 2].map(by_squeeze);
                let places = [angle, sharpness, value, off_plane, first, second, third];
                put(places, slopes.as_ref(), out, is_used);
            }
        }
        let last = self.slopes_len() - 1;
        is_used[last] = true;
        for n in 0..PANEL {
            out[last][n] = scale[n] * panel.round.at[2][n] * std::f32::consts::FRAC_1_PI;
        }
    }
}

/// Copies the columns that there are to their places.
#[inline(always)]
fn put<const N: usize>(
    places: [Option<usize>; N],
    columns: Option<&[Column; N]>,
    out: &mut [Column],
    is_used: &mut [bool],
) {
    for (n, place) in places.into_iter().enumerate() {
        let Some(place) = place else { continue };
        is_used[place] = columns.is_some();
        if let Some(columns) = columns {
            out[place] = columns[n];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::anisotropic::tests::grid_layout;
    use crate::isotropic::line;
    use crate::numeric::random::Random;
    use crate::table::direction;

    /// Derivatives at random directions, by differences, of lobes with random unknowns within `size` of 0.
    fn check<V: Views>(layout: &Layout<V>, size: f64, random: &mut Random) {
        let count = layout.lobes;
        let mut q = vec![0.0; layout.stride()];
        (0..layout.squeezes()).for_each(|i| q[i] = size * (2.0 * random.uniform() - 1.2));
        layout.angles().for_each(|i| q[i] = size * (2.6 * random.uniform() - 1.1));
        (0..count).for_each(|k| q[layout.sharpness(k)] = 6.0 * random.uniform() - 1.0);
        let d = direction(1.5 * random.uniform(), 6.2 * random.uniform());

        let lobes = Lobes::new(layout, &q);
        let panel = lobes.panel(&d.map(|v| [v as f32; PANEL]));
        let width = lobes.slopes_len();
        let (mut columns, mut is_used) = (vec![[f32::NAN; PANEL]; width], vec![false; width]);
        let scale = std::array::from_fn(|n| if n == 1 { 0.5 } else { 1.0 });
        lobes.slopes(&panel, &scale, &mut columns, &mut is_used);
        let slopes: Vec<f64> =
            (0..width).map(|i| if is_used[i] { f64::from(columns[i][0]) } else { 0.0 }).collect();
        assert!((0..width).all(|i| !is_used[i] || f64::from(columns[i][1]) == 0.5 * slopes[i]));
        assert!((slopes[width - 1] - d[2] * FRAC_1_PI).abs() < 1e-7);
        let numbers: Vec<f64> = (0..=count).map(|k| k as f64).collect();
        let sums = lobes.sums(&panel, &[vec![1.0; count + 1], vec![0.0; count + 1], numbers.clone()]);
        let values: Vec<f64> = (2 * count..3 * count).chain([width - 1]).map(|i| slopes[i]).collect();
        let weighted: f64 = values.iter().zip(&numbers).map(|(v, n)| v * n).sum();
        assert!((f64::from(sums[2][0]) - weighted).abs() < 2e-6 * weighted && sums[1] == [0.0; PANEL]);

        let squeezes = layout.squeezes();
        for k in 0..count {
            let mut pairs = vec![(layout.angle(k), k), (layout.sharpness(k), count + k)];
            if k < layout.squeezed {
                pairs.extend((0..squeezes).map(|i| (i, 3 * count + squeezes * k + i)));
            }
            if let Some(m) = k.checked_sub(layout.first_aside()) {
                pairs.push((layout.off_plane(m), 3 * count + squeezes * layout.squeezed + m));
            }
            for (index, column) in pairs {
                let at = |h: f64| {
                    let mut q = q.clone();
                    q[index] += h;
                    let mut out = vec![0.0; count + 1];
                    Lobes::new(layout, &q).values(&d, &mut out);
                    out[k]
                };
                let h = 1e-5;
                let (difference, slope) = ((at(h) - at(-h)) / (2.0 * h), slopes[column]);
                let scale = (values[k].abs() + slope.abs() + 1e-9).max(1.0);
                // Columns are f32, and differences f64.
                assert!((difference - slope).abs() < 5e-6 * scale, "{k} {index}: {difference} {slope}");
                assert!((at(0.0) - values[k]).abs() < 2e-6 * scale);
            }
        }
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let mut random = Random::new(7);
        for round in 0..60 {
            check(&line::Layout::new(4, 2, 1, vec![0.0]), 1.0, &mut random);
            check(&grid_layout(1, 1), if round % 3 == 0 { 1e-5 } else { 1.0 }, &mut random);
        }
    }
}
