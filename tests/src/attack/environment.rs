//! Light: maps, stored tables, and light and material drawn together.

use super::input::{above, any_direction, put_right, random, uniform};
use crate::inputs::Random;
use glam::Vec3;
use srbf_core::{
    Environment, Error, LIGHT_BLOCK, LightBlock, MAX_REFLECT_RAYS, Material, Mixture, ProductSampling,
    environment_len,
};

/// Words of the head of a table.
const HEAD: usize = 16;

/// A map whose size, range and pixels follow from the bytes: one byte a channel.
pub fn made(bytes: &[u8]) -> bool {
    let Some((&[width, range], pixels)) = bytes.split_first_chunk::<2>() else { return false };
    let width = 1 + usize::from(width) % 20;
    let Some((environment, power)) = map(width, range, pixels) else { return false };
    check(&environment, &mut random(bytes), true);
    let again = Environment::from_table(environment.table().to_vec()).expect("its own table is read again");
    assert_eq!(again.power(), power);
    true
}

/// A map, made; `None` if it is no map, or black.
fn map(width: usize, range: u8, pixels: &[u8]) -> Option<(Environment<Vec<u32>>, f32)> {
    let value = |byte: u8| match range % 3 {
        0 if byte == 0 => 0.0,
        0 => 10f32.powf(f32::from(byte) / 3.0 - 43.0).min(1e30),
        1 => f32::from(byte),
        _ => [0.0, 1.0, 1e-30, 1e30][usize::from(byte / 64)],
    };
    let pixels: Vec<[f32; 3]> =
        pixels.as_chunks::<3>().0.iter().take(4096).map(|rgb| rgb.map(value)).collect();
    let full = &pixels[..pixels.len() / width * width];
    let words = environment_len(width, full.len() / width).ok()?;
    match Environment::new(width, full, vec![0; words]) {
        Ok(environment) => {
            let power = environment.power();
            Some((environment, power))
        }
        Err(Error::BlackMap) => None,
        Err(error) => panic!("a map of {width} columns and {} pixels: {error}", full.len()),
    }
}

/// The words of a stored table, whose magic and checksum are put right.
pub fn read(bytes: &[u8]) -> bool {
    let mut words: Vec<u32> = bytes.as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word)).collect();
    if words.len() < HEAD {
        return false;
    }
    put_table_right(&mut words);
    let turn = f32::from_bits(words[words.len() - 1]);
    let Ok(environment) = Environment::from_table(&words[..]) else { return false };
    let mut random = random(bytes);
    check(&environment, &mut random, false);
    check(&environment.turned(turn), &mut random, false);
    true
}

/// The magic word and the checksum that a table should have: FNV-1a of head and words.
fn put_table_right(words: &mut [u32]) {
    words[0] = u32::from_le_bytes(*b"srbE");
    let mut sum = 0xcbf2_9ce4_8422_2325_u64;
    for word in words[1..4].iter().chain(&words[HEAD..]) {
        sum = (sum ^ u64::from(*word)).wrapping_mul(0x0100_0000_01b3);
    }
    words[4] = sum as u32;
    words[5] = (sum >> 32) as u32;
}

/// Looks up and draws. Of a map that was made, a draw's density is that which is looked up.
fn check<M: AsRef<[u32]>>(environment: &Environment<M>, random: &mut Random, is_made: bool) {
    for cell in (0..environment.cell_count()).take(32) {
        assert!(environment.cell(cell).is_some(), "cell {cell}");
    }
    assert!(environment.cell(environment.cell_count()).is_none());
    for _ in 0..16 {
        let d = any_direction(random);
        let (radiance, pdf) = environment.radiance_and_pdf(d);
        assert!(
            pdf >= 0.0 && pdf.is_finite() && !radiance.is_nan(),
            "{d}: radiance {radiance}, density {pdf}"
        );
        let u = [uniform(random), uniform(random), uniform(random)];
        let sample = environment.sample(u);
        assert!((sample.direction.length() - 1.0).abs() < 1e-5, "{u:?}: {sample:?}");
        assert!(sample.pdf >= 0.0 && sample.pdf.is_finite(), "{u:?}: {sample:?}");
        assert!(!is_made || sample.radiance.is_finite(), "{u:?}: {sample:?}");
    }
}

/// A map of 64 bytes and then `.srbf` bytes, drawn from together.
pub fn product(bytes: &[u8]) -> bool {
    let Some((head, rest)) = bytes.split_first_chunk::<64>() else { return false };
    let mut file = rest.to_vec();
    put_right(&mut file);
    let Ok(material) = Material::from_bytes(&file[..]) else { return false };
    let Some((environment, _)) = map(1 + usize::from(head[1] % 5), head[0], &head[4..]) else { return false };
    let share = f32::from(head[3]) / 255.0;
    let kappa = if head[2] & 128 == 0 { 1e-3 * (1.0 + 100.0 * f32::from(head[3])) } else { f32::INFINITY };
    let candidates = 2 + usize::from(head[2] % 31);
    let Ok(sampling) = ProductSampling::new(candidates, share, kappa) else { return false };
    let mut random = random(bytes);
    let mut mixture = Mixture::<64>::empty();
    for _ in 0..3 {
        let wo = above(&mut random);
        material.prepare(wo, &mut mixture).expect("a unit vector and room for every lobe");
        let normal = random.direction();
        let tangent = normal.any_orthonormal_vector();
        let frame = [tangent, normal.cross(tangent), normal];
        let u: [Vec<f32>; 3] =
            core::array::from_fn(|_| (0..candidates).map(|_| uniform(&mut random)).collect());
        let choice = uniform(&mut random);
        reflect(&mixture, &environment, &frame, &u, choice, &mut random);
        let drawn = mixture
            .sample_product(&environment, &frame, &sampling, u.each_ref().map(|u| &u[..]), choice)
            .expect("three numbers a candidate");
        let place = || format!("{sampling:?}, {wo}, powers {} {}", environment.power(), mixture.power());
        if let Some(drawn) = drawn {
            assert!((drawn.direction.length() - 1.0).abs() < 1e-5, "{}: {drawn:?}", place());
            assert!(!drawn.weight.is_nan(), "{}: {drawn:?}", place());
        }
        for pdf in [mixture.pdf(random.direction()), f32::NAN, f32::INFINITY, -1.0, f32::MAX, 0.0] {
            for of_light in
                [environment.pdf(random.direction()), f32::NAN, f32::INFINITY, -1.0, f32::MAX, 0.0]
            {
                let weight = sampling.ray_weight(pdf, of_light);
                assert!(
                    (0.0..=1.0).contains(&weight),
                    "{}: ray weight {weight} of {pdf}, {of_light}",
                    place()
                );
            }
        }
    }
    true
}

/// Many directions of both at once: light that is a number, or an error where it is more than a float holds.
fn reflect(
    mixture: &Mixture<'_, 64>,
    environment: &Environment<Vec<u32>>,
    frame: &[Vec3; 3],
    u: &[Vec<f32>; 3],
    choice: f32,
    random: &mut Random,
) {
    let numbers: [[f32; LIGHT_BLOCK]; 3] =
        core::array::from_fn(|_| core::array::from_fn(|_| uniform(random)));
    let block = LightBlock::new(environment, numbers.each_ref());
    let rays = u[0].len().min(MAX_REFLECT_RAYS);
    let u = u.each_ref().map(|u| &u[..rays]);
    let drawn = match mixture.reflect(environment, &block, frame, frame[2], u, choice) {
        Ok(drawn) => drawn,
        Err(error) => return assert_eq!(error, Error::Amplitude),
    };
    for (ray, shadow) in [(false, false), (false, true), (true, false), (true, true)] {
        assert!(
            !drawn.light(ray, shadow).is_nan(),
            "powers {} and {}: {drawn:?}",
            environment.power(),
            mixture.power()
        );
    }
}
