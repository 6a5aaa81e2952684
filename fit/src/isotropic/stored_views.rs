//! Where the stored views of a material lie that can be evaluated anywhere.
//!
//! Between stored views the logarithms of sharpness and amplitude are straight lines. So the error there goes with the square of
//! the distance times the second derivative of the mixture. Two numbers of a view stand for that: the logarithm of its albedo and
//! that of its root mean square, which a peak's height and width decide. Their second derivatives by the angle are known before
//! anything is fitted; a mixture of its square root (equal errors) and of a density that rises towards grazing says how many
//! stored views belong where.
//!
//! Where exactly is a matter of energy. Measured tables are straight lines themselves, between rows that are some degrees apart.
//! The albedo of a channel that has a kink (vch_golden_yellow's blue at 45 degrees) wants a stored view there. So the stored views
//! are those of all probes whose intervals have the least sum of two terms. These are the square of an interval's share of that
//! density, and the fourth power of the bend of its albedo. The least sum is found by dynamic programming (Bellman and Roth 1969,
//! Curve fitting by segmented straight lines).
//!
//! At the normal an isotropic mixture is the same at every azimuth. Some measured tables are not, however near they come to it. For
//! those, a fit with factors has one more stored view next to the normal. Else the mixture of the normal would be blended with others
//! up to the next view.

use crate::FitError;
use crate::isotropic::tuning::stored_views::{
    APART, BULGE, BY_ANGLE, CROOKED, FINER, GRAZING, NEAR_NORMAL, PROBED, PROBED_INTERVALS, SKEWED, SMOOTHED,
    SPAN, WIDEST, WIDEST_MEAN,
};
use crate::table::Table;
use crate::table::albedo_log::Ratio;
use crate::table::luminance;
use crate::table::{Brdf, Density};

/// A material at the probes.
pub(crate) struct Probes {
    /// Angles, radians, and the albedo there.
    pub albedo: Vec<(f64, [f64; 3])>,
    /// Logarithm of the albedo of each channel with the luminance added: a dark channel of a bright colour hardly counts.
    ln_albedo: Vec<[f64; 3]>,
    /// Integral of the density of stored views up to each.
    integral: Vec<f64>,
    /// Whether the table depends on the azimuth next to the normal.
    is_skewed: bool,
}

impl Probes {
    /// Probes a material from 0 to `last` radians, densely enough for `views` views and twice as many. Albedos of grazing views are integrated
    /// as densely as asked for.
    ///
    /// # Errors
    /// As [`Table::from_brdf`].
    pub fn new(brdf: &dyn Brdf, last: f64, views: usize, dense: Density) -> Result<Self, FitError> {
        let multiple = (FINER * views).div_ceil(PROBED_INTERVALS).max(1);
        let intervals = multiple * PROBED_INTERVALS;
        let step = last / intervals as f64;
        let mut thetas: Vec<f64> = (0..=intervals).map(|i| step * i as f64).collect();
        thetas[intervals] = last;
        let mut table = Table::from_brdf(brdf, &thetas, PROBED)?;
        let grazing = thetas.partition_point(|theta| *theta < GRAZING.to_radians());
        if grazing < thetas.len() {
            let fine = Table::from_brdf(brdf, &thetas[grazing..], dense)?;
            table.views[grazing..]
                .iter_mut()
                .zip(fine.views)
                .for_each(|(view, fine)| view.albedo = fine.albedo);
        }
        let ratio = Ratio::new(table.views.iter().map(|view| view.albedo));
        let ln_albedo = table.views.iter().map(|view| {
            let bright = luminance(view.albedo).max(0.0);
            view.albedo.map(|a| libm::log(ratio.shifted(a) + bright))
        });
        let ln_albedo = ln_albedo.collect();
        let integral = integral(&table, step, multiple);
        let albedo = table.views.iter().map(|view| (view.theta, view.albedo)).collect();
        let is_skewed = table.views[0].floor > SKEWED;
        Ok(Self { albedo, ln_albedo, integral, is_skewed })
    }

    /// Where one more stored view lies, if the table needs one next to the normal.
    pub fn next_to_normal(&self) -> Option<f64> {
        self.is_skewed.then_some(NEAR_NORMAL.to_radians())
    }

    /// Places `count` stored views, at least 2, from the first probe to the last.
    pub fn place(&self, count: usize) -> Vec<f64> {
        let probes = self.albedo.len();
        let intervals = (count.max(2) - 1).min((probes - 1) / APART);
        let equal = self.integral[probes - 1] / intervals as f64;
        let last = self.albedo[probes - 1].0;
        let widest = WIDEST.to_radians().max(WIDEST_MEAN * last / intervals as f64);
        let cost = |from: usize, to: usize| {
            if self.albedo[to].0 - self.albedo[from].0 > widest {
                return f64::INFINITY;
            }
            let share = (self.integral[to] - self.integral[from]) / equal;
            share * share + (self.crooked(from, to) / CROOKED).powi(4)
        };
        let costs: Vec<Vec<f64>> =
            (0..probes).map(|to| (0..to).map(|from| cost(from, to)).collect()).collect();

        // Least cost of a number of intervals up to each probe, and the begin of the last of them.
        let mut least = vec![f64::INFINITY; probes];
        least[0] = 0.0;
        let mut begins = Vec::with_capacity(intervals);
        for _ in 0..intervals {
            let best = |to: usize| {
                let begin = |from: usize| (least[from] + costs[to][from], from);
                let begins = (0..(to + 1).saturating_sub(APART)).map(begin);
                begins.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, 0))
            };
            let (costs, begin): (Vec<f64>, Vec<usize>) = (0..probes).map(best).unzip();
            least = costs;
            begins.push(begin);
        }
        let mut view_angles = vec![probes - 1];
        for begin in begins.iter().rev() {
            view_angles.push(begin[view_angles[view_angles.len() - 1]]);
        }
        view_angles.iter().rev().map(|&probe| self.albedo[probe].0).collect()
    }

    /// Farthest that a channel's albedo is from a straight line between two probes, in its logarithm. The logarithm of a sum of
    /// lobes between two stored views is convex, and cannot follow what bulges upwards.
    fn crooked(&self, from: usize, to: usize) -> f64 {
        let (a, b) = (self.ln_albedo[from], self.ln_albedo[to]);
        let off = |i: usize| {
            let blend = (i - from) as f64 / (to - from) as f64;
            let off = |c: usize| {
                let above = self.ln_albedo[i][c] - (a[c] + blend * (b[c] - a[c]));
                if above > 0.0 { BULGE * above } else { -above }
            };
            off(0).max(off(1)).max(off(2))
        };
        (from + 1..to).map(off).fold(0.0, f64::max)
    }
}

/// Integral of the density of stored views up to every view of a table, views a step apart from the normal on.
fn integral(table: &Table, step: f64, multiple: usize) -> Vec<f64> {
    let logs: Vec<[f64; 2]> = table
        .views
        .iter()
        .map(|view| {
            let square: f64 = view
                .samples
                .iter()
                .map(|s| {
                    s.weight * s.rgb.iter().map(|v| v * v).sum::<f64>() * s.direction[2] * s.direction[2]
                })
                .sum();
            [view.albedo.iter().sum::<f64>(), libm::sqrt(square)].map(|v| libm::log(v.max(1e-12)))
        })
        .collect();

    // Odd and even continuations are the same at the normal: the table is symmetric there.
    let count = logs.len();
    let span = (multiple * SPAN) as isize;
    let at = |i: isize| logs[i.unsigned_abs().min(count - 1)];
    let bend = |i: isize| {
        let i = i.clamp(0, count as isize - 1 - span);
        let (before, here, after) = (at(i - span), at(i), at(i + span));
        let second = [0, 1].map(|n| (before[n] - 2.0 * here[n] + after[n]) / (span as f64 * step).powi(2));
        libm::sqrt(libm::hypot(second[0], second[1]))
    };
    let reach = (multiple * SMOOTHED) as isize;
    let smooth = |i: usize| (-reach..=reach).map(|n| bend(i as isize + n)).sum::<f64>();
    let density: Vec<f64> = (0..count).map(smooth).collect();
    let base: Vec<f64> = table.views.iter().map(|view| 1.0 / libm::sqrt(libm::cos(view.theta))).collect();
    let mean = |v: &[f64]| (v.iter().sum::<f64>() / count as f64).max(1e-12);
    let (bends, angles) = ((1.0 - BY_ANGLE) / mean(&density), BY_ANGLE / mean(&base));
    let density: Vec<f64> = density.iter().zip(&base).map(|(d, b)| bends * d + angles * b).collect();
    let mut integral = vec![0.0; count];
    for i in 1..count {
        integral[i] = integral[i - 1] + 0.5 * (density[i - 1] + density[i]);
    }
    integral
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A diffuse surface whose brightness has a step at an angle of the outgoing direction.
    struct Step(f64);

    impl Brdf for Step {
        fn evaluate(&self, _: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
            [0.1 + 0.1 / (1.0 + libm::exp(-40.0 * (libm::acos(wo[2]) - self.0))); 3]
        }
    }

    #[test]
    fn views_rise_between_the_ends_and_gather_where_something_changes() {
        for at in [0.4, 1.0] {
            let view_angles = Probes::new(&Step(at), 1.5, 14, PROBED).unwrap().place(14);
            assert!(
                view_angles.len() == 14 && view_angles[0] == 0.0 && view_angles[13] == 1.5,
                "{view_angles:?}"
            );
            assert!(view_angles.windows(2).all(|w| w[1] - w[0] > 0.01), "{view_angles:?}");
            let near = |centre: f64| view_angles.iter().filter(|k| (**k - centre).abs() < 0.15).count();
            assert!(near(at) >= 4 && near(at) > near(1.4 - at), "{at}: {view_angles:?}");
        }
        let probes = Probes::new(&Step(0.4), 1.5, 100, PROBED).unwrap();
        assert_eq!(probes.place(2), [0.0, 1.5]);
        assert!((100..=200).step_by(50).all(|count| probes.place(count).len() == count));
    }

    /// A diffuse surface of which one channel rises from an angle of the outgoing direction on.
    struct Kink(f64);

    impl Brdf for Kink {
        fn evaluate(&self, _: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
            [0.1, 0.1, 0.1 * libm::exp(5.0 * (libm::acos(wo[2]) - self.0).max(0.0))]
        }
    }

    #[test]
    fn a_kink_of_one_channel_has_a_view() {
        for at in [0.3, 0.77, 1.1] {
            let view_angles = Probes::new(&Kink(at), 1.5, 8, PROBED).unwrap().place(8);
            assert!(view_angles.iter().any(|stored| (stored - at).abs() < 0.01), "{at}: {view_angles:?}");
        }
    }
}
