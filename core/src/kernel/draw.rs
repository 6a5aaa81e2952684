//! Draws directions: a lobe by its power, then a direction in it; of one mixture, in vectors of directions or
//! alone.
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use crate::float::BELOW_ONE;
use crate::mixture::row;
use crate::mixture::rows::{AnyMixture, Domain, Head, MixtureRef};
use crate::simd::elementary::{ln_plus_times, sin_cos_turns};
use crate::simd::lanes::{Lanes, TOGETHER, WIDEST, dot3, halves, of_halves, scale};
use crate::squeeze::turn_back;

/// Chooses one of some shares, which sum to 1, by a number of a draw. Returns: its place, and the number that is left, uniform in [0, 1).
/// The last one that is not 0 takes the rest that rounding leaves.
#[inline(always)]
pub(crate) fn choose(shares: &[f32], u: f32) -> (usize, f32) {
    let (mut left, mut chosen) = (u, (0, 0.0));
    for (k, &share) in shares.iter().enumerate() {
        if share > 0.0 {
            chosen = (k, (left / share).min(BELOW_ONE));
            if left < share {
                break;
            }
            left -= share;
        }
    }
    chosen
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
    fn new(head: &Head<'_>) -> Self {
        Self {
            in_plane: head.in_plane,
            any_squeezed: head.squeezed > 0,
            any_diffuse: head.lobes_power < head.power,
            is_folded: head.domain == Domain::Hemisphere,
            azimuth: [L::splat(head.squeeze.azimuth[0]), L::splat(head.squeeze.azimuth[1])],
            widen: [L::splat(1.0 / head.squeeze.along), L::splat(1.0 / head.squeeze.inverse)],
        }
    }
}

/// Draws directions: lobe by `u[0]`, direction in it by `u[1]` and `u[2]`.
#[inline(always)]
pub(crate) fn sample_direction<L: Lanes>(m: &MixtureRef<'_>, u: [L; 3]) -> [L; 3] {
    if L::VECTORS > TOGETHER {
        let mut parts = halves(u);
        for i in 0..2 {
            parts[i] = sample_direction(m, parts[i]);
        }
        return of_halves(parts);
    }
    let head = m.head;
    let target = chosen_power(head.power, u[0]);
    let count = head.count;
    let k = target.search(&m.row(row::CUMULATIVE), count.saturating_sub(1));
    let choice = Choice {
        axis: [
            L::lookup(&m.row(row::AXIS_X), count, k),
            if head.in_plane { L::splat(0.0) } else { L::lookup(&m.row(row::AXIS_Y), count, k) },
            L::lookup(&m.row(row::AXIS_Z), count, k),
        ],
        inside: L::lookup(&m.row(row::INSIDE), count, k),
        gone: L::lookup(&m.row(row::TAIL), count, k),
        inverse_sharpness: L::lookup(&m.row(row::INVERSE_SHARPNESS), count, k),
        is_squeezed: L::index_below(k, head.squeezed),
        is_lobe: target.lt(L::splat(head.lobes_power)),
    };
    draw(&Frame::new(head), choice, u[1], u[2])
}

/// Draws one direction, and the factor that makes its length 1: lanes are lobes while the lobe
/// is searched. Without `SEEN`, for a mixture that neither turns nor squeezes it, that is 1 but for rounding.
#[cfg_attr(not(feature = "simd"), inline(never))]
#[cfg_attr(feature = "simd", inline(always))]
pub(crate) fn draw_one<L: Lanes, const SEEN: bool>(m: &AnyMixture<'_>, u: [f32; 3]) -> ([f32; 3], f32) {
    let target = u[0] * m.head.power;
    let k = chosen_lobe::<L>(m, target);
    draw_from::<L::One, SEEN>(m, k, target, u)
}

/// The lobe at a place on the running sum of powers.
#[inline(always)]
pub(crate) fn chosen_lobe<L: Lanes>(m: &AnyMixture<'_>, target: f32) -> usize {
    if L::COUNT == 1 {
        let last = m.head.count.clamp(1, m.capacity()) - 1;
        let mut passed = 0;
        for group in &m.groups {
            let powers = &group[row::CUMULATIVE][..WIDEST.min(last - passed)];
            let within = powers.iter().take_while(|power| target >= **power).count();
            passed += within;
            if within < WIDEST {
                break;
            }
        }
        return passed;
    }
    // The running sum never falls: the lobes that are passed come first, and numbers stored behind the last do not matter. The
    // last ends the search whatever its sum is rounded to.
    let mut above = 1u64.wrapping_shl((m.head.count as u32).wrapping_sub(1));
    row::for_lobes!(m.head.count <= WIDEST, L, &m.groups, m.head.count, |group, at, k| {
        above |= L::bits(L::splat(target).lt(L::load(&group[row::CUMULATIVE][at..]))) << k;
    });
    (above.trailing_zeros() as usize).min(m.capacity() - 1)
}

/// Draws one direction from lobe `k`, or the diffuse term; `L` has one lane.
#[inline(always)]
fn draw_from<L: Lanes<Index = usize>, const SEEN: bool>(
    m: &AnyMixture<'_>,
    k: usize,
    target: f32,
    u: [f32; 3],
) -> ([f32; 3], f32) {
    let (group, at) = (&m.groups[(k / WIDEST).min(m.groups.len() - 1)], k % WIDEST);
    let choice = Choice {
        axis: [
            L::splat(group[row::AXIS_X][at]),
            L::splat(group[row::AXIS_Y][at]),
            L::splat(group[row::AXIS_Z][at]),
        ],
        inside: L::splat(group[row::INSIDE][at]),
        gone: L::splat(group[row::TAIL][at]),
        inverse_sharpness: L::splat(group[row::INVERSE_SHARPNESS][at]),
        is_squeezed: L::index_below(k, m.head.squeezed),
        is_lobe: L::splat(target).lt(L::splat(m.head.lobes_power)),
    };
    let frame = Frame { any_squeezed: SEEN && m.head.squeezed > 0, ..Frame::new(&m.head) };
    let ([x, y, z], inverse) = draw_unscaled::<L, SEEN>(&frame, choice, L::splat(u[1]), L::splat(u[2]));
    ([x.first(), y.first(), z.first()], inverse.first())
}

/// The place on the running sum of powers that a uniform number stands for.
#[inline(always)]
pub(crate) fn chosen_power<L: Lanes>(power: f32, u: L) -> L {
    // Below the whole, so that a lobe that adds something is found whatever the product rounds to.
    (u * L::splat(power)).min(L::splat(power * (1.0 - f32::EPSILON)))
}

/// Draws directions from chosen lobes.
#[inline(always)]
pub(crate) fn draw<L: Lanes>(frame: &Frame<L>, choice: Choice<L>, u: L, turns: L) -> [L; 3] {
    let (d, inverse) = draw_unscaled::<L, true>(frame, choice, u, turns);
    scale(d, inverse)
}

/// Draws directions, and the factors that make their lengths 1. `SEEN`: they are turned.
#[inline(always)]
pub(crate) fn draw_unscaled<L: Lanes, const SEEN: bool>(
    frame: &Frame<L>,
    choice: Choice<L>,
    u: L,
    turns: L,
) -> ([L; 3], L) {
    let one = L::splat(1.0);
    // One direction is a chain of dependent operations: operations that do not wait for the lobe, and then those that do not wait
    // for the logarithm, run beside it.

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
        // A direction that is not squeezed has a length of 1 but for rounding, and one step of Newton's is exact.
        length_squared.neg_mul_add(L::splat(0.5), L::splat(1.5))
    };
    (if SEEN { turn_back(d, frame.azimuth) } else { d }, inverse)
}

/// The unit vector across an axis at an azimuth, in the frame of Duff et al. 2017: tangent and bitangent are
/// (1 + sign x a x, sign x a y, -sign x) and (y a x, sign + y a y, -y). Its last component comes with the
/// other sign. `signed` is cosine and sine times the sign.
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

/// `ln(1 - u inside) / s` with `inside = 1 - exp(-2 s)` and `gone = exp(-2 s)`, both to full precision;
/// rounding may leave it a little below -2. And that plus 2.
#[inline(always)]
fn cos_minus_one<L: Lanes>(u: L, inside: L, gone: L, inverse_sharpness: L) -> [L; 2] {
    let one = L::splat(1.0);
    // u = 1 at a large sharpness: a small number stands for 0.
    let left = (one - u).max(L::splat(1e-30));
    // 1 - u inside, rounded once; for a large u, for which 1 - u is exact, without cancellation.
    let y = L::select(u.lt(L::splat(0.5)), inside.neg_mul_add(u, one), gone.mul_add(u, left));
    // ln(1 - drop) = ln(y) + c / y, c what rounding lost of y. 1 / y = 1 + drop + ...: the terms left out are below a rounding.
    let drop = u * inside;
    let lost = (one - y) - drop;
    let lost = lost.mul_add(drop, lost).keep(y.ge(L::splat(0.5)));
    ln_plus_times(y, lost, inverse_sharpness)
}
