//! From a material and an outgoing direction to a mixture: lanes are lobes.

use crate::factors::{Among, Factors};
use crate::format::{self, Kind, f32_at};
use crate::lanes::{Lanes, atan2_positive, exp2, sin_cos, splat3};
use crate::simd::{Level, Routine};
use crate::squeeze::Squeeze;
use crate::two::Two;
use crate::{Domain, Error, LeaveOut, MAX_LOBES, Material, Mixture, anisotropic, color};
use glam::Vec3;

/// Widest vector of any back end, a pair included.
const WIDEST: usize = 32;

/// The bytes from `ahead` before an offset on, at least `need` of them: near either end of the file those of `copy`, `len` bytes, which
/// is then made.
macro_rules! from_offset {
    ($bytes:expr, $offset:expr, $ahead:expr, $need:expr, $copy:ident, $len:expr) => {{
        let (bytes, offset, ahead): (&[u8], usize, usize) = ($bytes, $offset, $ahead);
        if offset >= ahead && bytes.len() - (offset - ahead) >= $need {
            &bytes[offset - ahead..]
        } else {
            $copy = padded::<$len>(bytes, offset, ahead, $need);
            &$copy[..]
        }
    }};
}

pub(crate) struct Prepare<'a, 'b, const N: usize> {
    pub material: &'a Material<'b>,
    pub wo: Vec3,
    pub leave_out: LeaveOut,
    /// What it runs on.
    pub level: Level,
    pub mixture: &'a mut Mixture<'b, N>,
}

impl<const N: usize> Routine for Prepare<'_, '_, N> {
    type Output = Result<(), Error>;
    #[inline(always)]
    fn run<L: Lanes>(self) -> Result<(), Error> {
        prepare::<L, N>(self.material, self.wo, self.leave_out, self.level, self.mixture)
    }
}

#[inline(always)]
pub(crate) fn prepare<'m, L: Lanes, const N: usize>(
    material: &Material<'m>,
    wo: Vec3,
    leave_out: LeaveOut,
    level: Level,
    mixture: &mut Mixture<'m, N>,
) -> Result<(), Error> {
    mixture.begin(level, Domain::Hemisphere, Squeeze::NONE);
    let count = material.lobe_count();
    if count > N {
        return Err(Error::Capacity { needed: count, available: N });
    }
    // False for a NaN too.
    let across_squared = wo.x * wo.x + wo.y * wo.y;
    let is_unit = (across_squared + wo.z * wo.z - 1.0).abs() <= 2e-3;
    if !is_unit {
        return Err(Error::Direction);
    }
    if wo.z < 0.0 {
        return Ok(());
    }
    if let Kind::Grid(shape) = material.header.kind {
        if L::LOBES_PAIRED {
            anisotropic::prepare::<Two<L>, N>(material, shape, wo, leave_out, mixture);
        } else {
            anisotropic::prepare::<L, N>(material, shape, wo, leave_out, mixture);
        }
        return Ok(());
    }
    // Where one number has no fused operations but a vector has, in a vector: the same bits as in `PrepareInto`.
    let (azimuth, theta) = if L::FUSED && !L::One::FUSED {
        Facing::<L>::of(wo, across_squared)
    } else {
        Facing::<L::One>::of(wo, across_squared)
    };
    let place = Place::after(material, views_passed::<L>(material, theta), theta);
    at_place::<L, N>(material, azimuth, place, leave_out, mixture);
    mixture.sum_up();
    take_factors(material, place, wo, mixture);
    Ok(())
}

/// Gives a mixture the factors of its material, if there are some.
#[inline(always)]
fn take_factors<'m, const N: usize>(
    material: &Material<'m>,
    place: Place,
    wo: Vec3,
    mixture: &mut Mixture<'m, N>,
) {
    if material.header.factors[0] > 0 {
        let views = [[place.before as u16, place.after as u16]; 2];
        mixture.factors = Factors::new(material, wo, Among { views, onward: place.blend, outward: 0.0 });
    }
}

/// Mixtures for many outgoing directions: lanes are directions for their angles and azimuths, lobes for the rest.
pub(crate) struct PrepareInto<'a, 'b, const N: usize> {
    pub material: &'a Material<'b>,
    pub wo: [&'a [f32]; 3],
    /// What it runs on.
    pub level: Level,
    /// As many as directions; a direction that is none leaves an empty one. They have room for all lobes.
    pub mixtures: &'a mut [Mixture<'b, N>],
}

impl<const N: usize> Routine for PrepareInto<'_, '_, N> {
    type Output = ();
    #[inline(always)]
    #[allow(clippy::needless_range_loop)] // see lanes: kernels loop over array indices
    fn run<L: Lanes>(self) {
        let Self { material, wo, level, mixtures } = self;
        let [x, y, z] = wo;
        if L::COUNT == 1 || matches!(material.header.kind, Kind::Grid(_)) {
            for i in 0..mixtures.len() {
                let wo = Vec3::new(x[i], y[i], z[i]);
                let _ = prepare::<L, N>(material, wo, LeaveOut::default(), level, &mut mixtures[i]);
            }
            return;
        }
        let mut at = 0;
        while at < mixtures.len() {
            let count = L::COUNT.min(mixtures.len() - at);
            let [x, y, z] =
                [load_some::<L>(&x[at..], count), load_some(&y[at..], count), load_some(&z[at..], count)];
            let across_squared = x * x + y * y;
            let off = (across_squared + z * z - L::splat(1.0)).abs();
            let seen = L::bits(L::splat(2e-3).ge(off)) & L::bits(z.ge(L::splat(0.0)));
            let facing = Facing::new([x, y, z], across_squared);
            let mut passed = L::splat(0.0);
            for view in 0..material.header.views - 1 {
                let theta = L::splat(f32_at(material.bytes, material.header.theta(view)));
                passed = passed + L::select(facing.theta.ge(theta), L::splat(1.0), L::splat(0.0));
            }
            let (mut thetas, mut passed_by, mut azimuths) =
                ([0.0; WIDEST], [0.0; WIDEST], [[0.0; WIDEST]; 2]);
            facing.theta.store(&mut thetas);
            passed.store(&mut passed_by);
            facing.azimuth[0].store(&mut azimuths[0]);
            facing.azimuth[1].store(&mut azimuths[1]);
            for i in 0..count {
                let mixture = &mut mixtures[at + i];
                mixture.begin(level, Domain::Hemisphere, Squeeze::NONE);
                if seen >> i & 1 == 1 {
                    let place = Place::after(material, passed_by[i] as usize, thetas[i]);
                    let azimuth = [azimuths[0][i], azimuths[1][i]];
                    at_place::<L, N>(material, azimuth, place, LeaveOut::default(), mixture);
                    let wo = Vec3::new(wo[0][at + i], wo[1][at + i], wo[2][at + i]);
                    take_factors(material, place, wo, mixture);
                }
            }
            // Apart, so that the chains of additions of many mixtures run side by side.
            for mixture in &mut mixtures[at..at + count] {
                mixture.sum_up();
            }
            at += L::COUNT;
        }
    }
}

/// The first `count` numbers of a slice, and zeros.
#[inline(always)]
fn load_some<L: Lanes>(from: &[f32], count: usize) -> L {
    if count == L::COUNT {
        return L::load(from);
    }
    let mut padded = [0.0; WIDEST];
    padded[..count].copy_from_slice(&from[..count]);
    L::load(&padded)
}

/// Outgoing directions as angle from the normal and azimuth.
struct Facing<L> {
    theta: L,
    /// Cosine and sine, in the caller's frame, of the azimuth of +x of the view.
    azimuth: [L; 2],
}

impl<L: Lanes> Facing<L> {
    /// Azimuth and angle of one direction.
    #[inline(always)]
    fn of(wo: Vec3, across_squared: f32) -> ([f32; 2], f32) {
        let facing = Self::new(splat3(wo.to_array()), L::splat(across_squared));
        ([facing.azimuth[0].first(), facing.azimuth[1].first()], facing.theta.first())
    }

    /// Of unit vectors above the horizon; anything for others.
    #[inline(always)]
    fn new([x, y, z]: [L; 3], across_squared: L) -> Self {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let across = across_squared.sqrt();
        // +x of the view points away from wo, towards the mirror direction; at the normal any azimuth serves, and the square of
        // what is nearer to it than 1e-19 has lost its digits.
        let inverse = one / across;
        let is_tilted = across_squared.ge(L::splat(f32::MIN_POSITIVE));
        let azimuth = [
            L::select(is_tilted, (zero - x) * inverse, one),
            L::select(is_tilted, (zero - y) * inverse, zero),
        ];
        Self { theta: atan2_positive(across, z), azimuth }
    }
}

/// Interpolates the views round a place. The mixture has begun, and is to be summed up.
#[inline(always)]
fn at_place<L: Lanes, const N: usize>(
    material: &Material<'_>,
    azimuth: [f32; 2],
    place: Place,
    leave_out: LeaveOut,
    mixture: &mut Mixture<'_, N>,
) {
    // The heads: squeeze and diffuse albedo.
    let (copy_a, copy_b);
    let (a, b) = (material.header.head(place.before), material.header.head(place.after));
    let a = from_offset!(material.bytes, a, 0, HEADS, copy_a, HEADS);
    let b = from_offset!(material.bytes, b, 0, HEADS, copy_b, HEADS);
    let (mut head, mut logarithms) = ([0.0; WIDEST], [0.0; WIDEST]);
    let mut i = 0;
    while i < format::HEAD {
        // What comes behind the head is none of its numbers, and its power of two may be a subnormal, which costs 150 cycles.
        let numbers = place.between::<L>(a, b, i).keep(L::first_lanes(format::HEAD - i));
        exp2(numbers).store(&mut head[i..]);
        if material.header.has_luminance {
            numbers.store(&mut logarithms[i..]);
        }
        i += L::COUNT;
    }
    mixture.squeeze = Squeeze::new(azimuth, 1.0, 1.0 / head[0]);
    mixture.diffuse = if material.header.has_luminance {
        Vec3::from_array(color::rgb(head[1], [logarithms[2], logarithms[3]]))
    } else {
        Vec3::new(head[1], head[2], head[3])
    };

    // Twelve lobes are one and a half vectors of eight lanes: a pair of them, with constants loaded once.
    match (L::LOBES_PAIRED, material.header.mirrored > 0) {
        (true, true) => lobes::<Two<L>, N, true>(material, place, leave_out, mixture),
        (true, false) => lobes::<Two<L>, N, false>(material, place, leave_out, mixture),
        (false, true) => lobes::<L, N, true>(material, place, leave_out, mixture),
        (false, false) => lobes::<L, N, false>(material, place, leave_out, mixture),
    }
}

/// The two views round an outgoing direction, and how far between them it lies.
#[derive(Clone, Copy)]
struct Place {
    before: usize,
    after: usize,
    blend: f32,
}

impl Place {
    /// `passed`: how many views but the last have an angle of at most `theta`.
    #[inline(always)]
    fn after(material: &Material<'_>, passed: usize, theta: f32) -> Self {
        let (bytes, header) = (material.bytes, &material.header);
        let after = passed.min(header.views - 1);
        let before = after.saturating_sub(1);
        let (from, to) = (f32_at(bytes, header.theta(before)), f32_at(bytes, header.theta(after)));
        let blend = if to > from { ((theta - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
        Self { before, after, blend }
    }

    /// Interpolates numbers from the `i`-th on; `a` and `b` are the bytes of the same rows of the two views.
    #[inline(always)]
    fn between<L: Lanes>(self, a: &[u8], b: &[u8], i: usize) -> L {
        let (a, b) = (L::load_bytes(&a[4 * i..]), L::load_bytes(&b[4 * i..]));
        (b - a).mul_add(L::splat(self.blend), a)
    }
}

/// How many views but the last have an angle of at most `theta`; the first always has.
#[inline(always)]
fn views_passed<L: Lanes>(material: &Material<'_>, theta: f32) -> usize {
    let last = material.header.views - 1;
    let mut passed = 0;
    let mut view = 0;
    while view < last {
        let copy;
        let thetas = from_offset!(material.bytes, material.header.theta(view), 0, HEADS, copy, HEADS);
        let inner = u64::MAX >> (64 - (last - view).min(L::COUNT));
        passed += (L::bits(L::splat(theta).ge(L::load_bytes(thetas))) & inner).count_ones() as usize;
        view += L::COUNT;
    }
    passed
}

/// Interpolates the lobes and completes the mixture but for its sums. `MIRRORED`: some of them are.
#[inline(always)]
fn lobes<L: Lanes, const N: usize, const MIRRORED: bool>(
    material: &Material<'_>,
    place: Place,
    leave_out: LeaveOut,
    mixture: &mut Mixture<'_, N>,
) {
    let header = &material.header;
    let (count, mirrored) = (header.lobes, if MIRRORED { header.mirrored } else { 0 });
    let total = count + mirrored;
    // From as many numbers before the view as there are images, which lie so much before their own places. The last vector
    // reaches past the view, and at the last view past the file.
    let reach = 4 * (4 * count + 2 * mirrored + total.next_multiple_of(L::COUNT));
    let (copy_a, copy_b);
    let a = from_offset!(material.bytes, header.row(place.before, 0), 4 * mirrored, reach, copy_a, PADDED);
    let b = from_offset!(material.bytes, header.row(place.after, 0), 4 * mirrored, reach, copy_b, PADDED);
    let rows = Rows { a: &a[..reach], b: &b[..reach], place, count, mirrored };
    let zero = L::splat(0.0);
    mixture.in_plane = mirrored == 0;
    let mut k = 0;
    while k < total && k + L::COUNT <= N {
        let valid = L::iota().lt(L::splat((total - k) as f32));
        // Lanes without a lobe hold bytes of the next view or of the text, whose powers of two may be subnormals: 150 cycles each on Intel.
        // A power of -126 is exactly 0.
        let angle = rows.row::<L>(0, k).keep(valid);
        let log_sharpness = rows.row::<L>(1, k).keep(valid);
        let none = L::splat(-126.0);
        let first = exp2(L::select(valid, rows.row(2, k), none));
        let nothing = if header.has_luminance { zero } else { none };
        let second = L::select(valid, rows.row(3, k), nothing);
        let third = L::select(valid, rows.row(4, k), nothing);
        if header.has_luminance {
            let [red, green, blue] = color::rgb(first, [second, third]);
            red.store(&mut mixture.red[k..]);
            green.store(&mut mixture.green[k..]);
            blue.store(&mut mixture.blue[k..]);
        } else {
            first.store(&mut mixture.red[k..]);
            exp2(second).store(&mut mixture.green[k..]);
            exp2(third).store(&mut mixture.blue[k..]);
        }
        let (mut x, mut z) = sin_cos(angle);
        let mut y = zero;
        if mirrored > 0 && k + L::COUNT > count - mirrored {
            let (sin, cos) = sin_cos(rows.off_plane(k));
            (x, y, z) = (x * cos, sin, z * cos);
        }
        x.store(&mut mixture.axis_x[k..]);
        y.store(&mut mixture.axis_y[k..]);
        z.store(&mut mixture.axis_z[k..]);
        exp2(log_sharpness).store(&mut mixture.sharpness[k..]);
        k += L::COUNT;
    }
    mixture.finish_lobes::<L>(total, header.squeezed, leave_out);
}

/// The bytes of two views, from as many numbers before each as it has mirrored lobes.
struct Rows<'a> {
    a: &'a [u8],
    b: &'a [u8],
    place: Place,
    count: usize,
    mirrored: usize,
}

impl Rows<'_> {
    /// Numbers of a row of a vector of lobes, images being what they mirror; behind the last lobe anything.
    #[inline(always)]
    fn row<L: Lanes>(&self, row: usize, k: usize) -> L {
        let at = self.mirrored + row * self.count + k;
        let stored = self.place.between(self.a, self.b, at);
        if self.mirrored == 0 || k + L::COUNT <= self.count {
            return stored;
        }
        let image = self.place.between(self.a, self.b, at - self.mirrored);
        L::select(self.before::<L>(self.count, k), stored, image)
    }

    /// Angles out of the plane of incidence: 0, then those of the mirrored lobes, then their opposites, then 0.
    #[inline(always)]
    fn off_plane<L: Lanes>(&self, k: usize) -> L {
        let zero = L::splat(0.0);
        let at = 4 * self.count + self.mirrored + k;
        let stored = self.place.between(self.a, self.b, at + self.mirrored);
        let image = zero - self.place.between::<L>(self.a, self.b, at);
        let image = L::select(self.before::<L>(self.count + self.mirrored, k), image, zero);
        let mirrored = L::select(self.before::<L>(self.count, k), stored, image);
        let off_plane = L::select(self.before::<L>(self.count - self.mirrored, k), zero, mirrored);
        // The square of what is next to nothing is a subnormal.
        off_plane.keep(off_plane.abs().ge(L::splat(LEAST_OFF_PLANE)))
    }

    /// Which lobes of a vector come before one.
    #[inline(always)]
    fn before<L: Lanes>(&self, lobe: usize, k: usize) -> L::Mask {
        L::iota().lt(L::splat(lobe as f32 - k as f32))
    }
}

/// Least angle out of the plane of incidence that is not taken for 0, radians.
const LEAST_OFF_PLANE: f32 = 1e-9;

/// Bytes of one vector: the angles of views, or the head of one.
const HEADS: usize = 4 * WIDEST;

/// Room for a view of the most lobes, and a vector more.
const PADDED: usize = 4 * (5 * MAX_LOBES + WIDEST);

/// At least `need` bytes from `ahead` before an offset on, with zeros before the file and after it.
#[cold]
#[inline(never)]
fn padded<const LEN: usize>(bytes: &[u8], offset: usize, ahead: usize, need: usize) -> [u8; LEN] {
    let mut copy = [0; LEN];
    let missing = ahead.saturating_sub(offset).min(LEN);
    let rest = &bytes[offset.saturating_sub(ahead)..];
    let len = rest.len().min(need.min(LEN).saturating_sub(missing));
    copy[missing..missing + len].copy_from_slice(&rest[..len]);
    copy
}
