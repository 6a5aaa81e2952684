//! Our fit, as the judge of methods sees it: `.srbf` bytes, evaluated by the run-time library.

use crate::method::{Fitted, FittedView, Method};
use crate::table::Table;
use crate::{FitError, Settings, fit};
use srbf_core::{MAX_LOBES, Material, Mixture, Vec3};

/// Our method with its settings.
pub struct Tracked<'a>(pub &'a Settings);

impl Method for Tracked<'_> {
    fn fit(&self, table: &Table) -> Result<Box<dyn Fitted>, FitError> {
        Ok(Box::new(TrackedLobes { bytes: fit(table, self.0, |_| {})?.bytes }))
    }
}

/// A material as `.srbf` bytes.
#[derive(Clone, Debug)]
pub struct TrackedLobes {
    /// The bytes.
    pub bytes: Vec<u8>,
}

impl TrackedLobes {
    /// Angles of the views that are stored, radians.
    ///
    /// # Errors
    /// [`FitError::Format`] for bytes that are no material.
    pub fn knots(&self) -> Result<Vec<f64>, FitError> {
        knots(&self.bytes)
    }
}

/// Angles of the views of a material, radians.
pub(crate) fn knots(bytes: &[u8]) -> Result<Vec<f64>, FitError> {
    let material = Material::from_bytes(bytes)?;
    Ok((0..material.view_count()).filter_map(|n| material.view_theta(n)).map(f64::from).collect())
}

impl Fitted for TrackedLobes {
    fn view(&self, theta: f64) -> Result<Box<dyn FittedView + '_>, FitError> {
        Ok(Box::new(TrackedView::new(&Material::from_bytes(&self.bytes)?, theta)?))
    }
}

/// The mixture of a material for one outgoing direction.
pub(crate) struct TrackedView(pub Mixture<MAX_LOBES>);

impl TrackedView {
    pub fn new(material: &Material<'_>, theta: f64) -> Result<Self, FitError> {
        let mut mixture = Mixture::empty();
        let (sin, cos) = libm::sincos(theta);
        // The f32 nearest to pi / 2 is beyond it.
        material.prepare(Vec3::new(-sin as f32, 0.0, cos.max(0.0) as f32), &mut mixture)?;
        Ok(Self(mixture))
    }
}

impl FittedView for TrackedView {
    fn f_cos(&self, direction: [f64; 3]) -> [f64; 3] {
        self.0.evaluate(Vec3::from(direction.map(|v| v as f32))).to_array().map(f64::from)
    }

    fn pdf(&self, direction: [f64; 3]) -> Option<f64> {
        Some(f64::from(self.0.pdf(Vec3::from(direction.map(|v| v as f32)))))
    }

    fn albedo(&self) -> Option<[f64; 3]> {
        Some(self.0.albedo().to_array().map(f64::from))
    }
}
