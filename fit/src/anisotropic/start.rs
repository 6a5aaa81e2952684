//! Where an anisotropic fit starts.
//!
//! At every stored view the highlight is taken for one Gaussian: its covariance gives the squeeze matrix that makes it round, and
//! the sharpness that it then has. Squeezed lobes have multiples of that sharpness, in a geometric series, round ones a series of
//! their own; narrow lobes point to the highlight, wide ones towards the normal. The amplitudes are the best non-negative ones,
//! stored view by stored view. Starts differ in the range of the series and by a jitter.

use crate::anisotropic::grid::{Grid, Layout, Stored};
use crate::anisotropic::shape::{exponential, frame};
use crate::anisotropic::table::TurnedView;
use crate::anisotropic::tuning::start::{APART, LEAST};
use crate::family::layout::Views;
use crate::family::lobes::Lobes;
use crate::family::start::{dim, paint, series};
use crate::family::unit::dot;
use crate::numeric::random::Random;
use crate::table::{DARKEST, View, luminance};

/// A highlight as one Gaussian.
struct Highlight {
    /// Tilt of its axis along and across the plane of incidence.
    tilt: [f64; 2],
    /// Logarithm of the squeeze matrix that makes it round.
    squeeze: [f64; 3],
    /// Sharpness under that squeeze.
    sharpness: f64,
}

/// Makes the unknowns of start number `n`, from tables at the stored views.
pub(super) fn start(table: &[TurnedView], layout: &Layout, n: usize) -> Vec<f64> {
    let mut random = Random::new(0x5eed + n as u64);
    let jitter = if n == 0 { 0.0 } else { 0.5 };
    let mut vary = |size: f64| jitter * size * (2.0 * random.uniform() - 1.0);
    let (widest, narrowest) = (0.04 * libm::exp(vary(1.2)), 1.8 * libm::exp(vary(0.8)));
    let (round_low, round_high) = (1.2, 30.0 * libm::exp(vary(1.5)));
    let mut relative: Vec<f64> = (0..layout.lobes)
        .map(|k| {
            let round = layout.lobes - layout.squeezed;
            let s = if k < layout.squeezed {
                series(widest, narrowest, k, layout.squeezed)
            } else {
                series(round_low, round_high, k - layout.squeezed, round)
            };
            s * libm::exp(vary(0.7))
        })
        .collect();
    let mut spread: Vec<[f64; 2]> = relative.iter().map(|_| [vary(0.2), vary(1.0)]).collect();
    // Partners stand on both sides.
    for k in 0..layout.lobes {
        let Some(of) = layout.views.partner(k) else { continue };
        spread[of][1] = APART + 0.5 * spread[of][1];
        (spread[k], relative[k]) = ([spread[of][0], -spread[of][1]], relative[of]);
    }

    let p = layout.stride();
    let mut x = vec![0.0; layout.len()];
    // Relative to a table that is dark: a start that is brighter by decades takes many steps to fade.
    let brightest = table.iter().map(|at| luminance(at.view.albedo)).fold(DARKEST, f64::max);
    let least = LEAST * brightest.min(1.0);
    for (stored, TurnedView { view, .. }) in table.iter().enumerate() {
        let highlight = Highlight::new(view);
        let q = &mut x[stored * p..(stored + 1) * p];
        q[..3].copy_from_slice(&highlight.squeeze);
        for k in 0..layout.lobes {
            let squeezed = k < layout.squeezed;
            let s = relative[k] * if squeezed { highlight.sharpness } else { 1.0 };
            let lean = s / (s + 6.0);
            let width = if squeezed { 1.0 / libm::sqrt(s.max(4.0)) } else { 0.1 };
            q[layout.sharpness(k)] = libm::log(s).clamp(-1.0, 13.0);
            if stored > 0 {
                q[layout.angle(k)] = lean * highlight.tilt[0] + width * spread[k][0];
                q[layout.off_plane(k)] =
                    lean * highlight.tilt[1] + width * spread[k][1] * libm::sin(view.theta);
            }
        }
        if stored == 0 {
            // The view of the normal looks along azimuth 0, its +x at half a turn: which a matrix does not see.
            for k in 0..layout.lobes {
                (q[layout.angle(k)], q[layout.off_plane(k)]) = (0.0, 0.0);
            }
        }
        let lobes = Lobes::new(layout, q);
        let sharpness: Vec<f64> = (0..layout.lobes).map(|k| libm::exp(q[layout.sharpness(k)])).collect();
        paint(layout, (view, &lobes), &sharpness, least, q);
        dim(layout, q);
        if layout.views.stored(stored) == Stored::Images {
            for k in 0..layout.lobes {
                let Some(of) = layout.views.partner(k) else { continue };
                for (to, i) in layout.tint(of).into_iter().zip(layout.tint(k)) {
                    q[to] = 0.5 * (q[to] + q[i]);
                }
            }
        }
        (0..p).filter(|&i| Grid::fixed(layout, stored, i)).for_each(|i| q[i] = 0.0);
    }
    x
}

impl Highlight {
    /// Moments of the square of `f cos`, which weigh the peak more than its surroundings.
    fn new(view: &View) -> Self {
        let value = |s: &crate::table::Sample| s.rgb.iter().sum::<f64>() * s.direction[2];
        let peak = view.samples.iter().max_by(|a, b| value(a).total_cmp(&value(b)));
        let Some(peak) = peak else { return Self { tilt: [0.0; 2], squeeze: [0.0; 3], sharpness: 10.0 } };
        let axis = peak.direction;
        let angle = libm::acos(axis[2].min(1.0));
        let [_, along, aside] = frame(axis);
        let (c, s) = (aside[1], -aside[0]);
        let frame = [along, aside];

        let half = 0.25 * value(peak);
        let (mut sum, mut first, mut second) = (0.0, [0.0; 2], [0.0; 3]);
        for sample in view.samples.iter().filter(|s| value(s) > half) {
            let d = sample.direction;
            let [x, y] = frame.map(|t| dot(&t, &d));
            let w = sample.weight * value(sample) * value(sample);
            sum += w;
            first = [first[0] + w * x, first[1] + w * y];
            second = [second[0] + w * x * x, second[1] + w * x * y, second[2] + w * y * y];
        }
        let mean = first.map(|v| v / sum);
        let moment = [
            second[0] / sum - mean[0] * mean[0],
            second[1] / sum - mean[0] * mean[1],
            second[2] / sum - mean[1] * mean[1],
        ];
        // Cut at a quarter of the peak, the square of a Gaussian of precision Q has about 0.46 of its covariance, 1 / (2 Q).
        let floor = 1e-7;
        let covariance = [moment[0] / 0.23 + floor, moment[1] / 0.23, moment[2] / 0.23 + floor];
        let determinant = (covariance[0] * covariance[2] - covariance[1] * covariance[1]).max(floor * floor);
        let precision =
            [covariance[2] / determinant, -covariance[1] / determinant, covariance[0] / determinant];
        let (squeeze, sharpness) = rounding(axis, frame, precision);
        Self { tilt: [angle * c, angle * s], squeeze, sharpness }
    }
}

/// The squeeze that makes a highlight of a given precision in its tangent plane round, and the sharpness that it then has.
///
/// Two numbers are to be met, the ratio of the axes and their direction; a symmetric matrix has three. The one along the plane of
/// incidence is kept small away from the normal, and the trace near it. A few damped Gauss-Newton steps.
fn rounding(axis: [f64; 3], frame: [[f64; 3]; 2], precision: [f64; 3]) -> ([f64; 3], f64) {
    let seen = |squeeze: [f64; 3]| {
        let (m, _) = exponential(squeeze);
        let map = |v: [f64; 3]| [m[0] * v[0] + m[1] * v[1], m[1] * v[0] + m[2] * v[1], v[2]];
        let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| a[k] * b[k]).sum::<f64>();
        let a = map(axis);
        let length = libm::sqrt(dot(a, a));
        let unit = a.map(|v| v / length);
        let columns = frame.map(|t| {
            let v = map(t);
            let along = dot(v, unit);
            [0, 1, 2].map(|k| (v[k] - along * unit[k]) / length)
        });
        [dot(columns[0], columns[0]), dot(columns[0], columns[1]), dot(columns[1], columns[1])]
    };
    let features = |m: [f64; 3]| {
        [libm::log((m[0] + 1e-12) / (m[2] + 1e-12)), 2.0 * m[1] / libm::sqrt(m[0] * m[2] + 1e-24)]
    };
    let goal = features(precision);
    let near = axis[2] * axis[2] * axis[2] * axis[2];
    let residual = |s: [f64; 3]| {
        let f = features(seen(s));
        [f[0] - goal[0], f[1] - goal[1], 0.1 * (s[0] + near * s[2]), 0.02 * s[1]]
    };
    let cost = |s: [f64; 3]| residual(s).iter().map(|r| r * r).sum::<f64>();
    let mut s = [0.0; 3];
    let mut damping = 0.1;
    for _ in 0..60 {
        let r = residual(s);
        let h = 1e-5;
        let columns = [0, 1, 2].map(|i| {
            let mut t = s;
            t[i] += h;
            let q = residual(t);
            [0, 1, 2, 3].map(|k| (q[k] - r[k]) / h)
        });
        let mut a = [[0.0; 3]; 3];
        let mut b = [0.0; 3];
        for i in 0..3 {
            b[i] = -(0..4).map(|k| columns[i][k] * r[k]).sum::<f64>();
            for j in 0..3 {
                a[i][j] = (0..4).map(|k| columns[i][k] * columns[j][k]).sum();
            }
            a[i][i] += damping;
        }
        let step = solve3(a, b);
        let moved = [0, 1, 2].map(|i| (s[i] + step[i].clamp(-0.5, 0.5)).clamp(-1.9, 3.0));
        if cost(moved) < cost(s) {
            s = moved;
            damping = (0.3 * damping).max(1e-6);
        } else {
            damping *= 4.0;
        }
    }
    let m = seen(s);
    let ratio = (precision[0] * precision[2] - precision[1] * precision[1]).max(1e-9)
        / (m[0] * m[2] - m[1] * m[1]).max(1e-9);
    (s, libm::sqrt(ratio).clamp(1.0, 1e6))
}

/// Gauss elimination of a positive definite 3 x 3 system.
fn solve3(mut a: [[f64; 3]; 3], mut b: [f64; 3]) -> [f64; 3] {
    for k in 0..3 {
        for i in k + 1..3 {
            let f = a[i][k] / a[k][k];
            (k..3).for_each(|j| a[i][j] -= f * a[k][j]);
            b[i] -= f * b[k];
        }
    }
    for k in (0..3).rev() {
        b[k] = (b[k] - (k + 1..3).map(|j| a[k][j] * b[j]).sum::<f64>()) / a[k][k];
    }
    b
}
