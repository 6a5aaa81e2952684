//! A measured table, or an analytic model, as a material: what was measured, as it is, for fits to be judged by.
//!
//! Its values are not touched: channels that are negative, of colours outside the gamut of sRGB, stay so.

pub mod albedo;
mod guide;

use anyhow::{Context, bail};
use glam::{DVec3, Vec3};
use guide::{Guide, Proposal};
use srbf_core::Sample;
use srbf_fit::analytic;
use srbf_fit::baselines::lafortune;
use srbf_fit::read::{Content, Source};
use srbf_fit::table::{Brdf, Symmetry};
use std::path::Path;

/// Ends of the names of tables.
const ENDINGS: [&str; 5] = ["brdf", "astm", "csv", "binary", "bsdf"];

/// What can be evaluated at any pair of directions, and what samples it.
pub struct MeasuredMaterial {
    /// Name of the file without folder and extension, or of the model.
    pub name: String,
    brdf: Box<dyn Brdf + Send>,
    is_isotropic: bool,
    guide: Guide,
}

impl MeasuredMaterial {
    /// Whether a name is that of a table or model, and not that of a `.srbf` file or preset.
    pub fn is_named(name: &str) -> bool {
        let file = split_published(name).map_or(name, |parts| parts.0);
        let ending = Path::new(file).extension().unwrap_or_default();
        name.starts_with(analytic::PREFIX) || ENDINGS.iter().any(|known| ending.eq_ignore_ascii_case(known))
    }

    /// Reads what `srbf fit` reads: a table, `model:...`, or `FILE.csv:NAME`, one of the published Lafortune fits of a file.
    ///
    /// # Errors
    /// As the reader says them; scattered samples, which say nothing between their directions.
    pub fn load(name: &str) -> anyhow::Result<Self> {
        let source = match split_published(name) {
            Some((file, material)) => lafortune::read(Path::new(file), material)?,
            None => srbf_fit::read::read(Path::new(name)).map_err(|error| {
                match lafortune::names(Path::new(name)) {
                    Ok(names) => anyhow::anyhow!(
                        "{name}: published fits; {name}:NAME is expected, with one of {names}"
                    ),
                    Err(_) => error.into(),
                }
            })?,
        };
        Self::new(source).with_context(|| format!("material {name}"))
    }

    /// Takes what was read, and finds out how to sample it.
    ///
    /// # Errors
    /// Scattered samples.
    pub fn new(source: Source) -> anyhow::Result<Self> {
        check_evaluable(&source.content)?;
        let Content::Evaluable(brdf) = source.content else { bail!("no values everywhere") };
        let is_isotropic = brdf.symmetry() == Symmetry::Isotropic;
        let value = |wi: DVec3, wo: DVec3| f_cos(brdf.as_ref(), wi, wo);
        let guide = Guide::new(&value, is_isotropic);
        let name = source.name;
        let plain = ENDINGS.iter().find_map(|ending| {
            let (stem, end) = name.rsplit_once('.')?;
            end.eq_ignore_ascii_case(ending).then_some(stem)
        });
        Ok(Self { name: plain.unwrap_or(&name).to_owned(), brdf, is_isotropic, guide })
    }

    /// Whether the values do not change when both directions turn round the normal.
    pub fn is_isotropic(&self) -> bool {
        self.is_isotropic
    }

    /// Gets ready for an outgoing direction, a unit vector in the shading frame.
    pub fn view(&self, wo: Vec3) -> View<'_> {
        let wo = wo.as_dvec3().normalize();
        View { material: self, wo, proposal: self.guide.proposal(wo) }
    }

    fn f_cos(&self, wi: DVec3, wo: DVec3) -> DVec3 {
        f_cos(self.brdf.as_ref(), wi, wo)
    }
}

/// Refuses scattered samples.
///
/// # Errors
/// Says what can be done with them.
pub fn check_evaluable(content: &Content) -> anyhow::Result<()> {
    match content {
        Content::Evaluable(_) => Ok(()),
        Content::Samples(_) => bail!(
            "it holds scattered samples, and no values between them; a table with a value for every pair of directions \
             (.bsdf, .binary) or a model:... is expected. `srbf fit` makes a material of samples that can be rendered"
        ),
    }
}

/// File and name of `FILE.csv:NAME`.
fn split_published(name: &str) -> Option<(&str, &str)> {
    let (file, material) = name.rsplit_once(':')?;
    let is_csv = Path::new(file).extension().is_some_and(|end| end.eq_ignore_ascii_case("csv"));
    (is_csv && !name.starts_with(analytic::PREFIX)).then_some((file, material))
}

/// `f cos` as it was measured, 0 where it was not; linear sRGB, 1/sr.
fn f_cos(brdf: &dyn Brdf, wi: DVec3, wo: DVec3) -> DVec3 {
    if wi.z <= 0.0 || wo.z <= 0.0 {
        return DVec3::ZERO;
    }
    let value = DVec3::from(brdf.evaluate(wi.to_array(), wo.to_array())) * wi.z;
    DVec3::from(value.to_array().map(|v| if v.is_finite() { v } else { 0.0 }))
}

/// A material seen from one outgoing direction. All directions are unit vectors in the shading frame.
pub struct View<'a> {
    material: &'a MeasuredMaterial,
    wo: DVec3,
    proposal: Proposal,
}

impl View<'_> {
    /// `f cos`; linear sRGB, 1/sr.
    pub fn evaluate(&self, wi: Vec3) -> Vec3 {
        self.material.f_cos(wi.as_dvec3().normalize(), self.wo).as_vec3()
    }

    /// Density of [`sample`](Self::sample); 1/sr.
    pub fn pdf(&self, wi: Vec3) -> f32 {
        self.proposal.density(wi.as_dvec3().normalize()) as f32
    }

    /// Draws an incident direction; `None` where it would lie below the horizon.
    pub fn sample(&self, u: [f32; 3]) -> Option<Sample> {
        // Rounded first: value and density are those of the direction that is handed out.
        let direction = self.proposal.sample(u.map(f64::from)).as_vec3();
        let pdf = self.pdf(direction);
        let is_drawn = direction.z > 0.0 && pdf > 0.0 && pdf.is_finite();
        is_drawn.then(|| Sample { direction, pdf, weight: self.evaluate(direction) / pdf })
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// A model by its name.
    pub fn model(text: &str) -> MeasuredMaterial {
        MeasuredMaterial::load(text).unwrap()
    }

    /// Green and glossy, red below zero: what lies outside the gamut of sRGB.
    pub fn vivid() -> MeasuredMaterial {
        struct Vivid;
        impl Brdf for Vivid {
            fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
                let chord: f64 = [wi[0] + wo[0], wi[1] + wo[1], wi[2] - wo[2]].iter().map(|v| v * v).sum();
                let lobe = (-40.0 * chord).exp();
                [-0.05 - 0.5 * lobe, 0.1 + 2.0 * lobe, 0.02]
            }
        }
        let content = Content::Evaluable(Box::new(Vivid));
        MeasuredMaterial::new(Source { content, name: "vivid".into(), sha256: String::new() }).unwrap()
    }

    #[test]
    fn tables_are_told_from_materials_by_name() {
        for name in ["a.bsdf", "b/c.BINARY", "x.brdf", "x.astm", "x.csv", "x.csv:felt", "model:lambert"] {
            assert!(MeasuredMaterial::is_named(name), "{name}");
        }
        for name in ["a.srbf", "matte", "bsdf", "csv:felt"] {
            assert!(!MeasuredMaterial::is_named(name), "{name}");
        }
    }

    #[test]
    fn negative_channels_stay() {
        let material = vivid();
        let view = material.view(Vec3::new(-0.6, 0.0, 0.8));
        let value = view.evaluate(Vec3::new(0.6, 0.0, 0.8));
        assert!((value.x + 0.55 * 0.8).abs() < 1e-6, "{value}");
        assert_eq!(view.evaluate(Vec3::new(0.6, 0.0, -0.8)), Vec3::ZERO);
    }
}
