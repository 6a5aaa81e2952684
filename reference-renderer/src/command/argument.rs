//! Values of options that several commands take.

use crate::trace::film;
use crate::trace::scene::SceneName;
use crate::world::environment::file::Projection;
use crate::world::environment::{self, Environment};
use anyhow::{Context, bail, ensure};
use glam::Vec3;
use std::path::{Path, PathBuf};

/// Largest radiance of a constant environment: squares of it stay far from the largest f32.
const MAX_CONSTANT: f32 = 1e6;

/// Parses `WIDTHxHEIGHT`.
pub fn size(text: &str) -> Result<[u32; 2], String> {
    let expected =
        || format!("expected WIDTHxHEIGHT, at least 1x1 and at most {} pixels in all", film::MAX_PIXELS);
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(expected)?;
    let [width, height] = [width, height].map(|n| n.parse::<u32>().unwrap_or(0));
    let pixels = u64::from(width) * u64::from(height);
    if (1..=film::MAX_PIXELS).contains(&pixels) { Ok([width, height]) } else { Err(expected()) }
}

/// Parses `X,Y,Z`, finite numbers of at most a million.
pub fn point(text: &str) -> Result<Vec3, String> {
    let numbers: Vec<f32> = text.split(',').filter_map(|n| n.trim().parse().ok()).collect();
    let all = numbers.len() == text.split(',').count() && numbers.iter().all(|v| v.abs() <= MAX_COORDINATE);
    match numbers[..] {
        [x, y, z] if all => Ok(Vec3::new(x, y, z)),
        _ => Err(format!("expected X,Y,Z, three numbers within -{MAX_COORDINATE} to {MAX_COORDINATE}")),
    }
}

/// Largest coordinate of a camera.
const MAX_COORDINATE: f32 = 1e6;

/// The direction at an angle from the viewer of the sphere, above and to the right, as the suns of a verdict stand.
fn beside_viewer(degrees: f32) -> Vec3 {
    let standpoint = SceneName::Sphere.standpoint();
    let back = (standpoint.eye - standpoint.target).normalize();
    let right = Vec3::Z.cross(back).normalize();
    let (sin, cos) = degrees.to_radians().sin_cos();
    cos * back + sin * (0.8 * right + 0.6 * back.cross(right))
}

/// Makes the environment of `sky`, `haze`, `sun:DEGREES`, `constant:VALUE`, or the name of a `.hdr` or `.exr` file of a latitude-longitude map.
pub fn environment(text: &str) -> anyhow::Result<Environment> {
    projected_environment(text, Projection::LatLong)
}

/// The same, with what kind of map a file holds.
pub fn projected_environment(text: &str, projection: Projection) -> anyhow::Result<Environment> {
    match text {
        "sky" => return Ok(environment::sky::sky()),
        "haze" => return Ok(environment::sky::haze()),
        _ => {}
    }
    if let Some(degrees) = text.strip_prefix("sun:") {
        let degrees: Option<f32> = degrees.parse().ok().filter(|v| (0.0..=180.0).contains(v));
        let expected =
            || format!("environment {text}: an angle from 0 to 180 is expected after `sun:`, degrees");
        return Ok(environment::sky::sun_alone(beside_viewer(degrees.with_context(expected)?)));
    }
    if let Some(value) = text.strip_prefix("constant:") {
        let value = value.parse().ok().filter(|v| *v > 0.0 && *v <= MAX_CONSTANT);
        let expected = || {
            format!(
                "environment {text}: a number above 0, at most {MAX_CONSTANT}, is expected after `constant:`"
            )
        };
        return Environment::constant(value.with_context(expected)?);
    }
    let path = Path::new(text);
    if path.extension().is_none() && !path.exists() {
        bail!("environment {text}: expected sky, haze, sun:DEGREES, constant:VALUE, or a .hdr or .exr file");
    }
    environment::file::read(path, projection)
}

/// Refuses stops beyond those that f32 has.
pub fn check_stops(stops: f32) -> anyhow::Result<()> {
    ensure!(stops.abs() <= 64.0, "--exposure {stops}: within -64 to 64 is expected");
    Ok(())
}

/// The folder of the measurements.
pub fn data_folder() -> anyhow::Result<PathBuf> {
    let folder = std::env::var_os("SRBF_DATA_DIR").filter(|folder| !folder.is_empty());
    folder.map(PathBuf::from).context("SRBF_DATA_DIR is not set: it names the folder of the measurements")
}

/// Runs work on the number of threads asked for; 0 is one a processor.
pub fn on_threads<T: Send>(
    threads: usize,
    work: impl FnOnce() -> anyhow::Result<T> + Send,
) -> anyhow::Result<T> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .context("cannot start the threads")?
        .install(work)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(size("640x400"), Ok([640, 400]));
        for text in ["", "640", "x", "0x10", "10x0", "-1x5", "99999x99999", "4294967295x4294967295", "1x1x1"]
        {
            assert!(size(text).is_err(), "{text}");
        }
    }

    #[test]
    fn points() {
        assert_eq!(point("1,-2.5, 3"), Ok(Vec3::new(1.0, -2.5, 3.0)));
        for text in ["", "1", "1,2", "1,2,3,4", "1,x,3", "1,2,3,x", "nan,0,0", "inf,0,0", "1e9,0,0", "1,2,"] {
            assert!(point(text).is_err(), "{text}");
        }
    }

    #[test]
    fn environments() {
        assert!(environment("sky").is_ok());
        assert!(environment("constant:0.5").is_ok());
        for text in
            ["constant:", "constant:x", "constant:-1", "constant:nan", "constant:inf", "nowhere", "no.hdr"]
        {
            let error = format!("{:#}", environment(text).err().expect(text));
            assert!(error.contains(text), "{error}");
        }
    }
}
