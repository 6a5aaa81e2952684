//! `cargo lab turns`.

use anyhow::{Context, ensure};
use srbf_core::{Material, Mixture, Vec3, luminance};
use srbf_fit::complete::Model;
use srbf_fit::read::{Content, Conventions, Source, csv, read};
use srbf_fit::table::{Brdf, Symmetry, Table, direction, evaluation_views};
use srbf_fit::{Settings, fit, fit_source};
use srbf_reference_renderer::numbers::random::Random;
use srbf_reference_renderer::out::output;
use srbf_tests::partition::Partition;
use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::path::PathBuf;

/// Fits generated surfaces that a turn changes, sampled as instruments do, and says how far fits are from the truth.
///
/// Each has 12 turns of 6 incidences by 100 directions, with noise. Errors are relative L2 of f cos, in per cent: at the samples' own
/// directions, and at angles and turns between them, over the hemisphere. Beside our fit stand its completion, the isotropic fit of the
/// same samples, and one anisotropic microfacet lobe with a diffuse term. Draws are compared with their density at 24 outgoing
/// directions (chi-square, the least p, which chance alone brings below 0.0021 once in twenty runs); of the same draws come the largest
/// weight, and the distance of the reflected energy from that of the truth.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Only those whose names contain this
    #[arg(long, value_name = "NAME", default_value = "")]
    only: String,
    /// Deviation of the noise, per cent of each value
    #[arg(long, default_value_t = 2.0)]
    noise: f64,
    /// The CSV to write; else none is written
    #[arg(long, value_name = "OUT.csv")]
    output: Option<PathBuf>,
}

/// The instrument.
const TURNS: usize = 12;
const INCIDENCES: [f64; 6] = [5.0, 20.0, 35.0, 50.0, 62.0, 74.0];
const DIRECTIONS: usize = 100;

/// Angles and turns between those of the instrument.
const BETWEEN: [f64; 4] = [12.0, 28.0, 43.0, 56.0];
const TURNS_BETWEEN: usize = 8;

/// Outgoing directions at which draws are compared with their density: degrees, each at `TURNS_DRAWN` turns.
const DRAWN: [f64; 6] = [7.0, 20.0, 33.0, 46.0, 59.0, 72.0];
const TURNS_DRAWN: usize = 4;
const DRAWS: usize = 400_000;

/// A surface of several parts: models, each turned by an angle.
struct Sum {
    parts: Vec<(Box<dyn Brdf + Send>, f64)>,
    /// Height and width, radians, of a lobe about the back direction.
    retro: Option<[f64; 2]>,
}

impl Sum {
    fn new(parts: &[(&str, f64)], retro: Option<[f64; 2]>) -> anyhow::Result<Self> {
        let part = |(text, degrees): &(&str, f64)| {
            let Content::Evaluable(brdf) = read(format!("model:{text}").as_ref())?.content else {
                anyhow::bail!("{text}: no model")
            };
            Ok((brdf, degrees.to_radians()))
        };
        Ok(Self { parts: parts.iter().map(part).collect::<anyhow::Result<_>>()?, retro })
    }
}

fn turned([x, y, z]: [f64; 3], angle: f64) -> [f64; 3] {
    let (sin, cos) = angle.sin_cos();
    [x * cos + y * sin, y * cos - x * sin, z]
}

impl Brdf for Sum {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (brdf, angle) in &self.parts {
            let value = brdf.evaluate(turned(wi, *angle), turned(wo, *angle));
            (0..3).for_each(|c| sum[c] += value[c]);
        }
        if let Some([height, width]) = self.retro {
            let apart: f64 = (0..3).map(|k| (wi[k] - wo[k]).powi(2)).sum();
            sum.iter_mut().for_each(|v| *v += height * (-apart / (width * width)).exp());
        }
        sum
    }

    fn symmetry(&self) -> Symmetry {
        Symmetry::HalfTurn
    }
}

fn truths() -> anyhow::Result<Vec<(&'static str, Sum)>> {
    Ok(vec![
        ("Ward .1 x .4", Sum::new(&[("ward:diffuse=0.1,specular=0.3,alpha_x=0.1,alpha_y=0.4", 25.0)], None)?),
        (
            "GGX .08 x .3 with a coat",
            Sum::new(
                &[("ggx:alpha_x=0.08,alpha_y=0.3,f0=0.5/0.35/0.2", 25.0), ("ggx:alpha=0.06,ior=1.5", 0.0)],
                None,
            )?,
        ),
        (
            "weave of two threads",
            Sum::new(
                &[
                    ("ward:diffuse=0.1/0.05/0.03,specular=0.15,alpha_x=0.12,alpha_y=0.45", 10.0),
                    ("ward:diffuse=0.03/0.05/0.1,specular=0.1,alpha_x=0.12,alpha_y=0.45", 100.0),
                ],
                None,
            )?,
        ),
        (
            "brushed metal with a retro part",
            Sum::new(&[("ggx:alpha_x=0.1,alpha_y=0.35,f0=0.7/0.6/0.5", 25.0)], Some([0.6, 0.15]))?,
        ),
    ])
}

/// The samples of the instrument, as a table of text.
fn samples(truth: &dyn Brdf, noise: f64) -> String {
    let mut random = Random::new(1, 0, 0);
    let mut text = "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,r,g,b\n".to_owned();
    for turn in 0..TURNS {
        for degrees in INCIDENCES {
            let phi = TAU * turn as f64 / TURNS as f64;
            let wi = direction(degrees.to_radians(), phi);
            let mirror = direction(degrees.to_radians(), phi + PI);
            let all = evaluation_views::spread(DIRECTIONS / 2)
                .chain(evaluation_views::about(mirror, DIRECTIONS / 2));
            for wo in all.filter(|wo| wo[2] > 0.05) {
                // Twelve uniform numbers are nearly normal.
                let normal = (0..12).map(|_| f64::from(random.unit())).sum::<f64>() - 6.0;
                let [r, g, b] = truth.evaluate(wi, wo).map(|v| v * (1.0 + 0.01 * noise * normal));
                let _ =
                    writeln!(text, "{},{},{},{},{},{},{r},{g},{b}", wi[0], wi[1], wi[2], wo[0], wo[1], wo[2]);
            }
        }
    }
    text
}

/// f of a material.
struct Lobes<'a>(&'a Material<&'a [u8]>);

/// Values of f for an outgoing direction and incident ones.
type Values<'a> = dyn Fn([f64; 3], &[[f64; 3]]) -> Vec<[f64; 3]> + 'a;

/// Relative L2 distance of `f cos` from the truth: the mean over outgoing directions.
fn error(truth: &dyn Brdf, views: &[(f64, f64)], values: &Values<'_>) -> f64 {
    let mut sum = 0.0;
    for &(theta, phi) in views {
        let (wo, mirror) = (direction(theta, phi), direction(theta, phi + PI));
        let all: Vec<([f64; 3], f64)> = evaluation_views::weighed(mirror).collect();
        let incident: Vec<[f64; 3]> = all.iter().map(|d| d.0).collect();
        let (mut apart, mut whole) = (0.0, 0.0);
        for ((wi, weight), found) in all.iter().zip(values(wo, &incident)) {
            for (a, b) in truth.evaluate(*wi, wo).iter().zip(found) {
                apart += weight * wi[2] * wi[2] * (a - b).powi(2);
                whole += weight * wi[2] * wi[2] * a * a;
            }
        }
        sum += (apart / whole).sqrt();
    }
    100.0 * sum / views.len() as f64
}

impl Lobes<'_> {
    fn values(&self, wo: [f64; 3], incident: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let narrow = |d: [f64; 3]| Vec3::from(d.map(|v| v as f32));
        let mut mixture = Mixture::<64>::empty();
        if self.0.prepare(narrow(wo), &mut mixture).is_err() {
            return vec![[f64::NAN; 3]; incident.len()];
        }
        let value = |wi: &[f64; 3]| mixture.evaluate(narrow(*wi)).to_array().map(|v| f64::from(v) / wi[2]);
        incident.iter().map(value).collect()
    }
}

/// The draws of a material.
struct Drawn {
    /// The least p of the comparisons with the density.
    p: f64,
    /// Largest channel of a weight.
    weight: f32,
    /// Largest distance of the reflected luminance from that of the truth, as a share of it.
    energy: f64,
}

/// Draws from a material, and compares with its density and with the truth.
fn drawn(truth: &dyn Brdf, material: &Material<&[u8]>) -> anyhow::Result<Drawn> {
    let mut random = Random::new(3, 0, 0);
    let mut all = Drawn { p: 1.0, weight: 0.0, energy: 0.0 };
    let views = DRAWN.iter().flat_map(|theta| {
        (0..TURNS_DRAWN).map(move |n| (theta.to_radians(), TAU * (n as f64 + 0.3) / TURNS_DRAWN as f64))
    });
    for (theta, phi) in views {
        let (wo, mirror) = (direction(theta, phi), direction(theta, phi + PI));
        let mut mixture = Mixture::<64>::empty();
        material.prepare(Vec3::from(wo.map(|v| v as f32)), &mut mixture)?;
        let (mut weight, mut missing) = (0.0f32, 0);
        let compared = Partition::new(&mixture, |d| mixture.pdf(d)).test(DRAWS, || {
            let Some(sample) = mixture.sample([random.unit(), random.unit(), random.unit()]) else {
                missing += 1;
                return Vec3::Z;
            };
            weight = weight.max(sample.weight.max_element());
            sample.direction
        });
        ensure!(missing == 0, "{missing} draws gave no direction");
        all.p = all.p.min(compared.p);
        all.weight = all.weight.max(weight);
        // Both by the same directions, so that what these miss is missed twice.
        let (mut ours, mut theirs) = (0.0, 0.0);
        for (wi, solid) in evaluation_views::weighed(mirror) {
            let value = luminance(mixture.evaluate(Vec3::from(wi.map(|v| v as f32))));
            ours += solid * f64::from(value);
            let value = truth.evaluate(wi, wo).map(|v| v as f32);
            theirs += solid * wi[2] * f64::from(luminance(Vec3::from(value)));
        }
        all.energy = all.energy.max((ours / theirs - 1.0).abs());
    }
    Ok(all)
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<()> {
    println!("processor: {}", srbf_core::Processor::this());
    let at: Vec<(f64, f64)> = INCIDENCES
        .iter()
        .flat_map(|theta| {
            (0..TURNS).step_by(3).map(move |n| (theta.to_radians(), TAU * n as f64 / TURNS as f64))
        })
        .collect();
    let between: Vec<(f64, f64)> = BETWEEN
        .iter()
        .flat_map(|theta| {
            (0..TURNS_BETWEEN)
                .map(move |n| (theta.to_radians(), TAU * (n as f64 + 0.4) / TURNS_BETWEEN as f64))
        })
        .collect();
    let mut text = "surface,bytes,seconds,fit at the turns measured,fit between,completion between,isotropic fit between,one anisotropic lobe between,least p of 24 chi-square,largest weight,energy off (%)\n".to_owned();
    for (name, truth) in truths()?.iter().filter(|truth| truth.0.contains(&args.only)) {
        let intake = csv::parse(samples(truth, args.noise).as_bytes(), &Conventions::default())?;
        let views = intake.views();
        let source = Source::of_samples(intake, (*name).to_owned(), String::new())?;
        let Content::Evaluable(completion) = &source.content else {
            anyhow::bail!("{name}: taken as isotropic: {:?}", source.intake.map(|intake| intake.isotropy))
        };
        if let Some(turn) = source.completion.as_ref().and_then(|completion| completion.turn) {
            println!("{name}: {}", turn.text());
        }
        let found = fit_source(&source, &Settings::default(), |_| {})?;
        let material = Material::from_bytes(found.bytes.as_slice())?;
        let of = |brdf: &dyn Brdf, views: &[(f64, f64)]| {
            error(truth, views, &|wo, incident| incident.iter().map(|wi| brdf.evaluate(*wi, wo)).collect())
        };
        let lobes =
            |views: &[(f64, f64)]| error(truth, views, &|wo, incident| Lobes(&material).values(wo, incident));
        let table = Table::from_scattered(views)?;
        let isotropic = fit(&table, &Settings::default(), |_| {})?;
        let isotropic = Material::from_bytes(isotropic.bytes.as_slice())?;
        let intake = source.intake.as_ref().context("samples")?;
        let one = Model::fit_turned(&intake.rows, intake.is_light_fixed)?;
        let row = [
            lobes(&at),
            lobes(&between),
            of(completion.as_ref(), &between),
            error(truth, &between, &|wo, incident| Lobes(&isotropic).values(wo, incident)),
            of(&one, &between),
        ];
        ensure!(row.iter().all(|v| v.is_finite()), "{name}: an error is no number");
        let numbers = row.map(|v| format!("{v:.1}")).join(",");
        let Drawn { p, weight, energy } = drawn(truth, &material)?;
        let line = format!(
            "{name},{},{:.1},{numbers},{p:.4},{weight:.2},{:.1}",
            found.bytes.len(),
            found.report.seconds,
            100.0 * energy
        );
        println!("{line}");
        text += &line;
        text.push('\n');
    }
    if let Some(path) = &args.output {
        output::write(path, text.as_bytes())?;
    }
    Ok(())
}
