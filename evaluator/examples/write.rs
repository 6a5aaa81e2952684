//! Writes the text of a language to standard output: `write LANGUAGE [MATERIAL.srbf]`, with a material's words if one is named; `json` is one
//! more language then.

use srbf_core::Material;
use srbf_evaluator::{Language, export, json, text};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().ok_or("a language is expected: glsl, wgsl, hlsl, slang, cuda, cpp, metal")?;
    let language = Language::from_name(&name);
    let written = match (language, arguments.next()) {
        (Some(language), None) => text(language),
        (language, Some(path)) => {
            let material = Material::from_bytes(std::fs::read(path)?)?;
            match language {
                Some(language) => export(&material, language),
                None if name == "json" => json(&material),
                None => return Err(format!("{name}: no such language").into()),
            }
        }
        _ => return Err(format!("{name}: no such language").into()),
    };
    print!("{written}");
    Ok(())
}
