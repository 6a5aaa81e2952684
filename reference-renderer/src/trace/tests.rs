//! Sheets in scenes: energy, light from behind, and a reference that draws directions evenly over the sphere.

use crate::numbers::points::PointsName;
use crate::numbers::random::Random;
use crate::out::progress::Progress;
use crate::shade::Light;
use crate::shade::shader::Shader;
use crate::study::furnace;
use crate::trace::camera::Camera;
use crate::trace::film::Film;
use crate::trace::render::{add_samples, add_samples_by_waves};
use crate::trace::scene::{Role, Scene, SceneName, Shapes};
use crate::trace::settings::RenderSettings;
use crate::truth::sheets::StoredSheet;
use crate::truth::sheets::tests::{lossless, symmetric};
use crate::truth::stored::StoredMaterial;
use crate::truth::stored::tests::{brushed, lacquer};
use crate::world::ball::Ball;
use crate::world::bulb::Bulb;
use crate::world::environment::{Environment, sky};
use crate::world::mesh::Mesh;
use crate::world::skin::Skin;
use crate::world::sphere_sampling;
use glam::{DVec3, Vec3, vec3};
use srbf_core::Quarter;
use std::borrow::Cow;

const SIZE: [u32; 2] = [24, 16];

/// The ways in which the light is sampled.
const LIGHTS: [Light; 5] = [Light::Off, Light::Mis, Light::Only, Light::Product, Light::Even];

fn settings(light: Light, max_bounces: u32) -> RenderSettings {
    RenderSettings { light, split: 1, max_bounces, points: PointsName::Random, seed: 19 }
}

fn film(scene: &Scene<'_>, camera: &Camera, settings: &RenderSettings, samples: u32) -> Film {
    let mut film = Film::new(SIZE);
    add_samples(scene, camera, settings, &mut film, samples, &Progress::hidden()).unwrap();
    film
}

/// Mean over the picture, and its standard error.
fn mean(film: &Film) -> (DVec3, DVec3) {
    let n = film.pixels.len() as f64;
    let sum: DVec3 = (0..film.pixels.len()).map(|i| film.mean(i)).sum();
    let variance: DVec3 = (0..film.pixels.len()).map(|i| film.variance_of_mean(i)).sum();
    (sum / n, variance.map(f64::sqrt) / n)
}

/// A square that leans, alone; the direction of its front.
fn leaning() -> (Shapes, Vec3) {
    let corners = [vec3(-1.0, -1.0, -0.4), vec3(1.0, -1.0, -0.4), vec3(1.0, 1.0, 0.4), vec3(-1.0, 1.0, 0.4)];
    let mut shapes = Shapes::default();
    shapes.add(Mesh::quadrilateral(corners), Role::Object);
    (shapes, vec3(0.0, -0.4, 1.0).normalize())
}

/// A camera that sees nothing but the square, aslant, from in front or from behind.
fn aslant(is_behind: bool) -> Camera {
    let eye = if is_behind { vec3(2.0, 1.0, -3.0) } else { vec3(2.0, -1.0, 3.0) };
    Camera::new(eye, Vec3::ZERO, 10f32.to_radians(), SIZE)
}

/// Under the same light from everywhere a surface of two materials shows the weighted albedo, times the tint.
#[test]
fn a_skin_has_the_weighted_albedo_and_its_tint() {
    let environment = Environment::constant(1.0).unwrap();
    let [dark, bright] = [0.2, 0.8].map(|albedo| StoredMaterial::matte("grey", [albedo; 3]).unwrap());
    let tint = vec3(1.0, 0.5, 0.25);
    let skin = Skin::even(0.25, tint);
    let expected = 0.35 * tint.as_dvec3();
    let check = |name: &str, film: &Film| {
        let (mean, error) = mean(film);
        let apart = (mean - expected).abs() - 4.0 * error;
        assert!(apart.max_element() < 2e-3, "{name}: {mean}, {error}, not {expected}");
    };
    let mut mesh = leaning().0.mesh;
    mesh.wrap();
    let scene = || {
        let mut shapes = Shapes::default();
        shapes.add(mesh.clone(), Role::Object);
        let palette = vec![(&dark.material).into(), (&bright.material).into()];
        Scene::build(shapes, |_| (&dark.material).into(), &environment).with_skin(&skin, palette)
    };
    for light in LIGHTS {
        check(&format!("{light:?}"), &film(&scene(), &aslant(false), &settings(light, 3), 64));
    }
    let mut waves = Film::new(SIZE);
    let settings = settings(Light::Mis, 3);
    add_samples_by_waves(&scene(), &aslant(false), &settings, &mut waves, 64, &Progress::hidden()).unwrap();
    check("waves", &waves);
}

/// A sheet whose four quarters differ, two of them with an axis.
fn uneven() -> StoredSheet {
    let (brushed, lacquer) = (brushed(), lacquer());
    let dim = StoredMaterial::matte("dim", [0.1, 0.2, 0.3]).unwrap();
    let quarters =
        [Some(&lacquer.material), Some(&brushed.material), Some(&brushed.material), Some(&dim.material)];
    let mut bytes = vec![0; srbf_core::Sheet::encoded_len(quarters, "test")];
    srbf_core::Sheet::encode(quarters, false, "test", &mut bytes).unwrap();
    StoredSheet::new("uneven", Cow::Owned(bytes)).unwrap()
}

/// The furnace: under the same light from everywhere, a sheet shows the sum of its two shares; a lossless one is as bright as the light.
#[test]
fn a_sheet_in_the_furnace_has_the_sum_of_its_shares() {
    let environment = Environment::constant(1.7).unwrap();
    let ground_glass = StoredSheet::load("ground_glass").unwrap();
    for (sheet, whole) in [
        (lossless([0.3; 3]), Some(1.0)),
        (lossless([0.2, 0.5, 0.9]), Some(1.0)),
        (ground_glass, None),
        (uneven(), None),
    ] {
        for is_behind in [false, true] {
            let camera = aslant(is_behind);
            let scene = Scene::build(leaning().0, |_| (&sheet).into(), &environment);
            let expected = furnace::albedos(&scene, &camera, SIZE);
            // The corner of a pixel may lie on the edge between both triangles, which a ray misses.
            assert!(expected.iter().flatten().count() > 370);
            if let Some(whole) = whole {
                let off = expected.iter().flatten().map(|a| (*a - whole).abs().max_element());
                assert!(off.fold(0.0, f64::max) < 1e-5);
            }
            for light in LIGHTS {
                // Even samples of the light seldom meet a narrow lobe: alone, they have to be more.
                let samples = if light == Light::Only { 1024 } else { 256 };
                let film = film(&scene, &camera, &settings(light, 4), samples);
                let found = furnace::compare(&expected, Vec3::splat(1.7), &film);
                let deviation = (found.rendered - found.expected).abs();
                let allowed = 4.0 * found.standard_error + 2e-4 * found.expected.abs();
                println!("{}, behind: {is_behind}, {light:?}: {found:?}", sheet.name);
                assert!(deviation.cmple(allowed).all(), "{}, {light:?}: {found:?}", sheet.name);
                let error = found.standard_error.max_element();
                assert!(error < 0.02 * found.expected.max_element(), "{light:?}: {found:?}");
            }
        }
    }
}

/// A room all of whose walls are a lossless sheet: light comes through, and goes to and fro between them, and none of it is lost.
#[test]
fn a_room_of_lossless_sheets_is_as_bright_as_the_light() {
    let (environment, sheet) = (Environment::constant(1.0).unwrap(), lossless([0.4, 0.6, 0.5]));
    let scene = Scene::build(SceneName::Window.shapes(None), |_| (&sheet).into(), &environment);
    for camera in [SceneName::Window.camera(SIZE), SceneName::Room.camera(SIZE)] {
        for light in [Light::Off, Light::Mis] {
            let (found, error) = mean(&film(&scene, &camera, &settings(light, 400), 256));
            println!("{light:?}: {found} +- {error}");
            assert!((found - 1.0).abs().cmple(4.0 * error + 2e-4).all(), "{light:?}: {found} +- {error}");
            assert!(error.max_element() < 0.01, "{light:?}: {error}");
        }
    }
}

/// A sheet that transmits by Lambert's law alone, its light behind it: the map by quadrature, the bulb in closed form.
#[test]
fn light_behind_a_sheet_lights_its_front() {
    let half = StoredMaterial::matte("half", [0.6, 0.3, 0.1]).unwrap();
    let sheet = symmetric([None, Some(&half.material)]);
    let albedo = DVec3::new(0.6, 0.3, 0.1);
    let (shapes, front) = leaning();
    let camera = Camera::new(2.0 * front, Vec3::ZERO, 0.1f32.to_radians(), SIZE);

    let pixels = (0..64 * 32).map(|i| Vec3::splat(if i < 64 * 16 { 0.01 } else { 1.0 + (i % 3) as f32 }));
    let light = Environment::new(64, pixels.collect()).unwrap();
    let n = 400_000;
    let mut random = Random::new(3, 0, 0);
    let irradiance: f64 = (0..n)
        .map(|_| sphere_sampling::uniform([random.unit(), random.unit()]))
        .map(|d| f64::from(light.radiance(d).x * (-d.dot(front)).max(0.0)))
        .sum::<f64>()
        * 4.0
        * std::f64::consts::PI
        / f64::from(n);
    let scene = Scene::build(shapes, |_| (&sheet).into(), &light);
    let lit = albedo * irradiance / std::f64::consts::PI;
    for way in LIGHTS {
        let (found, error) = mean(&film(&scene, &camera, &settings(way, 1), 256));
        println!("{way:?}: {found} {lit} +- {error}");
        // 400 000 directions have an error of 0.2 %.
        assert!((found - lit).abs().cmple(4.0 * error + 6e-3 * lit).all(), "{way:?}: {found} {lit}");
    }

    // Behind it, and towards it at an angle of 60 degrees.
    let dark = Environment::constant(1e-6).unwrap();
    let aside = front.any_orthonormal_vector();
    let ball = Ball { centre: (-0.5 * front + 0.75f32.sqrt() * aside) * 3.0, radius: 0.6 };
    let bulb = Bulb { ball, radiance: Vec3::splat(5.0) };
    let mut shapes = leaning().0;
    shapes.bulb = Some(bulb);
    let scene = Scene::build(shapes, |_| (&sheet).into(), &dark);
    let lit = albedo * 5.0 * 0.2f64.powi(2) * 0.5;
    for way in LIGHTS {
        let (found, error) = mean(&film(&scene, &camera, &settings(way, 1), 512));
        println!("bulb, {way:?}: {found} {lit} +- {error}");
        assert!((found - lit).abs().cmple(4.0 * error + 2e-3 * lit).all(), "{way:?}: {found} {lit}");
        assert!(error.max_element() < 0.05 * lit.max_element(), "{way:?}: {error}");
    }
}

/// The radiance of the square by directions drawn evenly over the sphere, with a frame that is made here; mean over the picture.
fn reference(
    sheet: &StoredSheet,
    front: Vec3,
    camera: &Camera,
    light: &Environment,
    samples: u32,
) -> (DVec3, DVec3) {
    let along = Vec3::Z.cross(front).normalize();
    let across = front.cross(along);
    let local = |d: Vec3| vec3(d.dot(along), d.dot(across), d.dot(front));
    let mut film = Film::new(SIZE);
    for (i, pixel) in film.pixels.iter_mut().enumerate() {
        let mut random = Random::new(41, i as u64, 0);
        for _ in 0..samples {
            let (x, y) = ((i as u32 % SIZE[0]) as f32, (i as u32 / SIZE[0]) as f32);
            let ray = camera.ray(x + random.unit(), y + random.unit());
            let wi = sphere_sampling::uniform([random.unit(), random.unit()]);
            let value = sheet.sheet.evaluate(local(-ray.direction), local(wi));
            pixel.add(value * light.radiance(wi) * (4.0 * std::f32::consts::PI));
        }
    }
    film.samples = samples;
    mean(&film)
}

#[test]
fn every_way_to_sample_has_the_mean_of_even_directions() {
    let light = sky::haze();
    let front = leaning().1;
    for sheet in [StoredSheet::load("ground_glass").unwrap(), uneven()] {
        for is_behind in [false, true] {
            let camera = aslant(is_behind);
            let (expected, own) = reference(&sheet, front, &camera, &light, 2048);
            let scene = Scene::build(leaning().0, |_| (&sheet).into(), &light);
            for way in LIGHTS {
                let (found, error) = mean(&film(&scene, &camera, &settings(way, 1), 512));
                println!("{}, behind: {is_behind}, {way:?}: {found} {expected} +- {own} {error}", sheet.name);
                let error = (error * error + own * own).map(f64::sqrt);
                assert!(
                    (found - expected).abs().cmple(4.5 * error).all(),
                    "{}, behind: {is_behind}, {way:?}: {found} {expected} +- {error}",
                    sheet.name
                );
                assert!(error.max_element() < 0.02 * expected.max_element(), "{way:?}: {error}");
            }
        }
    }
}

/// Where paths go on, through a shade and a window: however the light is sampled, the mean is the same.
#[test]
fn scenes_of_sheets_have_one_mean() {
    let (light, sheet, rest) = (sky::haze(), StoredSheet::load("ground_glass").unwrap(), lacquer());
    for name in [SceneName::LampShade, SceneName::Window] {
        let of = |role| if role == Role::Object { (&sheet).into() } else { (&rest.material).into() };
        let scene = Scene::build(name.shapes(None), of, &light);
        let by = |way, samples| mean(&film(&scene, &name.camera(SIZE), &settings(way, 4), samples));
        let (expected, own) = by(Light::Mis, 2048);
        for way in LIGHTS {
            let (found, error) = by(way, 1024);
            println!("{}, {way:?}: {found} {expected} +- {own} {error}", name.text());
            let error = (error * error + own * own).map(f64::sqrt);
            assert!(
                (found - expected).abs().cmple(4.5 * error).all(),
                "{}, {way:?}: {found} {expected} +- {error}",
                name.text()
            );
            assert!(error.max_element() < 0.05 * expected.max_element(), "{way:?}: {error}");
        }
    }
}

/// A sheet that only reflects is rendered as its material, bit for bit: one text shades both.
#[test]
fn a_sheet_that_only_reflects_is_its_material() {
    let (light, lacquer) = (sky::sky(), lacquer());
    let sheet = symmetric([Some(&lacquer.material), None]);
    assert!(sheet.sheet.quarter(Quarter::BackTransmission).is_none());
    for way in [Light::Off, Light::Mis, Light::Only] {
        let render = |object: Shader<'_>| {
            let scene = Scene::new(SceneName::Sphere, object, object, &light);
            film(&scene, &SceneName::Sphere.camera(SIZE), &settings(way, 3), 16)
        };
        assert_eq!(render((&sheet).into()), render((&lacquer.material).into()), "{way:?}");
    }
}

/// The bulb over a floor, in closed form, and behind a ball, which hides it.
#[test]
fn a_bulb_lights_a_floor() {
    let (dark, floor) =
        (Environment::constant(1e-6).unwrap(), StoredMaterial::matte("floor", [0.5; 3]).unwrap());
    let camera = Camera::new(vec3(2.0, 0.0, 1.0), Vec3::ZERO, 0.1f32.to_radians(), SIZE);
    let bulb = Bulb { ball: Ball { centre: vec3(0.0, 0.0, 2.0), radius: 0.5 }, radiance: Vec3::splat(3.0) };
    for hidden in [false, true] {
        let mut shapes = Shapes::default();
        shapes.bulb = Some(bulb);
        shapes.add(Mesh::square(5.0, 0.0), Role::Ground);
        shapes.ball = hidden.then_some((Ball { centre: vec3(0.0, 0.0, 0.8), radius: 0.4 }, Role::Ball));
        let scene = Scene::build(shapes, |_| (&floor.material).into(), &dark);
        let lit = if hidden { 0.0 } else { 0.5 * 3.0 * 0.25f64.powi(2) };
        for way in LIGHTS {
            let (found, error) = mean(&film(&scene, &camera, &settings(way, 1), 512));
            println!("hidden: {hidden}, {way:?}: {found} {lit} +- {error}");
            assert!((found.x - lit).abs() < 4.0 * error.x + 2e-3 * lit + 1e-6, "{way:?}: {found} {lit}");
        }
    }
}
