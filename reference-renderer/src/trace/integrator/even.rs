//! Light and lobes together by even sums, at the first surface of a path: one shadow ray, and the ray that the path goes on along.
//!
//! Sums without shadows help where most of the light is seen, and cost time where it is not. So a survey before the picture finds out
//! where both rays escape, by paths and numbers of its own: which method a place gets does not depend on the samples that the picture is
//! made of, and both have the same mean.

use crate::numbers::points::{Decision, Points, PointsName, shifts};
use crate::shade::shader::Scattering;
use crate::trace::camera::Camera;
use crate::trace::carried::Rgb;
use crate::trace::frame::{Frame, look};
use crate::trace::integrator::even_by_density::{self, RAYS};
use crate::trace::openness::{Openness, SurveyedPath};
use crate::trace::path::Path;
use crate::trace::scene::Scene;
use crate::trace::settings::RenderSettings;
use crate::truth::LargeMixture;
use crate::world::environment::tile::{BLOCKS, LightTile};
use glam::Vec3;
use srbf_core::{LightBlock, Reflection, luminance};

/// Share of its power that the diffuse term of a matte surface has at least.
const MOSTLY_DIFFUSE: f32 = 0.9;

/// Paths of the survey, a few milliseconds, and the blocks of light that they share.
const SURVEY: u64 = 2048;
const SURVEY_BLOCKS: usize = 256;

/// Tells the numbers of the survey from those of the picture.
const OF_SURVEY: u64 = 0x5eed;

/// What all paths share.
pub struct Lighting {
    tile: LightTile,
    open: Openness,
}

/// The draws at the first surface, before anything is followed.
pub struct FirstHit {
    reflection: Reflection,
    /// `f cos` of the rendered material, towards the path's ray and the shadow ray.
    values: [Vec3; 2],
}

impl Lighting {
    /// Samples that a tile serves, for a number of directions at the first surface: then the next one is made.
    pub fn samples(settings: &RenderSettings) -> u32 {
        (BLOCKS as u32 / settings.split).max(1)
    }

    /// Surveys the scene, and draws a tile, the `number`-th, if it is open somewhere.
    pub fn new(
        scene: &Scene<'_>,
        camera: &Camera,
        size: [u32; 2],
        settings: &RenderSettings,
        number: u64,
    ) -> Self {
        let tile = LightTile::new(scene.environment, settings.seed ^ OF_SURVEY, 0, SURVEY_BLOCKS);
        let mut lighting = Self { tile, open: Openness::everywhere() };
        let mut seen = Vec::new();
        let mut scattering = Scattering::empty();
        // The same for every tile of a picture: of the seed and the scene alone.
        for i in 0..SURVEY {
            let points = Points::new(PointsName::Random, settings.seed ^ OF_SURVEY, i, 0);
            let [across, down, ..] = points.draw(Decision::Pixel, 0);
            let ray = camera.ray(across * size[0] as f32, down * size[1] as f32);
            let Some(surface) = scene.hit(&ray) else { continue };
            let Some(frame) = look(&surface, &ray, &mut scattering) else { continue };
            let path = Path { scene, settings, points, carried: Rgb };
            let drawn = path.draw_together(&lighting, &frame, &scattering);
            seen.push(path.survey(&frame, &drawn));
        }
        lighting.open = Openness::of(&seen);
        if lighting.open.is_anywhere() {
            lighting.tile = LightTile::new(scene.environment, settings.seed, number, BLOCKS);
        }
        lighting
    }

    /// Whether sums are worth their time at a point of a surface that is not matte.
    #[inline]
    pub fn may_help_at(&self, point: Vec3) -> bool {
        self.open.is_at(point)
    }

    /// Whether they are at a point where they may be. A surface whose lobes are unknown is taken for not matte.
    #[inline]
    pub fn helps_on(&self, scattering: &Scattering<'_>, point: Vec3) -> bool {
        let is_matte =
            |lobes: &LargeMixture<'_>| luminance(lobes.diffuse()) >= MOSTLY_DIFFUSE * lobes.power();
        !scattering.known_lobes().is_some_and(is_matte) || self.open.is_at_matte(point)
    }
}

impl<'a> Path<'_, 'a> {
    /// The block of samples of the light at the first surface.
    #[inline]
    pub(super) fn block<'l>(&self, lighting: &'l Lighting) -> &'l LightBlock {
        lighting.tile.block(self.points.block(0, BLOCKS))
    }

    /// Draws both rays: by lobes where they are known, and their products with the light are within f32.
    fn draw_together(&self, lighting: &Lighting, frame: &Frame, scattering: &Scattering<'a>) -> FirstHit {
        let u = shifts::<RAYS>(self.points.draw(Decision::Material, 0));
        let [choice, ..] = self.points.draw(Decision::Choice, 0);
        let axes = [frame.tangent, frame.bitangent, frame.normal];
        let (block, map) = (self.block(lighting), &self.scene.environment.map);
        let by_lobes = scattering.lobes_for_product().and_then(|lobes| {
            lobes.reflect(map, block, &axes, frame.flat, u.each_ref().map(|u| &u[..]), choice).ok()
        });
        let mut reflection = by_lobes.unwrap_or_else(|| {
            even_by_density::reflect(scattering, self.scene.environment, block, frame, &u, choice)
        });
        let mut values = [reflection.ray_value, reflection.shadow_value];
        if let Some(ray) = &mut reflection.ray
            && let Some(truth) = scattering.other_truth(ray.direction)
        {
            values[0] = truth;
            ray.weight = truth / ray.pdf;
        }
        if let Some(direction) = reflection.shadow
            && let Some(truth) = scattering.other_truth(frame.to_local(direction))
        {
            values[1] = truth;
        }
        FirstHit { reflection, values }
    }

    /// Whether the shadow ray of a draw is clear; one that does not exist brings nothing.
    fn is_lit(&self, frame: &Frame, drawn: &FirstHit) -> bool {
        drawn.reflection.shadow.is_some_and(|direction| self.scene.is_clear(&frame.ray(direction)))
    }

    /// The findings of a path of the survey.
    fn survey(&self, frame: &Frame, drawn: &FirstHit) -> SurveyedPath {
        let escapes = |direction: Vec3| {
            let world = frame.to_world(direction);
            frame.leaves(world) && self.scene.is_clear(&frame.ray(world))
        };
        let ray = drawn.reflection.ray.is_some_and(|ray| escapes(ray.direction));
        let sum = drawn.reflection.block_sum + drawn.reflection.ray_sum;
        SurveyedPath {
            point: frame.point,
            light: luminance(sum).max(0.0),
            // A shadow ray that does not exist is blocked nowhere: all the reflected light is in the sums of the lobes.
            clear: [ray, drawn.reflection.shadow.is_none() || self.is_lit(frame, drawn)],
        }
    }

    /// The radiance of a path, by even sums at its first surface.
    pub(super) fn even(
        &self,
        lighting: &Lighting,
        frame: &Frame,
        scattering: &mut Scattering<'a>,
        together: &mut Vec<FirstHit>,
    ) -> Vec3 {
        let split = self.settings.split as usize;
        together.clear();
        // All of them before the first is followed: the next surface takes the storage of this one.
        for part in 0..split {
            together.push(self.branch(part, split).draw_together(lighting, frame, scattering));
        }
        let mut light = Vec3::ZERO;
        for (part, drawn) in together.iter().enumerate() {
            light += self.branch(part, split).follow_together(frame, drawn, scattering);
        }
        light / split as f32
    }

    /// What both rays bring.
    fn follow_together(&self, frame: &Frame, drawn: &FirstHit, scattering: &mut Scattering<'a>) -> Vec3 {
        let is_lit = self.is_lit(frame, drawn);
        let FirstHit { reflection, values: [ray_value, shadow_value] } = drawn;
        let light = |escapes| reflection.light_of(escapes, is_lit, *ray_value, *shadow_value);
        let Some(sample) = &reflection.ray else { return light(false) };
        let direction = frame.to_world(sample.direction);
        if !frame.leaves(direction) {
            return light(false);
        }
        let ray = frame.ray(direction);
        match self.scene.hit(&ray) {
            None => light(true),
            Some(surface) => light(false) + self.onward(surface, ray, sample.weight, scattering),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::numbers::points::PointsName;
    use crate::out::progress::Progress;
    use crate::shade::Light;
    use crate::trace::film::Film;
    use crate::trace::render::add_samples;
    use crate::trace::scene::{Scene, SceneName};
    use crate::trace::settings::RenderSettings;
    use crate::truth::stored::StoredMaterial;
    use crate::world::environment::Environment;
    use glam::{DVec3, Vec3};

    const SIZE: [u32; 2] = [24, 16];

    /// Mean over the picture, and its standard error.
    fn mean(scene: &Scene<'_>, name: SceneName, light: Light, samples: u32) -> (DVec3, DVec3) {
        let settings =
            RenderSettings { light, split: 1, max_bounces: 3, points: PointsName::Random, seed: 31 };
        let mut film = Film::new(SIZE);
        add_samples(scene, &name.camera(SIZE), &settings, &mut film, samples, &Progress::hidden()).unwrap();
        let n = film.pixels.len() as f64;
        let sum: DVec3 = (0..film.pixels.len()).map(|i| film.mean(i)).sum();
        let variance: DVec3 = (0..film.pixels.len()).map(|i| film.variance_of_mean(i)).sum();
        (sum / n, (variance / (n * n)).map(f64::sqrt))
    }

    #[test]
    fn means_are_those_of_long_references_and_a_bias_of_one_percent_is_found() {
        let light = (0..64 * 32)
            .map(|i| Vec3::splat(if i == 420 { 300.0 } else { 0.2 + ((i * 37) % 11) as f32 * 0.1 }));
        let light = Environment::new(64, light.collect()).unwrap();
        let object = StoredMaterial::load("garnet_red").unwrap();
        let ground = StoredMaterial::load("matte").unwrap();
        for name in [SceneName::Sphere, SceneName::Teapot, SceneName::Room] {
            let scene = Scene::new(name, &object.material, &ground.material, &light);
            let (ours, error) = mean(&scene, name, Light::Even, 128);
            // Sixteen times the samples.
            let (reference, own) = mean(&scene, name, Light::Mis, 2048);
            let error = (error * error + own * own).map(f64::sqrt);
            let apart = (ours - reference) / error;
            println!("{}: {apart} standard errors of {:.2e}", name.text(), error.max_element());
            assert!(apart.abs().max_element() < 4.0, "{}: {ours} {reference}", name.text());
            if name == SceneName::Sphere {
                let planted = (1.01 * ours - reference) / error;
                assert!(planted.abs().max_element() > 4.0, "a bias of 1 % is {planted} standard errors");
            }
        }
    }
}
