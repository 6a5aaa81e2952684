//! A light learnt from samples, as a path guider learns it: a mixture of von Mises-Fisher distributions, fitted by expectation
//! maximisation.
//!
//! Such a distribution is a round lobe over its integral, so that lobes of `core` over the whole sphere are the mixture: they draw, and
//! give the density, sixteen directions at a time.

use glam::{DVec3, Vec3};
use srbf_core::{Domain, Draws, LightRows, LightSource, Lobe, Mixture, Towards};
use srbf_reference_renderer::numbers::random::Random;
use std::f64::consts::{PI, TAU};

/// Lobes of a learnt light.
const LOBES: usize = 16;

/// Rounds of the maximisation.
const ROUNDS: usize = 40;

/// Estimates of the radiance are above this part of the mean radiance, so that light which was never met can be drawn.
const FLOOR: f32 = 0.03;

/// Part of a lobe's share of the samples by which it is widened: lobes of few samples would become needles.
const PRIOR: f64 = 0.02;

/// A direction that was followed, and the radiance from there over the density that it was drawn with.
#[derive(Clone, Copy)]
pub struct Followed {
    pub direction: Vec3,
    pub weight: f32,
}

/// A mixture learnt from directions that were followed.
pub struct LearntLight {
    mixture: Mixture<'static, LOBES>,
    /// The integral of the radiance over the sphere.
    total: f32,
}

/// The integral of a lobe over the sphere, over its value at the axis.
fn integral(sharpness: f64) -> f64 {
    -TAU * (-2.0 * sharpness).exp_m1() / sharpness
}

impl LearntLight {
    /// Learns a light.
    ///
    /// # Errors
    /// Samples without light.
    pub fn learn(followed: &[Followed], random: &mut Random) -> anyhow::Result<Self> {
        let directions: Vec<DVec3> = followed.iter().map(|one| one.direction.as_dvec3()).collect();
        let weights: Vec<f64> = followed.iter().map(|one| f64::from(one.weight)).collect();
        let whole: f64 = weights.iter().sum();
        anyhow::ensure!(whole > 0.0 && whole.is_finite(), "no sample has light");
        // Each begins at a sample that is drawn by its weight.
        let mut lobes = [(DVec3::Z, 8.0, 1.0 / LOBES as f64); LOBES];
        for lobe in &mut lobes {
            let mut left = f64::from(random.unit()) * whole;
            let place = weights.iter().position(|weight| {
                left -= weight;
                left < 0.0
            });
            lobe.0 = directions[place.unwrap_or(0)];
        }
        for _ in 0..ROUNDS {
            let mut sums = [(DVec3::ZERO, 1e-12); LOBES];
            let scaled = lobes.map(|(axis, sharpness, share)| (axis, sharpness, share / integral(sharpness)));
            for (&d, &weight) in directions.iter().zip(&weights) {
                let density = scaled.map(|(axis, sharpness, amplitude)| {
                    amplitude * (-0.5 * sharpness * (d - axis).length_squared()).exp()
                });
                let all: f64 = density.iter().sum();
                for (sum, density) in sums.iter_mut().zip(density) {
                    let part = if all > 0.0 { weight * density / all } else { 0.0 };
                    sum.0 += d * part;
                    sum.1 += part;
                }
            }
            for (lobe, (mean, share)) in lobes.iter_mut().zip(sums) {
                let length = mean.length();
                // Banerjee and others 2005, the sharpness of the mean's length.
                let r = (length / (share + PRIOR * whole / LOBES as f64)).min(0.9995);
                let sharpness = (r * (3.0 - r * r) / (1.0 - r * r)).clamp(0.05, 2e4);
                *lobe = (mean.try_normalize().unwrap_or(lobe.0), sharpness, share / whole);
            }
        }
        let total = whole / followed.len() as f64;
        let made: Result<Vec<Lobe>, _> = lobes
            .iter()
            .map(|&(axis, sharpness, share)| {
                let amplitude = total * share / integral(sharpness);
                Lobe::new(axis.as_vec3().normalize(), sharpness as f32, Vec3::splat(amplitude as f32))
            })
            .collect();
        Ok(Self { mixture: Mixture::new(Domain::Sphere, 1.0, &[], &made?)?, total: total as f32 })
    }

    /// Draws a direction, with its density.
    #[inline]
    pub fn sample(&self, u: [f32; 3]) -> Option<(Vec3, f32)> {
        self.mixture.sample(u).map(|sample| (sample.direction, sample.pdf))
    }

    /// The density towards a direction; 1/sr.
    #[inline]
    pub fn pdf(&self, direction: Vec3) -> f32 {
        self.mixture.pdf(direction)
    }

    /// The estimate of the radiance where the density is known: that times the integral, and a floor.
    fn estimate(&self, count: usize, to: &mut LightRows) {
        let floor = FLOOR * self.total / (4.0 * PI) as f32;
        let mut radiance = to.pdf;
        radiance[..count].iter_mut().for_each(|pdf| *pdf = self.total * *pdf + floor);
        to.radiance = [radiance; 3];
    }
}

impl LightSource for LearntLight {
    fn sample_into(&self, u: [&[f32]; 3], to: &mut LightRows) {
        let count = u[0].len();
        let direction = to.direction.each_mut().map(|row| &mut row[..count]);
        let draws = Draws { u, direction, pdf: Some(&mut to.pdf[..count]), weight: None };
        self.mixture.ask(draws.into()).expect("slices of one length");
        self.estimate(count, to);
    }

    fn evaluate_into(&self, count: usize, to: &mut LightRows) {
        let wi = to.direction.each_ref().map(|row| &row[..count]);
        let towards = Towards { wi, value: None, pdf: Some(&mut to.pdf[..count]) };
        self.mixture.ask(towards.into()).expect("slices of one length");
        self.estimate(count, to);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_lobes_are_learnt_and_the_total_is_the_mean_weight() {
        let mut random = Random::new(1, 2, 3);
        let lobe = |axis, sharpness, a: f32| Lobe::new(axis, sharpness, Vec3::splat(a)).unwrap();
        let truth: Mixture<'_, 16> =
            Mixture::new(Domain::Sphere, 1.0, &[], &[lobe(Vec3::X, 50.0, 3.0), lobe(Vec3::NEG_Z, 5.0, 1.0)])
                .unwrap();
        let followed: Vec<Followed> = (0..4000)
            .map(|_| {
                let sample = truth.sample([(); 3].map(|()| random.unit())).unwrap();
                Followed { direction: sample.direction, weight: sample.weight.x }
            })
            .collect();
        let learnt = LearntLight::learn(&followed, &mut random).unwrap();
        assert!((learnt.total / truth.power() - 1.0).abs() < 1e-3);
        for d in [Vec3::X, Vec3::new(0.96, 0.28, 0.0), Vec3::NEG_Z, Vec3::new(0.6, 0.0, -0.8)] {
            let ratio = learnt.pdf(d) / truth.pdf(d);
            assert!((0.7..1.4).contains(&ratio), "{d}: {ratio}");
        }
        assert!(LearntLight::learn(&[Followed { direction: Vec3::X, weight: 0.0 }], &mut random).is_err());
    }
}
