//! Path tracing by waves: many paths go from surface to surface together, and the hits of each material are asked in one request.
//!
//! A path takes the numbers that [`radiance`](super::radiance) takes, and brings the same light but for rounding. It is for lobes that
//! sample themselves, beside one sample of the light or none.

use super::{ROULETTE_FROM, Rival};
use crate::numbers::points::{Decision, Points};
use crate::shade::Light;
use crate::trace::carried::Rgb;
use crate::trace::frame::Frame;
use crate::trace::path::Path;
use crate::trace::scene::Scene;
use crate::trace::settings::RenderSettings;
use crate::truth::stored::Bytes;
use crate::world::environment::{LightPlace, LightSample};
use crate::world::ray::Ray;
use glam::Vec3;
use srbf_core::{Draws, Material, Request, Towards, power_heuristic};

/// Paths of a wave: their hits stay in the cache of a core.
pub const PATHS: usize = 1024;

/// A path on its way to the next surface.
struct Traveller {
    /// Its place among the paths of the wave.
    index: usize,
    points: Points,
    ray: Ray,
    throughput: Vec3,
    /// Density of the ray, as a material drew it; `None` from the camera.
    pdf: Option<f32>,
}

/// A path at a surface.
struct Hit<'a> {
    traveller: Traveller,
    frame: Frame,
    material: &'a Material<Bytes>,
    place: Option<LightPlace>,
}

/// Numbers of the hits, in the order of their materials: one array each.
const WO: usize = 0;
const WI: usize = 3;
const U: usize = 6;
const INPUTS: usize = 9;
const OUTPUTS: usize = 11;

/// Storage of a wave.
#[derive(Default)]
pub struct Room<'a> {
    alive: Vec<Traveller>,
    hits: Vec<Hit<'a>>,
    order: Vec<usize>,
    lights: Vec<Option<LightSample>>,
    inputs: [Vec<f32>; INPUTS],
    outputs: [Vec<f32>; OUTPUTS],
}

/// Estimates the radiance along rays of the camera: `light[i]` of ray `i`, overwritten. A material that is no lobes of its own gives NaN.
pub fn wave<'a>(
    scene: &Scene<'a>,
    settings: &RenderSettings,
    rays: impl Iterator<Item = (Ray, Points)>,
    light: &mut Vec<Vec3>,
    room: &mut Room<'a>,
) {
    light.clear();
    room.alive.clear();
    for (index, (ray, points)) in rays.enumerate() {
        light.push(Vec3::ZERO);
        room.alive.push(Traveller { index, points, ray, throughput: Vec3::ONE, pdf: None });
    }
    for bounce in 0..settings.max_bounces {
        meet(scene, settings, bounce, light, room);
        if room.hits.is_empty() {
            return;
        }
        sort(scene, bounce, room);
        ask(settings, room);
        go_on(scene, settings, bounce, light, room);
    }
    // A surface beyond the last one reflects nothing more.
    for traveller in room.alive.drain(..) {
        if scene.hit(&traveller.ray).is_none() {
            light[traveller.index] += escaped(scene, settings, &traveller);
        }
    }
}

/// The light where a path leaves the scene, times its throughput.
fn escaped(scene: &Scene<'_>, settings: &RenderSettings, traveller: &Traveller) -> Vec3 {
    let Some(pdf) = traveller.pdf else { return scene.light_along(&traveller.ray) };
    let path = Path { scene, settings, points: traveller.points, carried: Rgb };
    traveller.throughput * path.found(&traveller.ray, Rival::Sample(pdf))
}

/// Finds the next surface of every path.
fn meet<'a>(
    scene: &Scene<'a>,
    settings: &RenderSettings,
    bounce: u32,
    light: &mut [Vec3],
    room: &mut Room<'a>,
) {
    room.hits.clear();
    for mut traveller in room.alive.drain(..) {
        let Some(surface) = scene.hit(&traveller.ray) else {
            light[traveller.index] += escaped(scene, settings, &traveller);
            continue;
        };
        let Some(material) = surface.material.own_lobes() else {
            light[traveller.index] = Vec3::NAN;
            continue;
        };
        let place = matches!(settings.light, Light::Mis | Light::Only).then(|| {
            let path = Path { scene, settings, points: traveller.points, carried: Rgb };
            let place = path.light_place(bounce);
            scene.environment.prefetch_place(place);
            place
        });
        traveller.throughput *= surface.tint.unwrap_or(Vec3::ONE);
        let frame = Frame::new(&surface, -traveller.ray.direction);
        room.hits.push(Hit { traveller, frame, material, place });
    }
}

/// Sorts the hits by their materials, and writes what these are asked into arrays.
fn sort(scene: &Scene<'_>, bounce: u32, room: &mut Room<'_>) {
    let Room { hits, order, lights, inputs, .. } = room;
    order.clear();
    order.extend(0..hits.len());
    // Stable, so that the picture does not depend on where materials lie in memory.
    order.sort_by_key(|&i| std::ptr::from_ref(hits[i].material).addr());
    lights.clear();
    inputs.iter_mut().for_each(Vec::clear);
    for &i in &*order {
        let Hit { traveller, frame, place, .. } = &hits[i];
        let light = place.map(|place| scene.environment.sample_place(place));
        let light = light.filter(|light| frame.leaves(light.direction));
        let wo = frame.to_local(-traveller.ray.direction);
        let wi = light.map_or(Vec3::Z, |light| frame.to_local(light.direction));
        let [u, v, w, _] = traveller.points.draw(Decision::Material, bounce);
        for (first, numbers) in [(WO, wo), (WI, wi), (U, Vec3::new(u, v, w))] {
            for (array, number) in inputs[first..].iter_mut().zip(numbers.to_array()) {
                array.push(number);
            }
        }
        lights.push(light);
    }
}

/// Asks each material for a draw at every hit, and for value and density towards the sample of the light.
fn ask(settings: &RenderSettings, room: &mut Room<'_>) {
    let Room { hits, order, inputs, outputs, .. } = room;
    let n = order.len();
    outputs.iter_mut().for_each(|array| array.resize(n, 0.0));
    let samples_light = matches!(settings.light, Light::Mis | Light::Only);
    let mut from = 0;
    for run in order.chunk_by(|&a, &b| std::ptr::eq(hits[a].material, hits[b].material)) {
        let range = from..from + run.len();
        let input = |first: usize| [0, 1, 2].map(|k| &inputs[first + k][range.clone()]);
        let [x, y, z, pdf, r, g, b, red, green, blue, density] =
            outputs.each_mut().map(|array| &mut array[range.clone()]);
        let draw = Draws { u: input(U), direction: [x, y, z], pdf: Some(pdf), weight: Some([r, g, b]) };
        let towards = Towards { wi: input(WI), value: Some([red, green, blue]), pdf: Some(density) };
        let request = Request { draw: Some(draw), evaluate: samples_light.then_some(towards) };
        hits[run[0]].material.ask(input(WO), request).expect("slices of one length");
        from = range.end;
    }
}

/// Adds the light that is sampled, and sends the paths on.
fn go_on<'a>(
    scene: &Scene<'a>,
    settings: &RenderSettings,
    bounce: u32,
    light: &mut [Vec3],
    room: &mut Room<'a>,
) {
    let Room { alive, hits, order, lights, outputs, .. } = room;
    let vector = |first: usize, k: usize| Vec3::from_array([0, 1, 2].map(|c| outputs[first + c][k]));
    for (k, &i) in order.iter().enumerate() {
        let Hit { traveller, frame, .. } = &hits[i];
        let Traveller { index, points, mut throughput, .. } = *traveller;
        if let Some(sample) = &lights[k] {
            let (value, pdf) = (vector(7, k), outputs[10][k]);
            let weight = match settings.light {
                Light::Only => 1.0,
                _ => power_heuristic(1.0, sample.pdf, 1.0, pdf),
            };
            let contribution = value * sample.radiance * (weight / sample.pdf);
            if contribution != Vec3::ZERO && scene.is_clear(&frame.ray(sample.direction)) {
                light[index] += throughput * contribution;
            }
        }
        let pdf = outputs[3][k];
        let direction = frame.to_world(vector(0, k));
        // What reflects nothing draws with density 0.
        if pdf == 0.0 || !frame.leaves(direction) {
            continue;
        }
        throughput *= vector(4, k);
        if bounce >= ROULETTE_FROM {
            let survival = throughput.abs().max_element().min(0.95);
            if points.draw(Decision::Roulette, bounce)[0] >= survival {
                continue;
            }
            throughput /= survival;
        }
        alive.push(Traveller { index, points, ray: frame.ray(direction), throughput, pdf: Some(pdf) });
    }
}
