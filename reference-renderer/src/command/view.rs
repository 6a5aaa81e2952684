//! `srbf view`.

mod browser;
mod server;

use crate::out::print;
use crate::out::print::shown;
use crate::out::progress::Progress;
use crate::truth::sheets::sheet_in;
use crate::truth::stored::{MATTE, PRESETS, StoredMaterial, is_fit};
use crate::world::teapot;
use anyhow::{Context, anyhow};
use server::Server;
use srbf_web::{Opened, Preset, Teapot, export, fitted, open};
use std::path::{Path, PathBuf};

/// Quadrilaterals along each side of a patch of the teapot.
const TEAPOT_STEPS: u32 = 10;

/// Largest fitter that is read.
const MAX_FITTER: u64 = 1 << 26;

/// Materials that one knows, of models, which the page shows before the presets.
const KNOWN: [(&str, &[u8]); 3] = [
    ("gold", include_bytes!("../../presets/known/gold.srbf")),
    ("car_paint", include_bytes!("../../presets/known/car_paint.srbf")),
    ("velvet", include_bytes!("../../presets/known/velvet.srbf")),
];

/// Shows a material or a sheet in a browser: ball and teapot, lobes, verdict.
///
/// A measurement is fitted first, as `srbf fit` does. The page is served on the loopback address alone, until the command is ended by
/// Ctrl-C. Of a sheet both sides are shown, by the light that they reflect and by that which comes through. Materials, packed ones too, and
/// measurements may be dropped on the page: this program reads and fits them.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The material or the sheet, a .srbf file or the name of a preset; or a measurement or model that `srbf fit` reads [default: the presets]
    #[arg(value_name = "FILE|PRESET|MODEL")]
    material: Option<String>,
    /// Port of the loopback address; 0 is any that is free
    #[arg(long, default_value_t = 0)]
    port: u16,
    /// Prints the address, and opens no browser
    #[arg(long)]
    no_open: bool,
    /// A folder that `packaging/web` wrote: its fitter.js fits dropped files, in the browser
    #[arg(long, value_name = "DIR")]
    page: Option<PathBuf>,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<()> {
    let fitter = args.page.as_deref().map(fitter).transpose()?;
    // Before a fit, which takes seconds.
    let server = Server::bind(args.port)?;
    let opened = args.material.as_deref().map(opened).transpose()?;
    let mut files = files(opened.as_ref())?;
    // Without it the page asks this program.
    files.push(("fitter.js", fitter.unwrap_or_else(|| b"self.srbfServer = true;\n".to_vec())));
    let address = server.address();
    println!("{address} shows {}; Ctrl-C ends it", args.material.as_deref().unwrap_or("the presets"));
    print::flush();
    if !args.no_open
        && let Err(error) = browser::open(&address)
    {
        println!("note no browser was opened: {error}");
    }
    server.run(&files, &|verb, with, bytes, progress| match verb {
        "open" => open(with, bytes, progress).map(|opened| (opened.json.to_string(), opened.bytes)),
        _ => export(bytes, with).map(|bytes| (String::new(), bytes)),
    })
}

/// The files of the page but for the fitter.
///
/// # Errors
/// As the page says them.
pub fn files(opened: Option<&Opened>) -> anyhow::Result<Vec<(&'static str, Vec<u8>)>> {
    with_parts(|presets, teapot| srbf_web::files(presets, teapot, opened))
}

/// The page as one file, which begins with a material.
///
/// # Errors
/// As the page says them.
pub fn one_file(opened: &Opened) -> anyhow::Result<String> {
    with_parts(|presets, teapot| srbf_web::one_file(presets, teapot, opened))
}

/// Calls with the presets and the teapot of the page.
fn with_parts<T>(call: impl FnOnce(&[Preset<'_>], &Teapot<'_>) -> Result<T, String>) -> anyhow::Result<T> {
    let mesh = teapot::tessellate(TEAPOT_STEPS);
    let numbers = |vectors: &[glam::Vec3]| vectors.iter().map(|v| v.to_array()).collect::<Vec<_>>();
    let (positions, normals) = (numbers(&mesh.positions), numbers(&mesh.normals));
    let teapot = Teapot { positions: &positions, normals: &normals, triangles: &mesh.triangles };
    let presets: Vec<Preset<'_>> =
        KNOWN.iter().chain(PRESETS).map(|&(name, bytes)| Preset { name, bytes }).collect();
    call(&presets, &teapot).map_err(|text| anyhow!(text))
}

/// The fitter of a folder.
fn fitter(folder: &Path) -> anyhow::Result<Vec<u8>> {
    let file = folder.join("fitter.js");
    srbf_fit::read_at_most(&file, MAX_FITTER)
        .with_context(|| format!("--page: {}: a folder that `packaging/web` wrote is expected", shown(&file)))
}

/// The material or the sheet of a name: as it is stored, or fitted.
fn opened(name: &str) -> anyhow::Result<Opened> {
    let path = Path::new(name);
    if let Some(sheet) = sheet_in(path)? {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        return open(&format!("{stem}.srbf"), sheet.bytes(), |_| {}).map_err(|text| anyhow!(text));
    }
    let is_preset = name == MATTE || PRESETS.iter().any(|preset| preset.0 == name);
    if is_preset || is_fit(path) {
        let StoredMaterial { name, material } = StoredMaterial::load(name)?;
        return open(&format!("{name}.srbf"), material.bytes(), |_| {}).map_err(|text| anyhow!(text));
    }
    let source = srbf_fit::read::read(name.as_ref())?;
    let progress = Progress::of_shares(&source.name);
    fitted(&source, |share| progress.set_share(share)).map_err(|text| anyhow!(text))
}
