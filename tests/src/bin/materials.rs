//! Writes random materials for lab/differential.py: `cargo run --release --workspace --bin materials -- FOLDER [COUNT [SEED]]`.
//!
//! The files are `NUMBER-KIND.srbf`, of the kinds of [`ANY`] in turn and of one more, `ends`, at the ends of the format's ranges. A material
//! in codes also has its plain numbers beside it, `NUMBER-KIND.plain`.

use srbf_core::Material;
use srbf_tests::inputs::Random;
use srbf_tests::kinds::{ANY, any};
use srbf_tests::seeds::extreme;
use std::error::Error;
use std::path::Path;

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
