//! Pairs: every outgoing direction has its own mixture, as a wavefront renderer needs it.
//!
//! Lanes are lobes: the pairs are taken one after the other, mixture and all, inside one call of the back end. The
//! mixtures never leave the cache.

use crate::batch::{SamplesMut, same_length, sample_one};
use crate::lanes::Lanes;
use crate::prepare::prepare;
use crate::simd::{Level, Routine};
use crate::single::{luminance_one, value_one};
use crate::{Error, LeaveOut, Material, Mixture, luminance};
use glam::Vec3;

impl Material<'_> {
    /// Evaluates `f cos` and the density for n pairs of an outgoing and an incident direction.
    ///
    /// The same values as [`prepare`](Self::prepare) and [`Mixture::evaluate`], pair by pair. An outgoing direction
    /// below the horizon, or none at all (not finite, not of unit length), gives 0.
    ///
    /// Shapes: `wo` and `wi` x, y, z, each [n]; `value` red, green, blue, each [n], and `pdf` [n], overwritten; 1/sr.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn evaluate_pairs_into(
        &self,
        wo: [&[f32]; 3],
        wi: [&[f32]; 3],
        value: [&mut [f32]; 3],
        pdf: &mut [f32],
    ) -> Result<(), Error> {
        let outputs = value.iter().map(|s| s.len()).chain([pdf.len()]);
        same_length(wo.iter().chain(&wi).map(|s| s.len()).chain(outputs))?;
        match self.lobe_count() {
            0..=16 => Level::current().run(EvaluatePairs::<16> { material: self, wo, wi, value, pdf }),
            17..=32 => Level::current().run(EvaluatePairs::<32> { material: self, wo, wi, value, pdf }),
            _ => Level::current().run(EvaluatePairs::<64> { material: self, wo, wi, value, pdf }),
        }
        Ok(())
    }

    /// Draws an incident direction for each of n outgoing ones, with density and weight `f cos / pdf`.
    ///
    /// The same samples as [`prepare`](Self::prepare) and [`Mixture::sample`], one by one. Where nothing is reflected
    /// (and for an outgoing direction that is none) the sample is the normal with density 0 and weight 0.
    ///
    /// Shapes: `wo` x, y, z and `u` three uniform numbers in [0, 1), each [n]; `samples`, every slice [n], overwritten.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn sample_pairs_into(
        &self,
        wo: [&[f32]; 3],
        u: [&[f32]; 3],
        samples: SamplesMut<'_>,
    ) -> Result<(), Error> {
        let outputs = samples.direction.iter().chain(&samples.weight).map(|s| s.len());
        same_length(wo.iter().chain(&u).map(|s| s.len()).chain(outputs).chain([samples.pdf.len()]))?;
        match self.lobe_count() {
            0..=16 => Level::current().run(SamplePairs::<16> { material: self, wo, u, samples }),
            17..=32 => Level::current().run(SamplePairs::<32> { material: self, wo, u, samples }),
            _ => Level::current().run(SamplePairs::<64> { material: self, wo, u, samples }),
        }
        Ok(())
    }

    /// Evaluates the density alone for n pairs of an outgoing and an incident direction; 1/sr.
    ///
    /// One sum over the lobes in place of the three of [`evaluate_pairs_into`](Self::evaluate_pairs_into), which has the
    /// same densities within rounding, and the same say on outgoing directions that are none.
    ///
    /// Shapes: `wo` and `wi` x, y, z, each [n]; `pdf` [n], overwritten.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn pdf_pairs_into(&self, wo: [&[f32]; 3], wi: [&[f32]; 3], pdf: &mut [f32]) -> Result<(), Error> {
        self.one_channel_pairs(wo, wi, pdf, true)
    }

    /// Evaluates the luminance of `f cos` for n pairs of an outgoing and an incident direction; 1/sr.
    ///
    /// One colour channel in place of three; else as [`pdf_pairs_into`](Self::pdf_pairs_into).
    ///
    /// Shapes: `wo` and `wi` x, y, z, each [n]; `luminance` [n], overwritten.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn luminance_pairs_into(
        &self,
        wo: [&[f32]; 3],
        wi: [&[f32]; 3],
        luminance: &mut [f32],
    ) -> Result<(), Error> {
        self.one_channel_pairs(wo, wi, luminance, false)
    }

    fn one_channel_pairs(
        &self,
        wo: [&[f32]; 3],
        wi: [&[f32]; 3],
        out: &mut [f32],
        is_pdf: bool,
    ) -> Result<(), Error> {
        same_length(wo.iter().chain(&wi).map(|s| s.len()).chain([out.len()]))?;
        let material = self;
        match self.lobe_count() {
            0..=16 => Level::current().run(OneChannelPairs::<16> { material, wo, wi, out, is_pdf }),
            17..=32 => Level::current().run(OneChannelPairs::<32> { material, wo, wi, out, is_pdf }),
            _ => Level::current().run(OneChannelPairs::<64> { material, wo, wi, out, is_pdf }),
        }
        Ok(())
    }

    /// Draws an incident direction for each of n outgoing ones, with density, without a weight.
    ///
    /// One colour channel in place of three: the samples of [`sample_pairs_into`](Self::sample_pairs_into), for callers
    /// that take the value elsewhere. Where nothing is reflected the sample is the normal with density 0.
    ///
    /// Shapes: `wo` x, y, z and `u` three uniform numbers in [0, 1), each [n]; `direction` x, y, z, and `pdf`, each [n],
    /// overwritten; 1/sr.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn sample_pdf_pairs_into(
        &self,
        wo: [&[f32]; 3],
        u: [&[f32]; 3],
        direction: [&mut [f32]; 3],
        pdf: &mut [f32],
    ) -> Result<(), Error> {
        let outputs = direction.iter().map(|s| s.len()).chain([pdf.len()]);
        same_length(wo.iter().chain(&u).map(|s| s.len()).chain(outputs))?;
        let material = self;
        match self.lobe_count() {
            0..=16 => Level::current().run(SamplePdfPairs::<16> { material, wo, u, direction, pdf }),
            17..=32 => Level::current().run(SamplePdfPairs::<32> { material, wo, u, direction, pdf }),
            _ => Level::current().run(SamplePdfPairs::<64> { material, wo, u, direction, pdf }),
        }
        Ok(())
    }

    /// Makes the mixtures for n outgoing directions; see [`prepare`](Self::prepare).
    ///
    /// Shapes: `wo` x, y, z, each [n]; `mixtures` [n], overwritten. A direction that is none gives an empty mixture.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; [`Error::Capacity`] if a mixture has room for fewer
    /// lobes than the material has. Nothing is written then.
    pub fn prepare_into<const N: usize>(
        &self,
        wo: [&[f32]; 3],
        mixtures: &mut [Mixture<N>],
    ) -> Result<(), Error> {
        same_length(wo.iter().map(|s| s.len()).chain([mixtures.len()]))?;
        if self.lobe_count() > N {
            return Err(Error::Capacity { needed: self.lobe_count(), available: N });
        }
        Level::current().run(PrepareInto { material: self, wo, mixtures });
        Ok(())
    }
}

#[inline(always)]
fn at(vectors: &[&[f32]; 3], i: usize) -> Vec3 {
    Vec3::new(vectors[0][i], vectors[1][i], vectors[2][i])
}

struct EvaluatePairs<'a, 'b, const N: usize> {
    material: &'a Material<'b>,
    wo: [&'a [f32]; 3],
    wi: [&'a [f32]; 3],
    value: [&'a mut [f32]; 3],
    pdf: &'a mut [f32],
}

impl<const N: usize> Routine for EvaluatePairs<'_, '_, N> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { material, wo, wi, value: [red, green, blue], pdf } = self;
        let mut m = Mixture::<N>::empty();
        for i in 0..pdf.len() {
            let prepared = prepare::<L, N>(material, at(&wo, i), LeaveOut::default(), &mut m).is_ok();
            let value = if prepared { value_one::<L, N>(&m, at(&wi, i).to_array()) } else { Vec3::ZERO };
            [red[i], green[i], blue[i]] = value.to_array();
            pdf[i] = luminance(value) * m.inverse_power;
        }
    }
}

struct SamplePairs<'a, 'b, const N: usize> {
    material: &'a Material<'b>,
    wo: [&'a [f32]; 3],
    u: [&'a [f32]; 3],
    samples: SamplesMut<'a>,
}

impl<const N: usize> Routine for SamplePairs<'_, '_, N> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { material, wo, u, samples } = self;
        let SamplesMut { direction: [x, y, z], pdf, weight: [red, green, blue] } = samples;
        let mut m = Mixture::<N>::empty();
        for i in 0..pdf.len() {
            let mut direction = [0.0, 0.0, 1.0];
            let mut value = Vec3::ZERO;
            if prepare::<L, N>(material, at(&wo, i), LeaveOut::default(), &mut m).is_ok() && m.power > 0.0 {
                let u = [u[0][i], u[1][i], u[2][i]];
                direction = sample_one::<L, N>(&m, u);
                value = value_one::<L, N>(&m, direction);
            }
            let density = luminance(value) * m.inverse_power;
            let weight = if density > 0.0 { value / density } else { Vec3::ZERO };
            [x[i], y[i], z[i]] = direction;
            pdf[i] = density;
            [red[i], green[i], blue[i]] = weight.to_array();
        }
    }
}

/// Density or luminance.
struct OneChannelPairs<'a, 'b, const N: usize> {
    material: &'a Material<'b>,
    wo: [&'a [f32]; 3],
    wi: [&'a [f32]; 3],
    out: &'a mut [f32],
    is_pdf: bool,
}

impl<const N: usize> Routine for OneChannelPairs<'_, '_, N> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { material, wo, wi, out, is_pdf } = self;
        let mut m = Mixture::<N>::empty();
        for (i, out) in out.iter_mut().enumerate() {
            let prepared = prepare::<L, N>(material, at(&wo, i), LeaveOut::default(), &mut m).is_ok();
            let value = if prepared { luminance_one::<L, N>(&m, at(&wi, i).to_array()) } else { 0.0 };
            *out = if is_pdf { value * m.inverse_power } else { value };
        }
    }
}

struct SamplePdfPairs<'a, 'b, const N: usize> {
    material: &'a Material<'b>,
    wo: [&'a [f32]; 3],
    u: [&'a [f32]; 3],
    direction: [&'a mut [f32]; 3],
    pdf: &'a mut [f32],
}

impl<const N: usize> Routine for SamplePdfPairs<'_, '_, N> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { material, wo, u, direction: [x, y, z], pdf } = self;
        let mut m = Mixture::<N>::empty();
        for i in 0..pdf.len() {
            let mut direction = [0.0, 0.0, 1.0];
            pdf[i] = 0.0;
            if prepare::<L, N>(material, at(&wo, i), LeaveOut::default(), &mut m).is_ok() && m.power > 0.0 {
                direction = sample_one::<L, N>(&m, [u[0][i], u[1][i], u[2][i]]);
                pdf[i] = luminance_one::<L, N>(&m, direction) * m.inverse_power;
            }
            [x[i], y[i], z[i]] = direction;
        }
    }
}

struct PrepareInto<'a, 'b, const N: usize> {
    material: &'a Material<'b>,
    wo: [&'a [f32]; 3],
    mixtures: &'a mut [Mixture<N>],
}

impl<const N: usize> Routine for PrepareInto<'_, '_, N> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        for (i, mixture) in self.mixtures.iter_mut().enumerate() {
            // A direction that is none leaves the mixture empty; the capacity has been checked.
            let _ = prepare::<L, N>(self.material, at(&self.wo, i), LeaveOut::default(), mixture);
        }
    }
}
