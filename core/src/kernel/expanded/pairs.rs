//! The verbs of an expanded material, for n pairs, each with an outgoing direction of its own.

use super::super::multiply_factors::multiply_pairs;
use super::super::sights::{MOST, Numbers};
use super::super::slices::{SamplesMut, same_length};
use super::block::{Evaluate, KEPT, LaneSums, Sample, Sampled, Sums};
use super::table::{CHUNK, Expanded, IN_PLANE, MIRRORED};
use crate::color::luminance;
use crate::error::Error;
use crate::material::layout::MAX_LOBES;
use crate::mixture::factors::Nodes;
use crate::mixture::rows::{LEAST_DENSITY, drawn_density};
use crate::simd::detect::Level;
use glam::Vec3;

/// Most groups of lobes.
const GROUPS: usize = MAX_LOBES / CHUNK;

impl Expanded<'_> {
    /// Evaluates `f cos` for n pairs of an outgoing and an incident direction.
    ///
    /// The values of [`prepare`](Self::prepare) and [`Mixture::evaluate`](crate::Mixture::evaluate) but for
    /// rounding. An outgoing direction below the horizon, or none at all (not finite, not of unit length),
    /// gives 0.
    ///
    /// Shapes: `wo` and `wi` x, y, z, each `[n]`; `value` red, green, blue, each `[n]`, overwritten; 1/sr.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn evaluate_pairs_into(
        &self,
        wo: [&[f32]; 3],
        wi: [&[f32]; 3],
        mut value: [&mut [f32]; 3],
    ) -> Result<(), Error> {
        same_length(wo.iter().chain(&wi).map(|s| s.len()).chain(value.iter().map(|s| s.len())))?;
        let (level, mut lanes) = (Level::current(), LaneSums::NONE);
        for block in Block::all(wo[0].len()) {
            let (outgoing, incident) = (block.padded(&wo), block.padded(&wi));
            let mut sums = self.evaluate::<3>(level, block.count, &outgoing, &incident, &mut lanes);
            self.multiply(level, &outgoing, &incident, &mut sums);
            block.copy_out(&sums.value, &mut value);
        }
        Ok(())
    }

    /// Evaluates `f cos` and the density for n pairs of an outgoing and an incident direction.
    ///
    /// Shapes: `wo` and `wi` x, y, z, each `[n]`; `value` red, green, blue, each `[n]`, and `pdf` `[n]`,
    /// overwritten; 1/sr.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn evaluate_and_pdf_pairs_into(
        &self,
        wo: [&[f32]; 3],
        wi: [&[f32]; 3],
        mut value: [&mut [f32]; 3],
        pdf: &mut [f32],
    ) -> Result<(), Error> {
        let outputs = value.iter().map(|s| s.len()).chain([pdf.len()]);
        same_length(wo.iter().chain(&wi).map(|s| s.len()).chain(outputs))?;
        let (level, mut lanes) = (Level::current(), LaneSums::NONE);
        for block in Block::all(wo[0].len()) {
            let (outgoing, incident) = (block.padded(&wo), block.padded(&wi));
            let mut sums = self.evaluate::<3>(level, block.count, &outgoing, &incident, &mut lanes);
            block.copy_out(&[densities(&sums)], &mut [&mut *pdf]);
            self.multiply(level, &outgoing, &incident, &mut sums);
            block.copy_out(&sums.value, &mut value);
        }
        Ok(())
    }

    /// Evaluates the density alone for n pairs of an outgoing and an incident direction; 1/sr.
    ///
    /// Shapes: `wo` and `wi` x, y, z, each `[n]`; `pdf` `[n]`, overwritten.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn pdf_pairs_into(&self, wo: [&[f32]; 3], wi: [&[f32]; 3], pdf: &mut [f32]) -> Result<(), Error> {
        same_length(wo.iter().chain(&wi).map(|s| s.len()).chain([pdf.len()]))?;
        let (level, mut lanes) = (Level::current(), LaneSums::NONE);
        for block in Block::all(wo[0].len()) {
            let (outgoing, incident) = (block.padded(&wo), block.padded(&wi));
            let sums = self.evaluate::<1>(level, block.count, &outgoing, &incident, &mut lanes);
            let mut densities = sums.value;
            for (density, inverse_power) in densities[0].iter_mut().zip(&sums.inverse_power) {
                *density *= inverse_power;
            }
            block.copy_out(&densities, &mut [&mut *pdf]);
        }
        Ok(())
    }

    /// Draws an incident direction for each of n outgoing ones, with density and weight `f cos / pdf`.
    ///
    /// The samples of [`prepare`](Self::prepare) and [`Mixture::sample`](crate::Mixture::sample) but for
    /// rounding. Where nothing is reflected (and for an outgoing direction that is none) the sample is the
    /// normal with density 0 and weight 0.
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
        mut samples: SamplesMut<'_>,
    ) -> Result<(), Error> {
        same_length(wo.iter().chain(&u).map(|s| s.len()).chain(samples.lengths()))?;
        let level = Level::current();
        self.sample_each(level, wo, u, None, |block, outgoing, sampled| {
            self.write_samples(level, block, outgoing, sampled, &mut samples);
        });
        Ok(())
    }

    /// Draws an incident direction for each of n outgoing ones, with density, without a weight: the samples of
    /// [`sample_pairs_into`](Self::sample_pairs_into), in nearly the same time.
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
        mut direction: [&mut [f32]; 3],
        pdf: &mut [f32],
    ) -> Result<(), Error> {
        let outputs = direction.iter().map(|s| s.len()).chain([pdf.len()]);
        same_length(wo.iter().chain(&u).map(|s| s.len()).chain(outputs))?;
        self.sample_each(Level::current(), wo, u, None, |block, _, sampled| {
            block.copy_out(&sampled.direction, &mut direction);
            block.copy_out(&[drawn_densities(&sampled.sums)], &mut [&mut *pdf]);
        });
        Ok(())
    }

    /// Draws an incident direction for each of n outgoing ones, and evaluates value and density towards
    /// another one, with one preparation: what next-event estimation needs at every hit.
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
        mut samples: SamplesMut<'_>,
        wi: [&[f32]; 3],
        mut value: [&mut [f32]; 3],
        pdf: &mut [f32],
    ) -> Result<(), Error> {
        let outputs = value.iter().map(|s| s.len()).chain([pdf.len()]).chain(samples.lengths());
        same_length(wo.iter().chain(&u).chain(&wi).map(|s| s.len()).chain(outputs))?;
        let level = Level::current();
        self.sample_each(level, wo, u, Some(wi), |block, outgoing, sampled| {
            self.write_samples(level, block, outgoing, sampled, &mut samples);
            if let Some(sums) = &mut sampled.towards {
                block.copy_out(&[densities(sums)], &mut [&mut *pdf]);
                self.multiply(level, outgoing, &block.padded(&wi), sums);
                block.copy_out(&sums.value, &mut value);
            }
        });
        Ok(())
    }

    fn evaluate<const C: usize>(
        &self,
        level: Level,
        count: usize,
        wo: &[Numbers; 3],
        wi: &[Numbers; 3],
        lanes: &mut LaneSums<C>,
    ) -> Sums<C> {
        let expanded = self;
        if self.material.mirrored_count() > 0 {
            level.run(Evaluate::<MIRRORED, C> { expanded, count, wo, wi, lanes })
        } else {
            level.run(Evaluate::<IN_PLANE, C> { expanded, count, wo, wi, lanes })
        }
    }

    /// Samples every block, and hands on what it drew; `towards` other directions too.
    fn sample_each(
        &self,
        level: Level,
        wo: [&[f32]; 3],
        u: [&[f32]; 3],
        towards: Option<[&[f32]; 3]>,
        out: impl FnMut(Block, &[Numbers; 3], &mut Sampled<3>),
    ) {
        let is_mirrored = self.material.mirrored_count() > 0;
        let to = Towards { level, wo, u, towards };
        match (is_mirrored, self.material.lobe_count() <= CHUNK) {
            (false, true) => self.sample_as::<IN_PLANE, 1>(to, out),
            (false, false) => self.sample_as::<IN_PLANE, GROUPS>(to, out),
            (true, true) => self.sample_as::<MIRRORED, 1>(to, out),
            (true, false) => self.sample_as::<MIRRORED, GROUPS>(to, out),
        }
    }

    fn sample_as<const W: usize, const G: usize>(
        &self,
        Towards { level, wo, u, towards }: Towards<'_>,
        mut out: impl FnMut(Block, &[Numbers; 3], &mut Sampled<3>),
    ) {
        let (mut kept, mut lanes) = ([[[[0.0; CHUNK]; KEPT]; G]; MOST], LaneSums::NONE);
        for block in Block::all(wo[0].len()) {
            let (wo, u) = (block.padded(&wo), block.padded(&u));
            let towards = towards.map(|wi| block.padded(&wi));
            let (expanded, count, towards) = (self, block.count, towards.as_ref());
            let (kept, lanes) = (&mut kept, &mut lanes);
            let sample = Sample::<W, G, 3> { expanded, count, wo: &wo, u: &u, towards, kept, lanes };
            out(block, &wo, &mut level.run(sample));
        }
    }

    /// Multiplies values by their factors, if there are some.
    fn multiply(&self, level: Level, wo: &[Numbers; 3], wi: &[Numbers; 3], sums: &mut Sums<3>) {
        let nodes = Nodes::new(self.material.borrowed());
        if nodes.is_none() {
            return;
        }
        // What is no direction has no factor, and 0 times that may be none either.
        let (mut outgoing, mut incident) = (*wo, *wi);
        for i in 0..MOST {
            if sums.inverse_power[i] == 0.0 {
                outgoing.iter_mut().chain(&mut incident).for_each(|component| component[i] = 0.5);
            }
        }
        multiply_pairs(level, &nodes, &outgoing, &incident, &mut sums.value);
    }

    fn write_samples(
        &self,
        level: Level,
        block: Block,
        wo: &[Numbers; 3],
        Sampled { direction, sums, .. }: &mut Sampled<3>,
        samples: &mut SamplesMut<'_>,
    ) {
        let (pdf, drawn) = (densities(sums), drawn_densities(sums));
        self.multiply(level, wo, direction, sums);
        let weight = &mut sums.value;
        for i in 0..MOST {
            let inverse = if pdf[i] >= LEAST_DENSITY { 1.0 / pdf[i] } else { 0.0 };
            weight.iter_mut().for_each(|channel| channel[i] *= inverse);
        }
        block.copy_out(direction, &mut samples.direction);
        block.copy_out(&[drawn], &mut [&mut *samples.pdf]);
        block.copy_out(weight, &mut samples.weight);
    }
}

/// What is to be sampled, and towards what else to be evaluated.
struct Towards<'a> {
    level: Level,
    wo: [&'a [f32]; 3],
    u: [&'a [f32]; 3],
    towards: Option<[&'a [f32]; 3]>,
}

/// The densities of a block.
fn densities(sums: &Sums<3>) -> Numbers {
    let mut pdf = [0.0; MOST];
    let [red, green, blue] = &sums.value;
    for i in 0..MOST {
        pdf[i] = luminance(Vec3::new(red[i], green[i], blue[i])) * sums.inverse_power[i];
    }
    pdf
}

/// The densities of a block of what was drawn; 0 where nothing is reflected.
fn drawn_densities(sums: &Sums<3>) -> Numbers {
    let mut pdf = densities(sums);
    for (pdf, &inverse_power) in pdf.iter_mut().zip(&sums.inverse_power) {
        if inverse_power > 0.0 {
            *pdf = drawn_density(*pdf);
        }
    }
    pdf
}

/// Pairs that are taken together.
#[derive(Clone, Copy)]
struct Block {
    from: usize,
    count: usize,
}

impl Block {
    /// The blocks of n pairs.
    fn all(n: usize) -> impl Iterator<Item = Self> {
        (0..n).step_by(MOST).map(move |from| Self { from, count: MOST.min(n - from) })
    }

    /// The numbers of a block, padded with harmless ones.
    fn padded(self, vectors: &[&[f32]; 3]) -> [Numbers; 3] {
        let mut block = [[0.5; MOST]; 3];
        for (block, from_here) in block.iter_mut().zip(vectors) {
            let from_here = &from_here[self.from..self.from + self.count];
            match from_here.first_chunk() {
                Some(all) => *block = *all,
                None => block[..self.count].copy_from_slice(from_here),
            }
        }
        block
    }

    /// Copies the numbers of a block out.
    fn copy_out<const C: usize>(self, block: &[Numbers; C], to: &mut [&mut [f32]; C]) {
        for (block, to) in block.iter().zip(to) {
            let to = &mut to[self.from..self.from + self.count];
            match to.first_chunk_mut() {
                Some(all) => *all = *block,
                None => to.copy_from_slice(&block[..self.count]),
            }
        }
    }
}
