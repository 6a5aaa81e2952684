//! Each pair of directions its own mixture, as a wavefront renderer needs it.
//!
//! With vectors the pairs are taken in blocks, see `block.rs`, whose mixtures never leave the cache; without,
//! and where there are only a few, one after the other. With its block, a call takes up to 30 kB of stack, 44
//! or 74 where a material has more than 16 or 32 lobes.

#[cfg(feature = "simd")]
use super::block::{DrawBlock, SumBlock};
#[cfg(feature = "simd")]
use super::multiply_factors::multiply_block;
use super::prepare::PrepareInto;
#[cfg(feature = "simd")]
use super::sights::{MOST, Numbers};
use super::slices::{SamplesMut, same_length};
use crate::color::luminance;
use crate::error::Error;
use crate::material::borrowed::Material;
use crate::mixture::rows::Mixture;
#[cfg(feature = "simd")]
use crate::mixture::rows::weight;
use crate::simd::detect::Level;
use glam::Vec3;

impl<'m> Material<'m> {
    /// Evaluates `f cos` and the density for n pairs of an outgoing and an incident direction.
    ///
    /// The same values as [`prepare`](Self::prepare) and [`Mixture::evaluate`], pair by pair. An outgoing
    /// direction below the horizon, or none at all (not finite, not of unit length), gives 0.
    ///
    /// This and the other calls for pairs use up to 30 kB of stack, 44 or 74 kB for materials of more than 16
    /// or 32 lobes; 17 kB without the feature `simd`.
    ///
    /// Shapes: `wo` and `wi` x, y, z, each `[n]`; `value` red, green, blue, each `[n]`, and `pdf` `[n]`,
    /// overwritten; 1/sr.
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
            0..=16 => for_each::<16>(self, wo, &mut EvaluatePairs { wi, value, pdf }),
            17..=32 => for_each::<32>(self, wo, &mut EvaluatePairs { wi, value, pdf }),
            _ => for_each::<64>(self, wo, &mut EvaluatePairs { wi, value, pdf }),
        }
        Ok(())
    }

    /// Draws an incident direction for each of n outgoing ones, with density and weight `f cos / pdf`.
    ///
    /// The same samples as [`prepare`](Self::prepare) and [`Mixture::sample`], one by one. Where nothing is
    /// reflected (and for an outgoing direction that is none) the sample is the normal with density 0 and
    /// weight 0.
    ///
    /// Shapes: `wo` x, y, z and `u` three uniform numbers in [0, 1), each `[n]`; `samples`, every slice
    /// `[n]`, overwritten.
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
            0..=16 => for_each::<16>(self, wo, &mut SamplePairs { u, samples }),
            17..=32 => for_each::<32>(self, wo, &mut SamplePairs { u, samples }),
            _ => for_each::<64>(self, wo, &mut SamplePairs { u, samples }),
        }
        Ok(())
    }

    /// Evaluates the density alone for n pairs of an outgoing and an incident direction; 1/sr.
    ///
    /// One sum over the lobes in place of the three of [`evaluate_pairs_into`](Self::evaluate_pairs_into),
    /// which has the same densities within rounding, and the same say on outgoing directions that are none.
    ///
    /// Shapes: `wo` and `wi` x, y, z, each `[n]`; `pdf` `[n]`, overwritten.
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
    /// Shapes: `wo` and `wi` x, y, z, each `[n]`; `luminance` `[n]`, overwritten.
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
        match self.lobe_count() {
            0..=16 => for_each::<16>(self, wo, &mut OneChannelPairs { wi, out, is_pdf }),
            17..=32 => for_each::<32>(self, wo, &mut OneChannelPairs { wi, out, is_pdf }),
            _ => for_each::<64>(self, wo, &mut OneChannelPairs { wi, out, is_pdf }),
        }
        Ok(())
    }

    /// Draws an incident direction for each of n outgoing ones, with density, without a weight.
    ///
    /// One colour channel in place of three: the samples of [`sample_pairs_into`](Self::sample_pairs_into),
    /// for callers that take the value elsewhere. Where nothing is reflected the sample is the normal with
    /// density 0.
    ///
    /// Shapes: `wo` x, y, z and `u` three uniform numbers in [0, 1), each `[n]`; `direction` x, y, z, and
    /// `pdf`, each `[n]`, overwritten; 1/sr.
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
        match self.lobe_count() {
            0..=16 => for_each::<16>(self, wo, &mut SamplePdfPairs { u, direction, pdf }),
            17..=32 => for_each::<32>(self, wo, &mut SamplePdfPairs { u, direction, pdf }),
            _ => for_each::<64>(self, wo, &mut SamplePdfPairs { u, direction, pdf }),
        }
        Ok(())
    }

    /// Makes the mixtures for n outgoing directions; see [`prepare`](Self::prepare).
    ///
    /// Shapes: `wo` x, y, z, each `[n]`; `mixtures` `[n]`, overwritten. A direction that is none gives an
    /// empty mixture.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; [`Error::Capacity`] if a mixture has room
    /// for fewer lobes than the material has. Nothing is written then.
    pub fn prepare_into<const N: usize>(
        &self,
        wo: [&[f32]; 3],
        mixtures: &mut [Mixture<'m, N>],
    ) -> Result<(), Error> {
        same_length(wo.iter().map(|s| s.len()).chain([mixtures.len()]))?;
        if self.lobe_count() > N {
            return Err(Error::Capacity { needed: self.lobe_count(), available: N });
        }
        let level = Level::current();
        level.run(PrepareInto { material: self, wo, level, mixtures });
        Ok(())
    }
}

/// One direction, or three uniform numbers.
fn at(vectors: &[&[f32]; 3], i: usize) -> Vec3 {
    Vec3::new(vectors[0][i], vectors[1][i], vectors[2][i])
}

/// What is done with every pair, its mixture made.
trait Each<const N: usize> {
    /// For mixture `m`, an empty one if the outgoing direction of pair `i` was none.
    fn one(&mut self, m: &Mixture<'_, N>, i: usize);
    /// For the pairs from `from` on, as many as mixtures, at most [`MOST`].
    #[cfg(feature = "simd")]
    fn block(&mut self, level: Level, mixtures: &[Mixture<'_, N>], from: usize);
}

/// Fewer pairs than this are taken one by one.
#[cfg(feature = "simd")]
const FEW: usize = 4;

fn for_each<const N: usize>(material: &Material<'_>, wo: [&[f32]; 3], each: &mut impl Each<N>) {
    let n = wo[0].len();
    #[cfg(feature = "simd")]
    let level = Level::current();
    #[cfg(feature = "simd")]
    if n >= FEW && level != Level::Scalar {
        let mut mixtures = [const { Mixture::<N>::empty() }; MOST];
        let mut from = 0;
        while from < n {
            let count = MOST.min(n - from);
            let [x, y, z] = wo.map(|s| &s[from..from + count]);
            let mixtures = &mut mixtures[..count];
            level.run(PrepareInto { material, wo: [x, y, z], level, mixtures });
            each.block(level, mixtures, from);
            from += count;
        }
        return;
    }
    let mut mixture = Mixture::<N>::empty();
    for i in 0..n {
        // A direction that is none leaves the mixture empty; it has room for all lobes.
        let _ = material.prepare(at(&wo, i), &mut mixture);
        each.one(&mixture, i);
    }
}

/// The numbers of a block, padded with harmless ones: a direction, or uniform numbers.
#[cfg(feature = "simd")]
fn padded(vectors: &[&[f32]; 3], from: usize, count: usize) -> [Numbers; 3] {
    let mut block = [[0.5; MOST]; 3];
    for (block, from_here) in block.iter_mut().zip(vectors.map(|s| &s[from..from + count])) {
        block[..count].copy_from_slice(from_here);
    }
    block
}

/// Copies a block of directions out.
#[cfg(feature = "simd")]
fn copy_out(block: &[Numbers; 3], to: [&mut [f32]; 3], from: usize, count: usize) {
    for (block, to) in block.iter().zip(to) {
        to[from..from + count].copy_from_slice(&block[..count]);
    }
}

struct EvaluatePairs<'a> {
    wi: [&'a [f32]; 3],
    value: [&'a mut [f32]; 3],
    pdf: &'a mut [f32],
}

impl<const N: usize> Each<N> for EvaluatePairs<'_> {
    fn one(&mut self, m: &Mixture<'_, N>, i: usize) {
        let (value, pdf) =
            if m.is_nothing() { (Vec3::ZERO, 0.0) } else { m.evaluate_and_pdf(at(&self.wi, i)) };
        self.pdf[i] = pdf;
        let [red, green, blue] = &mut self.value;
        [red[i], green[i], blue[i]] = value.to_array();
    }

    #[cfg(feature = "simd")]
    fn block(&mut self, level: Level, mixtures: &[Mixture<'_, N>], from: usize) {
        let count = mixtures.len();
        let directions = &padded(&self.wi, from, count);
        let mut value = level.run(SumBlock::<N, 3> { mixtures, directions });
        for (i, m) in mixtures.iter().enumerate() {
            let value = Vec3::new(value[0][i], value[1][i], value[2][i]);
            self.pdf[from + i] = luminance(value) * m.inverse_power;
        }
        multiply_block(level, mixtures, directions, &mut value);
        let [red, green, blue] = &mut self.value;
        copy_out(&value, [red, green, blue], from, count);
    }
}

struct SamplePairs<'a> {
    u: [&'a [f32]; 3],
    samples: SamplesMut<'a>,
}

impl<const N: usize> Each<N> for SamplePairs<'_> {
    fn one(&mut self, m: &Mixture<'_, N>, i: usize) {
        let u = at(&self.u, i).to_array();
        let (direction, pdf, weight) = match m.sample(u) {
            Some(sample) => (sample.direction, sample.pdf, sample.weight()),
            None => (Vec3::Z, 0.0, Vec3::ZERO),
        };
        let SamplesMut { direction: [x, y, z], pdf: pdf_out, weight: [red, green, blue] } = &mut self.samples;
        [x[i], y[i], z[i]] = direction.to_array();
        pdf_out[i] = pdf;
        [red[i], green[i], blue[i]] = weight.to_array();
    }

    #[cfg(feature = "simd")]
    fn block(&mut self, level: Level, mixtures: &[Mixture<'_, N>], from: usize) {
        let count = mixtures.len();
        let directions = level.run(DrawBlock { mixtures, u: &padded(&self.u, from, count) });
        let mut value = level.run(SumBlock::<N, 3> { mixtures, directions: &directions });
        let SamplesMut { direction: [x, y, z], pdf, weight: [red, green, blue] } = &mut self.samples;
        for (i, m) in mixtures.iter().enumerate() {
            let density = luminance(Vec3::new(value[0][i], value[1][i], value[2][i])) * m.inverse_power;
            pdf[from + i] = density;
        }
        multiply_block(level, mixtures, &directions, &mut value);
        for i in 0..count {
            let (value, density) = (Vec3::new(value[0][i], value[1][i], value[2][i]), pdf[from + i]);
            [red[from + i], green[from + i], blue[from + i]] = weight(value, density).to_array();
        }
        copy_out(&directions, [x, y, z], from, count);
    }
}

/// Density or luminance.
struct OneChannelPairs<'a> {
    wi: [&'a [f32]; 3],
    out: &'a mut [f32],
    is_pdf: bool,
}

impl<const N: usize> Each<N> for OneChannelPairs<'_> {
    fn one(&mut self, m: &Mixture<'_, N>, i: usize) {
        let d = at(&self.wi, i);
        self.out[i] = if m.is_nothing() {
            0.0
        } else if self.is_pdf {
            m.pdf(d)
        } else if m.has_factors() {
            luminance(m.evaluate(d))
        } else {
            m.pdf(d) * m.power
        };
    }

    #[cfg(feature = "simd")]
    fn block(&mut self, level: Level, mixtures: &[Mixture<'_, N>], from: usize) {
        let directions = &padded(&self.wi, from, mixtures.len());
        if !self.is_pdf && mixtures.iter().any(Mixture::has_factors) {
            let mut value = level.run(SumBlock::<N, 3> { mixtures, directions });
            multiply_block(level, mixtures, directions, &mut value);
            let [red, green, blue] = value;
            for (i, out) in self.out[from..from + mixtures.len()].iter_mut().enumerate() {
                *out = luminance(Vec3::new(red[i], green[i], blue[i]));
            }
            return;
        }
        let [sums] = level.run(SumBlock::<N, 1> { mixtures, directions });
        for (i, m) in mixtures.iter().enumerate() {
            self.out[from + i] = if self.is_pdf { sums[i] * m.inverse_power } else { sums[i] };
        }
    }
}

struct SamplePdfPairs<'a> {
    u: [&'a [f32]; 3],
    direction: [&'a mut [f32]; 3],
    pdf: &'a mut [f32],
}

impl<const N: usize> Each<N> for SamplePdfPairs<'_> {
    fn one(&mut self, m: &Mixture<'_, N>, i: usize) {
        let direction = m.sample_direction(at(&self.u, i).to_array()).unwrap_or(Vec3::Z);
        self.pdf[i] = m.pdf(direction);
        let [x, y, z] = &mut self.direction;
        [x[i], y[i], z[i]] = direction.to_array();
    }

    #[cfg(feature = "simd")]
    fn block(&mut self, level: Level, mixtures: &[Mixture<'_, N>], from: usize) {
        let count = mixtures.len();
        let directions = level.run(DrawBlock { mixtures, u: &padded(&self.u, from, count) });
        let [sums] = level.run(SumBlock::<N, 1> { mixtures, directions: &directions });
        for (i, m) in mixtures.iter().enumerate() {
            self.pdf[from + i] = sums[i] * m.inverse_power;
        }
        let [x, y, z] = &mut self.direction;
        copy_out(&directions, [x, y, z], from, count);
    }
}
