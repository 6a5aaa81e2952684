//! Where the knots of a material lie that can be evaluated anywhere.
//!
//! Between knots the logarithms of sharpness and amplitude are straight lines, so the error there goes with the square of the
//! distance times the second derivative of what they make. Two numbers of a view stand for that: the logarithm of its albedo
//! and that of its root mean square, which a peak's height and width decide. Their second derivatives by the angle are known
//! before anything is fitted; knots get equal shares of a mixture of its square
//! root (equal errors) and of a density that rises towards grazing.

use crate::FitError;
use crate::table::Table;
use crate::table::evaluable::{Brdf, Density};

/// Views at which the material is looked at.
const PROBES: usize = 60;

/// How densely each is looked at.
const PROBED: Density = Density { hemisphere: 150, cap: 50 };

/// Share of the knots that are placed by the angle alone, as `1 / sqrt(cos)`: towards grazing, highlights stretch.
const BY_ANGLE: f64 = 0.5;

/// Half the number of neighbours over which the density of knots is smoothed: noise has second derivatives too.
const SMOOTHED: usize = 2;

/// Places `count` knots, at least 2, from 0 to `last` radians.
///
/// # Errors
/// As [`Table::from_brdf`].
pub(crate) fn place(brdf: &dyn Brdf, count: usize, last: f64) -> Result<Vec<f64>, FitError> {
    let step = last / (PROBES - 1) as f64;
    let thetas: Vec<f64> = (0..PROBES).map(|i| step * i as f64).collect();
    let table = Table::from_brdf(brdf, &thetas, PROBED)?;
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
    let at = |i: isize| logs[i.unsigned_abs().min(PROBES - 1)];
    let bend = |i: isize| {
        let i = i.clamp(0, PROBES as isize - 2);
        let (before, here, after) = (at(i - 1), at(i), at(i + 1));
        let second = [0, 1].map(|n| (before[n] - 2.0 * here[n] + after[n]) / (step * step));
        libm::sqrt(libm::hypot(second[0], second[1]))
    };
    let reach = SMOOTHED as isize;
    let smooth = |i: usize| (-reach..=reach).map(|n| bend(i as isize + n)).sum::<f64>();
    let density: Vec<f64> = (0..PROBES).map(smooth).collect();
    let base: Vec<f64> = thetas.iter().map(|theta| 1.0 / libm::sqrt(libm::cos(*theta))).collect();
    let mean = |v: &[f64]| (v.iter().sum::<f64>() / PROBES as f64).max(1e-12);
    let (bends, angles) = ((1.0 - BY_ANGLE) / mean(&density), BY_ANGLE / mean(&base));
    let density: Vec<f64> = density.iter().zip(&base).map(|(d, b)| bends * d + angles * b).collect();

    // Equal shares of the integral, by straight lines between the probes.
    let mut integral = vec![0.0; PROBES];
    for i in 1..PROBES {
        integral[i] = integral[i - 1] + 0.5 * (density[i - 1] + density[i]);
    }
    let intervals = count.max(2) - 1;
    let knot = |n: usize| {
        let share = integral[PROBES - 1] * n as f64 / intervals as f64;
        let i = integral.partition_point(|v| *v <= share).clamp(1, PROBES - 1);
        let blend = (share - integral[i - 1]) / (integral[i] - integral[i - 1]);
        if n == intervals { last } else { step * ((i - 1) as f64 + blend.clamp(0.0, 1.0)) }
    };
    Ok((0..=intervals).map(knot).collect())
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
            let knots = place(&Step(at), 14, 1.5).unwrap();
            assert!(knots.len() == 14 && knots[0] == 0.0 && knots[13] == 1.5, "{knots:?}");
            assert!(knots.windows(2).all(|w| w[1] - w[0] > 0.01), "{knots:?}");
            let near = |centre: f64| knots.iter().filter(|k| (**k - centre).abs() < 0.15).count();
            assert!(near(at) >= 4 && near(at) > near(1.4 - at), "{at}: {knots:?}");
        }
        assert_eq!(place(&Step(0.4), 2, 1.5).unwrap(), [0.0, 1.5]);
    }
}
