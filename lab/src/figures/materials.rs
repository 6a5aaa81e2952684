//! The four materials of the thesis, each with the lobes that sample it and the samplers that are fitted to it.

use anyhow::{Context, bail};
use rayon::prelude::*;
use srbf_fit::read::{Content, Source};
use srbf_fit::{FactorNodes, Settings, fit_content};
use srbf_reference_renderer::shade::shader::Shader;
use srbf_reference_renderer::shade::{Sampler, SamplerName};
use srbf_reference_renderer::truth::Truth;
use srbf_reference_renderer::truth::measured::MeasuredMaterial;
use srbf_reference_renderer::truth::stored::StoredMaterial;
use srbf_thesis::lafortune;
use std::borrow::Cow;
use std::path::Path;

/// Name, title, and figure of chapter 5.
const MATERIALS: [(&str, &str, usize); 4] = [
    ("garnet_red", "garnet red", 2),
    ("blue_paint", "blue paint", 3),
    ("krylon_blue", "krylon blue", 4),
    ("cayman", "cayman", 5),
];

/// Those of a look: a published fit, and a measurement.
const QUICK: [&str; 2] = ["blue_paint", "cayman"];

/// What draws: samplers of tables.
const SAMPLERS: [SamplerName; 3] = [SamplerName::Lobes, SamplerName::Thesis, SamplerName::Lafortune];

/// A material: the measurement, and lobes.
pub struct Painted {
    pub name: &'static str,
    pub title: &'static str,
    /// Figure of chapter 5 with its sphere.
    pub figure: usize,
    pub table: MeasuredMaterial,
    pub lobes: StoredMaterial,
    /// Lafortune's lobes as the material.
    pub lafortune: MeasuredMaterial,
}

impl Painted {
    /// Loads all of them, or those of a look, in the order of the thesis's figures.
    ///
    /// # Errors
    /// Files that are missing or damaged.
    pub fn load(data: &Path, is_quick: bool) -> anyhow::Result<Vec<Self>> {
        let wanted = MATERIALS.par_iter().filter(|material| !is_quick || QUICK.contains(&material.0));
        wanted.map(|&material| Self::load_one(data, material)).collect()
    }

    fn load_one(
        data: &Path,
        (name, title, figure): (&'static str, &'static str, usize),
    ) -> anyhow::Result<Self> {
        let cornell = data.join("cornell");
        // Blue paint is not among the measurements at hand: its published fit stands for it.
        let is_published = name == "blue_paint";
        let file = if is_published {
            cornell.join("lafortune_fits.csv")
        } else {
            cornell.join(name).with_extension("brdf")
        };
        let text =
            file.to_str().with_context(|| format!("{}: a name in UTF-8 is expected", file.display()))?;
        let table = MeasuredMaterial::load(&if is_published {
            format!("{text}:bluepaint")
        } else {
            text.to_owned()
        })?;
        let lobes = if is_published { fit_published(&file, name)? } else { StoredMaterial::load(name)? };
        let model = srbf_thesis::samplers::lafortune::fit(&Truth::Table(&table))
            .with_context(|| format!("material {name}"))?;
        let model = Source::evaluable(Box::new(model), name.to_owned(), String::new());
        Ok(Self { name, title, figure, table, lobes, lafortune: MeasuredMaterial::new(model)? })
    }

    fn truth(&self, kind: Kind) -> Truth<'_> {
        match kind {
            Kind::Measurement => Truth::Table(&self.table),
            Kind::Lobes => Truth::Lobes(&self.lobes.material),
        }
    }
}

/// The function that all methods render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The measurement.
    Measurement,
    /// The lobes that were fitted to it.
    Lobes,
}

/// Lobes of a published fit, which no preset holds.
fn fit_published(file: &Path, name: &str) -> anyhow::Result<StoredMaterial> {
    let content = lafortune::read(file, "bluepaint")?.content;
    if !matches!(content, Content::Evaluable(_)) {
        bail!("{}: a model is expected", file.display());
    }
    let settings = Settings { factors: FactorNodes::None, ..Settings::default() };
    StoredMaterial::new(name, Cow::Owned(fit_content(&content, &settings, |_| {})?.bytes))
}

/// The samplers of a material, each fitted once.
pub struct FittedPaint<'a> {
    pub painted: &'a Painted,
    truth: Truth<'a>,
    samplers: Vec<Sampler<'a>>,
    lafortune_itself: Sampler<'a>,
}

impl<'a> FittedPaint<'a> {
    /// Fits them.
    ///
    /// # Errors
    /// None but of a material that is black.
    pub fn new(painted: &'a Painted, kind: Kind) -> anyhow::Result<Self> {
        let truth = painted.truth(kind);
        let lobes = Some(&painted.lobes.material).filter(|_| kind == Kind::Measurement);
        let fit = |&name: &SamplerName| Sampler::fit(name, &truth, lobes);
        let samplers = SAMPLERS.par_iter().map(fit).collect::<anyhow::Result<_>>();
        let samplers = samplers.with_context(|| format!("material {}", painted.name))?;
        let lafortune_itself = Sampler::fit(SamplerName::Lafortune, &Truth::Table(&painted.lafortune), None)?;
        Ok(Self { painted, truth, samplers, lafortune_itself })
    }

    /// The shading of a scene: the truth, drawn from by a sampler.
    pub fn shader(&'a self, name: SamplerName) -> Shader<'a> {
        let place = SAMPLERS.iter().position(|&other| other == name).unwrap_or(0);
        Shader { truth: self.truth, sampler: &self.samplers[place] }
    }

    /// The same where lobes are rendered: ours, or those of Lafortune.
    pub fn itself(&'a self, name: SamplerName) -> Shader<'a> {
        if name == SamplerName::Lafortune {
            return Shader { truth: Truth::Table(&self.painted.lafortune), sampler: &self.lafortune_itself };
        }
        (&self.painted.lobes.material).into()
    }
}
