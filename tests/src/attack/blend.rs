//! Blends: parts with any weight, tint and coat, of a material of any bytes, of its mixtures and of lobes.

use super::input::{above, any_direction, put_right, random, uniform};
use super::mixture::is_sound;
use glam::Vec3;
use srbf_core::{
    AnyMixture, Blend, BlendPart, Domain, Draws, Error, Lobe, MAX_BLEND, Material, Mixture, Request, Towards,
};

/// Bytes of a part.
const PART: usize = 6;
/// Hits of a request: more than are taken together.
const HITS: usize = 19;

/// The number of parts, six bytes for each of eight, and the `.srbf` bytes of a material, whose length and checksum are put right.
pub fn blend(bytes: &[u8]) -> bool {
    let Some((head, rest)) = bytes.split_first_chunk::<{ 1 + PART * MAX_BLEND }>() else { return false };
    let mut random = random(bytes);
    let mut rest = rest.to_vec();
    put_right(&mut rest);
    let Ok(material) = Material::from_bytes(&rest[..]) else { return false };
    let wo = above(&mut random);
    let mut prepared = Mixture::<64>::empty();
    material.prepare(wo, &mut prepared).expect("room for 64 lobes");
    let lobe = |axis: Vec3, sharpness, amplitude: f32| {
        Lobe::new(axis, sharpness, [amplitude, 0.5 * amplitude, -0.1 * amplitude]).expect("a lobe")
    };
    let own = [lobe(Vec3::Z, 0.0, 0.3), lobe(Vec3::new(-wo.x, -wo.y, wo.z).normalize_or(Vec3::Z), 1e8, 1e6)];
    let own = Mixture::<16>::new(Domain::Hemisphere, 0.01, &own[..1], &own[1..]).expect("a mixture");
    let mixtures: [&AnyMixture<'_>; 2] = [&prepared, &own];
    let count = usize::from(head[0]) % (MAX_BLEND + 2);
    let part = |bytes: &[u8; PART]| {
        let [kind, weight, tint @ .., coat] = *bytes;
        let weight = number(weight);
        let part = match kind % 3 {
            0 => BlendPart::new(&material, weight),
            kind => BlendPart::of_mixture(mixtures[usize::from(kind) - 1], weight),
        };
        part.tinted(tint.map(number)).coated(match coat {
            0..128 => 1.0,
            code => number(code).max(0.5),
        })
    };
    let mut parts: Vec<_> = head[1..].as_chunks::<PART>().0.iter().map(part).take(count).collect();
    if count > MAX_BLEND {
        parts.push(parts[0]);
    }
    let blend = match Blend::new(&parts) {
        Ok(blend) => blend,
        Err(Error::Parts) => {
            assert!(parts.is_empty() || parts.len() > MAX_BLEND);
            return false;
        }
        Err(error) => {
            assert_eq!(error, Error::Weight);
            return false;
        }
    };
    assert!(blend.albedo(wo).is_finite(), "albedo {}", blend.albedo(wo));
    for _ in 0..8 {
        let (wi, u) = (any_direction(&mut random), [0; 3].map(|_| uniform(&mut random)));
        let place = || format!("{blend:?} seen from {wo}, {wi}, {u:?}");
        let (value, pdf) = blend.evaluate_and_pdf(wo, wi);
        assert!(value.is_finite() && pdf >= 0.0, "{}: {value} {pdf}", place());
        let (both, alone) = (blend.sample_and_evaluate(wo, u, wi), blend.sample(wo, u));
        assert!(both.1.0.is_finite() && both.1.1 >= 0.0, "{}: {both:?}", place());
        for sample in [both.0, alone].into_iter().flatten() {
            is_sound(sample.direction, sample.pdf, sample.weight, place);
        }
        let (k, part, left) = blend.choose(u[0]);
        assert!(k < parts.len() && (0.0..1.0).contains(&left), "{}: part {k}, {left}", place());
        // A part that is chosen is one whose numbers may be blended again, but where its share is tiny.
        if let Ok(one) = Blend::new(&[part]) {
            assert!(one.evaluate(wo, wi).is_finite(), "{}", place());
        }
    }
    many(&blend, &mut random);
    true
}

/// A number of a byte: small and large ones, and those that are refused.
fn number(code: u8) -> f32 {
    match code {
        0 => 0.0,
        1 => f32::from_bits(1),
        2 => 1e-30,
        250 => -1e-3,
        251 => f32::NAN,
        252 => f32::INFINITY,
        253 => 1000.0,
        254 => 1000.0f32.next_up(),
        255 => 1.0,
        code => 10f32.powf(f32::from(code) / 40.0 - 4.0),
    }
}

/// Many hits in a request, each from a direction of its own.
fn many(blend: &Blend<'_>, random: &mut crate::inputs::Random) {
    let mut rows = [[0.0; HITS]; 9];
    #[allow(clippy::needless_range_loop)] // nine rows are written at a time
    for n in 0..HITS {
        let (wo, wi) = (above(random), any_direction(random));
        for i in 0..3 {
            (rows[i][n], rows[3 + i][n], rows[6 + i][n]) = (wo[i], wi[i], uniform(random));
        }
    }
    let (mut value, mut pdf) = ([[0.0; HITS]; 3], [0.0; HITS]);
    let (mut direction, mut drawn_pdf, mut weight) = ([[0.0; HITS]; 3], [0.0; HITS], [[0.0; HITS]; 3]);
    let three = |from: usize| [0, 1, 2].map(|i| &rows[from + i][..]);
    let request = Request {
        evaluate: Some(Towards {
            wi: three(3),
            value: Some(value.each_mut().map(|row| &mut row[..])),
            pdf: Some(&mut pdf),
        }),
        draw: Some(Draws {
            u: three(6),
            direction: direction.each_mut().map(|row| &mut row[..]),
            pdf: Some(&mut drawn_pdf),
            weight: Some(weight.each_mut().map(|row| &mut row[..])),
        }),
    };
    blend.ask(three(0), request).expect("slices of one length");
    for n in 0..HITS {
        let of = |rows: &[[f32; HITS]; 3]| Vec3::new(rows[0][n], rows[1][n], rows[2][n]);
        assert!(of(&value).is_finite() && pdf[n] >= 0.0, "hit {n}: {} {}", of(&value), pdf[n]);
        is_sound(of(&direction), drawn_pdf[n], of(&weight), || format!("hit {n} of {blend:?}"));
    }
}
