//! Maps on a mesh: the material of each place, the share of a second one, and a tint.

use super::environment::file::exr_pixels;
use crate::out::print::{ending, shown};
use anyhow::{Context, bail, ensure};
use glam::{Vec2, Vec3};
use std::io::Cursor;
use std::path::Path;

/// Largest file that is read, bytes.
const MAX_FILE: u64 = 1 << 30;

/// Most materials of a palette: an index has 8 bits.
pub const MAX_MATERIALS: usize = 256;

/// Rows of texels, the top one first, repeated in both directions. Coordinates go to the right and up.
struct Raster<T> {
    width: usize,
    texels: Vec<T>,
}

impl<T: Copy> Raster<T> {
    /// A texel by whole coordinates, to the right and down.
    fn texel(&self, x: i64, y: i64) -> T {
        let (width, height) = (self.width as i64, (self.texels.len() / self.width) as i64);
        self.texels[(y.rem_euclid(height) * width + x.rem_euclid(width)) as usize]
    }

    /// Where coordinates lie, in texels to the right and down.
    fn place(&self, uv: Vec2) -> Vec2 {
        // Far from 0 a float has no digits behind the point, which is a place too.
        let height = (self.texels.len() / self.width) as f32;
        Vec2::new(uv.x - uv.x.floor(), uv.y.ceil() - uv.y) * Vec2::new(self.width as f32, height)
    }

    /// The texel that coordinates lie in.
    fn nearest(&self, uv: Vec2) -> T {
        let place = self.place(uv);
        self.texel(place.x as i64, place.y as i64)
    }
}

impl Raster<Vec3> {
    /// Between the centres of texels.
    fn between(&self, uv: Vec2) -> Vec3 {
        let place = self.place(uv) - 0.5;
        let (corner, part) = (place.floor(), place - place.floor());
        let at = |dx: i64, dy: i64| self.texel(corner.x as i64 + dx, corner.y as i64 + dy);
        at(0, 0).lerp(at(1, 0), part.x).lerp(at(0, 1).lerp(at(1, 1), part.x), part.y)
    }
}

/// The maps of an object.
#[derive(Default)]
pub struct Skin {
    /// Two materials of a palette.
    index: Option<Raster<[u8; 2]>>,
    /// The share of the second, in each channel.
    weight: Option<Raster<Vec3>>,
    /// A factor on all reflected light.
    tint: Option<Raster<Vec3>>,
}

/// Files of maps; each may be missing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Files<'a> {
    /// `.png` of 8 bits: red the first material, green the second; a grey one has one material at each place.
    pub index: Option<&'a Path>,
    /// `.png` or `.exr`: the share of the second material, by its red channel.
    pub weight: Option<&'a Path>,
    /// `.png` in sRGB, or `.exr`, which is linear.
    pub tint: Option<&'a Path>,
}

impl Skin {
    /// Reads the maps of a palette with a number of materials.
    ///
    /// # Errors
    /// Names the file, and the texel whose number is out of range.
    pub fn read(files: Files<'_>, materials: usize) -> anyhow::Result<Self> {
        ensure!(
            (1..=MAX_MATERIALS).contains(&materials),
            "a palette of 1 to {MAX_MATERIALS} materials is expected, found {materials}"
        );
        ensure!(
            files.weight.is_none() || files.index.is_some() || materials > 1,
            "a weight map is the share of a second material, and the palette has one"
        );
        let index = files.index.map(|path| {
            let read = || indices(&srbf_fit::read_at_most(path, MAX_FILE)?, &ending(path), materials);
            read().with_context(|| format!("map {}", shown(path)))
        });
        let colours = |path: &Path, is_colour: bool| {
            let read = || colours(&srbf_fit::read_at_most(path, MAX_FILE)?, &ending(path), is_colour);
            read().with_context(|| format!("map {}", shown(path)))
        };
        Ok(Self {
            index: index.transpose()?,
            weight: files.weight.map(|path| colours(path, false)).transpose()?,
            tint: files.tint.map(|path| colours(path, true)).transpose()?,
        })
    }

    /// The same everywhere: the share of the second of two materials, and a tint.
    #[cfg(test)]
    pub fn even(weight: f32, tint: Vec3) -> Self {
        let all = |value| Some(Raster { width: 1, texels: vec![value] });
        Self { index: None, weight: all(Vec3::splat(weight)), tint: all(tint) }
    }

    /// The material at coordinates, and the tint there. `choice`, uniform in [0, 1), chooses one of two materials by the weight: the mean over
    /// all choices is the weighted sum of both.
    pub fn at(&self, uv: Vec2, choice: f32) -> (usize, Option<Vec3>) {
        let [first, second] = self.index.as_ref().map_or([0, 1], |map| map.nearest(uv));
        let weight = self.weight.as_ref().map_or(0.0, |map| map.between(uv).x);
        let material = if choice < weight { second } else { first };
        (material.into(), self.tint.as_ref().map(|map| map.between(uv)))
    }
}

/// The pixels of a PNG.
fn png(bytes: &[u8]) -> anyhow::Result<image::DynamicImage> {
    let mut reader = image::ImageReader::new(Cursor::new(bytes));
    reader.set_format(image::ImageFormat::Png);
    reader.decode().context("a .png picture is expected")
}

fn indices(bytes: &[u8], ending: &str, materials: usize) -> anyhow::Result<Raster<[u8; 2]>> {
    ensure!(ending == "png", "a name that ends in .png is expected");
    let picture = png(bytes)?;
    let rgb = match &picture {
        image::DynamicImage::ImageLuma8(_)
        | image::DynamicImage::ImageLumaA8(_)
        | image::DynamicImage::ImageRgb8(_)
        | image::DynamicImage::ImageRgba8(_) => picture.to_rgb8(),
        _ => bail!("8 bits a channel are expected: the numbers of materials"),
    };
    let width = rgb.width() as usize;
    let texels: Vec<[u8; 2]> = rgb.pixels().map(|p| [p.0[0], p.0[1]]).collect();
    let wrong = texels.iter().position(|two| two.iter().any(|&i| usize::from(i) >= materials));
    if let Some(n) = wrong {
        let [first, second] = texels[n];
        bail!(
            "column {}, row {}: materials {first} and {second}, of a palette from 0 to {}",
            n % width,
            n / width,
            materials - 1
        );
    }
    Ok(Raster { width, texels })
}

/// Numbers of at least 0. Those of a PNG are decoded from sRGB if they are colours.
fn colours(bytes: &[u8], ending: &str, is_colour: bool) -> anyhow::Result<Raster<Vec3>> {
    let (width, texels) = match ending {
        "png" => {
            let rgb = png(bytes)?.into_rgb32f();
            let decode = |v: f32| {
                if !is_colour {
                    v
                } else if v <= 0.040_45 {
                    v / 12.92
                } else {
                    ((v + 0.055) / 1.055).powf(2.4)
                }
            };
            (
                rgb.width() as usize,
                rgb.pixels().map(|p| Vec3::from_array(p.0.map(decode))).collect::<Vec<_>>(),
            )
        }
        "exr" => exr_pixels(bytes)?,
        _ => bail!("a name that ends in .png or .exr is expected"),
    };
    for (n, texel) in texels.iter().enumerate() {
        let fits = texel.to_array().into_iter().all(|v| (0.0..=1e3).contains(&v));
        ensure!(
            fits,
            "column {}, row {}: {texel}, numbers from 0 to 1000 are expected",
            n % width,
            n / width
        );
    }
    Ok(Raster { width, texels })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encoded(picture: &image::DynamicImage) -> Vec<u8> {
        let mut bytes = Vec::new();
        picture.write_to(&mut Cursor::new(&mut bytes), image::ImageFormat::Png).unwrap();
        bytes
    }

    #[test]
    fn grey_has_one_material_and_colours_have_two() {
        let grey = image::GrayImage::from_raw(2, 1, vec![0, 3]).unwrap();
        let map = indices(&encoded(&grey.into()), "png", 4).unwrap();
        assert_eq!(map.texels, [[0, 0], [3, 3]]);
        let rgb = image::RgbImage::from_raw(1, 2, vec![1, 2, 9, 3, 0, 9]).unwrap();
        let map = indices(&encoded(&rgb.into()), "png", 4).unwrap();
        assert_eq!(map.texels, [[1, 2], [3, 0]]);
        // Up is up.
        assert_eq!([map.nearest(Vec2::new(0.5, 0.9)), map.nearest(Vec2::new(0.5, 0.1))], [[1, 2], [3, 0]]);
        let deep = image::ImageBuffer::<image::Luma<u16>, _>::from_raw(1, 1, vec![1]).unwrap();
        assert!(indices(&encoded(&deep.into()), "png", 4).is_err());
    }

    #[test]
    fn a_number_out_of_the_palette_is_an_error_with_its_place() {
        let grey = image::GrayImage::from_raw(2, 2, vec![0, 1, 2, 1]).unwrap();
        let error = indices(&encoded(&grey.into()), "png", 2).err().unwrap().to_string();
        assert!(error.contains("column 0, row 1"), "{error}");
        assert!(indices(b"no picture", "png", 2).is_err() && colours(b"", "jpg", true).is_err());
    }

    #[test]
    fn one_of_two_is_chosen_by_the_weight() {
        let weight = Raster { width: 2, texels: vec![Vec3::ZERO, Vec3::ONE] };
        let skin = Skin { weight: Some(weight), ..Skin::default() };
        // Between the centres of the two texels the weight is linear.
        for (u, share) in [(0.25, 0.0), (0.5, 0.5), (0.625, 0.75), (0.75, 1.0)] {
            let seconds = (0..1000).filter(|i| skin.at(Vec2::new(u, 0.3), *i as f32 / 1000.0).0 == 1).count();
            assert!((seconds as f32 / 1000.0 - share).abs() < 2e-3, "{u}: {seconds}");
        }
    }

    #[test]
    fn any_coordinates_have_a_texel() {
        let map = Raster { width: 3, texels: (0..6).map(|i| Vec3::splat(i as f32)).collect() };
        for u in [0.0, -0.0, 1.0, -1.0, 0.999_999_94, 1e9, -1e9, 1e-30, -1e-30] {
            for v in [0.0, 1.0, -1e-30, 1e9, 0.5] {
                let uv = Vec2::new(u, v);
                assert!(map.between(uv).is_finite() && map.nearest(uv).x < 6.0, "{uv}");
            }
        }
    }

    #[test]
    fn colours_of_a_png_are_decoded_and_weights_are_not() {
        let grey = image::GrayImage::from_raw(1, 1, vec![188]).unwrap();
        let bytes = encoded(&grey.into());
        let value = |is_colour| colours(&bytes, "png", is_colour).unwrap().texels[0].x;
        assert!((value(true) - 0.503).abs() < 1e-3 && (value(false) - 188.0 / 255.0).abs() < 1e-6);
    }
}
