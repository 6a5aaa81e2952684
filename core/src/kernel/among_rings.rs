//! The lobes of anisotropic materials for many outgoing directions, from the rows of their files into groups of sixteen: lanes are
//! directions for the numbers that a mixture has once, lobes for the rest.
//!
//! [`prepare_anisotropic`](super::prepare_anisotropic) has the meaning of the numbers, and the text for one number at a time. Four views are
//! blended by their shares, products of two, so that a number is one chain of four operations. The axis of a lobe follows from the square
//! of its tilt, without a root. Squeezed or not, it is made a unit vector at the end.
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use super::between_views::{Lobes, Place, angles_of_views_passed, colored};
use super::outgoing::{Facing, Outgoing};
use super::streamed::lobes::store_first;
use crate::color;
use crate::material::borrowed::MaterialRef;
use crate::material::codes::Codes;
use crate::material::layout::{AXIS_UNIT, GRID_HEAD, GRID_ROWS, Kind, MAX_LOBES, Shape, f32_at, part};
use crate::mixture::factors::Among;
use crate::mixture::row::{self, Group};
use crate::simd::detect::Level;
use crate::simd::elementary::{atan2_positive, exp2, sin_cos, sinc_cos};
use crate::simd::lanes::{Lanes, Numbers, WIDEST};
use crate::simd::prefetch_lines;
use crate::simd::routine::Routine;
use crate::simd::tables::{FourRows, Shape as TableShape};
use core::f32::consts::{PI, TAU};
use glam::Vec3;

const ZEROS: Numbers = [0.0; WIDEST];

/// The numbers that a mixture has once.
#[derive(Clone, Copy)]
pub(crate) struct Frame {
    /// Cosine and sine, in the caller's frame, of the azimuth of the first eigenvector of the squeeze, and the squeeze along both.
    pub azimuth: [f32; 2],
    pub stretch: [f32; 2],
    /// Albedo of the diffuse term.
    pub diffuse: [f32; 3],
    /// Whether the outgoing direction is a unit vector; and one above the horizon.
    pub is_unit: bool,
    pub is_there: bool,
    /// Where it lies among the views.
    pub among: Among,
    /// Cosine and sine by which tilts at the normal are turned; those from +x of the view to the first eigenvector.
    turn: [f32; 2],
    tilt: [f32; 2],
    /// -1 where the mixture is a mirror image.
    image: f32,
}

impl Frame {
    pub const NONE: Self = Self {
        azimuth: [1.0, 0.0],
        stretch: [1.0; 2],
        diffuse: [0.0; 3],
        is_unit: false,
        is_there: false,
        among: Among::NOWHERE,
        turn: [1.0, 0.0],
        tilt: [1.0, 0.0],
        image: 1.0,
    };

    /// Of one outgoing direction, with its lobes, in room for them.
    #[inline(always)]
    pub fn of_one(material: MaterialRef<'_>, wo: Vec3, level: Level, groups: &mut [Group]) -> Self {
        let mut frame = [Self::NONE];
        let wo: [&[f32]; 3] = [&[wo.x], &[wo.y], &[wo.z]];
        let (materials, groups) = (&[material], &mut core::iter::once(groups));
        level.run_vectors(FillRings { materials, wo, frames: &mut frame, groups });
        frame[0]
    }

    /// An outgoing direction, as it has it.
    #[inline(always)]
    pub fn outgoing(&self, wo: Vec3) -> Outgoing {
        Outgoing { wo, theta: 0.0, azimuth: self.azimuth }
    }
}

/// Fills lobes and frames of at most [`WIDEST`] outgoing directions, each of a material of its own; isotropic ones are left out. A vector that
/// is no direction has the lobes of some.
pub(crate) struct FillRings<'a, 'm, 'g> {
    pub materials: &'a [MaterialRef<'m>],
    /// Directions: one, or as many numbers as a vector loads.
    pub wo: [&'a [f32]; 3],
    pub frames: &'a mut [Frame],
    /// Room for the lobes of each.
    pub groups: &'a mut dyn Iterator<Item = &'g mut [Group]>,
}

impl Routine for FillRings<'_, '_, '_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { materials, wo, frames, groups } = self;
        // One direction in single numbers, with the fused operations if the level has them: a vector would wait for numbers that were
        // stored one by one.
        if let ([material], [frame]) = (materials, &mut *frames) {
            frames_of::<L::One, L>(&[*material], wo, core::array::from_mut(frame));
        } else {
            frames_of::<L, L>(materials, wo, frames);
        }
        let (mut few, mut all) = (None, None);
        // The iterator is asked by a call: once a direction.
        for i in 0..materials.len().min(frames.len()) {
            let (Some(groups), material, frame) = (groups.next(), materials[i], &frames[i]) else { break };
            let Kind::Grid(shape) = material.header.kind else { continue };
            let rows = Rows {
                rows: four_views::<L::Lobes>(
                    material,
                    shape,
                    frame.among,
                    groups.len() == 1,
                    &mut few,
                    &mut all,
                ),
                shares: shares(frame.among),
                frame,
                count: material.header.lobes,
                squeezed: material.header.squeezed,
                has_luminance: material.header.has_luminance,
            };
            row::for_lobes!(false, L::Lobes, groups.iter_mut(), rows.count, |group, at, k| {
                let lobes = rows.lobes::<L::Lobes>(k);
                store_first(&lobes, group, at);
                lobes.sharpness.store(&mut group[row::SHARPNESS][at..]);
            });
        }
    }
}

/// The shares of four views: within before and after, beyond before and after.
#[inline(always)]
fn shares(Among { onward, outward, .. }: Among) -> [f32; 4] {
    let (within, before) = (1.0 - outward, 1.0 - onward);
    [within * before, within * onward, outward * before, outward * onward]
}

/// The frames of some outgoing directions, in lanes of `H`; lanes of `L` are angles of views.
#[inline(always)]
fn frames_of<H: Lanes, L: Lanes>(materials: &[MaterialRef<'_>], wo: [&[f32]; 3], frames: &mut [Frame]) {
    let count = materials.len().min(frames.len()).min(WIDEST);
    let turned = Turned::new::<H>(materials, count, wo, frames);
    let mut numbers = [ZEROS; GRID_HEAD];
    for i in 0..count {
        let (material, frame) = (materials[i], &mut frames[i]);
        let Kind::Grid(shape) = material.header.kind else { continue };
        frame.among = turned.among::<L>(i, material, shape);
        let turn = [turned.c[i], turned.s[i]];
        let views = frame.among.views;
        if material.header.codes.is_none() && H::COUNT > 1 {
            for ring in views {
                prefetch_lines::<8>(material.bytes, shape.row(material.header, usize::from(ring[0]), 0));
            }
        }
        frame.turn = if views[0][1] == 0 { turn } else { [1.0, 0.0] };
        frame.image = turned.image[i];
        let head = head::<H::One>(material, shape, frame.among, turn);
        for n in 0..GRID_HEAD {
            numbers[n][i] = head[n];
        }
    }
    let (mut tilt, mut stretch, mut azimuth, mut diffuse) = ([ZEROS; 2], [ZEROS; 2], [ZEROS; 2], [ZEROS; 3]);
    let (zero, one, half) = (H::splat(0.0), H::splat(1.0), H::splat(0.5));
    let mut at = 0;
    while at < count && at + H::COUNT <= WIDEST {
        // Eigenvectors: the one closer to the plane of incidence is the new x, at an angle of at most 45 degrees.
        let (xx, yy) = (H::load(&numbers[0][at..]), H::load(&numbers[2][at..]));
        let xy = H::load(&numbers[1][at..]) * H::load(&turned.image[at..]);
        let (middle, off) = (half * (xx + yy), half * (xx - yy));
        let reach = off.mul_add(off, xy * xy).sqrt();
        // The squares of less have lost their digits.
        let is_squeezed = reach.ge(H::splat(1e-18));
        let inverse = one / H::select(is_squeezed, reach, one);
        let cos = H::select(is_squeezed, (off.abs() * inverse).mul_add(half, half).sqrt(), one);
        let sin = ((xy * one.copy_sign(off)) * (inverse * half) / cos).keep(is_squeezed);
        cos.store(&mut tilt[0][at..]);
        sin.store(&mut tilt[1][at..]);
        let reach = reach.copy_sign(off);
        exp2(middle + reach).store(&mut stretch[0][at..]);
        exp2(middle - reach).store(&mut stretch[1][at..]);
        let (x, y) = (H::load(&turned.azimuth[0][at..]), H::load(&turned.azimuth[1][at..]));
        let (x, y) = (x.mul_add(cos, zero - y * sin), y.mul_add(cos, x * sin));
        // A product of unit vectors, but for rounding: a step of Newton's.
        let shrink = x.mul_add(x, y * y).neg_mul_add(half, H::splat(1.5));
        (x * shrink).store(&mut azimuth[0][at..]);
        (y * shrink).store(&mut azimuth[1][at..]);
        let differences = [H::load(&numbers[4][at..]), H::load(&numbers[5][at..])];
        let color = color::rgb(exp2(H::load(&numbers[3][at..])), differences);
        for channel in 0..3 {
            color[channel].store(&mut diffuse[channel][at..]);
        }
        at += H::COUNT;
    }
    for i in 0..count {
        // Red, green and blue are logarithms in files of version 1.
        if !materials[i].header.has_luminance {
            for channel in 0..3 {
                diffuse[channel][i] = exp2(H::One::splat(numbers[3 + channel][i])).first();
            }
        }
        let frame = &mut frames[i];
        frame.tilt = [tilt[0][i], tilt[1][i]];
        frame.stretch = [stretch[0][i], stretch[1][i]];
        frame.azimuth = [azimuth[0][i], azimuth[1][i]];
        frame.diffuse = [diffuse[0][i], diffuse[1][i], diffuse[2][i]];
    }
}

/// A vector in a frame that is turned by an angle of such a cosine and sine.
#[inline(always)]
fn turned_by<L: Lanes>([x, y]: [L; 2], [cos, sin]: [L; 2]) -> [L; 2] {
    [x.mul_add(cos, y * sin), x.neg_mul_add(sin, y * cos)]
}

/// Outgoing directions in the frames of the axes of materials; of their images in the first quarter, where there are mirrors.
struct Turned {
    /// Cosine and sine, in the caller's frame, of the azimuth of +x of the view.
    azimuth: [Numbers; 2],
    /// Angles from the normal.
    theta: Numbers,
    /// Cosine and sine of that azimuth from the axis.
    c: Numbers,
    s: Numbers,
    /// -1 where the mixture is a mirror image.
    image: Numbers,
    /// Azimuths in steps from view to view.
    along: Numbers,
}

impl Turned {
    #[inline(always)]
    fn new<L: Lanes>(
        materials: &[MaterialRef<'_>],
        count: usize,
        wo: [&[f32]; 3],
        frames: &mut [Frame],
    ) -> Self {
        let (mut axis, mut steps, mut mirrored) = (ZEROS, ZEROS, ZEROS);
        for i in 0..count {
            if let Kind::Grid(shape) = materials[i].header.kind {
                axis[i] = f32::from(shape.axis) * AXIS_UNIT;
                steps[i] = shape.steps() as u32 as f32 * (1.0 / TAU);
                mirrored[i] = if shape.is_mirrored() { 1.0 } else { 0.0 };
            }
        }
        let mut to =
            Self { azimuth: [ZEROS; 2], theta: ZEROS, c: ZEROS, s: ZEROS, image: ZEROS, along: ZEROS };
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let mut at = 0;
        while at < count && at + L::COUNT <= WIDEST {
            let facing =
                Facing::<L>::new([L::load(&wo[0][at..]), L::load(&wo[1][at..]), L::load(&wo[2][at..])]);
            let there = facing.is_there();
            let (units, theres) = (L::bits(facing.is_unit()), L::bits(there));
            for i in 0..L::COUNT.min(count - at) {
                frames[at + i].is_unit = units >> i & 1 == 1;
                frames[at + i].is_there = theres >> i & 1 == 1;
            }
            for n in 0..2 {
                facing.azimuth[n].store(&mut to.azimuth[n][at..]);
            }
            let (sin, cos) = sin_cos(L::load(&axis[at..]));
            let mirrors = L::load(&mirrored[at..]).ge(L::splat(0.5));
            let [c, s] = turned_by(facing.azimuth, [cos, sin]);
            L::select(mirrors, one.copy_sign(c * s), one).store(&mut to.image[at..]);
            L::select(mirrors, zero - c.abs(), c).store(&mut to.c[at..]);
            L::select(mirrors, zero - s.abs(), s).store(&mut to.s[at..]);
            // The azimuth does not wait for the length.
            let [c, s] = turned_by(facing.away, [cos, sin]);
            let (c, s) = (L::select(mirrors, zero - c.abs(), c), L::select(mirrors, zero - s.abs(), s));
            // +x of the view points away from the outgoing direction.
            let quarter = atan2_positive(s.abs(), c.abs());
            let upper = L::select(zero.lt(c), L::splat(PI) - quarter, quarter);
            let azimuth = L::select(zero.lt(s), L::splat(TAU) - upper, upper);
            facing.theta.keep(there).store(&mut to.theta[at..]);
            (azimuth * L::load(&steps[at..])).keep(there).store(&mut to.along[at..]);
            at += L::COUNT;
        }
        to
    }

    /// Where a direction lies among the views of its material.
    #[inline(always)]
    fn among<L: Lanes>(&self, i: usize, material: MaterialRef<'_>, shape: Shape) -> Among {
        let theta = self.theta[i];
        let passed = angles_of_views_passed::<L>(material, shape.thetas - 1, theta);
        let rings = Place::among_angles(material, shape.thetas, passed, theta);
        let mut before = self.along[i] as u32 as usize;
        let onward = self.along[i] - before as u32 as f32;
        let after = if shape.is_mirrored() {
            before = before.min(shape.azimuths - 1);
            (before + 1).min(shape.azimuths - 1)
        } else {
            // Of two turns at most; and a full turn, to which an azimuth may be rounded.
            while before >= shape.azimuths && shape.azimuths > 0 {
                before -= shape.azimuths;
            }
            if before + 1 == shape.azimuths { 0 } else { before + 1 }
        };
        let mut views = [[0; 2]; 2];
        for (views, ring) in views.iter_mut().zip(rings.views()) {
            if ring > 0 {
                let first = 1 + (ring - 1) * shape.azimuths;
                *views = [(first + before) as u16, (first + after) as u16];
            }
        }
        Among { views, onward, outward: rings.blend() }
    }
}

/// The numbers of the heads of four views, blended; that of the normal turned into the frame of the view, whose +x has such an azimuth.
#[inline(always)]
fn head<L: Lanes>(
    material: MaterialRef<'_>,
    shape: Shape,
    among: Among,
    [c, s]: [f32; 2],
) -> [f32; GRID_HEAD] {
    let MaterialRef { bytes, header } = material;
    let views = among.views.map(|ring| ring.map(usize::from));
    let mut heads = [[0.0; GRID_HEAD]; 4];
    if let Some(codes) = header.codes.map(Codes::of_grid) {
        let counts = header.grid_counts(shape);
        [heads[0], heads[1]] = codes.two_heads(counts, bytes, views[0]);
        [heads[2], heads[3]] = codes.two_heads(counts, bytes, views[1]);
    } else {
        for ring in 0..2 {
            for i in 0..2 {
                let from = shape.head(views[ring][i]);
                let bytes = part(bytes, from..from + 4 * GRID_HEAD);
                for n in 0..GRID_HEAD {
                    heads[2 * ring + i][n] = f32_at(bytes, 4 * n);
                }
            }
        }
    }
    let shares = shares(among);
    let mut sums = [[0.0; GRID_HEAD]; 2];
    for ring in 0..2 {
        let (a, b) = (L::splat(shares[2 * ring]), L::splat(shares[2 * ring + 1]));
        for n in 0..GRID_HEAD {
            let [first, second] = [L::splat(heads[2 * ring][n]), L::splat(heads[2 * ring + 1][n])];
            sums[ring][n] = second.mul_add(b, first * a).first();
        }
    }
    let [mut within, beyond] = sums;
    if views[0][1] == 0 {
        let [xx, xy, yy] = [within[0], within[1], within[2]];
        within[0] = c * c * xx + s * s * yy + 2.0 * (c * s) * xy;
        within[1] = (c * s) * (yy - xx) + (c * c - s * s) * xy;
        within[2] = s * s * xx + c * c * yy - 2.0 * (c * s) * xy;
    }
    for n in 0..GRID_HEAD {
        within[n] += beyond[n];
    }
    within
}

/// Room for the lobes of four views, and for the numbers that a vector reaches beyond.
type Numbers4<const LOBES: usize> = [[[f32; LOBES]; GRID_ROWS + 1]; 4];

/// The numbers of the lobes of four views: in the file; or in room, where they are decoded, or copied near the end of the file, which
/// vectors reach beyond. `is_few`: they are of one group.
#[inline(always)]
fn four_views<'a, L: Lanes>(
    material: MaterialRef<'a>,
    shape: Shape,
    among: Among,
    is_few: bool,
    few: &'a mut Option<Numbers4<WIDEST>>,
    all: &'a mut Option<Numbers4<MAX_LOBES>>,
) -> FourRows<'a> {
    let MaterialRef { bytes, header } = material;
    let width = header.lobes.next_multiple_of(L::COUNT);
    let of_table = TableShape { ahead: 0, stride: header.lobes, width };
    let views = among.views.map(|ring| ring.map(usize::from));
    let from = [views[0][0], views[0][1], views[1][0], views[1][1]].map(|view| shape.row(header, view, 0));
    if header.codes.is_none() {
        let ([i, j, k, l], need) = (from, of_table.bytes(GRID_ROWS));
        if i.max(j).max(k.max(l)) + need <= bytes.len() {
            return FourRows::new([&bytes[i..], &bytes[j..], &bytes[k..], &bytes[l..]], of_table);
        }
    }
    // Not cleared before it is asked for.
    let mut room = if is_few {
        few.get_or_insert([[[0.0; WIDEST]; GRID_ROWS + 1]; 4]).each_mut().map(|view| view.as_flattened_mut())
    } else {
        all.get_or_insert([[[0.0; MAX_LOBES]; GRID_ROWS + 1]; 4])
            .each_mut()
            .map(|view| view.as_flattened_mut())
    };
    if let Some(codes) = header.codes.map(Codes::of_grid) {
        let (counts, len) = (header.grid_counts(shape), GRID_ROWS * header.lobes);
        let mut left = room.iter_mut().map(|numbers| &mut numbers[..len]);
        for ring in views {
            if let (Some(a), Some(b)) = (left.next(), left.next()) {
                codes.two_views(counts, bytes, ring).all(0, [a, b]);
            }
        }
        if cfg!(target_endian = "big") {
            for number in room.iter_mut().flat_map(|numbers| numbers.iter_mut()) {
                *number = f32::from_bits(number.to_bits().to_le());
            }
        }
    } else {
        copied(bytes, from, 4 * GRID_ROWS * header.lobes, &mut room);
    }
    FourRows::new(room.map(|numbers| bytemuck::cast_slice(numbers)), of_table)
}

/// Copies the numbers of views.
#[cold]
#[inline(never)]
fn copied(bytes: &[u8], from: [usize; 4], len: usize, to: &mut [&mut [f32]; 4]) {
    for (to, from) in to.iter_mut().zip(from) {
        bytemuck::cast_slice_mut(to)[..len].copy_from_slice(&bytes[from..from + len]);
    }
}

/// The lobes of one outgoing direction.
struct Rows<'a> {
    rows: FourRows<'a>,
    shares: [f32; 4],
    frame: &'a Frame,
    count: usize,
    squeezed: usize,
    has_luminance: bool,
}

impl Rows<'_> {
    /// The lobes from the `k`-th on.
    #[inline(always)]
    fn lobes<L: Lanes>(&self, k: usize) -> Lobes<L> {
        let one = L::splat(1.0);
        let valid = L::first_lanes((self.count - k).min(L::COUNT));
        // The tilt, of the view; then in the frame of the eigenvectors.
        let ([x, beyond_x], [y, beyond_y]) = (self.rings::<L>(0, k), self.rings::<L>(1, k));
        let Frame { turn, tilt: [tilt_cos, tilt_sin], image, stretch, .. } = *self.frame;
        let (c, s) = (L::splat(turn[0]), L::splat(turn[1]));
        let (x, y) = (x.mul_add(c, y.mul_add(s, beyond_x)), y.mul_add(c, x.neg_mul_add(s, beyond_y)));
        let (x, y) = (x.keep(valid), y.keep(valid));
        let (sinc, cos) = sinc_cos(x.mul_add(x, y * y));
        let image = (L::splat(image * tilt_cos), L::splat(image * tilt_sin));
        let (x, y) = (
            x.mul_add(L::splat(tilt_cos), y * image.1) * sinc,
            x.neg_mul_add(L::splat(tilt_sin), y * image.0) * sinc,
        );
        let is_squeezed = L::first_lanes(self.squeezed.saturating_sub(k).min(L::COUNT));
        let x = x * L::select(is_squeezed, L::splat(stretch[0]), one);
        let y = y * L::select(is_squeezed, L::splat(stretch[1]), one);
        let shrink = one / x.mul_add(x, y.mul_add(y, cos * cos)).sqrt();
        let sharpness = exp2(self.number::<L>(2, k).keep(valid));
        let first = exp2(L::select(valid, self.number(3, k), L::splat(-126.0)));
        let others = [self.number(4, k), self.number(5, k)];
        let (rgb, luminance) = colored(first, others, valid, self.has_luminance);
        Lobes { axis: [x * shrink, y * shrink, cos * shrink], sharpness, rgb, luminance }
    }

    /// Numbers of a row, times the shares of the views within, and of those beyond.
    #[inline(always)]
    fn rings<L: Lanes>(&self, row: usize, k: usize) -> [L; 2] {
        let [a, b, c, d]: [L; 4] = self.rows.load(row, 0, k);
        let [of_a, of_b, of_c, of_d] = self.shares;
        [b.mul_add(L::splat(of_b), a * L::splat(of_a)), d.mul_add(L::splat(of_d), c * L::splat(of_c))]
    }

    /// Numbers of a row.
    #[inline(always)]
    fn number<L: Lanes>(&self, row: usize, k: usize) -> L {
        let [a, b, c, d]: [L; 4] = self.rows.load(row, 0, k);
        let [of_a, of_b, of_c, of_d] = self.shares;
        let within = b.mul_add(L::splat(of_b), a * L::splat(of_a));
        d.mul_add(L::splat(of_d), c.mul_add(L::splat(of_c), within))
    }
}
