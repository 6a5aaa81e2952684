//! A measured table, or an analytic model, as a material: the data itself, to judge fits by.
//!
//! Its values are not touched: channels that are negative, of colours outside the gamut of sRGB, stay so.

pub mod albedo;

use crate::truth::guided::Guide;
use crate::truth::networks::Networks;
use anyhow::Context;
use glam::{DVec3, Vec3};
use srbf_core::SpectralMap;
use srbf_fit::analytic;
use srbf_fit::complete::{Gaps, complete};
use srbf_fit::read::{Content, Source, Spectra};
use srbf_fit::table::{Brdf, Draws, Symmetry};
use srbf_thesis::lafortune;
use std::path::Path;
use std::sync::OnceLock;

/// Ends of the names of tables.
const ENDINGS: [&str; 14] = [
    "brdf",
    "astm",
    "csv",
    "binary",
    "bsdf",
    "txt",
    "tsv",
    "dat",
    "xompt",
    "anisotropicbsdf",
    "ssdd",
    "json",
    "npy",
    "gz",
];

/// The BRDF.
pub struct MeasuredMaterial {
    /// Name of the file without folder and extension, or of the model.
    pub name: String,
    brdf: Box<dyn Brdf + Send>,
    is_isotropic: bool,
    /// Samples that were completed, if it was not measured at every pair of directions.
    pub completed: Option<usize>,
    /// Its gaps in words; empty for none.
    pub gaps: String,
    /// The bytes of the map from its colours to spectra; empty without one.
    map: Vec<u8>,
    /// Made when it is asked for.
    guide: OnceLock<Guide>,
}

impl MeasuredMaterial {
    /// Whether a name is that of a table or model, and not that of a `.srbf` file or preset.
    pub fn is_named(name: &str) -> bool {
        let (file, is_part) = split_part(name).map_or((name, false), |parts| (parts.0, true));
        let is_table = |ending: &str| has_ending(Path::new(file), ending);
        name.starts_with(analytic::PREFIX) || is_part || ENDINGS.iter().any(|ending| is_table(ending))
    }

    /// Reads what `srbf fit` reads: a table, `model:...`; `FILE.csv:NAME`, one of the published Lafortune fits of a file; or
    /// `FILE.f32le:NAME`, one of the networks of a file.
    ///
    /// # Errors
    /// As the reader says them.
    pub fn load(name: &str) -> anyhow::Result<Self> {
        let source = read_source(name)?;
        Self::new(source).with_context(|| format!("material {name}"))
    }

    /// From a file that was read. Scattered samples are completed, which takes some seconds.
    ///
    /// # Errors
    /// Samples that cannot be completed: black ones.
    pub fn new(source: Source) -> anyhow::Result<Self> {
        let map = source.spectra().map(Spectra::to_map).transpose()?.unwrap_or_default();
        let (brdf, completed, gaps): (Box<dyn Brdf + Send>, _, _) = match source.content {
            Content::Evaluable(brdf) => {
                // Anisotropic tables have no pairs of directions in the frame of a view.
                let is_isotropic = brdf.symmetry() == Symmetry::Isotropic;
                let gaps =
                    Some(Gaps::of_table(brdf.as_ref())).filter(|gaps| is_isotropic && gaps.mean() > 0.0);
                (brdf, None, gaps.map_or_else(String::new, |gaps| gaps.text()))
            }
            Content::Samples(table) => {
                let samples = table.views.iter().map(|view| view.samples.len()).sum();
                let completion = complete(&table)?;
                let gaps = completion.report.gaps.text();
                (Box::new(completion), Some(samples), gaps)
            }
        };
        let is_isotropic = brdf.symmetry() == Symmetry::Isotropic;
        let name = source.name;
        let plain = ENDINGS.iter().find_map(|ending| {
            let (stem, end) = name.rsplit_once('.')?;
            end.eq_ignore_ascii_case(ending).then_some(stem)
        });
        let name = plain.unwrap_or(&name).to_owned();
        Ok(Self { name, brdf, is_isotropic, completed, gaps, map, guide: OnceLock::new() })
    }

    /// Whether the values do not change when both directions turn round the normal.
    pub fn is_isotropic(&self) -> bool {
        self.is_isotropic
    }

    /// The map from its colours to spectra; `None` without one.
    pub fn spectral_map(&self) -> Option<SpectralMap<'_>> {
        SpectralMap::from_bytes(&self.map).ok()
    }

    /// The measurement.
    pub fn brdf(&self) -> &dyn Brdf {
        self.brdf.as_ref()
    }

    /// `f cos` as it was measured, 0 where it was not; linear sRGB, 1/sr.
    pub fn f_cos(&self, wi: DVec3, wo: DVec3) -> DVec3 {
        if wi.z <= 0.0 || wo.z <= 0.0 {
            return DVec3::ZERO;
        }
        let value = match self.brdf.draws() {
            // In f32, as it is drawn from.
            Some(draws) => {
                Vec3::from(draws.look_up(wi.as_vec3().to_array(), wo.as_vec3().to_array()).value).as_dvec3()
            }
            None => DVec3::from(self.brdf.evaluate(wi.to_array(), wo.to_array())) * wi.z,
        };
        DVec3::from(value.to_array().map(|v| if v.is_finite() { v } else { 0.0 }))
    }

    /// The default sampler: GGX lobes and a cosine.
    pub fn guide(&self) -> &Guide {
        self.guide.get_or_init(|| Guide::new(&|wi, wo| self.f_cos(wi, wo), self.is_isotropic))
    }

    /// Whether the guide was made.
    pub fn has_guide(&self) -> bool {
        self.guide.get().is_some()
    }

    /// What its file brings along to be sampled by.
    pub fn draws(&self) -> Option<&dyn Draws> {
        self.brdf.draws()
    }
}

/// Reads what [`MeasuredMaterial::load`] names.
///
/// # Errors
/// As the reader says them; which parts there are of a file that has several.
pub fn read_source(name: &str) -> anyhow::Result<Source> {
    let Some((file, part)) = split_part(name) else {
        return srbf_fit::read::read(Path::new(name)).map_err(|error| {
            match lafortune::names(Path::new(name)) {
                Ok(names) => {
                    anyhow::anyhow!("{name}: published fits; {name}:NAME is expected, with one of {names}")
                }
                Err(_) => error.into(),
            }
        });
    };
    let file = Path::new(file);
    if has_ending(file, NETWORKS) {
        return Networks::read(file)?.source(part).with_context(|| format!("material {name}"));
    }
    Ok(lafortune::read(file, part)?)
}

/// End of the name of a file of networks.
const NETWORKS: &str = "f32le";

fn has_ending(file: &Path, ending: &str) -> bool {
    file.extension().is_some_and(|end| end.eq_ignore_ascii_case(ending))
}

/// File and name of `FILE.csv:NAME` and `FILE.f32le:NAME`.
fn split_part(name: &str) -> Option<(&str, &str)> {
    let (file, part) = name.rsplit_once(':')?;
    let has_parts = ["csv", NETWORKS].iter().any(|ending| has_ending(Path::new(file), ending));
    (has_parts && !name.starts_with(analytic::PREFIX)).then_some((file, part))
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// A model by its name.
    pub fn model(text: &str) -> MeasuredMaterial {
        MeasuredMaterial::load(text).unwrap()
    }

    /// Green and glossy, red below zero: a colour outside the gamut of sRGB.
    pub fn vivid() -> MeasuredMaterial {
        struct Vivid;
        impl Brdf for Vivid {
            fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
                let chord: f64 = [wi[0] + wo[0], wi[1] + wo[1], wi[2] - wo[2]].iter().map(|v| v * v).sum();
                let lobe = (-40.0 * chord).exp();
                [-0.05 - 0.5 * lobe, 0.1 + 2.0 * lobe, 0.02]
            }
        }
        MeasuredMaterial::new(Source::evaluable(Box::new(Vivid), "vivid".into(), String::new())).unwrap()
    }

    #[test]
    fn tables_are_told_from_materials_by_name() {
        for name in [
            "a.bsdf",
            "b/c.BINARY",
            "x.brdf",
            "x.astm",
            "x.csv",
            "x.csv:felt",
            "x.f32le:felt",
            "model:lambert",
        ] {
            assert!(MeasuredMaterial::is_named(name), "{name}");
        }
        for name in ["a.srbf", "matte", "bsdf", "csv:felt"] {
            assert!(!MeasuredMaterial::is_named(name), "{name}");
        }
    }

    #[test]
    fn negative_channels_stay() {
        let material = vivid();
        let wo = DVec3::new(-0.6, 0.0, 0.8);
        let value = material.f_cos(DVec3::new(0.6, 0.0, 0.8), wo);
        assert!((value.x + 0.55 * 0.8).abs() < 1e-6, "{value}");
        assert_eq!(material.f_cos(DVec3::new(0.6, 0.0, -0.8), wo), DVec3::ZERO);
    }
}
