//! Sheets: fits of all quarters, and the way back to files.

use crate::{folder, refused, srbf};
use glam::Vec3;
use srbf_core::{Quarter, Sheet, SheetMixture, luminance};
use std::fmt::Write;
use std::path::Path;

const FEW: [&str; 12] = [
    "--lobes",
    "2",
    "--starts",
    "1",
    "--steps",
    "10",
    "--views",
    "3",
    "--exchanges",
    "0",
    "--factors",
    "none",
];

/// Output of a command that ends well.
fn said(place: &Path, words: &[&str]) -> String {
    let output = srbf(place, words);
    assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Rows with viewers on one side, and lights on both: the values of reflection and of transmission, `f` in 1/sr.
fn rows(text: &mut String, side: f64, reflected: f64, transmitted: f64) {
    for wo in [[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [0.96, 0.0, 0.28f64]] {
        for (light, f) in [(side, reflected), (-side, transmitted)] {
            for i in 0..40 {
                let (z, phi) = ((f64::from(i) + 0.5) / 40.0, 2.4 * f64::from(i));
                let r = (1.0 - z * z).sqrt();
                let (x, y, z) = (r * phi.cos(), r * phi.sin(), light * z);
                writeln!(text, "{x},{y},{z},{},{},{},{f},{f},{f}", wo[0], wo[1], side * wo[2]).unwrap();
            }
        }
    }
}

fn table(sides: &[(f64, f64, f64)]) -> String {
    let mut text = String::from("wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,r,g,b\n");
    sides.iter().for_each(|&(side, reflected, transmitted)| rows(&mut text, side, reflected, transmitted));
    text
}

/// Reflected and transmitted share towards a viewer at 40 degrees, in front (1) or behind (-1).
fn shares(sheet: &Sheet<Vec<u8>>, side: f32) -> [f32; 2] {
    let mut pair = SheetMixture::<64>::empty();
    sheet.prepare(Vec3::new(0.643, 0.0, side * 0.766), &mut pair).unwrap();
    pair.albedos().map(luminance)
}

#[test]
fn samples_on_both_sides_are_a_sheet() {
    let place = folder("sheet-samples");
    // Lambertian: shares of .3 and .5 in front, .1 behind. Transmission is measured from one side.
    let pi = std::f64::consts::PI;
    let mut text = table(&[(1.0, 0.3 / pi, 0.5 / pi)]);
    let behind = table(&[(-1.0, 0.1 / pi, 0.0)]);
    behind
        .lines()
        .skip(1)
        .filter(|line| !line.ends_with(",0,0,0"))
        .for_each(|line| text += &format!("{line}\n"));
    std::fs::write(place.join("cloth.csv"), &text).unwrap();
    let fit = [&["fit", "cloth.csv", "--sheet", "--no-picture", "-o", "cloth.srbf"], &FEW[..]].concat();
    let words = said(&place, &fit);
    assert!(words.contains("the transmission is taken as the same from both sides"), "{words}");
    assert!(!words.contains("is black") && !words.contains("lowered"), "{words}");
    let sheet = Sheet::from_bytes(std::fs::read(place.join("cloth.srbf")).unwrap()).unwrap();
    for (side, wanted) in [(1.0, [0.3, 0.5]), (-1.0, [0.1, 0.5])] {
        let found = shares(&sheet, side);
        assert!((0..2).all(|k| (found[k] - wanted[k]).abs() < 0.01), "{side}: {found:?}, {wanted:?}");
    }
    let json: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(place.join("cloth.json")).unwrap()).unwrap();
    assert_eq!(json["transmissions_are_one_measurement"], true);

    // One quarter alone, and the default: the reflection of the front.
    let one =
        [&["fit", "cloth.csv", "--quarter", "back-reflection", "--no-picture", "-o", "b.srbf"], &FEW[..]]
            .concat();
    said(&place, &one);
    refused(
        &place,
        &["fit", "cloth.csv", "--sheet", "--quarter", "back-reflection"],
        &["--sheet", "--quarter"],
    );
    refused(
        &place,
        &["fit", "cloth.csv", "--sheet", "--band", "solar"],
        &["cloth.csv", "a file of a window"],
    );
    refused(&place, &["fit", "model:ggx", "--sheet"], &["model:ggx", "--sheet", "a file is expected"]);

    // The samples of the fit make the same sheet.
    let back = said(&place, &["convert", "cloth.srbf", "back.csv"]);
    assert!(back.contains("samples of 4 quarters"), "{back}");
    let text = std::fs::read_to_string(place.join("back.csv")).unwrap();
    let count = |wi: f64, wo: f64| {
        let is = |line: &&str| {
            let n: Vec<f64> = line.split(',').map(|word| word.parse().unwrap()).collect();
            n[2] * wi > 0.0 && n[5] * wo > 0.0
        };
        text.lines().skip(2).filter(is).count()
    };
    for (wi, wo) in [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)] {
        assert!(count(wi, wo) > 10_000, "{wi} {wo}: {}", count(wi, wo));
    }
}

/// Of samples that are fitted twice: they reflect and let through more light than falls on them.
#[test]
fn the_share_of_a_fit_that_goes_on_never_falls() {
    let place = folder("sheet-share");
    let pi = std::f64::consts::PI;
    std::fs::write(place.join("bright.csv"), table(&[(1.0, 0.9 / pi, 0.6 / pi)])).unwrap();
    let conventions = srbf_fit::read::Conventions::default();
    let sheet = srbf_fit::read::sheet_of(&place.join("bright.csv"), &conventions, true).unwrap().unwrap();
    let settings = srbf_fit::Settings {
        lobes: 2,
        starts: 1,
        steps: 10,
        views: Some(3),
        exchanges: 0,
        ..srbf_fit::Settings::default()
    };
    let mut shares = Vec::new();
    let fit = srbf_fit::fit_sheet(&sheet, &settings, |share| shares.push(share)).unwrap();
    assert!(fit.scale < 1.0, "{}", fit.scale);
    assert!(shares.is_sorted() && shares[0] < 0.1, "{shares:?}");
    assert_eq!(shares.last(), Some(&1.0));
    // The second fit is shown too.
    assert!(shares.iter().filter(|share| (0.55..0.95).contains(*share)).count() > 5, "{shares:?}");
}

#[test]
fn no_more_light_leaves_than_falls_on_it() {
    let place = folder("sheet-bright");
    let pi = std::f64::consts::PI;
    std::fs::write(place.join("bright.csv"), table(&[(1.0, 0.6 / pi, 0.6 / pi)])).unwrap();
    let fit = [&["fit", "bright.csv", "--sheet", "--no-picture", "-o", "bright.srbf"], &FEW[..]].concat();
    let words = said(&place, &fit);
    assert!(words.contains("values are lowered to 100 %"), "{words}");
    assert!(words.contains("the reflection of the back is black"), "{words}");
    let sheet = Sheet::from_bytes(std::fs::read(place.join("bright.srbf")).unwrap()).unwrap();
    let sum: f32 = shares(&sheet, 1.0).iter().sum();
    assert!((0.98..1.003).contains(&sum), "{sum}");
    assert!(sheet.quarter(Quarter::BackReflection).is_none());
    assert_eq!(
        sheet.quarter(Quarter::BackTransmission).map(|m| m.bytes().to_vec()),
        sheet.quarter(Quarter::FrontTransmission).map(|m| m.bytes().to_vec())
    );
    let behind = table(&[(-1.0, 0.0, 0.0)]);
    std::fs::write(place.join("black.csv"), behind).unwrap();
    refused(&place, &["fit", "black.csv", "--sheet"], &["black.csv", "all quarters are black"]);
}

#[test]
fn a_window_is_fitted_and_written_again() {
    let place = folder("sheet-window");
    for name in ["small", "tree3"] {
        let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/corpus");
        std::fs::copy(corpus.join(format!("{name}.xml")), place.join(format!("{name}.xml"))).unwrap();
        let (file, fitted) = (format!("{name}.xml"), format!("{name}.srbf"));
        let fit = [&["fit", &file, "--no-picture", "-o", &fitted], &FEW[..]].concat();
        let words = said(&place, &fit);
        assert!(words.contains("share reflected and transmitted"), "{words}");
        let inspected = said(&place, &["inspect", &fitted]);
        let quarter = format!("{fitted}:front-transmission");
        assert!(inspected.contains("a sheet") && inspected.contains(&quarter), "{inspected}");
        let written = said(&place, &["convert", &fitted, &format!("{name}-again.xml")]);
        assert!(written.contains("matrices of 145 x 145 patches"), "{written}");
    }
    said(&place, &["look", "tree3.xml", "--quarter", "back-transmission"]);
    let bands = "it has Visible, CIE-u, CIE-v";
    refused(&place, &["fit", "tree3.xml", "--band", "solar"], &["tree3.xml", bands]);
    refused(&place, &["look", "tree3.xml", "--band", "mauve"], &["tree3.xml", bands]);
    refused(
        &place,
        &["fit", "small-again.xml", "--cross-validate"],
        &["small-again.xml", "--cross-validate"],
    );
    refused(&place, &["convert", "small.srbf", "small.binary"], &["small.srbf"]);
}

#[test]
fn materials_are_joined_and_packed() {
    let place = folder("sheet-join");
    let presets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../presets");
    for name in ["garnet_red", "krylon_blue"] {
        std::fs::copy(presets.join(format!("{name}.srbf")), place.join(format!("{name}.srbf"))).unwrap();
    }
    let halves = ["--front-reflection", "garnet_red.srbf", "--front-transmission", "krylon_blue.srbf"];
    let join = [&["join"], &halves[..], &["--symmetric", "-o", "both.srbf"]].concat();
    let words = said(&place, &join);
    assert!(words.contains("2 quarters") && words.contains("light on the front"), "{words}");
    let bytes = |name: &str| std::fs::read(place.join(name)).unwrap();
    let sheet = Sheet::from_bytes(bytes("both.srbf")).unwrap();
    assert!(sheet.is_symmetric());
    for quarter in [Quarter::FrontTransmission, Quarter::BackTransmission] {
        assert_eq!(sheet.quarter(quarter).unwrap().bytes(), bytes("krylon_blue.srbf"));
    }

    let words = said(&place, &["pack", "both.srbf", "--cut", "-o", "packed.srbf"]);
    assert!(words.contains("front-reflection:") && words.contains("a sheet of"), "{words}");
    let packed = Sheet::from_bytes(bytes("packed.srbf")).unwrap();
    assert!(packed.is_symmetric() && 2 * packed.bytes().len() < sheet.bytes().len());
    for side in [1.0, -1.0] {
        let (whole, found) = (shares(&sheet, side), shares(&packed, side));
        assert!((0..2).all(|k| (found[k] / whole[k] - 1.0).abs() < 0.02), "{side}: {found:?}, {whole:?}");
    }
    // A quarter is a material to other commands; the plain form comes back.
    said(&place, &["pack", "packed.srbf:front-transmission", "--bits", "32", "-o", "plain.srbf"]);
    said(&place, &["pack", "packed.srbf", "--bits", "32", "-o", "sheet.srbf"]);
    assert!(Sheet::from_bytes(bytes("sheet.srbf")).unwrap().bytes().len() > packed.bytes().len());

    refused(&place, &["join", "-o", "none.srbf"], &["a quarter is expected"]);
    let back = ["join", "--back-reflection", "garnet_red.srbf", "--symmetric", "-o", "none.srbf"];
    refused(&place, &back, &["--symmetric", "--back-reflection"]);
    refused(
        &place,
        &["join", "--front-reflection", "both.srbf", "-o", "none.srbf"],
        &["both.srbf", "a sheet"],
    );
    assert!(!place.join("none.srbf").exists());
}
