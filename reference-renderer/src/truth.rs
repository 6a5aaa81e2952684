//! The truth of a picture, whatever samples it: lobes, a measured table, or a sheet.
//!
//! GGX lobes that follow a table (`guided`) stand here too: a table of albedo is integrated by them.
//!
//! May import: `out`.

pub mod guided;
pub mod measured;
pub mod networks;
pub mod sheets;
pub mod stored;

use crate::truth::guided::Guide;
use crate::truth::measured::MeasuredMaterial;
use crate::truth::sheets::StoredSheet;
use crate::truth::stored::Bytes;
use glam::DVec3;
use srbf_core::{MAX_LOBES, Material, Mixture, SpectralMap};
use srbf_fit::table::{Brdf, Draws, Symmetry};
use srbf_thesis::samplers::Reflection;

/// Storage for the mixture of any material.
pub type LargeMixture<'m> = Mixture<'m, MAX_LOBES>;

/// The material that a picture shows, whatever samples it.
#[derive(Clone, Copy)]
pub enum Truth<'a> {
    /// Lobes.
    Lobes(&'a Material<Bytes>),
    /// A table or model.
    Table(&'a MeasuredMaterial),
    /// Lobes on both sides of a thin surface.
    Sheet(&'a StoredSheet),
}

impl<'a> Truth<'a> {
    /// Whether the azimuth of the outgoing direction does not matter.
    pub fn is_isotropic(&self) -> bool {
        match self {
            Self::Lobes(material) => material.is_isotropic(),
            Self::Table(measured) => measured.is_isotropic(),
            Self::Sheet(stored) => stored.is_isotropic,
        }
    }

    /// Its own map from colours to spectra; `None` without one. The quarters of a sheet may have several, of which none is taken.
    pub fn spectral_map(&self) -> Option<SpectralMap<'a>> {
        match self {
            Self::Lobes(material) => material.spectral_map(),
            Self::Table(measured) => measured.spectral_map(),
            Self::Sheet(_) => None,
        }
    }

    /// What its file brings along to be sampled by.
    pub fn draws(&self) -> Option<&'a dyn Draws> {
        match self {
            Self::Lobes(_) | Self::Sheet(_) => None,
            Self::Table(measured) => measured.draws(),
        }
    }

    /// GGX lobes and a cosine, weighted by it.
    pub fn guide(&self) -> Guide {
        Guide::new(&|wi, wo| self.f_cos(wi, wo), self.is_isotropic())
    }
}

/// What samplers are fitted to.
impl Brdf for Truth<'_> {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        (self.f_cos(wi.into(), wo.into()) / wi[2]).to_array()
    }

    fn symmetry(&self) -> Symmetry {
        if self.is_isotropic() { Symmetry::Isotropic } else { Symmetry::None }
    }
}

/// For fits: scenes shade with `Scattering`.
impl Reflection for Truth<'_> {
    fn f_cos(&self, wi: DVec3, wo: DVec3) -> DVec3 {
        match self {
            Self::Lobes(material) => {
                let mut mixture = LargeMixture::empty();
                let prepared = material.prepare(wo.as_vec3(), &mut mixture);
                if prepared.is_ok() { mixture.evaluate(wi.as_vec3()).as_dvec3() } else { DVec3::ZERO }
            }
            Self::Table(measured) => measured.f_cos(wi, wo),
            Self::Sheet(stored) => stored.sheet.evaluate(wo.as_vec3(), wi.as_vec3()).as_dvec3(),
        }
    }
}
