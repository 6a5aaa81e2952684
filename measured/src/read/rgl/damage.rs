//! Every kind of damage to a `.bsdf` file is an error that names the field.

use super::container::{Field, Fields};
use super::parse;
use super::synthetic::{Written, fields};
use crate::analytic::ggx::{Facets, Ggx};
use crate::table::{Brdf, Draws, direction};

fn small(settings: Written) -> Fields {
    let model = Ggx { diffuse: [0.1; 3], alpha: [0.3, 0.5], facets: Facets::Schlick([0.5; 3]) };
    fields(&model, &Written { thetas: 3, warp: 5, picture: 4, ..settings })
}

fn anisotropic() -> Fields {
    small(Written { phis: 4, range: std::f64::consts::PI, ..Written::default() })
}

fn spectral() -> Fields {
    let wavelengths: Vec<f64> = (0..8).map(|i| 380.0 + 50.0 * f64::from(i)).collect();
    small(Written { spectrum: Some((wavelengths, vec![0.5; 8])), ..Written::default() })
}

/// The message about a file after a change.
fn error(mut fields: Fields, field: &str, change: &dyn Fn(&mut Field)) -> String {
    let at = fields.0.iter().position(|f| f.name == field).unwrap();
    change(&mut fields.0[at]);
    match parse(&fields.encode()) {
        Ok(_) => panic!("{field} is taken"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn a_missing_field_is_named() {
    for (make, names) in [
        (anisotropic as fn() -> Fields, &["phi_i", "theta_i", "ndf", "sigma", "vndf"][..]),
        (spectral, &["wavelengths", "spectra"]),
    ] {
        for name in names {
            let mut fields = make();
            assert!(parse(&fields.encode()).is_ok());
            fields.0.retain(|f| f.name != *name);
            let message = parse(&fields.encode()).unwrap_err().to_string();
            assert!(message.contains(name), "{name}: {message}");
        }
    }
    // Without colours of either kind the spectral ones are asked for.
    let mut fields = anisotropic();
    fields.0.retain(|f| f.name != "rgb");
    assert!(parse(&fields.encode()).unwrap_err().to_string().contains("spectra"));
}

#[test]
fn numbers_that_are_none_and_other_types_are_named() {
    for (make, names) in [
        (anisotropic as fn() -> Fields, &["phi_i", "theta_i", "ndf", "sigma", "vndf", "rgb"][..]),
        (spectral, &["wavelengths", "spectra"]),
    ] {
        for name in names {
            for bad in [f32::NAN, f32::INFINITY] {
                // In colours of isotropic files, nothing was measured there.
                if *name == "spectra" && bad.is_nan() {
                    continue;
                }
                let message = error(make(), name, &|field| {
                    let last = field.bytes.len() - 4;
                    field.bytes[last..].copy_from_slice(&bad.to_le_bytes());
                });
                assert!(message.contains(name) && message.contains("number"), "{message}");
            }
            assert!(error(make(), name, &|field| field.kind = 5).contains(name));
            let flat = error(make(), name, &|field| field.shape.push(1));
            assert!(flat.contains(name) && flat.contains("dimensions"), "{flat}");
        }
    }
}

#[test]
fn colours_of_isotropic_files_may_have_holes() {
    let holes = |share: f64| {
        let mut fields = small(Written::default());
        let field = fields.0.iter_mut().find(|field| field.name == "rgb").unwrap();
        let count = (share * field.bytes.len() as f64 / 4.0) as usize;
        field.bytes[..4 * count].chunks_exact_mut(4).for_each(|b| b.copy_from_slice(&f32::NAN.to_le_bytes()));
        parse(&fields.encode())
    };
    let up = [0.0, 0.0, 1.0];
    let grazing = direction(1.4, 0.0);
    let some = holes(0.3).unwrap();
    // The first of three slices is that of the outgoing direction along the normal.
    assert!(some.has_holes() && some.measured(up, up) == 0.0 && some.measured(up, grazing) == 1.0);
    assert!(some.samples(500).iter().all(|sample| sample.2.iter().all(|v| v.is_finite())));
    // Draws, in pictures, see black there.
    let [u, g] = [up, grazing].map(|d| d.map(|v| v as f32));
    assert!([u, g].into_iter().all(|wi| some.look_up(wi, u).value.iter().all(|v| v.is_finite())));
    // Between the first outgoing direction and the next, as much as was measured of the next.
    let [mirror, between] = [std::f64::consts::PI, 0.0].map(|phi| direction(0.4, phi));
    assert!(some.evaluate(mirror, between)[0].is_nan());
    assert!(some.look_up(mirror.map(|v| v as f32), between.map(|v| v as f32)).value[0] > 0.0);
    assert!(!holes(0.0).unwrap().has_holes());
    let message = holes(1.0).unwrap_err().to_string();
    assert!(message.contains("no number was measured"), "{message}");
}

#[test]
fn shapes_that_disagree_are_named() {
    // Two sizes changed so that the number of values stays.
    let swap = |a: usize, b: usize| move |field: &mut Field| field.shape.swap(a, b);
    assert!(error(anisotropic(), "vndf", &swap(0, 1)).contains("vndf"));
    assert!(error(anisotropic(), "vndf", &swap(0, 2)).contains("vndf"));
    assert!(error(anisotropic(), "rgb", &swap(2, 3)).contains("rgb"));
    assert!(error(spectral(), "spectra", &swap(2, 3)).contains("spectra"));
    // A picture of one row.
    let message = error(anisotropic(), "ndf", &|field| {
        field.shape = vec![1, 2];
        field.bytes.truncate(8);
    });
    assert!(message.contains("ndf") && message.contains("1 x 2"), "{message}");
}

#[test]
fn angles_and_wavelengths_have_to_rise_within_their_range() {
    let set = |n: usize, v: f32| {
        move |field: &mut Field| {
            field.bytes[4 * n..4 * n + 4].copy_from_slice(&v.to_le_bytes());
        }
    };
    for (name, n, v, expected) in [
        ("theta_i", 1, 0.0, "rise"),
        ("theta_i", 2, 0.1, "rise"),
        ("theta_i", 0, -0.5, "expected"),
        ("theta_i", 2, 2.0, "expected"),
        ("phi_i", 1, 3.0, "rise"),
        ("phi_i", 0, -4.0, "expected"),
        ("phi_i", 3, -0.5, "-pi"),
        ("phi_i", 0, -3.0, "-pi"),
    ] {
        let message = error(anisotropic(), name, &set(n, v));
        assert!(message.contains(name) && message.contains(expected), "{name} {n} {v}: {message}");
    }
    assert!(error(spectral(), "wavelengths", &set(1, 380.0)).contains("rise"));
    assert!(error(spectral(), "wavelengths", &set(0, 425.0)).contains("nm"));
}

#[test]
fn values_without_meaning_are_named() {
    let fill = |v: f32| {
        move |field: &mut Field| {
            field.bytes.chunks_exact_mut(4).for_each(|b| b.copy_from_slice(&v.to_le_bytes()));
        }
    };
    assert!(error(anisotropic(), "sigma", &fill(0.0)).contains("sigma"));
    assert!(error(anisotropic(), "vndf", &fill(0.0)).contains("vndf"));
    assert!(error(anisotropic(), "vndf", &fill(-1.0)).contains("vndf"));
    assert!(error(anisotropic(), "jacobian", &|field| field.bytes[0] = 7).contains("jacobian"));
    // Numbers whose products and quotients are infinite.
    for (name, value) in [
        ("ndf", 1.1e30),
        ("sigma", 1.1e30),
        ("sigma", 0.9e-30),
        ("vndf", 1.1e30),
        ("rgb", 1.1e30),
        ("rgb", -1.1e30),
    ] {
        let message = error(anisotropic(), name, &fill(value));
        assert!(message.contains(name) && message.contains("was expected"), "{name}, {value}: {message}");
    }
    assert!(error(spectral(), "spectra", &fill(1.1e30)).contains("spectra"));
}

/// There a value would be 0 over 0.
#[test]
fn nothing_is_reflected_on_the_horizon_or_below_it() {
    let (up, side, down) = (direction(0.4, 1.0), [1.0, 0.0, 0.0], [0.6, 0.0, -0.8]);
    for fields in [anisotropic(), small(Written::default())] {
        let rgl = parse(&fields.encode()).unwrap();
        assert!(rgl.evaluate(up, up)[0] > 0.0);
        for [wi, wo] in
            [[side, up], [up, side], [side, side], [[-1.0, 0.0, 0.0], side], [down, up], [up, down]]
        {
            let [narrow_wi, narrow_wo] = [wi, wo].map(|d| d.map(|v| v as f32));
            let known = rgl.look_up(narrow_wi, narrow_wo);
            assert_eq!((rgl.f_cos(wi, wo), rgl.evaluate(wi, wo)), ([0.0; 3], [0.0; 3]), "{wi:?}, {wo:?}");
            assert_eq!((known.value, known.density), ([0.0; 3], 0.0), "{wi:?}, {wo:?}");
        }
    }
}

#[test]
fn what_points_out_of_the_file_is_an_error_and_nothing_panics() {
    let good = anisotropic().encode();
    for cut in 0..good.len() {
        assert!(parse(&good[..cut]).is_err(), "cut at {cut}");
    }
    // Every byte of the list of fields, damaged in several ways: an error, or a material.
    let head = good.windows(8).position(|w| w == b"jacobian").unwrap() + 40;
    for at in 0..head {
        for byte in [0, 1, 0x7f, 0xff, good[at] ^ 1, good[at] ^ 0x80] {
            let mut bad = good.clone();
            bad[at] = byte;
            let _ = parse(&bad);
        }
    }
}
