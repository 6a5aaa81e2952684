//! `cargo lab web`: the page as a folder.

use anyhow::Context;
use srbf_reference_renderer::command::view::files;
use srbf_reference_renderer::out::output;
use srbf_web::fitter_script;
use std::path::PathBuf;

/// Writes the page that shows and fits materials in a browser, as a folder that needs no server and no network.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The folder
    folder: PathBuf,
    /// The fitter as a module for WebAssembly, as `wasm/build` makes it; without it the page fits nothing
    #[arg(long, value_name = "FILE.wasm")]
    fitter: Option<PathBuf>,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<()> {
    let mut files = files(None)?;
    let module =
        args.fitter.as_ref().map(|path| std::fs::read(path).with_context(|| path.display().to_string()));
    files.push(("fitter.js", module.transpose()?.map(|module| fitter_script(&module)).unwrap_or_default()));
    for (name, content) in files {
        let path = args.folder.join(name);
        output::write(&path, &content)?;
        println!("{}: {} bytes", path.display(), content.len());
    }
    Ok(())
}
