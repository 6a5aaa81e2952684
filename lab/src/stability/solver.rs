//! The solver of the fit: how near singular its problem is where it ends, how many steps it takes, and tables that it may get wrong.

use glam::DVec3;
use srbf_core::{Material, Mixture};
use srbf_fit::judge::report::{Ending, mean_error};
use srbf_fit::read::Content;
use srbf_fit::table::{Brdf, evaluation_views};
use srbf_fit::{FactorNodes, Settings, fit_content};
use srbf_tests::oracle;

/// A table that is fitted.
pub struct Case {
    pub name: &'static str,
    lobes: usize,
    peaks: Peaks,
}

/// Two peaks in the plane of incidence over a diffuse term: how sharp they are, and how far the second is from the mirror direction.
#[derive(Clone, Copy)]
struct Peaks {
    sharpness: f64,
    /// Radians.
    apart: f64,
    /// Height of the second over that of the first.
    second: f64,
}

/// What became of a table.
pub struct Solved {
    pub name: &'static str,
    /// Mean relative L2 error over the views, and that between them.
    pub error: [f64; 2],
    /// Fitted over true height of both peaks, at 30 degrees.
    pub heights: [f64; 2],
    /// Evaluations of the minimised function, over all starts.
    pub evaluations: usize,
    /// Why the last stage ended.
    pub ending: &'static str,
    /// Largest over least eigenvalue of the scaled normal matrix of a view, the worst of the views.
    pub condition: f64,
}

/// Tables from easy to hard.
pub const CASES: [Case; 4] = [
    Case { name: "one peak", lobes: 4, peaks: Peaks { sharpness: 300.0, apart: 0.0, second: 0.0 } },
    Case { name: "two peaks far apart", lobes: 4, peaks: Peaks { sharpness: 3e4, apart: 0.3, second: 0.5 } },
    Case {
        name: "two peaks that overlap",
        lobes: 4,
        peaks: Peaks { sharpness: 3e4, apart: 0.01, second: 0.5 },
    },
    Case { name: "two needles", lobes: 4, peaks: Peaks { sharpness: 1e6, apart: 0.3, second: 0.5 } },
];

impl Brdf for Peaks {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let (wi, wo) = (DVec3::from(wi), DVec3::from(wo));
        let theta = wo.x.hypot(wo.y).atan2(wo.z);
        let forwards = DVec3::new(-wo.x, -wo.y, 0.0).normalize_or(DVec3::X);
        let peak = |angle: f64| {
            let axis = forwards * angle.sin() + DVec3::Z * angle.cos();
            oracle::gaussian(axis, self.sharpness, wi)
        };
        let height = self.sharpness / std::f64::consts::TAU;
        [0.05 + 0.3 * height * (peak(theta) + self.second * peak(theta + self.apart)); 3]
    }
}

impl Case {
    /// Fits the table, and judges the result.
    ///
    /// # Errors
    /// Those of the fit.
    pub fn solve(&self) -> anyhow::Result<Solved> {
        let settings =
            Settings { lobes: self.lobes, factors: FactorNodes::None, starts: 8, ..Settings::default() };
        let fit = fit_content(&Content::Evaluable(Box::new(self.peaks)), &settings, |_| {})?;
        let material = Material::from_bytes(fit.bytes.as_slice())?;
        let thetas: Vec<f64> =
            (0..material.view_count()).filter_map(|v| material.view_theta(v)).map(f64::from).collect();
        let mut condition = 0.0f64;
        for theta in thetas {
            condition = condition.max(self.condition(&material, theta)?);
        }
        Ok(Solved {
            name: self.name,
            error: [mean_error(&fit.report.views), mean_error(&fit.report.held_out)],
            heights: self.heights(&material)?,
            evaluations: fit.report.evaluations,
            ending: match fit.report.ending {
                None => "unknown",
                Some(Ending::Converged) => "gained too little",
                Some(Ending::Steps) => "made all its steps",
            },
            condition,
        })
    }

    fn heights(&self, material: &Material<&[u8]>) -> anyhow::Result<[f64; 2]> {
        let theta = 30f64.to_radians();
        let wo = DVec3::new(-theta.sin(), 0.0, theta.cos());
        let mut mixture = Mixture::<64>::empty();
        material.prepare(wo.as_vec3(), &mut mixture)?;
        Ok([0.0, self.peaks.apart].map(|off| {
            let wi = DVec3::new((theta + off).sin(), 0.0, (theta + off).cos());
            let truth = self.peaks.evaluate(wi.to_array(), wo.to_array())[0] * wi.z;
            f64::from(mixture.evaluate(wi.as_vec3()).x) / truth
        }))
    }

    /// Of angle, logarithm of sharpness and of amplitude of each lobe, over the directions of the judge's table.
    fn condition(&self, material: &Material<&[u8]>, theta: f64) -> anyhow::Result<f64> {
        let table = evaluation_views::judging_table(&self.peaks, &[theta])?;
        let wo = DVec3::new(-theta.sin(), 0.0, theta.cos());
        let mut mixture = Mixture::<64>::empty();
        material.prepare(wo.as_vec3(), &mut mixture)?;
        let (squeeze, squeezed) = (f64::from(mixture.squeeze()), mixture.squeezed_len());
        let lobes: Vec<[f64; 3]> = (0..mixture.len())
            .filter_map(|k| mixture.lobe(k))
            .map(|lobe| {
                let axis = lobe.gaussian.axis.as_dvec3();
                [
                    axis.x.atan2(axis.z),
                    f64::from(lobe.gaussian.sharpness).ln(),
                    f64::from(lobe.amplitude.y).ln(),
                ]
            })
            .collect();
        // A lobe that has faded is no unknown of the problem.
        let alive: Vec<usize> = (0..lobes.len()).filter(|&k| lobes[k][2] > -80.0).collect();
        let value = |k: usize, [angle, s, a]: [f64; 3], wi: DVec3| {
            let axis = DVec3::new(angle.sin(), 0.0, angle.cos());
            let (u, scale) = if k < squeezed { oracle::squeezed([1.0, squeeze], wi) } else { (wi, 1.0) };
            let both =
                oracle::gaussian(axis, s.exp(), u) + oracle::gaussian(axis, s.exp(), oracle::mirrored(u));
            a.exp() * scale * both
        };
        const STEP: f64 = 1e-5;
        let n = 3 * alive.len();
        let mut normal = vec![vec![0.0; n]; n];
        for sample in &table.views[0].samples {
            let wi = DVec3::from(sample.direction);
            let slope = |unknown: usize| {
                let (k, what) = (alive[unknown / 3], unknown % 3);
                // An angle in widths of the lobe.
                let step = if what == 0 { STEP * (-0.5 * lobes[k][1]).exp().min(1.0) } else { STEP };
                let moved = |by: f64| {
                    let mut lobe = lobes[k];
                    lobe[what] += by;
                    value(k, lobe, wi)
                };
                (moved(step) - moved(-step)) / (2.0 * STEP)
            };
            let slopes: Vec<f64> = (0..n).map(slope).collect();
            for (row, slope) in normal.iter_mut().zip(&slopes) {
                for (entry, other) in row.iter_mut().zip(&slopes) {
                    *entry += sample.weight * slope * other;
                }
            }
        }
        Ok(condition(&scaled(normal)))
    }
}

/// With a diagonal of 1; unknowns that nothing depends on are left out.
fn scaled(matrix: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let most = (0..matrix.len()).map(|i| matrix[i][i]).fold(0.0, f64::max);
    let kept: Vec<usize> = (0..matrix.len()).filter(|&i| matrix[i][i] > 1e-12 * most).collect();
    let entry = |i: usize, j: usize| matrix[i][j] / (matrix[i][i] * matrix[j][j]).sqrt();
    kept.iter().map(|&i| kept.iter().map(|&j| entry(i, j)).collect()).collect()
}

/// Largest over least eigenvalue of a symmetric matrix, by Jacobi's rotations.
fn condition(matrix: &[Vec<f64>]) -> f64 {
    let n = matrix.len();
    let mut a = matrix.to_vec();
    for _ in 0..60 {
        let mut off = 0.0;
        for p in 0..n {
            for q in p + 1..n {
                off += a[p][q] * a[p][q];
                if a[p][q] == 0.0 {
                    continue;
                }
                let t = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
                let t = t.signum() / (t.abs() + t.hypot(1.0));
                let c = 1.0 / t.hypot(1.0);
                let s = t * c;
                for row in &mut a {
                    (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
                }
                let (above, below) = a.split_at_mut(q);
                for (x, y) in above[p].iter_mut().zip(&mut below[0]) {
                    (*x, *y) = (c * *x - s * *y, s * *x + c * *y);
                }
            }
        }
        if off < 1e-28 {
            break;
        }
    }
    let values = || (0..n).map(|i| a[i][i]);
    values().fold(0.0, f64::max) / values().fold(f64::INFINITY, f64::min).max(1e-16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_condition_of_a_known_matrix() {
        // Eigenvalues 1 + r and 1 - r.
        let found = condition(&[vec![1.0, 0.99], vec![0.99, 1.0]]);
        assert!((found - 199.0).abs() < 1e-6, "{found}");
        assert_eq!(scaled(vec![vec![4.0, 2.0], vec![2.0, 9.0]])[0][1], 2.0 / 6.0);
    }
}
