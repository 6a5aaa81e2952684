//! Many hits, each with an outgoing direction of its own, and perhaps a material of its own, as a wavefront renderer
//! has them.
//!
//! With vectors they are taken in blocks, see `block.rs`; without, and where there are only a few, or some
//! material is anisotropic, one after the other.

#[cfg(feature = "simd")]
use super::super::multiply_factors::multiply_pairs;
use super::super::request::{Draws, Request, Towards};
#[cfg(feature = "simd")]
use super::super::sights::{MOST, Numbers};
use super::super::slices::same_length;
#[cfg(feature = "simd")]
use super::block::{Block, Room, Sums};
#[cfg(feature = "simd")]
use super::one::GROUPS;
use super::one::{Asked, ask_one};
use crate::error::Error;
use crate::material::borrowed::{Material, MaterialRef};
#[cfg(feature = "simd")]
use crate::mixture::factors::{Among, Factors};
use crate::mixture::rows::Sample;
#[cfg(feature = "simd")]
use crate::mixture::rows::weight_of;
#[cfg(feature = "simd")]
use crate::simd::detect::Level;
#[cfg(feature = "simd")]
use crate::simd::lanes::{Lanes, PART};
#[cfg(feature = "simd")]
use crate::simd::routine::One;
use core::borrow::Borrow;
use glam::Vec3;

/// One outgoing direction for each of n hits.
impl<B: AsRef<[u8]>> Material<B> {
    /// Draws and evaluates for n hits, each with an outgoing direction of its own: what is asked is what is given.
    ///
    /// The answers of [`sample`](Self::sample) and [`evaluate_and_pdf`](Self::evaluate_and_pdf), one by one, in
    /// less time. An outgoing direction below the horizon, or none at all (not finite, not of unit length),
    /// reflects nothing.
    ///
    /// Shapes: `wo` x, y, z, each `[n]`; every slice of the request `[n]`. Takes up to 25 kB of stack, 60 for a
    /// material of more than 16 lobes.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn ask(&self, wo: [&[f32]; 3], request: Request<'_>) -> Result<(), Error> {
        let n = same_length(wo.iter().map(|s| s.len()))?;
        request.check(n)?;
        let material = self.borrowed();
        ask(&|_| material, material.header.lobe_count(), wo, request);
        Ok(())
    }

    /// The same for n hits, each with a material of its own; they need not be sorted.
    ///
    /// Shapes: `materials` `[n]`, or references to them; the rest as in [`ask`](Self::ask).
    ///
    /// # Errors
    /// As [`ask`](Self::ask).
    pub fn ask_each(
        materials: &[impl Borrow<Self>],
        wo: [&[f32]; 3],
        request: Request<'_>,
    ) -> Result<(), Error> {
        let n = same_length(wo.iter().map(|s| s.len()).chain([materials.len()]))?;
        request.check(n)?;
        let most = materials.iter().map(|m| m.borrow().lobe_count()).max().unwrap_or(0);
        ask(&|i| materials[i].borrow().borrowed(), most, wo, request);
        Ok(())
    }
}

/// One direction, or three uniform numbers.
fn at(vectors: &[&[f32]; 3], i: usize) -> Vec3 {
    Vec3::new(vectors[0][i], vectors[1][i], vectors[2][i])
}

/// Stores a direction or a colour.
fn put(vectors: &mut [&mut [f32]; 3], i: usize, v: Vec3) {
    for (to, number) in vectors.iter_mut().zip(v.to_array()) {
        to[i] = number;
    }
}

/// Fewer hits than this are taken one by one.
#[cfg(feature = "simd")]
const FEW: usize = 4;

/// Asks for all; `most`: no material has more lobes. Not generic over who owns the bytes of a material: the kernels are
/// compiled here, once.
fn ask<'m>(
    material: &dyn Fn(usize) -> MaterialRef<'m>,
    most: usize,
    wo: [&[f32]; 3],
    mut request: Request<'_>,
) {
    let n = wo[0].len();
    #[cfg(feature = "simd")]
    {
        let level = Level::current();
        if n >= FEW && level != Level::Scalar {
            if most <= PART {
                in_blocks::<1>(level, material, wo, &mut request);
            } else {
                in_blocks::<GROUPS>(level, material, wo, &mut request);
            }
            return;
        }
    }
    let _ = most;
    one_by_one(material, wo, &mut request, 0..n);
}

fn one_by_one<'m>(
    material: &dyn Fn(usize) -> MaterialRef<'m>,
    wo: [&[f32]; 3],
    request: &mut Request<'_>,
    range: core::ops::Range<usize>,
) {
    for i in range {
        let (material, wo) = (material(i), at(&wo, i));
        let draw = request.draw.as_mut();
        let evaluate = request.evaluate.as_mut();
        let colors = draw.as_ref().is_some_and(|draw| draw.weight.is_some())
            || evaluate.as_ref().is_some_and(|towards| towards.value.is_some());
        let u = draw.as_ref().map(|draw| at(&draw.u, i).to_array());
        let wi = evaluate.as_ref().map(|towards| at(&towards.wi, i).to_array());
        let answer = ask_one(material, wo, Asked { u, wi, colors });
        if let Some(draw) = draw {
            let nothing = Sample { direction: Vec3::Z, pdf: 0.0, weight: Vec3::ZERO };
            let sample = answer.sample.unwrap_or(nothing);
            put(&mut draw.direction, i, sample.direction);
            if let Some(pdf) = &mut draw.pdf {
                pdf[i] = sample.pdf;
            }
            if let Some(weight) = &mut draw.weight {
                put(weight, i, sample.weight);
            }
        }
        if let Some(towards) = evaluate {
            if let Some(value) = &mut towards.value {
                put(value, i, answer.value);
            }
            if let Some(pdf) = &mut towards.pdf {
                pdf[i] = answer.pdf;
            }
        }
    }
}

#[cfg(feature = "simd")]
fn in_blocks<'m, const G: usize>(
    level: Level,
    material: &dyn Fn(usize) -> MaterialRef<'m>,
    wo: [&[f32]; 3],
    request: &mut Request<'_>,
) {
    let n = wo[0].len();
    let mut room = Room::<G>::NEW;
    let mut from = 0;
    while from < n {
        let count = MOST.min(n - from);
        let materials: [MaterialRef<'m>; MOST] = core::array::from_fn(|i| material(from + i.min(count - 1)));
        if materials.iter().all(|material| material.header.is_isotropic()) {
            let hits = Hits { level, materials: &materials, wo: padded(&wo, from, count), from, count };
            hits.ask(request, &mut room);
        } else {
            one_by_one(material, wo, request, from..from + count);
        }
        from += count;
    }
}

/// The hits of a block.
#[cfg(feature = "simd")]
struct Hits<'a, 'm> {
    level: Level,
    materials: &'a [MaterialRef<'m>; MOST],
    wo: [Numbers; 3],
    from: usize,
    count: usize,
}

#[cfg(feature = "simd")]
impl Hits<'_, '_> {
    fn ask<const G: usize>(&self, request: &mut Request<'_>, room: &mut Room<G>) {
        let &Self { level, materials, ref wo, from, count } = self;
        let u = request.draw.as_ref().map(|draw| padded(&draw.u, from, count));
        let wi = request.evaluate.as_ref().map(|towards| padded(&towards.wi, from, count));
        let block = Block::<G> { materials, count, wo, u: u.as_ref(), wi: wi.as_ref(), room };
        let mut answers = level.run(block);
        if let Some(Draws { direction, pdf, weight, .. }) = &mut request.draw {
            if let Some(weight) = weight {
                self.multiply(&answers.direction, &mut answers.drawn);
                let Sums { value, pdf } = &mut answers.drawn;
                for i in 0..MOST {
                    let colour = weight_of(Vec3::new(value[0][i], value[1][i], value[2][i]), pdf[i]);
                    [value[0][i], value[1][i], value[2][i]] = colour.to_array();
                }
                self.copy_out(value, weight);
            }
            if let Some(pdf) = pdf {
                self.copy_out(&[answers.drawn.pdf], &mut [&mut **pdf]);
            }
            self.copy_out(&answers.direction, direction);
        }
        if let (Some(Towards { value, pdf, .. }), Some(wi)) = (&mut request.evaluate, &wi) {
            if let Some(pdf) = pdf {
                self.copy_out(&[answers.towards.pdf], &mut [&mut **pdf]);
            }
            if let Some(value) = value {
                self.multiply(wi, &mut answers.towards);
                self.copy_out(&answers.towards.value, value);
            }
        }
    }

    /// Multiplies values by their factors: all at once where the materials have the same.
    fn multiply(&self, wi: &[Numbers; 3], sums: &mut Sums) {
        let &Self { level, materials, ref wo, count, .. } = self;
        let first = materials[0];
        if materials.iter().all(|material| core::ptr::eq(material.bytes, first.bytes)) {
            if !first.header.has_factors() {
                return;
            }
            let factors = Factors::new(first, Vec3::Z, Among::NOWHERE);
            // What is no direction has no factor, and 0 times that may be none either.
            let (mut outgoing, mut incident) = (*wo, *wi);
            for i in 0..MOST {
                if sums.pdf[i] == 0.0 && sums.value.iter().all(|channel| channel[i] == 0.0) {
                    outgoing.iter_mut().chain(&mut incident).for_each(|component| component[i] = 0.5);
                }
            }
            multiply_pairs(level, &factors, &outgoing, &incident, &mut sums.value);
            return;
        }
        for (i, material) in materials.iter().enumerate().take(count) {
            let is_dark = sums.value.iter().all(|channel| channel[i] == 0.0);
            if material.header.has_factors() && !is_dark {
                let wo = Vec3::new(wo[0][i], wo[1][i], wo[2][i]);
                let factors = Factors::new(*material, wo, Among::NOWHERE);
                let factor = level.run_one::<_, Factor>(&factors, [wi[0][i], wi[1][i], wi[2][i]]);
                for channel in 0..3 {
                    sums.value[channel][i] *= factor[channel];
                }
            }
        }
    }

    /// Copies the numbers of a block out.
    fn copy_out<const C: usize>(&self, block: &[Numbers; C], to: &mut [&mut [f32]; C]) {
        for (block, to) in block.iter().zip(to) {
            let to = &mut to[self.from..self.from + self.count];
            match to.first_chunk_mut() {
                Some(all) => *all = *block,
                None => to.copy_from_slice(&block[..self.count]),
            }
        }
    }
}

/// The numbers of a block, padded with harmless ones.
#[cfg(feature = "simd")]
fn padded(vectors: &[&[f32]; 3], from: usize, count: usize) -> [Numbers; 3] {
    let mut block = [[0.5; MOST]; 3];
    for (block, vector) in block.iter_mut().zip(vectors) {
        let vector = &vector[from..from + count];
        match vector.first_chunk() {
            Some(all) => *block = *all,
            None => block[..count].copy_from_slice(vector),
        }
    }
    block
}

/// The factor towards a direction.
#[cfg(feature = "simd")]
struct Factor;

#[cfg(feature = "simd")]
impl One<&Factors<'_>> for Factor {
    type Output = [f32; 3];
    const IS_WIDE: bool = false;
    #[inline(always)]
    fn run<L: Lanes>(factors: &Factors<'_>, direction: [f32; 3]) -> [f32; 3] {
        factors.towards::<L::One>(direction).to_array()
    }
}
