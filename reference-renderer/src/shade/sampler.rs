//! A sampler of a material: by name, fitted to the rendered material.

use super::proposal::{Mixtures, Part, Proposal};
use super::strategy::SamplerName;
use crate::numbers::random::Random;
use crate::truth::Truth;
use crate::truth::guided::Guide;
use crate::truth::stored::Bytes;
use anyhow::{Context, bail};
use glam::Vec3;
use srbf_core::{Error, Material};
use srbf_fit::FitError;
use srbf_fit::table::Draws;
use srbf_thesis::lafortune::Lafortune;
use srbf_thesis::samplers::analytic::{Analytic, Lobe};
use srbf_thesis::samplers::factored::Factored;
use srbf_thesis::samplers::tabulated::Tabulated;
use srbf_thesis::samplers::thesis::{How, Thesis};
use srbf_thesis::samplers::{lafortune, rgl};

/// Share of the cosine in a sampler that may be 0, or far too small, where the truth is not.
const COSINE: f32 = 0.05;

/// Texels along an edge of the cube map that the thesis's algorithm fits. Tests ask whether estimates have a bias: a coarse map is
/// enough, and takes a tenth of the time.
const THESIS_EDGE: usize = if cfg!(test) { 20 } else { 64 };

/// What draws for one material.
pub struct Sampler<'a> {
    kind: Kind<'a>,
    cosine: f32,
    is_multi: bool,
}

enum Kind<'a> {
    /// The material's own sampler: the lobes that are rendered, or the guide of a table.
    Own,
    /// Lobes that sample a table.
    Lobes(&'a Material<Bytes>),
    Uniform,
    Cosine,
    Guided(Guide),
    Analytic(Analytic),
    Lafortune(Lafortune),
    Tabulated(Tabulated),
    Factored(Factored),
    Rgl(&'a dyn Draws),
    Thesis(Thesis),
}

/// The default, the material's own sampler.
pub static OWN: Sampler<'static> = Sampler { kind: Kind::Own, cosine: 0.0, is_multi: false };

impl<'a> Sampler<'a> {
    /// Fits a sampler to the rendered material. `lobes` sample a table; without any, a table's own lobes are its guide.
    ///
    /// # Errors
    /// Names materials that the sampler cannot sample: anisotropic ones by isotropic methods, others than `.bsdf` files by their warps, sheets
    /// by anything but their lobes.
    pub fn fit(
        name: SamplerName,
        truth: &Truth<'a>,
        lobes: Option<&'a Material<Bytes>>,
    ) -> anyhow::Result<Self> {
        Self::fit_beside(&mut None, name, truth, lobes)
    }

    /// Fits several samplers to a material. Those that draw in other ways from the same lobes, which take seconds to fit, share them.
    pub fn fit_all(
        names: impl IntoIterator<Item = SamplerName>,
        truth: &Truth<'a>,
        lobes: Option<&'a Material<Bytes>>,
    ) -> impl Iterator<Item = (SamplerName, anyhow::Result<Self>)> {
        let mut fitted = None;
        names.into_iter().map(move |name| (name, Self::fit_beside(&mut fitted, name, truth, lobes)))
    }

    /// `fitted`: the thesis's lobes, if they were fitted to that truth before.
    fn fit_beside(
        fitted: &mut Option<Thesis>,
        name: SamplerName,
        truth: &Truth<'a>,
        lobes: Option<&'a Material<Bytes>>,
    ) -> anyhow::Result<Self> {
        if let Truth::Sheet(stored) = truth
            && !matches!(name, SamplerName::Lobes | SamplerName::LobesMulti)
        {
            bail!(
                "{}: the sheet {} is sampled by its own lobes, on both sides; even, mis, product, light or lobes is expected",
                name.text(),
                stored.name
            );
        }
        let of_lobes = || match (truth, lobes) {
            (Truth::Table(_), Some(lobes)) => (Kind::Lobes(lobes), COSINE),
            _ => (Kind::Own, 0.0),
        };
        let analytic = |lobe| (Kind::Analytic(Analytic::fit(lobe, truth)), COSINE);
        let mut thesis = |how| -> Result<Kind<'_>, FitError> {
            let lobes = match fitted.take() {
                Some(lobes) => lobes,
                None => Thesis::fit(truth, how, THESIS_EDGE)?,
            };
            Ok(Kind::Thesis(fitted.insert(lobes).drawn(how)))
        };
        let (kind, cosine) = match name {
            SamplerName::Uniform => (Kind::Uniform, 0.0),
            SamplerName::Cosine => (Kind::Cosine, 0.0),
            SamplerName::Phong => analytic(Lobe::phong),
            SamplerName::Ward => analytic(Lobe::ward),
            SamplerName::Ggx => analytic(Lobe::ggx),
            SamplerName::Lafortune => (Kind::Lafortune(lafortune::fit(truth).context("lafortune")?), COSINE),
            SamplerName::Tabulated => (Kind::Tabulated(Tabulated::new(truth)), COSINE),
            SamplerName::Factored => {
                let mut random = Random::new(2004, 0, 0);
                (Kind::Factored(Factored::new(truth, || random.unit())), COSINE)
            }
            SamplerName::Rgl => match truth.draws() {
                Some(draws) => (Kind::Rgl(draws), COSINE),
                None => bail!("rgl: the warps of a .bsdf file are expected, and the material has none"),
            },
            SamplerName::Guided => (Kind::Guided(truth.guide()), 0.0),
            SamplerName::Thesis => (thesis(How::Inversion).context("thesis")?, COSINE),
            SamplerName::ThesisWalk => (thesis(How::Walk).context("thesis-walk")?, COSINE),
            SamplerName::ThesisMulti => (thesis(How::Together).context("thesis-multi")?, COSINE),
            SamplerName::Lobes | SamplerName::LobesMulti => of_lobes(),
            SamplerName::Defensive => match of_lobes() {
                // The guide of a table has its part of the cosine.
                (Kind::Own, _) if matches!(truth, Truth::Table(_)) => (Kind::Own, 0.0),
                (kind, _) => (kind, COSINE),
            },
        };
        Ok(Self { kind, cosine, is_multi: name.is_multi() })
    }

    /// Gets ready for an outgoing direction, a unit vector in the shading frame. The mixture of lobes that are rendered is ready.
    ///
    /// # Errors
    /// As [`Material::prepare`].
    #[inline]
    pub fn prepare<'m>(
        &'m self,
        wo: Vec3,
        truth: &Truth<'m>,
        mixtures: &mut Mixtures<'m>,
    ) -> Result<Proposal<'m>, Error> {
        let wide = || wo.as_dvec3().normalize();
        let part = match &self.kind {
            Kind::Own => match truth {
                Truth::Lobes(_) => Part::Lobes,
                Truth::Table(measured) => Part::Guided(measured.guide().proposal(wide())),
                Truth::Sheet(_) => Part::Sheet,
            },
            Kind::Lobes(material) => {
                material.prepare(wo, &mut mixtures.lobes)?;
                Part::Lobes
            }
            Kind::Uniform => Part::Uniform,
            Kind::Cosine => Part::Cosine,
            Kind::Guided(guide) => Part::Guided(guide.proposal(wide())),
            Kind::Analytic(analytic) => Part::Analytic(analytic.proposal(wide())),
            Kind::Lafortune(model) => Part::Lafortune(lafortune::LafortuneProposal::new(model, wide())),
            Kind::Tabulated(table) => Part::Tabulated(table.proposal(wide())),
            Kind::Factored(factors) => Part::Factored(factors.proposal(wide())),
            Kind::Rgl(draws) => Part::Rgl(rgl::RglProposal::new(*draws, wo)),
            Kind::Thesis(thesis) => Part::Thesis(thesis.prepare(wide(), &mut mixtures.round)?),
        };
        Ok(Proposal { part, cosine: self.cosine, is_multi: self.is_multi })
    }

    /// Whether lobes of another material draw.
    pub fn is_of_lobes(&self) -> bool {
        matches!(self.kind, Kind::Lobes(_))
    }

    /// Whether the rendered lobes alone draw, one direction at a time.
    pub fn is_own(&self) -> bool {
        matches!(self.kind, Kind::Own) && self.cosine == 0.0 && !self.is_multi
    }

    /// What draws, in words.
    pub fn title(&self, truth: &Truth<'_>) -> String {
        let of_lobes = |material: &Material<Bytes>| format!("{} lobes", material.lobe_count());
        let what = match &self.kind {
            Kind::Own => match truth {
                Truth::Lobes(_) => "its lobes".to_owned(),
                Truth::Sheet(_) => "its lobes on both sides".to_owned(),
                Truth::Table(_) => {
                    "GGX lobes of fixed roughness and a cosine, weighted by the table".to_owned()
                }
            },
            Kind::Lobes(material) => of_lobes(material),
            Kind::Uniform => "the uniform hemisphere".to_owned(),
            Kind::Cosine => "the cosine".to_owned(),
            Kind::Guided(_) => {
                "GGX lobes of fixed roughness and a cosine, weighted by the material".to_owned()
            }
            Kind::Analytic(analytic) => match analytic.lobe {
                Lobe::Phong { exponent } => format!("a Phong lobe of exponent {exponent:.1} and a cosine"),
                Lobe::Ward { alpha } => format!("Ward's lobe of roughness {alpha:.4} and a cosine"),
                Lobe::Ggx { alpha } => format!("visible normals of GGX of roughness {alpha:.4} and a cosine"),
            },
            Kind::Lafortune(model) => {
                let lobes: usize = model.channels.iter().map(|channel| channel.lobes.len()).sum();
                format!("{lobes} lobes of Lafortune's and a cosine")
            }
            Kind::Tabulated(table) => format!("tabulated distributions, {} kB", table.bytes() / 1000),
            Kind::Factored(factors) => format!("a factored distribution, {} kB", factors.bytes() / 1000),
            Kind::Rgl(_) => "the warps of its file".to_owned(),
            Kind::Thesis(thesis) => thesis.title(),
        };
        let together = if self.is_multi { ", several directions of a hit together" } else { "" };
        let cosine = if self.cosine > 0.0 {
            format!(", and {} % of the cosine", 100.0 * self.cosine)
        } else {
            String::new()
        };
        format!("{what}{together}{cosine}")
    }
}
