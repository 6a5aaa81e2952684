//! Balls side by side in one picture, with their difference and a line of text above and below.

use crate::out::panel::{FONT, Failure, register_font};
use crate::out::picture_file::{displayed, to_bytes};
use crate::out::progress::Progress;
use crate::shade::shader::LoadedMaterial;
use crate::trace::ball::{self, BallPixel};
use crate::world::environment::Environment;
use anyhow::{Context, anyhow};
use glam::{DVec3, Vec3};
use plotters::prelude::*;

/// Sides of a ball's square, pixels.
const SIDE: u32 = 256;

/// Height of a line of text, and of its letters, pixels.
const LINE: u32 = 22;
const LETTERS: u32 = 14;

/// Samples a pixel of two balls: each is a direction of the light and one of each material, so that a sheet takes 5 to 8 s on
/// two cores.
pub const SAMPLES: u32 = 128;

/// Factor on a difference on the display.
const MAGNIFIED: f32 = 4.0;

/// The display's value behind the balls.
const BACKGROUND: f32 = 0.16;

/// The display's value of no difference.
const EQUAL: f32 = 0.5;

/// Two balls in numbers: differences over the balls, in linear radiance, over the mean radiance of the second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Mean of the absolute difference.
    pub mean: f64,
    /// Root of the mean square.
    pub root_mean_square: f64,
}

/// A finished picture.
pub struct Sheet {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// 8-bit sRGB, rows from the top.
    pub rgb: Vec<u8>,
    /// How far two balls are apart.
    pub difference: Option<Difference>,
}

/// The light of a sheet, and how balls lie in it.
pub struct Light<'a> {
    /// Its name.
    pub name: &'a str,
    /// The light.
    pub environment: &'a Environment,
    /// Samples a pixel.
    pub samples: u32,
    /// Stops to brighten by, from the exposure of the light.
    pub stops: f32,
    /// Degrees by which the samples are turned about their normals.
    pub turn: f32,
}

impl Light<'_> {
    /// The factor on radiance, the same for all materials.
    pub fn exposure(&self) -> f32 {
        self.environment.exposure() * self.stops.exp2()
    }
}

/// Squares of balls: the material, or the material, the other one, and their difference on the display.
pub struct Balls {
    /// 8-bit sRGB, rows from the top.
    pub tiles: Vec<Vec<u8>>,
    /// How far two balls are apart.
    pub difference: Option<Difference>,
}

/// Renders squares, `side` pixels wide, with a colour of the display behind the balls.
///
/// # Errors
/// Radiance that is not finite.
pub fn balls(
    material: &LoadedMaterial,
    against: Option<&LoadedMaterial>,
    light: &Light<'_>,
    (side, ground): (u32, Vec3),
) -> anyhow::Result<Balls> {
    let progress = Progress::new("balls", side.into());
    let &Light { environment, samples, turn, .. } = light;
    let exposure = light.exposure();
    let shown = |radiance: Vec3| displayed(radiance * exposure);
    let Some(other) = against else {
        let pixels = ball::render([material.shader()], environment, [side, samples], turn, &progress)
            .with_context(|| format!("material {}", material.name()))?;
        return Ok(Balls { tiles: vec![tile(&pixels, |p| shown(p.radiance[0]), ground)], difference: None });
    };
    let shaders = [material.shader(), other.shader()];
    let pixels = ball::render(shaders, environment, [side, samples], turn, &progress)
        .with_context(|| format!("materials {} and {}", material.name(), other.name()))?;
    let apart = |p: &BallPixel<2>| {
        let [ours, theirs] = p.radiance.map(shown);
        (EQUAL + MAGNIFIED * (ours - theirs)).clamp(Vec3::ZERO, Vec3::ONE)
    };
    let [left, right] = [0, 1].map(|k| tile(&pixels, |p| shown(p.radiance[k]), ground));
    let tiles = vec![left, right, tile(&pixels, apart, Vec3::splat(EQUAL))];
    Ok(Balls { tiles, difference: Some(difference(&pixels)) })
}

/// Draws a ball of a material; or two, and their difference.
///
/// # Errors
/// As [`balls`]; faults of the font.
pub fn draw(
    material: &LoadedMaterial,
    against: Option<&LoadedMaterial>,
    light: &Light<'_>,
) -> anyhow::Result<Sheet> {
    let Balls { tiles, difference } = balls(material, against, light, (SIDE, Vec3::splat(BACKGROUND)))?;
    let stops = if light.stops == 0.0 { String::new() } else { format!(", {:+} stops", light.stops) };
    let mut below = format!("light {}{stops}, {} samples", light.name, light.samples);
    if let Some(found) = difference {
        below += &format!(
            "; mean difference {:.2} % of the mean radiance, root mean square {:.2} %",
            100.0 * found.mean,
            100.0 * found.root_mean_square
        );
    }
    let titles = [Some(material.title()), against.map(LoadedMaterial::title)];
    let third = (tiles.len() > 2).then(|| format!("left - right, x {MAGNIFIED}, grey is 0"));
    let titles: Vec<String> = titles.into_iter().flatten().chain(third).collect();
    compose(&titles, &tiles, &below, difference)
}

/// Numbers of two balls.
fn difference(pixels: &[BallPixel<2>]) -> Difference {
    let (mut radiance, mut absolute, mut squares, mut area) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, 0.0);
    for pixel in pixels {
        let [ours, theirs] = pixel.radiance.map(Vec3::as_dvec3);
        let coverage = f64::from(pixel.coverage);
        let apart = (ours - theirs).abs();
        radiance += coverage * theirs;
        absolute += coverage * apart;
        squares += coverage * apart * apart;
        area += coverage;
    }
    // Of a black ball, every difference is infinitely large.
    let mean = radiance.element_sum() / (3.0 * area);
    Difference {
        mean: absolute.element_sum() / (3.0 * area) / mean,
        root_mean_square: (squares.element_sum() / (3.0 * area)).sqrt() / mean,
    }
}

/// A ball's square: each pixel as the display shows it, before a background.
fn tile<const N: usize>(
    pixels: &[BallPixel<N>],
    shown: impl Fn(&BallPixel<N>) -> Vec3,
    ground: Vec3,
) -> Vec<u8> {
    pixels.iter().flat_map(|pixel| to_bytes(ground.lerp(shown(pixel), pixel.coverage))).collect()
}

/// Puts squares side by side, each with its text above, and a text below.
fn compose(
    titles: &[String],
    tiles: &[Vec<u8>],
    below: &str,
    difference: Option<Difference>,
) -> anyhow::Result<Sheet> {
    let size @ [width, height] = [SIDE * tiles.len() as u32, SIDE + 2 * LINE];
    let mut rgb: Vec<u8> = vec![to_bytes(Vec3::splat(BACKGROUND))[0]; (3 * width * height) as usize];
    for (column, tile) in tiles.iter().enumerate() {
        for (y, row) in tile.chunks_exact(3 * SIDE as usize).enumerate() {
            let start = 3 * ((LINE as usize + y) * width as usize + column * SIDE as usize);
            rgb[start..start + row.len()].copy_from_slice(row);
        }
    }
    let texts = titles.iter().enumerate().map(|(n, text)| (text.as_str(), [n as u32 * SIDE, 0], SIDE));
    let texts: Vec<_> = texts.chain([(below, [0, LINE + SIDE], width)]).collect();
    write_texts(&mut rgb, size, &texts).map_err(|error| anyhow!("cannot write the captions: {error}"))?;
    Ok(Sheet { size, rgb, difference })
}

/// Writes texts, each from a corner on over a width; longer ones are cut.
fn write_texts(rgb: &mut [u8], size: [u32; 2], texts: &[(&str, [u32; 2], u32)]) -> Result<(), Failure> {
    register_font()?;
    let root = BitMapBackend::with_buffer(rgb, size.into()).into_drawing_area();
    let style = TextStyle::from((FONT, LETTERS).into_font()).color(&RGBColor(225, 225, 225));
    let margin = (LINE - LETTERS) / 2;
    for &(text, [x, y], width) in texts {
        let mut cut = text.to_owned();
        while !cut.is_empty() && root.estimate_text_size(&cut, &style)?.0 + 2 * margin > width {
            cut.pop();
        }
        root.draw_text(&cut, &style, ((x + margin) as i32, (y + margin) as i32))?;
    }
    root.present()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::environment::{WHITE, sky};

    fn sheet(material: &str, against: Option<&str>) -> Sheet {
        let load = |name: &str| LoadedMaterial::load(name).unwrap();
        let against = against.map(load);
        let light = Light { name: "haze", environment: &sky::haze(), samples: 2, stops: 0.0, turn: 0.0 };
        draw(&load(material), against.as_ref(), &light).unwrap()
    }

    #[test]
    fn lobes_that_are_the_model_do_not_differ_from_it_and_others_do() {
        // The built-in grey has the albedo 1/2.
        let same = sheet("matte", Some("model:lambert:albedo=0.5"));
        assert_eq!(same.size, [3 * SIDE, SIDE + 2 * LINE]);
        assert_eq!(same.rgb.len(), (3 * same.size[0] * same.size[1]) as usize);
        assert!(same.difference.unwrap().root_mean_square < 1e-5, "{:?}", same.difference);
        let third = |sheet: &Sheet| {
            let row = (LINE + SIDE / 2) as usize * sheet.size[0] as usize;
            let start = 3 * (row + 2 * SIDE as usize);
            sheet.rgb[start..start + 3 * SIDE as usize].to_vec()
        };
        assert!(third(&same).iter().all(|v| v.abs_diff(128) <= 1));
        let brighter = sheet("matte", Some("model:lambert:albedo=0.4"));
        let found = brighter.difference.unwrap();
        assert!((found.mean - 0.25).abs() < 1e-4, "{found:?}");
        assert!(third(&brighter).iter().filter(|v| **v > 140).count() > 200);
    }

    #[test]
    fn a_ball_has_the_exposure_of_its_light_whatever_stands_beside_it() {
        let environment = Environment::constant(3.0).unwrap();
        let light = Light { name: "constant", environment: &environment, samples: 64, stops: 0.0, turn: 0.0 };
        let [matte, dark] =
            ["matte", "model:lambert:albedo=0.05"].map(|name| LoadedMaterial::load(name).unwrap());
        let middle = |tile: &[u8]| tile[tile.len() / 2 + 3 * SIDE as usize / 2];
        let of = |material, against| balls(material, against, &light, (SIDE, Vec3::ZERO)).unwrap().tiles;
        let (alone, beside) = (of(&matte, None), of(&matte, Some(&dark)));
        let expected = to_bytes(displayed(Vec3::splat(0.5 * WHITE)))[0];
        for shown in [middle(&alone[0]), middle(&beside[0])] {
            assert!(shown.abs_diff(expected) <= 4, "{shown} {expected}");
        }
        assert!(middle(&beside[1]) < expected / 2);
    }

    #[test]
    fn one_ball_has_a_square_and_texts() {
        let one = sheet("garnet_red", None);
        assert_eq!((one.size, one.difference), ([SIDE, SIDE + 2 * LINE], None));
        let lines = [0..LINE, LINE + SIDE..2 * LINE + SIDE];
        for rows in lines {
            let bytes = &one.rgb[(3 * SIDE * rows.start) as usize..(3 * SIDE * rows.end) as usize];
            assert!(bytes.iter().filter(|v| **v > 150).count() > 100, "no letters");
        }
    }
}
