//! Measured files: read, and evaluated where they can be; and exports read back.

use super::input::{above, random};
use crate::inputs::Random;
use srbf_core::{Quarter, printable};
use srbf_measured::ReadError;
use srbf_measured::analytic;
use srbf_measured::export;
use srbf_measured::look::Look;
use srbf_measured::read::window::{Band, Window};
use srbf_measured::read::{self, Content, Conventions, Intake, astm, cornell, csv, merl, neural, rgl, utia};
use srbf_measured::table::{Brdf, Scattered, Table};
use std::path::Path;

/// Most samples and views of which a table is made: beyond, an execution takes too long.
const MOST_SAMPLES: usize = 200;
const MOST_VIEWS: usize = 2;

/// Cornell's samples in the form of ASTM E1392.
pub fn astm(bytes: &[u8]) -> bool {
    scattered(astm::parse(bytes, &Conventions::default()))
}

/// Cornell's samples as pbrt-v2 has them.
pub fn cornell(bytes: &[u8]) -> bool {
    scattered(cornell::parse(bytes, &Conventions::default()))
}

/// Tables of text.
pub fn csv(bytes: &[u8]) -> bool {
    scattered(csv::parse(bytes, &Conventions::default()))
}

/// A reader of samples.
type Parse = fn(&[u8], &Conventions) -> Result<Intake, ReadError>;

/// Files of other programs: the first byte says of which, the others are the file.
pub fn formats(bytes: &[u8]) -> bool {
    const READERS: [Parse; 11] = [
        read::scatter_tables::zemax,
        read::scatter_tables::lighttools,
        read::speos::anisotropic,
        read::speos::spectral,
        read::openmaterial::parse,
        read::alta::parse,
        read::pab_opto::parse,
        read::ssdd::parse,
        read::fred::parse,
        read::numpy::parse,
        read::records::parse,
    ];
    let Some((&which, file)) = bytes.split_first() else { return false };
    scattered(READERS[usize::from(which) % READERS.len()](file, &Conventions::default()))
}

/// Samples are numbers, and make a table or an error; the look at them is plain text and numbers.
fn scattered(parsed: Result<Intake, ReadError>) -> bool {
    let intake = match parsed {
        Ok(intake) => intake,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            return false;
        }
    };
    let mut rows = intake.rows.iter().flat_map(|row| [row.wi, row.wo, row.rgb]).flatten();
    assert!(rows.all(f64::is_finite), "a row holds a number that is not finite");
    let views = intake.views();
    let samples = views.iter().flat_map(|(_, samples)| samples);
    let mut numbers = samples.flat_map(|(direction, rgb)| direction.iter().chain(rgb));
    assert!(numbers.all(|v| v.is_finite()), "a table holds a number that is not finite");
    let count: usize = views.iter().map(|(_, samples)| samples.len()).sum();
    if count > MOST_SAMPLES {
        return true;
    }
    let look = Look::new(&intake, None);
    assert!(look.to_json().is_object() && look.views.iter().all(|theta| theta.is_finite()));
    for text in look.findings.iter().map(|finding| finding.text.clone()).chain([look.summary()]) {
        assert_eq!(printable(&text).to_string(), text, "as it stands in the file");
    }
    if let Ok(table) = Table::from_scattered(views.into_iter().take(MOST_VIEWS).collect()) {
        let mut samples = table.views.iter().flat_map(|view| &view.samples);
        assert!(samples.all(|s| s.weight.is_finite()), "a sample without a weight");
    }
    true
}

/// The XML of WINDOW and Radiance: its quarters are functions with a value everywhere.
pub fn window(bytes: &[u8]) -> bool {
    let window = match Window::parse(bytes, Band::default()) {
        Ok(window) => window,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            return false;
        }
    };
    assert!(window.scale > 0.0 && window.scale <= 1.0, "{}", window.scale);
    let mut random = random(bytes);
    for quarter in Quarter::ALL {
        let Some(own) = &window.quarters[quarter as usize] else { continue };
        let matrix = &own.matrix;
        assert!(matrix.values.iter().all(|v| v.is_finite() && *v >= 0.0));
        // Of many patches a function takes long to find; that of a tree of three dimensions needs none.
        if matrix.values.len() <= 1000 || bytes.windows(11).any(|word| word == b"TensorTree3") {
            let brdf = window.brdf(quarter).expect("it is there");
            evaluate(brdf.as_ref(), &mut random, 6);
        }
    }
    true
}

/// A MERL file whose planes repeat the bytes, of which the first says where they begin; and the bytes as they are.
pub fn merl(bytes: &[u8]) -> bool {
    assert!(merl::parse(bytes).is_err(), "no input is as long as a file");
    let Some((&start, body)) = bytes.split_first() else { return false };
    if body.len() < 8 || start % 16 != 0 {
        return false;
    }
    let whole = 12 + 3 * 8 * 90 * 90 * 180;
    let mut file = Vec::with_capacity(whole);
    for size in [90i32, 90, 180] {
        file.extend_from_slice(&size.to_le_bytes());
    }
    while file.len() < whole {
        file.extend_from_slice(&body[..body.len().min(whole - file.len())]);
    }
    let Ok(merl) = merl::parse(&file) else { return false };
    evaluate(&merl, &mut random(bytes), 20);
    true
}

/// A UTIA file whose planes repeat the bytes, of which the first says how many are left out at its end.
pub fn utia(bytes: &[u8]) -> bool {
    assert!(utia::parse(bytes, &Conventions::default()).is_err(), "no input is as long as a file");
    let Some((&short, body)) = bytes.split_first() else { return false };
    // An execution takes a twentieth of a second.
    if body.len() < 8 || short % 16 > 1 {
        return false;
    }
    let mut file: Vec<u8> = body.iter().copied().cycle().take(3 * 288 * 288 * 8).collect();
    file.truncate(file.len() - usize::from(short));
    scattered(utia::parse(&file, &Conventions::default()))
}

/// Networks.
pub fn neural(bytes: &[u8]) -> bool {
    let Ok(networks) = neural::parse(bytes) else { return false };
    let mut random = random(bytes);
    for network in networks.iter().take(3) {
        evaluate(network, &mut random, 3);
    }
    true
}

/// RGL files: values, and their own draws.
pub fn rgl(bytes: &[u8]) -> bool {
    let Ok(brdf) = rgl::parse(bytes) else { return false };
    let mut random = random(bytes);
    evaluate(&brdf, &mut random, 6);
    for _ in 0..6 {
        let [wi, wo] = [above(&mut random), above(&mut random)].map(|d| d.as_dvec3().to_array());
        let value = brdf.f_cos(wi, wo);
        let is_right = |v: &f64| v.is_finite() || v.is_nan() && brdf.has_holes();
        assert!(value.iter().all(is_right), "{wi:?}, {wo:?}: f cos {value:?}");
        let Some(draws) = brdf.draws() else { continue };
        let [wi, wo] = [wi, wo].map(|d| d.map(|v| v as f32));
        let (drawn, with) = draws.draw([random.uniform(), random.uniform()], wo);
        assert!(drawn.iter().all(|v| v.is_finite()), "{wo:?}: {drawn:?}");
        for known in [with, draws.look_up(wi, wo)] {
            let is_valid = known.density >= 0.0 && known.density.is_finite();
            assert!(is_valid && known.value.iter().all(|v| v.is_finite()), "{wi:?}, {wo:?}: {known:?}");
        }
    }
    true
}

/// Values at pairs of directions above the horizon are finite, or no numbers where nothing was measured.
fn evaluate(brdf: &dyn Brdf, random: &mut Random, pairs: usize) {
    for _ in 0..pairs {
        let [wi, wo] = [above(random), above(random)]
            .map(|d| [f64::from(d.x), f64::from(d.y), f64::from(d.z).max(1e-20)]);
        let value = brdf.evaluate(wi, wo);
        assert!(!value.iter().any(|v| v.is_infinite()), "{wi:?}, {wo:?}: {value:?}");
    }
}

/// The text of an analytic model, its values, and a table of it, written as `.csv` and `.astm` and read back.
pub fn exports(bytes: &[u8]) -> bool {
    let Ok(text) = core::str::from_utf8(bytes) else { return false };
    // A model that reads a file would read any.
    if text.contains("file=") || text.starts_with("sgd") || text.starts_with("abc") {
        return false;
    }
    let Ok(source) = read::read(Path::new(&format!("{}{text}", analytic::PREFIX))) else { return false };
    let Content::Evaluable(brdf) = source.content else { return false };
    let mut random = random(bytes);
    evaluate(&*brdf, &mut random, 6);
    let direction = |random: &mut Random| above(random).as_dvec3().to_array();
    let views: Vec<(f64, Scattered)> = (0..3)
        .map(|n| {
            let theta = 0.4 * f64::from(n);
            let wo = [-theta.sin(), 0.0, theta.cos()];
            let samples = (0..8).map(|_| {
                let wi = direction(&mut random);
                (wi, brdf.evaluate(wi, wo))
            });
            (theta, samples.collect())
        })
        .collect();
    let Ok(table) = Table::from_scattered(views) else { return true };
    let count = |parse: Parse, file: String| {
        let parsed = parse(file.as_bytes(), &Conventions::default());
        let intake = parsed.unwrap_or_else(|error| panic!("{text}: an export is not read back: {error}"));
        intake.rows.len() + intake.left_out.iter().map(|left_out| left_out.count).sum::<usize>()
    };
    let written: usize = table.views.iter().map(|view| view.samples.len()).sum();
    assert_eq!(count(csv::parse, export::csv(&table, None)), written, "{text}");
    assert_eq!(count(astm::parse, export::astm(&table)), written, "{text}");
    true
}
