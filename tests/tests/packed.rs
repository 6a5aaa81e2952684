//! Materials in codes of 8 or 16 bits: they give the values of their plain numbers, at every level and by every call. Their numbers are as
//! near to those of the whole material as their bits allow.

use srbf_core::{Expanded, FormatError, Line, Material, Mixture, PackOptions, PlaneLobe, View};
use srbf_tests::inputs::Random;
use srbf_tests::kinds::{KINDS, for_each_level, materials, packed, upper};
use std::f32::consts::{FRAC_PI_2, PI};

const WAYS: [PackOptions; 4] = [
    PackOptions { bits: 8, channels: 3 },
    PackOptions { bits: 8, channels: 1 },
    PackOptions { bits: 16, channels: 3 },
    PackOptions { bits: 16, channels: 1 },
];

fn unpacked(material: &Material<Vec<u8>>) -> Material<Vec<u8>> {
    let mut bytes = vec![0; material.unpacked_len()];
    assert_eq!(material.unpack(&mut bytes), Ok(bytes.len()));
    Material::from_bytes(bytes).unwrap()
}

type Owned = Material<Vec<u8>>;

/// Every material in every way, behind the whole material.
fn all() -> Vec<(String, Owned, Owned)> {
    let mut all = Vec::new();
    for (name, bytes) in materials() {
        let whole = Material::from_bytes(bytes.clone()).unwrap();
        for options in WAYS {
            let small = Material::from_bytes(packed(&bytes, options)).unwrap();
            all.push((format!("{name}, {options:?}"), whole.clone(), small));
        }
    }
    all
}

#[test]
fn codes_are_what_they_unpack_to_at_every_level() {
    for (name, _, small) in all() {
        let plain = unpacked(&small);
        assert!(small.code_bits().is_some() && plain.code_bits().is_none(), "{name}");
        for_each_level(|level| {
            let mut random = Random(5);
            let (mut a, mut b) = (Mixture::<64>::empty(), Mixture::<64>::empty());
            for _ in 0..60 {
                let (wo, wi, u) = (upper(&mut random), upper(&mut random), random.three());
                small.prepare(wo, &mut a).unwrap();
                plain.prepare(wo, &mut b).unwrap();
                assert_eq!(a.evaluate_and_pdf(wi), b.evaluate_and_pdf(wi), "{level:?} {name} {wo} {wi}");
                assert_eq!(a.sample(u), b.sample(u), "{level:?} {name} {wo} {u:?}");
                assert_eq!(a.albedo(), b.albedo(), "{level:?} {name} {wo}");
                let hit = |m: &Material<Vec<u8>>| m.sample_and_evaluate(wo, u, wi);
                assert_eq!(hit(&small), hit(&plain), "{level:?} {name} {wo} {wi} {u:?}");
            }
        });
    }
}

#[test]
fn expanded_codes_are_what_they_unpack_to() {
    for (name, _, small) in all() {
        let plain = unpacked(&small);
        let mut room = [&small, &plain].map(|material| vec![0f32; material.expanded_len(64)]);
        let [first, second] = &mut room;
        let (a, b) = (Expanded::new(&small, 64, first).unwrap(), Expanded::new(&plain, 64, second).unwrap());
        // Other tests change the level of the process.
        for_each_level(|level| {
            let mut random = Random(8);
            let (mut from, mut to) = (Mixture::<64>::empty(), Mixture::<64>::empty());
            for _ in 0..50 {
                let (wo, wi) = (upper(&mut random), upper(&mut random));
                a.prepare(wo, &mut from).unwrap();
                b.prepare(wo, &mut to).unwrap();
                assert_eq!(from.evaluate_and_pdf(wi), to.evaluate_and_pdf(wi), "{level:?} {name}");
            }
        });
    }
}

/// Every number of a material: those of heads in its first four columns of numbers, those of lobes in the others.
fn columns(material: &Material<Vec<u8>>) -> Vec<Vec<f32>> {
    let views = 0..material.view_count();
    let column = |number: &dyn Fn(usize) -> f32| views.clone().map(number).collect::<Vec<f32>>();
    let mut all = vec![
        column(&|v| material.view_log2_squeeze(v).unwrap()),
        column(&|v| material.view_log2_diffuse(v).unwrap()),
        column(&|v| material.view_diffuse_color_differences(v).unwrap()[0]),
        column(&|v| material.view_diffuse_color_differences(v).unwrap()[1]),
    ];
    for k in 0..material.view_lobe_count() {
        let lobe = |v| material.view_lobe(v, k).unwrap();
        all.push(column(&|v| lobe(v).angle));
        all.push(column(&|v| lobe(v).off_plane));
        all.push(column(&|v| lobe(v).log2_sharpness));
        all.push(column(&|v| lobe(v).log2_luminance));
        all.push(column(&|v| lobe(v).color_differences[0]));
        all.push(column(&|v| lobe(v).color_differences[1]));
    }
    all
}

#[test]
fn numbers_are_as_near_as_their_bits_allow() {
    for (name, whole, small) in all() {
        let codes = if small.code_bits() == Some(8) { 255.0 } else { 65_535.0 };
        let is_grey = small.view_diffuse_color_differences(0) == Some([0.0; 2]);
        let mut least_codes = f32::INFINITY;
        for (n, (from, to)) in columns(&whole).iter().zip(columns(&small)).enumerate() {
            if is_grey && ((2..4).contains(&n) || n >= 4 && (n - 4) % 6 >= 4) {
                assert!(to.iter().all(|x| *x == 0.0), "{name}");
                continue;
            }
            let brightest = from.iter().fold(f32::MIN, |a, b| a.max(*b));
            // The darkest luminances of a lobe are the same in short codes.
            let floor = if n >= 4 && (n - 4) % 6 == 3 && codes < 256.0 { brightest - 24.0 } else { f32::MIN };
            let from: Vec<f32> = from.iter().map(|x| x.max(floor)).collect();
            let low = from.iter().fold(f32::MAX, |a, b| a.min(*b));
            // The low end and the step of a scale have eight bits, and the views are a little off their angles.
            let range = brightest - low + low.abs() / 128.0;
            let step = range * (1.0 + 1.0 / 128.0) / if n < 4 { 65_535.0 } else { codes };
            let off = from.iter().zip(&to).fold(0f32, |most, (a, b)| most.max((a - b).abs()));
            assert!(off <= 0.51 * step + 2e-5, "{name}: column {n} is off by {off}, range {range}");
            least_codes = least_codes.min(codes);
        }
        assert!(least_codes < f32::INFINITY);
        let apart = |v| (whole.view_theta(v).unwrap() - small.view_theta(v).unwrap()).abs();
        assert!((0..whole.view_count()).all(|v| apart(v) <= 1.3e-5), "{name}");
    }
}

/// A number at the very end of its range has a code within it, whatever the others of its row are: scales are rounded to 16 bits.
#[test]
fn numbers_at_the_ends_of_their_ranges_have_codes() {
    let mut count = 0;
    for ends in [
        [-PI, -PI],
        [PI, PI],
        [-PI, PI],
        [PI, PI.next_down()],
        [-PI, 1.3],
        [0.7, PI],
        [-PI.next_down(), -3.0],
    ] {
        for thetas in [[0.4, 1.5], [1.2, FRAC_PI_2], [0.001, 0.9]] {
            let lobe = |angle: f32| PlaneLobe {
                angle,
                off_plane: 0.5 * angle,
                log2_sharpness: if angle < 0.0 { -100.0 } else { 26.5 },
                log2_luminance: if angle < 0.0 { -126.0 } else { 60.0 },
                color_differences: [16.0, -16.0],
            };
            let normal = [PlaneLobe { angle: 0.0, off_plane: 0.0, ..lobe(1.0) }; 2];
            let lobes = ends.map(|angle| [PlaneLobe { off_plane: 0.0, ..lobe(angle) }, lobe(angle)]);
            let view = |theta, log2_squeeze, lobes| View {
                theta,
                log2_squeeze,
                log2_diffuse: 2.0,
                diffuse_color_differences: [-16.0, 16.0],
                lobes,
            };
            let views = [
                view(0.0, 0.0, &normal[..]),
                view(thetas[0], -6.64, &lobes[0]),
                view(thetas[1], 1.0, &lobes[1]),
            ];
            let line = Line { views: &views, squeezed: 1, mirrored: 1, factors: None };
            let mut bytes = vec![0; line.encoded_len("ends")];
            line.encode("ends", &mut bytes).unwrap();
            let material = Material::from_bytes(bytes).unwrap();
            for options in WAYS {
                let mut small = vec![0; material.packed_len(options, "")];
                assert_eq!(
                    material.pack(options, "", &mut small),
                    Ok(small.len()),
                    "{ends:?} {thetas:?} {options:?}"
                );
                count += usize::from(Material::from_bytes(small).is_ok());
            }
        }
    }
    assert_eq!(count, 7 * 3 * WAYS.len());
}

#[test]
fn a_preset_takes_a_third_of_its_bytes_and_keeps_its_values() {
    let mut seen = 0;
    for (name, whole, small) in all() {
        let is_preset = ["cayman", "garnet red", "krylon blue"].iter().any(|preset| name.starts_with(preset));
        if !is_preset || !name.contains("bits: 8, channels: 3") {
            continue;
        }
        seen += 1;
        // Spectra are in codes in both.
        let spectra = whole.spectral_map().map_or(0, |map| 8 + map.bytes().len());
        let (bytes, before) = (small.bytes().len() - spectra, whole.bytes().len() - spectra);
        let mut random = Random(2);
        let (mut off, mut all) = (0.0, 0.0);
        for _ in 0..4000 {
            let (wo, wi) = (upper(&mut random), upper(&mut random));
            let (a, b) = (whole.evaluate(wo, wi), small.evaluate(wo, wi));
            off += f64::from((a - b).length_squared());
            all += f64::from(a.length_squared());
        }
        let off = (off / all).sqrt();
        println!("{name}: {bytes} bytes of {before}, values off by {off:.4}");
        assert!(3 * (bytes - whole.provenance().len()) <= before && off < 0.02, "{name}: {bytes}, {off}");
    }
    assert_eq!(seen, 3);
}

#[test]
fn wrong_options_and_damaged_codes_are_refused() {
    let whole = Material::from_bytes(KINDS[3].bytes()).unwrap();
    let mut room = vec![0; 1 << 14];
    for options in [
        PackOptions { bits: 0, channels: 3 },
        PackOptions { bits: 12, channels: 3 },
        PackOptions { bits: 8, channels: 2 },
    ] {
        assert!(matches!(whole.pack(options, "", &mut room), Err(FormatError::Field { .. })), "{options:?}");
    }
    let needed = whole.packed_len(PackOptions::default(), "");
    let short = whole.pack(PackOptions::default(), "", &mut room[..needed - 1]);
    assert_eq!(short, Err(FormatError::Buffer { needed, available: needed - 1 }));

    let bytes = packed(whole.bytes(), PackOptions::default());
    for end in 0..bytes.len() {
        assert!(Material::from_bytes(&bytes[..end]).is_err(), "{end}");
    }
    // Bits of a code, channels, the reserved field, the length of the block, the tag.
    for (at, value) in [(48, 9), (49, 2), (50, 1), (44, 1), (40, b'Q')] {
        let mut damaged = bytes.clone();
        damaged[at] = value;
        let place = Material::from_bytes(damaged).unwrap_err();
        assert!(matches!(place, FormatError::Field { .. }), "{at}: {place:?}");
    }
}
