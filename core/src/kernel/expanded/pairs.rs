//! The verbs of an expanded material, for n pairs, each with an outgoing direction of its own.

use super::super::multiply_factors::multiply_pairs;
use super::super::request::{Draws, Request, Towards};
use super::super::slices::{Block, same_length};
use super::block::{Evaluate, KEPT, LaneSums, Sample, Sampled, Sums};
use super::table::{Expanded, IN_PLANE, MIRRORED};
use crate::color::luminance;
use crate::error::Error;
use crate::material::layout::MAX_LOBES;
use crate::mixture::factors::Nodes;
use crate::mixture::rows::{LEAST_DENSITY, density_of, drawn_density};
use crate::simd::detect::Level;
use crate::simd::lanes::{Numbers, WIDEST};
use glam::Vec3;

/// Most groups of lobes.
const GROUPS: usize = MAX_LOBES / WIDEST;

impl Expanded<'_> {
    /// Draws and evaluates for n hits, each with an outgoing direction of its own: outputs that are given are wanted.
    ///
    /// The answers of [`prepare`](Self::prepare) and the verbs of a [`Mixture`](crate::Mixture) but for rounding. An
    /// outgoing direction below the horizon, or none at all (not finite, not of unit length), reflects nothing.
    ///
    /// Shapes: `wo` x, y, z, each `[n]`; every slice of the request `[n]`.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn ask(&self, wo: [&[f32]; 3], mut request: Request<'_>) -> Result<(), Error> {
        let n = same_length(wo.iter().map(|s| s.len()))?;
        request.check(n)?;
        let level = Level::current();
        let Request { draw, evaluate } = &mut request;
        if let Some(draw) = draw {
            let wi = evaluate.as_ref().map(|towards| towards.wi);
            self.sample_each(Asked { level, wo, u: draw.u, wi }, |block, outgoing, sampled| {
                self.put_draws(level, block, outgoing, sampled, draw);
                if let (Some(towards), Some(sums)) = (&mut *evaluate, &mut sampled.towards) {
                    self.put(level, block, outgoing, sums, towards);
                }
            });
            return Ok(());
        }
        let Some(towards) = evaluate else { return Ok(()) };
        if towards.value.is_some() {
            let mut lanes = LaneSums::NONE;
            for block in Block::all(n) {
                let (outgoing, incident) = (block.padded(&wo), block.padded(&towards.wi));
                let mut sums = self.evaluate::<3>(level, block.count, &outgoing, &incident, &mut lanes);
                self.put(level, block, &outgoing, &mut sums, towards);
            }
        } else if let Some(pdf) = &mut towards.pdf {
            let mut lanes = LaneSums::NONE;
            for block in Block::all(n) {
                let (outgoing, incident) = (block.padded(&wo), block.padded(&towards.wi));
                let sums = self.evaluate::<1>(level, block.count, &outgoing, &incident, &mut lanes);
                let mut densities = sums.value;
                for (density, inverse_power) in densities[0].iter_mut().zip(&sums.inverse_power) {
                    *density = density_of(*density, *inverse_power);
                }
                block.copy_out(&densities, &mut [&mut **pdf]);
            }
        }
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

    /// Samples every block, and hands on its draws; evaluates towards other directions too.
    fn sample_each(&self, asked: Asked<'_>, out: impl FnMut(Block, &[Numbers; 3], &mut Sampled<3>)) {
        let is_mirrored = self.material.mirrored_count() > 0;
        match (is_mirrored, self.material.lobe_count() <= WIDEST) {
            (false, true) => self.sample_as::<IN_PLANE, 1>(asked, out),
            (false, false) => self.sample_as::<IN_PLANE, GROUPS>(asked, out),
            (true, true) => self.sample_as::<MIRRORED, 1>(asked, out),
            (true, false) => self.sample_as::<MIRRORED, GROUPS>(asked, out),
        }
    }

    fn sample_as<const W: usize, const G: usize>(
        &self,
        Asked { level, wo, u, wi }: Asked<'_>,
        mut out: impl FnMut(Block, &[Numbers; 3], &mut Sampled<3>),
    ) {
        let (mut kept, mut lanes) = ([[[[0.0; WIDEST]; KEPT]; G]; WIDEST], LaneSums::NONE);
        for block in Block::all(wo[0].len()) {
            let (wo, u) = (block.padded(&wo), block.padded(&u));
            let towards = wi.map(|wi| block.padded(&wi));
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
        // A vector that is no direction may have a factor of NaN, and 0 times NaN is NaN.
        let (mut outgoing, mut incident) = (*wo, *wi);
        for i in 0..WIDEST {
            if sums.inverse_power[i] == 0.0 {
                outgoing.iter_mut().chain(&mut incident).for_each(|component| component[i] = 0.5);
            }
        }
        multiply_pairs(level, &nodes, &outgoing, &incident, &mut sums.value);
    }

    /// Stores draws.
    fn put_draws(
        &self,
        level: Level,
        block: Block,
        wo: &[Numbers; 3],
        Sampled { direction, sums, .. }: &mut Sampled<3>,
        draw: &mut Draws<'_>,
    ) {
        block.copy_out(direction, &mut draw.direction);
        if let Some(pdf) = &mut draw.pdf {
            block.copy_out(&[drawn_densities(sums)], &mut [&mut **pdf]);
        }
        let Some(weight) = &mut draw.weight else { return };
        let pdf = densities(sums);
        self.multiply(level, wo, direction, sums);
        let value = &mut sums.value;
        for i in 0..WIDEST {
            let inverse = if pdf[i] >= LEAST_DENSITY { 1.0 / pdf[i] } else { 0.0 };
            value.iter_mut().for_each(|channel| channel[i] *= inverse);
        }
        block.copy_out(value, weight);
    }

    /// Stores densities, and values, which it multiplies by their factors.
    fn put(
        &self,
        level: Level,
        block: Block,
        wo: &[Numbers; 3],
        sums: &mut Sums<3>,
        towards: &mut Towards<'_>,
    ) {
        if let Some(pdf) = &mut towards.pdf {
            block.copy_out(&[densities(sums)], &mut [&mut **pdf]);
        }
        if let Some(value) = &mut towards.value {
            self.multiply(level, wo, &block.padded(&towards.wi), sums);
            block.copy_out(&sums.value, value);
        }
    }
}

/// The directions to be sampled, and those to be evaluated.
struct Asked<'a> {
    level: Level,
    wo: [&'a [f32]; 3],
    u: [&'a [f32]; 3],
    wi: Option<[&'a [f32]; 3]>,
}

/// The densities of a block.
fn densities(sums: &Sums<3>) -> Numbers {
    let mut pdf = [0.0; WIDEST];
    let [red, green, blue] = &sums.value;
    for i in 0..WIDEST {
        let luminance = luminance(Vec3::new(red[i], green[i], blue[i]));
        pdf[i] = density_of(luminance, sums.inverse_power[i]);
    }
    pdf
}

/// The densities of the drawn directions of a block; 0 where nothing is reflected.
fn drawn_densities(sums: &Sums<3>) -> Numbers {
    let mut pdf = densities(sums);
    for (pdf, &inverse_power) in pdf.iter_mut().zip(&sums.inverse_power) {
        if inverse_power > 0.0 {
            *pdf = drawn_density(*pdf);
        }
    }
    pdf
}
