//! The sampling of Weng and Shih 2006: round lobes on the sphere, fitted to f view by view and blended by equation 9. What falls
//! below the horizon is lost.

use super::Reflection;
use crate::thesis::{RoundLobe, ThesisFit, ThesisSettings, fit_brdf};
use glam::{DVec3, Vec3};
use rand_core::Rng;
use srbf_core::{Error, Gaussian, LUMINANCE, Lobe, MAX_LOBES, Metropolis, Mixture, Sample};
use srbf_fit::FitError;
use srbf_fit::table::evaluation_views::even_views;
use std::sync::Arc;

/// Outgoing directions that are fitted. Eight or ten is what Cornell measured.
const VIEWS: usize = 10;

/// Lobes of a view, such that four views fit into a mixture.
const LOBES: usize = 12;
const _: () = assert!(4 * LOBES <= MAX_LOBES);

/// How directions of a lobe are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum How {
    /// By inversion, a lobe for each direction by equation 14.
    Inversion,
    /// By the random walk, five steps, as figure 5.1. The estimate is biased: the walk's density is not known, and that of the
    /// lobes is taken.
    Walk,
    /// Several directions of one outgoing direction together, each of a lobe by equation 14, weighted by equation 13.
    Together,
}

/// The lobes of all views.
#[derive(Clone)]
pub struct Thesis {
    fit: Arc<ThesisFit>,
    how: How,
}

impl Thesis {
    /// Fits a reflection. `edge`: texels along the edge of a face of the cube map, 64 by default.
    ///
    /// # Errors
    /// An anisotropic reflection, and a black one.
    pub fn fit(reflection: &dyn Reflection, how: How, edge: usize) -> Result<Self, FitError> {
        let settings = ThesisSettings { lobes: LOBES, edge, ..ThesisSettings::default() };
        Ok(Self { fit: fit_brdf(reflection, &even_views(VIEWS), &settings)?.into(), how })
    }

    /// The same lobes, drawn from in another way.
    #[must_use]
    pub fn drawn(&self, how: How) -> Self {
        Self { how, ..self.clone() }
    }

    /// What draws, in words.
    pub fn title(&self) -> String {
        let how = match self.how {
            How::Inversion => "by inversion",
            How::Walk => "by a random walk of five steps, which is biased",
            How::Together => "weighted by equation 13",
        };
        format!("{LOBES} round lobes at {VIEWS} views blended by equation 9, {how}")
    }

    /// Gets ready for an outgoing direction: puts the lobes into a mixture.
    ///
    /// # Errors
    /// None but those of numbers that are no lobe.
    pub fn prepare<'a>(
        &self,
        wo: DVec3,
        mixture: &mut Mixture<'a, MAX_LOBES>,
    ) -> Result<ThesisProposal, Error> {
        let across = wo.x.hypot(wo.y);
        let [cos, sin] = if across > 0.0 { [-wo.x / across, -wo.y / across] } else { [1.0, 0.0] };
        let turned = |l: &RoundLobe| -> Result<Lobe, Error> {
            let [x, y, z] = l.axis;
            let axis = DVec3::new(x * cos - y * sin, x * sin + y * cos, z).normalize().as_vec3();
            let power: f64 = (0..3).map(|c| f64::from(LUMINANCE[c]) * l.amplitude[c]).sum();
            Lobe::new(axis, l.sharpness as f32, Vec3::splat(power as f32))
        };
        let lobes = self.fit.lobes_at(across.atan2(wo.z));
        let lobes: Vec<Lobe> = lobes.iter().map(turned).collect::<Result<_, _>>()?;
        *mixture = Mixture::sphere(&lobes)?;
        let mut sum = 0.0;
        let with_running = |lobe: Lobe| {
            sum += lobe.integral().x;
            (lobe.gaussian, sum)
        };
        // By inversion the mixture alone draws.
        let lobes = if self.how == How::Inversion {
            Vec::new()
        } else {
            lobes.into_iter().map(with_running).collect()
        };
        Ok(ThesisProposal { how: self.how, lobes })
    }
}

/// The lobes for one outgoing direction, each with the running sum of integrals; none where the mixture alone draws.
#[derive(Clone, Debug)]
pub struct ThesisProposal {
    how: How,
    lobes: Vec<(Gaussian, f32)>,
}

impl ThesisProposal {
    /// Draws a direction, maybe below the horizon; `None` if there is no lobe. A random walk takes more numbers than three: those of a
    /// stream that three integers begin.
    #[inline]
    pub fn sample<R: Rng>(
        &self,
        mixture: &Mixture<'_, MAX_LOBES>,
        u: [f32; 3],
        stream: impl FnOnce([u64; 3]) -> R,
    ) -> Option<Vec3> {
        if self.how != How::Walk {
            return mixture.sample(u).map(|sample: Sample| sample.direction);
        }
        let gaussian = self.lobes[self.choose(u[0])?].0;
        let mut numbers = stream(u.map(|v| u64::from(v.to_bits())));
        let walk = Metropolis::default();
        Some(walk.sample(&gaussian, range(&walk, gaussian.sharpness), &mut numbers))
    }

    /// The lobe at a share of the sum of integrals: equation 14.
    fn choose(&self, u: f32) -> Option<usize> {
        let whole = self.lobes.last()?.1;
        (whole > 0.0).then(|| {
            let target = u * whole;
            self.lobes.partition_point(|lobe| lobe.1 <= target).min(self.lobes.len() - 1)
        })
    }

    /// Draws a direction for each of `n` uniform numbers, of a lobe by equation 14, and makes the mixture of densities
    /// `sum n_k p_k / n`, by which equation 13 divides.
    pub fn sample_together(
        &self,
        numbers: impl ExactSizeIterator<Item = [f32; 4]>,
        directions: &mut Vec<Vec3>,
    ) -> Option<Mixture<'static, MAX_LOBES>> {
        let (n, mut counts) = (numbers.len(), [0u32; MAX_LOBES]);
        for [choice, u, v, _] in numbers {
            let lobe = self.choose(choice)?;
            counts[lobe] += 1;
            directions.push(self.lobes[lobe].0.sample([u, v]));
        }
        let mut drawn = Vec::with_capacity(self.lobes.len());
        for ((gaussian, _), count) in self.lobes.iter().zip(counts) {
            if count > 0 {
                let amplitude = count as f32 / (n as f32 * gaussian.integral());
                drawn.push(Lobe::new(gaussian.axis, gaussian.sharpness, Vec3::splat(amplitude)).ok()?);
            }
        }
        Mixture::sphere(&drawn).ok()
    }
}

/// The angle at which a Gaussian meets the floor of a walk: [`Metropolis::range`] in closed form.
fn range(walk: &Metropolis, sharpness: f32) -> f32 {
    let w = -walk.floor.ln() / sharpness;
    if w < 2.0 { 2.0 * (0.5 * w).sqrt().asin() } else { std::f32::consts::PI }
}

#[cfg(test)]
mod tests {
    use super::*;
    use srbf_core::Kernel;

    #[test]
    fn the_range_of_a_walk_is_that_which_is_searched_for() {
        let walk = Metropolis::default();
        for sharpness in [0.0, 0.5, 3.0, 90.0, 8000.0] {
            let gaussian = Gaussian::new(Vec3::Z, sharpness).unwrap();
            let searched = walk.range(|w| gaussian.value_at(2.0 * w));
            assert!((range(&walk, sharpness) / searched - 1.0).abs() < 1e-3, "{sharpness}");
        }
    }
}
