//! Readers on the real files: `cargo test -p srbf-measured -- --ignored`.

use srbf_measured::read::{Content, read, rgl};
use srbf_measured::table::Brdf;
use std::path::PathBuf;

fn data(file: &str) -> PathBuf {
    let folder = std::env::var_os("SRBF_DATA_DIR").expect("SRBF_DATA_DIR names the data folder");
    PathBuf::from(folder).join(file)
}

/// Against 1000 evaluations by Mitsuba 3.9.1.
#[test]
#[ignore = "needs SRBF_DATA_DIR"]
fn rgl_files_are_evaluated_as_mitsuba_does() {
    let text = std::fs::read_to_string(data("rgl/reference_evals.csv")).unwrap();
    let mut open: Option<(String, rgl::Rgl)> = None;
    let mut worst = 0.0f64;
    for line in text.lines().skip(1) {
        let (name, numbers) = line.split_once(',').unwrap();
        if open.as_ref().is_none_or(|(n, _)| n != name) {
            let bytes = std::fs::read(data(&format!("rgl/{name}_rgb.bsdf"))).unwrap();
            open = Some((name.to_owned(), rgl::parse(&bytes).unwrap()));
        }
        let v: Vec<f64> = numbers.split(',').map(|n| n.parse().unwrap()).collect();
        // Mitsuba's wi is the direction that the measurement is parametrised by: our outgoing one.
        let ours = open.as_ref().unwrap().1.f_cos([v[3], v[4], v[5]], [v[0], v[1], v[2]]);
        for c in 0..3 {
            let difference = (ours[c] - v[6 + c]).abs() / (v[6 + c].abs() + 1e-4);
            worst = worst.max(difference);
            assert!(difference < 2e-3, "{line}: {ours:?}");
        }
    }
    println!("largest relative difference {worst:.1e}");
}

/// Cornell's two forms of one measurement agree; the RGB form of another is for other primaries than sRGB, which makes a
/// saturated red 8 % darker, so only its scale is checked.
#[test]
#[ignore = "needs SRBF_DATA_DIR"]
fn astm_files_agree_with_brdf_files() {
    for (a, b, tolerance) in
        [("acryl_blue.astm", "acryl_blue.brdf", 1e-9), ("garnet_red_RGB.astm", "garnet_red.brdf", 0.15)]
    {
        let table = |name: &str| match read(&data(&format!("cornell/{name}"))).unwrap().content {
            Content::Samples(table) => table,
            Content::Evaluable(_) => panic!("{name} is scattered"),
        };
        let (a, b) = (table(a), table(b));
        for (a, b) in a.views.iter().zip(&b.views) {
            for c in 0..3 {
                assert!(
                    (a.albedo[c] - b.albedo[c]).abs() <= tolerance * b.albedo[c].max(0.05),
                    "{:?} {:?}",
                    a.albedo,
                    b.albedo
                );
            }
        }
    }
}

/// The MERL form of an RGL measurement, which has to be unpacked beside the data: 34 MB.
#[test]
#[ignore = "needs SRBF_DATA_DIR"]
fn the_merl_file_agrees_with_the_rgl_file_it_was_made_from() {
    let mut unpacked = Vec::new();
    let packed = std::fs::read(data("merl/rgl_ilm_solo_m_68_as_merl.binary.xz")).unwrap();
    lzma_rs::xz_decompress(&mut packed.as_slice(), &mut unpacked).unwrap();
    let merl = srbf_measured::read::merl::parse(&unpacked).unwrap();
    assert!(srbf_measured::read::merl::parse(&unpacked[..unpacked.len() - 8]).is_err());
    let rgl = rgl::parse(&std::fs::read(data("rgl/ilm_solo_m_68_rgb.bsdf")).unwrap()).unwrap();
    let mut logs = Vec::new();
    for i in 0..400 {
        let at = |n: f64, m: f64| {
            let (t, p) = (0.1 + 1.0 * (n * 0.618).fract(), 6.0 * (m * 0.414).fract());
            [t.sin() * p.cos(), t.sin() * p.sin(), t.cos()]
        };
        let (wi, wo) = (at(f64::from(i), f64::from(i)), at(f64::from(i) + 0.3, f64::from(3 * i)));
        let (a, b) = (merl.evaluate(wi, wo)[2], 0.5 * (rgl.evaluate(wi, wo)[2] + rgl.evaluate(wo, wi)[2]));
        logs.push((a.max(1e-6) / b.max(1e-6)).ln().abs());
    }
    logs.sort_by(f64::total_cmp);
    assert!(logs[logs.len() / 2] < 0.1, "median |log ratio| {}", logs[logs.len() / 2]);
}

/// SGD and neural fits are two independent fits of the same MERL measurements: they have to say about the same.
#[test]
#[ignore = "needs SRBF_DATA_DIR"]
fn sgd_fits_agree_with_neural_fits_of_the_same_material() {
    let names = std::fs::read_to_string(data("merl/nbrdf_merl80_names.txt")).unwrap();
    let networks =
        srbf_measured::read::neural::parse(&std::fs::read(data("merl/nbrdf_merl80.f32le")).unwrap()).unwrap();
    // Medians of |log ratio| that data/README.md states, over other pairs.
    for (name, stated) in [("red-fabric", 0.10), ("white-paint", 0.19), ("gold-metallic-paint", 0.27)] {
        let network = &networks[names.split_whitespace().position(|n| n == name).unwrap()];
        let Content::Evaluable(sgd) =
            read(std::path::Path::new(&format!("model:sgd:name={name}"))).unwrap().content
        else {
            panic!("a model can be evaluated")
        };
        let mut logs = Vec::new();
        for i in 0..1000 {
            let at = |n: f64, m: f64| {
                let (t, p) = (1.4 * (n * 0.618).fract(), 6.0 * (m * 0.414).fract());
                [t.sin() * p.cos(), t.sin() * p.sin(), t.cos()]
            };
            let (wi, wo) = (at(f64::from(i), f64::from(i)), at(f64::from(i) + 0.3, f64::from(3 * i)));
            let (a, b) = (sgd.evaluate(wi, wo), network.evaluate(wi, wo));
            (0..3).for_each(|c| logs.push((a[c].max(1e-5) / b[c].max(1e-5)).ln().abs()));
        }
        logs.sort_by(f64::total_cmp);
        let median = logs[logs.len() / 2];
        println!("{name}: median |log ratio| {median:.3}, stated {stated}");
        assert!(median < 1.6 * stated, "{name}: {median}, stated {stated}");
    }
}
