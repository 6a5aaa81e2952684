//! Our fit for the judge of methods: a material, evaluated by the run-time library.

use crate::FitError;
use crate::judge::method::{Fitted, FittedView};
use srbf_core::{Level, MAX_LOBES, Material, Mixture, Vec3, luminance};

/// Angles of the views that a material stores, radians.
pub fn view_angles(material: &Material<impl AsRef<[u8]>>) -> Vec<f64> {
    (0..material.view_count()).filter_map(|n| material.view_theta(n)).map(f64::from).collect()
}

impl<B: AsRef<[u8]> + Sync> Fitted for Material<B> {
    fn view(&self, theta: f64) -> Result<Box<dyn FittedView + '_>, FitError> {
        self.view_at(theta, 0.0)
    }

    fn view_at(&self, theta: f64, azimuth: f64) -> Result<Box<dyn FittedView + '_>, FitError> {
        let azimuth = if self.is_isotropic() { 0.0 } else { azimuth };
        Ok(Box::new(TrackedView::new(self, theta, azimuth)?))
    }
}

/// `f cos` of the luminance towards incident directions, of one outgoing direction; all in the frame of the surface. By scalar kernels.
pub(crate) fn values_towards(
    material: &Material<impl AsRef<[u8]>>,
    wo: [f64; 3],
    wi: &[[f64; 3]],
) -> Result<Vec<f64>, FitError> {
    let narrow = |d: [f64; 3]| Vec3::from(d.map(|v| v as f32)).normalize();
    let mut mixture = Mixture::<MAX_LOBES>::empty();
    material.prepare_with(narrow(wo), Level::Scalar.into(), &mut mixture)?;
    Ok(wi.iter().map(|d| f64::from(luminance(mixture.evaluate(narrow(*d)).to_array()))).collect())
}

/// Directions over which a value with factors is averaged: to about a thousandth.
const DRAWN: u32 = 3000;

/// The mixture of a material for one outgoing direction.
pub(crate) struct TrackedView<'m> {
    pub mixture: Mixture<'m, MAX_LOBES>,
    /// Whether the value is more than the lobes, whose albedo has a closed form.
    has_factors: bool,
    /// Sine and cosine of the angle from the frame of the view to that of the surface.
    turn: (f64, f64),
}

impl<'m> TrackedView<'m> {
    /// `azimuth`: by how much the outgoing direction is turned from -x.
    pub fn new(material: &'m Material<impl AsRef<[u8]>>, theta: f64, azimuth: f64) -> Result<Self, FitError> {
        let mut view = Self {
            mixture: Mixture::empty(),
            has_factors: material.factor_nodes().is_some(),
            turn: libm::sincos(azimuth),
        };
        let (sin, cos) = libm::sincos(theta);
        // The f32 nearest to pi / 2 is beyond it.
        let wo = view.to_surface([-sin, 0.0, cos.max(0.0)]);
        // Scalar on every processor, because these values decide the course of a fit.
        material.prepare_with(wo, Level::Scalar.into(), &mut view.mixture)?;
        Ok(view)
    }

    /// The albedo as the mean of `f cos / pdf` over directions that the lobes draw, evenly spread. The stored albedo is
    /// interpolated between its views, and up to 1.4 % off there (malachite), where a fit's energy is within 1 %.
    fn drawn_albedo(&self) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for i in 0..DRAWN {
            // The R2 sequence (Roberts 2018) beside even steps.
            let n = f64::from(i);
            let u = [(n + 0.5) / f64::from(DRAWN), 0.754_877_666_246_693 * n, 0.569_840_290_998_053 * n];
            if let Some(sample) = self.mixture.sample(u.map(|u| u.fract() as f32)) {
                let weight = sample.weight.to_array();
                (0..3).for_each(|c| sum[c] += f64::from(weight[c]) / f64::from(DRAWN));
            }
        }
        sum
    }

    /// The direction that the lobes draw by three numbers in [0, 1), in the frame of the view.
    pub fn draw(&self, u: [f32; 3]) -> Option<[f64; 3]> {
        let [x, y, z] = self.mixture.sample_direction(u)?.to_array().map(f64::from);
        let (sin, cos) = self.turn;
        Some([x * cos + y * sin, y * cos - x * sin, z])
    }

    fn to_surface(&self, [x, y, z]: [f64; 3]) -> Vec3 {
        let (sin, cos) = self.turn;
        Vec3::from([x * cos - y * sin, x * sin + y * cos, z].map(|v| v as f32))
    }
}

impl FittedView for TrackedView<'_> {
    fn f_cos(&self, direction: [f64; 3]) -> [f64; 3] {
        self.mixture.evaluate(self.to_surface(direction)).to_array().map(f64::from)
    }

    fn pdf(&self, direction: [f64; 3]) -> Option<f64> {
        Some(f64::from(self.mixture.pdf(self.to_surface(direction))))
    }

    fn albedo(&self) -> Option<[f64; 3]> {
        Some(match self.has_factors {
            true => self.drawn_albedo(),
            false => self.mixture.albedo().to_array().map(f64::from),
        })
    }
}
