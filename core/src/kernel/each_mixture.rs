//! Each pair of directions its own mixture, as a wavefront renderer needs it: of one material, or of mixtures that
//! are there.
//!
//! With vectors the pairs are taken in blocks, see `block.rs`, whose mixtures never leave the cache; without,
//! and where there are only a few, one after the other. With its block, a call takes up to 30 kB of stack, 44
//! or 74 where a material has more than 16 or 32 lobes.

#[cfg(feature = "simd")]
use super::block::{DrawBlock, SumBlock};
#[cfg(feature = "simd")]
use super::multiply_factors::multiply_block;
use super::prepare::{prepare, prepare_each};
use super::sights::MOST;
#[cfg(feature = "simd")]
use super::sights::Numbers;
use super::slices::{SamplesMut, same_length};
#[cfg(feature = "simd")]
use crate::color::luminance;
use crate::error::Error;
use crate::material::borrowed::{Material, MaterialRef};
#[cfg(feature = "simd")]
use crate::mixture::factors::Nodes;
use crate::mixture::leave_out::LeaveOut;
#[cfg(feature = "simd")]
use crate::mixture::rows::Domain;
#[cfg(feature = "simd")]
use crate::mixture::rows::weight_of;
use crate::mixture::rows::{Mixture, drawn_density};
use crate::simd::detect::Level;
use core::borrow::{Borrow, BorrowMut};
use glam::Vec3;

/// One outgoing direction for each of n pairs. All these calls use up to 30 kB of stack, 44 or 74 kB for materials
/// of more than 16 or 32 lobes; 17 kB without the feature `simd`.
impl<B: AsRef<[u8]>> Material<B> {
    /// Evaluates `f cos` for n pairs of an outgoing and an incident direction; 1/sr.
    ///
    /// The same values as [`prepare`](Self::prepare) and [`Mixture::evaluate`], pair by pair. An outgoing
    /// direction below the horizon, or none at all (not finite, not of unit length), gives 0.
    ///
    /// Shapes: `wo` and `wi` x, y, z, each `[n]`; `value` red, green, blue, each `[n]`, overwritten.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn evaluate_pairs_into(
        &self,
        wo: [&[f32]; 3],
        wi: [&[f32]; 3],
        value: [&mut [f32]; 3],
    ) -> Result<(), Error> {
        self.for_each_pair(wo, Verb::Evaluate(Evaluate { wi, value, pdf: None }))
    }

    /// Evaluates `f cos` and the density for n pairs of an outgoing and an incident direction; 1/sr.
    ///
    /// Shapes: as in [`evaluate_pairs_into`](Self::evaluate_pairs_into), and `pdf` `[n]`, overwritten.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn evaluate_and_pdf_pairs_into(
        &self,
        wo: [&[f32]; 3],
        wi: [&[f32]; 3],
        value: [&mut [f32]; 3],
        pdf: &mut [f32],
    ) -> Result<(), Error> {
        self.for_each_pair(wo, Verb::Evaluate(Evaluate { wi, value, pdf: Some(pdf) }))
    }

    /// Evaluates the density alone for n pairs of an outgoing and an incident direction; 1/sr.
    ///
    /// One sum over the lobes in place of three: the densities of
    /// [`evaluate_and_pdf_pairs_into`](Self::evaluate_and_pdf_pairs_into) within rounding.
    ///
    /// Shapes: `wo` and `wi` x, y, z, each `[n]`; `pdf` `[n]`, overwritten.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn pdf_pairs_into(&self, wo: [&[f32]; 3], wi: [&[f32]; 3], pdf: &mut [f32]) -> Result<(), Error> {
        self.for_each_pair(wo, Verb::Pdf(Pdf { wi, pdf }))
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
        self.for_each_pair(wo, Verb::Sample(Sample { u, samples }))
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
        self.for_each_pair(wo, Verb::SamplePdf(SamplePdf { u, direction, pdf }))
    }

    /// Draws an incident direction for each of n outgoing ones, and evaluates value and density towards another
    /// one, with one preparation: what next-event estimation needs at every hit.
    ///
    /// Shapes: as in [`sample_pairs_into`](Self::sample_pairs_into) and, of the other directions `wi`, in
    /// [`evaluate_and_pdf_pairs_into`](Self::evaluate_and_pdf_pairs_into).
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn sample_and_evaluate_pairs_into(
        &self,
        wo: [&[f32]; 3],
        u: [&[f32]; 3],
        samples: SamplesMut<'_>,
        wi: [&[f32]; 3],
        value: [&mut [f32]; 3],
        pdf: &mut [f32],
    ) -> Result<(), Error> {
        let evaluate = Evaluate { wi, value, pdf: Some(pdf) };
        self.for_each_pair(wo, Verb::SampleAndEvaluate(Sample { u, samples }, evaluate))
    }

    fn for_each_pair(&self, wo: [&[f32]; 3], mut verb: Verb<'_>) -> Result<(), Error> {
        let n = same_length(wo.iter().map(|s| s.len()))?;
        verb.check(n)?;
        for_each_pair(self.borrowed(), wo, &mut verb);
        Ok(())
    }

    /// Makes the mixtures for n outgoing directions; see [`prepare`](Self::prepare).
    ///
    /// Shapes: `wo` x, y, z, each `[n]`; `mixtures` `[n]`, or references to them, overwritten. A direction that
    /// is none gives an empty mixture.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; [`Error::Capacity`] if a mixture has room
    /// for fewer lobes than the material has. Nothing is written then.
    pub fn prepare_into<'a, const N: usize>(
        &'a self,
        wo: [&[f32]; 3],
        mixtures: &mut [impl BorrowMut<Mixture<'a, N>>],
    ) -> Result<(), Error> {
        same_length(wo.iter().map(|s| s.len()).chain([mixtures.len()]))?;
        if self.lobe_count() > N {
            return Err(Error::Capacity { needed: self.lobe_count(), available: N });
        }
        let (material, level) = (self.borrowed(), Level::current());
        for (block, mixtures) in mixtures.chunks_mut(MOST).enumerate() {
            let (from, count) = (block * MOST, mixtures.len());
            let wo = wo.map(|s| &s[from..from + count]);
            let mut left = mixtures.iter_mut();
            let mut mixtures: [_; MOST] = core::array::from_fn(|_| left.next().map(BorrowMut::borrow_mut));
            prepare_each(material, wo, level, &mut mixtures[..count]);
        }
        Ok(())
    }
}

/// One direction for each of n mixtures, or references to them. Every mixture uses the kernels of its own level;
/// those of one level and one material are taken in blocks.
impl<'m, const N: usize> Mixture<'m, N> {
    /// Evaluates `f cos` for n pairs of a mixture and an incident direction; 1/sr.
    ///
    /// Shapes: `mixtures` `[n]`; `wi` x, y, z, each `[n]`; `value` red, green, blue, each `[n]`, overwritten.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn evaluate_pairs_into(
        mixtures: &[impl Borrow<Self>],
        wi: [&[f32]; 3],
        value: [&mut [f32]; 3],
    ) -> Result<(), Error> {
        for_each_mixture(mixtures, Verb::Evaluate(Evaluate { wi, value, pdf: None }))
    }

    /// Evaluates `f cos` and the density for n pairs of a mixture and an incident direction; 1/sr.
    ///
    /// Shapes: as in [`evaluate_pairs_into`](Self::evaluate_pairs_into), and `pdf` `[n]`, overwritten.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn evaluate_and_pdf_pairs_into(
        mixtures: &[impl Borrow<Self>],
        wi: [&[f32]; 3],
        value: [&mut [f32]; 3],
        pdf: &mut [f32],
    ) -> Result<(), Error> {
        for_each_mixture(mixtures, Verb::Evaluate(Evaluate { wi, value, pdf: Some(pdf) }))
    }

    /// Evaluates the density alone for n pairs of a mixture and an incident direction; 1/sr.
    ///
    /// Shapes: `mixtures` `[n]`; `wi` x, y, z, each `[n]`; `pdf` `[n]`, overwritten.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn pdf_pairs_into(
        mixtures: &[impl Borrow<Self>],
        wi: [&[f32]; 3],
        pdf: &mut [f32],
    ) -> Result<(), Error> {
        for_each_mixture(mixtures, Verb::Pdf(Pdf { wi, pdf }))
    }

    /// Draws one direction from each of n mixtures, with density and weight `f cos / pdf`.
    ///
    /// A mixture that reflects nothing gives the normal with density 0 and weight 0.
    ///
    /// Shapes: `mixtures` `[n]`; `u` three uniform numbers in [0, 1), each `[n]`; `samples`, every slice `[n]`,
    /// overwritten.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn sample_pairs_into(
        mixtures: &[impl Borrow<Self>],
        u: [&[f32]; 3],
        samples: SamplesMut<'_>,
    ) -> Result<(), Error> {
        for_each_mixture(mixtures, Verb::Sample(Sample { u, samples }))
    }

    /// Draws one direction from each of n mixtures, with density, without a weight.
    ///
    /// Shapes: as in [`sample_pairs_into`](Self::sample_pairs_into); `direction` x, y, z, and `pdf`, each `[n]`,
    /// overwritten; 1/sr.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn sample_pdf_pairs_into(
        mixtures: &[impl Borrow<Self>],
        u: [&[f32]; 3],
        direction: [&mut [f32]; 3],
        pdf: &mut [f32],
    ) -> Result<(), Error> {
        for_each_mixture(mixtures, Verb::SamplePdf(SamplePdf { u, direction, pdf }))
    }

    /// Draws one direction from each of n mixtures, and evaluates value and density towards another one.
    ///
    /// Shapes: as in [`sample_pairs_into`](Self::sample_pairs_into) and, of the other directions `wi`, in
    /// [`evaluate_and_pdf_pairs_into`](Self::evaluate_and_pdf_pairs_into).
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn sample_and_evaluate_pairs_into(
        mixtures: &[impl Borrow<Self>],
        u: [&[f32]; 3],
        samples: SamplesMut<'_>,
        wi: [&[f32]; 3],
        value: [&mut [f32]; 3],
        pdf: &mut [f32],
    ) -> Result<(), Error> {
        let evaluate = Evaluate { wi, value, pdf: Some(pdf) };
        for_each_mixture(mixtures, Verb::SampleAndEvaluate(Sample { u, samples }, evaluate))
    }
}

/// One direction, or three uniform numbers.
fn at(vectors: &[&[f32]; 3], i: usize) -> Vec3 {
    Vec3::new(vectors[0][i], vectors[1][i], vectors[2][i])
}

/// What is done with every pair, its mixture made.
enum Verb<'a> {
    Evaluate(Evaluate<'a>),
    Pdf(Pdf<'a>),
    Sample(Sample<'a>),
    SamplePdf(SamplePdf<'a>),
    SampleAndEvaluate(Sample<'a>, Evaluate<'a>),
}

impl Verb<'_> {
    /// Refuses slices that are not of length `n`.
    fn check(&self, n: usize) -> Result<(), Error> {
        match self {
            Self::Evaluate(evaluate) => evaluate.check(n),
            Self::Pdf(Pdf { wi, pdf }) => all_of(n, wi.iter().map(|s| s.len()).chain([pdf.len()])),
            Self::Sample(sample) => sample.check(n),
            Self::SamplePdf(SamplePdf { u, direction, pdf }) => {
                let outputs = direction.iter().map(|s| s.len()).chain([pdf.len()]);
                all_of(n, u.iter().map(|s| s.len()).chain(outputs))
            }
            Self::SampleAndEvaluate(sample, evaluate) => sample.check(n).and(evaluate.check(n)),
        }
    }

    /// For mixture `m`, an empty one if the outgoing direction of pair `i` was none.
    fn one<const N: usize>(&mut self, m: &Mixture<'_, N>, i: usize) {
        match self {
            Self::Evaluate(evaluate) => evaluate.one(m, i),
            Self::Pdf(Pdf { wi, pdf }) => pdf[i] = if m.is_nothing() { 0.0 } else { m.pdf(at(wi, i)) },
            Self::Sample(sample) => sample.one(m, i),
            Self::SamplePdf(sample) => sample.one(m, i),
            Self::SampleAndEvaluate(sample, evaluate) => {
                sample.one(m, i);
                evaluate.one(m, i);
            }
        }
    }

    /// For the pairs from `from` on, as many as mixtures, at most [`MOST`].
    #[cfg(feature = "simd")]
    fn block<const N: usize>(&mut self, level: Level, mixtures: &[&Mixture<'_, N>], from: usize) {
        match self {
            Self::Evaluate(evaluate) => evaluate.block(level, mixtures, from),
            Self::Pdf(pdf) => pdf.block(level, mixtures, from),
            Self::Sample(sample) => sample.block(level, mixtures, from),
            Self::SamplePdf(sample) => sample.block(level, mixtures, from),
            Self::SampleAndEvaluate(sample, evaluate) => {
                sample.block(level, mixtures, from);
                evaluate.block(level, mixtures, from);
            }
        }
    }
}

/// Fewer pairs than this are taken one by one.
#[cfg(feature = "simd")]
const FEW: usize = 4;

/// Not generic over who owns the bytes of the material: the kernels are compiled here, once.
fn for_each_pair(material: MaterialRef<'_>, wo: [&[f32]; 3], verb: &mut Verb<'_>) {
    match material.header.lobe_count() {
        0..=16 => with_room::<16>(material, wo, verb),
        17..=32 => with_room::<32>(material, wo, verb),
        _ => with_room::<64>(material, wo, verb),
    }
}

fn with_room<const N: usize>(material: MaterialRef<'_>, wo: [&[f32]; 3], verb: &mut Verb<'_>) {
    let n = wo[0].len();
    let level = Level::current();
    #[cfg(feature = "simd")]
    if n >= FEW && level != Level::Scalar {
        let mut mixtures = [const { Mixture::<N>::empty() }; MOST];
        let mut from = 0;
        while from < n {
            let count = MOST.min(n - from);
            let wo = wo.map(|s| &s[from..from + count]);
            let mut made = mixtures.each_mut().map(Some);
            prepare_each(material, wo, level, &mut made[..count]);
            verb.block(level, &mixtures.each_ref()[..count], from);
            from += count;
        }
        return;
    }
    let mut mixture = Mixture::<N>::empty();
    for i in 0..n {
        // A direction that is none leaves the mixture empty; it has room for all lobes.
        let _ = prepare(material, at(&wo, i), LeaveOut::default(), level, &mut mixture);
        verb.one(&mixture, i);
    }
}

fn for_each_mixture<'m, const N: usize>(
    mixtures: &[impl Borrow<Mixture<'m, N>>],
    mut verb: Verb<'_>,
) -> Result<(), Error> {
    verb.check(mixtures.len())?;
    for (block, mixtures) in mixtures.chunks(MOST).enumerate() {
        let (from, last) = (block * MOST, mixtures.len() - 1);
        let block: [&Mixture<'m, N>; MOST] = core::array::from_fn(|i| mixtures[i.min(last)].borrow());
        let block = &block[..=last];
        #[cfg(feature = "simd")]
        if let Some(level) = level_of_block(block) {
            verb.block(level, block, from);
            continue;
        }
        for (i, mixture) in block.iter().enumerate() {
            verb.one(mixture, from + i);
        }
    }
    Ok(())
}

/// The level of mixtures that can be taken together: they have it in common, live on the hemisphere, and have the
/// same factors if any. `None` for others.
#[cfg(feature = "simd")]
fn level_of_block<const N: usize>(mixtures: &[&Mixture<'_, N>]) -> Option<Level> {
    let level = mixtures[0].head.level;
    if mixtures.len() < FEW || level == Level::Scalar {
        return None;
    }
    let factors = mixtures.iter().map(|m| m.head.factors.nodes).find(|nodes| !nodes.is_none());
    let factors = factors.unwrap_or(Nodes::NONE);
    let fits = |m: &&Mixture<'_, N>| {
        let nodes = m.head.factors.nodes;
        // What has neither lobes nor factors may be multiplied by any.
        let same_factors = (nodes.is_none() && m.is_nothing()) || nodes.is(&factors);
        m.head.level == level && m.head.domain == Domain::Hemisphere && same_factors
    };
    mixtures.iter().all(fits).then_some(level)
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

/// Copies a block of directions or colours out.
#[cfg(feature = "simd")]
fn copy_out(block: &[Numbers; 3], to: &mut [&mut [f32]; 3], from: usize, count: usize) {
    for (block, to) in block.iter().zip(to) {
        to[from..from + count].copy_from_slice(&block[..count]);
    }
}

/// The densities of a block, of the values before they are multiplied by factors.
#[cfg(feature = "simd")]
fn densities<const N: usize>(value: &[Numbers; 3], mixtures: &[&Mixture<'_, N>], pdf: &mut [f32]) {
    for (i, (m, pdf)) in mixtures.iter().zip(pdf).enumerate() {
        *pdf = luminance(Vec3::new(value[0][i], value[1][i], value[2][i])) * m.head.inverse_power;
    }
}

fn all_of(n: usize, mut lengths: impl Iterator<Item = usize>) -> Result<(), Error> {
    if lengths.all(|length| length == n) { Ok(()) } else { Err(Error::Length) }
}

/// Values, and perhaps densities.
struct Evaluate<'a> {
    wi: [&'a [f32]; 3],
    value: [&'a mut [f32]; 3],
    pdf: Option<&'a mut [f32]>,
}

impl Evaluate<'_> {
    fn check(&self, n: usize) -> Result<(), Error> {
        let outputs = self.value.iter().map(|s| s.len()).chain(self.pdf.iter().map(|s| s.len()));
        all_of(n, self.wi.iter().map(|s| s.len()).chain(outputs))
    }

    fn one<const N: usize>(&mut self, m: &Mixture<'_, N>, i: usize) {
        let (value, density) =
            if m.is_nothing() { (Vec3::ZERO, 0.0) } else { m.evaluate_and_pdf(at(&self.wi, i)) };
        let [red, green, blue] = &mut self.value;
        [red[i], green[i], blue[i]] = value.to_array();
        if let Some(pdf) = &mut self.pdf {
            pdf[i] = density;
        }
    }

    #[cfg(feature = "simd")]
    fn block<const N: usize>(&mut self, level: Level, mixtures: &[&Mixture<'_, N>], from: usize) {
        let count = mixtures.len();
        let directions = &padded(&self.wi, from, count);
        let mut value = level.run(SumBlock::<N, 3> { mixtures, directions });
        if let Some(pdf) = &mut self.pdf {
            densities(&value, mixtures, &mut pdf[from..from + count]);
        }
        multiply_block(level, mixtures, directions, &mut value);
        copy_out(&value, &mut self.value, from, count);
    }
}

/// Densities.
struct Pdf<'a> {
    wi: [&'a [f32]; 3],
    pdf: &'a mut [f32],
}

impl Pdf<'_> {
    #[cfg(feature = "simd")]
    fn block<const N: usize>(&mut self, level: Level, mixtures: &[&Mixture<'_, N>], from: usize) {
        let directions = &padded(&self.wi, from, mixtures.len());
        let [sums] = level.run(SumBlock::<N, 1> { mixtures, directions });
        for (i, m) in mixtures.iter().enumerate() {
            self.pdf[from + i] = sums[i] * m.head.inverse_power;
        }
    }
}

/// Samples.
struct Sample<'a> {
    u: [&'a [f32]; 3],
    samples: SamplesMut<'a>,
}

impl Sample<'_> {
    fn check(&self, n: usize) -> Result<(), Error> {
        all_of(n, self.u.iter().map(|s| s.len()).chain(self.samples.lengths()))
    }

    fn one<const N: usize>(&mut self, m: &Mixture<'_, N>, i: usize) {
        let u = at(&self.u, i).to_array();
        let (direction, pdf, weight) = match m.sample(u) {
            Some(sample) => (sample.direction, sample.pdf, sample.weight),
            None => (Vec3::Z, 0.0, Vec3::ZERO),
        };
        let SamplesMut { direction: [x, y, z], pdf: pdf_out, weight: [red, green, blue] } = &mut self.samples;
        [x[i], y[i], z[i]] = direction.to_array();
        pdf_out[i] = pdf;
        [red[i], green[i], blue[i]] = weight.to_array();
    }

    #[cfg(feature = "simd")]
    fn block<const N: usize>(&mut self, level: Level, mixtures: &[&Mixture<'_, N>], from: usize) {
        let count = mixtures.len();
        let directions = level.run(DrawBlock { mixtures, u: &padded(&self.u, from, count) });
        let mut value = level.run(SumBlock::<N, 3> { mixtures, directions: &directions });
        let SamplesMut { direction, pdf, weight } = &mut self.samples;
        let pdf = &mut pdf[from..from + count];
        densities(&value, mixtures, pdf);
        multiply_block(level, mixtures, &directions, &mut value);
        for (i, density) in pdf.iter_mut().enumerate() {
            let value = Vec3::new(value[0][i], value[1][i], value[2][i]);
            [weight[0][from + i], weight[1][from + i], weight[2][from + i]] =
                weight_of(value, *density).to_array();
            if mixtures[i].head.power > 0.0 {
                *density = drawn_density(*density);
            }
        }
        copy_out(&directions, direction, from, count);
    }
}

/// Directions with densities.
struct SamplePdf<'a> {
    u: [&'a [f32]; 3],
    direction: [&'a mut [f32]; 3],
    pdf: &'a mut [f32],
}

impl SamplePdf<'_> {
    fn one<const N: usize>(&mut self, m: &Mixture<'_, N>, i: usize) {
        let drawn = m.sample_direction(at(&self.u, i).to_array());
        let direction = drawn.unwrap_or(Vec3::Z);
        self.pdf[i] = drawn.map_or(0.0, |direction| drawn_density(m.pdf(direction)));
        let [x, y, z] = &mut self.direction;
        [x[i], y[i], z[i]] = direction.to_array();
    }

    #[cfg(feature = "simd")]
    fn block<const N: usize>(&mut self, level: Level, mixtures: &[&Mixture<'_, N>], from: usize) {
        let count = mixtures.len();
        let directions = level.run(DrawBlock { mixtures, u: &padded(&self.u, from, count) });
        let [sums] = level.run(SumBlock::<N, 1> { mixtures, directions: &directions });
        for (i, m) in mixtures.iter().enumerate() {
            let density = sums[i] * m.head.inverse_power;
            self.pdf[from + i] = if m.head.power > 0.0 { drawn_density(density) } else { density };
        }
        copy_out(&directions, &mut self.direction, from, count);
    }
}
