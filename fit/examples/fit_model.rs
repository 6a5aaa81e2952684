//! Fits a BRDF of your own, here Lambert's law with a soft highlight, and writes the material:
//! `cargo run --release -p srbf-fit --example fit_model -- OUT.srbf`.

use srbf_fit::judge::verdict::Summary;
use srbf_fit::read::Content;
use srbf_fit::table::Brdf;
use srbf_fit::{FactorNodes, Settings, fit_content, write_atomically};
use std::path::Path;

/// Whatever can be evaluated at any pair of directions.
struct Soft;

impl Brdf for Soft {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let mirror = -wi[0] * wo[0] - wi[1] * wo[1] + wi[2] * wo[2];
        let highlight = 0.3 * mirror.max(0.0).powi(20);
        [0.6, 0.3, 0.1].map(|albedo| albedo / std::f64::consts::PI + highlight)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Few lobes, starts and steps, for an example that is quick; the default fits better.
    let settings = Settings {
        lobes: 4,
        starts: 2,
        steps: 20,
        exchanges: 0,
        views: Some(6),
        factors: FactorNodes::None,
        provenance: "an example\n".into(),
        ..Settings::default()
    };
    let fit = fit_content(&Content::Evaluable(Box::new(Soft)), &settings, |_| {})?;
    let error = Summary::new(&fit.report).error.ok_or("nothing was judged")?;
    println!("{} bytes, relative L2 {:.1} % in the median", fit.bytes.len(), 100.0 * error.median);
    if let Some(path) = std::env::args().nth(1) {
        write_atomically(Path::new(&path), &fit.bytes)?;
    }
    if error.median < 0.2 { Ok(()) } else { Err("a poor fit".into()) }
}
