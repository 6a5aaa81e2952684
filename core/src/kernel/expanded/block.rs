//! A block of pairs of an expanded material.
//!
//! As in `kernel/block.rs` lanes are pairs for work that a pair needs once, lobes for the rest. No mixture is made:
//! lobes are interpolated when they are summed; where a direction is drawn first, their numbers are kept for
//! that.
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use super::super::draw::{Choice, Frame, draw};
use super::super::outgoing::Facing;
use super::super::sights::{Sights, folded_falloff, seen, sights};
use super::between_rows::{Lobes, blend, group, luminance_of};
use super::table::{
    DIFFUSE, DIFFUSE_POWER, Expanded, INVERSE_SQUEEZE, LOBES_POWER, MIRRORED, PAIR_HEAD, whole,
};
use crate::mixture::complete::{LEAST_SHARPNESS, tail_and_inside};
use crate::simd::lanes::{Lanes, Numbers, WIDEST};
use crate::simd::routine::Routine;
use crate::squeeze::Seen;
use core::f32::consts::{FRAC_1_PI, LOG2_E};

/// Sums of a block, the diffuse term included: red, green and blue, or the luminance alone.
pub(super) struct Sums<const C: usize> {
    pub value: [Numbers; C],
    /// The factor that makes a density of the luminance; 0 where nothing is reflected.
    pub inverse_power: Numbers,
}

/// Evaluates at most [`WIDEST`] pairs. `W`: the chunks of a group.
pub(super) struct Evaluate<'a, const W: usize, const C: usize> {
    pub expanded: &'a Expanded<'a>,
    pub count: usize,
    pub wo: &'a [Numbers; 3],
    pub wi: &'a [Numbers; 3],
    pub lanes: &'a mut LaneSums<C>,
}

impl<const W: usize, const C: usize> Routine for Evaluate<'_, W, C> {
    type Output = Sums<C>;
    #[inline(always)]
    fn run<L: Lanes>(self) -> Sums<C> {
        let Self { expanded, count, wo, wi, lanes } = self;
        let heads = Heads::new::<L>(expanded, wo, count);
        let sights = heads.sights::<L>(wi);
        // The usual material apart, its lobes in one vector: decisions that hold for all lobes are made out here.
        if expanded.is_plain && expanded.material.lobe_count() <= L::Lobes::COUNT {
            for i in 0..count.min(WIDEST) {
                lanes.set(i, sum_rows::<L::Lobes, W, C, true>(expanded, &heads, i, &sights));
            }
        } else {
            for i in 0..count.min(WIDEST) {
                lanes.set(i, sum_rows::<L::Lobes, W, C, false>(expanded, &heads, i, &sights));
            }
        }
        let value = lanes.value::<L>();
        heads.finish::<L, C>(value, &wi[2])
    }
}

/// Draws a direction for each of at most [`WIDEST`] pairs, evaluates towards it, and perhaps towards another
/// one. `W`: the chunks of a group; `G`: groups, at least as many as there are.
pub(super) struct Sample<'a, const W: usize, const G: usize, const C: usize> {
    pub expanded: &'a Expanded<'a>,
    pub count: usize,
    pub wo: &'a [Numbers; 3],
    pub u: &'a [Numbers; 3],
    pub towards: Option<&'a [Numbers; 3]>,
    pub kept: &'a mut [Kept<G>; WIDEST],
    pub lanes: &'a mut LaneSums<C>,
}

/// Its drawn directions, the normal where nothing is reflected, and the sums.
pub(super) struct Sampled<const C: usize> {
    pub direction: [Numbers; 3],
    pub sums: Sums<C>,
    pub towards: Option<Sums<C>>,
}

/// Numbers of the lobes of a pair that are kept: axis, rate, amplitudes; sharpness.
pub(super) const KEPT: usize = 8;

/// Of all lobes.
pub(super) type Kept<const G: usize> = [[Numbers; KEPT]; G];

impl<const W: usize, const G: usize, const C: usize> Routine for Sample<'_, W, G, C> {
    type Output = Sampled<C>;
    #[inline(always)]
    fn run<L: Lanes>(self) -> Sampled<C> {
        let Self { expanded, count, wo, u, towards, kept, lanes } = self;
        let heads = Heads::new::<L>(expanded, wo, count);
        let is_usual = expanded.is_plain && expanded.material.lobe_count() <= L::Lobes::COUNT;
        let mut chosen = Chosen::NONE;
        for i in 0..count.min(WIDEST) {
            let k = if is_usual {
                keep::<L::Lobes, W, G, C, true>(expanded, &heads, i, u[0][i], &mut kept[i])
            } else {
                keep::<L::Lobes, W, G, C, false>(expanded, &heads, i, u[0][i], &mut kept[i])
            };
            let lobe = &kept[i][k / WIDEST];
            for n in 0..3 {
                chosen.axis[n][i] = lobe[n][k % WIDEST];
            }
            chosen.sharpness[i] = lobe[KEPT - 1][k % WIDEST];
            chosen.squeezed[i] = if k < expanded.material.squeezed_count() { 1.0 } else { 0.0 };
        }
        let direction = heads.draw::<L>(expanded, &chosen, u, W != MIRRORED);
        let sums = heads.sum_kept::<L, G, C>(expanded, count, kept, &direction, lanes);
        let Some(wi) = towards else { return Sampled { direction, sums, towards: None } };
        let towards = Some(heads.sum_kept::<L, G, C>(expanded, count, kept, wi, lanes));
        Sampled { direction, sums, towards }
    }
}

/// Sums of a block by lane: rows are pairs. Rows of pairs that there are not are left as they were.
pub(super) struct LaneSums<const C: usize>([[Numbers; WIDEST]; C]);

impl<const C: usize> LaneSums<C> {
    pub const NONE: Self = Self([[[0.0; WIDEST]; WIDEST]; C]);

    #[inline(always)]
    fn set<L: Lanes>(&mut self, i: usize, acc: [L; C]) {
        for channel in 0..C {
            let row = &mut self.0[channel][i];
            if L::COUNT == WIDEST {
                acc[channel].store(row);
            } else {
                row[0] = acc[channel].sum();
            }
        }
    }

    /// The sums across the lanes.
    #[inline(always)]
    fn value<L: Lanes>(&self) -> [Numbers; C] {
        let mut value = [[0.0; WIDEST]; C];
        for channel in 0..C {
            if L::Lobes::COUNT == WIDEST {
                value[channel] = L::sums_of_rows(&self.0[channel]);
            } else {
                for i in 0..WIDEST {
                    value[channel][i] = self.0[channel][i][0];
                }
            }
        }
        value
    }
}

/// The numbers of a block that a pair needs once.
struct Heads {
    /// The row before the outgoing direction, and how far beyond it.
    row: [usize; WIDEST],
    share: Numbers,
    /// Cosine and sine, in the caller's frame, of the azimuth of +x of the view.
    azimuth: [Numbers; 2],
    /// The heads of the rows, interpolated.
    numbers: [Numbers; PAIR_HEAD],
    /// 1 for a unit vector above the horizon.
    is_there: Numbers,
}

/// The chosen lobes of a block.
struct Chosen {
    axis: [Numbers; 3],
    sharpness: Numbers,
    squeezed: Numbers,
}

impl Chosen {
    const NONE: Self = Self {
        axis: [[0.0; WIDEST], [0.0; WIDEST], [1.0; WIDEST]],
        sharpness: [1.0; WIDEST],
        squeezed: [0.0; WIDEST],
    };
}

impl Heads {
    #[inline(always)]
    fn new<L: Lanes>(expanded: &Expanded<'_>, wo: &[Numbers; 3], count: usize) -> Self {
        let zeros = [0.0; WIDEST];
        let (mut place, mut share, mut azimuth, mut is_there) = (zeros, zeros, [zeros; 2], zeros);
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let mut at = 0;
        while at + L::COUNT <= WIDEST {
            let wo = [L::load(&wo[0][at..]), L::load(&wo[1][at..]), L::load(&wo[2][at..])];
            let facing = Facing::<L>::new(wo);
            let [before, beyond] = expanded.places(facing.theta);
            before.store(&mut place[at..]);
            beyond.store(&mut share[at..]);
            facing.azimuth[0].store(&mut azimuth[0][at..]);
            facing.azimuth[1].store(&mut azimuth[1][at..]);
            L::select(facing.is_there(), one, zero).store(&mut is_there[at..]);
            at += L::COUNT;
        }
        let (mut row, mut numbers) = ([0; WIDEST], [zeros; PAIR_HEAD]);
        numbers[INVERSE_SQUEEZE] = [1.0; WIDEST];
        for i in 0..count.min(WIDEST) {
            row[i] = whole(place[i]);
            let ([a, b], share) = (expanded.two_rows(row[i]), L::One::splat(share[i]));
            let (a, b) = (&a[0], &b[0]);
            for n in 0..PAIR_HEAD {
                let (a, b) = (L::One::splat(a[n]), L::One::splat(b[n]));
                numbers[n][i] = blend(a, b, share).first();
            }
        }
        Self { row, share, azimuth, numbers, is_there }
    }

    /// What lobes see of incident directions.
    #[inline(always)]
    fn sights<L: Lanes>(&self, wi: &[Numbers; 3]) -> Sights {
        let mut excess = [0.0; WIDEST];
        for i in 0..WIDEST {
            let (c, s) = (f64::from(self.azimuth[0][i]), f64::from(self.azimuth[1][i]));
            excess[i] = (0.5 * (c * c + s * s - 1.0)) as f32;
        }
        sights::<L>(self.azimuth, excess, [[1.0; WIDEST], self.numbers[INVERSE_SQUEEZE]], wi)
    }

    /// Sums the lobes that were kept towards a direction for each pair.
    #[inline(always)]
    fn sum_kept<L: Lanes, const G: usize, const C: usize>(
        &self,
        expanded: &Expanded<'_>,
        count: usize,
        kept: &[Kept<G>; WIDEST],
        wi: &[Numbers; 3],
        lanes: &mut LaneSums<C>,
    ) -> Sums<C> {
        let sights = self.sights::<L>(wi);
        let (lobes, squeezed) = (expanded.material.lobe_count(), expanded.material.squeezed_count());
        if lobes <= L::Lobes::COUNT {
            let mask = L::Lobes::first_lanes(squeezed.min(WIDEST));
            for i in 0..count.min(WIDEST) {
                let mut acc = [L::Lobes::splat(0.0); C];
                Summand::<L::Lobes, C>::kept(&kept[i][0], 0).add(&seen(&sights, i, mask), &mut acc);
                lanes.set(i, acc);
            }
        } else {
            for i in 0..count.min(WIDEST) {
                lanes.set(i, sum_groups::<L::Lobes, G, C>(&kept[i], lobes, squeezed, &sights, i));
            }
        }
        self.finish::<L, C>(lanes.value::<L>(), &wi[2])
    }

    /// Draws from the chosen lobes, or the diffuse term.
    #[inline(always)]
    fn draw<L: Lanes>(
        &self,
        expanded: &Expanded<'_>,
        chosen: &Chosen,
        u: &[Numbers; 3],
        in_plane: bool,
    ) -> [Numbers; 3] {
        let (zero, one, half) = (L::splat(0.0), L::splat(1.0), L::splat(0.5));
        let mut out = [[0.0; WIDEST]; 3];
        let mut at = 0;
        while at + L::COUNT <= WIDEST {
            let frame = Frame {
                in_plane,
                any_squeezed: expanded.material.squeezed_count() > 0,
                any_diffuse: expanded.any_diffuse,
                is_folded: true,
                azimuth: [L::load(&self.azimuth[0][at..]), L::load(&self.azimuth[1][at..])],
                widen: [one, one / L::load(&self.numbers[INVERSE_SQUEEZE][at..])],
            };
            let sharpness = L::load(&chosen.sharpness[at..]).max(L::splat(LEAST_SHARPNESS));
            let [gone, inside] = tail_and_inside(sharpness);
            let [power, lobes_power] = self.powers::<L>(at);
            let choice = Choice {
                axis: [
                    L::load(&chosen.axis[0][at..]),
                    L::load(&chosen.axis[1][at..]),
                    L::load(&chosen.axis[2][at..]),
                ],
                inside,
                gone,
                inverse_sharpness: one / sharpness,
                is_squeezed: L::load(&chosen.squeezed[at..]).ge(half),
                is_lobe: target(L::load(&u[0][at..]), power).lt(lobes_power),
            };
            let [x, y, z] = draw(&frame, choice, L::load(&u[1][at..]), L::load(&u[2][at..]));
            let shines = L::splat(f32::MIN_POSITIVE).lt(power);
            L::select(shines, x, zero).store(&mut out[0][at..]);
            L::select(shines, y, zero).store(&mut out[1][at..]);
            L::select(shines, z, one).store(&mut out[2][at..]);
            at += L::COUNT;
        }
        out
    }

    /// The power, 0 where nothing is reflected, and the part that lobes have.
    #[inline(always)]
    fn powers<L: Lanes>(&self, at: usize) -> [L; 2] {
        let lobes = L::load(&self.numbers[LOBES_POWER][at..]);
        let power = lobes + L::load(&self.numbers[DIFFUSE_POWER][at..]);
        let there = L::load(&self.is_there[at..]).ge(L::splat(0.5));
        let shines = L::both(there, power.ge(L::splat(f32::MIN_POSITIVE)));
        [power.keep(shines), lobes]
    }

    /// Adds the diffuse term to the sums over the lobes; 0 for directions below the horizon.
    #[inline(always)]
    fn finish<L: Lanes, const C: usize>(&self, mut value: [Numbers; C], height: &Numbers) -> Sums<C> {
        let mut inverse_power = [0.0; WIDEST];
        let (zero, half, one) = (L::splat(0.0), L::splat(0.5), L::splat(1.0));
        let mut at = 0;
        while at + L::COUNT <= WIDEST {
            let z = L::load(&height[at..]);
            // Not set for a NaN.
            let above = L::both(z.ge(zero), L::load(&self.is_there[at..]).ge(half));
            for channel in 0..C {
                let from = if C == 3 { DIFFUSE + channel } else { DIFFUSE_POWER };
                let diffuse = L::load(&self.numbers[from][at..]) * L::splat(FRAC_1_PI);
                let sum = diffuse.mul_add(z, L::load(&value[channel][at..]));
                sum.keep(above).store(&mut value[channel][at..]);
            }
            let [power, _] = self.powers::<L>(at);
            let shines = L::splat(0.0).lt(power);
            (one / L::select(shines, power, one)).keep(shines).store(&mut inverse_power[at..]);
            at += L::COUNT;
        }
        Sums { value, inverse_power }
    }
}

/// The place on the running sum of powers that a uniform number stands for: below the whole.
#[inline(always)]
fn target<L: Lanes>(u: L, power: L) -> L {
    (u * power).min(power * L::splat(1.0 - f32::EPSILON))
}

/// Interpolates the lobes of a pair, keeps what summing and drawing need, and chooses one.
#[inline(always)]
fn keep<L: Lanes, const W: usize, const G: usize, const C: usize, const USUAL: bool>(
    expanded: &Expanded<'_>,
    heads: &Heads,
    i: usize,
    u: f32,
    kept: &mut Kept<G>,
) -> usize {
    let rows = expanded.two_rows(heads.row[i]);
    let share = L::splat(heads.share[i]);
    let target = target(u, heads.numbers[LOBES_POWER][i] + heads.numbers[DIFFUSE_POWER][i]);
    let lobes = expanded.material.lobe_count();
    // The last lobe ends the search whatever the sum is rounded to.
    let last = 1u64.wrapping_shl((lobes as u32).wrapping_sub(1));
    if USUAL {
        let of = Lobes::<L>::between::<W, true>(group(rows, 0), share, 0);
        let running = luminance_of(of.power).running_sum();
        Summand::<L, C>::new::<true>(&of).keep(&of, &mut kept[0], 0);
        let above = last | L::bits(L::splat(target).lt(running));
        return above.trailing_zeros() as usize % WIDEST;
    }
    let (mut above, mut passed) = (last, L::splat(0.0));
    for g in 0..lobes.div_ceil(WIDEST).min(G) {
        let mut j = 0;
        while j < WIDEST && WIDEST * g + j < lobes {
            let of = Lobes::<L>::between::<W, false>(group(rows, g), share, j);
            let luminance = luminance_of(of.power);
            let running = luminance.running_sum() + passed;
            above |= L::bits(L::splat(target).lt(running)) << (WIDEST * g + j);
            Summand::<L, C>::new::<false>(&of).keep(&of, &mut kept[g], j);
            passed = passed + L::splat(luminance.sum());
            j += L::COUNT;
        }
    }
    (above.trailing_zeros() as usize).min(WIDEST * G - 1)
}

/// What summing needs to know of lobes.
struct Summand<L, const C: usize> {
    axis: [L; 3],
    /// `-s / 2` in base 2.
    rate: L,
    amplitude: [L; C],
}

impl<L: Lanes, const C: usize> Summand<L, C> {
    /// `C` = 1: of the luminance.
    #[inline(always)]
    fn new<const P: bool>(lobes: &Lobes<L>) -> Self {
        let normaliser = lobes.normaliser::<P>();
        let mut amplitude = [normaliser; C];
        for channel in 0..C {
            let power = if C == 3 { lobes.power[channel] } else { luminance_of(lobes.power) };
            amplitude[channel] = power * normaliser;
        }
        Self { axis: lobes.axis, rate: lobes.sharpness * L::splat(-0.5 * LOG2_E), amplitude }
    }

    /// Keeps these lobes, from the `j`-th on of a group.
    #[inline(always)]
    fn keep(&self, of: &Lobes<L>, kept: &mut [Numbers; KEPT], j: usize) {
        for n in 0..3 {
            of.axis[n].store(&mut kept[n][j..]);
        }
        self.rate.store(&mut kept[3][j..]);
        for channel in 0..C {
            self.amplitude[channel].store(&mut kept[4 + channel][j..]);
        }
        of.sharpness.store(&mut kept[KEPT - 1][j..]);
    }

    /// The lobes that were kept.
    #[inline(always)]
    fn kept(kept: &[Numbers; KEPT], j: usize) -> Self {
        let mut amplitude = [L::splat(0.0); C];
        for channel in 0..C {
            amplitude[channel] = L::load(&kept[4 + channel][j..]);
        }
        let axis = [L::load(&kept[0][j..]), L::load(&kept[1][j..]), L::load(&kept[2][j..])];
        Self { axis, rate: L::load(&kept[3][j..]), amplitude }
    }

    /// Adds these lobes.
    #[inline(always)]
    fn add(&self, seen: &Seen<L>, acc: &mut [L; C]) {
        let g = folded_falloff::<L, false>(self.axis, self.rate, seen);
        for channel in 0..C {
            acc[channel] = g.mul_add(self.amplitude[channel], acc[channel]);
        }
    }
}

/// Sums the lobes of a pair, interpolated on the way. `USUAL`: of a plain material, in one vector.
#[inline(always)]
fn sum_rows<L: Lanes, const W: usize, const C: usize, const USUAL: bool>(
    expanded: &Expanded<'_>,
    heads: &Heads,
    i: usize,
    sights: &Sights,
) -> [L; C] {
    let rows = expanded.two_rows(heads.row[i]);
    let share = L::splat(heads.share[i]);
    let (lobes, squeezed) = (expanded.material.lobe_count(), expanded.material.squeezed_count());
    let mut acc = [L::splat(0.0); C];
    if USUAL {
        let of = Lobes::<L>::between::<W, true>(group(rows, 0), share, 0);
        let seen = seen(sights, i, L::first_lanes(squeezed.min(WIDEST)));
        Summand::<L, C>::new::<true>(&of).add(&seen, &mut acc);
        return acc;
    }
    for g in 0..lobes.div_ceil(WIDEST) {
        let mut j = 0;
        while j < WIDEST && WIDEST * g + j < lobes {
            let of = Lobes::<L>::between::<W, false>(group(rows, g), share, j);
            let mask = L::first_lanes(squeezed.saturating_sub(WIDEST * g + j));
            Summand::<L, C>::new::<false>(&of).add(&seen(sights, i, mask), &mut acc);
            j += L::COUNT;
        }
    }
    acc
}

/// Sums the lobes of a pair that were kept, in more than one vector.
#[inline(always)]
fn sum_groups<L: Lanes, const G: usize, const C: usize>(
    kept: &Kept<G>,
    lobes: usize,
    squeezed: usize,
    sights: &Sights,
    i: usize,
) -> [L; C] {
    let mut acc = [L::splat(0.0); C];
    for g in 0..lobes.div_ceil(WIDEST).min(G) {
        let mut j = 0;
        while j < WIDEST && WIDEST * g + j < lobes {
            let mask = L::first_lanes(squeezed.saturating_sub(WIDEST * g + j));
            Summand::<L, C>::kept(&kept[g], j).add(&seen(sights, i, mask), &mut acc);
            j += L::COUNT;
        }
    }
    acc
}
