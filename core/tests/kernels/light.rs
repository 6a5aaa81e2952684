//! Light from a map, alone and together with lobes, against plain texts of it.

use crate::{at_each_level, is_near, materials, three, upper};
use srbf_core::{
    Environment, LIGHT_BLOCK, LightBlock, LightRows, LightSource, Mixture, ProductSampling, Vec3,
    environment_len, luminance,
};
use srbf_levels::inputs::Random;
use srbf_levels::outputs::{slices, structure_of_arrays};
use std::f64::consts::{PI, TAU};

const WIDTH: usize = 16;
const HEIGHT: usize = 8;

/// A map without steep places, and its radiance in f64: linear in azimuth and height between the centres of pixels.
fn map() -> Vec<[f32; 3]> {
    let mut random = Random(12);
    (0..WIDTH * HEIGHT)
        .map(|_| [0.5 + random.uniform(), 0.3 + random.uniform(), 0.8 + random.uniform()])
        .collect()
}

fn radiance(map: &[[f32; 3]], d: Vec3, turn: f32) -> [f64; 3] {
    let [x, y, z] = d.to_array().map(f64::from);
    let right = (0.5 - (y.atan2(x) - f64::from(turn)) / TAU).rem_euclid(1.0) * WIDTH as f64 - 0.5;
    let below = x.hypot(y).atan2(z) / PI * HEIGHT as f64 - 0.5;
    let (column, row) = (right.floor(), below.floor());
    let depth = |row: f64| (PI * (row + 0.5).clamp(0.0, HEIGHT as f64) / HEIGHT as f64).cos();
    let down = ((depth(row) - z) / (depth(row) - depth(row + 1.0))).clamp(0.0, 1.0);
    let across = right - column;
    [0, 1, 2].map(|c| {
        let pixel = |dx: i64, dy: i64| {
            let at = [
                (column as i64 + dx).rem_euclid(WIDTH as i64),
                (row as i64 + dy).clamp(0, HEIGHT as i64 - 1),
            ];
            f64::from(map[at[1] as usize * WIDTH + at[0] as usize][c])
        };
        let along = |dy| pixel(0, dy) * (1.0 - across) + pixel(1, dy) * across;
        along(0) * (1.0 - down) + along(1) * down
    })
}

/// Tangent, bitangent and normal; from there to the world, and back.
fn frame(normal: Vec3) -> [Vec3; 3] {
    let tangent = normal.any_orthonormal_vector();
    [tangent, normal.cross(tangent), normal]
}

fn to_world(frame: &[Vec3; 3], d: Vec3) -> Vec3 {
    frame[0] * d.x + frame[1] * d.y + frame[2] * d.z
}

fn to_local(frame: &[Vec3; 3], d: Vec3) -> Vec3 {
    Vec3::new(frame[0].dot(d), frame[1].dot(d), frame[2].dot(d))
}

#[test]
fn light_alone_and_with_lobes_is_that_of_the_plain_text() {
    let map = map();
    let memory = vec![0; environment_len(WIDTH, HEIGHT).unwrap()];
    let light = Environment::new(WIDTH, &map, memory).unwrap().turned(0.7);
    let mut random = Random(13);
    for _ in 0..2000 {
        let (d, sample) = (random.direction(), light.sample(three(&mut random).to_array()));
        for (d, (got, pdf)) in
            [(d, light.radiance_and_pdf(d)), (sample.direction, (sample.radiance, sample.pdf))]
        {
            let want = radiance(&map, d, 0.7);
            assert!((0..3).all(|c| is_near(got[c], want[c], 2.0, 200.0)), "{d}: {got} {want:?}");
            assert!((luminance(got) / pdf / light.power() - 1.0).abs() < 1e-5, "{d}: {pdf}");
        }
    }
    let materials = materials();
    at_each_level(|level| {
        let mut random = Random(14);
        for (name, material) in &materials {
            for n in 0..40 {
                let mut m = Mixture::<64>::empty();
                material.prepare(upper(&mut random), &mut m).unwrap();
                let axes = frame(random.direction());
                let place = format!("{name}, {level:?}, {n}, normal {}", axes[2]);
                product_is_plain(&m, &light, &axes, &mut random, n, &place);
                sums_are_plain(&m, &light, &axes, &mut random, n, &place);
            }
        }
    });
}

type Light = Environment<Vec<u32>>;

/// A map by the two verbs alone, as code of the caller.
struct Hidden<'a>(&'a Light);

impl LightSource for Hidden<'_> {
    fn sample_into(&self, u: [&[f32]; 3], to: &mut LightRows) {
        self.0.sample_into(u, to);
    }

    fn evaluate_into(&self, count: usize, to: &mut LightRows) {
        self.0.evaluate_into(count, to);
    }
}

/// The luminance of a draw is the mean of those of its candidates, whichever was chosen; it is the one that the choice falls on.
fn product_is_plain(
    m: &Mixture<64>,
    light: &Light,
    axes: &[Vec3; 3],
    random: &mut Random,
    n: usize,
    place: &str,
) {
    let count = [2, 8, 15, 16, 17, 31, 32][n % 7];
    let sampling = ProductSampling::new(count, [0.5, 0.0, 0.8, 1.0][n % 4], f32::INFINITY).unwrap();
    let u: Vec<Vec3> = (0..count).map(|_| three(random)).collect();
    let (arrays, choice) = (structure_of_arrays(&u), random.uniform());
    let drawn = m.sample_product(light, axes, &sampling, slices(&arrays, count), choice).unwrap();
    let lobes = sampling.lobe_candidates();
    let candidates: Vec<(Vec3, f64)> = (0..count)
        .map(|i| {
            let u = u[i].to_array();
            let world = if i < lobes {
                to_world(axes, m.sample_direction(u).unwrap())
            } else {
                light.sample(u).direction
            };
            let (value, of_lobes) = m.evaluate_and_pdf(to_local(axes, world));
            let (radiance, of_light) = light.radiance_and_pdf(world);
            let (brought, other) = (luminance(value * radiance), luminance((value * radiance).abs()) / 8.0);
            let [of_lobes, of_light] = [of_lobes, of_light].map(f64::from);
            let density = (lobes as f64 * of_lobes + (count - lobes) as f64 * of_light) / count as f64;
            (world, f64::from(brought.max(other)) / density)
        })
        .collect();
    let whole: f64 = candidates.iter().map(|c| c.1).sum();
    let Some(drawn) = drawn else { return assert!(whole == 0.0, "{place}: nothing is drawn of {whole}") };
    let mut sum = 0.0;
    let near = candidates.iter().map(|c| {
        sum += c.1;
        (c.0, sum - f64::from(choice) * whole)
    });
    let near: Vec<(Vec3, f64)> = near.collect();
    if near.iter().all(|(_, after)| after.abs() > 1e-3 * whole) {
        let (wanted, _) = near.iter().find(|(_, after)| *after > 0.0).unwrap();
        assert!(drawn.direction.distance(*wanted) < 4e-6, "{place}: {drawn:?}, {wanted}");
        // The same light as code of the caller.
        let other = m.sample_product(&Hidden(light), axes, &sampling, slices(&arrays, count), choice);
        let other = other.unwrap().unwrap();
        let found = other.factor * light.radiance(other.direction);
        let scale = drawn.weight.abs().max_element();
        let apart = (other.weight - drawn.weight).abs().max((found - drawn.weight).abs()).max_element();
        assert!(
            other.direction.distance(*wanted) < 4e-6 && apart < 4e-3 * scale,
            "{place}: {drawn:?}, {other:?}"
        );
    }
    let weight = f64::from(luminance(drawn.weight).max(luminance(drawn.weight.abs()) / 8.0));
    assert!((weight * count as f64 / whole - 1.0).abs() < 2e-3, "{place}: {weight} of {whole}");
}

/// The sums of light and lobes, and the rest of them where rays are blocked.
fn sums_are_plain(
    m: &Mixture<64>,
    light: &Light,
    axes: &[Vec3; 3],
    random: &mut Random,
    n: usize,
    place: &str,
) {
    let flat = (axes[2] + 0.3 * random.direction()).normalize();
    let mut numbers = || [[0.0f32; LIGHT_BLOCK]; 3].map(|row| row.map(|_| random.uniform()));
    let (of_block, of_lobes) = (numbers(), numbers());
    // A block that sees no light above the surface.
    let is_dark = n.is_multiple_of(5);
    let block = LightBlock::of(|i| {
        let mut sample = light.sample([of_block[0][i], of_block[1][i], of_block[2][i]]);
        if is_dark && sample.direction.dot(flat) > 0.0 {
            sample.direction = -sample.direction;
        }
        sample
    });
    let count = [1, 2, 8, 15, 16][(n / 5 + n) % 5];
    let u = of_lobes.each_ref().map(|row| &row[..count]);
    let drawn = m.reflect(light, &block, axes, flat, u, random.uniform()).unwrap();
    let weight = |a: f64, b: f64| a * a / (a * a + b * b);
    let (mut sums, mut own) = ([[0.0; 3]; 2], [0.0; 3]);
    for i in 0..LIGHT_BLOCK {
        let at = |rows: &[[f32; LIGHT_BLOCK]; 3]| Vec3::new(rows[0][i], rows[1][i], rows[2][i]);
        let (value, pdf) = m.evaluate_and_pdf(to_local(axes, at(&block.direction)));
        let share = weight(f64::from(block.pdf[i]), f64::from(pdf)) / LIGHT_BLOCK as f64;
        for c in (0..3).filter(|_| at(&block.direction).dot(flat) > 0.0) {
            sums[0][c] += f64::from(value[c] * at(&block.light)[c]) * share;
        }
        if i >= count {
            continue;
        }
        let ray = m.sample(at(&of_lobes).to_array()).unwrap();
        let world = to_world(axes, ray.direction);
        let (radiance, of_light) = light.radiance_and_pdf(world);
        let share = weight(f64::from(ray.pdf), f64::from(of_light));
        for c in (0..3).filter(|_| world.dot(flat) > 0.0) {
            let brought = f64::from(ray.weight[c] * radiance[c]) * share;
            own[c] = if i == 0 { brought } else { own[c] };
            sums[1][c] += brought / count as f64;
        }
    }
    let size = sums.as_flattened().iter().fold(0.0f64, |size, sum| size.max(sum.abs()));
    let is_near =
        |got: Vec3, want: [f64; 3]| (0..3).all(|c| (f64::from(got[c]) - want[c]).abs() <= 2e-3 * size);
    assert!(is_near(drawn.block_sum, sums[0]), "{place}: {} {:?}", drawn.block_sum, sums[0]);
    assert!(is_near(drawn.ray_sum, sums[1]), "{place}: {} {:?}", drawn.ray_sum, sums[1]);
    assert!(is_near(drawn.ray_light * drawn.ray_value, own), "{place}: own ray {own:?}");
    let both = [0, 1, 2].map(|c| sums[0][c] + sums[1][c]);
    assert!(is_near(drawn.light(true, true), both), "{place}: in the open {both:?}");
    match drawn.shadow {
        Some(_) => assert_eq!(drawn.light(false, false), Vec3::ZERO, "{place}"),
        None => assert!(is_near(drawn.light(true, false), both), "{place}: no shadow ray, {both:?}"),
    }
    assert!(!is_dark || drawn.shadow.is_none(), "{place}: {drawn:?}");
}
