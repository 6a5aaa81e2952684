//! Where a fit starts.
//!
//! Every start is a family of lobes that is sensible at every view at once. So lobe k of one view already is lobe k of the next:
//! sharpness in a geometric series, the same at all views; narrow lobes point to the mirror direction, wide ones to the normal
//! (`angle = theta s / (s + s0)`); the squeeze is the cosine of the view. The amplitudes are the best non-negative ones, view by
//! view. Mirrored lobes are narrow ones beside the plane of incidence, a little more than their width off it: a peak that is no
//! Gaussian needs several lobes side by side. Starts differ in the range of the series, in `s0`, and by a jitter.

use crate::family::lobes::Lobes;
use crate::family::start::{dim, paint, series};
use crate::isotropic::line::Layout;
use crate::isotropic::tuning::start::{LEAST_SQUEEZE, MIRRORED, WIDTHS};
use crate::numeric::random::Random;
use crate::table::{Table, View};
use std::f64::consts::PI;

/// Makes the unknowns of start number `n`.
pub(crate) fn start(table: &Table, layout: &Layout, n: usize) -> Vec<f64> {
    let mut random = Random::new(0x5eed + n as u64);
    let jitter = if n == 0 { 0.0 } else { 0.5 };
    let mut vary = |size: f64| jitter * size * (2.0 * random.uniform() - 1.0);

    let top = sharpest(table) * libm::exp(vary(1.5));
    let bottom = 2.5 * libm::exp(vary(0.8));
    let round_top = libm::sqrt(top) * 4.0 * libm::exp(vary(1.5));
    let s0 = 6.0 * libm::exp(vary(1.0));
    let sharpness: Vec<f64> = (0..layout.lobes)
        .map(|k| {
            let in_plane = layout.first_aside();
            let s = if k < layout.squeezed {
                series(bottom, top.max(2.0 * bottom), k, layout.squeezed)
            } else if k < in_plane {
                // The widest is the last, which may be the defensive lobe.
                series(1.2, round_top.max(2.4), in_plane - 1 - k, in_plane - layout.squeezed)
            } else {
                series(MIRRORED.0 * top, MIRRORED.1 * top, k - in_plane, layout.aside)
            };
            s * libm::exp(vary(0.7))
        })
        .collect();
    let lean: Vec<f64> = sharpness.iter().map(|s| s / (s + s0) + vary(0.1)).collect();

    let p = layout.stride();
    let mut x = vec![0.0; layout.len()];
    for (stored, &theta) in layout.views.angles.iter().enumerate() {
        let q = &mut x[stored * p..(stored + 1) * p];
        shape(layout, theta, &sharpness, &lean, q);
        if let Some(view) = nearest(table, theta) {
            // The shapes of the view's own angle: a stored view without a view takes the amplitudes of the nearest.
            let mut at_view = vec![0.0; p];
            shape(layout, view.theta, &sharpness, &lean, &mut at_view);
            let lobes = Lobes::new(layout, &at_view);
            paint(layout, (view, &lobes), &sharpness, 1e-9, q);
        }
        // A stored view without a view may hold too much light with borrowed amplitudes.
        dim(layout, q);
    }
    x
}

fn shape(layout: &Layout, theta: f64, sharpness: &[f64], lean: &[f64], q: &mut [f64]) {
    q[0] = libm::log(libm::cos(theta).max(LEAST_SQUEEZE));
    for k in 0..layout.lobes {
        q[layout.angle(k)] = theta * lean[k];
        q[layout.sharpness(k)] = libm::log(sharpness[k]);
    }
    for m in 0..layout.aside {
        // At the normal every axis is the normal.
        let is_free = f64::from(u8::from(theta != 0.0));
        q[layout.off_plane(m)] = is_free * WIDTHS / libm::sqrt(sharpness[layout.first_aside() + m]);
    }
}

/// Four times the sharpness of a lobe that holds all of a view's light and is as high as its highest sample.
fn sharpest(table: &Table) -> f64 {
    let view = |v: &View| {
        let bright = |rgb: [f64; 3]| rgb.iter().sum::<f64>();
        let peak = v.samples.iter().map(|s| bright(s.rgb) * s.direction[2]).fold(0.0, f64::max);
        8.0 * PI * peak * libm::cos(v.theta).max(LEAST_SQUEEZE) / bright(v.albedo).max(1e-12)
    };
    table.views.iter().map(view).fold(30.0, f64::max).min(3e5)
}

fn nearest(table: &Table, theta: f64) -> Option<&View> {
    table.views.iter().min_by(|a, b| (a.theta - theta).abs().total_cmp(&(b.theta - theta).abs()))
}
