//! From an anisotropic material and an outgoing direction to a mixture: the meaning of the numbers, and the text for one number at a time. With
//! vectors `among_rings.rs` has it.
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
//!
//! # Mirrors
//! Where mirrors change nothing, views stand over a quarter of the turn. An outgoing direction elsewhere has the numbers of its image in
//! that quarter. In the second and the fourth quarter they are mirrored in the plane of incidence: tilts across it and the mixed
//! number of the squeeze have the other sign. *At the planes of the mirrors* it is continuous where the lobes there are their own
//! images, or those of each other.

use super::outgoing::Outgoing;
use crate::color;
use crate::material::borrowed::MaterialRef;
use crate::material::codes::Codes;
use crate::material::codes::TwoViews;
use crate::material::layout::{AXIS_UNIT, GRID_HEAD, GRID_ROWS, Header, Shape, f32_at};
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
    fn new(bytes: &[u8], header: &Header, shape: Shape, theta: f32, [x, y]: [f32; 2]) -> Self {
        let (mut within, last) = (0, shape.thetas - 1);
        while within + 1 < last && header.angle(bytes, within + 1) <= theta {
            within += 1;
        }
        let beyond = (within + 1).min(last);
        let (from, to) = (header.angle(bytes, within), header.angle(bytes, beyond));
        let outward = if to > from { ((theta - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };

        // Not both are 0.
        let quarter = atan2_positive(y.abs(), x.abs());
        let upper = if x < 0.0 { PI - quarter } else { quarter };
        let phi = if y < 0.0 { 2.0 * PI - upper } else { upper };
        let scaled = phi * shape.steps() as f32 * (0.5 / PI);
        let whole = scaled as usize;
        // At least 1 in a checked material: without the bound the compiler adds a panic.
        let azimuths = shape.azimuths.max(1);
        let along = if shape.is_mirrored() {
            [whole.min(azimuths - 1), (whole + 1).min(azimuths - 1)]
        } else {
            [whole % azimuths, (whole + 1) % azimuths]
        };
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

/// The numbers of a ring's head between two views.
#[inline(always)]
fn head_between(
    material: MaterialRef<'_>,
    shape: Shape,
    codes: Option<Codes<true>>,
    views: [usize; 2],
    onward: f32,
) -> [f32; GRID_HEAD] {
    let MaterialRef { bytes, header } = material;
    let [mut a, mut b] = [[0.0; GRID_HEAD]; 2];
    if let Some(codes) = codes {
        [a, b] = codes.two_heads(header.grid_counts(shape), bytes, views);
    } else {
        for i in 0..GRID_HEAD {
            a[i] = f32_at(bytes, shape.head(views[0]) + 4 * i);
            b[i] = f32_at(bytes, shape.head(views[1]) + 4 * i);
        }
    }
    for i in 0..GRID_HEAD {
        a[i] += onward * (b[i] - a[i]);
    }
    a
}

/// Where the numbers of the lobes of four views stand.
struct Stored<'a> {
    bytes: &'a [u8],
    /// Byte offset of the first number of each.
    at: [[usize; 2]; 2],
    lobes: usize,
    /// Codes that are read one by one.
    codes: Option<[TwoViews<'a, true>; 2]>,
}

impl Stored<'_> {
    /// Numbers of lobes from the k-th on, between the two views of a ring.
    #[inline(always)]
    fn between<L: Lanes>(&self, ring: usize, row: usize, k: usize, onward: L) -> L {
        if let Some(codes) = &self.codes {
            let [a, b] = codes[ring].numbers(row, k).map(L::splat);
            return (b - a).mul_add(onward, a);
        }
        let offset = 4 * (row * self.lobes + k);
        let [a, b] = self.at[ring].map(|at| L::splat(f32_at(self.bytes, at + offset)));
        (b - a).mul_add(onward, a)
    }
}

/// The part of a mixture that no lobe changes.
struct Frame {
    place: Place,
    views: [[usize; 2]; 2],
    /// Cosine and sine of the azimuth of +x of the view from the axis, of the image in the first quarter where there are mirrors.
    along: [f32; 2],
    /// -1 where the mixture is the mirror image of that one.
    image: f32,
    /// Cosine and sine from +x of the view to the frame of the eigenvectors, and the squeeze along both.
    tilt: [f32; 2],
    squeeze: [f32; 2],
}

/// Interpolates the heads of the views round an outgoing direction. One text for all instruction sets: it has no vectors.
#[inline(never)]
fn framed(
    material: MaterialRef<'_>,
    shape: Shape,
    codes: Option<Codes<true>>,
    outgoing: &Outgoing,
    mixture: &mut AnyMixture<'_>,
) -> Frame {
    let MaterialRef { bytes, header } = material;
    // Along the axis, and in the first quarter if the others are its images: +x of the view points away from the outgoing direction.
    let [mut c, mut s] = outgoing.azimuth;
    let mut image = 1.0;
    if shape.axis != 0 {
        let (sin, cos) = sin_cos(f32::from(shape.axis) * AXIS_UNIT);
        (c, s) = (c * cos + s * sin, s * cos - c * sin);
    }
    if shape.is_mirrored() {
        image = if (c < 0.0) == (s < 0.0) { 1.0 } else { -1.0 };
        (c, s) = (-c.abs(), -s.abs());
    }
    let place = Place::new(bytes, header, shape, outgoing.theta, [-c, -s]);
    let views = [
        [place.view(shape, 0, 0), place.view(shape, 0, 1)],
        [place.view(shape, 1, 0), place.view(shape, 1, 1)],
    ];

    // The squeeze matrix and the diffuse albedo.
    let mut head = head_between(material, shape, codes, views[0], place.onward);
    if place.rings[0] == 0 {
        let [xx, xy, yy] = [head[0], head[1], head[2]];
        head[0] = c * c * xx + s * s * yy + 2.0 * (c * s) * xy;
        head[1] = (c * s) * (yy - xx) + (c * c - s * s) * xy;
        head[2] = s * s * xx + c * c * yy - 2.0 * (c * s) * xy;
    }
    let ring = head_between(material, shape, codes, views[1], place.onward);
    for (head, ring) in head.iter_mut().zip(ring) {
        *head += place.outward * (ring - *head);
    }
    head[1] *= image;
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
    let squeeze = [rare_exp2(middle + reach), rare_exp2(middle - reach)];
    let [x, y] = outgoing.azimuth;
    let (x, y) = (x * tilt_cos - y * tilt_sin, y * tilt_cos + x * tilt_sin);
    let shrink = 1.0 / Lanes::sqrt(x * x + y * y);
    mixture.head.squeeze = Squeeze::new([x * shrink, y * shrink], squeeze[0], squeeze[1]);
    Frame { place, views, along: [c, s], image, tilt: [tilt_cos, tilt_sin], squeeze }
}

/// Interpolates the lobes round an outgoing direction, one after the other. The mixture has begun, and is to be summed up.
/// Returns: where the direction lies among the views.
#[cfg_attr(not(feature = "simd"), inline(never))]
#[cfg_attr(feature = "simd", inline(always))]
#[allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices
pub(crate) fn prepare<L: Lanes>(
    material: MaterialRef<'_>,
    shape: Shape,
    outgoing: &Outgoing,
    leave_out: LeaveOut,
    mixture: &mut AnyMixture<'_>,
) -> Among {
    let (bytes, header) = (material.bytes, material.header);
    let count = header.lobes;
    mixture.head.in_plane = false;
    let codes = header.codes.map(Codes::of_grid);
    let Frame { place, views, along: [c, s], image, tilt: [tilt_cos, tilt_sin], squeeze: [along, inverse] } =
        framed(material, shape, codes, outgoing, mixture);
    let turned = place.rings[0] == 0;

    let stored = Stored {
        bytes,
        at: views.map(|ring| ring.map(|view| shape.row(header, view, 0))),
        lobes: count,
        codes: codes.map(|codes| views.map(|ring| codes.two_views(header.grid_counts(shape), bytes, ring))),
    };
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let (onward, outward) = (L::splat(place.onward), L::splat(place.outward));
    row::for_lobes!(false, L, &mut mixture.groups, count, |group, at, k| {
        let valid = L::iota().lt(L::splat((count - k) as f32));
        let mut rows = [zero; GRID_ROWS];
        for row in 0..GRID_ROWS {
            rows[row] = stored.between(0, row, k, onward);
        }
        if turned {
            let [x, y] = [rows[0], rows[1]];
            rows[0] = x.mul_add(L::splat(c), y * L::splat(s));
            rows[1] = y.mul_add(L::splat(c), zero - x * L::splat(s));
        }
        for row in 0..GRID_ROWS {
            let ring = stored.between(1, row, k, onward);
            rows[row] = L::select(valid, (ring - rows[row]).mul_add(outward, rows[row]), zero);
        }

        rows[1] = rows[1] * L::splat(image);
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
    mixture.finish_lobes::<L, false>(count, header.squeezed, leave_out);
    let views = views.map(|ring| ring.map(|view| view as u16));
    Among { views, onward: place.onward, outward: place.outward }
}
