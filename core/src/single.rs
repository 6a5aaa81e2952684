//! One direction: lanes are lobes, for renderers that shade a point at a time.
#![allow(clippy::needless_range_loop)] // see lanes: kernels loop over array indices

use crate::batch::draw_one;
use crate::lanes::{Lanes, falloff, falloff_soon, scale};
use crate::mixture::lowest_bits;
use crate::simd::{Draw, One};
use crate::squeeze::{NUMBERS, Seen, Sight};
use crate::two::Two;
use crate::{Domain, Mixture};
use core::f32::consts::FRAC_1_PI;
use glam::Vec3;

/// Value towards a direction. `SEEN`: for a mixture that turns or squeezes it.
pub(crate) struct EvaluateOne<const SEEN: bool>;

impl<const N: usize, const SEEN: bool> One<Mixture<'_, N>> for EvaluateOne<SEEN> {
    type Output = Vec3;
    const IS_WIDE: bool = true;
    #[inline(always)]
    fn run<L: Lanes>(m: &Mixture<'_, N>, direction: [f32; 3]) -> Vec3 {
        value_one::<L, N, SEEN>(m, direction)
    }
}

/// Density at a direction. `SEEN`: for a mixture that turns or squeezes it.
pub(crate) struct PdfOne<const SEEN: bool>;

impl<const N: usize, const SEEN: bool> One<Mixture<'_, N>> for PdfOne<SEEN> {
    type Output = f32;
    const IS_WIDE: bool = true;
    #[inline(always)]
    fn run<L: Lanes>(m: &Mixture<'_, N>, direction: [f32; 3]) -> f32 {
        luminance_one::<L, N, SEEN>(m, direction) * m.inverse_power
    }
}

/// A direction from three uniform numbers, and what follows. `SEEN`: for a mixture that turns or squeezes it.
pub(crate) struct Drawn<const SEEN: bool>;

impl<const N: usize, const SEEN: bool> Draw<Mixture<'_, N>> for Drawn<SEEN> {
    #[inline(always)]
    fn run<L: Lanes>(m: &Mixture<'_, N>, u: [f32; 3]) -> ([f32; 3], f32) {
        let (d, inverse) = draw_one::<L, N, SEEN>(m, u);
        // What was squeezed has another length.
        if SEEN { (scale(d, inverse), 1.0) } else { (d, inverse) }
    }
}

/// A direction from three uniform numbers.
pub(crate) struct DirectionOne;

impl<const N: usize> One<Mixture<'_, N>> for DirectionOne {
    type Output = Vec3;
    const IS_WIDE: bool = false;
    #[inline(always)]
    fn run<L: Lanes>(m: &Mixture<'_, N>, u: [f32; 3]) -> Vec3 {
        let (d, inverse) = draw_one::<L, N, true>(m, u);
        Vec3::from_array(scale(d, inverse))
    }
}

/// Value towards one direction.
#[inline(always)]
pub(crate) fn value_one<L: Lanes, const N: usize, const SEEN: bool>(
    m: &Mixture<'_, N>,
    direction: [f32; 3],
) -> Vec3 {
    let amplitudes = [&m.red, &m.green, &m.blue];
    let diffuse = m.diffuse.to_array();
    // A pair of vectors of eight lanes: most mixtures need two, and constants are then loaded once.
    Vec3::from_array(if L::LOBES_PAIRED {
        sums_one::<Two<L>, N, 3, SEEN>(m, amplitudes, diffuse, direction)
    } else {
        sums_one::<L, N, 3, SEEN>(m, amplitudes, diffuse, direction)
    })
}

/// Luminance of the value towards one direction.
#[inline(always)]
pub(crate) fn luminance_one<L: Lanes, const N: usize, const SEEN: bool>(
    m: &Mixture<'_, N>,
    direction: [f32; 3],
) -> f32 {
    let diffuse = [m.diffuse_power];
    let [sum] = if L::LOBES_PAIRED {
        sums_one::<Two<L>, N, 1, SEEN>(m, [&m.luminance], diffuse, direction)
    } else {
        sums_one::<L, N, 1, SEEN>(m, [&m.luminance], diffuse, direction)
    };
    sum
}

/// Sums the lobes towards one direction, once for each of `C` sets of amplitudes. `SEEN`: it is turned or squeezed.
#[inline(always)]
pub(crate) fn sums_one<L: Lanes, const N: usize, const C: usize, const SEEN: bool>(
    m: &Mixture<'_, N>,
    amplitudes: [&[f32; N]; C],
    diffuse: [f32; C],
    direction: [f32; 3],
) -> [f32; C] {
    // False for a NaN too.
    let above = direction[2] >= 0.0;
    if !above && m.domain == Domain::Hemisphere {
        return [0.0; C];
    }
    let sums = if !SEEN {
        let seen = m.squeeze.turn(direction);
        all_lobes::<L, N, C, false>(m, amplitudes, &seen, &seen)
    } else if L::COUNT > 1 {
        let [turned, squeezed] = m.squeeze.precise.see(direction, L::FUSED);
        all_lobes::<L, N, C, true>(m, amplitudes, &turned, &squeezed)
    } else {
        let turned = m.squeeze.turn(direction);
        all_lobes::<L, N, C, true>(m, amplitudes, &turned, &m.squeeze.squeeze(&turned))
    };
    if m.domain == Domain::Sphere {
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
pub(crate) fn all_lobes<L: Lanes, const N: usize, const C: usize, const SEEN: bool>(
    m: &Mixture<'_, N>,
    amplitudes: [&[f32; N]; C],
    turned: &Sight,
    squeezed: &Sight,
) -> [f32; C] {
    let mut acc = [L::splat(0.0); C];
    // The usual number of lobes without a loop: a loop keeps more constants in registers than there are.
    if L::COUNT > 1 && 1 <= m.count && m.count <= L::COUNT {
        let seen = if !SEEN {
            turned.splat()
        } else if L::FUSED {
            Sight::splat_either::<L>(L::first_lanes(m.squeezed), squeezed, turned)
        } else {
            // No broadcasts under a mask; and the loop below is what is run.
            mix::<L>(&squeezed.splat(), &turned.splat(), m.squeezed)
        };
        add_lobes::<L, N, C, SEEN>(m, amplitudes, &seen, 0, &mut acc);
    } else {
        let (turned, squeezed) = (turned.splat(), squeezed.splat());
        let mut k = 0;
        while k < m.count && k + L::COUNT <= N {
            if k >= m.squeezed {
                add_lobes::<L, N, C, SEEN>(m, amplitudes, &turned, k, &mut acc);
            } else if k + L::COUNT <= m.squeezed {
                add_lobes::<L, N, C, SEEN>(m, amplitudes, &squeezed, k, &mut acc);
            } else {
                let mixed = mix::<L>(&squeezed, &turned, m.squeezed - k);
                add_lobes::<L, N, C, SEEN>(m, amplitudes, &mixed, k, &mut acc);
            }
            k += L::COUNT;
        }
    }
    let mut sums = [0.0; C];
    for i in 0..C {
        sums[i] = acc[i].sum();
    }
    sums
}

/// Adds the lobes from `k` on, one a lane. `SEEN`: the direction was turned or squeezed, and has a low part and a scale.
#[inline(always)]
fn add_lobes<L: Lanes, const N: usize, const C: usize, const SEEN: bool>(
    m: &Mixture<'_, N>,
    amplitudes: [&[f32; N]; C],
    seen: &Seen<L>,
    k: usize,
    acc: &mut [L; C],
) {
    let (axis, [x, y, z]) =
        ([L::load(&m.axis_x[k..]), L::load(&m.axis_y[k..]), L::load(&m.axis_z[k..])], seen.high);
    let mut rate = L::load(&m.rate[k..]);
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
    if m.folded >> k & lowest_bits(L::COUNT) != 0 {
        // A lobe of them that does not need its fold has a rate that leaves nothing of it.
        let t = L::load(&m.fold_rate[k..]).mul_add(seen.height, t);
        g = g + if SEEN { falloff(t) } else { falloff_soon(t) };
    }
    if SEEN {
        g = g * seen.scale;
    }
    for i in 0..C {
        acc[i] = g.mul_add(L::load(&amplitudes[i][k..]), acc[i]);
    }
}

/// What is seen, `first` by the first `count` lanes, `then` by the others.
#[inline(always)]
fn mix<L: Lanes>(first: &Seen<L>, then: &Seen<L>, count: usize) -> Seen<L> {
    let is_first = L::first_lanes(count);
    let (first, mut mixed) = (first.to_numbers(), then.to_numbers());
    for n in 0..NUMBERS {
        mixed[n] = L::select(is_first, first[n], mixed[n]);
    }
    Seen::from_numbers(mixed)
}
