//! Reads maps: Radiance `.hdr` and OpenEXR `.exr`, by longitude and latitude, or angular, which are converted.
//!
//! An angular map is square, and its directions fill a disc: the centre is the direction that the centre of a latitude-longitude map has
//! (+x), up is up, and the distance from the centre is the angle from it, up to half a turn at the rim (Debevec's light probes).

use super::{Environment, MAX_PIXELS};
use crate::out::print::{ending, shown};
use anyhow::{Context, bail, ensure};
use glam::Vec3;
use image::ImageDecoder;
use std::f32::consts::{PI, TAU};
use std::io::Cursor;
use std::path::Path;

/// Largest file that is read, bytes: four bytes a pixel and channel of the largest map.
const MAX_FILE: u64 = 16 * MAX_PIXELS as u64;

/// How a map shows directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Projection {
    /// Columns are longitudes, rows latitudes.
    LatLong,
    /// The distance from the centre is the angle from its direction.
    Angular,
}

/// Rows of radiance from the top.
struct Map {
    width: usize,
    pixels: Vec<Vec3>,
}

/// Reads a map from a file, its format told by the name's extension.
///
/// # Errors
/// Names the file, and what in it is not as expected.
pub fn read(path: &Path, projection: Projection) -> anyhow::Result<Environment> {
    let open = || from_bytes(&srbf_fit::read_at_most(path, MAX_FILE)?, &ending(path), projection);
    open().with_context(|| format!("environment {}", shown(path)))
}

/// Reads a map from the bytes of a file whose name has an ending, in small letters.
///
/// # Errors
/// Names the fault.
pub fn from_bytes(bytes: &[u8], ending: &str, projection: Projection) -> anyhow::Result<Environment> {
    match ending {
        "hdr" => from_hdr(bytes, projection),
        "exr" => from_exr(bytes, projection),
        _ => bail!("a name that ends in .hdr or .exr is expected"),
    }
}

/// Reads a Radiance picture. Bytes behind the last row are ignored: published probes have a stray one.
fn from_hdr(bytes: &[u8], projection: Projection) -> anyhow::Result<Environment> {
    let decoder =
        image::codecs::hdr::HdrDecoder::new(Cursor::new(bytes)).context("not a Radiance .hdr picture")?;
    let (width, height) = decoder.dimensions();
    check_size(width as usize, height as usize, projection)?;
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
    let pixels = picture.into_rgb32f().pixels().map(|p| Vec3::from_array(p.0) / exposure).collect();
    Map { width: width as usize, pixels }.environment(projection)
}

fn from_exr(bytes: &[u8], projection: Projection) -> anyhow::Result<Environment> {
    let (width, pixels) = exr_pixels(bytes)?;
    check_size(width, pixels.len() / width.max(1), projection)?;
    Map { width, pixels: without_negatives(pixels)? }.environment(projection)
}

/// Reads the first layer of an OpenEXR picture that has R, G and B channels: columns, and rows from the top.
///
/// # Errors
/// Names the fault.
pub fn exr_pixels(bytes: &[u8]) -> anyhow::Result<(usize, Vec<Vec3>)> {
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
                pixels[at.y() * *width + at.x()] = Vec3::new(r, g, b);
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .context("the pixels of the OpenEXR picture (R, G and B channels are expected)")?;
    Ok(picture.layer_data.channel_data.pixels)
}

/// How far below 0 a value may be, over the largest of the map: lossy compression leaves such.
const ROUNDING: f32 = 0.01;

/// Takes values a little below 0 as 0, and says so; refuses others.
fn without_negatives(mut pixels: Vec<Vec3>) -> anyhow::Result<Vec<Vec3>> {
    let largest =
        pixels.iter().map(|pixel| pixel.max_element()).filter(|v| v.is_finite()).fold(0.0, f32::max);
    let mut count = 0u64;
    for (n, pixel) in pixels.iter_mut().enumerate() {
        for value in pixel.as_mut() {
            if *value < 0.0 && value.is_finite() {
                ensure!(*value >= -ROUNDING * largest, "pixel {n}: {value} where a radiance was expected");
                *value = 0.0;
                count += 1;
            }
        }
    }
    if count > 0 {
        eprintln!("srbf: note: {count} values of the map are a little below 0, and count as 0");
    }
    Ok(pixels)
}

impl Map {
    fn environment(self, projection: Projection) -> anyhow::Result<Environment> {
        match projection {
            Projection::LatLong => Environment::new(self.width, self.pixels),
            Projection::Angular => {
                let by_latitude = self.by_latitude()?;
                Environment::new(by_latitude.width, by_latitude.pixels)
            }
        }
    }

    /// An angular map as one by longitude and latitude, as wide: pixels are as far apart along the equator as in the disc.
    fn by_latitude(&self) -> anyhow::Result<Self> {
        let bad = self.pixels.iter().position(|c| !c.is_finite());
        if let Some(i) = bad {
            bail!("the pixel in column {}, row {} is {}", i % self.width, i / self.width, self.pixels[i]);
        }
        let width = 2 * self.width.div_ceil(2);
        let height = width / 2;
        let pixel = |i: usize| {
            let turn = ((i % width) as f32 + 0.5) / width as f32;
            let down = PI * ((i / width) as f32 + 0.5) / height as f32;
            // To the right of the centre, up, and forward, for one who stands inside.
            let (sin, cos) = ((turn - 0.5) * TAU).sin_cos();
            let [right, up, forward] = [down.sin() * sin, down.cos(), down.sin() * cos];
            let across = right.hypot(up);
            let radius = across.atan2(forward) / PI;
            let [x, y] = if across > 0.0 { [right, -up].map(|v| radius * v / across) } else { [radius, 0.0] };
            self.at([x, y].map(|v| 0.5 * (v + 1.0) * self.width as f32 - 0.5))
        };
        Ok(Self { width, pixels: (0..width * height).map(pixel).collect() })
    }

    /// The value at a place of a square map, in pixels from the centre of the first.
    fn at(&self, place: [f32; 2]) -> Vec3 {
        let [x, y] = place.map(|v| v.clamp(0.0, (self.width - 1) as f32));
        let [column, row] = [x, y].map(|v| (v as usize).min(self.width.saturating_sub(2)));
        let [along, down] = [x - column as f32, y - row as f32];
        let pixel = |dx: usize, dy: usize| {
            self.pixels[(row + dy).min(self.width - 1) * self.width + (column + dx).min(self.width - 1)]
        };
        let upper = pixel(0, 0).lerp(pixel(1, 0), along);
        let lower = pixel(0, 1).lerp(pixel(1, 1), along);
        upper.lerp(lower, down)
    }
}

/// Refuses pictures that are too large, and those that by their shape are no such map.
fn check_size(width: usize, height: usize, projection: Projection) -> anyhow::Result<()> {
    check_size_limit(width, height)?;
    match projection {
        Projection::LatLong if width == height => bail!(
            "{width} x {height} pixels: a latitude-longitude map is expected, twice as wide as high; a square one may be an \
             angular map, --env-map angular"
        ),
        Projection::LatLong => ensure!(
            width == 2 * height,
            "{width} x {height} pixels: a latitude-longitude map is expected, twice as wide as high"
        ),
        Projection::Angular => {
            ensure!(width == height, "{width} x {height} pixels: an angular map is expected, as wide as high")
        }
    }
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
    use super::Projection::{Angular, LatLong};
    use super::*;
    use crate::numbers::random::Random;
    use std::sync::atomic::{AtomicU32, Ordering};

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
        // Tests run side by side.
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let name = format!("srbf-test-{}-{}.exr", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let path = std::env::temp_dir().join(name);
        crate::out::picture_file::write_exr(&path, size, pixels).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        std::fs::remove_file(path).unwrap();
        bytes
    }

    #[test]
    fn hdr_values_are_divided_by_the_exposure() {
        let environment = from_hdr(&hdr(), LatLong).unwrap();
        // Up is the first row: mantissa 100.5 / 256 times 2^(129 - 128), over exposure 2.
        let up = environment.radiance(Vec3::Z).x;
        assert!((up - 100.0 / 256.0).abs() < 3e-3, "{up}");
    }

    #[test]
    fn exr_that_was_written_is_read() {
        let pixels: Vec<Vec3> = (0..32).map(|i| Vec3::new(i as f32, 0.5, 1e-3)).collect();
        let environment = from_exr(&exr([8, 4], &pixels), LatLong).unwrap();
        // Straight up the values nearest the pole are blended around; the blue is constant, held beside a red of up to 7.
        let blue = environment.radiance(Vec3::Z).z;
        assert!((blue - 1e-3).abs() < 8e-6 * 7.0, "{blue}");
    }

    #[test]
    fn every_truncation_is_an_error() {
        let hdr = hdr();
        for end in 0..hdr.len() {
            assert!(from_hdr(&hdr[..end], LatLong).is_err(), "hdr {end}");
        }
        let exr = exr([16, 8], &[Vec3::ONE; 128]);
        for end in 0..exr.len() {
            assert!(from_exr(&exr[..end], LatLong).is_err(), "exr {end}");
        }
    }

    #[test]
    fn a_stray_byte_behind_the_pixels_is_harmless() {
        let mut bytes = hdr();
        bytes.push(0);
        assert!(from_hdr(&bytes, LatLong).is_ok());
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
            let _ = if round % 2 == 0 { from_hdr(&bytes, LatLong) } else { from_exr(&bytes, LatLong) };
        }
    }

    #[test]
    fn sizes_and_values_without_meaning_are_refused() {
        for size in
            ["-Y 0 +X 0", "-Y 4294967295 +X 4294967295", "-Y 4096 +X 8192", "-Y 65536 +X 131072", "-Y 8 +X 8"]
        {
            let bytes =
                [b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n", size.as_bytes(), b"\n\x01\x02\x03\x80"].concat();
            assert!(from_hdr(&bytes, LatLong).is_err(), "{size}");
        }
        let mut pixels = [Vec3::ONE; 128];
        pixels[77].y = f32::NAN;
        let error = format!("{:#}", from_exr(&exr([16, 8], &pixels), LatLong).err().unwrap());
        assert!(error.contains("column 13, row 4"), "{error}");
        pixels[77].y = -1.0;
        let error = format!("{:#}", from_exr(&exr([16, 8], &pixels), LatLong).err().unwrap());
        assert!(error.contains("pixel 77: -1 where a radiance was expected"), "{error}");
        pixels[77].y = -0.5 * ROUNDING;
        assert!(from_exr(&exr([16, 8], &pixels), LatLong).is_ok());
        let square = format!("{:#}", from_exr(&exr([9, 9], &[Vec3::ONE; 81]), LatLong).err().unwrap());
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
            let is_angular = name == "funston_beach_probe.hdr";
            let [right, wrong] = if is_angular { [Angular, LatLong] } else { [LatLong, Angular] };
            let result = read(&path, right);
            assert!(result.is_ok(), "{name}: {:#}", result.err().unwrap());
            let text = format!("{:#}", read(&path, wrong).err().unwrap());
            assert!(text.contains(" pixels: ") && text.contains(&name), "{text}");
            loaded += 1;
        }
        assert!(loaded >= 7, "{loaded} maps in the folder");
    }

    #[test]
    fn an_angular_map_has_its_directions_where_they_belong() {
        // Red forward, green to the right, blue up, white behind: the rim.
        let side = 64;
        let near = |x: f32, y: f32, at: [f32; 2]| ((x - at[0]).powi(2) + (y - at[1]).powi(2)) < 0.02;
        let pixels: Vec<Vec3> = (0..side * side)
            .map(|i| {
                let [x, y] = [i % side, i / side].map(|v| 2.0 * (v as f32 + 0.5) / side as f32 - 1.0);
                match () {
                    () if near(x, y, [0.0, 0.0]) => Vec3::X,
                    () if near(x, y, [0.5, 0.0]) => Vec3::Y,
                    () if near(x, y, [0.0, -0.5]) => Vec3::Z,
                    () if x.hypot(y) > 0.9 => Vec3::ONE,
                    () => Vec3::ZERO,
                }
            })
            .collect();
        let environment = from_exr(&exr([64, 64], &pixels), Angular).unwrap();
        for (direction, colour) in
            [(Vec3::X, Vec3::X), (Vec3::NEG_Y, Vec3::Y), (Vec3::Z, Vec3::Z), (Vec3::NEG_X, Vec3::ONE)]
        {
            let found = environment.radiance(direction);
            assert!((found - colour).length() < 0.05, "{direction}: {found}");
        }
        assert!(environment.radiance(Vec3::Y).length() < 0.05);
        let text = format!("{:#}", from_exr(&exr([16, 8], &[Vec3::ONE; 128]), Angular).err().unwrap());
        assert!(text.contains("as wide as high"), "{text}");
    }

    #[test]
    #[ignore = "needs SRBF_DATA_DIR"]
    fn the_published_probe_is_the_published_map() {
        // The same place, as an angular map and by longitude and latitude: they agree if neither is mirrored or turned.
        let folder = std::env::var_os("SRBF_DATA_DIR").expect("SRBF_DATA_DIR names the folder of the data");
        let folder = Path::new(&folder).join("envmaps");
        let probe = read(&folder.join("funston_beach_probe.hdr"), Angular).unwrap();
        let map = read(&folder.join("funston_beach_latlong.hdr"), LatLong).unwrap();
        let mut random = Random::new(4, 0, 0);
        let (mut difference, mut sum) = (0.0, 0.0);
        for _ in 0..20_000 {
            let d = crate::world::sphere_sampling::uniform([random.unit(), random.unit()]);
            difference += (probe.radiance(d) - map.radiance(d)).abs().element_sum();
            sum += map.radiance(d).element_sum();
        }
        assert!(difference < 0.1 * sum, "{} of the mean apart", difference / sum);
    }
}
