//! A block of at most sixteen hits on the hemisphere, each with lobes of its own.
//!
//! A [`LobeSource`](super::answers::LobeSource) fills the numbers that a hit has once ([`Hits`]), and its lobes, groups of sixteen. Here
//! directions are drawn, and the lobes are summed towards directions. Lanes are hits for work that a hit needs once, lobes for
//! the rest; in stages, so that a processor sees many short chains of dependent operations and not one long one.
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use super::draw::{Choice, Frame, chosen_power, draw};
use super::sights::{Sights, folded_falloff, seen, sights};
use crate::color::LUMINANCE;
use crate::mixture::row::{self, Group};
use crate::simd::lanes::{Lanes, Numbers, WIDEST, dot3, splat3};
use crate::simd::routine::Routine;
use core::f32::consts::FRAC_1_PI;

const ZEROS: Numbers = [0.0; WIDEST];
const ONES: Numbers = [1.0; WIDEST];

/// The numbers that a hit of a block has once.
pub(crate) struct Hits {
    pub count: usize,
    /// Lobes, and those of them that see the squeezed direction.
    pub lobes: [usize; WIDEST],
    pub squeezed: [usize; WIDEST],
    /// Every axis has y = 0 in the frame of the view.
    pub in_plane: bool,
    /// Some lobe is squeezed; there is a diffuse term.
    pub any_squeezed: bool,
    pub any_diffuse: bool,
    /// Cosine and sine, in the caller's frame, of the azimuth of +x of the view; half of what their squares exceed 1 by.
    pub azimuth: [Numbers; 2],
    pub excess: Numbers,
    /// What squeezed lobes see x and y times, and what takes them back.
    pub stretch: [Numbers; 2],
    pub widen: [Numbers; 2],
    /// Albedo of the diffuse term.
    pub diffuse: [Numbers; 3],
    /// Power of the lobes.
    pub lobes_power: Numbers,
    /// That and the power of the diffuse term, 0 where nothing is reflected; and its inverse, or 0.
    pub power: Numbers,
    pub inverse_power: Numbers,
    /// 1 for an outgoing direction: a unit vector above the horizon.
    pub is_there: Numbers,
}

impl Hits {
    pub const NONE: Self = Self {
        count: 0,
        lobes: [0; WIDEST],
        squeezed: [0; WIDEST],
        in_plane: false,
        any_squeezed: true,
        any_diffuse: true,
        azimuth: [ONES, ZEROS],
        excess: ZEROS,
        stretch: [ONES; 2],
        widen: [ONES; 2],
        diffuse: [ZEROS; 3],
        lobes_power: ZEROS,
        power: ZEROS,
        inverse_power: ZEROS,
        is_there: ZEROS,
    };

    /// Sets the excess of the azimuths.
    #[inline(always)]
    pub fn set_excess(&mut self) {
        for i in 0..WIDEST {
            let (c, s) = (f64::from(self.azimuth[0][i]), f64::from(self.azimuth[1][i]));
            self.excess[i] = (0.5 * (c * c + s * s - 1.0)) as f32;
        }
    }

    /// Copies the numbers of a hit of another block; `shines`: something is drawn from it.
    #[cfg(feature = "simd")]
    pub fn copy_hit(&mut self, i: usize, from: &Self, shines: bool) {
        (self.lobes[i], self.squeezed[i]) = (from.lobes[i], from.squeezed[i]);
        self.in_plane &= from.in_plane;
        for n in 0..2 {
            self.azimuth[n][i] = from.azimuth[n][i];
            self.stretch[n][i] = from.stretch[n][i];
            self.widen[n][i] = from.widen[n][i];
        }
        for channel in 0..3 {
            self.diffuse[channel][i] = from.diffuse[channel][i];
        }
        self.excess[i] = from.excess[i];
        self.lobes_power[i] = from.lobes_power[i];
        self.power[i] = if shines { from.power[i] } else { 0.0 };
        self.inverse_power[i] = from.inverse_power[i];
        self.is_there[i] = from.is_there[i];
    }

    /// Sets the power of lobes and diffuse terms, and its inverse.
    #[inline(always)]
    pub fn set_power<L: Lanes>(&mut self, diffuse_power: &Numbers) {
        let one = L::splat(1.0);
        let mut at = 0;
        while at + L::COUNT <= WIDEST {
            let power = L::load(&self.lobes_power[at..]) + L::load(&diffuse_power[at..]);
            let there = L::load(&self.is_there[at..]).ge(L::splat(0.5));
            // A sum so small that its inverse is infinite reflects nothing.
            let shines = L::both(there, power.ge(L::splat(f32::MIN_POSITIVE)));
            power.keep(shines).store(&mut self.power[at..]);
            (one / L::select(shines, power, one)).keep(shines).store(&mut self.inverse_power[at..]);
            at += L::COUNT;
        }
    }
}

/// The inputs and outputs of a block, in room that a batch uses again for every block.
#[repr(align(64))]
pub(crate) struct Room {
    /// Outgoing directions, uniform numbers, and incident directions.
    pub wo: [Numbers; 3],
    pub u: [Numbers; 3],
    pub wi: [Numbers; 3],
    /// The drawn directions, the normal where nothing is reflected, and the sums there; and the sums towards the others.
    pub direction: [Numbers; 3],
    pub drawn: Sums,
    pub towards: Sums,
    pub hits: Hits,
    /// Sums by lane; a row is a hit.
    lanes: Lanes3,
}

/// Sums by lane in three channels.
type Lanes3 = [[Numbers; WIDEST]; 3];

/// Values, without factors, and densities.
pub(crate) struct Sums {
    pub value: [Numbers; 3],
    pub pdf: Numbers,
}

impl Room {
    pub const NEW: Self = Self {
        wo: [[0.5; WIDEST]; 3],
        u: [[0.5; WIDEST]; 3],
        wi: [[0.5; WIDEST]; 3],
        direction: [ZEROS; 3],
        drawn: Sums { value: [ZEROS; 3], pdf: ZEROS },
        towards: Sums { value: [ZEROS; 3], pdf: ZEROS },
        hits: Hits::NONE,
        lanes: [[ZEROS; WIDEST]; 3],
    };
}

/// Draws directions, and evaluates towards others, as asked.
pub(crate) struct Work<'a> {
    pub room: &'a mut Room,
    /// The lobes of each hit: at least as many as there are.
    pub groups: &'a [&'a [Group]; WIDEST],
    pub draws: bool,
    pub evaluates: bool,
}

impl Routine for Work<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { room, groups, draws, evaluates } = self;
        let Room { u, wi, direction, drawn, towards, hits, lanes, .. } = room;
        let few = L::FUSED && groups.iter().all(|groups| groups.len() == 1);
        if evaluates {
            hits.sums::<L>(groups, few, wi, lanes, towards);
        }
        if draws {
            let chosen = if few {
                Chosen::new::<L, true>(hits, groups, &u[0])
            } else {
                Chosen::new::<L, false>(hits, groups, &u[0])
            };
            *direction = hits.draw::<L>(&chosen, u);
            hits.sums::<L>(groups, few, direction, lanes, drawn);
        }
    }
}

impl Hits {
    /// Draws from the chosen lobes, or the diffuse terms.
    #[inline(always)]
    fn draw<L: Lanes>(&self, chosen: &Chosen, u: &[Numbers; 3]) -> [Numbers; 3] {
        let (zero, one, half) = (L::splat(0.0), L::splat(1.0), L::splat(0.5));
        let mut out = [ZEROS; 3];
        let mut at = 0;
        while at + L::COUNT <= WIDEST {
            let frame = Frame {
                in_plane: self.in_plane,
                any_squeezed: self.any_squeezed,
                any_diffuse: self.any_diffuse,
                is_folded: true,
                azimuth: [L::load(&self.azimuth[0][at..]), L::load(&self.azimuth[1][at..])],
                widen: [L::load(&self.widen[0][at..]), L::load(&self.widen[1][at..])],
            };
            let choice = Choice {
                axis: [
                    L::load(&chosen.axis[0][at..]),
                    L::load(&chosen.axis[1][at..]),
                    L::load(&chosen.axis[2][at..]),
                ],
                inside: L::load(&chosen.inside[at..]),
                gone: L::load(&chosen.gone[at..]),
                inverse_sharpness: L::load(&chosen.inverse_sharpness[at..]),
                is_squeezed: L::load(&chosen.squeezed[at..]).ge(half),
                is_lobe: L::load(&chosen.target[at..]).lt(L::load(&self.lobes_power[at..])),
            };
            let [x, y, z] = draw(&frame, choice, L::load(&u[1][at..]), L::load(&u[2][at..]));
            let shines = zero.lt(L::load(&self.power[at..]));
            L::select(shines, x, zero).store(&mut out[0][at..]);
            L::select(shines, y, zero).store(&mut out[1][at..]);
            L::select(shines, z, one).store(&mut out[2][at..]);
            at += L::COUNT;
        }
        out
    }

    /// Values and densities towards a direction for each hit. `few`: each has one group of lobes.
    #[inline(always)]
    fn sums<L: Lanes>(
        &self,
        groups: &[&[Group]; WIDEST],
        few: bool,
        wi: &[Numbers; 3],
        lanes: &mut Lanes3,
        sums: &mut Sums,
    ) {
        let sights = sights::<L>(self.azimuth, self.excess, self.stretch, wi);
        for i in 0..self.count.min(WIDEST) {
            let acc = if few {
                sum_lobes::<L::Lobes, true>(groups[i], self.lobes[i], self.squeezed[i], &sights, i)
            } else {
                sum_lobes::<L::Lobes, false>(groups[i], self.lobes[i], self.squeezed[i], &sights, i)
            };
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

/// Sums the lobes of hit `i` in red, green and blue.
#[inline(always)]
fn sum_lobes<L: Lanes, const FEW: bool>(
    groups: &[Group],
    lobes: usize,
    squeezed: usize,
    sights: &Sights,
    i: usize,
) -> [L; 3] {
    let mut acc = [L::splat(0.0); 3];
    row::for_lobes!(FEW, L, groups, lobes, |group, at, k| {
        let mask = L::first_lanes(squeezed.saturating_sub(k).min(L::COUNT));
        let (rate, fold_rate) = (L::load(&group[row::RATE][at..]), L::load(&group[row::FOLD_RATE][at..]));
        let g = folded_falloff::<L, false>(axes(group, at), rate, fold_rate, &seen(sights, i, mask));
        add(group, at, g, &mut acc);
    });
    acc
}

/// Axes of the lobes of a group from one on.
#[inline(always)]
pub(crate) fn axes<L: Lanes>(group: &Group, at: usize) -> [L; 3] {
    let [x, y, z] = [row::AXIS_X, row::AXIS_Y, row::AXIS_Z];
    [L::load(&group[x][at..]), L::load(&group[y][at..]), L::load(&group[z][at..])]
}

/// Adds the lobes of a group from one on, of which a direction has the shares `g`.
#[inline(always)]
pub(crate) fn add<L: Lanes>(group: &Group, at: usize, g: L, acc: &mut [L; 3]) {
    for channel in 0..3 {
        acc[channel] = g.mul_add(L::load(&group[row::RED + channel][at..]), acc[channel]);
    }
}

/// The chosen lobes of a block.
struct Chosen {
    axis: [Numbers; 3],
    inside: Numbers,
    gone: Numbers,
    inverse_sharpness: Numbers,
    squeezed: Numbers,
    /// Place on the running sum of powers.
    target: Numbers,
}

impl Chosen {
    #[inline(always)]
    fn new<L: Lanes, const FEW: bool>(hits: &Hits, groups: &[&[Group]; WIDEST], u: &Numbers) -> Self {
        // Harmless ones behind the last hit.
        let mut chosen = Self {
            axis: [ZEROS, ZEROS, ONES],
            inside: ONES,
            gone: ZEROS,
            inverse_sharpness: ONES,
            squeezed: ZEROS,
            target: ZEROS,
        };
        for i in 0..hits.count.min(WIDEST) {
            let target = chosen_power(hits.power[i], L::One::splat(u[i])).first();
            let k = chosen_lobe::<L::Lobes, FEW>(groups[i], hits.lobes[i], target);
            let Some(group) = groups[i].get(if FEW { 0 } else { k / WIDEST }) else { continue };
            let at = k % WIDEST;
            for axis in 0..3 {
                chosen.axis[axis][i] = group[row::AXIS_X + axis][at];
            }
            chosen.inside[i] = group[row::INSIDE][at];
            chosen.gone[i] = group[row::TAIL][at];
            chosen.inverse_sharpness[i] = group[row::INVERSE_SHARPNESS][at];
            chosen.squeezed[i] = if k < hits.squeezed[i] { 1.0 } else { 0.0 };
            chosen.target[i] = target;
        }
        chosen
    }
}

/// The lobe at a place on the running sum of powers; the last one ends the search whatever the sum is rounded to.
#[inline(always)]
pub(crate) fn chosen_lobe<L: Lanes, const FEW: bool>(groups: &[Group], lobes: usize, target: f32) -> usize {
    let mut above = 1u64.wrapping_shl((lobes as u32).wrapping_sub(1));
    row::for_lobes!(FEW, L, groups, lobes, |group, at, k| {
        above |= L::bits(L::splat(target).lt(L::load(&group[row::CUMULATIVE][at..]))) << k;
    });
    (above.trailing_zeros() as usize).min(WIDEST * groups.len() - 1)
}
