//! From a material and an outgoing direction to a mixture: lanes are lobes.

use crate::anisotropic;
use crate::format::{self, Kind, f32_at};
use crate::lanes::{Lanes, atan2_positive, exp2, sin_cos};
use crate::simd::Routine;
use crate::squeeze::Squeeze;
use crate::two::Two;
use crate::{Domain, Error, LeaveOut, MAX_LOBES, Material, Mixture};
use glam::Vec3;

/// Widest vector of any back end, a pair included.
const WIDEST: usize = 32;

/// The bytes from an offset on, at least `need` of them: near the end of the file those of `copy`, which is then made.
macro_rules! from_offset {
    ($bytes:expr, $offset:expr, $need:expr, $copy:ident) => {{
        let rest: &[u8] = &$bytes[$offset..];
        if rest.len() >= $need {
            rest
        } else {
            $copy = padded(rest);
            &$copy[..]
        }
    }};
}

pub(crate) struct Prepare<'a, 'b, 'm, const N: usize> {
    pub material: &'a Material<'b>,
    pub wo: Vec3,
    pub leave_out: LeaveOut,
    pub mixture: &'m mut Mixture<N>,
}

impl<const N: usize> Routine for Prepare<'_, '_, '_, N> {
    type Output = Result<(), Error>;
    #[inline(always)]
    fn run<L: Lanes>(self) -> Result<(), Error> {
        prepare::<L, N>(self.material, self.wo, self.leave_out, self.mixture)
    }
}

#[inline(always)]
pub(crate) fn prepare<L: Lanes, const N: usize>(
    material: &Material<'_>,
    wo: Vec3,
    leave_out: LeaveOut,
    mixture: &mut Mixture<N>,
) -> Result<(), Error> {
    if let Kind::Grid(shape) = material.header.kind {
        return if L::PAIRED && 2 * L::COUNT <= 16 {
            anisotropic::prepare::<Two<L>, N>(material, shape, wo, leave_out, mixture)
        } else {
            anisotropic::prepare::<L, N>(material, shape, wo, leave_out, mixture)
        };
    }
    mixture.begin(Domain::Hemisphere, Squeeze::NONE);
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

    // +x of the view points away from wo, towards the mirror direction; at the normal any azimuth serves.
    let across = Lanes::sqrt(across_squared);
    let azimuth = if across > 0.0 {
        let inverse = 1.0 / across;
        [-wo.x * inverse, -wo.y * inverse]
    } else {
        [1.0, 0.0]
    };
    let place = Place::find::<L>(material, across, wo.z);

    // The heads: squeeze and diffuse albedo.
    let (copy_a, copy_b);
    let (a, b) = (material.header.head(place.before), material.header.head(place.after));
    let a = from_offset!(material.bytes, a, 4 * WIDEST, copy_a);
    let b = from_offset!(material.bytes, b, 4 * WIDEST, copy_b);
    let mut head = [0.0; WIDEST];
    let mut i = 0;
    while i < format::HEAD {
        exp2(place.between::<L>(a, b, i)).store(&mut head[i..]);
        i += L::COUNT;
    }
    mixture.squeeze = Squeeze::new(azimuth, 1.0, 1.0 / head[0]);
    mixture.diffuse = Vec3::new(head[1], head[2], head[3]);

    // Twelve lobes are one and a half vectors of eight lanes: a pair of them, with constants loaded once.
    match (L::PAIRED && 2 * L::COUNT <= 16, material.header.mirrored > 0) {
        (true, true) => lobes::<Two<L>, N, true>(material, place, leave_out, mixture),
        (true, false) => lobes::<Two<L>, N, false>(material, place, leave_out, mixture),
        (false, true) => lobes::<L, N, true>(material, place, leave_out, mixture),
        (false, false) => lobes::<L, N, false>(material, place, leave_out, mixture),
    }
    Ok(())
}

/// The two views round an outgoing direction, and how far between them it lies.
#[derive(Clone, Copy)]
struct Place {
    before: usize,
    after: usize,
    blend: f32,
}

impl Place {
    /// `across` and `z`: sine and cosine of the angle of the outgoing direction.
    #[inline(always)]
    fn find<L: Lanes>(material: &Material<'_>, across: f32, z: f32) -> Self {
        let (bytes, header) = (material.bytes, &material.header);
        let theta = atan2_positive(L::One::splat(across), L::One::splat(z)).first();
        let last = header.views - 1;
        let mut passed = 0;
        let mut view = 0;
        while view < last {
            // Bits of the views from here to the last but one that are at most theta; the first always is.
            let copy;
            let thetas = from_offset!(bytes, header.theta(view), 4 * WIDEST, copy);
            let inner = u64::MAX >> (64 - (last - view).min(L::COUNT));
            passed += (L::bits(L::splat(theta).ge(L::load_bytes(thetas))) & inner).count_ones() as usize;
            view += L::COUNT;
        }
        let after = passed.min(last);
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

/// Interpolates the lobes and completes the mixture. `MIRRORED`: some of them are.
#[inline(always)]
fn lobes<L: Lanes, const N: usize, const MIRRORED: bool>(
    material: &Material<'_>,
    place: Place,
    leave_out: LeaveOut,
    mixture: &mut Mixture<N>,
) {
    let header = &material.header;
    let (count, mirrored) = (header.lobes, if MIRRORED { header.mirrored } else { 0 });
    let total = count + mirrored;
    // From as many numbers before the view as there are images, which lie so much before their own places: all that precedes
    // a view is longer. The last vector reaches past the view, and at the last view past the file.
    let reach = 4 * (4 * count + 2 * mirrored + total.next_multiple_of(L::COUNT));
    let (copy_a, copy_b);
    let a = from_offset!(material.bytes, header.row(place.before, 0) - 4 * mirrored, reach, copy_a);
    let b = from_offset!(material.bytes, header.row(place.after, 0) - 4 * mirrored, reach, copy_b);
    let rows = Rows { a: &a[..reach], b: &b[..reach], place, count, mirrored };
    let zero = L::splat(0.0);
    mixture.in_plane = mirrored == 0;
    let mut k = 0;
    while k < total && k + L::COUNT <= N {
        let valid = L::iota().lt(L::splat((total - k) as f32));
        let angle = L::select(valid, rows.row(0, k), zero);
        let log_sharpness = L::select(valid, rows.row(1, k), zero);
        let log_red = rows.row::<L>(2, k);
        let log_green = rows.row::<L>(3, k);
        let log_blue = rows.row::<L>(4, k);
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
        L::select(valid, exp2(log_red), zero).store(&mut mixture.red[k..]);
        L::select(valid, exp2(log_green), zero).store(&mut mixture.green[k..]);
        L::select(valid, exp2(log_blue), zero).store(&mut mixture.blue[k..]);
        k += L::COUNT;
    }
    mixture.finish::<L>(total, header.squeezed, leave_out);
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
        L::select(self.before::<L>(self.count - self.mirrored, k), zero, mirrored)
    }

    /// Which lobes of a vector come before one.
    #[inline(always)]
    fn before<L: Lanes>(&self, lobe: usize, k: usize) -> L::Mask {
        L::iota().lt(L::splat(lobe as f32 - k as f32))
    }
}

/// Room for a view of the most lobes, and a vector more.
const PADDED: usize = 4 * (5 * MAX_LOBES + WIDEST);

/// The end of a file, with zeros after it.
#[cold]
#[inline(never)]
fn padded(rest: &[u8]) -> [u8; PADDED] {
    let mut copy = [0; PADDED];
    let len = rest.len().min(PADDED);
    copy[..len].copy_from_slice(&rest[..len]);
    copy
}
