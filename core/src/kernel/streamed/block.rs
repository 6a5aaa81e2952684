//! A block of hits, each with a material and an outgoing direction of its own.
//!
//! As in `kernel/block.rs` lanes are pairs for work that a pair needs once, lobes for the rest; in stages, so that a
//! processor sees many short chains of dependent operations and not one long one.
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use super::super::between_views::{Place, head_at, head_numbers, views_passed};
use super::super::draw::{Frame, chosen_power, draw};
use super::super::outgoing::Facing;
use super::super::sights::sights;
use super::lobes::{Kept, choice, chosen_lobe, keep_first, keep_second, numbers_of, sums_of_block};
use crate::color::{LUMINANCE, rgb};
use crate::material::borrowed::MaterialRef;
use crate::simd::elementary::exp2;
use crate::simd::lanes::{Lanes, Numbers, WIDEST, dot3, splat3};
use crate::simd::routine::Routine;
use core::f32::consts::FRAC_1_PI;

/// At most [`WIDEST`] hits, of which [`Room`] has the numbers. `G`: groups of sixteen lobes, at least as many as there are.
pub(super) struct HitBlock<'a, 'm, const G: usize> {
    pub materials: &'a [MaterialRef<'m>; WIDEST],
    pub count: usize,
    /// Whether directions are to be drawn, and materials evaluated towards others.
    pub draws: bool,
    pub evaluates: bool,
    pub room: &'a mut Room,
    /// For the lobes of each hit: at least as many as there are.
    pub kept: &'a mut [Kept<G>],
}

/// The inputs and outputs of a block, in room that a batch uses again for every block.
pub(super) struct Room {
    /// Outgoing directions, uniform numbers, and incident directions.
    pub wo: [Numbers; 3],
    pub u: [Numbers; 3],
    pub wi: [Numbers; 3],
    /// The drawn directions, the normal where nothing is reflected, and the sums there; and the sums towards the others.
    pub direction: [Numbers; 3],
    pub drawn: Sums,
    pub towards: Sums,
    /// Power of lobes and diffuse terms, 0 where nothing is reflected.
    pub power: Numbers,
    /// Sums by lane; a row is a pair.
    lanes: Lanes3,
}

/// Sums by lane in three channels.
type Lanes3 = [[[f32; WIDEST]; WIDEST]; 3];

impl Room {
    pub const NEW: Self = Self {
        wo: [[0.5; WIDEST]; 3],
        u: [[0.5; WIDEST]; 3],
        wi: [[0.5; WIDEST]; 3],
        direction: [[0.0; WIDEST]; 3],
        drawn: Sums { value: [[0.0; WIDEST]; 3], pdf: [0.0; WIDEST] },
        towards: Sums { value: [[0.0; WIDEST]; 3], pdf: [0.0; WIDEST] },
        power: [0.0; WIDEST],
        lanes: [[[0.0; WIDEST]; WIDEST]; 3],
    };
}

/// Values, without factors, and densities.
#[derive(Clone, Copy)]
pub(super) struct Sums {
    pub value: [Numbers; 3],
    pub pdf: Numbers,
}

impl<const G: usize> Routine for HitBlock<'_, '_, G> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { materials, count, draws, evaluates, room, kept } = self;
        let Room { wo, u, wi, direction, drawn, towards, power, lanes } = room;
        let count = count.min(WIDEST).min(kept.len());
        let mut heads = Heads::new::<L>(materials, wo, count);
        let mut in_plane = true;
        for i in 0..count {
            let (material, kept) = (materials[i], &mut kept[i]);
            let is_mirrored = material.header.mirrored > 0;
            in_plane &= !is_mirrored;
            // One text does for many lobes, of which some may be mirrored.
            if is_mirrored || G > 1 {
                keep_first::<L::Lobes, G, true>(material, heads.place[i], kept);
            } else {
                keep_first::<L::Lobes, G, false>(material, heads.place[i], kept);
            }
        }
        for i in 0..count {
            let lobes = materials[i].header.lobe_count();
            heads.lobes_power[i] = keep_second::<L::Lobes, G>(lobes, &mut kept[i]);
        }
        heads.sum_up::<L>();
        *power = heads.power;
        if evaluates {
            heads.sums::<L, G>(materials, count, kept, wi, lanes, towards);
        }
        if draws {
            let chosen = Chosen::new::<L, G>(materials, &heads, count, kept, &u[0]);
            *direction = heads.draw::<L>(&chosen, u, in_plane);
            heads.sums::<L, G>(materials, count, kept, direction, lanes, drawn);
        }
    }
}

/// The numbers of a block that a pair needs once.
struct Heads {
    place: [Place; WIDEST],
    /// Cosine and sine, in the caller's frame, of the azimuth of +x of the view.
    azimuth: [Numbers; 2],
    squeeze: Numbers,
    diffuse: [Numbers; 3],
    diffuse_power: Numbers,
    lobes_power: Numbers,
    /// Of both, 0 where nothing is reflected; and its inverse, or 0.
    power: Numbers,
    inverse_power: Numbers,
    /// 1 for a unit vector above the horizon.
    is_there: Numbers,
}

impl Heads {
    #[inline(always)]
    fn new<L: Lanes>(materials: &[MaterialRef<'_>; WIDEST], wo: &[Numbers; 3], count: usize) -> Self {
        let zeros = [0.0; WIDEST];
        let mut heads = Self {
            place: [Place::NOWHERE; WIDEST],
            azimuth: [zeros; 2],
            squeeze: [1.0; WIDEST],
            diffuse: [zeros; 3],
            diffuse_power: zeros,
            lobes_power: zeros,
            power: zeros,
            inverse_power: zeros,
            is_there: zeros,
        };
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let mut theta = zeros;
        let mut at = 0;
        while at + L::COUNT <= WIDEST {
            let facing =
                Facing::<L>::new([L::load(&wo[0][at..]), L::load(&wo[1][at..]), L::load(&wo[2][at..])]);
            facing.theta.store(&mut theta[at..]);
            facing.azimuth[0].store(&mut heads.azimuth[0][at..]);
            facing.azimuth[1].store(&mut heads.azimuth[1][at..]);
            L::select(facing.is_there(), one, zero).store(&mut heads.is_there[at..]);
            at += L::COUNT;
        }
        let mut numbers = [zeros; 4];
        for i in 0..count {
            // A vector that is no direction has no angle: any does, as nothing of it is seen.
            let theta = if heads.is_there[i] > 0.0 { theta[i] } else { 0.0 };
            let passed = views_passed::<L>(materials[i], theta);
            heads.place[i] = Place::after(materials[i], passed, theta);
            let of = head_numbers::<L::One>(materials[i], heads.place[i]);
            for n in 0..4 {
                numbers[n][i] = of[n];
            }
        }
        let mut at = 0;
        while at + L::COUNT <= WIDEST {
            exp2(L::load(&numbers[0][at..])).store(&mut heads.squeeze[at..]);
            let differences = [L::load(&numbers[2][at..]), L::load(&numbers[3][at..])];
            let color = rgb(exp2(L::load(&numbers[1][at..])), differences);
            for channel in 0..3 {
                color[channel].store(&mut heads.diffuse[channel][at..]);
            }
            at += L::COUNT;
        }
        for i in 0..count {
            // Red, green and blue are logarithms in files of version 1.
            if !materials[i].header.has_luminance {
                let (_, diffuse) = head_at::<L>(materials[i], heads.place[i]);
                for channel in 0..3 {
                    heads.diffuse[channel][i] = diffuse[channel];
                }
            }
        }
        let mut at = 0;
        while at + L::COUNT <= WIDEST {
            let mut color = [zero; 3];
            for channel in 0..3 {
                color[channel] = L::load(&heads.diffuse[channel][at..]);
            }
            dot3(color, splat3(LUMINANCE)).store(&mut heads.diffuse_power[at..]);
            at += L::COUNT;
        }
        heads
    }

    /// Adds the powers of lobes and diffuse terms.
    #[inline(always)]
    fn sum_up<L: Lanes>(&mut self) {
        let one = L::splat(1.0);
        let mut at = 0;
        while at + L::COUNT <= WIDEST {
            let power = L::load(&self.lobes_power[at..]) + L::load(&self.diffuse_power[at..]);
            let there = L::load(&self.is_there[at..]).ge(L::splat(0.5));
            // A sum so small that its inverse is infinite reflects nothing.
            let shines = L::both(there, power.ge(L::splat(f32::MIN_POSITIVE)));
            power.keep(shines).store(&mut self.power[at..]);
            (one / L::select(shines, power, one)).keep(shines).store(&mut self.inverse_power[at..]);
            at += L::COUNT;
        }
    }

    /// Draws from the chosen lobes, or the diffuse terms.
    #[inline(always)]
    fn draw<L: Lanes>(&self, chosen: &Chosen, u: &[Numbers; 3], in_plane: bool) -> [Numbers; 3] {
        let (zero, one, half) = (L::splat(0.0), L::splat(1.0), L::splat(0.5));
        let mut out = [[0.0; WIDEST]; 3];
        let mut at = 0;
        while at + L::COUNT <= WIDEST {
            let frame = Frame {
                in_plane,
                any_squeezed: true,
                any_diffuse: true,
                is_folded: true,
                azimuth: [L::load(&self.azimuth[0][at..]), L::load(&self.azimuth[1][at..])],
                widen: [one, L::load(&self.squeeze[at..])],
            };
            let mut numbers = [one; 6];
            for n in 0..6 {
                numbers[n] = L::load(&chosen.numbers[n][at..]);
            }
            let is_squeezed = L::load(&chosen.squeezed[at..]).ge(half);
            let is_lobe = L::load(&chosen.target[at..]).lt(L::load(&self.lobes_power[at..]));
            let choice = choice(numbers, is_squeezed, is_lobe);
            let [x, y, z] = draw(&frame, choice, L::load(&u[1][at..]), L::load(&u[2][at..]));
            let shines = zero.lt(L::load(&self.power[at..]));
            L::select(shines, x, zero).store(&mut out[0][at..]);
            L::select(shines, y, zero).store(&mut out[1][at..]);
            L::select(shines, z, one).store(&mut out[2][at..]);
            at += L::COUNT;
        }
        out
    }

    /// Values and densities towards a direction for each pair.
    #[inline(always)]
    fn sums<L: Lanes, const G: usize>(
        &self,
        materials: &[MaterialRef<'_>; WIDEST],
        count: usize,
        kept: &[Kept<G>],
        wi: &[Numbers; 3],
        lanes: &mut Lanes3,
        sums: &mut Sums,
    ) {
        let (mut excess, mut inverse) = ([0.0; WIDEST], [1.0; WIDEST]);
        for i in 0..WIDEST {
            let (c, s) = (f64::from(self.azimuth[0][i]), f64::from(self.azimuth[1][i]));
            excess[i] = (0.5 * (c * c + s * s - 1.0)) as f32;
            inverse[i] = 1.0 / self.squeeze[i];
        }
        let sights = sights::<L>(self.azimuth, excess, [[1.0; WIDEST], inverse], wi);
        for i in 0..count {
            let header = materials[i].header;
            let (lobes, squeezed) = (header.lobe_count(), header.squeezed);
            let acc = sums_of_block::<L::Lobes, G>(&kept[i], lobes, squeezed, &sights, i);
            for channel in 0..3 {
                let row = &mut lanes[channel][i];
                if L::Lobes::COUNT == WIDEST {
                    acc[channel].store(row);
                } else {
                    row[0] = acc[channel].sum();
                }
            }
        }
        for channel in 0..3 {
            if L::Lobes::COUNT == WIDEST {
                sums.value[channel] = L::sums_of_rows(&lanes[channel]);
            } else {
                for i in 0..WIDEST {
                    sums.value[channel][i] = lanes[channel][i][0];
                }
            }
        }
        self.finish::<L>(sums, &wi[2]);
    }

    /// Adds the diffuse terms to the sums over the lobes, 0 for directions below the horizon; and the densities.
    #[inline(always)]
    fn finish<L: Lanes>(&self, sums: &mut Sums, height: &Numbers) {
        let mut at = 0;
        while at + L::COUNT <= WIDEST {
            let z = L::load(&height[at..]);
            // Not set for a NaN.
            let there = L::load(&self.is_there[at..]).ge(L::splat(0.5));
            let above = L::both(z.ge(L::splat(0.0)), there);
            let mut value = [z; 3];
            for channel in 0..3 {
                let diffuse = L::load(&self.diffuse[channel][at..]) * L::splat(FRAC_1_PI);
                value[channel] = diffuse.mul_add(z, L::load(&sums.value[channel][at..])).keep(above);
                value[channel].store(&mut sums.value[channel][at..]);
            }
            let luminance = dot3(value, splat3(LUMINANCE));
            // As `density_of`.
            let pdf = luminance * L::load(&self.inverse_power[at..]);
            pdf.max(L::splat(0.0)).store(&mut sums.pdf[at..]);
            at += L::COUNT;
        }
    }
}

/// The chosen lobes of a block.
struct Chosen {
    /// As [`numbers_of`] has them.
    numbers: [Numbers; 6],
    squeezed: Numbers,
    /// Place on the running sum of powers.
    target: Numbers,
}

impl Chosen {
    #[inline(always)]
    fn new<L: Lanes, const G: usize>(
        materials: &[MaterialRef<'_>; WIDEST],
        heads: &Heads,
        count: usize,
        kept: &[Kept<G>],
        u: &Numbers,
    ) -> Self {
        let (one, zeros) = ([1.0; WIDEST], [0.0; WIDEST]);
        // Harmless ones behind the last pair.
        let mut chosen =
            Self { numbers: [zeros, zeros, one, one, zeros, one], squeezed: zeros, target: zeros };
        for i in 0..count {
            let target = chosen_power(heads.power[i], L::One::splat(u[i])).first();
            let kept = &kept[i];
            let k = chosen_lobe::<L::Lobes, G>(kept, materials[i].header.lobe_count(), target);
            let numbers = numbers_of(kept, k);
            for n in 0..6 {
                chosen.numbers[n][i] = numbers[n];
            }
            chosen.squeezed[i] = if k < materials[i].header.squeezed { 1.0 } else { 0.0 };
            chosen.target[i] = target;
        }
        chosen
    }
}
