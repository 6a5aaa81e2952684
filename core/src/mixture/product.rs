//! Products of mixtures, and their integrals: of plain lobes only.
//!
//! Squeezed lobes, a diffuse term and factors are no Gaussians, nor are their products: a mixture that has one is
//! refused. A fitted material has them; mixtures of lobes of one's own need not. They stand here, not beside `zonal`:
//! they read the rows of a mixture, which that room may not import.

use super::row;
use super::rows::{AnyMixture, Domain};
use crate::error::Error;
use crate::lobe::gaussian::{Gaussian, Lobe};
use glam::Vec3;

impl AnyMixture<'_> {
    /// Multiplies two mixtures of plain lobes, lobe by lobe, into the caller's storage.
    ///
    /// A folded lobe counts as two, itself and its mirror image. The products are not folded: they are lobes of the caller's
    /// shading frame. They stand for the product on the domain that both mixtures share, the upper hemisphere unless both live on
    /// the sphere. Integrate them there, for example by [`Gaussian::hemisphere_integral`](crate::Gaussian::hemisphere_integral).
    ///
    /// Returns: how many lobes were written. Shapes: `out` [(lobes + folded lobes) of the one times those of
    /// the other]; [`product_len`](Self::product_len) says.
    ///
    /// # Errors
    /// [`Error::Capacity`]; [`Error::Squeezed`], since a squeezed lobe, a diffuse term or a factor times a
    /// lobe is not a lobe.
    pub fn product_into(&self, other: &AnyMixture<'_>, out: &mut [Lobe]) -> Result<usize, Error> {
        self.check_round()?;
        other.check_round()?;
        let needed = self.product_len(other);
        if out.len() < needed {
            return Err(Error::Capacity { needed, available: out.len() });
        }
        let pairs = self.unfolded().flat_map(|a| other.unfolded().map(move |b| (a, b)));
        for (slot, (a, b)) in out.iter_mut().zip(pairs) {
            *slot = a.product(&b);
        }
        Ok(needed)
    }

    /// Number of lobes that [`product_into`](Self::product_into) writes.
    pub fn product_len(&self, other: &AnyMixture<'_>) -> usize {
        let count = |lobes: usize, folded: u64| lobes + folded.count_ones() as usize;
        count(self.head.count, self.head.folded) * count(other.head.count, other.head.folded)
    }

    /// Integrates the product of two mixtures of plain lobes over the domain that they share; channel by
    /// channel.
    ///
    /// On the sphere, and between two folded mixtures, in closed form: folded mixtures are even in z, so the
    /// integral over the upper hemisphere is half of that over the sphere, `sum of (G_j + G_j mirrored) G_k`
    /// over the sphere. Between a folded mixture and one on the sphere by [`Gaussian::hemisphere_integral`].
    ///
    /// # Errors
    /// [`Error::Squeezed`], for squeezed lobes, diffuse terms and factors; [`Error::Amplitude`] where f32 overflows.
    #[doc(alias = "spherical singular integral")]
    pub fn inner_product(&self, other: &AnyMixture<'_>) -> Result<Vec3, Error> {
        self.check_round()?;
        other.check_round()?;
        let mut sum = Vec3::ZERO;
        if self.head.domain == other.head.domain {
            for a in (0..self.head.count).map(|k| self.lobe_in_shading_frame(k)) {
                for b in (0..other.head.count).map(|k| other.lobe_in_shading_frame(k)) {
                    sum += a.inner_product(&b);
                    if self.head.domain == Domain::Hemisphere {
                        sum += a.inner_product(&b.mirrored());
                    }
                }
            }
        } else {
            for a in self.unfolded() {
                for b in other.unfolded() {
                    sum += a.integrated_product(&b, Gaussian::hemisphere_integral);
                }
            }
        }
        if sum.is_finite() { Ok(sum) } else { Err(Error::Amplitude) }
    }

    fn check_round(&self) -> Result<(), Error> {
        let squeezed = self.head.squeezed > 0 && !self.head.squeeze.is_round();
        if squeezed || self.head.diffuse != Vec3::ZERO || self.has_factors() {
            Err(Error::Squeezed)
        } else {
            Ok(())
        }
    }

    /// Lobe `k < len` with its axis turned to the caller's shading frame.
    fn lobe_in_shading_frame(&self, k: usize) -> Lobe {
        let axis = Vec3::from_array(self.head.squeeze.turn_back([
            self.number(row::AXIS_X, k),
            self.number(row::AXIS_Y, k),
            self.number(row::AXIS_Z, k),
        ]));
        let amplitude =
            Vec3::new(self.number(row::RED, k), self.number(row::GREEN, k), self.number(row::BLUE, k));
        Lobe { gaussian: Gaussian { axis, ..self.gaussian(k) }, amplitude }
    }

    /// All lobes in the caller's shading frame, each followed by its mirror image if it is folded.
    fn unfolded(&self) -> impl Iterator<Item = Lobe> {
        (0..self.head.count).flat_map(|k| {
            let lobe = self.lobe_in_shading_frame(k);
            let mirrored = (self.head.folded >> k & 1 == 1).then(|| lobe.mirrored());
            core::iter::once(lobe).chain(mirrored)
        })
    }
}
