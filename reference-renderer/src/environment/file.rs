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
        let bytes = srbf_fit::read_at_most(path, MAX_FILE)?;
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
    let picture = image::DynamicImage::from_decoder(decoder).with_context(|| {
        format!("{width} x {height} pixels are announced, and the file ends early or is damaged")
    })?;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// A small map in new-style run lengths is impossible below 8 columns: 16 x 8, rows of four runs each.
    fn hdr() -> Vec<u8> {
        let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n-Y 8 +X 16\n".to_vec();
        for row in 0..8u8 {
            bytes.extend([2, 2, 0, 16]);
            for value in [100 + row, 50, 25, 129] {
                bytes.extend([128 + 16, value]);
            }
        }
        bytes
    }

    fn exr(size: [u32; 2], pixels: &[Vec3]) -> Vec<u8> {
        let name = format!("srbf-test-{}-{}.exr", std::process::id(), size[0]);
        let path = std::env::temp_dir().join(name);
        crate::picture_file::write_exr(&path, size, pixels).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        std::fs::remove_file(path).unwrap();
        bytes
    }

    #[test]
    fn hdr_values_are_divided_by_the_exposure() {
        let environment = from_hdr(&hdr()).unwrap();
        // Up is the first row: mantissa 100.5 / 256 times 2^(129 - 128), over exposure 2.
        let up = environment.radiance(Vec3::Z).x;
        assert!((up - 100.0 / 256.0).abs() < 3e-3, "{up}");
    }

    #[test]
    fn exr_that_was_written_is_read() {
        let pixels: Vec<Vec3> = (0..32).map(|i| Vec3::new(i as f32, 0.5, 1e-3)).collect();
        let environment = from_exr(&exr([8, 4], &pixels)).unwrap();
        // Straight up the values nearest the pole are blended around; the blue is constant, held beside a red of up to 7.
        let blue = environment.radiance(Vec3::Z).z;
        assert!((blue - 1e-3).abs() < 8e-6 * 7.0, "{blue}");
    }

    #[test]
    fn every_truncation_is_an_error() {
        let hdr = hdr();
        for end in 0..hdr.len() {
            assert!(from_hdr(&hdr[..end]).is_err(), "hdr {end}");
        }
        let exr = exr([16, 8], &[Vec3::ONE; 128]);
        for end in 0..exr.len() {
            assert!(from_exr(&exr[..end]).is_err(), "exr {end}");
        }
    }

    #[test]
    fn a_stray_byte_behind_the_pixels_is_harmless() {
        let mut bytes = hdr();
        bytes.push(0);
        assert!(from_hdr(&bytes).is_ok());
    }

    #[test]
    fn damaged_bytes_never_panic() {
        let mut random = Random::new(21, 0, 0);
        let originals = [hdr(), exr([32, 16], &[Vec3::splat(0.7); 512])];
        for round in 0..4000 {
            let mut bytes = originals[round % 2].clone();
            for _ in 0..=random.below(3) {
                let at = random.below(bytes.len() as u32) as usize;
                bytes[at] = random.bits() as u8;
            }
            // Any value or any error will do.
            let _ = if round % 2 == 0 { from_hdr(&bytes) } else { from_exr(&bytes) };
        }
    }

    #[test]
    fn sizes_and_values_without_meaning_are_refused() {
        for size in
            ["-Y 0 +X 0", "-Y 4294967295 +X 4294967295", "-Y 4096 +X 8192", "-Y 65536 +X 131072", "-Y 8 +X 8"]
        {
            let bytes =
                [b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n", size.as_bytes(), b"\n\x01\x02\x03\x80"].concat();
            assert!(from_hdr(&bytes).is_err(), "{size}");
        }
        let mut pixels = [Vec3::ONE; 128];
        pixels[77].y = f32::NAN;
        let error = format!("{:#}", from_exr(&exr([16, 8], &pixels)).err().unwrap());
        assert!(error.contains("column 13, row 4"), "{error}");
        let square = format!("{:#}", from_exr(&exr([9, 9], &[Vec3::ONE; 81])).err().unwrap());
        assert!(square.contains("twice as wide as high"), "{square}");
    }

    #[test]
    #[ignore = "needs SRBF_DATA_DIR"]
    fn published_maps_load() {
        let folder = std::env::var_os("SRBF_DATA_DIR").expect("SRBF_DATA_DIR names the folder of the data");
        let mut loaded = 0;
        for entry in std::fs::read_dir(Path::new(&folder).join("envmaps")).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            match (name.as_str(), read(&path)) {
                // An angular map, square: decoded to its end, and refused by its shape.
                ("funston_beach_probe.hdr", Err(error)) => {
                    let text = format!("{error:#}");
                    assert!(text.contains("640 x 640") && text.contains(&name), "{text}");
                }
                (_, result) => assert!(result.is_ok(), "{name}: {:#}", result.err().unwrap()),
            }
            loaded += 1;
        }
        assert!(loaded >= 7, "{loaded} maps in the folder");
    }
}
