//! Mixtures of given lobes.

use super::leave_out::LeaveOut;
use super::row;
use super::rows::{Domain, Groups, Mixture, Room};
use crate::color;
use crate::error::Error;
use crate::lobe::gaussian::Lobe;
use crate::simd::detect::Level;
use crate::squeeze::Squeeze;
use glam::Vec3;

/// Largest magnitude of a component that folded lobes can have, if all have their peaks at one place.
fn lobes_at_most(lobes: &[Lobe]) -> f32 {
    2.0 * lobes.iter().map(|lobe| lobe.amplitude.abs().max_element()).sum::<f32>()
}

impl<const N: usize> Mixture<'_, N>
where
    Room<N>: Groups,
{
    /// Makes a mixture of folded, round lobes on the upper hemisphere.
    ///
    /// # Errors
    /// [`Error::Capacity`]; [`Error::Amplitude`] if integral or value could be infinite; and what
    /// [`Lobe::new`] refuses.
    pub fn hemisphere(lobes: &[Lobe]) -> Result<Self, Error> {
        Self::new(Domain::Hemisphere, 1.0, &[], lobes)
    }

    /// Makes a mixture of round lobes on the whole sphere.
    ///
    /// # Errors
    /// [`Error::Capacity`]; [`Error::Amplitude`] if integral or value could be infinite; and what
    /// [`Lobe::new`] refuses.
    pub fn sphere(lobes: &[Lobe]) -> Result<Self, Error> {
        Self::new(Domain::Sphere, 1.0, &[], lobes)
    }

    /// Makes a mixture of squeezed and round lobes; the squeeze c narrows (c < 1) or widens along y.
    ///
    /// # Errors
    /// [`Error::Capacity`]; [`Error::Squeeze`] outside [0.01, 2]; [`Error::Amplitude`] if integral or value
    /// could be infinite; and what [`Lobe::new`] refuses.
    pub fn new(domain: Domain, squeeze: f32, squeezed: &[Lobe], round: &[Lobe]) -> Result<Self, Error> {
        let needed = squeezed.len() + round.len();
        if needed > N {
            return Err(Error::Capacity { needed, available: N });
        }
        if !(0.01..=2.0).contains(&squeeze) {
            return Err(Error::Squeeze);
        }
        let mut mixture = Self::empty();
        mixture.begin(Level::current(), domain, Squeeze::new([1.0, 0.0], 1.0, 1.0 / squeeze));
        for (k, lobe) in squeezed.iter().chain(round).enumerate() {
            let Lobe { gaussian, amplitude } =
                Lobe::new(lobe.gaussian.axis, lobe.gaussian.sharpness, lobe.amplitude)?;
            mixture.head.in_plane &= gaussian.axis.y == 0.0;
            *mixture.number_mut(row::AXIS_X, k) = gaussian.axis.x;
            *mixture.number_mut(row::AXIS_Y, k) = gaussian.axis.y;
            *mixture.number_mut(row::AXIS_Z, k) = gaussian.axis.z;
            *mixture.number_mut(row::SHARPNESS, k) = gaussian.sharpness;
            *mixture.number_mut(row::RED, k) = amplitude.x;
            *mixture.number_mut(row::GREEN, k) = amplitude.y;
            *mixture.number_mut(row::BLUE, k) = amplitude.z;
        }
        mixture.finish::<f32>(needed, squeezed.len(), LeaveOut::default());
        // The most that a value can be: the fold doubles a lobe, the squeeze changes solid angles.
        let most = lobes_at_most(squeezed) * (1.0 / squeeze).max(squeeze * squeeze) + lobes_at_most(round);
        let is_finite = mixture.albedo().is_finite() && most.is_finite();
        if is_finite { Ok(mixture) } else { Err(Error::Amplitude) }
    }

    /// The same lobes beside a diffuse term of an albedo, linear sRGB: `albedo cos / pi` is added to the
    /// value.
    ///
    /// # Errors
    /// [`Error::Amplitude`] for a colour that no [`Lobe`] may have, and for a mixture that lives on the whole
    /// sphere or has factors.
    pub fn with_diffuse(mut self, albedo: impl Into<Vec3>) -> Result<Self, Error> {
        let albedo = albedo.into();
        if !color::is_admissible(albedo) || self.head.domain == Domain::Sphere || self.has_factors() {
            return Err(Error::Amplitude);
        }
        if self.head.count == 0 {
            self.head.level = Level::current();
        }
        self.set_diffuse(albedo.to_array());
        self.add_diffuse();
        if self.albedo().is_finite() { Ok(self) } else { Err(Error::Amplitude) }
    }

    /// The same, with the kernels of a level, whatever [`Level::set`] chose.
    /// [`with_diffuse`](Self::with_diffuse) on a mixture without lobes chooses anew: call it before.
    ///
    /// # Errors
    /// [`Error::Level`] if this processor or this build lacks it.
    pub fn with_level(mut self, level: Level) -> Result<Self, Error> {
        if !level.is_available() {
            return Err(Error::Level);
        }
        self.head.level = level;
        Ok(self)
    }
}
