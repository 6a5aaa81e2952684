//! Materials by name: the embedded presets, a matte grey, and `.srbf` files.

use anyhow::{Context, bail};
use srbf_core::{Line, Material, PlaneLobe, Quarter, Sheet, View, color_differences, read_file};
pub use srbf_evaluator::QUARTERS;
use srbf_evaluator::Surface;
use std::borrow::Cow;
use std::path::Path;

/// The presets: name and `.srbf` bytes.
pub const PRESETS: &[(&str, &[u8])] = &[
    ("garnet_red", include_bytes!("../../presets/garnet_red.srbf")),
    ("krylon_blue", include_bytes!("../../presets/krylon_blue.srbf")),
    ("cayman", include_bytes!("../../presets/cayman.srbf")),
];

/// The material that is rendered where none is named.
pub const DEFAULT: &str = "garnet_red";

/// Name of the built-in material without a highlight.
pub const MATTE: &str = "matte";

/// The bytes of a preset, or those of a file.
pub type Bytes = Cow<'static, [u8]>;

/// The file and the quarter of a sheet that a name such as `cloth.srbf:front-transmission` stands for.
fn quarter_of(name: &str) -> Option<(&Path, Quarter)> {
    let (path, quarter) = name.rsplit_once(':')?;
    let place = QUARTERS.iter().position(|own| *own == quarter)?;
    Some((Path::new(path), Quarter::ALL[place]))
}

/// Whether a name is that of a fit, or of a quarter of one.
pub fn is_fit(name: &Path) -> bool {
    let text = name.to_string_lossy();
    let path = quarter_of(&text).map_or(name, |(path, _)| path);
    path.extension().is_some_and(|end| end.eq_ignore_ascii_case("srbf"))
}

/// The material or the sheet of a file of at most `most` bytes; the material of a quarter that is named.
///
/// # Errors
/// Names the file and the place in it.
pub fn surface(name: &Path, most: u64) -> anyhow::Result<Surface<Vec<u8>>> {
    let text = name.to_string_lossy();
    let (path, quarter) = quarter_of(&text).map_or((name, None), |(path, quarter)| (path, Some(quarter)));
    let read = || {
        let bytes = srbf_fit::read_at_most(path, most)?;
        let Some(quarter) = quarter else { return anyhow::Ok(Surface::from_bytes(bytes)?) };
        let sheet = Sheet::from_bytes(bytes)?;
        let material = sheet.quarter(quarter).context("this quarter of the sheet is black")?;
        Ok(Surface::Material(Material::from_bytes(material.bytes().to_vec())?))
    };
    read().with_context(|| name.display().to_string())
}

/// A material and its name.
#[derive(Clone, Debug)]
pub struct StoredMaterial {
    /// Name of the preset, or of the file without folder and extension.
    pub name: String,
    /// The material itself.
    pub material: Material<Bytes>,
}

impl StoredMaterial {
    /// Finds a material by the name of a preset, or reads a `.srbf` file.
    ///
    /// # Errors
    /// Names the file and the place in it; or says which presets there are.
    pub fn load(name: &str) -> anyhow::Result<Self> {
        if let Some(&(name, bytes)) = PRESETS.iter().find(|preset| preset.0 == name) {
            return Self::new(name, Cow::Borrowed(bytes));
        }
        if name == MATTE {
            return Self::matte(name, [0.5; 3]);
        }
        let path = Path::new(name);
        if !path.exists() && path.extension().is_none() {
            let presets: Vec<&str> = PRESETS.iter().map(|preset| preset.0).chain([MATTE]).collect();
            bail!(
                "material {name}: expected a .srbf file, a table that `fit` reads, or one of {}",
                presets.join(", ")
            );
        }
        let (path, quarter) = quarter_of(name).map_or((path, None), |(path, quarter)| (path, Some(quarter)));
        let read = || {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy();
            let bytes = read_file(path)?;
            let Some(quarter) = quarter else { return Self::new(&stem, Cow::Owned(bytes)) };
            let sheet = Sheet::from_bytes(bytes)?;
            let material = sheet.quarter(quarter).context("this quarter of the sheet is black")?;
            Self::new(&stem, Cow::Owned(material.bytes().to_vec()))
        };
        read().with_context(|| format!("material {name}"))
    }

    /// Makes what scatters by Lambert's law with an albedo, linear sRGB above 0.
    ///
    /// # Errors
    /// An albedo that cannot be stored.
    pub fn matte(name: &str, albedo: [f32; 3]) -> anyhow::Result<Self> {
        Self::new(name, Cow::Owned(matte(albedo)))
    }

    /// Takes the bytes of a material.
    ///
    /// # Errors
    /// Bytes that are no material.
    pub fn new(name: &str, bytes: Bytes) -> anyhow::Result<Self> {
        Ok(Self { name: name.to_owned(), material: Material::from_bytes(bytes)? })
    }
}

/// Makes what scatters by Lambert's law: a diffuse term, and the one lobe that a material must
/// have so dark that no f32 shows it; still darker, its products would be subnormal and slow.
fn matte(albedo: [f32; 3]) -> Vec<u8> {
    let (log2_diffuse, diffuse_color_differences) = color_differences(albedo.map(f32::log2));
    let lobe = PlaneLobe {
        angle: 0.0,
        off_plane: 0.0,
        log2_sharpness: 0.0,
        log2_luminance: -60.0,
        color_differences: [0.0; 2],
    };
    let view =
        View { theta: 0.0, log2_squeeze: 0.0, log2_diffuse, diffuse_color_differences, lobes: &[lobe] };
    let line = Line { views: &[view], squeezed: 0, mirrored: 0, factors: None };
    let [red, green, blue] = albedo;
    let provenance = format!("built in: Lambert's law, albedo {red}/{green}/{blue}");
    let mut bytes = vec![0; line.encoded_len(&provenance)];
    line.encode(&provenance, &mut bytes).expect("the numbers are in range");
    bytes
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use srbf_core::{Grid, GridView, TiltedLobe};

    /// A red lacquer for tests: a diffuse term, a wide lobe, and a highlight that grows and narrows towards grazing.
    pub fn lacquer() -> StoredMaterial {
        let lobes: Vec<[PlaneLobe; 3]> = (0..=8)
            .map(|v| {
                let theta = v as f32 * 10f32.to_radians();
                let lobe = |angle: f32, sharpness: f32, rgb: [f32; 3]| {
                    let integral = srbf_core::special::sphere_integral(sharpness);
                    let (log2_luminance, color_differences) =
                        color_differences(rgb.map(|c| (c / integral).log2()));
                    PlaneLobe {
                        angle,
                        off_plane: 0.0,
                        log2_sharpness: sharpness.log2(),
                        log2_luminance,
                        color_differences,
                    }
                };
                let grazing = 0.04 + 0.4 * (1.0 - theta.cos()).powi(3);
                [
                    lobe(theta, 300.0, [grazing; 3]),
                    lobe(theta, 30.0, [0.5 * grazing; 3]),
                    lobe(0.1 * theta, 2.3, [0.35, 0.03, 0.03]),
                ]
            })
            .collect();
        let (log2_diffuse, diffuse_color_differences) =
            color_differences([0.05f32, 0.01, 0.01].map(f32::log2));
        let views: Vec<View<'_>> = lobes
            .iter()
            .enumerate()
            .map(|(v, lobes)| {
                let theta = v as f32 * 10f32.to_radians();
                View {
                    theta,
                    log2_squeeze: theta.cos().log2(),
                    log2_diffuse,
                    diffuse_color_differences,
                    lobes,
                }
            })
            .collect();
        let line = Line { views: &views, squeezed: 2, mirrored: 0, factors: None };
        let mut bytes = vec![0; line.encoded_len("test")];
        line.encode("test", &mut bytes).unwrap();
        StoredMaterial::new("lacquer", Cow::Owned(bytes)).unwrap()
    }

    /// A brushed metal for tests: a highlight that is four times as wide across x as along it, whose albedo depends on the
    /// azimuth.
    pub fn brushed() -> StoredMaterial {
        const AZIMUTHS: usize = 6;
        let thetas = [0.0f32, 0.5, 1.0, 1.4];
        let lobe = |theta: f32, share: f32| {
            let integral = srbf_core::special::sphere_integral(16.0);
            let rgb = [share, 0.8 * share, 0.5 * share];
            let (log2_luminance, color_differences) = color_differences(rgb.map(|c| (c / integral).log2()));
            TiltedLobe { tilt: [theta, 0.0], log2_sharpness: 4.0, log2_luminance, color_differences }
        };
        let mut views = vec![([1.0, 0.0, -1.0], [lobe(0.0, 0.5)])];
        for &theta in &thetas[1..] {
            for j in 0..AZIMUTHS {
                let (s, c) = (j as f32 * std::f32::consts::PI / AZIMUTHS as f32).sin_cos();
                let squeeze = [c * c - s * s, -2.0 * s * c, s * s - c * c - theta.cos().log2()];
                views.push((squeeze, [lobe(theta, 0.5 + 0.3 * theta.sin() * (c * c - s * s))]));
            }
        }
        let views: Vec<GridView<'_>> = views
            .iter()
            .map(|(squeeze, lobes)| GridView {
                log2_squeeze: *squeeze,
                log2_diffuse: -4.0,
                diffuse_color_differences: [0.0; 2],
                lobes,
            })
            .collect();
        let grid = Grid {
            thetas: &thetas,
            azimuths: AZIMUTHS,
            turns: 2,
            axis: 0.0,
            views: &views,
            squeezed: 1,
            factors: None,
        };
        let mut bytes = vec![0; grid.encoded_len("test")];
        grid.encode("test", &mut bytes).unwrap();
        StoredMaterial::new("brushed", Cow::Owned(bytes)).unwrap()
    }

    #[test]
    fn every_preset_and_the_matte_load_and_keep_energy() {
        for name in PRESETS.iter().map(|preset| preset.0).chain([MATTE]) {
            let stored = StoredMaterial::load(name).unwrap();
            let mut mixture = srbf_core::Mixture::<{ srbf_core::MAX_LOBES }>::empty();
            for degrees in 0..90 {
                let (sin, cos) = (degrees as f32).to_radians().sin_cos();
                stored.material.prepare(glam::vec3(-sin, 0.0, cos), &mut mixture).unwrap();
                let albedo = mixture.albedo();
                // Cayman's blue is outside the gamut of sRGB: its red was measured as down to -0.04 / sr.
                let luminance = srbf_core::luminance(albedo);
                assert!(
                    luminance >= 0.0 && albedo.min_element() > -0.05 && albedo.max_element() <= 1.0,
                    "{name}, {degrees}: {albedo}"
                );
            }
        }
    }

    #[test]
    fn products_with_the_lobe_of_the_matte_are_no_subnormals() {
        let stored = StoredMaterial::load(MATTE).unwrap();
        let amplitude = stored.material.view_lobe(0, 0).unwrap().log2_luminance;
        assert!((-62.0..-40.0).contains(&amplitude), "{amplitude}");
    }

    #[test]
    fn errors_say_what_is_expected() {
        let error = format!("{:#}", StoredMaterial::load("no_such_preset").unwrap_err());
        assert!(
            error.contains("no_such_preset") && error.contains(".srbf") && error.contains(MATTE),
            "{error}"
        );
        let error = format!("{:#}", StoredMaterial::load("missing/file.srbf").unwrap_err());
        assert!(error.contains("missing/file.srbf"), "{error}");
        // Without an end.
        #[cfg(unix)]
        {
            let error = format!("{:#}", StoredMaterial::load("/dev/zero").unwrap_err());
            assert!(error.contains("/dev/zero") && error.contains("not a regular file"), "{error}");
        }
    }
}
