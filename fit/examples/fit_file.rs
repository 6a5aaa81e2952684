//! Fits a measured file, or a model by its name, and prints the verdict:
//! `cargo run --release -p srbf-fit --example fit_file -- FILE OUT.srbf`.

use srbf_core::Material;
use srbf_fit::judge::reciprocity::reciprocity;
use srbf_fit::judge::verdict::Verdict;
use srbf_fit::{Settings, fit_source, read, write_atomically};
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let file = arguments.next().unwrap_or_else(|| "model:lambert:albedo=0.6/0.3/0.1".into());
    let source = read::read(Path::new(&file))?;
    let settings = Settings { lobes: 2, ..Settings::default() };
    let fit = fit_source(&source, &settings, |_| {})?;
    let material = Material::from_bytes(fit.bytes.as_slice())?;
    for line in Verdict::of_material(&fit.report, &reciprocity(&material)?).lines() {
        println!("{line}");
    }
    if let Some(path) = arguments.next() {
        write_atomically(Path::new(&path), &fit.bytes)?;
    }
    Ok(())
}
