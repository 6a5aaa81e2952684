//! The materials of a scene: lobes, a measured table, or a sheet, each with its sampler.

use crate::numbers::points::{Decision, Points};
use crate::shade::proposal::{Drawn, Mixtures, Part, Proposal};
use crate::shade::sampler::{OWN, Sampler};
use crate::truth::measured::MeasuredMaterial;
use crate::truth::sheets::StoredSheet;
use crate::truth::stored::{Bytes, StoredMaterial};
use crate::truth::{LargeMixture, Truth};
use glam::{DVec3, Vec3};
use srbf_core::{Error, MAX_LOBES, Material, Sample, SheetMixture, Towards, luminance};

/// A material that was loaded.
pub enum LoadedMaterial {
    /// Lobes.
    Lobes(StoredMaterial),
    /// A table or model, as it is.
    Table(Box<MeasuredMaterial>),
    /// A sheet.
    Sheet(Box<StoredSheet>),
}

impl LoadedMaterial {
    /// Loads a preset, a `.srbf` file, or what `srbf fit` reads.
    ///
    /// # Errors
    /// As [`StoredMaterial::load`] and [`MeasuredMaterial::load`].
    pub fn load(name: &str) -> anyhow::Result<Self> {
        if MeasuredMaterial::is_named(name) {
            return Ok(Self::Table(Box::new(MeasuredMaterial::load(name)?)));
        }
        Ok(Self::Lobes(StoredMaterial::load(name)?))
    }

    /// Its name.
    pub fn name(&self) -> &str {
        match self {
            Self::Lobes(stored) => &stored.name,
            Self::Table(measured) => &measured.name,
            Self::Sheet(stored) => &stored.name,
        }
    }

    /// The table, if it is one.
    pub fn table(&self) -> Option<&MeasuredMaterial> {
        match self {
            Self::Lobes(_) | Self::Sheet(_) => None,
            Self::Table(measured) => Some(measured),
        }
    }

    /// Its name, and the kind of material.
    pub fn title(&self) -> String {
        match self {
            Self::Lobes(stored) => format!("{}, {} lobes", stored.name, stored.material.lobe_count()),
            Self::Table(measured) => format!("{}, table", measured.name),
            Self::Sheet(stored) => format!("{}, sheet", stored.name),
        }
    }

    /// The rendered material.
    pub fn truth(&self) -> Truth<'_> {
        match self {
            Self::Lobes(stored) => Truth::Lobes(&stored.material),
            Self::Table(measured) => Truth::Table(measured),
            Self::Sheet(stored) => Truth::Sheet(stored),
        }
    }

    /// The material in a scene, with its own sampler.
    pub fn shader(&self) -> Shader<'_> {
        self.truth().into()
    }
}

/// A material in a scene: the truth, and its sampler.
#[derive(Clone, Copy)]
pub struct Shader<'a> {
    pub truth: Truth<'a>,
    pub sampler: &'a Sampler<'a>,
}

impl<'a> From<Truth<'a>> for Shader<'a> {
    fn from(truth: Truth<'a>) -> Self {
        Self { truth, sampler: &OWN }
    }
}

impl<'a> From<&'a Material<Bytes>> for Shader<'a> {
    fn from(material: &'a Material<Bytes>) -> Self {
        Truth::Lobes(material).into()
    }
}

impl<'a> From<&'a MeasuredMaterial> for Shader<'a> {
    fn from(measured: &'a MeasuredMaterial) -> Self {
        Truth::Table(measured).into()
    }
}

impl<'a> From<&'a StoredSheet> for Shader<'a> {
    fn from(stored: &'a StoredSheet) -> Self {
        Truth::Sheet(stored).into()
    }
}

impl<'a> Shader<'a> {
    /// Gets ready for an outgoing direction, a unit vector in the shading frame.
    ///
    /// # Errors
    /// As [`Material::prepare`].
    #[inline]
    pub fn prepare(&self, wo: Vec3, scattering: &mut Scattering<'a>) -> Result<(), Error> {
        scattering.scatterer = match self.truth {
            Truth::Lobes(material) => {
                material.prepare(wo, &mut scattering.mixtures.lobes)?;
                Scatterer::Lobes
            }
            Truth::Table(measured) => Scatterer::Table(measured, wo.as_dvec3().normalize()),
            Truth::Sheet(stored) => {
                stored.sheet.prepare(wo, scattering.mixtures.sheet.get_or_insert_default())?;
                Scatterer::Sheet
            }
        };
        scattering.proposal = self.sampler.prepare(wo, &self.truth, &mut scattering.mixtures)?;
        Ok(())
    }

    /// The lobes that are rendered, if they are what samples them, and nothing else.
    #[inline]
    pub fn own_lobes(&self) -> Option<&'a Material<Bytes>> {
        match self.truth {
            Truth::Lobes(material) if self.sampler.is_own() => Some(material),
            _ => None,
        }
    }

    /// Whether light comes through.
    #[inline]
    pub fn is_sheet(&self) -> bool {
        matches!(self.truth, Truth::Sheet(_))
    }

    /// Whether the azimuth of the outgoing direction does not matter.
    pub fn is_isotropic(&self) -> bool {
        self.truth.is_isotropic()
    }
}

/// The source of values, for one outgoing direction.
enum Scatterer<'a> {
    /// The mixture `lobes`.
    Lobes,
    /// A table, and the outgoing direction.
    Table(&'a MeasuredMaterial, DVec3),
    /// The mixtures `sheet`, which draw too.
    Sheet,
}

/// How a surface scatters towards one outgoing direction. All directions are unit vectors in the shading frame.
pub struct Scattering<'a> {
    mixtures: Mixtures<'a>,
    scatterer: Scatterer<'a>,
    proposal: Proposal<'a>,
}

impl<'a> Scattering<'a> {
    /// Storage for any material.
    pub fn empty() -> Self {
        Self { mixtures: Mixtures::empty(), scatterer: Scatterer::Lobes, proposal: Proposal::cosine() }
    }

    /// `f cos`; linear sRGB, 1/sr.
    #[inline]
    pub fn evaluate(&self, wi: Vec3) -> Vec3 {
        match &self.scatterer {
            Scatterer::Lobes => self.mixtures.lobes.evaluate(wi),
            Scatterer::Table(table, wo) => table.f_cos(wi.as_dvec3().normalize(), *wo).as_vec3(),
            Scatterer::Sheet => self.sheet().map_or(Vec3::ZERO, |pair| pair.evaluate_and_pdf(wi).0),
        }
    }

    /// The mixtures of a sheet; `None` of another material.
    #[inline]
    fn sheet(&self) -> Option<&SheetMixture<'a, MAX_LOBES>> {
        let is_sheet = matches!(self.scatterer, Scatterer::Sheet);
        self.mixtures.sheet.as_deref().filter(|_| is_sheet)
    }

    /// `f cos`, and the density of [`sample`](Self::sample); 1/sr.
    #[inline]
    pub fn evaluate_and_pdf(&self, wi: Vec3) -> (Vec3, f32) {
        if self.samples_its_lobes() {
            let (value, pdf) = self.mixtures.lobes.evaluate_and_pdf(wi);
            return (value, self.proposal.mix(pdf, wi));
        }
        if let Some(pair) = self.sheet() {
            return pair.evaluate_and_pdf(wi);
        }
        if let Part::Rgl(warps) = &self.proposal.part
            && wi.z > 0.0
        {
            let known = warps.look_up(wi);
            return (known.value.into(), self.proposal.mix(known.density, wi));
        }
        (self.evaluate(wi), self.proposal.pdf(&self.mixtures, wi))
    }

    /// Draws an incident direction; `None` where there is none to draw, which counts as black.
    #[inline]
    pub fn sample(&self, u: [f32; 3]) -> Option<Sample> {
        if self.samples_its_lobes() && self.proposal.cosine == 0.0 {
            return self.mixtures.lobes.sample(u);
        }
        if let Some(pair) = self.sheet() {
            return pair.sample(u);
        }
        let (direction, value, pdf) = match self.proposal.warps(u) {
            Some((warps, u)) => {
                let (direction, known) = warps.draw(u);
                (direction.z > 0.0).then_some(())?;
                (direction, known.value.into(), self.proposal.mix(known.density, direction))
            }
            None => {
                let direction = self.proposal.sample(&self.mixtures, u)?;
                let (value, pdf) = self.evaluate_and_pdf(direction);
                (direction, value, pdf)
            }
        };
        (pdf > 0.0 && pdf.is_finite()).then(|| Sample { direction, pdf, weight: value / pdf })
    }

    /// Draws `n` incident directions at the first surface, together if the sampler does; fewer where some count as black. The sum of what their weights bring
    /// over `n` is the estimate.
    pub fn sample_together(&self, n: u32, points: &Points, samples: &mut Vec<Sample>) {
        samples.clear();
        if let Some(drawn) = self.proposal.sample_as_thesis(&self.mixtures, n, points) {
            let is_possible = |d: &Drawn| d.divisor > 0.0 && d.divisor.is_finite();
            samples.extend(drawn.into_iter().filter(is_possible).map(|Drawn { direction, divisor, pdf }| {
                Sample { direction, pdf, weight: self.evaluate(direction) / divisor }
            }));
            return;
        }
        let is_multi = self.proposal.is_multi;
        let offset = if is_multi { points.draw(Decision::Choice, 0)[0] } else { 0.0 };
        for i in 0..n {
            let [own, u, v, _] = points.branch(i as usize, n as usize).draw(Decision::Material, 0);
            let choice = if is_multi { self.proposal.choice(i, n, offset) } else { own };
            samples.extend(self.sample([choice, u, v]));
        }
    }

    /// The value towards a direction, where a table is rendered.
    #[inline]
    pub fn other_truth(&self, wi: Vec3) -> Option<Vec3> {
        self.is_table().then(|| self.evaluate(wi))
    }

    /// Whether directions are drawn from the lobes and nothing else.
    #[inline]
    pub fn draws_lobes_alone(&self) -> bool {
        matches!(self.proposal.part, Part::Lobes) && self.proposal.cosine == 0.0
    }

    /// Whether lobes are rendered and drawn from.
    #[inline]
    fn samples_its_lobes(&self) -> bool {
        self.is_of_lobes() && matches!(self.proposal.part, Part::Lobes)
    }

    /// Whether the lobes of a material are rendered.
    #[inline]
    fn is_of_lobes(&self) -> bool {
        matches!(self.scatterer, Scatterer::Lobes)
    }

    #[inline]
    fn is_table(&self) -> bool {
        matches!(self.scatterer, Scatterer::Table(..))
    }

    /// The lobes that directions are drawn from together with the light: where our lobes sample the rendered material, and bring some light
    /// from everywhere, so that no candidate that matters is passed over.
    #[inline]
    pub fn lobes_for_product(&self) -> Option<&LargeMixture<'a>> {
        let lobes = &self.mixtures.lobes;
        let is_everywhere = self.is_of_lobes() || luminance(lobes.diffuse()) > 0.0;
        (matches!(self.proposal.part, Part::Lobes) && is_everywhere).then_some(lobes)
    }

    /// The lobes of a material that are rendered, or that draw.
    #[inline]
    pub fn known_lobes(&self) -> Option<&LargeMixture<'a>> {
        let is_known = self.is_of_lobes() || matches!(self.proposal.part, Part::Lobes);
        is_known.then_some(&self.mixtures.lobes)
    }

    /// Density of [`sample`](Self::sample); 1/sr.
    #[inline]
    pub fn pdf(&self, wi: Vec3) -> f32 {
        self.proposal.pdf(&self.mixtures, wi)
    }

    /// Draws a direction by itself; `None` as in [`sample`](Self::sample).
    #[inline]
    pub fn draw(&self, u: [f32; 3]) -> Option<Vec3> {
        self.proposal.sample(&self.mixtures, u)
    }

    /// Values of the rendered material towards directions; lobes are evaluated together.
    pub fn evaluate_all<const N: usize>(&self, wi: &[Vec3; N]) -> [Vec3; N] {
        if !self.is_of_lobes() {
            return wi.map(|d| self.evaluate(d));
        }
        let [x, y, z] = [0, 1, 2].map(|k| wi.map(|d| d[k]));
        let [mut red, mut green, mut blue] = [[0.0; N]; 3];
        // The slices are of one length.
        let value = Some([&mut red[..], &mut green[..], &mut blue[..]]);
        let _ = self.mixtures.lobes.ask(Towards { wi: [&x, &y, &z], value, pdf: None }.into());
        std::array::from_fn(|i| Vec3::new(red[i], green[i], blue[i]))
    }

    /// The share of the light that the lobes scatter: of a sheet, on both sides.
    pub fn albedo(&self) -> Vec3 {
        self.sheet().map_or_else(|| self.mixtures.lobes.albedo(), |pair| pair.albedos().iter().sum())
    }
}
