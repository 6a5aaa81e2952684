//! Surfaces that were turned in an instrument: each format with turns brings them all, and no isotropic surface becomes anisotropic.

use srbf_measured::ReadError;
use srbf_measured::read::{
    Content, Conventions, Intake, Row, Source, alta, numpy, read, read_from, ssdd, utia,
};
use srbf_measured::table::{Brdf, Symmetry};
use std::fmt::Write;
use std::path::PathBuf;

/// Angles of both directions in degrees, light first: from the normal, azimuth.
type Angles = [f64; 4];

/// Facets lean farthest along y, four times as far as along x.
const BRUSHED: &str = "ward:diffuse=0.1,specular=0.3,alpha_x=0.1,alpha_y=0.4";

/// Angles of incidence and of their azimuths, of the viewer and of its azimuth from that of incidence.
const INCIDENCES: [f64; 4] = [10.0, 30.0, 50.0, 70.0];
const TURNS: [f64; 5] = [0.0, 35.0, 70.0, 120.0, 155.0];
const VIEWERS: [f64; 5] = [5.0, 20.0, 35.0, 50.0, 65.0];
const AZIMUTHS: usize = 12;

fn direction(theta: f64, phi: f64) -> [f64; 3] {
    let ((st, ct), (sp, cp)) = (theta.to_radians().sin_cos(), phi.to_radians().sin_cos());
    [st * cp, st * sp, ct]
}

fn model(text: &str) -> Box<dyn Brdf + Send> {
    match read(format!("model:{text}").as_ref()).unwrap().content {
        Content::Evaluable(brdf) => brdf,
        Content::Samples(_) => panic!("{text} is a model"),
    }
}

fn value(brdf: &dyn Brdf, [theta_i, phi_i, theta_o, phi_o]: Angles) -> f64 {
    brdf.evaluate(direction(theta_i, phi_i), direction(theta_o, phi_o))[1]
}

/// Pairs of directions, angle of incidence fastest, then its azimuth, then the viewer's angle, then its azimuth from that of incidence.
fn pairs() -> impl Iterator<Item = Angles> {
    let azimuths = (0..AZIMUTHS).map(|n| 360.0 * n as f64 / AZIMUTHS as f64);
    azimuths.flat_map(|phi| {
        VIEWERS.into_iter().flat_map(move |theta_o| {
            TURNS.into_iter().flat_map(move |turn| {
                INCIDENCES.into_iter().map(move |theta_i| [theta_i, turn, theta_o, turn + phi])
            })
        })
    })
}

fn source(name: &str, bytes: &[u8]) -> Source {
    read_from(name, bytes, &Conventions::default()).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn csv(rows: impl Iterator<Item = (Angles, f64)>) -> String {
    let mut text = "theta_i,phi_i,theta_o,phi_o,value\n".to_owned();
    for ([theta_i, phi_i, theta_o, phi_o], f) in rows {
        let _ = writeln!(text, "{theta_i},{phi_i},{theta_o},{phi_o},{f:e}");
    }
    text
}

fn ssdd_file(brdf: &dyn Brdf) -> Vec<u8> {
    let list = |n: usize, all: &[f64]| {
        let words: Vec<String> = all.iter().map(f64::to_string).collect();
        format!("PARAM{n}_LIST {}\n", words.join(" "))
    };
    let azimuths: Vec<f64> = (0..AZIMUTHS).map(|n| 360.0 * n as f64 / AZIMUTHS as f64).collect();
    let mut text =
        "VERSION 0.2\nDATA_TYPE brdf\nCOLOR_MODEL monochrome\nPARAM_TYPE spherical_coordinate_system\n"
            .to_owned();
    text += &(list(0, &INCIDENCES) + &list(1, &TURNS) + &list(2, &VIEWERS) + &list(3, &azimuths));
    text += "DATA ascii\n";
    pairs().for_each(|angles| {
        let _ = writeln!(text, "{:e}", value(brdf, angles));
    });
    text.into_bytes()
}

fn alta_file(brdf: &dyn Brdf) -> Vec<u8> {
    let mut text = "#DIM 4 1\n#PARAM_IN SPHERICAL_TL_PL_TV_PV\n#PARAM_OUT INV_STERADIAN\n".to_owned();
    for angles in pairs() {
        let [theta_i, phi_i, theta_o, phi_o] = angles.map(f64::to_radians);
        let _ = writeln!(text, "{theta_i:e} {phi_i:e} {theta_o:e} {phi_o:e} {:e}", value(brdf, angles));
    }
    text.into_bytes()
}

fn numpy_file(brdf: &dyn Brdf) -> Vec<u8> {
    let head = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({}, 5), }}\n", pairs().count());
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((head.len() as u16).to_le_bytes());
    bytes.extend(head.bytes());
    for angles in pairs() {
        angles.into_iter().chain([value(brdf, angles)]).for_each(|v| bytes.extend(v.to_le_bytes()));
    }
    bytes
}

/// Light by viewer, each of 6 angles by 48 azimuths, three times.
fn utia_file(brdf: &dyn Brdf) -> Vec<u8> {
    let at = |n: usize| (15.0 * (n / 48) as f64, 7.5 * (n % 48) as f64);
    let mut plane = Vec::with_capacity(288 * 288 * 8);
    for n in 0..288 * 288 {
        let ((theta_i, phi_i), (theta_o, phi_o)) = (at(n / 288), at(n % 288));
        plane.extend(value(brdf, [theta_i, phi_i, theta_o, phi_o]).to_le_bytes());
    }
    plane.repeat(3)
}

/// The samples are those of the model at the very directions.
fn turns_are_read(intake: Result<Intake, ReadError>, brdf: &dyn Brdf) {
    let intake = intake.unwrap();
    let name = intake.format;
    assert!(intake.rows.len() >= 1200 && intake.left_out.is_empty(), "{name}: {}", intake.left_out_text());
    for row in &intake.rows {
        let expected = brdf.evaluate(row.wi, row.wo)[1];
        assert!((row.rgb[1] / expected - 1.0).abs() < 1e-9, "{name}: {row:?}, not {expected}");
    }
    // Both directions have azimuths all round.
    for of in [|row: &Row| row.wi, |row: &Row| row.wo] {
        let quarters = intake.rows.iter().map(of).filter(|d| d[2] < 0.99).map(|d| (d[0] > 0.0, d[1] > 0.0));
        assert!(quarters.collect::<std::collections::HashSet<_>>().len() >= 2, "{name}");
    }
}

#[test]
fn every_format_with_turns_brings_them() {
    let (brdf, conventions) = (model(BRUSHED), Conventions::default());
    let brdf = brdf.as_ref();
    turns_are_read(ssdd::parse(&ssdd_file(brdf), &conventions), brdf);
    turns_are_read(alta::parse(&alta_file(brdf), &conventions), brdf);
    turns_are_read(numpy::parse(&numpy_file(brdf), &conventions), brdf);
    turns_are_read(utia::parse(&utia_file(brdf), &conventions), brdf);
}

/// From the samples follow the axis and the stretch.
#[test]
fn the_axis_is_found_from_the_turns_of_a_file() {
    let source = source("a.ssdd", &ssdd_file(model(BRUSHED).as_ref()));
    let turn = source.completion.as_ref().and_then(|report| report.turn).unwrap();
    println!("{}", turn.text());
    let off = (turn.axis.to_degrees() - 90.0).abs();
    assert!(off < 3.0 && (turn.along / 2.0 - 1.0).abs() < 0.1, "{}", turn.text());
    let Content::Evaluable(completed) = &source.content else { panic!("no completion") };
    assert_ne!(completed.symmetry(), Symmetry::Isotropic);
}

/// Values as an instrument falsifies them: from the directions that the file has, and a number that is nearly normal, of deviation 1.
type Falsify = fn(&dyn Brdf, Angles, f64) -> f64;

/// A sample that lies on its table tilted by two degrees, away from the axis of the turn.
fn tilted(brdf: &dyn Brdf, angles: Angles, _: f64) -> f64 {
    let (sin, cos) = 2f64.to_radians().sin_cos();
    let [wi, wo] = [direction(angles[0], angles[1]), direction(angles[2], angles[3])]
        .map(|[x, y, z]| [x * cos + z * sin, y, z * cos - x * sin]);
    brdf.evaluate(wi, wo)[1]
}

#[test]
fn no_fault_of_an_instrument_makes_an_isotropic_surface_anisotropic() {
    let faults: [(&str, Falsify); 5] = [
        ("as it is", |brdf, angles, _| value(brdf, angles)),
        ("noise of 30 %", |brdf, angles, normal| value(brdf, angles) * (1.0 + 0.3 * normal).max(0.01)),
        ("tilted", tilted),
        ("tilted, noise of 10 %", |brdf, angles, normal| {
            tilted(brdf, angles, normal) * (1.0 + 0.1 * normal).max(0.01)
        }),
        ("left and right differ", |brdf, angles, _| {
            value(brdf, angles) * (1.0 + 0.15 * (angles[3] - angles[1]).to_radians().sin())
        }),
    ];
    let mut random = 7u64;
    let mut unit = || {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut became: Vec<String> = Vec::new();
    for surface in ["ggx:alpha=0.15,f0=0.9,diffuse=0.1", "ggx:alpha=0.35,f0=0.05,diffuse=0.3"] {
        let brdf = model(surface);
        for (fault, falsify) in faults {
            let mut normal = || (0..12).map(|_| unit()).sum::<f64>() - 6.0;
            let text = csv(pairs().map(|angles| (angles, falsify(brdf.as_ref(), angles, normal()))));
            let source = source("a.csv", text.as_bytes());
            let isotropy = source.intake.as_ref().unwrap().isotropy;
            println!("{surface}, {fault}: {isotropy:?}");
            assert!(isotropy.is_some(), "{surface}, {fault}: the turns are not seen");
            if source.completion.is_some() {
                became.push(format!("{surface}, {fault}: {isotropy:?}"));
            }
        }
    }
    assert!(became.is_empty(), "{became:#?}");
}

/// Of all files of samples, one alone is of a surface that a turn changes.
#[test]
#[ignore = "needs SRBF_DATA_DIR"]
fn measured_isotropic_surfaces_stay_isotropic() {
    let data = PathBuf::from(std::env::var_os("SRBF_DATA_DIR").expect("SRBF_DATA_DIR names the data folder"));
    let mut anisotropic = Vec::new();
    let mut count = 0;
    for folder in ["cornell", "field"] {
        for file in std::fs::read_dir(data.join(folder)).unwrap() {
            let path = file.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            let Ok(source) = read(&path) else { continue };
            count += usize::from(source.intake.is_some());
            if source.completion.is_some() {
                anisotropic.push(name);
            }
        }
    }
    assert!(count >= 12, "{count} files of samples");
    assert_eq!(anisotropic, ["sensor_lenslets_zemax4d.bsdf"]);
}
