//! `cargo lab good-inputs`.

mod made;
mod words;

use anyhow::Context;
use made::Made;
use srbf_fit::look::{Finding, Look, Topic};
use srbf_fit::read::{Content, Source, csv, read};
use srbf_fit::table::Symmetry;
use srbf_reference_renderer::command::argument;
use srbf_reference_renderer::command::look::looked_at;
use srbf_reference_renderer::numbers::random::Random;
use srbf_reference_renderer::truth::networks::Networks;
use std::path::{Path, PathBuf};

/// Looks at inputs without a fault, and prints each fault that `srbf look` finds in them: false words, but for measurements with faults.
///
/// Made-up inputs are models at the directions of usual instruments, with noise. The measured ones are all of the folder that SRBF_DATA_DIR
/// names: Cornell's, those of other programs, RGL's, and every eighth network of MERL.
///
/// With `--plant` one sample of each made-up input is given a fault. How many of these are named is printed, by noise, with the number of
/// other samples that are named.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Only made-up inputs, which need no files
    #[arg(long)]
    made: bool,
    /// Only inputs whose names contain this
    #[arg(long, value_name = "NAME", default_value = "")]
    only: String,
    /// Seed of the noise of made-up inputs, and of the directions that lie anywhere
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Factor on one sample of each made-up input, which `look` then has to name
    #[arg(long, value_name = "FACTOR", conflicts_with = "made")]
    plant: Option<f64>,
    /// Writes every word that `look` and `fit` say of FILES as CSV, and does nothing else
    #[arg(long, value_name = "CSV", requires = "files", conflicts_with_all = ["made", "plant"])]
    words: Option<PathBuf>,
    /// Files and folders for `--words`
    #[arg(value_name = "FILE", requires = "words")]
    files: Vec<PathBuf>,
}

/// One in this many networks is looked at.
const EVERY: usize = 8;

/// Letters of a word that are printed.
const SHOWN: usize = 150;

/// Inputs, and how many were told something.
#[derive(Default)]
struct Count {
    inputs: usize,
    told: usize,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<()> {
    println!("processor: {}", srbf_core::Processor::this());
    if let Some(output) = &args.words {
        return words::write(output, &args.files);
    }
    if let Some(factor) = args.plant {
        return planted(args, factor);
    }
    if !args.made {
        measured(&args.only)?;
    }
    let mut count = Count::default();
    println!("made-up inputs: the words at noise of {} %", made::NOISES.map(|n| format!("{n}")).join(", "));
    for (name, inputs) in made::all(args.seed).filter(|(name, _)| name.contains(&args.only)) {
        let mut words = Vec::new();
        for input in inputs {
            let said = of_made(&name, &input)?;
            count.inputs += 1;
            count.told += usize::from(said != "-");
            words.push(said);
        }
        println!("{name:<36} {}", words.join(" / "));
    }
    println!("{} of {} made-up inputs are told something", count.told, count.inputs);
    Ok(())
}

/// Gives each made-up input a fault, and prints how many are named.
fn planted(args: &Args, factor: f64) -> anyhow::Result<()> {
    let (mut named, mut others) = ([0; made::NOISES.len()], [0; made::NOISES.len()]);
    let mut refused = [0; made::NOISES.len()];
    let mut inputs = 0;
    for (number, (name, of_noise)) in
        made::all(args.seed).filter(|(name, _)| name.contains(&args.only)).enumerate()
    {
        inputs += 1;
        for (n, made) in of_noise.iter().enumerate() {
            let mut intake = csv::parse(made.text.as_bytes(), &Default::default())?;
            let mut random = Random::new(args.seed, number as u64, n as u64);
            let at = (f64::from(random.unit()) * intake.rows.len() as f64) as usize;
            let row = &mut intake.rows[at];
            row.rgb = row.rgb.map(|v| v * factor);
            let line = row.line;
            let Ok(source) = Source::of_samples(intake, name.clone(), String::new()) else {
                refused[n] += 1;
                continue;
            };
            let look = looked_at(source).with_context(|| name.clone())?;
            let wrong = || look.outliers.iter().filter(|o| o.is_wrong);
            let is_named = wrong().any(|o| o.row.line == line);
            named[n] += usize::from(is_named);
            others[n] += wrong().count() - usize::from(is_named);
        }
    }
    println!("one sample times {factor} in each of {inputs} made-up inputs");
    for (n, noise) in made::NOISES.iter().enumerate() {
        println!(
            "noise of {noise:>2} %: {:>3} named, and {} other samples; {} inputs refused as anisotropic",
            named[n], others[n], refused[n]
        );
    }
    Ok(())
}

/// The words about a made-up input.
fn of_made(name: &str, made: &Made) -> anyhow::Result<String> {
    let source = csv::parse(made.text.as_bytes(), &Default::default())
        .map_err(|error| error.to_string())
        .and_then(|intake| {
            Source::of_samples(intake, name.to_owned(), String::new()).map_err(|error| error.to_string())
        });
    let source = match source {
        Ok(source) => source,
        Err(error) => return Ok(format!("refused: {}", shortened(&error))),
    };
    let look = looked_at(source).with_context(|| name.to_owned())?;
    Ok(words(&look, made.is_retro))
}

/// Looks at the files of the data folder.
fn measured(only: &str) -> anyhow::Result<()> {
    let data = argument::data_folder()?;
    println!("{:<40} {:>7} {:>6} {:>8}  words", "measured", "samples", "angles", "left out");
    let mut sources: Vec<(String, Source)> = Vec::new();
    for (folder, endings) in [
        ("cornell", &["brdf", "astm"][..]),
        ("field", &["bsdf", "anisotropicbsdf", "csv", "dat", "xompt"]),
        ("rgl", &["bsdf"]),
    ] {
        for file in files(&data.join(folder), endings)? {
            let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
            if !name.contains(only) {
                continue;
            }
            match read(&file) {
                Ok(source) => sources.push((name, source)),
                Err(error) => println!("{name:<40} refused: {:#}", anyhow::Error::from(error)),
            }
        }
    }
    let networks = Networks::read(&data.join("merl/nbrdf_merl80.f32le"))?;
    for (name, network) in networks.all.into_iter().step_by(EVERY).filter(|n| n.0.contains(only)) {
        sources.push((name.clone(), Source::evaluable(Box::new(network), name, String::new())));
    }
    let mut count = Count::default();
    for (name, source) in sources {
        if matches!(&source.content, Content::Evaluable(brdf) if brdf.symmetry() != Symmetry::Isotropic) {
            continue;
        }
        let is_retro = name.contains("retro");
        let look = looked_at(source).with_context(|| name.clone())?;
        let said = words(&look, is_retro);
        count.inputs += 1;
        count.told += usize::from(said != "-");
        let left_out: usize = look.left_out.iter().map(|left| left.count).sum();
        println!("{name:<40} {:>7} {:>6} {left_out:>8}  {said}", look.samples, look.views.len());
    }
    println!("{} of {} measured inputs are told something", count.told, count.inputs);
    Ok(())
}

/// The files of a folder with one of these endings, in order.
fn files(folder: &Path, endings: &[&str]) -> anyhow::Result<Vec<PathBuf>> {
    let entries = std::fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    let mut files: Vec<PathBuf> = entries.map(|e| Ok(e?.path())).collect::<std::io::Result<_>>()?;
    files.retain(|f| f.extension().is_some_and(|e| endings.iter().any(|ending| e == *ending)));
    files.sort();
    Ok(files)
}

/// Faults that a look names; `-` for none. A highlight that no sample met is a fact, and no fault.
fn words(look: &Look, is_retro: bool) -> String {
    let is_word = |finding: &&Finding| match finding.topic {
        Topic::Units | Topic::Isotropy | Topic::Outliers | Topic::Reciprocity | Topic::Sides => {
            finding.is_off
        }
        Topic::Convention => finding.option == Some("--mirror equal") && !is_retro,
        Topic::NotMeasured | Topic::Highlight | Topic::Gaps | Topic::Stated => false,
    };
    let said: Vec<String> = look
        .findings
        .iter()
        .filter(is_word)
        .map(|f| format!("{}: {}", f.topic.name(), shortened(&f.text)))
        .collect();
    if said.is_empty() { "-".to_owned() } else { said.join(" | ") }
}

fn shortened(text: &str) -> String {
    let start: String = text.chars().take(SHOWN).collect();
    if start.len() < text.len() { start + " ..." } else { start }
}
