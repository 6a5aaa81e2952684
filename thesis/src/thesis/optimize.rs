//! The fit of section 4.1.1: axes, sharpness and amplitudes in turn, each by L-BFGS-B, until an iteration gains little.
//!
//! The objective is equation 7, the squared difference of f over the measured texels by solid angle, here relative to
//! the data's. The sharpness is fitted by its logarithm, amplitudes relative to the largest value: unknowns of the order
//! of 1, which is kind to the solver and changes no minimum. Axes have three components within [-1, 1] and are
//! normalised in the function. The three channels share axes and sharpness.

use super::ThesisSettings;
use super::cube::Cube;
use super::guess;
use super::kernel::{Slope, Texels};
use super::lobes::RoundLobe;
use crate::lbfgsb::minimize;
use srbf_fit::judge::report::Ending;

/// Least sharpness: wider than a hemisphere.
const WIDEST: f64 = 0.05;

/// Shortest axis that is normalised.
const SHORTEST: f64 = 1e-9;

/// A fitted view.
#[derive(Clone, Debug)]
pub(crate) struct Optimized {
    pub lobes: Vec<RoundLobe>,
    /// Evaluations of the function over all texels.
    pub evaluations: usize,
    /// Relative squared difference that was reached.
    pub cost: f64,
    pub ending: Ending,
}

/// Fits lobes to a vector. A black one has none.
///
/// Values are fitted as multiples of a power of two next to the largest. So no square is lost at either end of the range of f64,
/// and no digit changes.
pub(crate) fn fit(cube: &Cube, values: &[[f64; 3]], settings: &ThesisSettings) -> Optimized {
    let exponent = libm::frexp(values.iter().flatten().copied().fold(0.0, f64::max)).1;
    let scaled = |rgb: [f64; 3], exponent| rgb.map(|v| libm::ldexp(v, exponent));
    let values: Vec<[f64; 3]> = values.iter().map(|rgb| scaled(*rgb, -exponent)).collect();
    let mut found = fit_scaled(cube, &values, settings);
    found.lobes.iter_mut().for_each(|lobe| lobe.amplitude = scaled(lobe.amplitude, exponent));
    found
}

fn fit_scaled(cube: &Cube, values: &[[f64; 3]], settings: &ThesisSettings) -> Optimized {
    let mut lobes = guess::guess(cube, values, settings.lobes, settings.coverage);
    if lobes.is_empty() {
        return Optimized { lobes, evaluations: 0, cost: 0.0, ending: Ending::Converged };
    }
    let texels = Texels::new(cube, values);
    let largest = values.iter().flatten().copied().fold(0.0, f64::max);
    let bounds = (WIDEST, guess::sharpest(cube));
    let mut slopes = vec![Slope::default(); lobes.len()];
    fit_amplitudes(&texels, &mut lobes, largest, settings.steps);
    let mut cost = texels.differentiate(&lobes, &mut slopes);
    let (mut evaluations, mut ending) = (2, Ending::Steps);
    for _ in 0..settings.iterations {
        evaluations += fit_axes(&texels, &mut lobes, settings.steps);
        evaluations += fit_sharpness(&texels, &mut lobes, bounds, settings.steps);
        fit_amplitudes(&texels, &mut lobes, largest, settings.steps);
        let before = cost;
        cost = texels.differentiate(&lobes, &mut slopes);
        evaluations += 2;
        if (before - cost).abs() < settings.threshold * before {
            ending = Ending::Converged;
            break;
        }
    }
    Optimized { lobes, evaluations, cost, ending }
}

/// Moves the axes; returns the evaluations.
fn fit_axes(texels: &Texels, lobes: &mut [RoundLobe], steps: u64) -> usize {
    let mut x: Vec<f64> = lobes.iter().flat_map(|l| l.axis).collect();
    let length = |raw: &[f64]| libm::sqrt(raw.iter().map(|v| v * v).sum()).max(SHORTEST);
    let moved = |x: &[f64]| -> Vec<RoundLobe> {
        let lobe = |(lobe, raw): (&RoundLobe, &[f64])| {
            let length = length(raw);
            RoundLobe { axis: [raw[0] / length, raw[1] / length, raw[2] / length], ..*lobe }
        };
        lobes.iter().zip(x.chunks_exact(3)).map(lobe).collect()
    };
    let function = |x: &[f64], gradient: &mut [f64]| {
        let lobes = moved(x);
        let mut slopes = vec![Slope::default(); lobes.len()];
        let cost = texels.differentiate(&lobes, &mut slopes);
        for (k, (lobe, Slope { q, .. })) in lobes.iter().zip(&slopes).enumerate() {
            // By the unnormalised axis: a change along it has no effect.
            let along: f64 = (0..3).map(|i| q[i] * lobe.axis[i]).sum();
            let scale = lobe.sharpness / length(&x[3 * k..3 * k + 3]);
            (0..3).for_each(|i| gradient[3 * k + i] = scale * (q[i] - along * lobe.axis[i]));
        }
        cost
    };
    let n = x.len();
    let evaluations = minimize(&mut x, &vec![-1.0; n], &vec![1.0; n], steps, function);
    let lobes_moved = moved(&x);
    lobes.copy_from_slice(&lobes_moved);
    evaluations
}

/// Changes the sharpness within bounds; returns the evaluations.
fn fit_sharpness(texels: &Texels, lobes: &mut [RoundLobe], (low, high): (f64, f64), steps: u64) -> usize {
    let mut x: Vec<f64> = lobes.iter().map(|l| libm::log(l.sharpness)).collect();
    let changed = |x: &[f64]| -> Vec<RoundLobe> {
        let lobe = |(lobe, x): (&RoundLobe, &f64)| RoundLobe { sharpness: libm::exp(*x), ..*lobe };
        lobes.iter().zip(x).map(lobe).collect()
    };
    let function = |x: &[f64], gradient: &mut [f64]| {
        let lobes = changed(x);
        let mut slopes = vec![Slope::default(); lobes.len()];
        let cost = texels.differentiate(&lobes, &mut slopes);
        for (g, (lobe, Slope { q, p })) in gradient.iter_mut().zip(lobes.iter().zip(&slopes)) {
            *g = lobe.sharpness * ((0..3).map(|i| q[i] * lobe.axis[i]).sum::<f64>() - p);
        }
        cost
    };
    let n = x.len();
    let evaluations = minimize(&mut x, &vec![libm::log(low); n], &vec![libm::log(high); n], steps, function);
    let lobes_changed = changed(&x);
    lobes.copy_from_slice(&lobes_changed);
    evaluations
}

/// Changes the amplitudes. They enter the cost as a quadratic form, which is summed over the texels once.
fn fit_amplitudes(texels: &Texels, lobes: &mut [RoundLobe], scale: f64, steps: u64) {
    let k = lobes.len();
    let (gram, moment) = texels.normal_equations(lobes);
    let mut x: Vec<f64> = (0..3 * k).map(|i| lobes[i % k].amplitude[i / k] / scale).collect();
    let function = |x: &[f64], gradient: &mut [f64]| {
        let mut cost = 1.0;
        for c in 0..3 {
            for i in 0..k {
                let row: f64 = (0..k).map(|j| gram[i.max(j) * k + i.min(j)] * scale * x[c * k + j]).sum();
                let m = moment[c * k + i];
                cost += scale * x[c * k + i] * (row - 2.0 * m);
                gradient[c * k + i] = 2.0 * scale * (row - m);
            }
        }
        cost
    };
    // Evaluations cost next to nothing here.
    minimize(&mut x, &vec![0.0; 3 * k], &vec![f64::INFINITY; 3 * k], 10 * steps, function);
    for (i, v) in x.into_iter().enumerate() {
        lobes[i % k].amplitude[i / k] = scale * v;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::thesis::lobes::evaluate;
    use srbf_fit::table::direction;

    fn planted() -> Vec<RoundLobe> {
        let lobe = |theta: f64, azimuth, sharpness, amplitude| RoundLobe {
            axis: direction(theta, azimuth),
            sharpness,
            amplitude,
        };
        vec![
            lobe(0.9, 0.1, 60.0, [3.0, 2.0, 1.0]),
            lobe(0.7, 2.6, 15.0, [0.5, 1.5, 2.0]),
            lobe(0.2, 0.3, 2.0, [0.3, 0.2, 0.4]),
        ]
    }

    #[test]
    fn a_planted_mixture_is_found_again_to_less_than_a_percent() {
        let cube = Cube::new(32);
        let values: Vec<[f64; 3]> = cube.directions.iter().map(|d| evaluate(&planted(), d)).collect();
        let settings =
            ThesisSettings { lobes: 3, iterations: 300, threshold: 1e-6, ..ThesisSettings::default() };
        let found = fit(&cube, &values, &settings);
        let error = libm::sqrt(found.cost);
        assert!(error < 0.01, "{error}: {found:?}");
        assert!(found.evaluations > 10);
    }

    /// At either end of the range of f64, where the square of a value is 0 or infinite.
    #[test]
    fn the_unit_of_the_values_does_not_matter() {
        let cube = Cube::new(16);
        let settings = ThesisSettings { lobes: 3, ..ThesisSettings::default() };
        let in_unit = |exponent: i32| {
            let value = |d: &[f64; 3]| evaluate(&planted(), d).map(|v| libm::ldexp(v, exponent));
            fit(&cube, &cube.directions.iter().map(value).collect::<Vec<_>>(), &settings)
        };
        let usual = in_unit(0);
        assert!(usual.cost < 0.1, "{usual:?}");
        for exponent in [-700, 700] {
            let mut found = in_unit(exponent);
            for lobe in &mut found.lobes {
                lobe.amplitude = lobe.amplitude.map(|a| libm::ldexp(a, -exponent));
            }
            assert_eq!((&found.lobes, found.cost), (&usual.lobes, usual.cost), "{exponent}");
        }
    }

    #[test]
    fn amplitudes_are_never_negative_and_bounds_hold() {
        // A value that no sum of lobes has: bright at one texel, black round it.
        let cube = Cube::new(8);
        let values: Vec<[f64; 3]> =
            (0..cube.directions.len()).map(|n| if n % 7 == 3 { [1.0, 0.5, 0.0] } else { [0.0; 3] }).collect();
        let found = fit(&cube, &values, &ThesisSettings { lobes: 6, ..ThesisSettings::default() });
        assert!(found.cost.is_finite() && found.cost < 1.0, "{found:?}");
        for lobe in &found.lobes {
            assert!(lobe.amplitude.iter().all(|a| *a >= 0.0 && a.is_finite()), "{lobe:?}");
            assert!(lobe.sharpness <= 1.001 * guess::sharpest(&cube) && lobe.sharpness >= 0.999 * WIDEST);
            let length: f64 = lobe.axis.iter().map(|v| v * v).sum();
            assert!((length - 1.0).abs() < 1e-9, "{lobe:?}");
        }
    }
}
