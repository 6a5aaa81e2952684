//! A bulb: a ball that shines, the same from everywhere. It reflects nothing.

use crate::world::ball::Ball;
use glam::Vec3;
use std::f32::consts::TAU;

/// A ball that shines.
#[derive(Clone, Copy, Debug)]
pub struct Bulb {
    pub ball: Ball,
    /// Radiance of its surface, linear sRGB.
    pub radiance: Vec3,
}

/// A direction towards a bulb.
#[derive(Clone, Copy, Debug)]
pub struct BulbSample {
    /// Unit vector in the world.
    pub direction: Vec3,
    /// Distance to the bulb.
    pub distance: f32,
    /// Density; 1/sr.
    pub pdf: f32,
}

impl Bulb {
    /// The square of the sine of the angle from its middle to its rim, and one minus the cosine; `None` from within.
    fn rim(&self, from: Vec3) -> Option<(f32, f32)> {
        let sin_squared = self.ball.radius * self.ball.radius / (self.ball.centre - from).length_squared();
        // Without the cancellation of `1 - cos`.
        (sin_squared < 1.0).then(|| (sin_squared, sin_squared / (1.0 + (1.0 - sin_squared).sqrt())))
    }

    /// The density of [`sample`](Self::sample) towards any of its points; 1/sr.
    pub fn pdf(&self, from: Vec3) -> f32 {
        self.rim(from).map_or(0.0, |(_, height)| 1.0 / (TAU * height))
    }

    /// Draws a direction towards it, uniform in the solid angle that it is seen under; `None` from within.
    pub fn sample(&self, from: Vec3, [u, v]: [f32; 2]) -> Option<BulbSample> {
        let (rim, height) = self.rim(from)?;
        let to = self.ball.centre - from;
        let axis = to.normalize();
        let (tangent, bitangent) = axis.any_orthonormal_pair();
        // One minus the cosine of the angle from its middle.
        let w = u * height;
        let sin_squared = w * (2.0 - w);
        let (sin, cos) = (TAU * v).sin_cos();
        let across = (tangent * cos + bitangent * sin) * sin_squared.sqrt();
        let direction = (across + axis * (1.0 - w)).normalize();
        let half_chord = to.length() * (rim - sin_squared).max(0.0).sqrt();
        Some(BulbSample {
            direction,
            distance: to.length() * (1.0 - w) - half_chord,
            pdf: 1.0 / (TAU * height),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::random::Random;
    use crate::world::ray::Ray;
    use glam::vec3;

    /// Of any point near and far: its directions meet the ball at the distance that is told, and their mean is the centre of the cap.
    #[test]
    fn directions_meet_the_ball_and_fill_the_cap_evenly() {
        let bulb = Bulb { ball: Ball { centre: vec3(1.0, -2.0, 3.0), radius: 0.5 }, radiance: Vec3::ONE };
        let mut random = Random::new(8, 0, 0);
        for away in [0.51f32, 0.7, 2.0, 100.0] {
            let axis = vec3(0.6, 0.0, 0.8);
            let from = bulb.ball.centre - away * axis;
            let n = 20_000;
            let (mut mean, mut met) = (glam::DVec3::ZERO, 0);
            for _ in 0..n {
                let sample = bulb.sample(from, [random.unit(), random.unit()]).unwrap();
                assert!((sample.pdf / bulb.pdf(from) - 1.0).abs() < 1e-6);
                mean += sample.direction.as_dvec3() / f64::from(n);
                // At the rim, rounding decides.
                let Some(hit) = bulb.ball.hit(&Ray { origin: from, direction: sample.direction }) else {
                    continue;
                };
                met += 1;
                assert!((hit - sample.distance).abs() < 3e-3 * away, "{away}: {hit} {}", sample.distance);
            }
            assert!(met > n - n / 100, "{away}: {met}");
            // The mean height of a cap is half that of its rim.
            let rim = 1.0 - (1.0 - f64::from((0.5 / away).powi(2))).sqrt();
            let off = (mean - axis.as_dvec3() * (1.0 - 0.5 * rim)).length();
            assert!(off < 5.0 / f64::from(n).sqrt(), "{away}: {off}");
        }
        assert!(bulb.sample(bulb.ball.centre + 0.1, [0.5; 2]).is_none());
        assert_eq!(bulb.pdf(bulb.ball.centre), 0.0);
    }
}
