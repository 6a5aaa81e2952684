//! Files as laboratories, instruments and programs write them, in layouts that no list of ours names: each is read with its own values, or
//! refused with words that say why. All hold one surface, so that every sample that is read is held against it.
//!
//! `SRBF_LAYOUTS=FOLDER` keeps the files.

mod first;
mod later;
#[path = "../words/mod.rs"]
mod words;

use srbf_measured::complete::complete;
use srbf_measured::look::Look;
use srbf_measured::read::{Content, read};
use srbf_measured::with_reasons;
use std::f64::consts::PI;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use words::{lacking, said};

/// The right reading of a file.
enum Right {
    /// Samples, rows left out, the factor that values have over the BRDF, and words that are said.
    Read(usize, usize, f64, &'static [&'static str]),
    /// Refused with these words.
    Refused(&'static [&'static str]),
}

use Right::{Read, Refused};

/// A dull plastic: GGX of roughness 0.35, reflectance 0.05, over a diffuse share.
fn plastic(wi: [f64; 3], wo: [f64; 3], diffuse: f64) -> f64 {
    let sum = [0, 1, 2].map(|k| wi[k] + wo[k]);
    let length = sum.iter().map(|x| x * x).sum::<f64>().sqrt();
    let h = sum.map(|x| x / length);
    let between = (0..3).map(|k| wi[k] * h[k]).sum::<f64>();
    let a2: f64 = 0.35 * 0.35;
    let d = a2 / (PI * (h[2] * h[2] * (a2 - 1.0) + 1.0).powi(2));
    let g = |c: f64| 2.0 * c / (c + (a2 + (1.0 - a2) * c * c).sqrt());
    let fresnel = 0.05 + 0.95 * (1.0 - between).powi(5);
    diffuse / PI + d * g(wi[2]) * g(wo[2]) * fresnel / (4.0 * wi[2] * wo[2])
}

/// Diffuse shares of red, green and blue; grey files have that of green.
const DIFFUSE: [f64; 3] = [0.4, 0.3, 0.1];

fn direction(theta: f64, phi: f64) -> [f64; 3] {
    let ((st, ct), (sp, cp)) = (theta.to_radians().sin_cos(), phi.to_radians().sin_cos());
    [st * cp, st * sp, ct]
}

/// A sample: theta_i, theta_o and the azimuth of one from the other, degrees; 180 is the mirror side.
#[derive(Clone, Copy)]
struct At(f64, f64, f64);

impl At {
    fn rgb(self) -> [f64; 3] {
        DIFFUSE.map(|d| plastic(direction(self.0, 0.0), direction(self.1, self.2), d))
    }
    fn f(self) -> f64 {
        self.rgb()[1]
    }
    /// The angle between both directions, degrees.
    fn phase(self) -> f64 {
        let (i, o) = (direction(self.0, 0.0), direction(self.1, self.2));
        (0..3).map(|k| i[k] * o[k]).sum::<f64>().clamp(-1.0, 1.0).acos().to_degrees()
    }
}

/// 75 samples on one side of the plane of incidence.
fn grid() -> Vec<At> {
    let mut all = Vec::new();
    for i in [10.0, 30.0, 50.0] {
        for o in [5.0, 15.0, 30.0, 45.0, 60.0] {
            all.extend([0.0, 45.0, 90.0, 135.0, 180.0].map(|phi| At(i, o, phi)));
        }
    }
    all
}

/// Incident angle, signed outgoing angle (mirror side above 0) and value of 93 samples in the plane of incidence.
fn plane() -> Vec<(f64, f64, f64)> {
    let mut all = Vec::new();
    for i in [10.0, 30.0, 50.0] {
        for n in -15_i32..=15 {
            let signed = 5.0 * f64::from(n);
            all.push((i, signed, At(i, signed.abs(), if n < 0 { 0.0 } else { 180.0 }).f()));
        }
    }
    all
}

/// A line of each sample below a head.
fn lines(head: &str, line: impl Fn(usize, At) -> String) -> Vec<u8> {
    let mut text = head.to_owned();
    for (n, at) in grid().into_iter().enumerate() {
        text += &line(n, at);
        text.push('\n');
    }
    text.into_bytes()
}

fn comma(value: f64) -> String {
    format!("{value:.6}").replace('.', ",")
}

/// A line of each sample in the plane of incidence.
fn in_plane(head: &str, line: impl Fn(f64, f64, f64) -> String) -> Vec<u8> {
    let all = plane().into_iter().map(|(i, o, f)| line(i, o, f) + "\n");
    (head.to_owned() + &all.collect::<String>()).into_bytes()
}

/// The faults of one file.
fn faults(path: &Path, right: &Right) -> Vec<String> {
    let mut faults = Vec::new();
    match (read(path), right) {
        (Err(error), Refused(words)) => {
            let text = with_reasons(&error);
            println!("  refused: {text}");
            faults.extend(lacking(words, &text));
        }
        (Err(error), Read(..)) => faults.push(format!("refused: {}", with_reasons(&error))),
        (Ok(source), right) => {
            let (Content::Samples(table), Some(intake)) = (&source.content, &source.intake) else {
                return vec!["no samples".into()];
            };
            let completion = match complete(table) {
                Ok(completion) => completion,
                Err(error) => return vec![format!("not completed: {}", with_reasons(&error))],
            };
            let look = Look::new(intake, Some(&completion.report));
            let text = said(&look);
            println!("  {} rows, {}\n  {text}", intake.rows.len(), intake.left_out_text());
            let (rows, left_out, factor, words) = match right {
                Read(rows, left_out, factor, words) => (*rows, *left_out, *factor, *words),
                Refused(_) => (intake.rows.len(), intake.left_out_count(), 1.0, &[][..]),
            };
            if (intake.rows.len(), intake.left_out_count()) != (rows, left_out) {
                faults.push(format!("{} rows, {}", intake.rows.len(), intake.left_out_text()));
            }
            faults.extend(lacking(words, &text));
            let right = |wi, wo| plastic(wi, wo, DIFFUSE[1]) * factor;
            let mut wrong = intake.rows.clone();
            wrong.retain(|row| (row.rgb[1] / right(row.wi, row.wo) - 1.0).abs() > 0.01);
            if let Some(row) = wrong.first() {
                let f = right(row.wi, row.wo);
                faults.push(format!(
                    "{} values are wrong: line {:?}, {} for {f}",
                    wrong.len(),
                    row.line,
                    row.rgb[1]
                ));
            }
        }
    }
    faults
}

/// Every file is read with its own values, or refused with words that say why.
#[test]
fn layouts_in_no_list_are_read_or_refused_rightly() {
    let kept = std::env::var_os("SRBF_LAYOUTS").map(PathBuf::from);
    let folder = kept.unwrap_or_else(|| Path::new(env!("CARGO_TARGET_TMPDIR")).join("layouts"));
    std::fs::create_dir_all(&folder).unwrap();
    let mut all = Vec::new();
    for (name, bytes, right) in first::files().into_iter().chain(later::files()) {
        let path = folder.join(name);
        std::fs::write(&path, bytes).unwrap();
        println!("{name}");
        all.extend(faults(&path, &right).into_iter().map(|fault| format!("{name}: {fault}")));
    }
    assert!(all.is_empty(), "{}", all.join("\n"));
}
