//! What of a path is not lobes: rays, frames, the order of the light. For the share of time that they take.

use crate::numbers::points::{Decision, Points};
use crate::trace::camera::Camera;
use crate::trace::carried::Rgb;
use crate::trace::frame::Frame;
use crate::trace::path::Path;
use crate::trace::scene::Scene;
use crate::trace::settings::RenderSettings;
use crate::world::ray::Ray;
use glam::Vec3;
use std::hint::black_box;

/// Follows the path of a pixel at random, the `i`-th, with a shadow ray at each surface; the reflection is a cosine.
pub fn skeleton(scene: &Scene<'_>, camera: &Camera, size: [u32; 2], settings: &RenderSettings, i: u64) {
    let points = Points::new(settings.points, settings.seed, i, 0);
    let path = Path { scene, settings, points, carried: Rgb };
    let [across, down, ..] = points.draw(Decision::Pixel, 0);
    let mut ray: Ray = camera.ray(across * size[0] as f32, down * size[1] as f32);
    for bounce in 0..settings.max_bounces {
        let Some(surface) = scene.hit(&ray) else { break };
        let frame = Frame::new(&surface, -ray.direction);
        let light = scene.environment.sample_place(path.light_place(bounce));
        if frame.leaves(light.direction) {
            black_box(scene.is_clear(&frame.ray(light.direction)));
        }
        let [u, v, ..] = points.draw(Decision::Material, bounce);
        let (sin, cos) = (std::f32::consts::TAU * v).sin_cos();
        let direction = frame.to_world(Vec3::new(u.sqrt() * cos, u.sqrt() * sin, (1.0 - u).sqrt()));
        if !frame.leaves(direction) {
            break;
        }
        ray = frame.ray(direction);
    }
    black_box(ray.direction);
}
