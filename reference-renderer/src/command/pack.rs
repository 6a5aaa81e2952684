//! `srbf pack`.

use super::convention_args::ConventionArgs;
use crate::out::output;
use crate::out::print::shown;
use crate::out::progress::Progress;
use crate::truth::sheets::sheet_in;
use crate::truth::stored::{QUARTERS, StoredMaterial, is_fit};
use anyhow::{Context, bail, ensure};
use srbf_core::{Material, PackOptions, Quarter, Sheet};
use srbf_evaluator::plain_bytes;
use srbf_fit::pack::{Packed, PackedForm, Subject, Way, forms};
use srbf_fit::read::{Content, Conventions, read_with};
use srbf_fit::{FactorNodes, Settings, encoded, export, fit_source};
use std::path::{Path, PathBuf};

/// Writes a material in as few bytes as a scene needs: 8 or 16 bits a number, fewer lobes, views, factors, channels.
///
/// Without options all is kept, in codes of 8 bits: a third of the bytes. With fewer lobes, views or factors, lobes are both cut off and
/// fitted again; the nearer of both is written. Codes are read in place by every call, in Rust and C; shaders and the three.js
/// package read the plain form, which `srbf pack FILE.srbf --bits 32` writes again.
///
/// The error is the mean relative L2 error of f cos over twelve views that were not fitted: from the measurement, if FILE is one or
/// --against names it; else from FILE itself. Of an anisotropic material whole rings of views go. Of a sheet each quarter is packed.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// A fit, a preset, or a measured BRDF as `srbf fit` reads it, which is fitted first
    #[arg(value_name = "FILE|PRESET|MODEL")]
    input: PathBuf,
    /// The file to write [default: out/NAME-packed.srbf]
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// The measurement that FILE is a fit of: lobes are fitted to it again, and errors are from it
    #[arg(long, value_name = "TABLE")]
    against: Option<PathBuf>,
    /// Bits of a number: 8, 16, or 32 for plain numbers
    #[arg(long, default_value_t = 8, value_parser = bits)]
    bits: u8,
    /// Channels: 3, or 1 for the luminance alone
    #[arg(long, default_value_t = 3, value_parser = channels)]
    channels: u8,
    /// Lobes of a mixture, those in mirrored pairs counted twice [default: all]
    #[arg(long)]
    lobes: Option<usize>,
    /// Views [default: all]
    #[arg(long)]
    views: Option<usize>,
    /// `none`, or numbers of nodes as in 16x6x3 [default: all]
    #[arg(long, value_name = "NODES")]
    factors: Option<FactorNodes>,
    /// The smallest of nine forms whose error is at most this; it goes without numbers of lobes, views and factors
    #[arg(long, value_name = "PER_CENT", conflicts_with_all = ["lobes", "views", "factors"])]
    error: Option<f64>,
    /// Cuts off alone: nothing is fitted again
    #[arg(long)]
    cut: bool,
    #[command(flatten)]
    conventions: ConventionArgs,
}

fn bits(text: &str) -> Result<u8, String> {
    match text {
        "8" => Ok(8),
        "16" => Ok(16),
        "32" => Ok(32),
        _ => Err("expected 8, 16 or 32".into()),
    }
}

fn channels(text: &str) -> Result<u8, String> {
    match text {
        "1" => Ok(1),
        "3" => Ok(3),
        _ => Err("expected 1 or 3".into()),
    }
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<()> {
    // Before a fit, which takes seconds; without a name the input has to be read first.
    args.output.as_deref().map(output::check_place).transpose()?;
    let place = |name: &str| {
        let output =
            args.output.clone().unwrap_or_else(|| Path::new("out").join(format!("{name}-packed.srbf")));
        output::check_place(&output).map(|()| output)
    };
    if let Some(sheet) = sheet_in(&args.input)? {
        let output = place(&args.input.file_stem().unwrap_or_default().to_string_lossy())?;
        return pack_sheet(args, &sheet, &output);
    }
    let (whole, content, name) = whole(args)?;
    let output = place(&name)?;
    let bytes = packed(args, whole, &content, &name)?;
    output::write(&output, &bytes)?;
    let plain = if args.bits == 32 { " in plain numbers" } else { "" };
    println!("{}: {} bytes{plain}", shown(&output), bytes.len());
    Ok(())
}

/// Packs each quarter of a sheet.
fn pack_sheet(args: &Args, sheet: &Sheet<Vec<u8>>, output: &Path) -> anyhow::Result<()> {
    let mut parts: [Option<Vec<u8>>; 4] = [const { None }; 4];
    for quarter in Quarter::ALL {
        let is_stored = !(sheet.is_symmetric() && quarter.is_back());
        let Some(material) = sheet.quarter(quarter).filter(|_| is_stored) else { continue };
        let name = QUARTERS[quarter as usize];
        println!("{name}:");
        let content = match &args.against {
            Some(table) => {
                read_with(table, &Conventions { quarter, ..args.conventions.conventions() })?.content
            }
            None => {
                Content::Evaluable(Box::new(export::Lobes(Material::from_bytes(material.bytes().to_vec())?)))
            }
        };
        parts[quarter as usize] = Some(packed(args, material.bytes().to_vec(), &content, name)?);
    }
    let mut quarters: [Option<Material<&[u8]>>; 4] = [const { None }; 4];
    for (quarter, part) in quarters.iter_mut().zip(&parts) {
        *quarter = part.as_deref().map(Material::from_bytes).transpose()?;
    }
    let quarters = quarters.each_ref().map(Option::as_ref);
    let bytes = encoded(quarters, sheet.is_symmetric(), sheet.provenance())?;
    output::write(output, &bytes)?;
    println!("{}: {} bytes, a sheet of {}", shown(output), bytes.len(), sheet.bytes().len());
    Ok(())
}

/// The bytes of a material in the form that the options ask for.
fn packed(args: &Args, whole: Vec<u8>, content: &Content, name: &str) -> anyhow::Result<Vec<u8>> {
    if args.bits == 32 {
        let is_plain = args.channels == 3 && args.error.is_none() && args.against.is_none();
        let is_all = args.lobes.is_none() && args.views.is_none() && args.factors.is_none();
        ensure!(is_plain && is_all, "--bits 32: writes plain numbers again, and goes with no other option");
        return Ok(plain_bytes(&Material::from_bytes(whole)?).into_owned());
    }
    let subject = Subject::new(content, &whole)?;
    let pack = PackOptions { bits: args.bits, channels: args.channels };
    let material = subject.whole();
    // The source, which stands first; how it was fitted is known from the whole.
    let provenance = material.provenance().lines().next().unwrap_or_default().to_owned();
    let settings = Settings { provenance, ..Settings::default() };
    println!(
        "whole      {:>6} bytes  {}  error {:.2} %",
        material.bytes().len(),
        described(&PackedForm::of(material, pack)),
        100.0 * subject.error(&whole)?
    );
    let pack_in = |form: &PackedForm| -> anyhow::Result<Packed> {
        let progress = Progress::of_shares(name);
        let packed = subject.pack(form, &settings, !args.cut, |share| progress.set_share(share))?;
        drop(progress);
        let way = if packed.way == Way::Cut { "" } else { ", fitted again" };
        println!(
            "{:>2} bits    {:>6} bytes  {}  error {:.2} %{way}",
            pack.bits,
            packed.bytes.len(),
            described(form),
            100.0 * packed.error
        );
        Ok(packed)
    };
    let packed = match args.error {
        None => pack_in(&form(args, material, pack))?,
        Some(per_cent) => smallest(&forms(material, pack), per_cent, pack_in)?,
    };
    Ok(packed.bytes)
}

/// The bytes of the whole material, the content that it is judged by, and its name.
fn whole(args: &Args) -> anyhow::Result<(Vec<u8>, Content, String)> {
    let conventions = args.conventions.conventions();
    let text = args.input.to_string_lossy();
    let is_model = text.starts_with(srbf_fit::analytic::PREFIX);
    let is_preset = args.input.extension().is_none() && !args.input.exists() && !is_model;
    if is_preset || is_fit(&args.input) {
        let StoredMaterial { name, material } = StoredMaterial::load(&text)?;
        let bytes = material.bytes().to_vec();
        let content = match &args.against {
            Some(table) => read_with(table, &conventions)?.content,
            None => Content::Evaluable(Box::new(export::Lobes(material))),
        };
        return Ok((bytes, content, name));
    }
    ensure!(
        args.against.is_none(),
        "--against: where FILE is a fit; {} is read as the measurement",
        shown(&args.input)
    );
    let source = read_with(&args.input, &conventions)?;
    let provenance = format!("{}, SHA-256 {}\n", source.name, source.sha256);
    let progress = Progress::of_shares(&source.name);
    let settings = Settings { provenance, ..Settings::default() };
    let fit = fit_source(&source, &settings, |share| progress.set_share(share))
        .with_context(|| shown(&args.input))?;
    let stem = args.input.file_stem().unwrap_or_default().to_string_lossy();
    Ok((fit.bytes, source.content, stem.into_owned()))
}

/// The form that the options ask for.
fn form(args: &Args, material: &Material<Vec<u8>>, pack: PackOptions) -> PackedForm {
    let whole = PackedForm::of(material, pack);
    PackedForm {
        lobes: args.lobes.unwrap_or(whole.lobes),
        views: args.views.unwrap_or(whole.views),
        factors: match args.factors {
            None | Some(FactorNodes::Chosen) => whole.factors,
            Some(FactorNodes::None) => None,
            Some(FactorNodes::Given(nodes) | FactorNodes::Signed(nodes)) => Some(nodes),
        },
        pack,
    }
}

/// The smallest form whose error is at most a number of per cent: errors are taken to fall with the size.
fn smallest(
    forms: &[PackedForm],
    per_cent: f64,
    mut pack_in: impl FnMut(&PackedForm) -> anyhow::Result<Packed>,
) -> anyhow::Result<Packed> {
    ensure!(per_cent.is_finite() && per_cent > 0.0, "--error: a number above 0 is expected, per cent");
    let (mut below, mut found) = (0, None);
    let mut above = forms.len();
    while below < above {
        let middle = (below + above) / 2;
        let packed = pack_in(&forms[middle])?;
        if 100.0 * packed.error <= per_cent {
            (above, found) = (middle, Some(packed));
        } else {
            below = middle + 1;
        }
    }
    match found {
        Some(packed) => Ok(packed),
        None => {
            bail!("--error: no form is within {per_cent} %; 16 bits may help, or an error that the whole has")
        }
    }
}

/// A form in words.
fn described(form: &PackedForm) -> String {
    let factors = form.factors.map_or("no factors".to_owned(), |[a, b, c]| format!("factors {a}x{b}x{c}"));
    let channels = if form.pack.channels == 1 { ", 1 channel" } else { "" };
    format!("{:>2} lobes, {:>2} views, {factors}{channels}", form.lobes, form.views)
}
