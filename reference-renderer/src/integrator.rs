//! Path tracing: the radiance along one ray, by the strategy asked for.
//!
//! Where lobes are the material, a sample of them has the weight `value / pdf` of constant luminance. Of a measured table the
//! samples are those of a mixture that is like it.

use crate::camera::Ray;
use crate::random::Random;
use crate::scene::{Scene, Surface};
use crate::shader::Scattering;
use crate::sphere_sampling;
use glam::Vec3;
use srbf_core::{Sample, power_heuristic};
use std::f32::consts::{FRAC_1_PI, TAU};

/// How directions are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Sampler {
    /// From the material and from the environment, weighted by the power heuristic.
    Mis,
    /// From the material only: its lobes, or what samples a table.
    Lobes,
    /// From the lobes, and one in twenty from the cosine: weights are bounded.
    Defensive,
    /// From the cosine only.
    Cosine,
    /// Uniform on the hemisphere.
    Uniform,
    /// From the environment only.
    Light,
}

impl Sampler {
    /// The name on the command line, in tables and plots.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mis => "mis",
            Self::Lobes => "lobes",
            Self::Defensive => "defensive",
            Self::Cosine => "cosine",
            Self::Uniform => "uniform",
            Self::Light => "light",
        }
    }

    fn samples_environment(self) -> bool {
        matches!(self, Self::Mis | Self::Light)
    }

    /// Draws an incident direction in the shading frame.
    #[inline]
    fn sample(self, scattering: &Scattering<'_>, random: &mut Random) -> Option<Sample> {
        let (direction, pdf) = match self {
            Self::Mis | Self::Lobes | Self::Light => {
                return scattering.sample([random.unit(), random.unit(), random.unit()]);
            }
            Self::Defensive => {
                return scattering.sample_defensive([random.unit(), random.unit(), random.unit()]);
            }
            Self::Cosine => {
                let direction = sphere_sampling::cosine([random.unit(), random.unit()]);
                (direction, direction.z * FRAC_1_PI)
            }
            Self::Uniform => (sphere_sampling::uniform_hemisphere([random.unit(), random.unit()]), 1.0 / TAU),
        };
        Some(Sample { direction, pdf, weight: scattering.evaluate(direction) / pdf })
    }
}

/// Paths end at random from this bounce on, more likely the less they carry.
const ROULETTE_FROM: u32 = 3;

/// Smallest cosine that an outgoing direction has with the shading normal: the normal is bent until it has it.
const LEAST_COSINE: f32 = 1e-3;

/// Distance by which rays start above a surface, relative to the size of the coordinates.
const RAY_OFFSET: f32 = 1e-4;

/// Estimates the radiance that comes in along a ray with one path of at most `max_bounces` scatterings.
pub fn radiance<'a>(
    scene: &Scene<'a>,
    mut ray: Ray,
    sampler: Sampler,
    max_bounces: u32,
    random: &mut Random,
    scattering: &mut Scattering<'a>,
) -> Vec3 {
    let mut light = Vec3::ZERO;
    let mut throughput = Vec3::ONE;
    // Density of the direction of `ray` if it competes with samples of the environment.
    let mut competing: Option<f32> = None;

    for bounce in 0.. {
        let Some(surface) = scene.hit(&ray) else {
            let weight = match competing {
                None => 1.0,
                Some(_) if sampler == Sampler::Light => 0.0,
                Some(pdf) => power_heuristic(1.0, pdf, 1.0, scene.environment.pdf(ray.direction)),
            };
            light += throughput * scene.environment.radiance(ray.direction) * weight;
            break;
        };
        if bounce == max_bounces {
            break;
        }

        let wo = -ray.direction;
        let frame = Frame::new(&surface, wo);
        if surface.material.prepare(frame.to_local(wo), scattering).is_err() {
            // Impossible: the storage holds every material, and wo is a unit vector. A NaN is found in the picture.
            return Vec3::NAN;
        }

        if sampler.samples_environment() {
            let sample = scene.environment.sample(random);
            if frame.leaves(sample.direction) {
                let (value, pdf) = scattering.evaluate_and_pdf(frame.to_local(sample.direction));
                let weight =
                    if sampler == Sampler::Light { 1.0 } else { power_heuristic(1.0, sample.pdf, 1.0, pdf) };
                let contribution = throughput * value * sample.radiance * (weight / sample.pdf);
                if contribution != Vec3::ZERO && scene.is_clear(&frame.ray(sample.direction)) {
                    light += contribution;
                }
            }
        }

        let Some(sample) = sampler.sample(scattering, random) else { break };
        let direction = frame.to_world(sample.direction);
        if !frame.leaves(direction) {
            break;
        }
        throughput *= sample.weight;
        if bounce >= ROULETTE_FROM {
            // By its size: of a colour outside the gamut, channels are negative.
            let survival = throughput.abs().max_element().min(0.95);
            if random.unit() >= survival {
                break;
            }
            throughput /= survival;
        }
        competing = sampler.samples_environment().then_some(sample.pdf);
        ray = frame.ray(direction);
    }
    light
}

/// The shading frame at a point, on the side from where it is seen.
pub struct Frame {
    point: Vec3,
    flat: Vec3,
    tangent: Vec3,
    bitangent: Vec3,
    normal: Vec3,
}

impl Frame {
    /// Makes the frame at a surface seen from a direction.
    ///
    /// The tangent is horizontal, as the grooves are of what was turned on a lathe about the vertical: along the parallels of
    /// the sphere and round the teapot's body. It matters to anisotropic materials only.
    pub fn new(surface: &Surface<'_, '_>, wo: Vec3) -> Self {
        let flat = if surface.flat.dot(wo) < 0.0 { -surface.flat } else { surface.flat };
        let mut normal = if surface.smooth.dot(flat) < 0.0 { -surface.smooth } else { surface.smooth };
        // Near the outline an interpolated normal may look away from the viewer, who would see black.
        let cosine = normal.dot(wo);
        if cosine < LEAST_COSINE {
            normal = (normal + wo * (LEAST_COSINE - cosine)).normalize();
        }
        let (tangent, bitangent) = match Vec3::Z.cross(normal).try_normalize() {
            Some(tangent) if !surface.material.is_isotropic() => (tangent, normal.cross(tangent)),
            _ => normal.any_orthonormal_pair(),
        };
        Self { point: surface.point, flat, tangent, bitangent, normal }
    }

    /// Into the shading frame.
    #[inline]
    pub fn to_local(&self, d: Vec3) -> Vec3 {
        Vec3::new(d.dot(self.tangent), d.dot(self.bitangent), d.dot(self.normal))
    }

    /// Out of the shading frame.
    #[inline]
    pub fn to_world(&self, d: Vec3) -> Vec3 {
        (self.tangent * d.x + self.bitangent * d.y + self.normal * d.z).normalize()
    }

    /// Whether a direction leaves the surface itself: one that does not would leak light through it.
    #[inline]
    pub fn leaves(&self, direction: Vec3) -> bool {
        direction.dot(self.flat) > 0.0
    }

    /// A ray from just above the surface.
    #[inline]
    fn ray(&self, direction: Vec3) -> Ray {
        let offset = RAY_OFFSET * self.point.abs().max_element().max(1.0);
        Ray { origin: self.point + self.flat * offset, direction }
    }
}
