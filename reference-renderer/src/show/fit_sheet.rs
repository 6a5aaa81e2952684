//! The picture of a fit: the sentence of its verdict, balls, curves in the plane of incidence, and discs of the hemisphere.
//!
//! Colours and names are those of the page that `srbf view` shows. The letters can still be read where the picture is shown half as wide.

mod curves;
mod discs;
mod head;

use crate::out::panel::{FONT, Failure, register_font};
use crate::out::picture_file;
use crate::shade::shader::LoadedMaterial;
use crate::show::ball_sheet::{self, Light};
use anyhow::anyhow;
use plotters::coord::Shift;
use plotters::prelude::*;
use srbf_core::{Vec3, luminance};
use srbf_fit::judge::method::Fitted;
use srbf_fit::table::{Brdf, Table};
use std::path::Path;

/// Width of the picture, and the size of a tile of it, pixels: a ball, or curves.
const WIDTH: u32 = 800;
const TILE: [u32; 2] = [400, 400];

/// Height of the caption of a tile, and of letters, pixels.
const CAPTION: u32 = 40;
const LETTERS: u32 = 21;

/// The colours of the page: paper, ground of the ball, text, quiet text, lines, and the red of what counts.
const PAPER: RGBColor = RGBColor(0xf6, 0xf4, 0xef);
const STAGE: RGBColor = RGBColor(0xe2, 0xdd, 0xd2);
const INK: RGBColor = RGBColor(0x1e, 0x1b, 0x18);
const QUIET: RGBColor = RGBColor(0x6b, 0x64, 0x5c);
const RULE: RGBColor = RGBColor(0xdd, 0xd7, 0xcc);
const ACCENT: RGBColor = RGBColor(0xa3, 0x14, 0x2e);
const GOOD: RGBColor = RGBColor(0x2f, 0x6b, 0x3c);
const FAIR: RGBColor = RGBColor(0x7a, 0x62, 0x18);

/// A part of the picture.
type Area<'a> = DrawingArea<BitMapBackend<'a>, Shift>;

/// 8-bit sRGB, rows from the top.
pub struct Strip {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Three bytes a pixel.
    pub rgb: Vec<u8>,
}

impl Strip {
    /// An empty one.
    fn paper(size: [u32; 2]) -> Self {
        let pixels = (size[0] * size[1]) as usize;
        Self { size, rgb: [PAPER.0, PAPER.1, PAPER.2].repeat(pixels) }
    }

    /// Draws into it.
    fn draw(&mut self, draw: impl FnOnce(&Area<'_>) -> Result<(), Failure>) -> anyhow::Result<()> {
        let size = self.size.into();
        let drawn = || {
            register_font()?;
            let root = BitMapBackend::with_buffer(&mut self.rgb, size).into_drawing_area();
            draw(&root)?;
            root.present()?;
            Ok::<_, Failure>(())
        };
        drawn().map_err(|error| anyhow!("cannot draw the picture: {error}"))
    }

    /// Puts a square of pixels at a place.
    fn put(&mut self, rgb: &[u8], side: u32, [left, top]: [u32; 2]) {
        for (row, from) in rgb.chunks_exact(3 * side as usize).enumerate() {
            let start = 3 * ((top + row as u32) * self.size[0] + left) as usize;
            self.rgb[start..start + from.len()].copy_from_slice(from);
        }
    }
}

/// Draws text in the letters of the picture.
fn text(area: &Area<'_>, text: &str, colour: RGBColor, [x, y]: [u32; 2]) -> Result<(), Failure> {
    let style = TextStyle::from((FONT, LETTERS).into_font()).color(&colour);
    area.draw_text(text, &style, (x as i32, y as i32))?;
    Ok(())
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
    let head = head::draw(subject)?;
    let names = ["fit", subject.against.as_ref().map_or("", |against| against.name), "4 x their difference"];
    let ground = [STAGE.0, STAGE.1, STAGE.2].map(|v| f32::from(v) / 255.0);
    let side = TILE[1] - CAPTION - MARGIN;
    let balls = ball_sheet::balls(subject.ball, subject.ball_beside, &subject.light, (side, ground.into()))?;
    let panels = curves::panels(subject)?;
    let count = balls.tiles.len() + panels.len();
    let mut grid = Strip::paper([WIDTH, TILE[1] * count.div_ceil(2) as u32]);
    let place = |n: usize| [n as u32 % 2 * TILE[0], n as u32 / 2 * TILE[1]];
    for (n, tile) in balls.tiles.iter().enumerate() {
        let [left, top] = place(n);
        grid.put(tile, side, [left + (TILE[0] - side) / 2, top + CAPTION]);
    }
    grid.draw(|root| {
        for (n, _) in balls.tiles.iter().enumerate() {
            let [left, top] = place(n);
            text(root, names[n], INK, [left + (TILE[0] - side) / 2, top + 10])?;
        }
        for (n, panel) in panels.iter().enumerate() {
            let [left, top] = place(balls.tiles.len() + n).map(|v| v as i32);
            curves::draw(&root.clone().shrink((left, top), (TILE[0], TILE[1])), panel)?;
        }
        Ok(())
    })?;
    Ok(stacked(&[head, grid, discs::draw(subject)?]))
}

/// Free pixels on each side of a tile.
const MARGIN: u32 = 16;

/// Draws and writes it.
///
/// # Errors
/// As [`draw`]; names the file that cannot be written.
pub fn write(path: &Path, subject: &Subject<'_>) -> anyhow::Result<()> {
    let block = draw(subject)?;
    picture_file::write_png(path, block.size, &block.rgb)
}

/// Blocks of one width, one below the other.
fn stacked(blocks: &[Strip]) -> Strip {
    let size = [WIDTH, blocks.iter().map(|block| block.size[1]).sum()];
    Strip { size, rgb: blocks.iter().flat_map(|block| block.rgb.iter().copied()).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::truth::stored::StoredMaterial;
    use crate::world::environment::sky;

    #[test]
    fn colours_are_those_of_the_page() {
        let style = include_str!("../../../web/page/style.css");
        for (name, colour) in
            [("paper", PAPER), ("ink", INK), ("quiet", QUIET), ("line", RULE), ("accent", ACCENT)]
                .into_iter()
                .chain([("good", GOOD), ("fair", FAIR)])
        {
            let RGBColor(r, g, b) = colour;
            assert!(style.contains(&format!("--{name}: #{r:02x}{g:02x}{b:02x}")), "{name}");
        }
    }

    #[test]
    fn a_ball_is_as_large_as_the_curves_and_nothing_is_empty() {
        let stored = StoredMaterial::load("garnet_red").unwrap();
        let fit = stored.material.clone();
        let ball = LoadedMaterial::Lobes(stored);
        let environment = sky::haze();
        let light = Light { name: "haze", environment: &environment, samples: 1, stops: 0.0, turn: 0.0 };
        let subject = Subject {
            name: "garnet_red",
            fit: &fit,
            against: None,
            ball: &ball,
            ball_beside: None,
            light,
            verdict: &["use it with care: of words".into(), "off  a criterion".into()],
        };
        let picture = draw(&subject).unwrap();
        let [width, height] = picture.size;
        assert_eq!((width, picture.rgb.len()), (WIDTH, (3 * width * height) as usize));
        // Below the head, each part of 200 pixels has something on it.
        for (top, left) in (1..height / 200).flat_map(|row| [0, 200, 400, 600].map(|left| (200 * row, left)))
        {
            let pixel = |x: u32, y: u32| &picture.rgb[3 * (y * width + x) as usize..][..3];
            let is_paper = |p: &[u8]| p == [PAPER.0, PAPER.1, PAPER.2];
            let all = (top..top + 200).flat_map(|y| (left..left + 200).map(move |x| (x, y)));
            assert!(all.filter(|&(x, y)| !is_paper(pixel(x, y))).count() > 300, "{left} {top} is empty");
        }
    }
}
