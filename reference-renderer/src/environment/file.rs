//! Reads latitude-longitude maps: Radiance `.hdr` and OpenEXR `.exr`.

use super::{Environment, MAX_PIXELS};
use anyhow::{Context, bail, ensure};
use glam::Vec3;
use image::ImageDecoder;
use std::io::Cursor;
use std::path::Path;

/// Largest file that is read, bytes: four bytes a pixel and channel of the largest map.
const MAX_FILE: u64 = 16 * MAX_PIXELS as u64;

/// Reads a map from a file, its format told by the name's extension.
///
/// # Errors
/// Names the file, and what in it is not as expected.
pub fn read(path: &Path) -> anyhow::Result<Environment> {
    let open = || -> anyhow::Result<Environment> {
        let size = std::fs::metadata(path)?.len();
        ensure!(size <= MAX_FILE, "the file has {size} bytes, at most {MAX_FILE} are read");
        let bytes = std::fs::read(path)?;
        match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
            Some("hdr") => from_hdr(&bytes),
            Some("exr") => from_exr(&bytes),
            _ => bail!("a name that ends in .hdr or .exr is expected"),
        }
    };
    open().with_context(|| format!("environment {}", path.display()))
}

/// Reads a Radiance picture. Bytes behind the last row are ignored: published probes have a stray one.
fn from_hdr(bytes: &[u8]) -> anyhow::Result<Environment> {
    let decoder =
        image::codecs::hdr::HdrDecoder::new(Cursor::new(bytes)).context("not a Radiance .hdr picture")?;
    let (width, height) = decoder.dimensions();
    check_size(width as usize, height as usize)?;
    // A row takes at least four bytes, whatever its compression.
    ensure!(
        bytes.len() / 4 >= height as usize,
        "{height} rows are announced, {} bytes are too few",
        bytes.len()
    );
    let exposure = decoder.metadata().exposure.unwrap_or(1.0);
    ensure!(exposure.is_finite() && exposure > 0.0, "EXPOSURE is {exposure}: a positive number is expected");
    let picture = image::DynamicImage::from_decoder(decoder).context("the pixels of the .hdr picture")?;
    let pixels = picture.to_rgb32f().pixels().map(|p| Vec3::from_array(p.0) / exposure).collect();
    Environment::new(width as usize, pixels)
}

/// Reads the first layer of an OpenEXR picture that has R, G and B channels.
fn from_exr(bytes: &[u8]) -> anyhow::Result<Environment> {
    use exr::prelude::{ReadChannels, ReadLayers};
    let headers = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false)
        .context("not an OpenEXR picture")?
        .headers;
    for header in &headers {
        check_size_limit(header.layer_size.width(), header.layer_size.height())?;
    }
    let picture = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| (size.width(), vec![Vec3::ZERO; size.area()]),
            |(width, pixels): &mut (usize, Vec<Vec3>), at, (r, g, b): (f32, f32, f32)| {
                // Lossy compression leaves values a little below 0.
                let clean = |v: f32| if v < 0.0 && v.is_finite() { 0.0 } else { v };
                pixels[at.y() * *width + at.x()] = Vec3::new(clean(r), clean(g), clean(b));
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .context("the pixels of the OpenEXR picture (R, G and B channels are expected)")?;
    let (width, pixels) = picture.layer_data.channel_data.pixels;
    check_size(width, pixels.len() / width.max(1))?;
    Environment::new(width, pixels)
}

/// Refuses what is too large, and what by its shape is not a latitude-longitude map.
fn check_size(width: usize, height: usize) -> anyhow::Result<()> {
    check_size_limit(width, height)?;
    ensure!(
        width == 2 * height,
        "{width} x {height} pixels: a latitude-longitude map is expected, twice as wide as high"
    );
    Ok(())
}

fn check_size_limit(width: usize, height: usize) -> anyhow::Result<()> {
    let pixels = width.checked_mul(height);
    ensure!(
        pixels.is_some_and(|n| n > 0 && n <= MAX_PIXELS),
        "{width} x {height} pixels: at least 1 and at most {MAX_PIXELS} are expected"
    );
    Ok(())
}
