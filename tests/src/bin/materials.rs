//! Writes random materials for lab/differential.py: `cargo run --release --workspace --bin materials -- FOLDER [COUNT [SEED]]`.
//!
//! The files are `NUMBER-KIND.srbf`, of the kinds of [`ANY`] in turn and of one more, `ends`, at the ends of the format's ranges. A material
//! in codes also has its plain numbers beside it, `NUMBER-KIND.plain`. It prints the name of each, and the sharpness of its sharpest lobe.

use srbf_core::{Material, Quarter, Sheet};
use srbf_tests::inputs::Random;
use srbf_tests::kinds::{ANY, any};
use srbf_tests::seeds::extreme;
use std::error::Error;
use std::path::Path;

/// The sharpest lobe of a material.
fn sharpest(material: &Material<impl AsRef<[u8]>>) -> f32 {
    let views = (0..material.view_count()).flat_map(|v| (0..material.view_lobe_count()).map(move |k| (v, k)));
    let log2 = |(v, k)| match material.view_lobe(v, k) {
        Some(lobe) => lobe.log2_sharpness,
        None => material.view_tilted_lobe(v, k).map_or(0.0, |lobe| lobe.log2_sharpness),
    };
    views.map(log2).fold(0.0, f32::max).exp2()
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let folder = Path::new(arguments.first().ok_or("a folder is expected")?);
    let number = |i: usize, other: u64| arguments.get(i).map_or(Ok(other), |text| text.parse::<u64>());
    let (count, seed) = (number(1, 280)?, number(2, 1)?);
    std::fs::create_dir_all(folder)?;
    let mut random = Random(seed);
    for n in 0..count as usize {
        let (kind, bytes) = match ANY.get(n % (ANY.len() + 1)) {
            Some(kind) => (*kind, any(kind, &mut random)),
            None => ("ends", extreme(&mut random)),
        };
        let sharpest = match Sheet::from_bytes(&bytes[..]) {
            Ok(sheet) => {
                let quarters = Quarter::ALL.into_iter().filter_map(|of| sheet.quarter(of));
                quarters.map(|quarter| sharpest(&quarter)).fold(0.0, f32::max)
            }
            Err(_) => sharpest(&Material::from_bytes(&bytes[..])?),
        };
        println!("{n:04}-{kind},{sharpest}");
        let path = folder.join(format!("{n:04}-{kind}.srbf"));
        if kind.starts_with("codes") {
            let material = Material::from_bytes(&bytes[..])?;
            let mut plain = vec![0; material.unpacked_len()];
            let written = material.unpack(&mut plain)?;
            std::fs::write(path.with_extension("plain"), &plain[..written])?;
        }
        std::fs::write(path, bytes)?;
    }
    Ok(())
}
