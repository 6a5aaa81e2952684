//! Out of a local minimum: the lobe that is missed least is put where it is missed most.
//!
//! The worth of a lobe at a view is the growth of the sum of squares when the lobe is taken out. The amplitudes of all others are
//! chosen again then: `a^2 / (G^-1)_kk` with the Gram matrix G of the unit lobes. Of two lobes that have merged, each is worth
//! nothing. The new lobe is one of a few families (sharpness and lean constant over the views, beside a lobe that is there, or
//! along a peak that no lobe has, `stray`), the one that alone would reduce the residual most. Then all lobes are moved downhill together; if that ends higher than before,
//! all is put back.

mod stray;

use crate::family::lobes::Lobes;
use crate::family::objective::data_term::{self, Point};
use crate::family::objective::{Weighted, Weights};
use crate::isotropic::line::{Line, Objective};
use crate::isotropic::tuning::exchange::{
    CAUTION, FAMILIES, IMPROVEMENT, PATIENCE, STRAY, STRAY_LN_SHARPNESS,
};
use crate::numeric::levenberg::{Limits, minimize};
use crate::numeric::random::Random;
use crate::table::luminance;
use rayon::prelude::*;
use stray::Track;

/// A family of lobes: one for every view.
#[derive(Clone, Copy, Debug)]
enum Family<'a> {
    /// The same sharpness at all views, and an axis in proportion to the angle of the view; so far off the plane if mirrored.
    Alone { ln_sharpness: f64, lean: f64, off_plane: f64 },
    /// A copy of a lobe at every view, with a factor on the sharpness, moved by a share of its width: along the plane, or off
    /// it if mirrored.
    Beside { lobe: usize, ln_sharper: f64, widths: f64 },
    /// The same sharpness at all views, and an axis along a stray peak.
    Along { track: &'a Track, ln_sharpness: f64 },
}

/// The residual of one view.
struct Residual {
    theta: f64,
    q: Vec<f64>,
    /// Target minus value of the lobes, per channel, for every sample. A lobe that was taken out has no value.
    left: Vec<[f64; 3]>,
    worth: Vec<f64>,
}

/// Exchanges lobes up to `rounds` times, for families that follow from `seed`; `tick` is called after each step of the solver.
/// Returns the cost.
pub(crate) fn exchange(
    objective: &Objective,
    x: &mut Vec<f64>,
    cost: f64,
    (rounds, limits, weights): (usize, Limits, Weights),
    seed: u64,
    mut tick: impl FnMut(),
) -> f64 {
    let layout = &objective.layout;
    let mut random = Random::new(0xe8c4 + seed);
    let mut cost = cost;
    // Slots that were tried in vain since the last success.
    let mut vain: Vec<usize> = Vec::new();
    for _ in 0..rounds {
        let mut residuals: Vec<Residual> = objective.residuals(x);
        let worth = |k: usize| residuals.iter().map(|r| r.worth[k]).sum::<f64>();
        if vain.len() >= PATIENCE {
            break;
        }
        let slot = (0..layout.lobes)
            .filter(|&k| !vain.contains(&k) && layout.defensive() != Some(k))
            .min_by(|&a, &b| worth(a).total_cmp(&worth(b)));
        let Some(slot) = slot else { break };
        objective.take_out(&mut residuals, slot);
        let track = Track::find(&objective.views, &residuals);
        let along = track.iter().flat_map(Family::along);
        let families: Vec<Family<'_>> = (0..FAMILIES)
            .map(|n| Family::random(&mut random, n % 2 == 1, layout.lobes))
            .chain(along)
            .collect();
        let gain = |f: &Family<'_>| objective.gain(&residuals, slot, *f);
        let gains: Vec<f64> = families.par_iter().map(gain).collect();
        let best = (0..families.len()).max_by(|&a, &b| gains[a].total_cmp(&gains[b])).unwrap_or(0);
        let mut moved = x.clone();
        objective.put(&residuals, slot, families[best], &mut moved);
        let (reached, _) = minimize(&Weighted { objective, weights }, &mut moved, limits, &mut tick);
        if reached < cost * (1.0 - IMPROVEMENT) {
            cost = reached;
            *x = moved;
            vain.clear();
        } else {
            vain.push(slot);
        }
    }
    cost
}

impl<'a> Family<'a> {
    /// Families along a stray peak, from wide to narrow.
    fn along(track: &'a Track) -> impl Iterator<Item = Self> {
        (0..STRAY).map(move |n| {
            let (wide, narrow) = STRAY_LN_SHARPNESS;
            let ln_sharpness = wide + (narrow - wide) * n as f64 / (STRAY - 1) as f64;
            Self::Along { track, ln_sharpness }
        })
    }

    fn random(random: &mut Random, is_beside: bool, lobes: usize) -> Self {
        let ln_sharpness = 0.5 + 12.0 * random.uniform();
        // Sharp lobes follow the mirror direction, wide ones may point anywhere between.
        let spread = 1.0 / (1.0 + 0.2 * ln_sharpness);
        let lean = 1.05 - spread * 2.0 * random.uniform();
        let lobe = ((random.uniform() * lobes as f64) as usize).min(lobes - 1);
        let (ln_sharper, widths) = (4.0 * random.uniform() - 2.0, 3.0 * random.uniform() - 1.5);
        let off_plane = random.uniform();
        if is_beside {
            Self::Beside { lobe, ln_sharper, widths }
        } else {
            Self::Alone { ln_sharpness, lean, off_plane }
        }
    }

    /// The unknowns of a view with the family in a slot, amplitudes as they were.
    fn shape(&self, objective: &Objective, slot: usize, theta: f64, q: &mut [f64]) {
        let layout = &objective.layout;
        let mirrored = slot.checked_sub(layout.first_aside());
        let (angle, off_plane, ln_sharpness) = match *self {
            Self::Alone { ln_sharpness, lean, off_plane } => (lean * theta, off_plane * theta, ln_sharpness),
            Self::Along { track, ln_sharpness } => (track.at(theta), 0.0, ln_sharpness),
            Self::Beside { lobe, ln_sharper, widths } => {
                let ln_sharpness = q[layout.sharpness(lobe)];
                let moved = widths * libm::exp(-0.5 * ln_sharpness);
                let along = if mirrored.is_some() { 0.0 } else { moved };
                (q[layout.angle(lobe)] + along, moved.abs(), ln_sharpness + ln_sharper)
            }
        };
        // At the normal every axis is the normal.
        let is_free = f64::from(u8::from(theta != 0.0));
        q[layout.angle(slot)] = is_free * angle;
        if let Some(m) = mirrored {
            q[layout.off_plane(m)] = is_free * off_plane;
        }
        q[layout.sharpness(slot)] = ln_sharpness;
    }
}

impl Objective {
    /// The squeezed lobe that would be missed least; none if there is none.
    pub fn least_missed(&self, x: &[f64]) -> Option<usize> {
        let residuals = self.residuals(x);
        let worth = |k: usize| residuals.iter().map(|r| r.worth[k]).sum::<f64>();
        (0..self.layout.squeezed).min_by(|&a, &b| worth(a).total_cmp(&worth(b)))
    }

    fn residuals(&self, x: &[f64]) -> Vec<Residual> {
        let layout = &self.layout;
        let count = layout.lobes + 1;
        let view = |data: &crate::family::objective::Data<Line>| {
            let mut q = vec![0.0; layout.stride()];
            layout.interpolate(x, data.place, &mut q);
            let lobes = Lobes::new(layout, &q);
            let amplitudes = layout.amplitudes(&q);
            let values = data_term::values(&lobes, &amplitudes, &data.panels);
            let difference = |(p, v): (&Point, &[f64; 3])| [0, 1, 2].map(|c| p.aim[c] - v[c]);
            let left = data.points.iter().zip(&values).map(difference).collect();
            // Of all derivatives, the values themselves.
            let sums = data_term::sums(&lobes, &amplitudes, &data.panels);
            let width = lobes.slopes_len();
            let column = |k: usize| if k < layout.lobes { 2 * layout.lobes + k } else { width - 1 };
            let product = |n: usize| sums.gram[column(n / count) * width + column(n % count)];
            let gram: Vec<f64> = (0..count * count).map(product).collect();
            let inverse = inverse_diagonal(&gram, count);
            let power = |k: usize| amplitudes.iter().map(|a| a[k] * a[k]).sum::<f64>();
            let worth = (0..layout.lobes).map(|k| power(k) / inverse[k]).collect();
            Residual { theta: layout.theta(data.place), q, left, worth }
        };
        self.views.par_iter().map(view).collect()
    }

    /// Adds the value of the lobe in a slot to the residuals.
    fn take_out(&self, residuals: &mut [Residual], slot: usize) {
        for (view, residual) in self.views.iter().zip(residuals) {
            let lobe = Lobes::alone(&self.layout, &residual.q, slot);
            // Without the diffuse term.
            let amplitudes = self.layout.amplitudes(&residual.q).map(|a| vec![a[slot], 0.0]);
            let values = data_term::values(&lobe, &amplitudes, &view.panels);
            for (left, value) in residual.left.iter_mut().zip(values) {
                (0..3).for_each(|c| left[c] += value[c]);
            }
        }
    }

    /// Best amplitudes of a family at a view, in place of the lobe in a slot, and the decrease of the sum of squares.
    fn best(&self, view: usize, residual: &Residual, slot: usize, family: Family<'_>) -> ([f64; 3], f64) {
        let layout = &self.layout;
        let mut q = residual.q.clone();
        family.shape(self, slot, residual.theta, &mut q);
        let (lobe, panels) = (Lobes::alone(layout, &q, slot), &self.views[view].panels);
        let (square, moment) = data_term::projection(&lobe, panels, &residual.left);
        let amplitude = moment.map(|m| if square > 0.0 { m / square } else { 0.0 });
        // A lobe without luminance has no colour either.
        if luminance(amplitude) <= 0.0 {
            return ([0.0; 3], 0.0);
        }
        (amplitude, amplitude.iter().map(|a| a * a * square).sum())
    }

    fn gain(&self, residuals: &[Residual], slot: usize, family: Family<'_>) -> f64 {
        residuals.iter().enumerate().map(|(n, r)| self.best(n, r, slot, family).1).sum()
    }

    fn put(&self, residuals: &[Residual], slot: usize, family: Family<'_>, x: &mut [f64]) {
        let layout = &self.layout;
        let p = layout.stride();
        let found: Vec<[f64; 3]> =
            residuals.iter().enumerate().map(|(n, r)| self.best(n, r, slot, family).0).collect();
        let largest = found.iter().map(|color| luminance(*color)).fold(1e-9, f64::max);
        for (stored, &theta) in layout.views.angles.iter().enumerate() {
            let q = &mut x[stored * p..(stored + 1) * p];
            family.shape(self, slot, theta, q);
            let closer = |a: &usize, b: &usize| {
                (residuals[*a].theta - theta).abs().total_cmp(&(residuals[*b].theta - theta).abs())
            };
            let Some(near) = (0..residuals.len()).min_by(closer) else { continue };
            layout.set_tint(q, slot, found[near].map(|a| CAUTION * a), 1e-4 * largest);
        }
    }
}

/// Diagonal of the inverse of a symmetric matrix of which the lower half is given, by Gauss-Jordan elimination with a little
/// added to the diagonal.
fn inverse_diagonal(lower: &[f64], n: usize) -> Vec<f64> {
    let mut a = vec![0.0; n * n];
    let mut inverse = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..n {
            a[i * n + j] = if i >= j { lower[i * n + j] } else { lower[j * n + i] };
        }
        a[i * n + i] = a[i * n + i] * (1.0 + 1e-9) + 1e-30;
        inverse[i * n + i] = 1.0;
    }
    for k in 0..n {
        let pivot = 1.0 / a[k * n + k];
        for j in 0..n {
            a[k * n + j] *= pivot;
            inverse[k * n + j] *= pivot;
        }
        for i in (0..n).filter(|&i| i != k) {
            let factor = a[i * n + k];
            for j in 0..n {
                a[i * n + j] -= factor * a[k * n + j];
                inverse[i * n + j] -= factor * inverse[k * n + j];
            }
        }
    }
    (0..n).map(|i| inverse[i * n + i].max(1e-300)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::family::objective::Emphasis;
    use crate::isotropic::line::Layout;
    use crate::table::{Table, direction};

    #[test]
    fn the_diagonal_of_an_inverse_is_that_of_the_inverse() {
        // [4 1; 1 3] has the inverse [3 -1; -1 4] / 11; the upper half is not read.
        let found = inverse_diagonal(&[4.0, f64::NAN, 1.0, 3.0], 2);
        assert!((found[0] - 3.0 / 11.0).abs() < 1e-8 && (found[1] - 4.0 / 11.0).abs() < 1e-8, "{found:?}");
    }

    /// Two lobes lie on one of two peaks: no step downhill parts them.
    #[test]
    fn of_two_lobes_on_one_peak_one_is_put_on_the_other() {
        let layout = Layout::new(2, 2, 0, vec![0.0, 0.5, 1.0]);
        let peak = |d: [f64; 3], angle: f64| {
            let axis = direction(angle, 0.0);
            libm::exp(60.0 * ((0..3).map(|k| d[k] * axis[k]).sum::<f64>() - 1.0)) / d[2]
        };
        let mut views = vec![];
        for theta in [0.45, 0.55] {
            let grid = (0..15).flat_map(|t| (0..12).map(move |p| (0.1 * f64::from(t), 0.28 * f64::from(p))));
            let value = |d| peak(d, theta) + peak(d, 0.1 * theta);
            views.push((theta, grid.map(|(t, p)| direction(t, p)).map(|d| (d, [value(d); 3])).collect()));
        }
        let table = Table::from_scattered(views).unwrap();
        let objective = Objective::new(
            &table,
            layout.clone(),
            Emphasis { tail: 0.03, measure: 0.0, energy: 1.0, is_dense: false },
            None,
        )
        .unwrap();
        let mut x = vec![0.0; layout.len()];
        for (stored, theta) in [0.0, 0.5, 1.0].into_iter().enumerate() {
            let q = &mut x[stored * layout.stride()..];
            for k in 0..2 {
                q[layout.angle(k)] = theta;
                q[layout.sharpness(k)] = libm::log(60.0);
                layout.set_tint(q, k, [0.5; 3], 0.0);
            }
            q[layout.diffuse()] = -8.0;
        }
        let weights = Weights { smoothness: 1e-6, energy: 1.0, faint_color: 1e-3 };
        let limits = Limits { steps: 60, improvement: 1e-4 };
        let (before, _) = minimize(&Weighted { objective: &objective, weights }, &mut x, limits, || {});
        let after = exchange(&objective, &mut x, before, (8, limits, weights), 0, || {});
        assert!(after < 0.2 * before, "{before} {after}");
    }
}
