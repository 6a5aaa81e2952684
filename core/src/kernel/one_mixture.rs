//! Many directions of one mixture: values, densities, samples.
//!
//! Structure of arrays in and out, any count, any alignment, no allocation.
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use super::draw::sample_direction;
use super::each_mixture::{draw_one, evaluate_one};
use super::lobe_sums::{STAGE, Stage, sums};
use super::request::{Draws, Request, Towards};
use crate::color::{LUMINANCE, luminance};
use crate::error::Error;
use crate::mixture::rows::{AnyMixture, LEAST_DENSITY, MixtureRef, density_of};
use crate::simd::lanes::{Lanes, WIDEST, dot3, scale, splat3};
use crate::simd::routine::Routine;
use core::ops::Range;
use glam::Vec3;

/// Directions of a batch that are evaluated, and then multiplied while they are near.
const NEAR: usize = 512;

/// Fewer directions than this are drawn one by one.
const FEW_DRAWS: usize = 4;

/// Fewer than this are evaluated one by one.
const FEW: usize = 6;

impl AnyMixture<'_> {
    /// Draws and evaluates for n hits: outputs that are given are wanted.
    ///
    /// Shapes: every slice of the request `[n]`; of draws and of directions to evaluate there may be different
    /// numbers.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices of either are not all of one length; nothing is written then.
    pub fn ask(&self, mut request: Request<'_>) -> Result<(), Error> {
        let drawn = request.draw.as_ref().map_or(0, |draw| draw.u[0].len());
        let towards = request.evaluate.as_ref().map_or(0, |towards| towards.wi[0].len());
        request.check_each(drawn, towards)?;
        // Through references: a request that has just been made is slow to move.
        let many_drawn = request.draw.take_if(|_| drawn >= FEW_DRAWS);
        let many_towards = request.evaluate.take_if(|_| towards >= FEW);
        if let Some(draw) = &mut request.draw {
            (0..drawn).for_each(|i| draw_one(draw, self, i));
        }
        if let Some(evaluate) = &mut request.evaluate {
            (0..towards).for_each(|i| evaluate_one(evaluate, self, i));
        }
        if many_drawn.is_none() && many_towards.is_none() {
            return Ok(());
        }
        let mixture = self.borrowed();
        if let Some(draw) = many_drawn {
            mixture.draw(draw);
        }
        if let Some(towards) = many_towards {
            mixture.evaluate(towards);
        }
        Ok(())
    }
}

/// The draws and the sums of [`AnyMixture::ask`]; all slices of a request have one length.
impl MixtureRef<'_> {
    fn draw(&self, Draws { u, direction: [x, y, z], pdf, mut weight }: Draws<'_>) {
        if self.head.power == 0.0 {
            z.fill(1.0);
            [x, y]
                .into_iter()
                .chain(pdf)
                .chain(weight.into_iter().flatten())
                .for_each(|slice| slice.fill(0.0));
            return;
        }
        if let Some(pdf) = pdf {
            self.draw_with(u, [x, y, z], pdf, weight);
            return;
        }
        // Densities that nobody wants are worked out all the same.
        let mut densities = [0.0; NEAR];
        for range in near(x.len()) {
            let pdf = &mut densities[..range.len()];
            let direction = [&mut *x, &mut *y, &mut *z].map(|s| &mut s[range.clone()]);
            let weight = weight.as_mut().map(|weight| weight.each_mut().map(|s| &mut s[range.clone()]));
            self.draw_with(u.map(|s| &s[range.clone()]), direction, pdf, weight);
        }
    }

    fn draw_with(
        &self,
        u: [&[f32]; 3],
        [x, y, z]: [&mut [f32]; 3],
        pdf: &mut [f32],
        weight: Option<[&mut [f32]; 3]>,
    ) {
        let level = self.head.level;
        let Some([red, green, blue]) = weight else {
            let special = ForEach { block: DrawPdf(self), inputs: u, outputs: [x, y, z, pdf] };
            let Err(ForEach { outputs: [x, y, z, pdf], .. }) = level.run_special(special) else { return };
            let mut unused = [[0.0; NEAR]; 3];
            for range in near(pdf.len()) {
                let [red, green, blue] = unused.each_mut().map(|row| &mut row[..range.len()]);
                let [x, y, z, pdf] = [&mut *x, &mut *y, &mut *z, &mut *pdf].map(|s| &mut s[range.clone()]);
                let outputs = [x, y, z, pdf, red, green, blue];
                level.run(ForEach { block: Draw(self), inputs: u.map(|s| &s[range.clone()]), outputs });
            }
            return;
        };
        if !self.head.has_factors() {
            level.run(ForEach { block: Draw(self), inputs: u, outputs: [x, y, z, pdf, red, green, blue] });
            return;
        }
        for range in near(pdf.len()) {
            let outputs = [&mut *x, &mut *y, &mut *z, &mut *pdf, &mut *red, &mut *green, &mut *blue];
            let (inputs, outputs) = (u.map(|s| &s[range.clone()]), outputs.map(|s| &mut s[range.clone()]));
            level.run(ForEach { block: Draw(self), inputs, outputs });
            let drawn = [&x[range.clone()], &y[range.clone()], &z[range.clone()]];
            let weight = [&mut *red, &mut *green, &mut *blue].map(|s| &mut s[range.clone()]);
            self.head.multiply(drawn, weight);
        }
    }

    /// Values towards directions, without factors.
    pub(crate) fn values(&self, wi: [&[f32]; 3], value: [&mut [f32]; 3]) {
        self.head.level.run(ForEach { block: Value(self), inputs: wi, outputs: value });
    }

    /// Densities of values without factors: they are of the lobes alone.
    pub(crate) fn densities(&self, [red, green, blue]: [&[f32]; 3], pdf: &mut [f32]) {
        for (i, pdf) in pdf.iter_mut().enumerate() {
            *pdf = density_of(luminance(Vec3::new(red[i], green[i], blue[i])), self.head.inverse_power);
        }
    }

    fn evaluate(&self, Towards { wi, value, mut pdf }: Towards<'_>) {
        let level = self.head.level;
        let Some([red, green, blue]) = value else {
            if let Some(pdf) = pdf {
                let special = ForEach { block: Density(self), inputs: wi, outputs: [pdf] };
                let Err(ForEach { outputs: [pdf], .. }) = level.run_special(special) else { return };
                let mut value = [[0.0; NEAR]; 3];
                for range in near(pdf.len()) {
                    let [red, green, blue] = value.each_mut().map(|row| &mut row[..range.len()]);
                    self.values(wi.map(|s| &s[range.clone()]), [&mut *red, &mut *green, &mut *blue]);
                    self.densities([red, green, blue], &mut pdf[range]);
                }
            }
            return;
        };
        if pdf.is_none() && !self.head.has_factors() {
            self.values(wi, [red, green, blue]);
            return;
        }
        for range in near(red.len()) {
            let inputs = wi.map(|s| &s[range.clone()]);
            let [red, green, blue] = [&mut *red, &mut *green, &mut *blue].map(|s| &mut s[range.clone()]);
            self.values(inputs, [&mut *red, &mut *green, &mut *blue]);
            if let Some(pdf) = &mut pdf {
                self.densities([red, green, blue], &mut pdf[range]);
            }
            if self.head.has_factors() {
                self.head.multiply(inputs, [red, green, blue]);
            }
        }
    }
}

/// Ranges of n directions that are near in the cache while they are worked on twice.
fn near(n: usize) -> impl Iterator<Item = Range<usize>> {
    (0..n).step_by(NEAR).map(move |from| from..n.min(from + NEAR))
}

/// A kernel that takes `I` numbers and gives `O` for each direction.
trait Block<const I: usize, const O: usize> {
    /// The text, `#[inline(always)]`.
    fn block<L: Lanes>(&self, inputs: [L; I], stage: &mut Stage<L>) -> [L; O];
}

/// Runs a block over whole slices.
struct ForEach<'a, K, const I: usize, const O: usize> {
    block: K,
    inputs: [&'a [f32]; I],
    outputs: [&'a mut [f32]; O],
}

impl<K: Block<I, O>, const I: usize, const O: usize> Routine for ForEach<'_, K, I, O> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(mut self) {
        self.steps::<L::Batch>(0);
    }
}

impl<K: Block<I, O>, const I: usize, const O: usize> ForEach<'_, K, I, O> {
    /// Takes all inputs from `at` on, `COUNT` at a time; then half of that; at last one vector, with inputs
    /// that have been taken before, or padded.
    #[inline(always)]
    fn steps<L: Lanes>(&mut self, mut at: usize) {
        let n = self.inputs[0].len();
        // Where no step begins any more; one vector goes on to the end.
        let end = if L::VECTORS == 1 { n } else { (n + 1).saturating_sub(L::COUNT) };
        if at < end {
            let mut stage = [L::splat(0.0); STAGE];
            while at < end {
                self.step(at.min(n.saturating_sub(L::COUNT)), &mut stage);
                at += L::COUNT;
            }
        }
        if L::VECTORS > 1 {
            self.steps::<L::Half>(at);
        }
    }

    /// Takes `COUNT` inputs from `at` on, or all, if there are fewer, by a padded copy.
    #[inline(always)]
    fn step<L: Lanes>(&mut self, at: usize, stage: &mut Stage<L>) {
        let left = self.inputs[0].len() - at;
        let mut vectors = [L::splat(0.0); I];
        for i in 0..I {
            vectors[i] = if left >= L::COUNT {
                L::load(&self.inputs[i][at..])
            } else {
                // 0.5 is a valid uniform number and a harmless direction.
                let mut padded = [0.5; WIDEST];
                padded[..left].copy_from_slice(&self.inputs[i][at..]);
                L::load(&padded)
            };
        }
        let results = self.block.block(vectors, stage);
        for o in 0..O {
            if left >= L::COUNT {
                results[o].store(&mut self.outputs[o][at..]);
            } else {
                let mut padded = [0.0; WIDEST];
                results[o].store(&mut padded);
                self.outputs[o][at..].copy_from_slice(&padded[..left]);
            }
        }
    }
}

struct Value<'a>(&'a MixtureRef<'a>);

impl Block<3, 3> for Value<'_> {
    #[inline(always)]
    fn block<L: Lanes>(&self, d: [L; 3], stage: &mut Stage<L>) -> [L; 3] {
        let m = self.0;
        sums(m, m.head.diffuse.to_array(), d, stage)
    }
}

struct Density<'a>(&'a MixtureRef<'a>);

impl Block<3, 1> for Density<'_> {
    #[inline(always)]
    fn block<L: Lanes>(&self, d: [L; 3], stage: &mut Stage<L>) -> [L; 1] {
        let m = self.0;
        let [sum] = sums(m, [m.head.diffuse_power], d, stage);
        [sum * L::splat(m.head.inverse_power)]
    }
}

struct DrawPdf<'a>(&'a MixtureRef<'a>);

impl Block<3, 4> for DrawPdf<'_> {
    #[inline(always)]
    fn block<L: Lanes>(&self, u: [L; 3], stage: &mut Stage<L>) -> [L; 4] {
        let [x, y, z] = sample_direction(self.0, u);
        let [pdf] = Density(self.0).block([x, y, z], stage);
        [x, y, z, pdf.max(L::splat(LEAST_DENSITY))]
    }
}

struct Draw<'a>(&'a MixtureRef<'a>);

impl Block<3, 7> for Draw<'_> {
    #[inline(always)]
    fn block<L: Lanes>(&self, u: [L; 3], stage: &mut Stage<L>) -> [L; 7] {
        let m = self.0;
        let [x, y, z] = sample_direction(m, u);
        let value = sums(m, m.head.diffuse.to_array(), [x, y, z], stage);
        // The density is the luminance of the value over its integral, and power / luminance is 1 / pdf.
        let luminance = dot3(value, splat3(LUMINANCE));
        let pdf = luminance * L::splat(m.head.inverse_power);
        let inverse = (L::splat(m.head.power) / luminance).keep(pdf.ge(L::splat(LEAST_DENSITY)));
        let [red, green, blue] = scale(value, inverse);
        [x, y, z, pdf.max(L::splat(LEAST_DENSITY)), red, green, blue]
    }
}
