//! Reads a `.srbf` material and prints its albedo from the normal to grazing: `cargo run --example inspect -- FILE.srbf`.

use srbf_core::{Material, Mixture, read_file};
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "presets/garnet_red.srbf".into());
    let material = Material::from_bytes(read_file(Path::new(&path))?)?;
    println!("{} lobes at {} views", material.lobe_count(), material.view_count());
    let mut mixture = Mixture::<64>::empty(); // room for any material
    for degrees in [0.0f32, 20.0, 40.0, 60.0, 80.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        material.prepare([sin, 0.0, cos], &mut mixture)?;
        println!("{degrees:4} degrees: albedo {:.3}", mixture.albedo());
    }
    Ok(())
}
