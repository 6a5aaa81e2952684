//! Inputs that people sent or that were made from the layouts of public files, each with its right values: the folders `field-cases` and
//! `field-cases/more` beside the data folder, which no repository holds.

mod words;

use srbf_measured::complete::{Completion, complete};
use srbf_measured::look::Look;
use srbf_measured::read::{Content, Conventions, Intake, Mirror, Source, Values, read, read_with};
use srbf_measured::table::Brdf;
use srbf_measured::with_reasons;
use std::path::{Path, PathBuf};
use words::lacking;

fn folder() -> PathBuf {
    let data = PathBuf::from(std::env::var_os("SRBF_DATA_DIR").expect("SRBF_DATA_DIR names the data folder"));
    let places = [data.join("field-cases"), data.join("..").join("field-cases")];
    places.into_iter().find(|place| place.is_dir()).expect("field-cases is in the data folder, or beside it")
}

/// Cosine of half a degree, within which a sample is at a place.
const AT: f64 = 0.999_96;

/// The mean of the samples at a pair of directions, whatever frame they are in: theta_i, theta_o, and the difference of azimuths.
fn value(intake: &Intake, theta_i: f64, theta_o: f64, turn: f64) -> Option<[f64; 3]> {
    let [i, o, turn] = [theta_i, theta_o, turn].map(f64::to_radians);
    let between = i.sin() * o.sin() * turn.cos() + i.cos() * o.cos();
    let mut found = Vec::new();
    for row in &intake.rows {
        let dot: f64 = (0..3).map(|k| row.wi[k] * row.wo[k]).sum();
        if (row.wi[2] - i.cos()).abs() < 1.0 - AT + 1e-3
            && (row.wo[2] - o.cos()).abs() < 2e-3
            && (dot - between).abs() < 2e-3
        {
            found.push(row.rgb);
        }
    }
    let mean = |c: usize| found.iter().map(|rgb: &[f64; 3]| rgb[c]).sum::<f64>() / found.len() as f64;
    (!found.is_empty()).then(|| [0, 1, 2].map(mean))
}

fn direction(theta: f64, phi: f64) -> [f64; 3] {
    let ((st, ct), (sp, cp)) = (theta.to_radians().sin_cos(), phi.to_radians().sin_cos());
    [st * cp, st * sp, ct]
}

/// The right reading of one input.
enum Right {
    /// Samples, rows left out, values in green (theta_i, theta_o, turn; f), words that notes have, and words that they have not.
    Read(usize, usize, &'static [[f64; 4]], &'static [&'static str], &'static [&'static str]),
    /// Refused with these words.
    Refused(&'static [&'static str]),
}

use Right::{Read, Refused};

/// The dull plastic of most inputs.
const PLASTIC: [f64; 4] = [40.0, 30.0, 20.0, 0.0998];
const OTHER: [f64; 4] = [25.0, 40.0, 100.0, 0.1060];

const MORE: &[(&str, Right)] = &[
    (
        "speos_both.brdf",
        Read(291, 426, &[], &["states a reflectance of 0.350 at 50 degrees; ours is 0.35"], &["check"]),
    ),
    ("mueller.csv", Read(75, 0, &[], &["m12", "fr11"], &["11000"])),
    ("speos_0_360.anisotropicbsdf", Read(291, 0, &[], &[], &[])),
    ("null_value.xompt", Read(71, 4, &[], &["905"], &[])),
    ("clipped.csv", Read(680, 0, &[], &["103 times", "saturated", "--saturated"], &[])),
    ("propagation.csv", Refused(&["along the light", "--incident along-light", "75"])),
    (
        "rpv.csv",
        Read(
            0,
            0,
            &[[38.0, 38.0, 180.0, 0.0457], [35.0, 35.0, 0.0, 0.0936]],
            &[],
            &["no sample is within the highlight"],
        ),
    ),
    (
        "backscatter_alone.csv",
        Read(18, 0, &[], &["where the light comes from", "guess"], &["mirror directions at equal azimuths"]),
    ),
    ("log10.csv", Refused(&["logarithm"])),
    ("fred.txt", Read(0, 0, &[[50.0, 50.0, 180.0, 0.176]], &["phi 0"], &[])),
    ("src_z.txt", Read(75, 0, &[], &["--divide pi"], &[])),
    ("lambda_equals.csv", Read(75, 0, &[], &[], &["one wavelength"])),
    ("pivot.csv", Read(165, 0, &[], &["matrix"], &[])),
    ("transposed.csv", Read(0, 0, &[[10.0, 20.0, 180.0, 0.126906]], &["a sample a column"], &[])),
    ("cr.csv", Read(75, 0, &[], &[], &[])),
    ("records.json", Read(75, 0, &[], &[], &[])),
    ("rows.npy", Read(75, 0, &[], &["no names"], &[])),
    ("half_difference.csv", Read(75, 0, &[], &[], &["turned"])),
    ("speos_binary.anisotropicbsdf", Refused(&["SPEOS", "mode 1", "as text"])),
    ("window.xml", Refused(&["window", "WINDOW"])),
    (
        "alta_false_cosine.dat",
        Read(
            450,
            0,
            &[PLASTIC, OTHER],
            &["--values brdf", "agree without dividing"],
            &["multiplied by the cosine of the incident"],
        ),
    ),
];

const FIRST: &[(&str, Right)] = &[
    ("x_noise30.csv", Read(0, 0, &[], &[], &[])),
    ("x_aniso.csv", Read(1152, 0, &[], &["anisotropic", "at 90 degrees"], &[])),
    ("p_1dsharp.csv", Read(0, 0, &[], &[], &["--divide"])),
    ("u_percent.csv", Read(450, 0, &[], &["--divide 100pi"], &[])),
    ("u_milli.csv", Read(450, 0, &[], &["--divide 0.001"], &[])),
    ("d_outlier.csv", Read(450, 0, &[], &["theta_i, phi_i 40.0"], &[])),
    ("m_m1.csv", Read(437, 13, &[], &[], &[])),
    ("m_nan.csv", Read(0, 0, &[], &["without a number"], &[])),
    ("m_empty.csv", Read(0, 0, &[], &["without a number"], &[])),
    ("q_retro.csv", Read(0, 0, &[], &[], &["no sample is within"])),
    ("a_rad.csv", Refused(&["radians?"])),
    ("a_mirror0.csv", Read(450, 0, &[], &["--mirror equal"], &[])),
    ("u_cos.csv", Read(450, 0, &[], &["values are multiplied by the cosine"], &[])),
    ("n_theta_r.csv", Read(24, 0, &[], &[], &[])),
    ("n_camel.csv", Read(24, 0, &[], &[], &[])),
    ("n_units.csv", Read(24, 0, &[], &[], &[])),
    ("n_quoted.csv", Read(24, 0, &[], &[], &[])),
    ("l_german.csv", Read(24, 0, &[], &[], &[])),
    ("l_tab.csv", Read(24, 0, &[], &[], &[])),
    ("l_sep.csv", Read(23, 0, &[], &[], &[])),
    ("l_trail.csv", Read(24, 0, &[], &[], &[])),
    ("s_laser_nm.csv", Read(24, 0, &[], &["one wavelength"], &[])),
    ("s_rev.csv", Read(24, 0, &[], &[], &[])),
    ("s_sigma.csv", Read(24, 0, &[], &["sigma"], &[])),
    ("s_xyz.csv", Read(24, 0, &[], &[], &[])),
    // Azimuths of a viewer along the normal, who sees all of them alike.
    ("s_long.csv", Refused(&["8 samples at 1 pair of directions"])),
    ("as_xyz.astm", Read(20, 0, &[], &[], &[])),
    ("as_550.astm", Read(20, 0, &[], &[], &[])),
    ("as_thetar.astm", Read(20, 0, &[], &[], &[])),
    ("a_trans.csv", Read(0, 0, &[], &["transmission"], &[])),
    ("a_o90.csv", Read(0, 0, &[], &["horizon"], &[])),
    ("a_i90.csv", Read(0, 0, &[], &["horizon"], &[])),
];

/// The completion of samples; `None` where they were completed as they were read.
fn completed(source: &Source) -> Result<Option<Completion>, String> {
    let Content::Samples(table) = &source.content else { return Ok(None) };
    complete(table).map(Some).map_err(|error| with_reasons(&error))
}

/// Everything that is said about a source.
fn said(source: &Source, completion: Option<&Completion>) -> String {
    let report = completion.map(|completion| &completion.report).or(source.completion.as_ref());
    let look = Look::new(source.intake.as_ref().unwrap(), report);
    words::said(&look)
}

/// The faults of one input.
fn faults(path: &Path, right: &Right) -> Vec<String> {
    let mut faults = Vec::new();
    let found = read(path).map_err(|error| with_reasons(&error));
    match (found.and_then(|source| Ok((completed(&source)?, source))), right) {
        (Err(text), Refused(words)) => {
            println!("  refused: {text}");
            faults.extend(lacking(words, &text));
        }
        (Err(text), Read(..)) => faults.push(format!("refused: {text}")),
        (Ok(_), Refused(_)) => faults.push("is read".into()),
        (Ok((completion, source)), Read(rows, left_out, values, has, has_not)) => {
            let intake = source.intake.as_ref().unwrap();
            let text = said(&source, completion.as_ref());
            println!("  {} rows, {} left out\n{text}", intake.rows.len(), intake.left_out_count());
            if *rows > 0 && (intake.rows.len(), intake.left_out_count()) != (*rows, *left_out) {
                faults.push(format!("{} rows, {}", intake.rows.len(), intake.left_out_text()));
            }
            for [i, o, turn, f] in *values {
                let measured = value(intake, *i, *o, *turn);
                let (found, most) = match measured {
                    Some(rgb) => (rgb[1], 0.01),
                    None => {
                        let completion = completion.as_ref().unwrap();
                        (completion.evaluate(direction(*i, 0.0), direction(*o, *turn))[1], 0.05)
                    }
                };
                let apart = (found / f - 1.0).abs();
                if apart.is_nan() || apart > most {
                    faults.push(format!("f {found} at ({i}, {o}; {turn}), not {f}"));
                }
            }
            faults.extend(lacking(has, &text));
            faults.extend(
                has_not.iter().filter(|word| text.contains(**word)).map(|word| format!("`{word}` is said")),
            );
        }
    }
    faults
}

/// Every kept input is read, refused and spoken of as it should be.
#[test]
#[ignore = "needs SRBF_DATA_DIR"]
fn kept_inputs_are_read_and_spoken_of_as_they_should_be() {
    let mut all = Vec::new();
    for (folder, cases) in [(folder(), FIRST), (folder().join("more"), MORE)] {
        for (name, right) in cases {
            println!("{name}");
            all.extend(faults(&folder.join(name), right).into_iter().map(|fault| format!("{name}: {fault}")));
        }
    }
    assert!(all.is_empty(), "{}", all.join("\n"));
}

/// An option changes notes as well as values.
#[test]
#[ignore = "needs SRBF_DATA_DIR"]
fn notes_follow_the_option_that_was_given() {
    let more = folder().join("more");
    let with = |name: &str, conventions: Conventions| read_with(&more.join(name), &conventions).unwrap();
    let plain = Conventions { values: Some(Values::Brdf), ..Conventions::default() };
    let source = with("alta_false_cosine.dat", plain);
    let text = said(&source, completed(&source).unwrap().as_ref());
    assert!(!text.contains("divided"), "{text}");
    let f = value(source.intake.as_ref().unwrap(), 40.0, 30.0, 20.0).unwrap()[1];
    assert!((f / 0.0998 - 1.0).abs() < 0.01, "{f}");
    let mirror = Conventions { mirror: Some(Mirror::Opposite), ..Conventions::default() };
    let turned = with("transposed.csv", mirror);
    assert!(
        (value(turned.intake.as_ref().unwrap(), 10.0, 20.0, 0.0).unwrap()[1] / 0.126906 - 1.0).abs() < 0.01
    );
}
