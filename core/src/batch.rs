//! Batches: lanes are directions, the lobes of one mixture are taken one after the other.
//!
//! Structure of arrays in and out, any count, any alignment, no allocation.
#![allow(clippy::needless_range_loop)] // see lanes: kernels loop over array indices

use crate::lanes::{
    Lanes, TOGETHER, dot3, falloff, halves, ln_plus_times, of_halves, scale, sin_cos_turns, splat3,
};
use crate::mixture::Mixture;
use crate::simd::Routine;
use crate::squeeze::{Seen, turn_back};
use crate::{Domain, Error, LUMINANCE};
use core::f32::consts::FRAC_1_PI;
use core::ops::Range;

/// Widest vector: what fewer directions than that are padded to.
const WIDEST: usize = 16;

/// What one stage leaves for the next: a number for each lobe, and one for its fold.
type Stage<L> = [L; STAGE];
const STAGE: usize = 16;

impl<const N: usize> Mixture<'_, N> {
    /// Evaluates `f cos` towards n incident directions; 1/sr. Same values as [`evaluate`](Self::evaluate).
    ///
    /// Shapes: `directions` x, y, z, each [n], unit vectors; `value` red, green, blue, each [n], overwritten.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn evaluate_into(&self, directions: [&[f32]; 3], value: [&mut [f32]; 3]) -> Result<(), Error> {
        same_length(directions.iter().map(|s| s.len()).chain(value.iter().map(|s| s.len())))?;
        if self.has_factors() {
            self.factored_into(directions, value);
        } else {
            self.lobes_into(directions, value);
        }
        Ok(())
    }

    /// What the lobes and the diffuse term have towards n directions, without factors; all slices of one length.
    #[inline(always)]
    pub(crate) fn lobes_into(&self, directions: [&[f32]; 3], value: [&mut [f32]; 3]) {
        self.level.run(ForEach { block: Value(self), inputs: directions, outputs: value });
    }

    /// Evaluates the density of [`sample`](Self::sample) at n directions; 1/sr.
    ///
    /// Shapes: `directions` x, y, z, each [n], unit vectors; `pdf` [n], overwritten.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn pdf_into(&self, directions: [&[f32]; 3], pdf: &mut [f32]) -> Result<(), Error> {
        same_length(directions.iter().map(|s| s.len()).chain([pdf.len()]))?;
        self.level.run(ForEach {
            block: Luminance(self, self.inverse_power),
            inputs: directions,
            outputs: [pdf],
        });
        Ok(())
    }

    /// Evaluates the luminance of `f cos` towards n incident directions; 1/sr: one colour channel in place of three, but for a mixture
    /// with factors, which has them for each channel.
    ///
    /// Shapes: `directions` x, y, z, each [n], unit vectors; `luminance` [n], overwritten.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn luminance_into(&self, directions: [&[f32]; 3], luminance: &mut [f32]) -> Result<(), Error> {
        same_length(directions.iter().map(|s| s.len()).chain([luminance.len()]))?;
        if self.has_factors() {
            self.factored_luminance(directions, luminance);
            return Ok(());
        }
        self.level.run(ForEach { block: Luminance(self, 1.0), inputs: directions, outputs: [luminance] });
        Ok(())
    }

    /// Draws n directions, with density and weight `f cos / pdf`, in one pass.
    ///
    /// Shapes: `u` three uniform numbers in [0, 1) a sample, each [n]; `samples`, every slice [n], overwritten. A
    /// mixture that reflects nothing gives the normal with density 0 and weight 0.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn sample_into(&self, u: [&[f32]; 3], samples: SamplesMut<'_>) -> Result<(), Error> {
        let outputs = samples.direction.iter().chain(&samples.weight).map(|s| s.len());
        same_length(u.iter().map(|s| s.len()).chain(outputs).chain([samples.pdf.len()]))?;
        let SamplesMut { direction: [x, y, z], pdf, weight: [red, green, blue] } = samples;
        if self.power == 0.0 {
            z.fill(1.0);
            [x, y, pdf, red, green, blue].into_iter().for_each(|slice| slice.fill(0.0));
            return Ok(());
        }
        if self.has_factors() {
            self.factored_draws(u, [x, y, z], pdf, [red, green, blue]);
            return Ok(());
        }
        self.draws_into(u, [x, y, z, pdf, red, green, blue]);
        Ok(())
    }

    /// Directions, densities, and weights without factors; all slices of one length.
    #[inline(always)]
    pub(crate) fn draws_into(&self, u: [&[f32]; 3], outputs: [&mut [f32]; 7]) {
        self.level.run(ForEach { block: Draw(self), inputs: u, outputs });
    }

    /// Draws n directions with density, without a weight: one colour channel in place of three.
    ///
    /// Shapes: `u` as for [`sample_into`](Self::sample_into), each [n]; `direction` x, y, z, and `pdf`, each [n],
    /// overwritten. A mixture that reflects nothing gives the normal with density 0.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn sample_pdf_into(
        &self,
        u: [&[f32]; 3],
        direction: [&mut [f32]; 3],
        pdf: &mut [f32],
    ) -> Result<(), Error> {
        same_length(u.iter().map(|s| s.len()).chain(direction.iter().map(|s| s.len())).chain([pdf.len()]))?;
        let [x, y, z] = direction;
        if self.power == 0.0 {
            z.fill(1.0);
            [x, y, pdf].into_iter().for_each(|slice| slice.fill(0.0));
            return Ok(());
        }
        self.level.run(ForEach { block: DrawPdf(self), inputs: u, outputs: [x, y, z, pdf] });
        Ok(())
    }
}

/// Where a batch of samples goes.
#[derive(Debug)]
pub struct SamplesMut<'a> {
    /// Incident directions, x, y, z, in the caller's shading frame.
    pub direction: [&'a mut [f32]; 3],
    /// Density at them; 1/sr.
    pub pdf: &'a mut [f32],
    /// `f cos / pdf`, linear sRGB.
    pub weight: [&'a mut [f32]; 3],
}

pub(crate) fn same_length(lengths: impl IntoIterator<Item = usize>) -> Result<(), Error> {
    let mut lengths = lengths.into_iter();
    let first = lengths.next().unwrap_or(0);
    if lengths.all(|n| n == first) { Ok(()) } else { Err(Error::Length) }
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
    /// Takes all inputs from `at` on, `COUNT` at a time; then half of that; at last one vector, with inputs that have been taken before,
    /// or padded.
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

struct Value<'a, const N: usize>(&'a Mixture<'a, N>);

impl<const N: usize> Block<3, 3> for Value<'_, N> {
    #[inline(always)]
    fn block<L: Lanes>(&self, d: [L; 3], stage: &mut Stage<L>) -> [L; 3] {
        let m = self.0;
        sums(m, [&m.red, &m.green, &m.blue], m.diffuse.to_array(), d, stage)
    }
}

/// The luminance times a number.
struct Luminance<'a, const N: usize>(&'a Mixture<'a, N>, f32);

impl<const N: usize> Block<3, 1> for Luminance<'_, N> {
    #[inline(always)]
    fn block<L: Lanes>(&self, d: [L; 3], stage: &mut Stage<L>) -> [L; 1] {
        let m = self.0;
        let [sum] = sums(m, [&m.luminance], [m.diffuse_power], d, stage);
        [sum * L::splat(self.1)]
    }
}

struct DrawPdf<'a, const N: usize>(&'a Mixture<'a, N>);

impl<const N: usize> Block<3, 4> for DrawPdf<'_, N> {
    #[inline(always)]
    fn block<L: Lanes>(&self, u: [L; 3], stage: &mut Stage<L>) -> [L; 4] {
        let [x, y, z] = sample_direction(self.0, u);
        let [pdf] = Luminance(self.0, self.0.inverse_power).block([x, y, z], stage);
        [x, y, z, pdf]
    }
}

struct Draw<'a, const N: usize>(&'a Mixture<'a, N>);

impl<const N: usize> Block<3, 7> for Draw<'_, N> {
    #[inline(always)]
    fn block<L: Lanes>(&self, u: [L; 3], stage: &mut Stage<L>) -> [L; 7] {
        let m = self.0;
        let [x, y, z] = sample_direction(m, u);
        let value = sums(m, [&m.red, &m.green, &m.blue], m.diffuse.to_array(), [x, y, z], stage);
        // The density is the luminance of the value over its integral, and power / luminance is 1 / pdf; where f32
        // rounds the density to 0, the weight is 0 as well.
        let luminance = dot3(value, splat3(LUMINANCE));
        let zero = L::splat(0.0);
        let inverse = L::select(zero.lt(luminance), L::splat(m.power) / luminance, zero);
        let [red, green, blue] = scale(value, inverse);
        [x, y, z, luminance * L::splat(m.inverse_power), red, green, blue]
    }
}

/// Sums the lobes and the diffuse term towards a vector of directions, once for each of `C` sets of amplitudes.
#[inline(always)]
fn sums<L: Lanes, const N: usize, const C: usize>(
    m: &Mixture<'_, N>,
    amplitudes: [&[f32; N]; C],
    diffuse: [f32; C],
    d: [L; 3],
    stage: &mut Stage<L>,
) -> [L; C] {
    let mut acc = [L::splat(0.0); C];
    let turned = m.squeeze.turn(d);
    if m.squeezed > 0 {
        let (seen, lobes) = (m.squeeze.squeeze(&turned), 0..m.squeezed);
        match (m.in_plane, L::FUSED) {
            (true, true) => run::<L, N, C, true, true, true>(m, amplitudes, &seen, lobes, &mut acc, stage),
            (true, false) => run::<L, N, C, true, true, false>(m, amplitudes, &seen, lobes, &mut acc, stage),
            (false, true) => run::<L, N, C, false, true, true>(m, amplitudes, &seen, lobes, &mut acc, stage),
            (false, false) => {
                run::<L, N, C, false, true, false>(m, amplitudes, &seen, lobes, &mut acc, stage)
            }
        }
        acc = scale(acc, seen.scale);
    }
    let lobes = m.squeezed..m.count;
    match (m.in_plane, m.squeeze.is_turned) {
        (true, true) => run::<L, N, C, true, true, false>(m, amplitudes, &turned, lobes, &mut acc, stage),
        (true, false) => run::<L, N, C, true, false, false>(m, amplitudes, &turned, lobes, &mut acc, stage),
        (false, true) => run::<L, N, C, false, true, false>(m, amplitudes, &turned, lobes, &mut acc, stage),
        (false, false) => run::<L, N, C, false, false, false>(m, amplitudes, &turned, lobes, &mut acc, stage),
    }
    if m.domain == Domain::Hemisphere {
        let zero = L::splat(0.0);
        let above = d[2].ge(zero);
        for i in 0..C {
            let sum = L::splat(diffuse[i] * FRAC_1_PI).mul_add(d[2], acc[i]);
            acc[i] = L::select(above, sum, zero);
        }
    }
    acc
}

/// Adds a run of lobes that see the same direction. `PLANE`: every axis has y = 0. `LOW`: the direction has a low part.
/// `LONG`: it has a length.
#[inline(always)]
fn run<L: Lanes, const N: usize, const C: usize, const PLANE: bool, const LOW: bool, const LONG: bool>(
    m: &Mixture<'_, N>,
    amplitudes: [&[f32; N]; C],
    seen: &Seen<L>,
    lobes: Range<usize>,
    acc: &mut [L; C],
    stage: &mut Stage<L>,
) {
    // Stretches of lobes that need their fold, and of lobes that do not: no branch in the loop over either.
    let (mut k, to) = (lobes.start, lobes.end.min(N));
    while k < to {
        let ahead = m.folded >> k;
        if ahead & 1 == 1 {
            let end = to.min(k + ahead.trailing_ones() as usize);
            stretch::<L, N, C, PLANE, LOW, LONG, true>(m, amplitudes, seen, k..end, acc, stage);
            k = end;
        } else {
            let end = to.min(k + ahead.trailing_zeros() as usize);
            stretch::<L, N, C, PLANE, LOW, LONG, false>(m, amplitudes, seen, k..end, acc, stage);
            k = end;
        }
    }
}

/// Adds lobes that all need their fold (`FOLD`), or none.
#[inline(always)]
fn stretch<
    L: Lanes,
    const N: usize,
    const C: usize,
    const PLANE: bool,
    const LOW: bool,
    const LONG: bool,
    const FOLD: bool,
>(
    m: &Mixture<'_, N>,
    amplitudes: [&[f32; N]; C],
    seen: &Seen<L>,
    lobes: Range<usize>,
    acc: &mut [L; C],
    stage: &mut Stage<L>,
) {
    let (mut k, to) = (lobes.start, lobes.end.min(N));
    // Axes in the plane share the part across it; its low part would only count relative to itself.
    let yy = seen.high[1] * seen.high[1];
    if L::VECTORS <= TOGETHER {
        for k in k..to {
            let axis = [m.axis_x[k], m.axis_y[k], m.axis_z[k]];
            let t = exponent::<L, PLANE, LOW, LONG>(axis, m.rate[k], seen, yy);
            let mut g = falloff(t);
            if FOLD {
                g = g + falloff(fold_exponent(m.fold_rate[k], seen, t));
            }
            for i in 0..C {
                acc[i] = g.mul_add(L::splat(amplitudes[i][k]), acc[i]);
            }
        }
        return;
    }
    // One lobe is a long chain of dependent operations, and a processor sees no further than a few of them ahead. In stages, each a loop
    // of its own with a short chain, it sees many lobes.
    while k < to {
        let n = (to - k).min(if FOLD { STAGE / 2 } else { STAGE });
        let (x, y, z) = (&m.axis_x[k..k + n], &m.axis_y[k..k + n], &m.axis_z[k..k + n]);
        let (rate, fold_rate) = (&m.rate[k..k + n], &m.fold_rate[k..k + n]);
        for j in 0..n {
            stage[j] = exponent::<L, PLANE, LOW, LONG>([x[j], y[j], z[j]], rate[j], seen, yy);
            if FOLD {
                stage[n + j] = fold_exponent(fold_rate[j], seen, stage[j]);
            }
        }
        for j in 0..if FOLD { 2 * n } else { n } {
            stage[j] = falloff(stage[j]);
        }
        if FOLD {
            for j in 0..n {
                stage[j] = stage[j] + stage[n + j];
            }
        }
        // Two channels at a time, and the last by itself: so many sums stay in registers. Both loops as one function of one or two channels are
        // compiled to 1.07 of the time.
        for i in (0..C).step_by(2) {
            let amplitude = &amplitudes[i][k..k + n];
            if i + 1 < C {
                let (other, mut sum) = (&amplitudes[i + 1][k..k + n], [acc[i], acc[i + 1]]);
                for j in 0..n {
                    sum[0] = stage[j].mul_add(L::splat(amplitude[j]), sum[0]);
                    sum[1] = stage[j].mul_add(L::splat(other[j]), sum[1]);
                }
                [acc[i], acc[i + 1]] = sum;
            } else {
                let mut sum = acc[i];
                for j in 0..n {
                    sum = stage[j].mul_add(L::splat(amplitude[j]), sum);
                }
                acc[i] = sum;
            }
        }
        k += n;
    }
}

/// The exponent of a lobe, to base 2; `yy` is the square of what is seen of y.
#[inline(always)]
fn exponent<L: Lanes, const PLANE: bool, const LOW: bool, const LONG: bool>(
    axis: [f32; 3],
    rate: f32,
    seen: &Seen<L>,
    yy: L,
) -> L {
    let ([x, y, z], [x_low, y_low, z_low]) = (seen.high, seen.low);
    let mut dx = apart::<L, LONG>(axis[0], x, seen.length);
    let mut dz = apart::<L, LONG>(axis[2], z, seen.length);
    if LOW {
        dx = lower::<L, LONG>(dx, x_low);
        // What is only turned or not made a unit vector has its height in one f32.
        if !L::FUSED {
            dz = lower::<L, LONG>(dz, z_low);
        }
    }
    let chord_squared = if PLANE {
        dx.mul_add(dx, dz.mul_add(dz, yy))
    } else {
        let mut dy = apart::<L, LONG>(axis[1], y, seen.length);
        if LOW {
            dy = lower::<L, LONG>(dy, y_low);
        }
        dx.mul_add(dx, dz.mul_add(dz, dy * dy))
    };
    let mut rate = L::splat(rate);
    if LONG {
        rate = rate * seen.inverse_square;
    }
    rate * chord_squared
}

/// The exponent of the fold of a lobe: `|d - mirrored axis|^2 = |d - axis|^2 + 4 d.z axis.z`, both terms of one sign.
#[inline(always)]
fn fold_exponent<L: Lanes>(fold_rate: f32, seen: &Seen<L>, exponent: L) -> L {
    L::splat(fold_rate).mul_add(seen.height, exponent)
}

/// A component of the axis minus one of the direction, or of the direction minus the axis that is as long (`LONG`): what is the same
/// for all lobes stands where it may stay in memory.
#[inline(always)]
fn apart<L: Lanes, const LONG: bool>(axis: f32, direction: L, length: L) -> L {
    let axis = L::splat(axis);
    if LONG { axis.neg_mul_add(length, direction) } else { axis - direction }
}

/// Adds the low part of the direction to that.
#[inline(always)]
fn lower<L: Lanes, const LONG: bool>(apart: L, low: L) -> L {
    if LONG { apart + low } else { apart - low }
}

/// What drawing from a lobe needs to know of it.
pub(crate) struct Choice<L: Lanes> {
    pub axis: [L; 3],
    pub inside: L,
    pub gone: L,
    pub inverse_sharpness: L,
    pub is_squeezed: L::Mask,
    /// A lobe was chosen, not the diffuse term: the rest does not matter for that.
    pub is_lobe: L::Mask,
}

/// What drawing needs to know of the mixture.
pub(crate) struct Frame<L: Lanes> {
    /// Every axis has y = 0 in the frame of the view.
    pub in_plane: bool,
    /// Some lobe is squeezed; there is a diffuse term.
    pub any_squeezed: bool,
    pub any_diffuse: bool,
    /// What falls below the horizon is mirrored up.
    pub is_folded: bool,
    /// Cosine and sine of the azimuth of the view's +x.
    pub azimuth: [L; 2],
    /// What takes x and y back from what squeezed lobes see.
    pub widen: [L; 2],
}

impl<L: Lanes> Frame<L> {
    #[inline(always)]
    fn new<const N: usize>(m: &Mixture<'_, N>) -> Self {
        Self {
            in_plane: m.in_plane,
            any_squeezed: m.squeezed > 0,
            any_diffuse: m.lobes_power < m.power,
            is_folded: m.domain == Domain::Hemisphere,
            azimuth: [L::splat(m.squeeze.azimuth[0]), L::splat(m.squeeze.azimuth[1])],
            widen: [L::splat(1.0 / m.squeeze.along), L::splat(1.0 / m.squeeze.inverse)],
        }
    }
}

/// Draws directions: lobe by `u[0]`, direction in it by `u[1]` and `u[2]`.
#[inline(always)]
fn sample_direction<L: Lanes, const N: usize>(m: &Mixture<'_, N>, u: [L; 3]) -> [L; 3] {
    if L::VECTORS > TOGETHER {
        let mut parts = halves(u);
        for i in 0..2 {
            parts[i] = sample_direction(m, parts[i]);
        }
        return of_halves(parts);
    }
    let target = chosen_power(m, u[0]);
    let count = m.count.min(N);
    let k = target.search(&m.cumulative[..count.saturating_sub(1)]);
    let frame = Frame::new(m);
    let choice = Choice {
        axis: [
            L::lookup(&m.axis_x, count, k),
            if m.in_plane { L::splat(0.0) } else { L::lookup(&m.axis_y, count, k) },
            L::lookup(&m.axis_z, count, k),
        ],
        inside: L::lookup(&m.inside, count, k),
        gone: L::lookup(&m.tail, count, k),
        inverse_sharpness: L::lookup(&m.inverse_sharpness, count, k),
        is_squeezed: L::index_below(k, m.squeezed),
        is_lobe: target.lt(L::splat(m.lobes_power)),
    };
    draw(&frame, choice, u[1], u[2])
}

/// Draws one direction, and what it is to be multiplied by to be of length 1: lanes are lobes while the lobe is searched. Without `SEEN`,
/// for a mixture that neither turns nor squeezes it, that is 1 but for rounding.
#[inline(always)]
pub(crate) fn draw_one<L: Lanes, const N: usize, const SEEN: bool>(
    m: &Mixture<'_, N>,
    u: [f32; 3],
) -> ([f32; 3], f32) {
    let target = u[0] * m.power;
    let k = chosen_lobe::<L, N>(m, target);
    draw_from::<L::One, N, SEEN>(m, k, target, u)
}

/// The lobe at a place on the running sum of powers.
#[inline(always)]
pub(crate) fn chosen_lobe<L: Lanes, const N: usize>(m: &Mixture<'_, N>, target: f32) -> usize {
    // The running sum never falls: the lobes that are passed come first, and what is stored behind the last does not matter. The last
    // ends the search whatever its sum is rounded to.
    let (mut above, mut from) = (1u64.wrapping_shl((m.count as u32).wrapping_sub(1)), 0);
    while from < m.count && from + L::COUNT <= N {
        above |= L::bits(L::splat(target).lt(L::load(&m.cumulative[from..]))) << from;
        from += L::COUNT;
    }
    (above.trailing_zeros() as usize).min(N - 1)
}

/// Draws one direction from lobe `k`, or the diffuse term; `L` has one lane.
#[inline(always)]
fn draw_from<L: Lanes<Index = usize>, const N: usize, const SEEN: bool>(
    m: &Mixture<'_, N>,
    k: usize,
    target: f32,
    u: [f32; 3],
) -> ([f32; 3], f32) {
    let choice = Choice {
        axis: [L::splat(m.axis_x[k]), L::splat(m.axis_y[k]), L::splat(m.axis_z[k])],
        inside: L::splat(m.inside[k]),
        gone: L::splat(m.tail[k]),
        inverse_sharpness: L::splat(m.inverse_sharpness[k]),
        is_squeezed: L::index_below(k, m.squeezed),
        is_lobe: L::splat(target).lt(L::splat(m.lobes_power)),
    };
    let frame = Frame { any_squeezed: SEEN && m.squeezed > 0, ..Frame::new(m) };
    let ([x, y, z], inverse) = draw_unscaled::<L, SEEN>(&frame, choice, L::splat(u[1]), L::splat(u[2]));
    ([x.first(), y.first(), z.first()], inverse.first())
}

/// The place on the running sum of powers that a uniform number stands for.
#[inline(always)]
pub(crate) fn chosen_power<L: Lanes, const N: usize>(m: &Mixture<'_, N>, u: L) -> L {
    // Below the whole, so that a lobe that adds something is found whatever the product rounds to.
    (u * L::splat(m.power)).min(L::splat(m.power * (1.0 - f32::EPSILON)))
}

/// Draws directions from chosen lobes.
#[inline(always)]
pub(crate) fn draw<L: Lanes>(frame: &Frame<L>, choice: Choice<L>, u: L, turns: L) -> [L; 3] {
    let (d, inverse) = draw_unscaled::<L, true>(frame, choice, u, turns);
    scale(d, inverse)
}

/// Draws directions, and what they are to be multiplied by to be of length 1. `SEEN`: they are turned.
#[inline(always)]
fn draw_unscaled<L: Lanes, const SEEN: bool>(
    frame: &Frame<L>,
    choice: Choice<L>,
    u: L,
    turns: L,
) -> ([L; 3], L) {
    let one = L::splat(1.0);
    // One direction is a chain of dependent operations: what does not wait for the lobe, and then what does not wait for the
    // logarithm, is done beside that.
    // Angle from the axis, as cos - 1: see special::one_minus_cos.
    let [mut fall, mut above] = cos_minus_one(u, choice.inside, choice.gone, choice.inverse_sharpness);
    let [mut x, mut y, mut z] = choice.axis;
    let mut is_squeezed = choice.is_squeezed;
    // The diffuse term is cosine-weighted round the normal: sqrt(1 - u) - 1, without cancellation.
    if frame.any_diffuse {
        let flat = u / (L::splat(-1.0) - (one - u).sqrt());
        fall = L::select(choice.is_lobe, fall, flat);
        above = L::select(choice.is_lobe, above, flat + L::splat(2.0));
        x = x.keep(choice.is_lobe);
        y = y.keep(choice.is_lobe);
        z = L::select(choice.is_lobe, z, one);
        is_squeezed = L::both(is_squeezed, choice.is_lobe);
    }
    let (sin_phi, cos_phi) = sin_cos_turns(turns);

    // Axes that are mirrored up need no sign.
    let [side_x, side_y, minus_side_z] = if frame.is_folded {
        across(frame.in_plane, [x, y, z], one, [cos_phi, sin_phi], [cos_phi, sin_phi])
    } else {
        let sign = one.copy_sign(z);
        across(frame.in_plane, [x, y, z], sign, [cos_phi, sin_phi], [sign * cos_phi, sign * sin_phi])
    };

    // Negative, but for rounding at the far end.
    let sin_theta = (fall * above).abs().sqrt();
    // The axis is added last and whole: `axis cos` would round a narrow lobe to the grid round its axis.
    let mut d = [
        x + side_x.mul_add(sin_theta, x * fall),
        y + side_y.mul_add(sin_theta, y * fall),
        z + minus_side_z.neg_mul_add(sin_theta, z * fall),
    ];
    if frame.any_squeezed {
        for i in 0..2 {
            d[i] = d[i] * L::select(is_squeezed, frame.widen[i], one);
        }
    }
    if frame.is_folded {
        d[2] = d[2].abs();
    }
    // Turning leaves the length as it is.
    let length_squared = dot3(d, d);
    let inverse = if frame.any_squeezed {
        length_squared.sqrt() * (one / length_squared)
    } else {
        // What is not squeezed has a length of 1 but for rounding, and one step of Newton's is exact.
        length_squared.neg_mul_add(L::splat(0.5), L::splat(1.5))
    };
    (if SEEN { turn_back(d, frame.azimuth) } else { d }, inverse)
}

/// The unit vector across an axis at an azimuth, in the frame of Duff et al. 2017: tangent and bitangent are
/// (1 + sign x a x, sign x a y, -sign x) and (y a x, sign + y a y, -y). Its last component comes with the other sign. `signed` is
/// cosine and sine times the sign.
#[inline(always)]
fn across<L: Lanes>(
    in_plane: bool,
    [x, y, z]: [L; 3],
    sign: L,
    [cos, sin]: [L; 2],
    signed: [L; 2],
) -> [L; 3] {
    let [across, along] = signed;
    if in_plane {
        // The same for y = 0 and a unit axis: no division.
        return [z * across, along, x * across];
    }
    let a = L::splat(-1.0) / (sign + z);
    let q = x.mul_add(across, y * sin);
    let aq = a * q;
    [x.mul_add(aq, cos), y.mul_add(aq, along), q]
}

/// `ln(1 - u inside) / s` with `inside = 1 - exp(-2 s)` and `gone = exp(-2 s)`, both to full precision; rounding may
/// leave it a little below -2. And that plus 2.
#[inline(always)]
fn cos_minus_one<L: Lanes>(u: L, inside: L, gone: L, inverse_sharpness: L) -> [L; 2] {
    let one = L::splat(1.0);
    // u = 1 at a large sharpness: a small number stands for 0.
    let left = (one - u).max(L::splat(1e-30));
    // 1 - u inside, rounded once; for a large u, for which 1 - u is exact, without cancellation.
    let y = L::select(u.lt(L::splat(0.5)), inside.neg_mul_add(u, one), gone.mul_add(u, left));
    // ln(1 - drop) = ln(y) + c / y, c what rounding lost of y. 1 / y = 1 + drop + ...: what is left out is below a rounding.
    let drop = u * inside;
    let lost = (one - y) - drop;
    let lost = lost.mul_add(drop, lost).keep(y.ge(L::splat(0.5)));
    ln_plus_times(y, lost, inverse_sharpness)
}
