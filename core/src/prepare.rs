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
    mixture.squeeze = Squeeze { azimuth, inverse: 1.0 / head[0], ..Squeeze::NONE };
    mixture.diffuse = Vec3::new(head[1], head[2], head[3]);

    // Twelve lobes are one and a half vectors of eight lanes: a pair of them, with constants loaded once.
    if L::PAIRED && 2 * L::COUNT <= 16 {
        lobes::<Two<L>, N>(material, place, leave_out, mixture);
    } else {
        lobes::<L, N>(material, place, leave_out, mixture);
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

/// Interpolates the lobes and completes the mixture.
#[inline(always)]
fn lobes<L: Lanes, const N: usize>(
    material: &Material<'_>,
    place: Place,
    leave_out: LeaveOut,
    mixture: &mut Mixture<N>,
) {
    let header = &material.header;
    let count = header.lobes;
    let total = count + header.mirrored;
    // The last vector of the last row reaches past the view, and at the last view past the file.
    let reach = 4 * (4 * count + total.next_multiple_of(L::COUNT));
    let (copy_a, copy_b);
    let a = from_offset!(material.bytes, header.row(place.before, 0), reach, copy_a);
    let b = from_offset!(material.bytes, header.row(place.after, 0), reach, copy_b);
    let (a, b) = (&a[..reach], &b[..reach]);
    let zero = L::splat(0.0);
    let mut k = 0;
    while k < total && k + L::COUNT <= N {
        // Beyond the stored lobes there is room for the images of mirrored ones, or nothing.
        let valid = L::iota().lt(L::splat((count - k) as f32));
        let angle = L::select(valid, place.between(a, b, k), zero);
        let log_sharpness = L::select(valid, place.between(a, b, count + k), zero);
        let log_red = place.between::<L>(a, b, 2 * count + k);
        let log_green = place.between::<L>(a, b, 3 * count + k);
        let log_blue = place.between::<L>(a, b, 4 * count + k);
        let (sin, cos) = sin_cos(angle);
        sin.store(&mut mixture.axis_x[k..]);
        zero.store(&mut mixture.axis_y[k..]);
        cos.store(&mut mixture.axis_z[k..]);
        exp2(log_sharpness).store(&mut mixture.sharpness[k..]);
        L::select(valid, exp2(log_red), zero).store(&mut mixture.red[k..]);
        L::select(valid, exp2(log_green), zero).store(&mut mixture.green[k..]);
        L::select(valid, exp2(log_blue), zero).store(&mut mixture.blue[k..]);
        k += L::COUNT;
    }
    if header.mirrored > 0 {
        mirror::<L, N>(material, place, mixture);
    }
    mixture.finish::<L>(total, header.squeezed, leave_out);
}

/// Takes the mirrored lobes, the last of the stored ones, off the plane of incidence, and puts their images behind them.
#[inline(always)]
fn mirror<L: Lanes, const N: usize>(material: &Material<'_>, place: Place, mixture: &mut Mixture<N>) {
    let header = &material.header;
    let (count, mirrored) = (header.lobes, header.mirrored);
    let reach = 4 * mirrored.next_multiple_of(L::COUNT);
    let (copy_a, copy_b);
    let a = from_offset!(material.bytes, header.row(place.before, 5), reach, copy_a);
    let b = from_offset!(material.bytes, header.row(place.after, 5), reach, copy_b);
    let (mut sin, mut cos) = ([0.0; MAX_LOBES], [0.0; MAX_LOBES]);
    let mut i = 0;
    while i < mirrored && i + L::COUNT <= MAX_LOBES {
        let (s, c) = sin_cos(place.between::<L>(a, b, i));
        s.store(&mut sin[i..]);
        c.store(&mut cos[i..]);
        i += L::COUNT;
    }
    mixture.in_plane = false;
    let mut i = 0;
    while i < mirrored && count + i < N {
        let (k, image) = (count - mirrored + i, count + i);
        mixture.axis_x[k] *= cos[i];
        mixture.axis_y[k] = sin[i];
        mixture.axis_z[k] *= cos[i];
        mixture.axis_x[image] = mixture.axis_x[k];
        mixture.axis_y[image] = -sin[i];
        mixture.axis_z[image] = mixture.axis_z[k];
        mixture.sharpness[image] = mixture.sharpness[k];
        mixture.red[image] = mixture.red[k];
        mixture.green[image] = mixture.green[k];
        mixture.blue[image] = mixture.blue[k];
        i += 1;
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
