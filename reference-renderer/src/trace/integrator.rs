//! Path tracing: the radiance along one ray.
//!
//! The truth and its sampler come with the material of a surface; whether the light is sampled too is a setting. At the first
//! surface several directions may be drawn together; from there on each goes its way alone.

pub mod even;
pub mod even_by_density;
pub mod skeleton;
pub mod wave;

use crate::numbers::points::{Decision, Points, PointsName};
use crate::shade::Light;
use crate::shade::shader::Scattering;
use crate::trace::carried::{Carried, Rgb, Wavelengths};
use crate::trace::frame::{Frame, look};
use crate::trace::integrator::even::{FirstHit, Lighting};
use crate::trace::path::Path;
use crate::trace::scene::{Scene, Surface};
use crate::trace::settings::RenderSettings;
use crate::truth::LargeMixture;
use crate::world::bulb::Bulb;
use crate::world::environment::LightPlace;
use crate::world::ray::Ray;
use glam::Vec3;
use srbf_core::{ProductSampling, Sample, luminance, power_heuristic};
use std::array::from_fn;

/// Paths end at random from this bounce on, more likely the less they carry.
const ROULETTE_FROM: u32 = 3;

/// How light and lobes are sampled together: sixteen candidates, half of them of the lobes, and the path's own ray beside them.
const PRODUCT: ProductSampling = match ProductSampling::new(CANDIDATES, 0.5, 4.0) {
    Ok(sampling) => sampling,
    Err(_) => panic!("the numbers are in range"),
};
const CANDIDATES: usize = 16;

/// Storage of a path that lasts longer than the path.
pub struct Workspace<'a> {
    scattering: Scattering<'a>,
    drawn: Vec<Sample>,
    rivals: Vec<Rival>,
    together: Vec<FirstHit>,
}

impl Default for Workspace<'_> {
    /// Storage for paths through any material.
    fn default() -> Self {
        Self { scattering: Scattering::empty(), drawn: Vec::new(), rivals: Vec::new(), together: Vec::new() }
    }
}

/// Estimates the radiance that comes in along a ray, with paths of at most `max_bounces` scatterings; what all paths share is there where
/// the settings ask for it.
pub fn radiance<'a>(
    scene: &Scene<'a>,
    ray: &Ray,
    settings: &RenderSettings,
    lighting: Option<&Lighting>,
    points: &Points,
    workspace: &mut Workspace<'a>,
) -> Vec3 {
    let Some(surface) = scene.hit(ray) else { return scene.light_along(ray) };
    let path = Path { scene, settings, points: *points, carried: Rgb };
    let split = settings.split as usize;
    let lighting = lighting.filter(|lighting| lighting.may_help_at(surface.point));
    let first = match lighting {
        None => path.branch(0, split).ask_for_light(0),
        Some(lighting) => {
            path.branch(0, split).block(lighting).prefetch();
            None
        }
    };
    let scattering = &mut workspace.scattering;
    let Some(frame) = look(&surface, ray, scattering) else { return Vec3::NAN };
    if let Some(lighting) = lighting.filter(|lighting| lighting.helps_on(scattering, frame.point)) {
        return surface.tint.unwrap_or(Vec3::ONE)
            * path.even(lighting, &frame, scattering, &mut workspace.together);
    }
    surface.tint.unwrap_or(Vec3::ONE) * path.reflected(&frame, &(), first, workspace)
}

/// Estimates the colour of the light along a ray, with paths that carry values at four wavelengths.
pub fn spectral_radiance<'a>(
    scene: &Scene<'a>,
    ray: &Ray,
    settings: &RenderSettings,
    wavelengths: Wavelengths,
    points: &Points,
    workspace: &mut Workspace<'a>,
) -> Vec3 {
    let path = Path { scene, settings, points: *points, carried: wavelengths };
    let Some(surface) = scene.hit(ray) else {
        return wavelengths.colour(wavelengths.light(scene.light_along(ray)));
    };
    let first = path.branch(0, settings.split as usize).ask_for_light(0);
    let Some(frame) = look(&surface, ray, &mut workspace.scattering) else { return Vec3::NAN };
    let primaries = wavelengths.surface(surface.material);
    let reflected = path.reflected(&frame, &primaries, first, workspace);
    // A colour of a reflectance is a smooth spectrum as that of a radiance is.
    wavelengths.colour(surface.tint.map_or(reflected, |tint| reflected * wavelengths.light(tint)))
}

impl<'a, C: Carried> Path<'_, 'a, C> {
    /// The light that the first surface reflects, whose material is ready; `first` as [`ask_for_light`](Self::ask_for_light) gives it.
    fn reflected(
        &self,
        frame: &Frame,
        own: &C::Surface,
        first: Option<LightPlace>,
        workspace: &mut Workspace<'a>,
    ) -> C::Value {
        let (scattering, split) = (&mut workspace.scattering, self.settings.split as usize);
        let mut light = self.branch(0, split).light_at(frame, own, scattering, 0, first);
        for part in 1..split {
            let branch = self.branch(part, split);
            light += branch.light_at(frame, own, scattering, 0, branch.ask_for_light(0));
        }
        let mut drawn = std::mem::take(&mut workspace.drawn);
        scattering.sample_together(self.settings.split, &self.points, &mut drawn);
        // All of them before the first is followed: the next surface takes the storage of this one.
        let mut rivals = std::mem::take(&mut workspace.rivals);
        rivals.clear();
        rivals.extend(drawn.iter().map(|sample| self.rival(sample, scattering)));
        for (part, (sample, &rival)) in drawn.iter().zip(&rivals).enumerate() {
            light += self.branch(part, split).follow(frame, own, sample, rival, scattering);
        }
        (workspace.drawn, workspace.rivals) = (drawn, rivals);
        light / self.settings.split as f32
    }

    /// Part `i` of `n` that the path branches into at the first surface.
    pub(in crate::trace) fn branch(&self, i: usize, n: usize) -> Self {
        Self { points: self.points.branch(i, n), ..*self }
    }

    /// The numbers of the sample of the light at a surface. A large map is in no cache: the memory that they will read is requested, while the
    /// material is made ready. None where light and lobes are sampled together, or no light is.
    fn ask_for_light(&self, surface: u32) -> Option<LightPlace> {
        matches!(self.settings.light, Light::Mis | Light::Even | Light::Only).then(|| {
            let place = self.light_place(surface);
            self.scene.environment.prefetch_place(place);
            place
        })
    }

    /// Light that samples of it bring to a surface, the first, or one that comes later, with the numbers that were asked for.
    fn light_at(
        &self,
        frame: &Frame,
        own: &C::Surface,
        scattering: &Scattering<'a>,
        surface: u32,
        asked: Option<LightPlace>,
    ) -> C::Value {
        let around = self.light_around(frame, own, scattering, surface, asked);
        match &self.scene.bulb {
            None => around,
            Some(bulb) => around + self.light_of(bulb, frame, own, scattering, surface),
        }
    }

    /// Light of the bulb.
    fn light_of(
        &self,
        bulb: &Bulb,
        frame: &Frame,
        own: &C::Surface,
        scattering: &Scattering<'a>,
        surface: u32,
    ) -> C::Value {
        if self.settings.light == Light::Off {
            return C::BLACK;
        }
        let [u, v, ..] = self.points.draw(Decision::Bulb, surface);
        // From where a ray that was drawn towards it starts.
        let from = frame.ray(bulb.ball.centre - frame.point).origin;
        let Some(sample) = bulb.sample(from, [u, v]).filter(|sample| frame.leaves(sample.direction)) else {
            return C::BLACK;
        };
        let (value, pdf) = scattering.evaluate_and_pdf(frame.to_local(sample.direction));
        let weight = match self.settings.light {
            Light::Only => 1.0,
            _ => power_heuristic(1.0, sample.pdf, 1.0, pdf),
        };
        let radiance = self.carried.light(bulb.radiance);
        let contribution = self.carried.scattered(own, value) * radiance * (weight / sample.pdf);
        let ray = Ray { origin: from, direction: sample.direction };
        let is_seen = contribution != C::BLACK && self.scene.is_clear_to(&ray, sample.distance);
        if is_seen { contribution } else { C::BLACK }
    }

    /// Light from round the scene.
    fn light_around(
        &self,
        frame: &Frame,
        own: &C::Surface,
        scattering: &Scattering<'a>,
        surface: u32,
        asked: Option<LightPlace>,
    ) -> C::Value {
        if self.settings.light == Light::Off {
            return C::BLACK;
        }
        if self.settings.light == Light::Product {
            let candidates = scattering.lobes_for_product().filter(|_| !self.is_evenly_lit());
            if let Some(lobes) = candidates {
                return self.product_at(frame, own, scattering, lobes, surface);
            }
        }
        let place = asked.unwrap_or_else(|| self.light_place(surface));
        let sample = self.scene.environment.sample_place(place);
        if !frame.leaves(sample.direction) {
            return C::BLACK;
        }
        let (value, pdf) = scattering.evaluate_and_pdf(frame.to_local(sample.direction));
        let weight = match self.settings.light {
            Light::Mis | Light::Even | Light::Product => power_heuristic(1.0, sample.pdf, 1.0, pdf),
            Light::Only | Light::Off => 1.0,
        };
        let radiance = self.carried.light(sample.radiance);
        let contribution = self.carried.scattered(own, value) * radiance * (weight / sample.pdf);
        let is_seen = contribution != C::BLACK && self.scene.is_clear(&frame.ray(sample.direction));
        if is_seen { contribution } else { C::BLACK }
    }

    /// The place on the map of the sample of the light at a surface.
    pub(in crate::trace) fn light_place(&self, surface: u32) -> LightPlace {
        let [u, v, w, _] = self.points.draw(Decision::Light, surface);
        match self.points.name {
            PointsName::Sobol => self.scene.environment.ordered_place([u, v]),
            PointsName::Random => LightPlace::Numbers([u, v, w]),
        }
    }

    /// The numbers that draw a direction from the light: those that lie evenly keep to the order of the map.
    #[inline]
    fn towards_light(&self, [u, v, w, _]: [f32; 4]) -> [f32; 3] {
        match self.points.name {
            PointsName::Sobol => self.scene.environment.ordered([u, v]),
            PointsName::Random => [u, v, w],
        }
    }

    /// The numbers of the candidates at a surface: those of the lobes, then those of the light.
    ///
    /// Sobol points come in the order of the first number, which chooses a lobe, or the height of the light. The choice is made along
    /// that order, so that evenly spread choices are evenly spread directions.
    fn candidates(&self, surface: u32) -> [[f32; CANDIDATES]; 3] {
        let mut drawn = [[0.0; 4]; CANDIDATES];
        let (of_lobes, of_light) = drawn.split_at_mut(PRODUCT.lobe_candidates());
        self.points.draw_together(Decision::LobeCandidate, surface, of_lobes);
        self.points.draw_together(Decision::LightCandidate, surface, of_light);
        for u in of_light {
            let [u0, u1, u2] = self.towards_light(*u);
            *u = [u0, u1, u2, 0.0];
        }
        from_fn(|k| drawn.map(|u| u[k]))
    }

    /// Whether the light is the same from everywhere: then samples of it tell nothing that the lobes do not know.
    fn is_evenly_lit(&self) -> bool {
        self.scene.environment.constant_radiance().is_some()
    }

    /// Light that one direction brings to a surface, chosen among candidates of lobes and light by their light.
    fn product_at(
        &self,
        frame: &Frame,
        own: &C::Surface,
        scattering: &Scattering<'a>,
        lobes: &LargeMixture<'a>,
        surface: u32,
    ) -> C::Value {
        let u = self.candidates(surface);
        let choice = self.points.draw(Decision::Choice, surface)[0];
        let map = &self.scene.environment.map;
        let axes = [frame.tangent, frame.bitangent, frame.normal];
        // The slices are as long as the candidates are many.
        let Ok(drawn) = lobes.sample_product(map, &axes, &PRODUCT, u.each_ref().map(|u| &u[..]), choice)
        else {
            return C::NAN;
        };
        let Some(sample) = drawn.filter(|sample| frame.leaves(sample.direction)) else { return C::BLACK };
        if !self.scene.is_clear(&frame.ray(sample.direction)) {
            return C::BLACK;
        }
        let truth = scattering.other_truth(frame.to_local(sample.direction));
        if let (None, Some(weight)) = (truth, self.carried.product(sample.weight)) {
            return weight;
        }
        // The weight is light times the value of the lobes times a number, which is wanted.
        let radiance = map.radiance(sample.direction);
        let by_lobes = lobes.evaluate(frame.to_local(sample.direction));
        let brought = luminance(by_lobes * radiance);
        if brought == 0.0 {
            return C::BLACK;
        }
        let value = self.carried.scattered(own, truth.unwrap_or(by_lobes));
        value * self.carried.light(radiance) * (luminance(sample.weight) / brought)
    }

    /// How a direction drawn from a material competes with samples of the light.
    fn rival(&self, sample: &Sample, scattering: &Scattering<'a>) -> Rival {
        match (self.settings.light, scattering.lobes_for_product()) {
            (Light::Product, Some(lobes)) if !self.is_evenly_lit() => {
                // The sampler may have a part of the cosine, which is no candidate.
                let pdf =
                    if scattering.draws_lobes_alone() { sample.pdf } else { lobes.pdf(sample.direction) };
                Rival::Candidates { of_lobes: pdf, of_material: sample.pdf }
            }
            _ => Rival::Sample(sample.pdf),
        }
    }

    /// The light where a ray drawn from a material finds it, times its weight.
    fn found(&self, ray: &Ray, rival: Rival) -> C::Value {
        if let Some(bulb) = self.scene.bulb_along(ray) {
            let weight = match (self.settings.light, rival) {
                (Light::Off, _) => 1.0,
                (Light::Only, _) => 0.0,
                (_, Rival::Candidates { of_material, .. } | Rival::Sample(of_material)) => {
                    power_heuristic(1.0, of_material, 1.0, bulb.pdf(ray.origin))
                }
            };
            return self.carried.light(bulb.radiance) * weight;
        }
        let (radiance, pdf) = self.scene.environment.radiance_and_pdf(ray.direction);
        let weight = match (self.settings.light, rival) {
            (Light::Off, _) => 1.0,
            (Light::Only, _) => 0.0,
            (_, Rival::Candidates { of_lobes, .. }) => PRODUCT.ray_weight(of_lobes, pdf),
            (_, Rival::Sample(of_material)) => power_heuristic(1.0, of_material, 1.0, pdf),
        };
        self.carried.light(radiance) * weight
    }

    /// Light along a direction drawn at the first surface, times its weight.
    fn follow(
        &self,
        first: &Frame,
        own: &C::Surface,
        sample: &Sample,
        rival: Rival,
        scattering: &mut Scattering<'a>,
    ) -> C::Value {
        let direction = first.to_world(sample.direction);
        if !first.leaves(direction) {
            return C::BLACK;
        }
        let ray = first.ray(direction);
        let weight = self.carried.scattered(own, sample.weight);
        match self.scene.hit(&ray) {
            None => weight * self.found(&ray, rival),
            Some(surface) => self.onward(surface, ray, weight, scattering),
        }
    }

    /// The light of the second surface of a path, and of all that come after it.
    pub(in crate::trace) fn onward(
        &self,
        surface: Surface<'_, 'a>,
        ray: Ray,
        throughput: C::Value,
        scattering: &mut Scattering<'a>,
    ) -> C::Value {
        let (mut light, mut throughput) = (C::BLACK, throughput);
        let (mut surface, mut ray) = (surface, ray);
        for bounce in 1..self.settings.max_bounces {
            let asked = self.ask_for_light(bounce);
            let Some(frame) = look(&surface, &ray, scattering) else { return C::NAN };
            let own = self.carried.surface(surface.material);
            if let Some(tint) = surface.tint {
                throughput *= self.carried.light(tint);
            }
            light += throughput * self.light_at(&frame, &own, scattering, bounce, asked);
            let [u, v, w, _] = self.points.draw(Decision::Material, bounce);
            let Some(sample) = scattering.sample([u, v, w]) else { break };
            let direction = frame.to_world(sample.direction);
            if !frame.leaves(direction) {
                break;
            }
            throughput *= self.carried.scattered(&own, sample.weight);
            if bounce >= ROULETTE_FROM {
                let survival = C::size(throughput).min(0.95);
                if self.points.draw(Decision::Roulette, bounce)[0] >= survival {
                    break;
                }
                throughput /= survival;
            }
            let rival = self.rival(&sample, scattering);
            ray = frame.ray(direction);
            match self.scene.hit(&ray) {
                None => {
                    light += throughput * self.found(&ray, rival);
                    break;
                }
                Some(next) => surface = next,
            }
        }
        light
    }
}

/// The sampling of the light beside a direction drawn from a material, and the density of that direction.
#[derive(Clone, Copy)]
enum Rival {
    /// One sample of the light.
    Sample(f32),
    /// Candidates of lobes and light; the density of the lobes, and that of the direction as it was drawn.
    Candidates { of_lobes: f32, of_material: f32 },
}
