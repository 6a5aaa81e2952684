//! `srbf-lab forms`: error, bytes and time of a material with less and less in it.
//!
//! Forms take turns, many times over, and the least time of each is kept: what disturbs the machine disturbs all of them, and only
//! ever adds.

mod plot;

use srbf_benches::harness::capped_and_best;
use srbf_core::{Level, MAX_LOBES, Material, Mixture, PackOptions, Vec3};
use srbf_fit::pack::{PackedForm, Subject, Way, forms};
use srbf_fit::read::read;
use srbf_fit::{Settings, fit_content};
use srbf_reference_renderer::command::fit::names;
use srbf_reference_renderer::out::output;
use std::fmt::Write;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Rounds over all forms, and calls that are timed together.
const ROUNDS: usize = 40;
const CALLS: usize = 200;

/// Ways of writing the numbers of the whole material.
const WAYS: [PackOptions; 3] = [
    PackOptions { bits: 16, channels: 3 },
    PackOptions { bits: 8, channels: 3 },
    PackOptions { bits: 8, channels: 1 },
];

/// Error, bytes and time of the forms that `srbf pack` can make of a measurement: a table and a plot.
///
/// The error is the mean relative L2 error of f cos over views that were not fitted, from the measurement. Hits are of one
/// direction with its density and one draw, through codes, and through the plain numbers that they unpack to, with AVX2 and at the best level.
/// Writes out/NAME-forms.csv and .png.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The measured BRDF or the model, as `srbf fit` reads it
    #[arg(value_name = "FILE|MODEL")]
    file: PathBuf,
}

/// A form and its costs.
struct FormRow {
    form: PackedForm,
    bits: u8,
    error: f64,
    /// The error by cutting off alone.
    cut: f64,
    is_fitted_again: bool,
    bytes: Vec<u8>,
    plain: Vec<u8>,
    /// Nanoseconds at each level: to prepare from codes; a hit through codes, and through plain numbers.
    nanoseconds: Vec<[f64; 3]>,
}

/// Fits a measurement, makes every form, prints the table, and writes it.
pub fn run(args: &Args) -> anyhow::Result<()> {
    println!("processor: {}", srbf_core::Processor::this());
    let source = read(&args.file)?;
    let name = names::stem(&args.file, None)?.to_string_lossy().into_owned();
    let settings = Settings::default();
    let whole = fit_content(&source.content, &settings, |_| {})?.bytes;
    let subject = Subject::new(&source.content, &whole)?;
    let mut rows = Vec::new();
    let material = subject.whole();
    let plain = PackedForm::of(material, WAYS[0]);
    let error = subject.error(&whole)?;
    rows.push(row(plain, 32, error, error, false, whole.clone())?);
    let mut all: Vec<PackedForm> = WAYS.iter().map(|way| PackedForm::of(material, *way)).collect();
    all.extend(forms(material, PackOptions::default()).into_iter().rev().skip(1));
    for form in all {
        let packed = subject.pack(&form, &settings, true, |_| {})?;
        let cut = subject.pack(&form, &settings, false, |_| {})?;
        rows.push(row(
            form,
            form.pack.bits,
            packed.error,
            cut.error,
            packed.way == Way::FittedAgain,
            packed.bytes,
        )?);
    }
    let levels = capped_and_best();
    rows.iter_mut().for_each(|row| row.nanoseconds = vec![[f64::INFINITY; 3]; levels.len()]);
    for _ in 0..ROUNDS {
        for (i, level) in levels.iter().enumerate() {
            level.set()?;
            for row in &mut rows {
                let timed = time(&row.bytes, &row.plain)?;
                row.nanoseconds[i].iter_mut().zip(timed).for_each(|(least, new)| *least = least.min(new));
            }
        }
    }

    println!("nanoseconds: {}", levels.iter().map(|level| level.name()).collect::<Vec<_>>().join("; "));
    print(&rows);
    let out = Path::new("out").join(format!("{name}-forms.csv"));
    output::write(&out, csv(&levels, &rows).as_bytes())?;
    let picture = out.with_extension("png");
    let calls = ["prepare", "hit", "hit, unpacked"];
    // A grey material is far from a coloured one, whatever its bytes.
    let colored = rows.iter().filter(|row| row.form.pack.channels == 3);
    let points = colored.map(|row| plot::Point {
        error: row.error,
        bytes: row.bytes.len(),
        nanoseconds: row.nanoseconds[0],
    });
    plot::write(
        &picture,
        &format!("{name}: forms of srbf pack, {}", levels[0].name()),
        calls,
        &points.collect::<Vec<_>>(),
    )?;
    println!("{}, {}", out.display(), picture.display());
    Ok(())
}

fn row(
    form: PackedForm,
    bits: u8,
    error: f64,
    cut: f64,
    is_fitted_again: bool,
    bytes: Vec<u8>,
) -> anyhow::Result<FormRow> {
    let material = Material::from_bytes(bytes.as_slice())?;
    let plain = srbf_evaluator::plain_bytes(&material).into_owned();
    Ok(FormRow { form, bits, error, cut, is_fitted_again, bytes, plain, nanoseconds: Vec::new() })
}

/// Nanoseconds of preparing from codes, and of a hit through codes and through plain numbers.
fn time(bytes: &[u8], plain: &[u8]) -> anyhow::Result<[f64; 3]> {
    let place = |n: usize| (n as f32 * 0.618_034).fract();
    let direction = |n: usize| {
        let (z, azimuth) = (0.05 + 0.9 * place(n), std::f32::consts::TAU * place(3 * n + 1));
        let across = (1.0 - z * z).sqrt();
        Vec3::new(across * azimuth.cos(), across * azimuth.sin(), z)
    };
    let directions: Vec<Vec3> = (0..CALLS).map(direction).collect();
    let per_call = |start: Instant| start.elapsed().as_secs_f64() * 1e9 / CALLS as f64;
    let mut mixture = Mixture::<MAX_LOBES>::empty();
    let material = Material::from_bytes(bytes)?;
    let start = Instant::now();
    for d in &directions {
        material.prepare(*d, &mut mixture)?;
        black_box(&mixture);
    }
    let prepare = per_call(start);
    let hits = |material: &Material<&[u8]>| {
        let start = Instant::now();
        for (n, d) in directions.iter().enumerate() {
            black_box(material.sample_and_evaluate(
                *d,
                [place(n), place(5 * n), place(7 * n)],
                direction(n + 1),
            ));
        }
        per_call(start)
    };
    Ok([prepare, hits(&material), hits(&Material::from_bytes(plain)?)])
}

fn factors(form: &PackedForm) -> String {
    form.factors.map_or("none".into(), |[a, b, c]| format!("{a}x{b}x{c}"))
}

fn print(rows: &[FormRow]) {
    println!(
        "| bits | channels | lobes | views | factors | bytes | error % | cut off alone % | prepare ns | hit ns | unpacked |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    for row in rows {
        let at_each = |i: usize| {
            row.nanoseconds.iter().map(|times| format!("{:.0}", times[i])).collect::<Vec<_>>().join("; ")
        };
        let [prepare, hit, plain] = [0, 1, 2].map(at_each);
        println!(
            "| {} | {} | {} | {} | {} | {} | {:.2}{} | {:.2} | {prepare} | {hit} | {plain} |",
            row.bits,
            row.form.pack.channels,
            row.form.lobes,
            row.form.views,
            factors(&row.form),
            row.bytes.len(),
            100.0 * row.error,
            if row.is_fitted_again { "*" } else { "" },
            100.0 * row.cut,
        );
    }
    println!("* fitted again");
}

fn csv(levels: &[Level], rows: &[FormRow]) -> String {
    let mut text =
        "bits,channels,lobes,views,factors,bytes,relative_l2,relative_l2_cut,fitted_again".to_owned();
    // Writing to a String cannot fail.
    for level in levels.iter().map(|level| level.name()) {
        let _ = write!(text, ",prepare_ns_{level},hit_ns_{level},hit_plain_ns_{level}");
    }
    text.push('\n');
    for row in rows {
        let _ = write!(
            text,
            "{},{},{},{},{},{},{:.6},{:.6},{}",
            row.bits,
            row.form.pack.channels,
            row.form.lobes,
            row.form.views,
            factors(&row.form),
            row.bytes.len(),
            row.error,
            row.cut,
            row.is_fitted_again,
        );
        for time in row.nanoseconds.iter().flatten() {
            let _ = write!(text, ",{time:.1}");
        }
        text.push('\n');
    }
    text
}
