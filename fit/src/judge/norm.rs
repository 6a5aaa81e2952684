//! Relative L2 errors of one view.

use crate::judge::method::FittedView;
use crate::table::View;

/// What errors are measured in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Norm {
    /// `f cos`, which a renderer integrates.
    FCos,
    /// f alone, as in equation 7 of the thesis.
    F,
}

/// Relative L2 error over the samples of a view and the channels, with the quadrature weights of the table.
pub fn relative_l2(fitted: &dyn FittedView, view: &View, norm: Norm) -> f64 {
    relative(squares(&values(fitted, view), view, norm))
}

/// `f cos` at every sample of a view.
pub(crate) fn values(fitted: &dyn FittedView, view: &View) -> Vec<[f64; 3]> {
    view.samples.iter().map(|s| fitted.f_cos(s.direction)).collect()
}

/// Root of a squared difference over the squares of the data; of the difference alone if the data are black.
pub(crate) fn relative((difference, data): (f64, f64)) -> f64 {
    libm::sqrt(if data > 0.0 { difference / data } else { difference })
}

/// Sums of squares over a view: of the difference of [`values`], and of the data.
pub(crate) fn squares(values: &[[f64; 3]], view: &View, norm: Norm) -> (f64, f64) {
    let (mut difference, mut sum) = (0.0, 0.0);
    for (s, &value) in view.samples.iter().zip(values) {
        let cosine = match norm {
            Norm::FCos => 1.0,
            Norm::F => s.direction[2],
        };
        for (value, f) in value.into_iter().zip(s.rgb) {
            let data = f * s.direction[2] / cosine;
            let off = value / cosine - data;
            difference += s.weight * off * off;
            sum += s.weight * data * data;
        }
    }
    (difference, sum)
}
