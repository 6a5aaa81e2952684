//! From an anisotropic material and an outgoing direction to a mixture: lanes are lobes.
//!
//! # Interpolated numbers
//! The views lie on rings round the normal, each ring periodic in the azimuth of the outgoing direction. The mixture of a view is
//! written in the frame of the view, +x in the plane of incidence away from `wo`. A highlight stays at one place of it when `wo`
//! turns. Between four views everything is interpolated linearly, in angle and azimuth: the axes as vectors of angles from the
//! normal ([`TiltedLobe`](crate::TiltedLobe)), the logarithms of sharpness, luminance and squeeze, and the colour differences.
//!
//! # The squeeze matrix
//! Isotropic materials are squeezed across the plane of incidence by one number. A brushed surface has a direction of its own. So
//! a direction `d` is seen as `u = (M (d.x, d.y), d.z) / r` with a symmetric matrix M, held as its logarithm: that is a vector
//! space, which interpolation does not leave, in which a turn is linear, and in which no angle wraps. (An axis and a number would
//! have to jump: from the normal, where the axis turns once with every half turn of `wo`, to grazing, where it stays in the plane
//! of incidence.) `dw(u) = det M dw(d) / r^3`. With the eigenvectors as x and y, M is diagonal: the mixture takes them as its
//! frame, and the kernels see two numbers in place of one.
//!
//! A lobe's axis is stored where the lobe points to, before the squeeze, so that a change of M leaves a
//! highlight in its place.
//!
//! # Why it is continuous
//! *Along a ring* the four shares are continuous and periodic. *Across a ring* the share of the views beyond is 0. *At the normal*
//! there is one view, stored in the frame of the surface. In the frame of a view whose +x is at the azimuth a it is turned by -a;
//! turning is linear in tilts and in the logarithm of M, and leaves the rest as it is. Between the normal and the first ring, at
//! the share t of the ring, the mixture is `(1 - t) turned(normal, -a) + t ring(a)`. Turned back by a into the frame of the
//! surface it differs from the normal's by at most `t` times a constant, whatever a is: so it tends to the normal's view from
//! every side, and at the normal itself, where a is any number, it is that view.

use super::outgoing::Outgoing;
use crate::color;
use crate::material::borrowed::MaterialRef;
use crate::material::layout::{GRID_HEAD, GRID_ROWS, Shape, f32_at};
use crate::mixture::factors::Among;
use crate::mixture::leave_out::LeaveOut;
use crate::mixture::row;
use crate::mixture::rows::AnyMixture;
use crate::simd::elementary::{atan2_positive, rare_exp2, sin_cos};
use crate::simd::lanes::Lanes;
use crate::squeeze::Squeeze;
use core::f32::consts::PI;

/// Where an outgoing direction lies among the views.
struct Place {
    /// The ring within, the ring beyond, and the share of the one beyond; ring 0 is the normal.
    rings: [usize; 2],
    outward: f32,
    /// The views before and after along a ring, and the share of the one after.
    along: [usize; 2],
    onward: f32,
}

impl Place {
    #[inline(always)]
    fn new(bytes: &[u8], shape: Shape, thetas: usize, &Outgoing { wo, theta, .. }: &Outgoing) -> Self {
        let (mut within, last) = (0, shape.thetas - 1);
        while within + 1 < last && f32_at(bytes, thetas + 4 * (within + 1)) <= theta {
            within += 1;
        }
        let beyond = (within + 1).min(last);
        let (from, to) = (f32_at(bytes, thetas + 4 * within), f32_at(bytes, thetas + 4 * beyond));
        let outward = if to > from { ((theta - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };

        // At the normal any azimuth serves; that of `Outgoing` is then this one too.
        let mut phi = PI;
        if wo.x * wo.x + wo.y * wo.y >= f32::MIN_POSITIVE {
            let quarter = atan2_positive(wo.y.abs(), wo.x.abs());
            let upper = if wo.x < 0.0 { PI - quarter } else { quarter };
            phi = if wo.y < 0.0 { 2.0 * PI - upper } else { upper };
        }
        let scaled = phi * (shape.turns * shape.azimuths) as f32 * (0.5 / PI);
        let whole = scaled as usize;
        // At least 1 in a checked material: without the bound the compiler adds a panic.
        let azimuths = shape.azimuths.max(1);
        let along = [whole % azimuths, (whole + 1) % azimuths];
        Self { rings: [within, beyond], outward, along, onward: scaled - whole as f32 }
    }

    /// Number of a view: a place along a ring.
    #[inline(always)]
    fn view(&self, shape: Shape, ring: usize, along: usize) -> usize {
        if self.rings[ring] == 0 {
            0
        } else {
            1 + (self.rings[ring] - 1) * shape.azimuths + self.along[along]
        }
    }
}

/// A number of the head between two views of a ring.
#[inline(always)]
fn between(bytes: &[u8], shape: Shape, [a, b]: [usize; 2], onward: f32, i: usize) -> f32 {
    let (a, b) = (f32_at(bytes, shape.head(a) + 4 * i), f32_at(bytes, shape.head(b) + 4 * i));
    a + onward * (b - a)
}

/// Interpolates the lobes round an outgoing direction. The mixture has begun, and is to be summed up.
/// Returns: where the direction lies among the views.
#[cfg_attr(not(feature = "simd"), inline(never))]
#[cfg_attr(feature = "simd", inline(always))]
#[allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices
pub(crate) fn prepare<L: Lanes, const FEW: bool>(
    material: MaterialRef<'_>,
    shape: Shape,
    outgoing: &Outgoing,
    leave_out: LeaveOut,
    mixture: &mut AnyMixture<'_>,
) -> Among {
    let (bytes, header) = (material.bytes, material.header);
    let count = header.lobes;
    mixture.head.in_plane = false;

    let place = Place::new(bytes, shape, header.theta(0), outgoing);
    let [c, s] = outgoing.azimuth;
    let views = [
        [place.view(shape, 0, 0), place.view(shape, 0, 1)],
        [place.view(shape, 1, 0), place.view(shape, 1, 1)],
    ];
    let turned = place.rings[0] == 0;

    // The head: squeeze matrix and diffuse albedo.
    let mut head = [0.0; GRID_HEAD];
    for i in 0..GRID_HEAD {
        head[i] = between(bytes, shape, views[0], place.onward, i);
    }
    if turned {
        let [xx, xy, yy] = [head[0], head[1], head[2]];
        head[0] = c * c * xx + s * s * yy + 2.0 * (c * s) * xy;
        head[1] = (c * s) * (yy - xx) + (c * c - s * s) * xy;
        head[2] = s * s * xx + c * c * yy - 2.0 * (c * s) * xy;
    }
    for i in 0..GRID_HEAD {
        let ring = between(bytes, shape, views[1], place.onward, i);
        head[i] += place.outward * (ring - head[i]);
    }
    mixture.set_diffuse(if header.has_luminance {
        color::rgb(rare_exp2(head[3]), [head[4], head[5]])
    } else {
        [rare_exp2(head[3]), rare_exp2(head[4]), rare_exp2(head[5])]
    });

    // Eigenvectors: the one closer to the plane of incidence is the new x, at an angle of at most 45 degrees.
    let (middle, half, xy) = (0.5 * (head[0] + head[2]), 0.5 * (head[0] - head[2]), head[1]);
    let reach = Lanes::sqrt(half * half + xy * xy);
    let (mut tilt_cos, mut tilt_sin) = (1.0, 0.0);
    // The squares of less have lost their digits.
    if reach > 1e-18 {
        tilt_cos = Lanes::sqrt(0.5 * (1.0 + half.abs() / reach));
        tilt_sin = (if half < 0.0 { -xy } else { xy }) / (2.0 * reach * tilt_cos);
    }
    let reach = if half < 0.0 { -reach } else { reach };
    let (along, inverse) = (rare_exp2(middle + reach), rare_exp2(middle - reach));
    let (x, y) = (c * tilt_cos - s * tilt_sin, s * tilt_cos + c * tilt_sin);
    let shrink = 1.0 / Lanes::sqrt(x * x + y * y);
    mixture.head.squeeze = Squeeze::new([x * shrink, y * shrink], along, inverse);

    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let (onward, outward) = (L::splat(place.onward), L::splat(place.outward));
    row::for_lobes!(FEW, L, &mut mixture.groups, count, |group, at, k| {
        let valid = L::iota().lt(L::splat((count - k) as f32));
        let mut rows = [zero; GRID_ROWS];
        for row in 0..GRID_ROWS {
            let a = load_bytes::<L>(bytes, shape.row(header, views[0][0], row) + 4 * k);
            let b = load_bytes::<L>(bytes, shape.row(header, views[0][1], row) + 4 * k);
            rows[row] = (b - a).mul_add(onward, a);
        }
        if turned {
            let [x, y] = [rows[0], rows[1]];
            rows[0] = x.mul_add(L::splat(c), y * L::splat(s));
            rows[1] = y.mul_add(L::splat(c), zero - x * L::splat(s));
        }
        for row in 0..GRID_ROWS {
            let a = load_bytes::<L>(bytes, shape.row(header, views[1][0], row) + 4 * k);
            let b = load_bytes::<L>(bytes, shape.row(header, views[1][1], row) + 4 * k);
            let ring = (b - a).mul_add(onward, a);
            rows[row] = L::select(valid, (ring - rows[row]).mul_add(outward, rows[row]), zero);
        }

        // The axis, in the frame of the eigenvectors; then as squeezed lobes see it.
        let angle = rows[0].mul_add(rows[0], rows[1] * rows[1]).sqrt();
        let (sin, cos) = sin_cos(angle);
        let scale = sin / angle.max(L::splat(1e-30));
        let (x, y) = (rows[0] * scale, rows[1] * scale);
        let (tilt_cos, tilt_sin) = (L::splat(tilt_cos), L::splat(tilt_sin));
        let (x, y) = (x.mul_add(tilt_cos, y * tilt_sin), y.mul_add(tilt_cos, zero - x * tilt_sin));
        let (wide_x, wide_y) = (x * L::splat(along), y * L::splat(inverse));
        let shrink = one / wide_x.mul_add(wide_x, wide_y.mul_add(wide_y, cos * cos)).sqrt();
        let squeezed = L::iota().lt(L::splat(header.squeezed as f32 - k as f32));
        L::select(squeezed, wide_x * shrink, x).store(&mut group[row::AXIS_X][at..]);
        L::select(squeezed, wide_y * shrink, y).store(&mut group[row::AXIS_Y][at..]);
        L::select(squeezed, cos * shrink, cos).store(&mut group[row::AXIS_Z][at..]);
        rare_exp2(rows[2]).store(&mut group[row::SHARPNESS][at..]);
        let first = rare_exp2(rows[3]).keep(valid);
        let amplitude = if header.has_luminance {
            color::rgb(first, [rows[4], rows[5]])
        } else {
            [first, rare_exp2(rows[4]).keep(valid), rare_exp2(rows[5]).keep(valid)]
        };
        amplitude[0].store(&mut group[row::RED][at..]);
        amplitude[1].store(&mut group[row::GREEN][at..]);
        amplitude[2].store(&mut group[row::BLUE][at..]);
    });
    mixture.finish_lobes::<L, FEW>(count, header.squeezed, leave_out);
    let views = views.map(|ring| ring.map(|view| view as u16));
    Among { views, onward: place.onward, outward: place.outward }
}

/// Loads little-endian f32 from bytes of any alignment; numbers past the end read as 0.
#[inline(always)]
fn load_bytes<L: Lanes>(bytes: &[u8], offset: usize) -> L {
    if L::COUNT == 1 {
        return L::splat(f32_at(bytes, offset));
    }
    let rest = &bytes[offset..];
    if rest.len() >= 4 * L::COUNT {
        return L::load_bytes(rest);
    }
    let mut padded = [0; 64];
    padded[..rest.len()].copy_from_slice(rest);
    L::load_bytes(&padded)
}
