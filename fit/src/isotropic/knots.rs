//! Where the knots of a material lie that can be evaluated anywhere.
//!
//! Between knots the logarithms of sharpness and amplitude are straight lines, so the error there goes with the square of the
//! distance times the second derivative of what they make. Two numbers of a view stand for that: the logarithm of its albedo
//! and that of its root mean square, which a peak's height and width decide. Their second derivatives by the angle are known
//! before anything is fitted; a mixture of its square root (equal errors) and of a density that rises towards grazing says how
//! many knots belong where.
//!
//! Where exactly is a matter of energy. Measured tables are straight lines themselves, between rows that are some degrees
//! apart, and the albedo of a channel that has a kink (vch_golden_yellow's blue at 45 degrees) wants a knot there. So the knots
//! are those, of all at the probes, for which the intervals have the least sum of the square of their share of that density
//! and of the fourth power of how far their albedos are from straight, by dynamic programming (Bellman and Roth 1969, Curve fitting
//! by segmented straight lines).

use crate::FitError;
use crate::table::Table;
use crate::table::albedo_log::Ratio;
use crate::table::luminance;
use crate::table::{Brdf, Density};

/// Intervals between views at which the material is looked at, or a multiple: half a degree up to 87 degrees.
const PROBED_INTERVALS: usize = 174;

/// Least number of them over that of the material's views. Pairs of lobes pay for up to twice as many.
const FINER: usize = 4;

/// How densely each is looked at.
const PROBED: Density = Density { hemisphere: 150, cap: 50 };

/// Share of the knots that are placed by the angle alone, as `1 / sqrt(cos)`: towards grazing, highlights stretch.
const BY_ANGLE: f64 = 0.5;

/// Half degrees that a second difference spans on each side, and half the number over which the density of knots is smoothed:
/// noise has second derivatives too.
const SPAN: usize = 3;
const SMOOTHED: usize = 6;

/// Least number of probes from knot to knot.
const APART: usize = 2;

/// Angle that no two knots are farther apart by, degrees, or by as many times their mean distance: what lies between them is not known
/// from noise.
const WIDEST: f64 = 8.0;
const WIDEST_MEAN: f64 = 1.5;

/// Distance of an albedo from straight that weighs as much as an interval's equal share of the density; less of it hardly counts.
const CROOKED: f64 = 0.007;

/// What it counts where the albedo is above the line, over below.
const BULGE: f64 = 1.5;

/// A material as it looks from the probes.
pub(crate) struct Probes {
    /// Angles, radians, and the albedo there.
    pub albedo: Vec<(f64, [f64; 3])>,
    /// Logarithm of the albedo of each channel with the luminance added: what a dark channel of a bright colour does is not seen.
    ln_albedo: Vec<[f64; 3]>,
    /// Integral of the density of knots up to each.
    integral: Vec<f64>,
}

impl Probes {
    /// Looks at a material from 0 to `last` radians, closely enough for `views` views and twice as many.
    ///
    /// # Errors
    /// As [`Table::from_brdf`].
    pub fn new(brdf: &dyn Brdf, last: f64, views: usize) -> Result<Self, FitError> {
        let multiple = (FINER * views).div_ceil(PROBED_INTERVALS).max(1);
        let intervals = multiple * PROBED_INTERVALS;
        let step = last / intervals as f64;
        let mut thetas: Vec<f64> = (0..=intervals).map(|i| step * i as f64).collect();
        thetas[intervals] = last;
        let table = Table::from_brdf(brdf, &thetas, PROBED)?;
        let ratio = Ratio::new(table.views.iter().map(|view| view.albedo));
        let ln_albedo = table.views.iter().map(|view| {
            let bright = luminance(view.albedo).max(0.0);
            view.albedo.map(|a| libm::log(ratio.shifted(a) + bright))
        });
        let ln_albedo = ln_albedo.collect();
        let integral = integral(&table, step, multiple);
        let albedo = table.views.iter().map(|view| (view.theta, view.albedo)).collect();
        Ok(Self { albedo, ln_albedo, integral })
    }

    /// Places `count` knots, at least 2, from the first probe to the last.
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

        // Least cost of so many intervals up to each probe, and where the last of them begins.
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
        let mut knots = vec![probes - 1];
        for begin in begins.iter().rev() {
            knots.push(begin[knots[knots.len() - 1]]);
        }
        knots.iter().rev().map(|&probe| self.albedo[probe].0).collect()
    }

    /// Farthest that a channel's albedo is from a straight line between two probes, in its logarithm. The logarithm of a sum of
    /// lobes between two knots is convex, and cannot follow what bulges upwards.
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

/// Integral of the density of knots up to every view of a table, views a step apart from the normal on.
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
    fn knots_rise_between_the_ends_and_gather_where_something_changes() {
        for at in [0.4, 1.0] {
            let knots = Probes::new(&Step(at), 1.5, 14).unwrap().place(14);
            assert!(knots.len() == 14 && knots[0] == 0.0 && knots[13] == 1.5, "{knots:?}");
            assert!(knots.windows(2).all(|w| w[1] - w[0] > 0.01), "{knots:?}");
            let near = |centre: f64| knots.iter().filter(|k| (**k - centre).abs() < 0.15).count();
            assert!(near(at) >= 4 && near(at) > near(1.4 - at), "{at}: {knots:?}");
        }
        let probes = Probes::new(&Step(0.4), 1.5, 100).unwrap();
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
    fn a_kink_of_one_channel_has_a_knot() {
        for at in [0.3, 0.77, 1.1] {
            let knots = Probes::new(&Kink(at), 1.5, 8).unwrap().place(8);
            assert!(knots.iter().any(|knot| (knot - at).abs() < 0.01), "{at}: {knots:?}");
        }
    }
}
