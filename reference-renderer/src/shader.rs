//! What a scene shades with: lobes, or a measured table.

use crate::material::{Bytes, StoredMaterial};
use crate::measured::{MeasuredMaterial, View};
use glam::Vec3;
use srbf_core::{Defensive, Error, MAX_LOBES, Material, Mixture, Sample};

/// Storage for the mixture of any material.
pub type AnyMixture<'m> = Mixture<'m, MAX_LOBES>;

/// A material that was loaded.
pub enum LoadedMaterial {
    /// Lobes.
    Lobes(StoredMaterial),
    /// A table or model, as it is.
    Table(Box<MeasuredMaterial>),
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

    /// What it is called.
    pub fn name(&self) -> &str {
        match self {
            Self::Lobes(stored) => &stored.name,
            Self::Table(measured) => &measured.name,
        }
    }

    /// What it is called, and what kind of material it is.
    pub fn title(&self) -> String {
        match self {
            Self::Lobes(stored) => format!("{}, {} lobes", stored.name, stored.material.lobe_count()),
            Self::Table(measured) => format!("{}, table", measured.name),
        }
    }

    /// What a scene shades with.
    pub fn shader(&self) -> Shader<'_> {
        match self {
            Self::Lobes(stored) => Shader::Lobes(&stored.material),
            Self::Table(measured) => Shader::Table(measured),
        }
    }
}

/// A material in a scene.
#[derive(Clone, Copy)]
pub enum Shader<'a> {
    /// Lobes.
    Lobes(&'a Material<Bytes>),
    /// A table or model.
    Table(&'a MeasuredMaterial),
}

impl<'a> From<&'a Material<Bytes>> for Shader<'a> {
    fn from(material: &'a Material<Bytes>) -> Self {
        Self::Lobes(material)
    }
}

impl<'a> Shader<'a> {
    /// Gets ready for an outgoing direction, a unit vector in the shading frame.
    ///
    /// # Errors
    /// As [`Material::prepare`].
    #[inline]
    pub fn prepare(&self, wo: Vec3, scattering: &mut Scattering<'a>) -> Result<(), Error> {
        match self {
            Self::Lobes(material) => {
                scattering.table = None;
                material.prepare(wo, &mut scattering.lobes)
            }
            Self::Table(measured) => {
                scattering.table = Some(measured.view(wo));
                Ok(())
            }
        }
    }

    /// Whether the azimuth of the outgoing direction does not matter.
    pub fn is_isotropic(&self) -> bool {
        match self {
            Self::Lobes(material) => material.is_isotropic(),
            Self::Table(measured) => measured.is_isotropic(),
        }
    }
}

/// How a surface scatters towards one outgoing direction. All directions are unit vectors in the shading frame.
pub struct Scattering<'a> {
    /// Unused where a table is.
    lobes: AnyMixture<'a>,
    table: Option<View<'a>>,
}

impl<'a> Scattering<'a> {
    /// Storage for any material.
    pub fn empty() -> Self {
        Self { lobes: AnyMixture::empty(), table: None }
    }

    /// `f cos`; linear sRGB, 1/sr.
    #[inline]
    pub fn evaluate(&self, wi: Vec3) -> Vec3 {
        match &self.table {
            None => self.lobes.evaluate(wi),
            Some(table) => table.evaluate(wi),
        }
    }

    /// `f cos`, and the density of [`sample`](Self::sample); 1/sr.
    #[inline]
    pub fn evaluate_and_pdf(&self, wi: Vec3) -> (Vec3, f32) {
        match &self.table {
            None => self.lobes.evaluate_and_pdf(wi),
            Some(table) => (table.evaluate(wi), table.pdf(wi)),
        }
    }

    /// Draws an incident direction; `None` where there is none to draw, which counts as black.
    #[inline]
    pub fn sample(&self, u: [f32; 3]) -> Option<Sample> {
        match &self.table {
            None => self.lobes.sample(u),
            Some(table) => table.sample(u),
        }
    }

    /// The same, one direction in twenty from the cosine; of a table as [`sample`](Self::sample), which has that part.
    pub fn sample_defensive(&self, u: [f32; 3]) -> Option<Sample> {
        match &self.table {
            None => Some(Defensive::new(&self.lobes, 0.05).ok()?.sample(u)),
            Some(table) => table.sample(u),
        }
    }

    /// The lobes that were prepared last.
    pub fn lobes(&self) -> &AnyMixture<'a> {
        &self.lobes
    }
}
