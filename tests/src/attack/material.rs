//! `.srbf` bytes: prepared, evaluated and drawn from, one at a time, in pairs, and expanded.

use super::input::{above, any_direction, put_right, random, uniform};
use super::mixture::{self, is_sound};
use crate::inputs::Random;
use glam::Vec3;
use srbf_core::{Draws, Expanded, Material, Mixture, PackOptions, Towards, printable, printable_lines};

/// Rows of expanded materials: the fewest, more and fewer than there are views.
const ROWS: [usize; 3] = [2, 5, 33];

/// `.srbf` bytes of any version, whose length and checksum are put right.
pub fn material(bytes: &[u8]) -> bool {
    let mut bytes = bytes.to_vec();
    put_right(&mut bytes);
    if Material::from_bytes(&bytes[..]).is_err() {
        return false;
    }
    // The CRC of bytes with their own CRC behind them is always the same: the second numbers follow from the file.
    for part in [&bytes[..], &bytes[..bytes.len() - 4]] {
        check(&bytes, &mut random(part), "");
    }
    true
}

/// Does everything with the bytes of a sound material: all that comes out is a number, and what reflects draws.
///
/// # Panics
/// If something does not hold; `place` is said then.
pub fn check(bytes: &[u8], random: &mut Random, place: &str) {
    let material = Material::from_bytes(bytes).expect("found to be sound");
    say_all(&material);
    pack(&material, random, place);
    spectra(&material, random, place);
    let rows = ROWS[random.below(ROWS.len())];
    let mut memory = vec![0.0; if material.is_isotropic() { material.expanded_len(rows) } else { 0 }];
    let expanded = Expanded::new(&material, rows, &mut memory);
    assert_eq!(expanded.is_ok(), material.is_isotropic(), "{place}: {:?}", expanded.err());
    let mut prepared = Mixture::<64>::empty();
    for n in 0..4 {
        let wo = [Vec3::Z, above(random), any_direction(random), Vec3::X][n];
        material.prepare(wo, &mut prepared).expect("a unit vector and room for every lobe");
        let place = format!("{place}, {wo}");
        mixture::check(&prepared, random, &place);

        let wi = any_direction(random);
        let factor = material.factor(wo, wi);
        // Below the horizon it is any number.
        let within = factor.min_element() >= 0.0 && factor.max_element() <= 1.001 * material.largest_factor();
        assert!(within || wi.z < 0.0, "{place}, {wi}: factor {factor}");
        pair(&material, expanded.as_ref().ok(), [wo, wi], random, &place);
    }
}

/// In codes and in plain numbers again: both are materials.
fn pack(material: &Material<&[u8]>, random: &mut Random, place: &str) {
    let options = PackOptions { bits: [8, 16][random.below(2)], channels: [1, 3][random.below(2)] };
    let mut small = vec![0; material.packed_len(options, "")];
    let mut plain = vec![0; material.unpacked_len()];
    let (packed, unpacked) = (material.pack(options, "", &mut small), material.unpack(&mut plain));
    if !material.is_isotropic() {
        assert_eq!(unpacked, Ok(plain.len()), "{place}");
        if let Ok(bytes) = packed {
            assert!(Material::from_bytes(&small[..bytes]).is_ok(), "{place}");
        }
        return;
    }
    assert_eq!(unpacked, Ok(plain.len()), "{place}");
    match packed {
        Ok(bytes) => assert!(Material::from_bytes(&small[..bytes]).is_ok(), "{place}"),
        // Views that are nearly the same have no codes of their own.
        Err(error) => {
            let apart = |v: usize| material.view_theta(v).zip(material.view_theta(v + 1)).map(|(a, b)| b - a);
            let is_close = (0..material.view_count()).filter_map(apart).any(|apart| apart < 5e-5);
            assert!(is_close, "{place}: {error}");
        }
    }
}

/// Spectra of its colours: numbers at any wavelength, none below 0.
fn spectra(material: &Material<&[u8]>, random: &mut Random, place: &str) {
    let any = f32::from_bits((random.below(1 << 16) << 16 | random.below(1 << 16)) as u32);
    let primaries = material.primaries(&[any, 0.0, random.between(300.0, 1000.0), f32::NAN, f32::MAX]);
    let values = primaries.of([random.between(-1.0, 9.0), 0.5, random.between(0.0, 1e6)]);
    let is_sound = |v: &f32| v.is_finite() && *v >= 0.0;
    assert!(primaries.columns().as_flattened().iter().all(|v| v.is_finite()), "{place}: {any}");
    assert!(values.iter().all(is_sound), "{place}: {any}, {values:?}");
    assert_eq!(material.has_spectrum(), material.spectral_map().is_some());
    let Some(map) = material.spectral_map() else { return };
    let nm = |n: usize| map.wavelength(n).unwrap_or(f32::INFINITY);
    assert!((0..map.len()).all(|n| nm(n) < nm(n + 1) && map.column(n).is_some()), "{place}");
    let mut again = vec![0; material.with_spectral_map_len(map)];
    assert_eq!(material.with_spectral_map(map, &mut again), Ok(material.bytes().len()), "{place}");
}

/// Every accessor, within the counts and beyond.
fn say_all(material: &Material<&[u8]>) {
    let text = material.provenance().len();
    assert!(text <= material.bytes().len());
    let shown = printable(material.provenance()).to_string();
    let lines = printable_lines(material.provenance()).to_string();
    assert!(!shown.contains(char::is_control) && !lines.contains(|c: char| c.is_control() && c != '\n'));
    for view in 0..=material.view_count() {
        let is_there = view < material.view_count();
        assert_eq!(material.view_theta(view).is_some(), is_there);
        assert!(material.view_azimuth(view).is_none_or(f32::is_finite));
        assert!(material.view_log2_squeeze(view).is_none_or(f32::is_finite));
        assert!(material.view_log2_squeeze_matrix(view).is_none_or(|m| m.iter().all(|v| v.is_finite())));
        assert!(material.view_log2_diffuse(view).is_none_or(|v| !v.is_nan()));
        for lobe in 0..=material.view_lobe_count() {
            let found =
                [material.view_lobe(view, lobe).is_some(), material.view_tilted_lobe(view, lobe).is_some()];
            assert!(found != [true; 2] && (is_there || found == [false; 2]));
        }
        assert!(material.view_albedo_difference(view).is_none_or(|d| d.iter().all(|v| v.is_finite())));
    }
}

/// One pair of directions in batches, of the material and of the expanded one.
fn pair(
    material: &Material<&[u8]>,
    expanded: Option<&Expanded<'_>>,
    [wo, wi]: [Vec3; 2],
    random: &mut Random,
    place: &str,
) {
    let [o, i] = [wo, wi].map(|d| d.to_array().map(|x| [x]));
    let [o, i] = [&o, &i].map(|d| [&d[0][..], &d[1][..], &d[2][..]]);
    let u = [uniform(random), uniform(random), uniform(random)].map(|u| [u]);
    let u = [&u[0][..], &u[1][..], &u[2][..]];
    for (which, expanded) in [("pairs", None), ("expanded", expanded)] {
        if which == "expanded" && expanded.is_none() {
            continue;
        }
        let place = || format!("{place}, {wi}, {u:?}, {which}");
        let (mut value, mut pdf) = ([[0.0; 1]; 3], [0.0; 1]);
        let [red, green, blue] = value.each_mut().map(|channel| &mut channel[..]);
        let mut drawn = [[0.0; 1]; 7];
        let [x, y, z, density, r, g, b] = drawn.each_mut().map(|number| &mut number[..]);
        let samples = Draws { u, direction: [x, y, z], pdf: Some(density), weight: Some([r, g, b]) };
        match expanded {
            Some(expanded) => {
                expanded
                    .ask(o, Towards { wi: i, value: Some([red, green, blue]), pdf: Some(&mut pdf) }.into())
                    .expect("one pair");
                expanded.ask(o, samples.into()).expect("one sample");
            }
            None => {
                material
                    .ask(o, Towards { wi: i, value: Some([red, green, blue]), pdf: Some(&mut pdf) }.into())
                    .expect("one pair");
                material.ask(o, samples.into()).expect("one sample");
            }
        }
        let is_number = value.as_flattened().iter().all(|v| v.is_finite());
        assert!(
            is_number && pdf[0].is_finite() && pdf[0] >= 0.0,
            "{}: value {value:?}, density {pdf:?}",
            place()
        );
        let [x, y, z, density, r, g, b] = drawn.map(|[number]| number);
        is_sound(Vec3::new(x, y, z), density, Vec3::new(r, g, b), place);
    }
}
