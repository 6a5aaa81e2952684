//! Many directions of one mixture: values, densities, samples.
//!
//! Structure of arrays in and out, any count, any alignment, no allocation.
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use super::draw::sample_direction;
use super::lobe_sums::{STAGE, Stage, sums};
use super::request::{Draws, Request, Towards};
use super::slices::{SamplesMut, same_length};
use crate::color::{LUMINANCE, luminance};
use crate::error::Error;
use crate::mixture::rows::{LEAST_DENSITY, Mixture, MixtureRef, Rows};
use crate::simd::lanes::{Lanes, PARTS, dot3, scale, splat3};
use crate::simd::routine::Routine;
use glam::Vec3;

/// Widest vector: what fewer directions than that are padded to.
const WIDEST: usize = 16;

/// Directions of a batch that are evaluated, and then multiplied while they are near.
const CHUNK: usize = 512;

impl<const N: usize> Mixture<'_, N> {
    /// Draws and evaluates for n hits: what is asked is what is given.
    ///
    /// Shapes: every slice of the request `[n]`; of draws and of directions to evaluate there may be different
    /// numbers.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices of either are not all of one length; nothing is written then.
    pub fn ask(&self, request: Request<'_>) -> Result<(), Error> {
        let Request { draw, evaluate } = request;
        let drawn = draw.as_ref().map_or(0, |draw| draw.u[0].len());
        let towards = evaluate.as_ref().map_or(0, |towards| towards.wi[0].len());
        let (draw, evaluate) = (Request { draw, evaluate: None }, Request { draw: None, evaluate });
        draw.check(drawn).and(evaluate.check(towards))?;
        self.borrowed(&mut [Rows::zeros(); PARTS]).ask(draw.draw, evaluate.evaluate)
    }

    /// Evaluates `f cos` towards n incident directions; 1/sr. Same values as [`evaluate`](Self::evaluate).
    ///
    /// Shapes: `directions` x, y, z, each `[n]`, unit vectors; `value` red, green, blue, each `[n]`,
    /// overwritten.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    #[inline]
    pub fn evaluate_into(&self, directions: [&[f32]; 3], value: [&mut [f32]; 3]) -> Result<(), Error> {
        self.borrowed(&mut [Rows::zeros(); PARTS]).evaluate_into(directions, value)
    }

    /// Evaluates `f cos` and the density of [`sample`](Self::sample) at n directions; 1/sr.
    ///
    /// Shapes: `directions` x, y, z, each `[n]`, unit vectors; `value` red, green, blue, each `[n]`, and `pdf`
    /// `[n]`, overwritten.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    #[inline]
    pub fn evaluate_and_pdf_into(
        &self,
        directions: [&[f32]; 3],
        value: [&mut [f32]; 3],
        pdf: &mut [f32],
    ) -> Result<(), Error> {
        self.borrowed(&mut [Rows::zeros(); PARTS]).evaluate_and_pdf_into(directions, value, pdf)
    }

    /// Evaluates the density of [`sample`](Self::sample) at n directions; 1/sr.
    ///
    /// Shapes: `directions` x, y, z, each `[n]`, unit vectors; `pdf` `[n]`, overwritten.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    #[inline]
    pub fn pdf_into(&self, directions: [&[f32]; 3], pdf: &mut [f32]) -> Result<(), Error> {
        self.borrowed(&mut [Rows::zeros(); PARTS]).pdf_into(directions, pdf)
    }

    /// Draws n directions, with density and weight `f cos / pdf`, in one pass.
    ///
    /// Shapes: `u` three uniform numbers in [0, 1) a sample, each `[n]`; `samples`, every slice `[n]`,
    /// overwritten. A mixture that reflects nothing gives the normal with density 0 and weight 0.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    #[inline]
    pub fn sample_into(&self, u: [&[f32]; 3], samples: SamplesMut<'_>) -> Result<(), Error> {
        self.borrowed(&mut [Rows::zeros(); PARTS]).sample_into(u, samples)
    }

    /// Draws n directions with density, without a weight: one colour channel in place of three.
    ///
    /// Shapes: `u` as for [`sample_into`](Self::sample_into), each `[n]`; `direction` x, y, z, and `pdf`,
    /// each `[n]`, overwritten. A mixture that reflects nothing gives the normal with density 0.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    #[inline]
    pub fn sample_pdf_into(
        &self,
        u: [&[f32]; 3],
        direction: [&mut [f32]; 3],
        pdf: &mut [f32],
    ) -> Result<(), Error> {
        self.borrowed(&mut [Rows::zeros(); PARTS]).sample_pdf_into(u, direction, pdf)
    }

    /// Draws n directions, and evaluates value and density towards n others.
    ///
    /// Shapes: as in [`sample_into`](Self::sample_into) and, of the other directions, in
    /// [`evaluate_and_pdf_into`](Self::evaluate_and_pdf_into).
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    #[inline]
    pub fn sample_and_evaluate_into(
        &self,
        u: [&[f32]; 3],
        samples: SamplesMut<'_>,
        directions: [&[f32]; 3],
        value: [&mut [f32]; 3],
        pdf: &mut [f32],
    ) -> Result<(), Error> {
        self.borrowed(&mut [Rows::zeros(); PARTS])
            .sample_and_evaluate_into(u, samples, directions, value, pdf)
    }
}

/// What [`Mixture`] has under the same names.
impl MixtureRef<'_> {
    /// Answers a request whose slices have been checked.
    fn ask(&self, draw: Option<Draws<'_>>, evaluate: Option<Towards<'_>>) -> Result<(), Error> {
        match draw {
            Some(Draws { u, direction, pdf: Some(pdf), weight: Some(weight) }) => {
                self.sample_into(u, SamplesMut { direction, pdf, weight })?;
            }
            Some(Draws { u, direction, pdf: Some(pdf), weight: None }) => {
                self.sample_pdf_into(u, direction, pdf)?;
            }
            // Densities that nobody wants are worked out all the same, a chunk at a time.
            Some(Draws { u, direction: [x, y, z], pdf: None, mut weight }) => {
                let mut densities = [0.0; CHUNK];
                for from in (0..x.len()).step_by(CHUNK) {
                    let range = from..x.len().min(from + CHUNK);
                    let pdf = &mut densities[..range.len()];
                    let u = u.map(|s| &s[range.clone()]);
                    let direction = [&mut *x, &mut *y, &mut *z].map(|s| &mut s[range.clone()]);
                    match &mut weight {
                        Some(weight) => {
                            let weight = weight.each_mut().map(|s| &mut s[range.clone()]);
                            self.sample_into(u, SamplesMut { direction, pdf, weight })?;
                        }
                        None => self.sample_pdf_into(u, direction, pdf)?,
                    }
                }
            }
            None => {}
        }
        match evaluate {
            Some(Towards { wi, value: Some(value), pdf: Some(pdf) }) => {
                self.evaluate_and_pdf_into(wi, value, pdf)
            }
            Some(Towards { wi, value: Some(value), pdf: None }) => self.evaluate_into(wi, value),
            Some(Towards { wi, value: None, pdf: Some(pdf) }) => self.pdf_into(wi, pdf),
            _ => Ok(()),
        }
    }

    fn evaluate_into(&self, directions: [&[f32]; 3], value: [&mut [f32]; 3]) -> Result<(), Error> {
        same_length(directions.iter().map(|s| s.len()).chain(value.iter().map(|s| s.len())))?;
        if self.head.has_factors() {
            self.chunks_into(directions, value, None);
        } else {
            self.lobes_into(directions, value);
        }
        Ok(())
    }

    fn evaluate_and_pdf_into(
        &self,
        directions: [&[f32]; 3],
        value: [&mut [f32]; 3],
        pdf: &mut [f32],
    ) -> Result<(), Error> {
        let outputs = value.iter().map(|s| s.len()).chain([pdf.len()]);
        same_length(directions.iter().map(|s| s.len()).chain(outputs))?;
        self.chunks_into(directions, value, Some(pdf));
        Ok(())
    }

    fn pdf_into(&self, directions: [&[f32]; 3], pdf: &mut [f32]) -> Result<(), Error> {
        same_length(directions.iter().map(|s| s.len()).chain([pdf.len()]))?;
        self.head.level.run(ForEach { block: Density(self), inputs: directions, outputs: [pdf] });
        Ok(())
    }

    fn sample_into(&self, u: [&[f32]; 3], samples: SamplesMut<'_>) -> Result<(), Error> {
        same_length(u.iter().map(|s| s.len()).chain(samples.lengths()))?;
        let SamplesMut { direction: [x, y, z], pdf, weight: [red, green, blue] } = samples;
        if self.head.power == 0.0 {
            z.fill(1.0);
            [x, y, pdf, red, green, blue].into_iter().for_each(|slice| slice.fill(0.0));
            return Ok(());
        }
        if self.head.has_factors() {
            self.factored_draws(u, [x, y, z], pdf, [red, green, blue]);
            return Ok(());
        }
        self.draws_into(u, [x, y, z, pdf, red, green, blue]);
        Ok(())
    }

    fn sample_pdf_into(
        &self,
        u: [&[f32]; 3],
        direction: [&mut [f32]; 3],
        pdf: &mut [f32],
    ) -> Result<(), Error> {
        same_length(u.iter().map(|s| s.len()).chain(direction.iter().map(|s| s.len())).chain([pdf.len()]))?;
        let [x, y, z] = direction;
        if self.head.power == 0.0 {
            z.fill(1.0);
            [x, y, pdf].into_iter().for_each(|slice| slice.fill(0.0));
            return Ok(());
        }
        self.head.level.run(ForEach { block: DrawPdf(self), inputs: u, outputs: [x, y, z, pdf] });
        Ok(())
    }

    fn sample_and_evaluate_into(
        &self,
        u: [&[f32]; 3],
        samples: SamplesMut<'_>,
        directions: [&[f32]; 3],
        value: [&mut [f32]; 3],
        pdf: &mut [f32],
    ) -> Result<(), Error> {
        let outputs = value.iter().map(|s| s.len()).chain([pdf.len()]).chain(samples.lengths());
        same_length(u.iter().chain(&directions).map(|s| s.len()).chain(outputs))?;
        self.sample_into(u, samples)?;
        self.evaluate_and_pdf_into(directions, value, pdf)
    }

    /// What the lobes and the diffuse term have towards n directions, without factors; all slices of one
    /// length.
    fn lobes_into(&self, directions: [&[f32]; 3], value: [&mut [f32]; 3]) {
        self.head.level.run(ForEach { block: Value(self), inputs: directions, outputs: value });
    }

    /// Directions, densities, and weights without factors; all slices of one length.
    fn draws_into(&self, u: [&[f32]; 3], outputs: [&mut [f32]; 7]) {
        self.head.level.run(ForEach { block: Draw(self), inputs: u, outputs });
    }

    /// Values times factors, and perhaps densities, which are of the lobes alone; all slices of one length.
    fn chunks_into(&self, wi: [&[f32]; 3], value: [&mut [f32]; 3], mut pdf: Option<&mut [f32]>) {
        let n = value[0].len();
        let [red, green, blue] = value;
        for from in (0..n).step_by(CHUNK) {
            let range = from..n.min(from + CHUNK);
            let wi = wi.map(|s| &s[range.clone()]);
            let [red, green, blue] = [&mut *red, &mut *green, &mut *blue].map(|s| &mut s[range.clone()]);
            self.lobes_into(wi, [&mut *red, &mut *green, &mut *blue]);
            if let Some(pdf) = &mut pdf {
                for (i, pdf) in pdf[range].iter_mut().enumerate() {
                    *pdf = luminance(Vec3::new(red[i], green[i], blue[i])) * self.head.inverse_power;
                }
            }
            if self.head.has_factors() {
                self.head.multiply(wi, [red, green, blue]);
            }
        }
    }

    /// Directions, densities, and weights with factors; all slices of one length.
    fn factored_draws(
        &self,
        u: [&[f32]; 3],
        direction: [&mut [f32]; 3],
        pdf: &mut [f32],
        weight: [&mut [f32]; 3],
    ) {
        let n = pdf.len();
        let ([x, y, z], [red, green, blue]) = (direction, weight);
        for from in (0..n).step_by(CHUNK) {
            let range = from..n.min(from + CHUNK);
            let outputs = [&mut *x, &mut *y, &mut *z, &mut *pdf, &mut *red, &mut *green, &mut *blue];
            self.draws_into(u.map(|s| &s[range.clone()]), outputs.map(|s| &mut s[range.clone()]));
            let weight = [&mut *red, &mut *green, &mut *blue];
            let drawn = [&x[range.clone()], &y[range.clone()], &z[range.clone()]];
            self.head.multiply(drawn, weight.map(|s| &mut s[range.clone()]));
        }
    }
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
