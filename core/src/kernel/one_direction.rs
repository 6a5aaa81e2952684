//! One direction of one mixture, for renderers that shade a point at a time: lanes are lobes.
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use super::block::axes;
use super::draw::draw_one;
use crate::color::luminance;
use crate::mixture::row::{self, Group};
use crate::mixture::rows::{AnyMixture, Domain, Sample, density_of, drawn_density, lowest_bits, weight_of};
use crate::simd::ONE_TEXT;
use crate::simd::elementary::{falloff, falloff_left, falloff_soon, is_left};
use crate::simd::lanes::{Lanes, WIDEST, scale};
use crate::simd::routine::{Draw, One};
use crate::squeeze::{NUMBERS, Seen, Sight};
use core::f32::consts::FRAC_1_PI;
use glam::Vec3;

impl AnyMixture<'_> {
    /// Evaluates `f cos` towards an incident direction, linear sRGB; 1/sr. 0 below the horizon of a
    /// hemisphere.
    ///
    /// A lobe is exactly 0 where it is below 2^-100 (8e-31) of its amplitude; above, its relative error is at
    /// most 3e-7 times 2 plus its exponent.
    #[inline]
    pub fn evaluate(&self, direction: impl Into<Vec3>) -> Vec3 {
        let direction = direction.into();
        if self.has_factors() {
            return self.factored(direction).0;
        }
        self.lobes_value(direction)
    }

    /// The value, and the luminance of the lobes alone, of a mixture with factors.
    #[inline(never)]
    fn factored(&self, direction: Vec3) -> (Vec3, f32) {
        self.head.level.run_one::<_, FactoredOne>(self, direction.to_array())
    }

    /// The value of the lobes and the diffuse term, without factors.
    #[inline(always)]
    fn lobes_value(&self, direction: Vec3) -> Vec3 {
        if !ONE_TEXT && self.is_plain() {
            self.head.level.run_one::<_, EvaluateOne<false>>(self, direction.to_array())
        } else {
            self.head.level.run_one::<_, EvaluateOne<true>>(self, direction.to_array())
        }
    }

    /// Evaluates the density of [`sample`](Self::sample) at a direction; 1/sr.
    #[inline]
    pub fn pdf(&self, direction: impl Into<Vec3>) -> f32 {
        let direction = direction.into();
        if !ONE_TEXT && self.is_plain() {
            self.head.level.run_one::<_, PdfOne<false>>(self, direction.to_array())
        } else {
            self.head.level.run_one::<_, PdfOne<true>>(self, direction.to_array())
        }
    }

    /// Value and density in one pass over the lobes.
    #[inline]
    pub fn evaluate_and_pdf(&self, direction: impl Into<Vec3>) -> (Vec3, f32) {
        let direction = direction.into();
        let (value, luminance) = if self.has_factors() {
            self.factored(direction)
        } else {
            let value = self.lobes_value(direction);
            (value, luminance(value))
        };
        (value, density_of(luminance, self.head.inverse_power))
    }

    /// Draws an incident direction from the density: lobe by `u[0]`, direction in it by `u[1]` and `u[2]`.
    ///
    /// `None` where the integral is 0: such a mixture reflects nothing. No sample is wasted below the horizon.
    /// The three numbers are uniform in [0, 1).
    /// Source: Weng and Shih 2006, section 4.2.2, eq. 14; differs: what falls below the horizon is mirrored
    /// up.
    #[inline]
    pub fn sample(&self, u: [f32; 3]) -> Option<Sample> {
        if self.has_factors() {
            return self.sample_factored(u);
        }
        if !ONE_TEXT && self.is_plain() { self.sample_as::<false>(u) } else { self.sample_as::<true>(u) }
    }

    #[inline(always)]
    fn sample_as<const SEEN: bool>(&self, u: [f32; 3]) -> Option<Sample> {
        if self.head.power <= 0.0 {
            return None;
        }
        let (direction, value) = self.head.level.draw_one::<_, Drawn<SEEN>, EvaluateOne<SEEN>>(self, u);
        Some(self.sampled(direction, value, luminance(value)))
    }

    #[inline(never)]
    fn sample_factored(&self, u: [f32; 3]) -> Option<Sample> {
        if self.head.power <= 0.0 {
            return None;
        }
        let (direction, (value, luminance)) =
            self.head.level.draw_one::<_, Drawn<true>, FactoredOne>(self, u);
        Some(self.sampled(direction, value, luminance))
    }

    /// A sample of a direction that has been drawn, with the value there and the luminance of the lobes alone.
    #[inline(always)]
    fn sampled(&self, direction: [f32; 3], value: Vec3, luminance: f32) -> Sample {
        let pdf = luminance * self.head.inverse_power;
        let weight = weight_of(value, pdf);
        Sample { direction: Vec3::from_array(direction), pdf: drawn_density(pdf), weight }
    }

    /// Draws a direction, and evaluates value and density towards another one: what next-event estimation needs
    /// at every hit.
    ///
    /// The first is what [`sample`](Self::sample) gives, the second what
    /// [`evaluate_and_pdf`](Self::evaluate_and_pdf) does.
    #[inline]
    pub fn sample_and_evaluate(
        &self,
        u: [f32; 3],
        direction: impl Into<Vec3>,
    ) -> (Option<Sample>, (Vec3, f32)) {
        (self.sample(u), self.evaluate_and_pdf(direction))
    }

    /// Draws only the direction of [`sample`](Self::sample), for callers that take value and density
    /// elsewhere.
    #[inline]
    pub fn sample_direction(&self, u: [f32; 3]) -> Option<Vec3> {
        (self.head.power > 0.0).then(|| self.head.level.run_one::<_, DirectionOne>(self, u))
    }
}

/// Value towards a direction. `SEEN`: for a mixture that turns or squeezes it.
struct EvaluateOne<const SEEN: bool>;

impl<const SEEN: bool> One<&AnyMixture<'_>> for EvaluateOne<SEEN> {
    type Output = Vec3;
    const IS_WIDE: bool = true;
    #[inline(always)]
    fn run<L: Lanes>(m: &AnyMixture<'_>, direction: [f32; 3]) -> Vec3 {
        value_one::<L, SEEN>(m, direction)
    }
}

/// Density at a direction. `SEEN`: for a mixture that turns or squeezes it.
struct PdfOne<const SEEN: bool>;

impl<const SEEN: bool> One<&AnyMixture<'_>> for PdfOne<SEEN> {
    type Output = f32;
    const IS_WIDE: bool = true;
    #[inline(always)]
    fn run<L: Lanes>(m: &AnyMixture<'_>, direction: [f32; 3]) -> f32 {
        luminance_one::<L, SEEN>(m, direction) * m.head.inverse_power
    }
}

/// A direction from three uniform numbers, and the numbers that follow from it. `SEEN`: for a mixture that turns or squeezes it.
struct Drawn<const SEEN: bool>;

impl<const SEEN: bool> Draw<&AnyMixture<'_>> for Drawn<SEEN> {
    #[inline(always)]
    fn run<L: Lanes>(m: &AnyMixture<'_>, u: [f32; 3]) -> ([f32; 3], f32) {
        let (d, inverse) = draw_one::<L, SEEN>(m, u);
        // A squeezed direction has another length.
        let is_seen = if ONE_TEXT { !m.is_plain() } else { SEEN };
        if is_seen { (scale(d, inverse), 1.0) } else { (d, inverse) }
    }
}

/// A direction from three uniform numbers.
struct DirectionOne;

impl One<&AnyMixture<'_>> for DirectionOne {
    type Output = Vec3;
    const IS_WIDE: bool = false;
    #[inline(always)]
    fn run<L: Lanes>(m: &AnyMixture<'_>, u: [f32; 3]) -> Vec3 {
        let (d, inverse) = draw_one::<L, true>(m, u);
        Vec3::from_array(scale(d, inverse))
    }
}

/// Value towards one direction, and the luminance of the lobes alone there, for a mixture with factors.
struct FactoredOne;

impl One<&AnyMixture<'_>> for FactoredOne {
    type Output = (Vec3, f32);
    const IS_WIDE: bool = true;
    #[inline(always)]
    fn run<L: Lanes>(m: &AnyMixture<'_>, direction: [f32; 3]) -> (Vec3, f32) {
        // First, as it is the longer chain of dependent operations: the lobes are summed beside it.
        let factor = m.head.factors.nodes.towards::<L::One>(m.head.factors.wo, direction);
        let value = value_one::<L, true>(m, direction);
        (value * factor, luminance(value))
    }
}

/// Value towards one direction.
#[inline(always)]
fn value_one<L: Lanes, const SEEN: bool>(m: &AnyMixture<'_>, direction: [f32; 3]) -> Vec3 {
    if ONE_TEXT {
        let [x, y, z] = direction;
        return three_sums_one::<L>(m, row::RED, x, y, z);
    }
    let amplitudes = [row::RED, row::GREEN, row::BLUE];
    let diffuse = m.head.diffuse.to_array();
    Vec3::from_array(sums_one::<L::Lobes, 3, SEEN>(m, amplitudes, diffuse, direction))
}

/// Luminance of the value towards one direction.
#[inline(always)]
fn luminance_one<L: Lanes, const SEEN: bool>(m: &AnyMixture<'_>, direction: [f32; 3]) -> f32 {
    if ONE_TEXT {
        let [x, y, z] = direction;
        return three_sums_one::<L>(m, row::LUMINANCE, x, y, z).x;
    }
    let [sum] = sums_one::<L::Lobes, 1, SEEN>(m, [row::LUMINANCE], [m.head.diffuse_power], direction);
    sum
}

/// Sums the lobes and a diffuse term towards one direction, once for each of three rows of amplitudes from the `first` on:
/// one text for value and density, which leaves two of the sums. The numbers travel in registers.
#[cfg_attr(not(feature = "simd"), inline(never))]
#[cfg_attr(feature = "simd", inline(always))]
fn three_sums_one<L: Lanes>(m: &AnyMixture<'_>, first: usize, x: f32, y: f32, z: f32) -> Vec3 {
    let [a, b, c] = [first, first + 1, first + 2];
    let diffuse = if first == row::RED { m.head.diffuse.to_array() } else { [m.head.diffuse_power; 3] };
    Vec3::from_array(sums_one::<L::Lobes, 3, true>(m, [a, b, c], diffuse, [x, y, z]))
}

/// Sums the lobes towards one direction, once for each of `C` sets of amplitudes. `SEEN`: it is turned or
/// squeezed.
#[inline(always)]
fn sums_one<L: Lanes, const C: usize, const SEEN: bool>(
    m: &AnyMixture<'_>,
    amplitudes: [usize; C],
    diffuse: [f32; C],
    direction: [f32; 3],
) -> [f32; C] {
    // False for a NaN too.
    let above = direction[2] >= 0.0;
    if !above && m.head.domain == Domain::Hemisphere {
        return [0.0; C];
    }
    let sums = if !SEEN {
        let seen = m.head.squeeze.turn(direction);
        all_lobes::<L, C, false>(m, amplitudes, &seen, &seen)
    } else {
        let [turned, squeezed] = m.head.squeeze.see::<L>(direction);
        all_lobes::<L, C, true>(m, amplitudes, &turned, &squeezed)
    };
    if m.head.domain == Domain::Sphere {
        return sums;
    }
    with_diffuse(sums, diffuse, direction[2])
}

/// Adds the diffuse term, of albedos `diffuse`, to sums over the lobes.
#[inline(always)]
pub(crate) fn with_diffuse<const C: usize>(mut sums: [f32; C], diffuse: [f32; C], z: f32) -> [f32; C] {
    for i in 0..C {
        sums[i] += diffuse[i] * FRAC_1_PI * z;
    }
    sums
}

/// Sums all lobes towards a direction. `SEEN`: it was turned or squeezed, and has a low part and a scale.
#[inline(always)]
pub(crate) fn all_lobes<L: Lanes, const C: usize, const SEEN: bool>(
    m: &AnyMixture<'_>,
    amplitudes: [usize; C],
    turned: &Sight,
    squeezed: &Sight,
) -> [f32; C] {
    let mut acc = [L::splat(0.0); C];
    if L::COUNT == 1 {
        // Two loops, so that the numbers of either direction stay in registers.
        let (turned, squeezed) = (turned.splat(), squeezed.splat());
        let is_soon = if ONE_TEXT { m.is_plain() } else { !SEEN };
        let first = m.head.squeezed.min(m.head.count);
        let mut k = 0;
        for (n, group) in m.groups.iter().enumerate() {
            let end = m.head.count.min(WIDEST * (n + 1));
            while k < first.min(end) {
                add_lobe::<L, C, SEEN, true, false>(m, group, amplitudes, &squeezed, k, &mut acc);
                k += 1;
            }
            while !is_soon && k < end {
                add_lobe::<L, C, SEEN, false, false>(m, group, amplitudes, &turned, k, &mut acc);
                k += 1;
            }
            while is_soon && k < end {
                add_lobe::<L, C, false, false, true>(m, group, amplitudes, &turned, k, &mut acc);
                k += 1;
            }
        }
        return sums_of(acc);
    }
    // The usual number of lobes without a loop: a loop keeps more constants in registers than there are.
    if L::COUNT > 1 && 1 <= m.head.count && m.head.count <= L::COUNT {
        let seen = if !SEEN {
            turned.splat()
        } else if L::FUSED {
            Sight::splat_either::<L>(L::first_lanes(m.head.squeezed), squeezed, turned)
        } else {
            // No broadcasts under a mask; and the loop below runs.
            mix::<L>(&squeezed.splat(), &turned.splat(), m.head.squeezed)
        };
        if let Some(group) = m.groups.first() {
            add_lobes::<L, C, SEEN>(group, 0, m.head.folded, amplitudes, &seen, &mut acc);
        }
    } else {
        let (turned, squeezed) = (turned.splat(), squeezed.splat());
        row::for_lobes!(false, L, &m.groups, m.head.count, |group, at, k| {
            let folded = m.head.folded >> k;
            if k >= m.head.squeezed {
                add_lobes::<L, C, SEEN>(group, at, folded, amplitudes, &turned, &mut acc);
            } else if k + L::COUNT <= m.head.squeezed {
                add_lobes::<L, C, SEEN>(group, at, folded, amplitudes, &squeezed, &mut acc);
            } else {
                let mixed = mix::<L>(&squeezed, &turned, m.head.squeezed - k);
                add_lobes::<L, C, SEEN>(group, at, folded, amplitudes, &mixed, &mut acc);
            }
        });
    }
    sums_of(acc)
}

/// The sum over the lanes of each of some vectors.
#[inline(always)]
fn sums_of<L: Lanes, const C: usize>(vectors: [L; C]) -> [f32; C] {
    let mut sums = [0.0; C];
    for i in 0..C {
        sums[i] = vectors[i].sum();
    }
    sums
}

/// Adds the lobes of a group from one on, one a lane; the lowest bits of `folded` say which need their folds. `SEEN`: the direction
/// was turned or squeezed, and has a low part and a scale.
#[inline(always)]
fn add_lobes<L: Lanes, const C: usize, const SEEN: bool>(
    group: &Group,
    at: usize,
    folded: u64,
    amplitudes: [usize; C],
    seen: &Seen<L>,
    acc: &mut [L; C],
) {
    let (axis, [x, y, z]) = (axes::<L>(group, at), seen.high);
    let mut rate = L::load(&group[row::RATE][at..]);
    let [mut dx, mut dy, mut dz];
    if SEEN && L::FUSED {
        dx = axis[0].neg_mul_add(seen.length, x);
        dy = axis[1].neg_mul_add(seen.length, y);
        dz = axis[2].neg_mul_add(seen.length, z);
        rate = rate * seen.inverse_square;
    } else {
        dx = x - axis[0];
        dy = y - axis[1];
        dz = z - axis[2];
    }
    if SEEN {
        dx = dx + seen.low[0];
        dy = dy + seen.low[1];
        if !L::FUSED {
            dz = dz + seen.low[2];
        }
    }
    let t = rate * dx.mul_add(dx, dy.mul_add(dy, dz * dz));
    let mut g = if SEEN { falloff(t) } else { falloff_soon(t) };
    if folded & lowest_bits(L::COUNT) != 0 {
        // A lobe of them that does not need its fold has a rate that leaves nothing of it.
        let t = L::load(&group[row::FOLD_RATE][at..]).mul_add(seen.height, t);
        g = g + if SEEN { falloff(t) } else { falloff_soon(t) };
    }
    if SEEN {
        g = g * seen.scale;
    }
    for i in 0..C {
        acc[i] = g.mul_add(L::load(&group[amplitudes[i]][at..]), acc[i]);
    }
}

/// Adds lobe `k`, one of `group`, where vectors are one number: a lobe that has fallen to 0 is left early. `SQUEEZED`: its direction
/// was squeezed too, else only turned. `SOON`: by [`falloff_soon`].
#[inline(always)]
fn add_lobe<L: Lanes, const C: usize, const SEEN: bool, const SQUEEZED: bool, const SOON: bool>(
    m: &AnyMixture<'_>,
    group: &Group,
    amplitudes: [usize; C],
    seen: &Seen<L>,
    k: usize,
    acc: &mut [L; C],
) {
    let at = k % WIDEST;
    let mut apart = seen.high;
    for i in 0..3 {
        apart[i] = apart[i] - L::load(&group[row::AXIS_X + i][at..]);
        if SEEN && (SQUEEZED || i < 2) {
            apart[i] = apart[i] + seen.low[i];
        }
    }
    let [x, y, z] = apart;
    let t = L::load(&group[row::RATE][at..]) * x.mul_add(x, y.mul_add(y, z * z));
    // Its fold has fallen further.
    if L::bits(is_left(t)) == 0 {
        return;
    }
    let mut g = falloff_left::<L, SOON>(t);
    // Small processors shift a number of 64 bits by a call.
    let folded = if k < 32 { m.head.folded as u32 } else { (m.head.folded >> 32) as u32 };
    if folded >> (k % 32) & 1 == 1 {
        let t = L::load(&group[row::FOLD_RATE][at..]).mul_add(seen.height, t);
        if L::bits(is_left(t)) != 0 {
            g = g + falloff_left::<L, SOON>(t);
        }
    }
    if SEEN && SQUEEZED {
        g = g * seen.scale;
    }
    // The rows follow each other, and one check of their place does.
    for (acc, row) in acc.iter_mut().zip(group.get(amplitudes[0]..).unwrap_or_default()) {
        *acc = g.mul_add(L::load(&row[at..]), *acc);
    }
}

/// The seen direction: `first` for the first `count` lanes, `then` for the others.
#[inline(always)]
fn mix<L: Lanes>(first: &Seen<L>, then: &Seen<L>, count: usize) -> Seen<L> {
    let is_first = L::first_lanes(count);
    let (first, mut mixed) = (first.to_numbers(), then.to_numbers());
    for n in 0..NUMBERS {
        mixed[n] = L::select(is_first, first[n], mixed[n]);
    }
    Seen::from_numbers(mixed)
}
