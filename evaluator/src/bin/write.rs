//! Writes the text of a language to standard output: `write LANGUAGE [FILE.srbf [NAME]]`, with the words of a material or a sheet if one is named;
//! `json` is one more language then. Names begin with NAME then, or with `srbf`. `write LANGUAGE sheet` writes the text with the functions of
//! a sheet, `write LANGUAGE blend` with those of a blend too, and `write LANGUAGE sheet-functions` those of a sheet alone.

use srbf_evaluator::{Content, Language, Surface, blend_text, functions, sheet_text, text};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().ok_or("a language is expected: glsl, wgsl, hlsl, slang, cuda, cpp, metal")?;
    let language = Language::from_name(&name);
    let written = match (language, arguments.next()) {
        (Some(language), None) => text(language),
        (Some(language), Some(word)) if word == "sheet" => sheet_text(language),
        (Some(language), Some(word)) if word == "blend" => blend_text(language),
        (Some(language), Some(word)) if word == "sheet-functions" => {
            functions(language, Content::Sheet).split_off(functions(language, Content::Material).len())
        }
        (language, Some(path)) => {
            let surface = Surface::from_bytes(std::fs::read(path)?)?;
            match language {
                Some(language) => surface.export_as(language, arguments.next().as_deref().unwrap_or("srbf")),
                None if name == "json" => surface.json(),
                None => return Err(format!("{name}: no such language").into()),
            }
        }
        _ => return Err(format!("{name}: no such language").into()),
    };
    print!("{written}");
    Ok(())
}
