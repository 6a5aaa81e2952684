//! Writes the text of a language to standard output: `write LANGUAGE [FILE.srbf]`, with the words of a material or a sheet if one is named;
//! `json` is one more language then. `write LANGUAGE sheet` writes the text with the functions of a sheet.

use srbf_evaluator::{Language, Surface, sheet_text, text};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().ok_or("a language is expected: glsl, wgsl, hlsl, slang, cuda, cpp, metal")?;
    let language = Language::from_name(&name);
    let written = match (language, arguments.next()) {
        (Some(language), None) => text(language),
        (Some(language), Some(word)) if word == "sheet" => sheet_text(language),
        (language, Some(path)) => {
            let surface = Surface::from_bytes(std::fs::read(path)?)?;
            match language {
                Some(language) => surface.export(language),
                None if name == "json" => surface.json(),
                None => return Err(format!("{name}: no such language").into()),
            }
        }
        _ => return Err(format!("{name}: no such language").into()),
    };
    print!("{written}");
    Ok(())
}
