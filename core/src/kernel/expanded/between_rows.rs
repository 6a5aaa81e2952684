//! The lobes of an expanded material between two rows: lanes are lobes.
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use super::super::between_views::{Place, views_passed};
use super::super::outgoing::Facing;
use super::table::{
    DIFFUSE, Expanded, HEAD, IN_PLANE, INVERSE_SQUEEZE, LOBES_ALBEDO, LOBES_POWER, MIRRORED, whole,
};
use crate::error::Error;
use crate::mixture::complete::{LEAST_SHARPNESS, tail_and_inside, tail_and_inside_of_sharp};
use crate::mixture::factors::Factors;
use crate::mixture::row::{self, Group};
use crate::mixture::rows::{AnyMixture, Domain, lowest_bits};
use crate::simd::detect::Level;
use crate::simd::lanes::{Lanes, Numbers, WIDEST, dot3, splat3};
use crate::simd::routine::One;
use crate::squeeze::Squeeze;
use core::f32::consts::{FRAC_1_PI, LOG2_E};
use glam::Vec3;

/// Lobes as they are interpolated.
#[derive(Clone, Copy)]
struct Lobes<L> {
    /// Unit vectors above the horizon.
    pub axis: [L; 3],
    pub sharpness: L,
    /// Integrals in red, green and blue.
    pub power: [L; 3],
}

impl<L: Lanes> Lobes<L> {
    /// Those from the `j`-th on of the same group of two rows. `W`: [`IN_PLANE`] or [`MIRRORED`]; `P`: of a
    /// material that is plain.
    #[inline(always)]
    pub fn between<const W: usize, const P: bool>([a, b]: [&[Numbers; W]; 2], share: L, j: usize) -> Self {
        let mut numbers = [L::splat(0.0); MIRRORED];
        for i in 0..W {
            let (a, b) = (L::load(&a[i][j..]), L::load(&b[i][j..]));
            // Axes by the difference, which rounds once: their digits count by the root of the sharpness.
            let is_axis = i < 2 || i == MIRRORED - 1;
            numbers[i] = if is_axis { (b - a).mul_add(share, a) } else { blend(a, b, share) };
        }
        let [x, z, sharpness, red, green, blue, y] = numbers;
        let mut axis = [x, y, z.abs()];
        let mut squared = x.mul_add(x, z * z);
        if W == MIRRORED {
            squared = y.mul_add(y, squared);
        }
        let inverse = if P {
            // One step of Newton's from 1.
            squared.neg_mul_add(L::splat(0.5), L::splat(1.5))
        } else {
            // Axes that are opposite have none between them.
            let squared = squared.max(L::splat(1e-12));
            squared.sqrt() / squared
        };
        for i in 0..3 {
            axis[i] = axis[i] * inverse;
        }
        Self { axis, sharpness, power: [red, green, blue] }
    }

    /// `1 / s`, `exp(-2 s)` and `1 - exp(-2 s)`.
    #[inline(always)]
    fn integral<const P: bool>(&self) -> [L; 3] {
        let s = self.least_sharpness::<P>();
        let [tail, inside] = if P { tail_and_inside_of_sharp(s) } else { tail_and_inside(s) };
        [L::splat(1.0) / s, tail, inside]
    }

    /// The sharpness, at least that of a lobe that is constant to f32.
    #[inline(always)]
    fn least_sharpness<const P: bool>(&self) -> L {
        if P { self.sharpness } else { self.sharpness.max(L::splat(LEAST_SHARPNESS)) }
    }
}

/// Between two numbers: either at its end, and no less than 0 where they are not. A difference would leave the smaller of the two
/// only the rounding of the larger.
#[inline(always)]
pub(super) fn blend<L: Lanes>(a: L, b: L, share: L) -> L {
    b.mul_add(share, a * (L::splat(1.0) - share))
}

/// The same group of lobes of two rows, as arrays of [`Numbers`]s.
#[inline(always)]
fn group<'m, const W: usize>([a, b]: [&'m [Numbers]; 2], g: usize) -> [&'m [Numbers; W]; 2] {
    let part = |row: &'m [Numbers]| row[1 + g * W..].first_chunk().expect("a row has all groups");
    [part(a), part(b)]
}

impl Expanded<'_> {
    /// Makes the mixture for an outgoing direction, in the caller's storage, which it overwrites: as
    /// [`Material::prepare`](crate::Material::prepare), in less time, with an error that falls with the
    /// square of the number of rows.
    ///
    /// # Errors
    /// [`Error::Capacity`] if the storage has room for fewer lobes than the material has;
    /// [`Error::Direction`] if `wo` is not a finite unit vector. The mixture is empty then.
    #[inline]
    pub fn prepare<'a>(&'a self, wo: impl Into<Vec3>, mixture: &mut AnyMixture<'a>) -> Result<(), Error> {
        let level = Level::current();
        level.run_one::<_, Towards>(Prepare { expanded: self, level, mixture }, wo.into().to_array())
    }
}

/// What [`Towards`] is given beside the outgoing direction.
struct Prepare<'a, 'm> {
    expanded: &'m Expanded<'m>,
    /// The level that it runs on.
    level: Level,
    mixture: &'a mut AnyMixture<'m>,
}

/// The mixture for one outgoing direction.
struct Towards;

impl One<Prepare<'_, '_>> for Towards {
    type Output = Result<(), Error>;
    const IS_WIDE: bool = true;
    #[inline(always)]
    fn run<L: Lanes>(to: Prepare<'_, '_>, numbers: [f32; 3]) -> Result<(), Error> {
        let Prepare { expanded, level, mixture } = to;
        let material = expanded.material.borrowed();
        mixture.begin(level, Domain::Hemisphere, Squeeze::NONE);
        let needed = material.header.lobe_count();
        if needed > mixture.capacity() {
            return Err(Error::Capacity { needed, available: mixture.capacity() });
        }
        let wo = Vec3::from_array(numbers);
        let Some(outgoing) = Facing::<L::One>::new(splat3(numbers)).first(wo) else {
            return Err(Error::Direction);
        };
        if wo.z < 0.0 {
            return Ok(());
        }
        let [row, share] = expanded.place::<L>(outgoing.theta);
        let rows = expanded.two_rows(whole(row));
        let mut head = [0.0; HEAD];
        for i in 0..HEAD {
            head[i] = blend(rows[0][0][i], rows[1][0][i], share);
        }
        mixture.head.squeeze = Squeeze::new(outgoing.azimuth, 1.0, head[INVERSE_SQUEEZE]);
        mixture.set_diffuse([head[DIFFUSE], head[DIFFUSE + 1], head[DIFFUSE + 2]]);
        mixture.head.in_plane = material.header.mirrored == 0;
        store_lobes::<L::Lobes>(expanded, rows, share, &mut mixture.groups);
        // Every lobe has its fold, and the sums over the lobes are interpolated.
        (mixture.head.count, mixture.head.squeezed) = (needed, material.header.squeezed);
        mixture.head.folded = lowest_bits(needed);
        mixture.head.lobes_albedo =
            Vec3::new(head[LOBES_ALBEDO], head[LOBES_ALBEDO + 1], head[LOBES_ALBEDO + 2]);
        mixture.head.lobes_power = head[LOBES_POWER];
        mixture.add_diffuse();
        if material.header.has_factors() {
            let passed = views_passed::<L>(material, outgoing.theta);
            let place = Place::after(material, passed, outgoing.theta);
            mixture.head.factors = Factors::new(material, wo, place.among());
        }
        Ok(())
    }
}

/// Interpolates all lobes into groups.
#[inline(always)]
pub(super) fn store_lobes<L: Lanes>(
    expanded: &Expanded<'_>,
    rows: [&[Numbers]; 2],
    share: f32,
    groups: &mut [Group],
) {
    let header = expanded.material.borrowed().header;
    let count = header.lobe_count();
    match (header.mirrored == 0, expanded.is_plain) {
        (true, true) => store_lobes_of::<L, IN_PLANE, true>(rows, share, groups, count),
        (true, false) => store_lobes_of::<L, IN_PLANE, false>(rows, share, groups, count),
        (false, true) => store_lobes_of::<L, MIRRORED, true>(rows, share, groups, count),
        (false, false) => store_lobes_of::<L, MIRRORED, false>(rows, share, groups, count),
    }
}

/// `W`: the chunks of a group; `P`: of a material that is plain.
#[inline(always)]
fn store_lobes_of<L: Lanes, const W: usize, const P: bool>(
    rows: [&[Numbers]; 2],
    share: f32,
    groups: &mut [Group],
    count: usize,
) {
    let (mut k, mut passed) = (0, L::splat(0.0));
    for (g, to) in groups.iter_mut().enumerate() {
        let mut at = 0;
        while k < count && at + L::COUNT <= WIDEST {
            let lobes = Lobes::<L>::between::<W, P>(group(rows, g), L::splat(share), at);
            let [inverse, tail, inside] = lobes.integral::<P>();
            let normaliser =
                lobes.sharpness.max(L::splat(LEAST_SHARPNESS)) * L::splat(0.5 * FRAC_1_PI) / inside;
            let [x, y, z] = lobes.axis;
            let rate = lobes.sharpness * L::splat(-0.5 * LOG2_E);
            let luminance = luminance_of(lobes.power);
            x.store(&mut to[row::AXIS_X][at..]);
            y.store(&mut to[row::AXIS_Y][at..]);
            z.store(&mut to[row::AXIS_Z][at..]);
            lobes.sharpness.store(&mut to[row::SHARPNESS][at..]);
            (lobes.power[0] * normaliser).store(&mut to[row::RED][at..]);
            (lobes.power[1] * normaliser).store(&mut to[row::GREEN][at..]);
            (lobes.power[2] * normaliser).store(&mut to[row::BLUE][at..]);
            (luminance * normaliser).store(&mut to[row::LUMINANCE][at..]);
            rate.store(&mut to[row::RATE][at..]);
            (rate * z * L::splat(4.0)).store(&mut to[row::FOLD_RATE][at..]);
            inverse.store(&mut to[row::INVERSE_SHARPNESS][at..]);
            inside.store(&mut to[row::INSIDE][at..]);
            tail.store(&mut to[row::TAIL][at..]);
            (luminance.running_sum() + passed).store(&mut to[row::CUMULATIVE][at..]);
            (k, at) = (k + L::COUNT, at + L::COUNT);
            if k < count {
                passed = passed + L::splat(luminance.sum());
            }
        }
    }
}

/// The luminance of three numbers.
#[inline(always)]
fn luminance_of<L: Lanes>(rgb: [L; 3]) -> L {
    dot3(rgb, splat3(crate::color::LUMINANCE))
}
