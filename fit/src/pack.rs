//! A material in as few bytes as a scene needs: fewer lobes, views, factors, channels and bits.
//!
//! A part of a material can be cut off, or lobes be fitted again with less of everything. Both are tried, and the nearer
//! one is taken.
//!
//! May import: `anisotropic`, `fit`, `judge`, `settings`.

mod cut;
mod forms;

pub use forms::{PackedForm, forms};

use crate::anisotropic::{TurnedView, judge_turned, judged_at};
use crate::judge::report::{ViewReport, mean_error};
use crate::judge::spectral::with_map;
use crate::read::Content;
use crate::table::{Symmetry, Table, evaluation_views};
use crate::{FactorNodes, FitError, Settings, fit_content};
use srbf_core::{Material, PackOptions};

/// Views that a packed material is judged at, and of an anisotropic one the azimuth from one to the next, radians.
const JUDGED_VIEWS: usize = 12;
const APART: f64 = 2.4;

/// Fewest nodes over the azimuth of a table that is fitted with its sign: three nodes are better used without.
const FEWEST_SIGNED: usize = 5;

/// The measurement or the fit that a material is packed from.
pub struct Subject<'a> {
    content: &'a Content,
    /// The material that parts are cut off.
    whole: Material<Vec<u8>>,
    judged: Judged,
}

/// Views that materials are judged at.
enum Judged {
    Isotropic(Table),
    Anisotropic(Vec<TurnedView>),
}

/// A packed material.
#[derive(Clone, Debug)]
pub struct Packed {
    /// Its bytes.
    pub bytes: Vec<u8>,
    /// Its mean relative L2 error over the judged views.
    pub error: f64,
    /// What its lobes are.
    pub way: Way,
}

/// Where the lobes of a packed material come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Those of the whole material, some of them perhaps cut off.
    Cut,
    /// Fitted again.
    FittedAgain,
}

impl<'a> Subject<'a> {
    /// Of a measurement and the bytes of its fit; or of a fit alone, whose lobes are the content then.
    ///
    /// # Errors
    /// [`FitError::Format`] for bytes that are none; [`FitError::Table`] for a content that is black.
    pub fn new(content: &'a Content, whole: &[u8]) -> Result<Self, FitError> {
        let whole = Material::from_bytes(whole.to_vec())?;
        let thetas = || evaluation_views::halfway(&evaluation_views::even_views(JUDGED_VIEWS + 1));
        let judged = match content {
            Content::Samples(table) => Judged::Isotropic(table.clone()),
            Content::Evaluable(brdf) if brdf.symmetry() != Symmetry::Isotropic => {
                // Every ring is seen from another side.
                let at = thetas().into_iter().enumerate().map(|(n, theta)| (theta, APART * n as f64));
                Judged::Anisotropic(judged_at(brdf.as_ref(), &at.collect::<Vec<_>>()))
            }
            Content::Evaluable(brdf) => {
                Judged::Isotropic(evaluation_views::judging_table(brdf.as_ref(), &thetas())?)
            }
        };
        Ok(Self { content, whole, judged })
    }

    /// The material that parts are cut off.
    pub fn whole(&self) -> &Material<Vec<u8>> {
        &self.whole
    }

    /// Mean relative L2 error of a material over the judged views.
    ///
    /// # Errors
    /// [`FitError::Format`] for bytes that are no material.
    pub fn error(&self, bytes: &[u8]) -> Result<f64, FitError> {
        let material = Material::from_bytes(bytes)?;
        let views = match &self.judged {
            Judged::Anisotropic(views) => judge_turned(bytes, views, 0.0)?,
            Judged::Isotropic(table) => table
                .views
                .iter()
                .map(|view| ViewReport::judge(&material, view))
                .collect::<Result<Vec<_>, _>>()?,
        };
        Ok(mean_error(&views))
    }

    /// Packs in a form. Parts are cut off the whole material. If lobes, views or factors go and `fits_again`, lobes are fitted again too,
    /// and the nearer of both is taken. `progress` is called with the share of the work that is done.
    ///
    /// # Errors
    /// [`FitError::Setting`] for a form with more than the whole material has; otherwise as [`fit_content`].
    pub fn pack(
        &self,
        form: &PackedForm,
        settings: &Settings,
        fits_again: bool,
        progress: impl FnMut(f64) + Send,
    ) -> Result<Packed, FitError> {
        let cut = self.with_spectra(cut::cut(&self.whole, form)?)?;
        let bytes = packed(&cut, form.pack, &settings.provenance)?;
        let cut_off = Packed { error: self.error(&bytes)?, bytes, way: Way::Cut };
        if !fits_again || PackedForm::of(&self.whole, form.pack) == *form {
            return Ok(cut_off);
        }
        let factors = match form.factors {
            None => FactorNodes::None,
            Some(nodes) if nodes[2] >= FEWEST_SIGNED && self.whole.has_signed_factors() => {
                FactorNodes::Signed(nodes)
            }
            Some(nodes) => FactorNodes::Given(nodes),
        };
        let few = Settings {
            lobes: form.lobes,
            views: Some(form.views),
            squeezed: None,
            mirrored: None,
            factors,
            ..settings.clone()
        };
        let fitted = Material::from_bytes(fit_content(self.content, &few, progress)?.bytes)?;
        let fitted = self.with_spectra(fitted)?;
        let bytes = packed(&fitted, form.pack, &settings.provenance)?;
        let again = Packed { error: self.error(&bytes)?, bytes, way: Way::FittedAgain };
        Ok(if again.error < cut_off.error { again } else { cut_off })
    }
}

impl Subject<'_> {
    /// A material with the spectra of the whole.
    fn with_spectra(&self, material: Material<Vec<u8>>) -> Result<Material<Vec<u8>>, FitError> {
        let Some(map) = self.whole.spectral_map() else { return Ok(material) };
        Ok(Material::from_bytes(with_map(material.bytes(), map.bytes())?)?)
    }
}

/// The bytes of a material in codes.
fn packed(material: &Material<Vec<u8>>, options: PackOptions, provenance: &str) -> Result<Vec<u8>, FitError> {
    let mut bytes = vec![0; material.packed_len(options, provenance)];
    material.pack(options, provenance, &mut bytes)?;
    Ok(bytes)
}
