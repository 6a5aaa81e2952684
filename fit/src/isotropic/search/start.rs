//! Where a fit starts.
//!
//! Every start is a family of lobes that is sensible at every view at once. So lobe k of one view already is lobe k of the next:
//! sharpness in a geometric series, the same at all views; narrow lobes point to the mirror direction, wide ones to the normal
//! (`angle = theta s / (s + s0)`); the squeeze is the cosine of the view. The amplitudes are the best non-negative ones, view by
//! view. Mirrored lobes are narrow ones beside the plane of incidence, a little more than their width off it: a peak that is no
//! Gaussian needs several lobes side by side. Starts differ in the range of the series, in `s0`, and by a jitter.

use crate::family::layout::Layout;
use crate::family::lobes::Lobes;
use crate::isotropic::tuning::start::{BRIGHTEST, FAINT, LEAST_SQUEEZE, MIRRORED, SWEEPS, WIDTHS};
use crate::numeric::random::Random;
use crate::table::{Table, View, luminance};
use std::f64::consts::PI;

/// Makes the unknowns of start number `n`.
pub(crate) fn start(table: &Table, layout: &Layout, n: usize) -> Vec<f64> {
    let mut random = Random::new(0x5eed + n as u64);
    let jitter = if n == 0 { 0.0 } else { 0.5 };
    let mut vary = |size: f64| jitter * size * (2.0 * random.next() - 1.0);

    let top = sharpest(table) * libm::exp(vary(1.5));
    let bottom = 2.5 * libm::exp(vary(0.8));
    let round_top = libm::sqrt(top) * 4.0 * libm::exp(vary(1.5));
    let s0 = 6.0 * libm::exp(vary(1.0));
    let series = |low: f64, high: f64, i: usize, count: usize| {
        let t = if count > 1 { i as f64 / (count - 1) as f64 } else { 0.5 };
        libm::exp(libm::log(low) + t * (libm::log(high.max(2.0 * low)) - libm::log(low)))
    };
    let sharpness: Vec<f64> = (0..layout.lobes)
        .map(|k| {
            let in_plane = layout.first_mirrored();
            let s = if k < layout.squeezed {
                series(bottom, top, k, layout.squeezed)
            } else if k < in_plane {
                // The widest is the last, which may be the defensive lobe.
                series(1.2, round_top, in_plane - 1 - k, in_plane - layout.squeezed)
            } else {
                series(MIRRORED.0 * top, MIRRORED.1 * top, k - in_plane, layout.mirrored)
            };
            s * libm::exp(vary(0.7))
        })
        .collect();
    let lean: Vec<f64> = sharpness.iter().map(|s| s / (s + s0) + vary(0.1)).collect();

    let p = layout.stride();
    let mut x = vec![0.0; layout.len()];
    for (stored, &theta) in layout.view_angles.iter().enumerate() {
        let q = &mut x[stored * p..(stored + 1) * p];
        shape(layout, theta, &sharpness, &lean, q);
        if let Some(view) = nearest(table, theta) {
            // The shapes of the view's own angle: a stored view without a view takes the amplitudes of the nearest.
            let mut at_view = vec![0.0; p];
            shape(layout, view.theta, &sharpness, &lean, &mut at_view);
            let lobes = Lobes::new(layout, &at_view);
            let found = best_amplitudes(view, &lobes, layout.lobes + 1);
            let color = |k: usize| [0, 1, 2].map(|c| found[c][k]);
            let largest = (0..=layout.lobes).map(|k| luminance(color(k))).fold(1e-9, f64::max);
            for (k, sharpness) in sharpness.iter().enumerate() {
                let faint = FAINT * largest / sharpness.max(1.0);
                layout.set_tint(q, k, color(k), faint);
            }
            let faint = 1e-3 * luminance(view.albedo).max(0.0) + 1e-9;
            layout.set_tint(q, layout.lobes, color(layout.lobes), faint);
        }
        // A stored view without a view may hold too much light with borrowed amplitudes.
        let most = layout.albedo(q, None).into_iter().fold(0.0, f64::max);
        if most > BRIGHTEST {
            layout.luminances().for_each(|i| q[i] -= libm::log(most / BRIGHTEST));
        }
    }
    x
}

fn shape(layout: &Layout, theta: f64, sharpness: &[f64], lean: &[f64], q: &mut [f64]) {
    q[0] = libm::log(libm::cos(theta).max(LEAST_SQUEEZE));
    for k in 0..layout.lobes {
        q[layout.angle(k)] = theta * lean[k];
        q[layout.sharpness(k)] = libm::log(sharpness[k]);
    }
    for m in 0..layout.mirrored {
        // At the normal every axis is the normal.
        let is_free = f64::from(u8::from(theta != 0.0));
        q[layout.off_plane(m)] = is_free * WIDTHS / libm::sqrt(sharpness[layout.first_mirrored() + m]);
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

/// Best non-negative amplitudes of the first `count` of lobes and diffuse term, per channel, by coordinate descent on the normal
/// equations.
pub(crate) fn best_amplitudes(view: &View, lobes: &Lobes, count: usize) -> [Vec<f64>; 3] {
    let mut gram = vec![0.0; count * count];
    let mut moment = [vec![0.0; count], vec![0.0; count], vec![0.0; count]];
    let mut unit = vec![0.0; lobes.len() + 1];
    for s in &view.samples {
        lobes.values(&s.direction, &mut unit);
        for i in 0..count {
            for j in 0..count {
                gram[i * count + j] += s.weight * unit[i] * unit[j];
            }
            for (c, m) in moment.iter_mut().enumerate() {
                m[i] += s.weight * unit[i] * s.rgb[c] * s.direction[2];
            }
        }
    }
    moment.map(|moment| {
        let mut a = vec![0.0; count];
        for _ in 0..SWEEPS {
            for i in 0..count {
                let diagonal = gram[i * count + i];
                if diagonal > 0.0 {
                    let row = &gram[i * count..(i + 1) * count];
                    let slope = moment[i] - row.iter().zip(&a).map(|(g, a)| g * a).sum::<f64>();
                    a[i] = (a[i] + slope / diagonal).max(0.0);
                }
            }
        }
        a
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::{Table, direction};

    #[test]
    fn amplitudes_of_lobes_that_made_the_table_are_found_again() {
        let layout = Layout::new(3, 1, 0, vec![0.0, 1.0]);
        let mut q = vec![0.0; layout.stride()];
        shape(&layout, 0.6, &[40.0, 5.0, 1.5], &[1.0, 0.5, 0.0], &mut q);
        let lobes = Lobes::new(&layout, &q);
        let truth = [2.0, 0.0, 0.5];
        let mut scattered = vec![];
        for theta in 0..28 {
            for phi in 0..19 {
                let d = direction(f64::from(theta) * 0.05, f64::from(10 * phi).to_radians());
                let mut unit = [0.0; 4];
                lobes.values(&d, &mut unit);
                let v = truth.iter().zip(unit).map(|(a, u)| a * u).sum::<f64>() / d[2];
                scattered.push((d, [v, 2.0 * v, 0.0]));
            }
        }
        let table = Table::from_scattered(vec![(0.6, scattered)]).unwrap();
        let found = best_amplitudes(&table.views[0], &lobes, 4);
        for k in 0..3 {
            assert!(
                (found[0][k] - truth[k]).abs() < 1e-3 && (found[1][k] - 2.0 * truth[k]).abs() < 2e-3,
                "{found:?}"
            );
            assert_eq!(found[2][k], 0.0);
        }
    }
}
