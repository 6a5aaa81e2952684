//! Distances of samples from the predictions of completions without them.

use super::color::rgb;
use super::points::Point;
use super::process::Process;
use super::scale::Scale;

/// Errors of samples left out one by one, in groups, or view by view.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HeldOut {
    /// Mean over the views of the relative L2 error of `f cos`, each at most 1.
    pub error: f64,
    /// Root mean square of the difference of logarithms, over the projected solid angle.
    pub logarithm: f64,
}

impl HeldOut {
    /// What candidates are compared by.
    pub fn rank(&self) -> f64 {
        self.error + self.logarithm
    }

    /// From the distances of points from their predictions.
    pub(super) fn new(points: &[Point], above: &[[f64; 3]], scale: Scale) -> Self {
        let bands = 1 + points.iter().map(|p| p.band).max().unwrap_or(0);
        let mut squares = vec![(0.0, 0.0); bands];
        let (mut logarithms, mut even) = (0.0, 0.0);
        for (p, above) in points.iter().zip(above) {
            let data = [0, 1, 2].map(|c| p.base[c] + p.above[c]);
            let said = [0, 1, 2].map(|c| data[c] - above[c].clamp(-super::FARTHEST, super::FARTHEST));
            let [data, said] = [data, said].map(|values| rgb(values.map(|v| scale.back(v))));
            for (data, said) in data.into_iter().zip(said) {
                squares[p.band].0 += p.relative * (said - data) * (said - data);
                squares[p.band].1 += p.relative * data * data;
            }
            logarithms += p.even * above.iter().map(|a| a * a).sum::<f64>() / 3.0;
            even += p.even;
        }
        let bright: Vec<f64> =
            squares.iter().filter(|s| s.1 > 0.0).map(|s| libm::sqrt(s.0 / s.1).min(1.0)).collect();
        let error = bright.iter().sum::<f64>() / bright.len().max(1) as f64;
        Self { error, logarithm: libm::sqrt(logarithms / even.max(1e-300)) }
    }

    /// Of points left out one by one.
    pub(super) fn alone(process: &Process, points: &[Point], scale: Scale) -> Self {
        let above: Vec<[f64; 3]> = process.left_out_alone().into_iter().map(|left| left.0).collect();
        Self::new(points, &above, scale)
    }

    /// Of bands of views left out, but the first and the last; `None` with fewer than three bands.
    pub(super) fn bands(process: &Process, points: &[Point], scale: Scale) -> Option<Self> {
        let last = points.iter().map(|p| p.band).max()?;
        let mut parts = Vec::new();
        let mut aboves = Vec::new();
        for band in 1..last {
            let group: Vec<usize> = (0..points.len()).filter(|&i| points[i].band == band).collect();
            if group.is_empty() {
                continue;
            }
            aboves.extend(process.left_out(&group)?);
            parts.extend(group.iter().map(|&i| points[i].clone()));
        }
        (!parts.is_empty()).then(|| Self::new(&parts, &aboves, scale))
    }
}
