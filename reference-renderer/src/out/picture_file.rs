//! Finished pictures as files: linear OpenEXR, and a tone-mapped PNG to look at.

use crate::out::output;
use crate::out::print::shown;
use anyhow::Context;
use glam::Vec3;
use std::io::Cursor;
use std::path::Path;

/// Writes linear radiance, rows from the top, as OpenEXR with 32-bit floats.
///
/// # Errors
/// Names the file.
pub fn write_exr(path: &Path, [width, height]: [u32; 2], pixels: &[Vec3]) -> anyhow::Result<()> {
    use exr::prelude::{Encoding, Image, Layer, LayerAttributes, SpecificChannels, WritableImage};
    let size = (width as usize, height as usize);
    let channels = SpecificChannels::rgb(|at: exr::math::Vec2<usize>| {
        let Vec3 { x, y, z } = pixels[at.y() * size.0 + at.x()];
        (x, y, z)
    });
    let attributes = LayerAttributes { software_name: Some("srbf".into()), ..LayerAttributes::default() };
    let layer = Layer::new(size, attributes, Encoding::FAST_LOSSLESS, channels);
    let mut bytes = Vec::new();
    Image::from_layer(layer)
        .write()
        .non_parallel()
        .to_buffered(Cursor::new(&mut bytes))
        .with_context(|| format!("cannot encode {}", shown(path)))?;
    output::write(path, &bytes)
}

/// Share of the pixels that are darker than nearly white in the PNG.
const BRIGHT_SHARE: f64 = 0.95;

/// The factor that brings the brightest pixels, but for a twentieth of them, to where the tone map begins to compress.
pub fn automatic_exposure(pixels: &[Vec3]) -> f32 {
    let mut bright: Vec<f32> = pixels.iter().map(|&p| srbf_core::luminance(p)).collect();
    let place = (BRIGHT_SHARE * bright.len() as f64) as usize;
    let Some(place) = place.checked_sub(usize::from(place == bright.len())) else { return 1.0 };
    let (_, &mut value, _) = bright.select_nth_unstable_by(place, f32::total_cmp);
    if value > 0.0 && value.is_finite() { 0.8 / value } else { 1.0 }
}

/// Writes a tone-mapped PNG; `exposure` scales the radiance first.
///
/// # Errors
/// Names the file.
pub fn write_tone_mapped_png(
    path: &Path,
    size: [u32; 2],
    pixels: &[Vec3],
    exposure: f32,
) -> anyhow::Result<()> {
    write_png(path, size, &tone_mapped(pixels, exposure))
}

/// Bytes of tone-mapped sRGB; `exposure` scales the radiance first.
pub fn tone_mapped(pixels: &[Vec3], exposure: f32) -> Vec<u8> {
    pixels.iter().flat_map(|&p| to_bytes(displayed(p * exposure))).collect()
}

/// Writes a PNG of 8-bit sRGB pixels.
///
/// # Errors
/// Names the file.
pub fn write_png(path: &Path, size: [u32; 2], rgb: &[u8]) -> anyhow::Result<()> {
    let bytes = encode_png(size, rgb).with_context(|| shown(path))?;
    output::write(path, &bytes)
}

/// Bytes of the signature and of the head of a PNG file.
const HEAD: usize = 33;

/// The chunk that says what wrote the file: length, kind and text, checksum.
const SOFTWARE: &[u8; 25] = b"\x00\x00\x00\x0dtEXtSoftware\x00srbf\xe7J\xd9\x8f";

/// The bytes of a PNG file of 8-bit sRGB pixels.
///
/// # Errors
/// A size that is not that of the pixels.
pub fn encode_png([width, height]: [u32; 2], rgb: &[u8]) -> anyhow::Result<Vec<u8>> {
    use image::ImageEncoder;
    let mut bytes = Vec::new();
    image::codecs::png::PngEncoder::new(&mut bytes)
        .write_image(rgb, width, height, image::ExtendedColorType::Rgb8)
        .context("cannot encode a picture")?;
    // Behind the signature and the head, whose lengths are fixed.
    bytes.splice(HEAD..HEAD, *SOFTWARE);
    Ok(bytes)
}

/// Maps radiance into [0, 1]: colours up to 0.8 keep their hue and nearly their value, brighter ones are compressed
/// and run towards white.
///
/// Source: Khronos 2024, "PBR Neutral" tone mapper.
fn tone_map(radiance: Vec3) -> Vec3 {
    const START: f32 = 0.8 - 0.04;
    const DESATURATION: f32 = 0.15;
    let low = radiance.min_element();
    let offset = if low < 0.08 { low - 6.25 * low * low } else { 0.04 };
    let colour = radiance - offset;
    let peak = colour.max_element();
    if peak < START {
        return colour;
    }
    let room = 1.0 - START;
    let new_peak = 1.0 - room * room / (peak + room - START);
    let white = 1.0 - 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    (colour * (new_peak / peak)).lerp(Vec3::splat(new_peak), white)
}

/// A radiance as a display shows it: tone-mapped, sRGB values from 0 to 1. Here, and only here, negative channels become 0.
pub fn displayed(radiance: Vec3) -> Vec3 {
    let curve = |v: f32| if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
    tone_map(radiance.max(Vec3::ZERO)).clamp(Vec3::ZERO, Vec3::ONE).map(curve)
}

/// Bytes of a colour of a display, each channel from 0 to 1.
pub fn to_bytes(shown: Vec3) -> [u8; 3] {
    shown.to_array().map(|v| (255.0 * v).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tone_map_is_monotonic_and_ends_below_one() {
        let mut previous = -1.0;
        for i in 0..2000 {
            let value = tone_map(Vec3::splat(1e-3 * 1.01f32.powi(i))).x;
            assert!(value >= previous && value <= 1.0, "{i}: {value}");
            previous = value;
        }
        assert_eq!(automatic_exposure(&[]), 1.0);
        assert_eq!(automatic_exposure(&[Vec3::ZERO]), 1.0);
        assert_eq!(automatic_exposure(&[Vec3::ONE; 7]), 0.8);
        assert_eq!(to_bytes(displayed(Vec3::ZERO)), [0; 3]);
        assert_eq!(to_bytes(displayed(Vec3::splat(1e9))), [255; 3]);
        assert_eq!(displayed(Vec3::new(-0.3, 0.2, -0.1)), displayed(Vec3::new(0.0, 0.2, 0.0)));
    }
}
