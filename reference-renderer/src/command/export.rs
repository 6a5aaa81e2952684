//! `srbf export`.

use crate::out::output;
use crate::truth::stored::surface;
use anyhow::{Context, ensure};
use srbf_evaluator::{Language, blend_text, is_name, renamed, sheet_text, text};
use std::io::Write;
use std::path::PathBuf;

/// Most bytes of a file that is read.
const MAX_FILE: u64 = 1 << 26;

/// Writes a material or a sheet for a shader or a program that does not link the library: one text that evaluates and draws from it, with
/// its numbers.
///
/// The text begins with the calls that a program makes, and is the same for all languages but for their words. Two of them stand in one
/// program by --name. The words of FILE stand in it as constants, `srbf_data`; with --buffer
/// they do not, and the text reads any `.srbf` file in place, from memory or through a function `srbf_word` of yours.
/// Of a sheet it has all quarters, and functions that choose the side; FILE.srbf:front-transmission is a quarter alone.
/// docs/use-from-shaders.md says how, and how far values are from the library's: 3e-4.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The fitted material or sheet, `.srbf`; not with --buffer
    #[arg(required_unless_present = "buffer", conflicts_with = "buffer")]
    file: Option<PathBuf>,
    #[command(flatten)]
    language: Chosen,
    /// The text alone, which reads materials from memory
    #[arg(long, conflicts_with = "json")]
    buffer: bool,
    /// The text alone has the functions of a sheet too
    #[arg(long, requires = "buffer")]
    sheet: bool,
    /// The text alone has the functions of a sheet and of a blend too
    #[arg(long, requires = "buffer", conflicts_with = "sheet")]
    blend: bool,
    /// What all names begin with, so that two texts stand in one program: letters, digits and single underscores
    #[arg(long, default_value = "srbf", conflicts_with = "json", value_parser = name)]
    name: String,
    /// The file to write [default: standard output]
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// The language, one of these.
#[derive(Debug, clap::Args)]
#[group(required = true, multiple = false)]
#[allow(clippy::struct_excessive_bools)] // clap has a group of options so
struct Chosen {
    /// GLSL: ES 3.0, and 3.30 and later
    #[arg(long)]
    glsl: bool,
    /// WGSL, of WebGPU
    #[arg(long)]
    wgsl: bool,
    /// HLSL, shader model 5 and later
    #[arg(long)]
    hlsl: bool,
    /// Slang
    #[arg(long)]
    slang: bool,
    /// CUDA C++
    #[arg(long)]
    cuda: bool,
    /// C++17
    #[arg(long)]
    cpp: bool,
    /// The Metal shading language
    #[arg(long)]
    metal: bool,
    /// The numbers of every view, by name
    #[arg(long)]
    json: bool,
}

impl Chosen {
    /// `None` for JSON.
    fn language(&self) -> Option<Language> {
        let all = [
            (self.glsl, Language::Glsl),
            (self.wgsl, Language::Wgsl),
            (self.hlsl, Language::Hlsl),
            (self.slang, Language::Slang),
            (self.cuda, Language::Cuda),
            (self.cpp, Language::Cpp),
            (self.metal, Language::Metal),
        ];
        all.into_iter().find(|(is_chosen, _)| *is_chosen).map(|(_, language)| language)
    }
}

/// A name of --name.
fn name(text: &str) -> Result<String, String> {
    let hint = "a letter, then letters, digits and single underscores are expected, at most 32 in all, as in `paint`; gl is GLSL's own";
    if is_name(text) { Ok(text.to_owned()) } else { Err(hint.to_owned()) }
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<()> {
    let written = match (&args.file, args.language.language()) {
        (None, language) => {
            let language = language.context("--buffer: JSON has no text")?;
            let text = match (args.sheet, args.blend) {
                (_, true) => blend_text(language),
                (true, _) => sheet_text(language),
                _ => text(language),
            };
            renamed(&text, &args.name)
        }
        (Some(file), language) => {
            let surface = surface(file, MAX_FILE)?;
            ensure!(
                surface.can_read(),
                "{}: of format version 1, which the text does not read",
                file.display()
            );
            language.map_or_else(|| surface.json(), |language| surface.export_as(language, &args.name))
        }
    };
    match &args.output {
        Some(path) => output::write(path, written.as_bytes()),
        None => Ok(std::io::stdout().write_all(written.as_bytes())?),
    }
}
