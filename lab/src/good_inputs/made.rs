//! Inputs that no threshold was chosen by: models at the directions of usual instruments, with noise, as tables of text.

use srbf_fit::analytic::PREFIX;
use srbf_fit::read::{Content, read};
use srbf_fit::table::Brdf;
use srbf_reference_renderer::numbers::random::Random;
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// Deviations of the noise, per cent of each value.
pub const NOISES: [f64; 4] = [0.0, 1.0, 5.0, 15.0];

/// Models, by a short name; the last is made here.
const MODELS: [(&str, &str); 10] = [
    ("white", "lambert:albedo=0.9"),
    ("black", "ggx:alpha=0.25,ior=1.5,diffuse=0.004"),
    ("plastic", "ggx:alpha=0.12,ior=1.5,diffuse=0.3/0.1/0.02"),
    ("lacquer", "ggx:alpha=0.02,ior=1.5,diffuse=0.05/0.2/0.6"),
    ("metal", "ggx:alpha=0.2,f0=0.95/0.7/0.4"),
    ("phong", "phong:diffuse=0.4,specular=0.2,exponent=400"),
    ("ward", "ward:diffuse=0.1,specular=0.4,alpha=0.06"),
    ("satin", "ggx:alpha=0.06,f0=0.5/0.3/0.2,diffuse=0.2"),
    ("cloth", "phong:diffuse=0.25,specular=0.1,exponent=8"),
    (RETRO, ""),
];

/// The name of a model with a peak about the back direction.
const RETRO: &str = "retro";

/// The directions of instruments.
const PATTERNS: [Pattern; 6] = [
    Pattern::Goniometer,
    Pattern::InPlane,
    Pattern::OneView,
    Pattern::Anywhere,
    Pattern::Turned,
    Pattern::Few,
];

/// Which pairs of directions are measured.
#[derive(Clone, Copy, Debug)]
enum Pattern {
    /// Eight views, lights every 10 degrees and 20 of azimuth, on one side.
    Goniometer,
    /// Five lights, viewers every 2.5 degrees in the plane of incidence.
    InPlane,
    /// One view at 30 degrees, lights over the hemisphere.
    OneView,
    /// Both directions anywhere.
    Anywhere,
    /// Few angles, and the sample turned to four azimuths.
    Turned,
    /// Three views of forty lights.
    Few,
}

/// An input.
pub struct Made {
    /// The table of text.
    pub text: String,
    /// Whether its peak is about the back direction.
    pub is_retro: bool,
}

/// A peak about the back direction over a dull surface.
struct Retro;

impl Brdf for Retro {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let squared: f64 = (0..3).map(|k| (wi[k] - wo[k]).powi(2)).sum();
        [
            0.06 + 3.0 * (-squared / 0.02).exp(),
            0.05 + 2.5 * (-squared / 0.02).exp(),
            0.04 + 0.4 * (-squared / 0.02).exp(),
        ]
    }
}

/// All inputs: a name of model and pattern, and one for each noise.
pub fn all(seed: u64) -> impl Iterator<Item = (String, Vec<Made>)> {
    MODELS.into_iter().flat_map(move |(name, model)| {
        PATTERNS.into_iter().map(move |pattern| {
            let brdf = brdf(model);
            let made = NOISES.map(|noise| Made {
                text: text(brdf.as_ref(), pattern, noise / 100.0, seed),
                is_retro: name == RETRO,
            });
            (format!("{name}, {pattern:?}"), made.into())
        })
    })
}

fn brdf(model: &str) -> Box<dyn Brdf> {
    match read(format!("{PREFIX}{model}").as_ref()).map(|source| source.content) {
        Ok(Content::Evaluable(brdf)) => brdf,
        _ => Box::new(Retro),
    }
}

fn direction(theta: f64, phi: f64) -> [f64; 3] {
    let ((st, ct), (sp, cp)) = (theta.to_radians().sin_cos(), phi.to_radians().sin_cos());
    [st * cp, st * sp, ct.max(0.0)]
}

impl Pattern {
    /// Angles in degrees: incident and outgoing angle from the normal, azimuth of each.
    fn angles(self, seed: u64) -> Vec<[f64; 4]> {
        let mut all = Vec::new();
        match self {
            Self::Goniometer => {
                for view in 1..=8 {
                    for light in 0..9 {
                        all.extend((0..10).map(|p| {
                            [10.0 * f64::from(light), 20.0 * f64::from(p), 10.0 * f64::from(view), 0.0]
                        }));
                    }
                }
            }
            Self::InPlane => {
                for light in 0..5 {
                    let viewer = |n: i32| {
                        let signed = 2.5 * f64::from(n);
                        [15.0 * f64::from(light), 0.0, signed.abs(), if signed < 0.0 { 0.0 } else { 180.0 }]
                    };
                    all.extend((-33..=33).map(viewer));
                }
            }
            Self::OneView => all.extend((0..400).map(|n| {
                let n = f64::from(n);
                [
                    (1.0 - (n + 0.5) / 400.0).sqrt().acos().to_degrees().min(88.0),
                    137.507_764 * n % 360.0,
                    30.0,
                    0.0,
                ]
            })),
            Self::Anywhere => {
                let mut random = Random::new(seed, 6, 7);
                let mut unit = || f64::from(random.unit());
                all.extend((0..900).map(|_| [85.0 * unit(), 360.0 * unit(), 85.0 * unit(), 360.0 * unit()]));
            }
            Self::Turned => {
                for turn in [0.0, 30.0, 75.0, 110.0] {
                    for (i, o, p) in (0..240).map(|n| (n % 4, n / 4 % 5, n / 20)) {
                        let [i, o, p] = [i, o, p].map(f64::from);
                        all.push([12.0 + 20.0 * i, turn, 5.0 + 16.0 * o, (turn + 30.0 * p) % 360.0]);
                    }
                }
            }
            Self::Few => {
                for view in [10.0, 35.0, 60.0] {
                    for (light, p) in (0..40).map(|n| (n % 8, n / 8)) {
                        all.push([5.0 + 10.0 * f64::from(light), 180.0 - 36.0 * f64::from(p), view, 0.0]);
                    }
                }
            }
        }
        all
    }
}

/// The table of text of a model, with noise whose deviation is a share of each value.
fn text(brdf: &dyn Brdf, pattern: Pattern, noise: f64, seed: u64) -> String {
    let mut text = "theta_i,phi_i,theta_o,phi_o,r,g,b\n".to_owned();
    let mut random = Random::new(seed, pattern as u64, 0);
    for [theta_i, phi_i, theta_o, phi_o] in pattern.angles(seed) {
        let rgb = brdf.evaluate(direction(theta_i, phi_i), direction(theta_o, phi_o));
        let mut normal = || {
            let (u, v) = (1.0 - f64::from(random.unit()), f64::from(random.unit()));
            (-2.0 * u.ln()).sqrt() * (TAU * v).cos()
        };
        // Most of the noise is of the light or the place, and in all channels alike.
        let common = normal();
        let [r, g, b] = rgb.map(|v| v * (1.0 + noise * (0.9 * common + 0.44 * normal())));
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{theta_i:.3},{phi_i:.3},{theta_o:.3},{phi_o:.3},{r:.5e},{g:.5e},{b:.5e}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use srbf_fit::read::csv;

    /// All inputs are read whole, their brightest samples are about the mirror direction, and noise changes with the seed alone.
    #[test]
    fn made_up_inputs_are_read_whole() {
        assert_eq!(all(0).count(), MODELS.len() * PATTERNS.len());
        for (name, made) in all(0).filter(|(name, _)| name.contains("metal") || name.contains(RETRO)) {
            assert_eq!(made.len(), NOISES.len());
            let intake = csv::parse(made[0].text.as_bytes(), &Default::default()).unwrap();
            assert!(intake.rows.len() >= 100 && intake.left_out_count() == 0, "{name}");
            let level = |rgb: [f64; 3]| rgb.iter().sum::<f64>();
            let brightest = intake.rows.iter().max_by(|a, b| level(a.rgb).total_cmp(&level(b.rgb))).unwrap();
            let cross = brightest.wi[0] * brightest.wo[0] + brightest.wi[1] * brightest.wo[1];
            assert_eq!(cross > 0.0, made[0].is_retro, "{name}: {brightest:?}");
        }
        let text = |seed| text(brdf(MODELS[0].1).as_ref(), Pattern::Few, 0.1, seed);
        assert!(text(1) == text(1) && text(1) != text(2));
    }
}
