//! What starts have in common: series of sharpness, and the best colours for given shapes of the lobes of a view.

use crate::family::layout::{Layout, Views};
use crate::family::lobes::Lobes;
use crate::family::tuning::start::{BRIGHTEST, FAINT, SWEEPS};
use crate::table::{View, luminance};

/// Number `i` of a geometric series of `count` numbers.
pub(crate) fn series(low: f64, high: f64, i: usize, count: usize) -> f64 {
    let t = if count > 1 { i as f64 / (count - 1) as f64 } else { 0.5 };
    libm::exp(libm::log(low) + t * (libm::log(high) - libm::log(low)))
}

/// Gives lobes and diffuse term of the unknowns `q` the best colours for a view, in which the lobes have shapes as in `lobes`.
/// `sharpness`: that of each lobe. `least`: the least luminance.
pub(crate) fn paint<V: Views>(
    layout: &Layout<V>,
    (view, lobes): (&View, &Lobes),
    sharpness: &[f64],
    least: f64,
    q: &mut [f64],
) {
    let found = best_amplitudes(view, lobes, layout.lobes + 1);
    let color = |k: usize| [0, 1, 2].map(|c| found[c][k]);
    let largest = (0..=layout.lobes).map(|k| luminance(color(k))).fold(least, f64::max);
    for (k, sharpness) in sharpness.iter().enumerate() {
        let faint = FAINT * largest / sharpness.max(1.0);
        layout.set_tint(q, k, color(k), faint);
    }
    let faint = 1e-3 * luminance(view.albedo).max(0.0) + least;
    layout.set_tint(q, layout.lobes, color(layout.lobes), faint);
}

/// Darkens a view that is too bright for a start.
pub(crate) fn dim<V: Views>(layout: &Layout<V>, q: &mut [f64]) {
    let most = layout.albedo(q, None).into_iter().fold(0.0, f64::max);
    if most > BRIGHTEST {
        layout.darken(q, libm::log(most / BRIGHTEST));
    }
}

/// Best non-negative amplitudes of the first `count` of lobes and diffuse term, per channel, by coordinate descent on the normal
/// equations.
fn best_amplitudes(view: &View, lobes: &Lobes, count: usize) -> [Vec<f64>; 3] {
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
    use crate::isotropic::line;
    use crate::table::{Table, direction};

    #[test]
    fn amplitudes_of_lobes_that_made_the_table_are_found_again() {
        let layout = line::Layout::new(3, 1, 0, vec![0.0, 1.0]);
        let mut q = vec![0.0; layout.stride()];
        q[0] = libm::log(libm::cos(0.6));
        for (k, (sharpness, lean)) in [(40.0, 1.0), (5.0, 0.5), (1.5, 0.0)].into_iter().enumerate() {
            (q[layout.angle(k)], q[layout.sharpness(k)]) = (0.6 * lean, libm::log(sharpness));
        }
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
