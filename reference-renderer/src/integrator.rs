//! Path tracing: the radiance along one ray.
//!
//! What is rendered and what samples it come with the material of a surface; whether the light is sampled too is a setting. At the first
//! surface several directions may be drawn together; from there on each goes its way alone.

use crate::camera::Ray;
use crate::random::Random;
use crate::render::Settings;
use crate::sampling::Light;
use crate::scene::{Scene, Surface};
use crate::shader::Scattering;
use glam::Vec3;
use srbf_core::{Sample, power_heuristic};

/// Paths end at random from this bounce on, more likely the less they carry.
const ROULETTE_FROM: u32 = 3;

/// Smallest cosine that an outgoing direction has with the shading normal: the normal is bent until it has it.
const LEAST_COSINE: f32 = 1e-3;

/// Distance by which rays start above a surface, relative to the size of the coordinates.
const RAY_OFFSET: f32 = 1e-4;

/// What a path needs that lasts longer than it: storage.
pub struct Workspace<'a> {
    scattering: Scattering<'a>,
    drawn: Vec<Sample>,
}

impl Workspace<'_> {
    /// Storage for paths through any material.
    pub fn new() -> Self {
        Self { scattering: Scattering::empty(), drawn: Vec::new() }
    }
}

/// Estimates the radiance that comes in along a ray, with paths of at most `max_bounces` scatterings.
pub fn radiance<'a>(
    scene: &Scene<'a>,
    ray: &Ray,
    settings: &Settings,
    random: &mut Random,
    workspace: &mut Workspace<'a>,
) -> Vec3 {
    let Some(surface) = scene.hit(ray) else { return scene.environment.radiance(ray.direction) };
    let mut path = Path { scene, settings, random };
    let scattering = &mut workspace.scattering;
    let Some(frame) = look(&surface, ray, scattering) else { return Vec3::NAN };
    let mut light = Vec3::ZERO;
    for _ in 0..settings.split {
        light += path.light_at(&frame, scattering);
    }
    let mut drawn = std::mem::take(&mut workspace.drawn);
    scattering.sample_together(settings.split, path.random, &mut drawn);
    for sample in &drawn {
        light += path.follow(&frame, sample, scattering);
    }
    workspace.drawn = drawn;
    light / settings.split as f32
}

/// Makes the frame of a surface and gets its material ready; `None` is impossible, as the storage holds every material, and the outgoing
/// direction is a unit vector. A NaN is found in the picture.
fn look<'a>(surface: &Surface<'_, 'a>, ray: &Ray, scattering: &mut Scattering<'a>) -> Option<Frame> {
    let wo = -ray.direction;
    let frame = Frame::new(surface, wo);
    surface.material.prepare(frame.to_local(wo), scattering).ok().map(|()| frame)
}

/// A path on its way.
struct Path<'p, 'a> {
    scene: &'p Scene<'a>,
    settings: &'p Settings,
    random: &'p mut Random,
}

impl<'a> Path<'_, 'a> {
    /// Light that a sample of the environment brings to a surface.
    fn light_at(&mut self, frame: &Frame, scattering: &Scattering<'a>) -> Vec3 {
        if self.settings.light == Light::Off {
            return Vec3::ZERO;
        }
        let sample = self.scene.environment.sample(self.random);
        if !frame.leaves(sample.direction) {
            return Vec3::ZERO;
        }
        let (value, pdf) = scattering.evaluate_and_pdf(frame.to_local(sample.direction));
        let weight = match self.settings.light {
            Light::Mis => power_heuristic(1.0, sample.pdf, 1.0, pdf),
            Light::Only | Light::Off => 1.0,
        };
        let contribution = value * sample.radiance * (weight / sample.pdf);
        let is_seen = contribution != Vec3::ZERO && self.scene.is_clear(&frame.ray(sample.direction));
        if is_seen { contribution } else { Vec3::ZERO }
    }

    /// Weight of the environment where a direction drawn from a material finds it.
    fn weight_of_environment(&self, direction: Vec3, pdf: f32) -> f32 {
        match self.settings.light {
            Light::Off => 1.0,
            Light::Only => 0.0,
            Light::Mis => power_heuristic(1.0, pdf, 1.0, self.scene.environment.pdf(direction)),
        }
    }

    /// What comes in along a direction drawn at the first surface, times its weight.
    fn follow(&mut self, first: &Frame, sample: &Sample, scattering: &mut Scattering<'a>) -> Vec3 {
        let direction = first.to_world(sample.direction);
        if !first.leaves(direction) {
            return Vec3::ZERO;
        }
        let (mut light, mut throughput, mut pdf) = (Vec3::ZERO, sample.weight, sample.pdf);
        let mut ray = first.ray(direction);
        for bounce in 1.. {
            let Some(surface) = self.scene.hit(&ray) else {
                let weight = self.weight_of_environment(ray.direction, pdf);
                light += throughput * self.scene.environment.radiance(ray.direction) * weight;
                break;
            };
            if bounce == self.settings.max_bounces {
                break;
            }
            let Some(frame) = look(&surface, &ray, scattering) else { return Vec3::NAN };
            light += throughput * self.light_at(&frame, scattering);
            let u = [self.random.unit(), self.random.unit(), self.random.unit()];
            let Some(sample) = scattering.sample(u) else { break };
            let direction = frame.to_world(sample.direction);
            if !frame.leaves(direction) {
                break;
            }
            throughput *= sample.weight;
            if bounce >= ROULETTE_FROM {
                // By its size: of a colour outside the gamut, channels are negative.
                let survival = throughput.abs().max_element().min(0.95);
                if self.random.unit() >= survival {
                    break;
                }
                throughput /= survival;
            }
            pdf = sample.pdf;
            ray = frame.ray(direction);
        }
        light
    }
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
