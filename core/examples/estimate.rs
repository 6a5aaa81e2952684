//! Estimates an albedo by draws, and compares it with the closed form: the weight of a draw is hardly noisy.
//!
//! `cargo run --example estimate -- FILE.srbf`

use srbf_core::{Material, Mixture, Vec3, read_file};
use std::path::Path;

const DRAWS: usize = 4096;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "presets/garnet_red.srbf".into());
    let material = Material::from_bytes(read_file(Path::new(&path))?)?;
    let mut mixture = Mixture::<64>::empty();
    material.prepare([-0.6, 0.0, 0.8], &mut mixture)?;

    // Evenly spread numbers: steps of the generalised golden ratio.
    let number = |n: usize, step: f64| (0.5 + step * n as f64).fract() as f32;
    let mut sum = Vec3::ZERO;
    for n in 0..DRAWS {
        let u = [number(n, 0.819_172_513), number(n, 0.671_043_607), number(n, 0.549_700_478)];
        sum += mixture.sample(u).map_or(Vec3::ZERO, |sample| sample.weight);
    }
    let (estimate, albedo) = (sum / DRAWS as f32, mixture.albedo());
    println!("by {DRAWS} draws {estimate:.4}, in closed form {albedo:.4}");
    let is_close = (estimate - albedo).abs().max_element() < 0.01 * albedo.max_element();
    if is_close { Ok(()) } else { Err("the draws do not meet the closed form".into()) }
}
