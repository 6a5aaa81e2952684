//! Measurements as people have them: each kind of layout and fault is read, refused or valued as it should be.
//!
//! The inputs are made here, from models whose values are known, one fault in each.

use srbf_measured::complete::complete;
use srbf_measured::look::{Look, Topic};
use srbf_measured::read::{Content, Conventions, Mirror, Reason, Source, Values, read, read_with};
use srbf_measured::table::Brdf;
use srbf_measured::with_reasons;
use std::path::{Path, PathBuf};

/// One sample: angles of both directions in degrees, and f.
#[derive(Clone, Copy)]
struct Sample {
    theta_i: f64,
    phi_i: f64,
    theta_o: f64,
    phi_o: f64,
    f: f64,
}

const NAMES: &str = "theta_i,phi_i,theta_o,phi_o,value";

fn direction(theta: f64, phi: f64) -> [f64; 3] {
    let ((st, ct), (sp, cp)) = (theta.to_radians().sin_cos(), phi.to_radians().sin_cos());
    [st * cp, st * sp, ct.max(0.0)]
}

fn model(name: &str) -> Box<dyn Brdf + Send> {
    match read(Path::new(name)).unwrap().content {
        Content::Evaluable(brdf) => brdf,
        Content::Samples(_) => panic!("{name} is a model"),
    }
}

/// A dull plastic, on a grid of 450 pairs of directions in half a turn.
fn grid() -> Vec<Sample> {
    of_model("model:ggx:alpha=0.35,f0=0.05,diffuse=0.3")
}

fn of_model(name: &str) -> Vec<Sample> {
    let brdf = model(name);
    let mut samples = Vec::new();
    for theta_i in [10.0, 25.0, 40.0, 55.0, 70.0] {
        for theta_o in (0..9).map(|n| 10.0 * f64::from(n)) {
            for phi_o in (0..10).map(|n| 20.0 * f64::from(n)) {
                let f = brdf.evaluate(direction(theta_i, 0.0), direction(theta_o, phi_o))[1];
                samples.push(Sample { theta_i, phi_i: 0.0, theta_o, phi_o, f });
            }
        }
    }
    samples
}

fn text(samples: &[Sample]) -> String {
    let row = |s: &Sample| format!("{},{},{},{},{:.6}\n", s.theta_i, s.phi_i, s.theta_o, s.phi_o, s.f);
    format!("{NAMES}\n{}", samples.iter().map(row).collect::<String>())
}

fn changed(change: impl Fn(&mut Sample)) -> String {
    let mut samples = grid();
    samples.iter_mut().for_each(change);
    text(&samples)
}

/// A file that is gone when it is dropped.
struct File(PathBuf);

impl File {
    fn new(name: &str, bytes: &[u8]) -> Self {
        let path = std::env::temp_dir().join(format!("srbf-field-{}-{name}", std::process::id()));
        std::fs::write(&path, bytes).unwrap();
        Self(path)
    }
}

impl Drop for File {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

fn read_text(name: &str, text: &str) -> Source {
    let file = File::new(name, text.as_bytes());
    read(&file.0).unwrap_or_else(|error| panic!("{name}: {}", with_reasons(&error)))
}

fn refused(name: &str, text: &str) -> String {
    let file = File::new(name, text.as_bytes());
    match read(&file.0) {
        Ok(_) => panic!("{name} is read"),
        Err(error) => with_reasons(&error),
    }
}

/// The findings about a file, completed.
fn look(source: &Source) -> Look {
    let Content::Samples(table) = &source.content else { panic!("samples") };
    let completion = complete(table).unwrap();
    Look::new(source.intake.as_ref().unwrap(), Some(&completion.report))
}

fn quick_look(source: &Source) -> Look {
    Look::new(source.intake.as_ref().unwrap(), None)
}

fn is_off(look: &Look, topic: Topic) -> bool {
    look.findings.iter().any(|finding| finding.topic == topic && finding.is_off)
}

/// The same rows in many layouts and spellings are the same samples.
#[test]
fn layouts_of_the_same_rows_are_read() {
    let few = &grid()[20..44];
    let plain = text(few);
    let row = |sep: &str, number: &dyn Fn(f64) -> String| -> String {
        let line = |s: &Sample| [s.theta_i, s.phi_i, s.theta_o, s.phi_o, s.f].map(number).join(sep) + "\n";
        few.iter().map(line).collect()
    };
    let point = |v: f64| format!("{v:.6}");
    let comma = |v: f64| format!("{v:.6}").replace('.', ",");
    let renamed = |names: &str| plain.replacen(NAMES, names, 1);
    let spectrum = |wavelengths: &[&str]| {
        let line = |s: &Sample| {
            let values = wavelengths.iter().map(|_| format!("{:.6}", s.f)).collect::<Vec<_>>().join(",");
            format!("{},{},{},{},{values}\n", s.theta_i, s.phi_i, s.theta_o, s.phi_o)
        };
        format!(
            "theta_i,phi_i,theta_o,phi_o,{}\n{}",
            wavelengths.join(","),
            few.iter().map(line).collect::<String>()
        )
    };
    let long: String = few
        .iter()
        .flat_map(|s| {
            [450, 550, 650]
                .map(|w| format!("{},{},{},{},{w},{:.6}\n", s.theta_i, s.phi_i, s.theta_o, s.phi_o, s.f))
        })
        .collect();
    let falling: Vec<String> = (0..31).rev().map(|n| (400 + 10 * n).to_string()).collect();
    let falling: Vec<&str> = falling.iter().map(String::as_str).collect();
    let radians = |v: f64| format!("{:.9}", v.to_radians());
    let astm = |vars: &str, values: usize| {
        let line = |s: &Sample| {
            let values = vec![format!("{:.6}", s.f); values].join(",");
            format!(
                "{},{},{},{},{values}\n",
                radians(s.theta_i),
                radians(s.phi_i),
                radians(s.theta_o),
                radians(s.phi_o)
            )
        };
        format!("MEAS_NAME BRDF\nNUM_POINTS 24\nVARS {vars}\n\n{}", few.iter().map(line).collect::<String>())
    };
    let sigma: String = plain.lines().skip(1).map(|line| format!("{line},0.001\n")).collect();
    for (name, text) in [
        ("plain.csv", plain.clone()),
        ("no_ending", plain.clone()),
        ("plain.brdf", plain.clone()),
        ("theta_r.csv", renamed("theta_i,phi_i,theta_r,phi_r,value")),
        ("camel.csv", renamed("thetaI,phiI,thetaO,phiO,BRDF")),
        ("units.csv", renamed("theta_i [deg],phi_i [deg],theta_o [deg],phi_o [deg],value")),
        ("quoted.csv", renamed("\"theta_i\",\"phi_i\",\"theta_o\",\"phi_o\",\"value\"")),
        ("german.csv", format!("theta_i;phi_i;theta_o;phi_o;value\n{}", row(";", &comma))),
        (
            "german_names.csv",
            format!(
                "Probe;Lack 7\nBearbeiter;M\u{fc}ller\n\nEinfallswinkel;Einfallsazimut;Beobachtungswinkel;Beobachtungsazimut;BRDF\n{}",
                row(";", &comma)
            ),
        ),
        (
            "scatter_deg.txt",
            format!(
                "\"Incidence (deg)\"\t\"Incidence azimuth (deg)\"\t\"Scatter (deg)\"\t\"Scatter azimuth (deg)\"\tBRDF\n{}",
                row("\t", &point)
            ),
        ),
        ("cosines_too.csv", {
            let rows = plain.lines().skip(1).map(|line| format!("{line},0.5,0.5\n")).collect::<String>();
            format!("{NAMES},cos_i,cos_o\n{rows}")
        }),
        ("tab.csv", format!("theta_i\tphi_i\ttheta_o\tphi_o\tvalue\n{}", row("\t", &point))),
        ("sep.csv", format!("sep=,\n{plain}")),
        ("trailing.csv", plain.replace('\n', ",\n")),
        ("laser.csv", renamed("theta_i,phi_i,theta_o,phi_o,532nm")),
        ("falling.csv", spectrum(&falling)),
        ("sigma.csv", format!("{NAMES},sigma\n{sigma}")),
        ("xyz.csv", spectrum(&["X", "Y", "Z"])),
        ("long.csv", format!("theta_i,phi_i,theta_o,phi_o,wavelength,value\n{long}")),
        ("xyz.astm", astm("theta_i,phi_i,theta_s,phi_s,X,Y,Z", 3)),
        ("550.astm", astm("theta_i,phi_i,theta_s,phi_s,550nm", 1)),
        ("theta_r.astm", astm("theta_i,phi_i,theta_r,phi_r,R,G,B", 3)),
    ] {
        let source = read_text(name, &text);
        let intake = source.intake.as_ref().unwrap();
        assert_eq!((intake.rows.len(), intake.left_out_count()), (24, 0), "{name}");
        for (row, s) in intake.rows.iter().zip(few) {
            // X, Y, Z that are equal are not white.
            let tolerance = if name.starts_with("xyz") { 0.25 * s.f } else { 1e-5 };
            assert!((row.rgb[1] - s.f).abs() < tolerance, "{name}: {row:?}, {}", s.f);
            let angle = row.wi[2].acos().to_degrees() - s.theta_i;
            assert!(
                angle.abs() < 1e-3 && (row.wo[2].acos().to_degrees() - s.theta_o).abs() < 1e-3,
                "{name}: {row:?}"
            );
        }
    }
}

/// Missing values are left out, counted, and never 0.
#[test]
fn what_was_not_measured_is_left_out_and_counted() {
    let every = |n: usize, value: &str| -> String {
        text(&grid())
            .lines()
            .enumerate()
            .map(|(line, row)| match (line, row.rsplit_once(',')) {
                (1.., Some((angles, _))) if line % n == 0 => format!("{angles},{value}\n"),
                _ => format!("{row}\n"),
            })
            .collect::<String>()
    };
    let extra = |rows: &str| text(&grid()) + rows;
    let few = text(&grid()[..19]);
    for (name, text, reason, count) in [
        ("m1.csv", every(34, "-1"), Reason::Sentinel(-1.0), 13),
        ("m999.csv", every(34, "-999"), Reason::Sentinel(-999.0), 13),
        ("nan.csv", every(34, "NaN"), Reason::NoNumber, 13),
        ("empty.csv", every(34, ""), Reason::NoNumber, 13),
        ("zero.csv", every(34, "0"), Reason::DeadZero, 13),
        ("o90.csv", few.clone() + "10,0,90,0,0\n25,0,90,90,0\n40,0,90,180,0\n", Reason::Horizon, 3),
        ("i90.csv", extra("90,0,10,0,0\n90,0,20,0,0\n"), Reason::Horizon, 2),
        ("transmission.csv", few + "25,0,160,0,0.02\n25,0,170,90,0.02\n", Reason::Transmission, 2),
    ] {
        let source = read_text(name, &text);
        let intake = source.intake.as_ref().unwrap();
        let [left] = intake.left_out.as_slice() else { panic!("{name}: {:?}", intake.left_out) };
        assert_eq!((left.reason, left.count), (reason, count), "{name}");
        assert!(!left.lines.is_empty() && intake.rows.iter().all(|row| row.rgb[1] > 0.0), "{name}");
        assert!(quick_look(&source).findings.iter().any(|f| f.topic == Topic::NotMeasured), "{name}");
    }
}

/// Angles and sides that may mean two things are asked back, or said with the option that decides.
#[test]
fn conventions_are_asked_or_said() {
    let radians = changed(|s| {
        for angle in [&mut s.theta_i, &mut s.phi_i, &mut s.theta_o, &mut s.phi_o] {
            *angle = angle.to_radians();
        }
    });
    assert!(refused("rad.csv", &radians).contains("--angles radians"));

    let cosines = text(&grid()).replacen("theta_i,phi_i,theta_o,phi_o", "cos_i,phi_i,cos_o,phi_o", 1);
    assert!(refused("cosines.csv", &cosines).contains("is no cosine"));

    // A glossy surface whose azimuths count from the mirror direction.
    let mut samples = of_model("model:ggx:alpha=0.15,f0=0.9");
    samples.iter_mut().for_each(|s| s.phi_o = 180.0 - s.phi_o);
    let mirror = text(&samples);
    let source = read_text("mirror0.csv", &mirror);
    let said =
        |source: &Source| quick_look(source).findings.iter().any(|f| f.option == Some("--mirror equal"));
    assert!(said(&source));
    let file = File::new("mirror1.csv", mirror.as_bytes());
    let turned = Conventions { mirror: Some(Mirror::Equal), ..Conventions::default() };
    assert!(!said(&read_with(&file.0, &turned).unwrap()));
}

/// A turn that matters makes a surface anisotropic, and its axis is found; noise, gloss and the two sides of a plane do not.
#[test]
fn only_a_real_turn_makes_a_surface_anisotropic() {
    let mut random = 1u64;
    let mut noise = || {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        // Nearly normal, of deviation 0.3.
        0.3 * ((random >> 33) as f64 / f64::from(1u32 << 31) - 0.5) * 3.46
    };
    let mut both = Vec::new();
    for s in grid() {
        let f = s.f * (1.0 + noise());
        both.push(Sample { f, ..s });
        both.push(Sample { f: s.f * (1.0 + noise()), phi_o: -s.phi_o, ..s });
    }
    assert!(!is_off(&quick_look(&read_text("noise.csv", &text(&both))), Topic::Isotropy));

    let turned = |name: &str| -> String {
        let brdf = model(name);
        let mut samples = Vec::new();
        for turn in [0.0, 35.0, 70.0, 120.0] {
            for theta_i in [10.0, 30.0, 50.0, 70.0] {
                for theta_o in [5.0, 20.0, 35.0, 50.0, 65.0] {
                    for phi in (0..12).map(|n| 30.0 * f64::from(n)) {
                        let (phi_i, phi_o) = (turn, turn + phi);
                        let f = brdf.evaluate(direction(theta_i, phi_i), direction(theta_o, phi_o))[1];
                        samples.push(Sample { theta_i, phi_i, theta_o, phi_o, f });
                    }
                }
            }
        }
        text(&samples)
    };
    let ward = "model:ward:diffuse=0.1,specular=0.3,alpha_x=0.1,alpha_y=0.4";
    let source = read_text("aniso.csv", &turned(ward));
    let turn = source.completion.as_ref().unwrap().turn.unwrap();
    println!("{turn:?}");
    assert!((turn.axis.to_degrees() - 90.0).abs() < 2.0 && (turn.along - 2.0).abs() < 0.1, "{turn:?}");
    let look = Look::new(source.intake.as_ref().unwrap(), source.completion.as_ref());
    assert!(!is_off(&look, Topic::Isotropy));
    assert!(look.findings.iter().any(|f| f.text.contains("times as wide along an axis at 90 degrees")));
    let Content::Evaluable(completed) = &source.content else { panic!("a completion") };
    let truth = model(ward);
    let (mut off, mut all) = (0.0, 0.0);
    for n in 0..500 {
        let n = f64::from(n);
        let pair = [70.0 * (0.618 * n).fract(), 70.0 * (0.37 * n).fract()];
        let (wi, wo) = (direction(pair[0], 360.0 * (0.755 * n).fract()), direction(pair[1], 77.0 * n));
        let [found, right] = [completed.as_ref(), truth.as_ref()].map(|brdf| brdf.evaluate(wi, wo)[1]);
        off += (found - right) * (found - right);
        all += right * right;
    }
    println!("{}", (off / all).sqrt());
    assert!((off / all).sqrt() < 0.1, "{}", (off / all).sqrt());
    // A sample that is tilted on its table by two degrees, with noise, is none.
    let (brdf, mut tilted) = (model("model:ggx:alpha=0.15,f0=0.9,diffuse=0.1"), Vec::new());
    let tilt = |[x, y, z]: [f64; 3]| {
        let (sin, cos) = 2f64.to_radians().sin_cos();
        [x * cos + z * sin, y, z * cos - x * sin]
    };
    for turn in (0..12).map(|n| 30.0 * f64::from(n)) {
        for (theta_i, theta_o, phi) in (0..60)
            .map(|n| (15.0 * f64::from(1 + n % 4), 12.0 * f64::from(1 + n / 4 % 5), 72.0 * f64::from(n / 20)))
        {
            let (phi_i, phi_o) = (turn, turn + 180.0 - phi);
            let [wi, wo] = [direction(theta_i, phi_i), direction(theta_o, phi_o)].map(tilt);
            let f = brdf.evaluate(wi, wo)[1] * (1.0 + 0.3 * noise());
            tilted.push(Sample { theta_i, phi_i, theta_o, phi_o, f });
        }
    }
    let source = read_text("tilted.csv", &text(&tilted));
    println!("{:?}", source.intake.as_ref().unwrap().isotropy);
    assert!(source.completion.is_none());
    let same = read_text("turned.csv", &turned("model:ggx:alpha=0.1,f0=0.9"));
    assert!(!is_off(&quick_look(&same), Topic::Isotropy));
}

/// Values in other units are reported with likely units, and a cosine by the swapped pairs.
#[test]
fn units_and_cosines_are_told_by_what_they_do() {
    let of = |name: &str, factor: f64| look(&read_text(name, &changed(|s| s.f *= factor)));
    let candidate = |look: &Look, name: &str| {
        look.units.as_ref().and_then(|units| units.candidates.iter().find(|c| c.0 == name).map(|c| c.1))
    };
    let right = of("right.csv", 1.0);
    assert!(!is_off(&right, Topic::Units) && right.outliers.is_empty(), "{:?}", right.findings);
    let albedo = right.units.as_ref().unwrap().albedo;
    for (name, factor, divide) in
        [("percent.csv", 100.0 * std::f64::consts::PI, "100pi"), ("milli.csv", 1e-3, "0.001")]
    {
        let look = of(name, factor);
        let found = candidate(&look, divide).unwrap_or_else(|| panic!("{name}: {:?}", look.units));
        assert!(
            is_off(&look, Topic::Units) && (found / albedo - 1.0).abs() < 0.05,
            "{name}: {found} {albedo}"
        );
    }
    let cosine = read_text("cos.csv", &changed(|s| s.f *= s.theta_o.to_radians().cos()));
    let found = quick_look(&cosine);
    assert_eq!(found.reciprocity.unwrap().cosine, Some(Values::CosineOutgoing), "{:?}", found.reciprocity);
    assert!(is_off(&found, Topic::Reciprocity));
}

/// One view in a plane says nothing of units.
#[test]
fn one_view_in_a_plane_is_told_nothing_of_units() {
    let brdf = model("model:ggx:alpha=0.08,f0=0.9");
    let sample = |n: u32| {
        let theta_i = f64::from(n);
        let f = brdf.evaluate(direction(theta_i, 180.0), direction(30.0, 0.0))[1];
        Sample { theta_i, phi_i: 180.0, theta_o: 30.0, phi_o: 0.0, f }
    };
    let look = look(&read_text("one.csv", &text(&(0..89).map(sample).collect::<Vec<_>>())));
    let off: Vec<&str> = look.findings.iter().filter(|f| f.is_off).map(|f| f.text.as_str()).collect();
    assert!(!is_off(&look, Topic::Units) && !is_off(&look, Topic::Isotropy), "{off:?}");
}

/// A sample that is 50 times too bright is named by its line.
#[test]
fn an_outlier_is_named_by_its_line() {
    let mut samples = grid();
    let at = samples.iter().position(|s| s.theta_i == 40.0 && s.theta_o == 30.0 && s.phi_o == 20.0).unwrap();
    samples[at].f *= 50.0;
    let look = look(&read_text("outlier.csv", &text(&samples)));
    let lines: Vec<usize> = look.outliers.iter().map(|o| o.row.line).collect();
    assert_eq!(lines, [at + 2], "{:?}", look.findings);
    assert!((look.outliers[0].ratio / 50.0 - 1.0).abs() < 0.3, "{:?}", look.outliers);
}

fn data(file: &str) -> PathBuf {
    let folder = std::env::var_os("SRBF_DATA_DIR").expect("SRBF_DATA_DIR names the data folder");
    PathBuf::from(folder).join(file)
}

/// Real files in the layouts of instruments and optics programs are read as they stand.
#[test]
#[ignore = "needs SRBF_DATA_DIR"]
fn files_of_other_programs_are_read_as_they_stand() {
    for (file, format, rows, left_out) in [
        ("field/planesymmetric_zemax.bsdf", "Zemax BSDF", 2200..2400, 50..200),
        ("field/planesymmetric_speos.anisotropicbsdf", "SPEOS .anisotropicbsdf", 5500..6500, 2000..3000),
        ("field/in_plane_spectra.csv", "table of text", 300..329, 20..30),
        ("field/retro_3m_yellow.dat", "ALTA", 7200..7312, 1..100),
        ("field/lidar_905nm.xompt", "ASAM OpenMATERIAL", 700..725, 180..190),
    ] {
        let source = read(&data(file)).unwrap_or_else(|error| panic!("{file}: {}", with_reasons(&error)));
        let intake = source.intake.as_ref().unwrap();
        println!("{file}: {} rows; {}", intake.rows.len(), intake.left_out_text());
        println!("  {:?}", intake.notes);
        assert_eq!(intake.format, format);
        assert!(rows.contains(&intake.rows.len()), "{file}: {}", intake.rows.len());
        assert!(left_out.contains(&intake.left_out_count()), "{file}: {}", intake.left_out_text());
    }
}

/// Two files of other programs hold the same measurement: their values agree, direction by direction, but for a factor of 1.09 to 1.16:
/// each states a total of its own, and SPEOS's scales its values.
#[test]
#[ignore = "needs SRBF_DATA_DIR"]
fn files_of_the_same_measurement_agree() {
    let completion = |file: &str| {
        let Content::Samples(table) = read(&data(file)).unwrap().content else { panic!("{file}: samples") };
        complete(&table).unwrap()
    };
    let zemax = completion("field/planesymmetric_zemax.bsdf");
    let speos = completion("field/planesymmetric_speos.anisotropicbsdf");
    for theta_o in [15.0, 35.0, 55.0] {
        let mut ratios = Vec::new();
        for theta_i in (5..=65).step_by(10) {
            for phi in (0..=180).step_by(30) {
                let [i, o] = [direction(f64::from(theta_i), f64::from(phi)), direction(theta_o, 0.0)];
                ratios.push(speos.evaluate(i, o)[1] / zemax.evaluate(i, o)[1]);
            }
        }
        ratios.sort_by(f64::total_cmp);
        let [low, middle, high] =
            [0.1, 0.5, 0.9].map(|share| ratios[(share * (ratios.len() - 1) as f64) as usize]);
        println!("at {theta_o} degrees SPEOS over Zemax: {low:.3} to {high:.3}, median {middle:.3}");
        assert!((middle - 1.12).abs() < 0.06 && high / low < 1.15, "{theta_o}: {low}, {middle}, {high}");
    }
}

/// The albedo of the Zemax file is that of the instrument itself. Its total takes cells near the horizon, which it did not measure, as 0;
/// towards grazing they are a tenth of the light.
#[test]
#[ignore = "needs SRBF_DATA_DIR"]
fn the_albedo_of_a_zemax_file_is_what_it_states() {
    let source = read(&data("field/planesymmetric_zemax.bsdf")).unwrap();
    let intake = source.intake.as_ref().unwrap();
    let Content::Samples(table) = &source.content else { panic!("samples") };
    let completion = complete(table).unwrap();
    for degrees in [15.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 75.0] {
        let stated = intake.stated.iter().find(|s| s.0 == degrees).unwrap().1;
        let table = srbf_measured::table::Table::from_brdf(
            &completion,
            &[f64::to_radians(degrees)],
            srbf_measured::table::Density { hemisphere: 2000, cap: 300 },
        )
        .unwrap();
        let ours = table.views[0].uncut_albedo[1];
        println!("{degrees} degrees: {ours:.4}, stated {stated:.4}");
        let most = if degrees > 65.0 { 0.1 } else { 0.07 };
        assert!((ours / stated - 1.0).abs() < most, "{degrees}: {ours}, {stated}");
    }
}

/// Views of the retro-reflective sheet are found again from the others.
#[test]
#[ignore = "needs SRBF_DATA_DIR"]
fn views_of_a_retro_reflector_are_found_from_the_others() {
    let source = read(&data("field/retro_3m_yellow.dat")).unwrap();
    let Content::Samples(table) = &source.content else { panic!("samples") };
    let completion = complete(table).unwrap();
    println!("{:?} {:?}", completion.report.samples_left_out, completion.report.views_left_out);
    assert!(completion.report.samples_left_out.error < 0.25);
    assert!(completion.report.views_left_out.as_ref().is_some_and(|views| views.error < 0.25));
}
