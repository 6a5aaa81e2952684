//! Draws at the edges of cells and of the range of uniform numbers: none has density 0.

use glam::Vec3;
use srbf_core::{Domain, Environment, Lobe, Mixture, ProductSampling, luminance};
use srbf_tests::inputs::{Random, UNIFORM, levels};
use srbf_tests::maps::{Map, frame};

/// The largest f32 below 1.
const LAST: f32 = 1.0 - 0.5 * f32::EPSILON;

/// Maps with black pixels, with black and dark neighbours of a sun of 1e6, with suns of one pixel, and of 2 x 2 pixels.
pub fn hostile() -> Vec<Map> {
    let of = |name: &str, width: usize, pixels: Vec<[f32; 3]>| Map { name: name.into(), width, pixels };
    let grey = |values: &[f32]| values.iter().map(|&v| [v; 3]).collect::<Vec<_>>();
    let mut maps = vec![
        of("2 x 2, a black column", 2, grey(&[0.0, 1.0, 0.0, 1.0])),
        of("2 x 2, a black row", 2, grey(&[0.0, 0.0, 1.0, 1.0])),
        of("2 x 2, one pixel", 2, grey(&[0.0, 0.0, 0.0, 1.0])),
        of("2 x 2, crossed", 2, grey(&[1.0, 0.0, 0.0, 1.0])),
        of("2 x 2, blue and nothing", 2, vec![[0.0; 3], [0.0, 0.0, 1e-5], [1.0, 0.0, 0.0], [0.0; 3]]),
        of("1 x 2", 1, grey(&[1.0, 0.0])),
        of("2 x 1", 2, grey(&[1.0, 0.0])),
        Map::pixel(3, 3, 1, 1),
        Map::pixel(16, 8, 0, 0),
        Map::pixel(16, 8, 15, 7),
    ];
    for dark in [0.0, 1e-30, 1e-24, 1e-16, 1e-6, 1.0, 15.0] {
        let mut pixels = vec![[dark; 3]; 16 * 8];
        pixels[2 * 16 + 3] = [1e6; 3];
        maps.push(of(&format!("a sun of 1e6 before {dark:e}"), 16, pixels.clone()));
        pixels[2 * 16 + 4] = [0.0; 3];
        pixels[3 * 16 + 3] = [0.0, 0.0, 8.0];
        maps.push(of(&format!("a sun of 1e6 beside black before {dark:e}"), 16, pixels));
    }
    let mut random = Random(41);
    let speckled = (0..32 * 16).map(|i| if i % 3 == 0 { [0.0; 3] } else { random.three() });
    maps.push(of("every third pixel is black", 32, speckled.collect()));
    maps
}

/// Pairs of numbers that hit each cell at its edges, and where it begins to hand on, with what f32 rounds to beside them.
fn hits(environment: &Environment<Vec<u32>>) -> Vec<[f32; 2]> {
    let (count, steps) = (environment.cell_count(), f64::from(1 << 24));
    let mut all = Vec::new();
    for index in 0..count {
        let kept = f64::from(environment.cell(index).expect("a cell").kept);
        for place in [0.0, 1e-9, 0.5 * kept, kept, 0.5 + 0.5 * kept, 1.0] {
            for beside in [-1.0, 0.0, 1.0] {
                let u = ((index as f64 + place) / count as f64 * steps * steps + beside) / steps;
                if (0.0..steps).contains(&u) {
                    let first = u.floor();
                    all.push([(first / steps) as f32, (u - first).min(f64::from(LAST)) as f32]);
                }
            }
        }
    }
    all.extend(UNIFORM.into_iter().flat_map(|a| UNIFORM.map(|b| [a, b])));
    all.retain(|u| u.iter().all(|u| (0.0..1.0).contains(u)));
    all
}

/// Thirds numbers: the ends, and the numbers next to them.
const THIRDS: [f32; 7] = [0.0, f32::MIN_POSITIVE, 1.0 / (1 << 24) as f32, 0.3, 0.5, 1.0 - f32::EPSILON, LAST];

fn check(map: &Map, environment: &Environment<Vec<u32>>, u: [f32; 3]) {
    let sample = environment.sample(u);
    let place = || format!("{}, {u:?}: {sample:?}", map.name);
    assert!(sample.pdf >= f32::MIN_POSITIVE && sample.pdf.is_finite(), "{}", place());
    let ratio = luminance(sample.radiance / sample.pdf) / environment.power();
    assert!((ratio - 1.0).abs() < 1e-4, "{}", place());
    assert!((sample.direction.length() - 1.0).abs() < 1e-6, "{}", place());
}

#[test]
fn no_draw_of_a_map_has_density_0() {
    for map in hostile() {
        let environment = map.environment().turned(0.3);
        for [a, b] in hits(&environment) {
            THIRDS.into_iter().for_each(|c| check(&map, &environment, [a, b, c]));
        }
    }
}

/// Mixtures of lobes that are faint, as sharp as they may be, without a shape, or squeezed.
pub fn hostile_mixtures() -> Vec<Mixture<'static, 16>> {
    let lobe = |z: f32, sharpness: f32, power: f32| {
        Lobe::new(Vec3::new(0.3, 0.1, z).normalize(), sharpness, Vec3::splat(power)).unwrap()
    };
    let squeezed = Mixture::new(Domain::Sphere, 0.05, &[lobe(0.1, 1e5, 10.0)], &[lobe(0.7, 5.0, 1.0)]);
    vec![
        Mixture::hemisphere(&[lobe(1.0, 3.0, 1e-33), lobe(0.2, 1e8, 1.0)]).unwrap(),
        Mixture::hemisphere(&[lobe(1.0, 0.0, 0.3)]).unwrap(),
        squeezed.unwrap(),
    ]
}

#[test]
fn no_draw_of_light_and_material_is_no_number() {
    let mixtures = hostile_mixtures();
    let mut random = Random(42);
    let mut drawn = 0;
    for map in hostile() {
        let environment = map.environment();
        let hits = hits(&environment);
        for m in &mixtures {
            for level in levels() {
                let m = m.clone().with_level(level).unwrap();
                for round in 0..300 {
                    let count = [2, 16, 32][round % 3];
                    let sampling = ProductSampling::new(count, 0.5, [4.0, f32::INFINITY][round % 2]).unwrap();
                    let any = |n: usize, random: &mut Random| (random.uniform() * n as f32) as usize % n;
                    let mut u = [[0.0f32; 32]; 3];
                    #[allow(clippy::needless_range_loop)] // three rows are written at a time
                    for i in 0..count {
                        let hit = hits[any(hits.len(), &mut random)];
                        let ends = [
                            THIRDS[any(7, &mut random)],
                            THIRDS[any(7, &mut random)],
                            THIRDS[any(7, &mut random)],
                        ];
                        let is_lobe = i < sampling.lobe_candidates();
                        (u[0][i], u[1][i]) = if is_lobe { (ends[0], ends[1]) } else { (hit[0], hit[1]) };
                        u[2][i] = ends[2];
                    }
                    let choice = THIRDS[any(7, &mut random)];
                    let axes = frame(random.direction());
                    let u = u.each_ref().map(|u| &u[..count]);
                    if let Some(sample) = m.sample_product(&environment, &axes, &sampling, u, choice).unwrap()
                    {
                        assert!(
                            sample.weight.is_finite() && sample.direction.is_finite(),
                            "{}: {sample:?}",
                            map.name
                        );
                        drawn += 1;
                    }
                }
            }
        }
    }
    assert!(drawn > 10_000, "{drawn}");
}
