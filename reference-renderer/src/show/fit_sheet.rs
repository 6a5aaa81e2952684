//! The picture of a fit: curves in the plane of incidence, discs of the hemisphere, balls, and the verdict in words.
//!
//! Blocks of one width stand one below the other.

mod curves;
mod discs;
mod words;

use crate::out::picture_file;
use crate::shade::shader::LoadedMaterial;
use crate::show::ball_sheet::{self, Light};
use srbf_core::{Vec3, luminance};
use srbf_fit::judge::method::Fitted;
use srbf_fit::table::{Brdf, Table};
use std::path::Path;

/// Width of every block, pixels.
const WIDTH: u32 = 1280;

/// 8-bit sRGB, rows from the top.
pub struct Strip {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Three bytes a pixel.
    pub rgb: Vec<u8>,
}

impl Strip {
    /// A white one.
    fn white(size: [u32; 2]) -> Self {
        Self { size, rgb: vec![255; 3 * (size[0] * size[1]) as usize] }
    }
}

/// The data beside a fit.
pub struct Against<'a> {
    /// A BRDF and its name.
    pub brdf: &'a dyn Brdf,
    pub name: &'static str,
    /// Samples that it was made of.
    pub samples: Option<&'a Table>,
}

/// The subject of a sheet.
pub struct Subject<'a> {
    /// The name of the material.
    pub name: &'a str,
    /// The values of the material.
    pub fit: &'a dyn Fitted,
    pub against: Option<Against<'a>>,
    /// The material as a ball, and what stands beside it.
    pub ball: &'a LoadedMaterial,
    pub ball_beside: Option<&'a LoadedMaterial>,
    pub light: Light<'a>,
    /// Lines of the verdict.
    pub verdict: &'a [String],
}

/// Luminance of a colour.
fn y(rgb: [f64; 3]) -> f64 {
    let [r, g, b] = rgb.map(|v| v as f32);
    f64::from(luminance(Vec3::new(r, g, b)))
}

/// Draws the whole.
///
/// # Errors
/// As the fit and the balls say them; faults of the font.
pub fn draw(subject: &Subject<'_>) -> anyhow::Result<Strip> {
    let mut blocks = vec![curves::draw(subject)?, discs::draw(subject)?];
    let sheet = ball_sheet::draw(subject.ball, subject.ball_beside, &subject.light)?;
    blocks.push(Strip { size: sheet.size, rgb: sheet.rgb });
    if !subject.verdict.is_empty() {
        blocks.push(words::draw(subject.verdict)?);
    }
    Ok(stacked(&blocks))
}

/// Draws and writes it.
///
/// # Errors
/// As [`draw`]; names the file that cannot be written.
pub fn write(path: &Path, subject: &Subject<'_>) -> anyhow::Result<()> {
    let block = draw(subject)?;
    picture_file::write_png(path, block.size, &block.rgb)
}

/// Blocks one below the other, on white; narrow ones begin at the left.
fn stacked(blocks: &[Strip]) -> Strip {
    let mut all = Strip::white([WIDTH, blocks.iter().map(|block| block.size[1]).sum()]);
    let mut rows = all.rgb.chunks_exact_mut(3 * WIDTH as usize);
    for block in blocks {
        for (row, from) in rows.by_ref().zip(block.rgb.chunks_exact(3 * block.size[0] as usize)) {
            row[..from.len()].copy_from_slice(from);
        }
    }
    all
}
