//! The squared difference of a mixture and a vector, with what its gradient is made of: four texels at a time.
//!
//! All the time of the fit goes here. Let `slope` be the derivative of the difference by the lobe's exponent, and
//! `q = sum slope d`, `p = sum slope` over the texels. The derivative by the axis is `s q`, and that by the logarithm of the
//! sharpness `s (q.axis - p)`.

use super::cube::Cube;
use super::lobes::{RoundLobe, SMALLEST};
use wide::f64x4;

/// Texels of a vector, four by four; missing ones at the end have no weight.
pub(crate) struct Texels {
    blocks: Vec<Panel>,
}

struct Panel {
    direction: [f64x4; 3],
    value: [f64x4; 3],
    /// Solid angle over the sum of squares of the data.
    weight: f64x4,
}

/// Sums over the texels for one lobe.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Slope {
    pub q: [f64; 3],
    pub p: f64,
}

impl Texels {
    /// Gathers a vector.
    pub fn new(cube: &Cube, values: &[[f64; 3]]) -> Self {
        let square = |(v, w): (&[f64; 3], &f64)| w * v.iter().map(|v| v * v).sum::<f64>();
        let norm: f64 = values.iter().zip(&cube.solid_angles).map(square).sum();
        let lanes = |f: &dyn Fn(usize) -> f64, from: usize| {
            f64x4::from([0, 1, 2, 3].map(|i| if from + i < values.len() { f(from + i) } else { 0.0 }))
        };
        let block = |from: usize| Panel {
            direction: [0, 1, 2].map(|k| lanes(&|n| cube.directions[n][k], from)),
            value: [0, 1, 2].map(|c| lanes(&|n| values[n][c], from)),
            weight: lanes(&|n| cube.solid_angles[n] / norm, from),
        };
        Self { blocks: (0..values.len()).step_by(4).map(block).collect() }
    }

    /// The squared difference relative to the data's. Shapes: `slopes` as `lobes`, overwritten.
    pub fn differentiate(&self, lobes: &[RoundLobe], slopes: &mut [Slope]) -> f64 {
        let zero = f64x4::ZERO;
        let splat: Vec<[f64x4; 7]> = lobes
            .iter()
            .map(|l| {
                [l.axis[0], l.axis[1], l.axis[2], l.sharpness, l.amplitude[0], l.amplitude[1], l.amplitude[2]]
            })
            .map(|numbers| numbers.map(f64x4::splat))
            .collect();
        let mut units = vec![zero; lobes.len()];
        let mut sums = vec![[zero; 4]; lobes.len()];
        let mut cost = zero;
        for block in &self.blocks {
            let [x, y, z] = block.direction;
            let mut residual = block.value.map(|v| -v);
            for (unit, [ax, ay, az, s, red, green, blue]) in units.iter_mut().zip(&splat) {
                *unit = unit_lobe(*s * (*ax * x + *ay * y + *az * z - 1.0));
                residual[0] += *red * *unit;
                residual[1] += *green * *unit;
                residual[2] += *blue * *unit;
            }
            let [r, g, b] = residual;
            cost += block.weight * (r * r + g * g + b * b);
            let twice = block.weight + block.weight;
            for ((sum, unit), [.., red, green, blue]) in sums.iter_mut().zip(&units).zip(&splat) {
                let slope = twice * *unit * (r * *red + g * *green + b * *blue);
                sum[0] += slope * x;
                sum[1] += slope * y;
                sum[2] += slope * z;
                sum[3] += slope;
            }
        }
        for (slope, sum) in slopes.iter_mut().zip(&sums) {
            let [x, y, z, p] = sum.map(f64x4::reduce_add);
            *slope = Slope { q: [x, y, z], p };
        }
        cost.reduce_add()
    }

    /// Gram matrix of the lobes with amplitude 1, lower half, and their products with the data by channel.
    ///
    /// Shapes: K by K, rows; 3 by K.
    pub fn normal_equations(&self, lobes: &[RoundLobe]) -> (Vec<f64>, Vec<f64>) {
        let k = lobes.len();
        let mut gram = vec![f64x4::ZERO; k * k];
        let mut moment = vec![f64x4::ZERO; 3 * k];
        let mut units = vec![f64x4::ZERO; k];
        for block in &self.blocks {
            let [x, y, z] = block.direction;
            for (unit, l) in units.iter_mut().zip(lobes) {
                *unit = unit_lobe((x * l.axis[0] + y * l.axis[1] + z * l.axis[2] - 1.0) * l.sharpness);
            }
            for i in 0..k {
                let weighted = block.weight * units[i];
                (0..=i).for_each(|j| gram[i * k + j] += weighted * units[j]);
                (0..3).for_each(|c| moment[c * k + i] += weighted * block.value[c]);
            }
        }
        let sum = |v: Vec<f64x4>| v.into_iter().map(f64x4::reduce_add).collect();
        (sum(gram), sum(moment))
    }
}

/// `exp(t)`, 0 where it is too small to matter.
#[inline]
fn unit_lobe(t: f64x4) -> f64x4 {
    let seen = t.simd_gt(f64x4::splat(SMALLEST));
    if seen.none() { f64x4::ZERO } else { seen.select(t.exp(), f64x4::ZERO) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::thesis::lobes::evaluate;
    use srbf_fit::table::direction;

    #[test]
    fn cost_and_slopes_agree_with_sums_and_differences() {
        // 3 * 6^2 texels are no multiple of 4 times 8.
        let cube = Cube::new(6);
        let lobe = |theta, azimuth, sharpness| RoundLobe {
            axis: direction(theta, azimuth),
            sharpness,
            amplitude: [2.0, 1.0, 0.5],
        };
        let values: Vec<[f64; 3]> = cube
            .directions
            .iter()
            .map(|d| evaluate(&[lobe(0.8, 0.3, 9.0), lobe(0.1, 1.0, 2.0)], d))
            .collect();
        let texels = Texels::new(&cube, &values);
        let lobes = [lobe(0.6, 0.1, 12.0), lobe(0.3, 2.0, 3.0), lobe(1.0, 0.2, 400.0)];
        let mut slopes = [Slope::default(); 3];
        let cost = texels.differentiate(&lobes, &mut slopes);

        let (mut difference, mut norm) = (0.0, 0.0);
        for ((d, v), w) in cube.directions.iter().zip(&values).zip(&cube.solid_angles) {
            let fitted = evaluate(&lobes, d);
            difference += w * (0..3).map(|c| (fitted[c] - v[c]) * (fitted[c] - v[c])).sum::<f64>();
            norm += w * v.iter().map(|v| v * v).sum::<f64>();
        }
        assert!((cost - difference / norm).abs() < 1e-9 * cost, "{cost} {}", difference / norm);

        for k in 0..lobes.len() {
            let at = |ln_sharpness: f64, y: f64| {
                let mut moved = lobes;
                moved[k].sharpness *= libm::exp(ln_sharpness);
                moved[k].axis[1] += y;
                texels.differentiate(&moved, &mut [Slope::default(); 3])
            };
            let (h, s, q) = (1e-6, lobes[k].sharpness, slopes[k].q);
            let by_sharpness = s * ((0..3).map(|i| q[i] * lobes[k].axis[i]).sum::<f64>() - slopes[k].p);
            for (difference, slope) in
                [(at(h, 0.0) - at(-h, 0.0), by_sharpness), (at(0.0, h) - at(0.0, -h), s * q[1])]
            {
                let difference = difference / (2.0 * h);
                assert!((difference - slope).abs() < 1e-6 * (1.0 + slope.abs()), "{k}: {difference} {slope}");
            }
        }
    }
}
