//! The lobes of an isotropic material between two views: lanes are lobes.

use super::one_lobe::{self, Between, LEAST_OFF_PLANE, OneLobe, OneRows};
use crate::color::{self, LUMINANCE};
use crate::material::borrowed::MaterialRef;
use crate::material::codes::angles_passed;
#[cfg(feature = "simd")]
use crate::material::layout::f32_at;
use crate::material::layout::{HEAD, Header, MAX_LOBES};
use crate::mixture::factors::Among;
use crate::mixture::leave_out::LeaveOut;
use crate::mixture::row;
use crate::mixture::rows::AnyMixture;
use crate::simd::elementary::{exp2, exp2_soon, sin_cos};
use crate::simd::lanes::{Lanes, WIDEST, WIDEST_PAIR, dot3, halves, of_halves, splat3};
#[cfg(feature = "simd")]
use crate::simd::prefetch_lines;
use crate::simd::tables::{ROWS, TwoRows};
use crate::squeeze::Squeeze;

/// The bytes from `ahead` before an offset on, at least `need` of them: near either end of the file those of
/// `copy`, `len` bytes, which is then made.
macro_rules! from_offset {
    ($bytes:expr, $offset:expr, $ahead:expr, $need:expr, $copy:ident, $len:expr) => {{
        let (bytes, offset, ahead): (&[u8], usize, usize) = ($bytes, $offset, $ahead);
        if offset >= ahead && bytes.len() - (offset - ahead) >= $need {
            &bytes[offset - ahead..]
        } else {
            $copy = $crate::kernel::between_views::padded::<$len>(bytes, offset, ahead, $need);
            &$copy[..]
        }
    }};
}

pub(crate) use from_offset;

/// The [`Rows`] round a place; the copies as in `from_offset`. `$room`: where codes are decoded, two slices.
macro_rules! rows_at {
    ($L:ty, $material:expr, $place:expr, $copy_a:ident, $copy_b:ident, $room:expr) => {{
        use $crate::kernel::between_views as rows_of;
        use $crate::simd::tables::{ROWS, Shape, TwoRows};
        let (material, place): ($crate::material::borrowed::MaterialRef<'_>, _) = ($material, $place);
        let header = material.header;
        let (count, mirrored) = (header.lobes, header.mirrored);
        // From as many numbers before the view as there are images, which lie so much before their own places.
        // The last vector reaches past the view, and at the last view past the file.
        let width = (count + mirrored).next_multiple_of(<$L as $crate::simd::lanes::Lanes>::COUNT);
        let shape = Shape { ahead: mirrored, stride: count, width };
        let has_luminance = header.has_luminance;
        let views = if header.codes.is_some() {
            let [a, b]: [&mut [f32]; 2] = $room;
            rows_of::decode(material, place, [a, b]);
            TwoRows::new([bytemuck::cast_slice(a), bytemuck::cast_slice(b)], shape)
        } else {
            let ([a, b], need) = (place.rows(header), shape.bytes(ROWS));
            let a = rows_of::from_offset!(material.bytes, a, 4 * mirrored, need, $copy_a, { rows_of::PADDED });
            let b = rows_of::from_offset!(material.bytes, b, 4 * mirrored, need, $copy_b, { rows_of::PADDED });
            TwoRows::new([a, b], shape)
        };
        rows_of::Rows { views, blend: place.blend(), count, mirrored, has_luminance }
    }};
}

/// Room for two views, which is not cleared before it is asked for: of one group of lobes, which is `$few`, or of all.
macro_rules! room_for {
    ($few:expr, $little:ident, $all:ident) => {{
        use $crate::kernel::between_views as rows_of;
        if $few {
            $little.get_or_insert(rows_of::FEW_DECODED).each_mut().map(|numbers| &mut numbers[..])
        } else {
            $all.get_or_insert(rows_of::NOT_DECODED).each_mut().map(|numbers| &mut numbers[..])
        }
    }};
}

#[cfg(feature = "simd")]
pub(crate) use {room_for, rows_at};

/// The two views round an outgoing direction, and how far between them it lies.
#[derive(Clone, Copy)]
pub(crate) struct Place {
    before: usize,
    after: usize,
    blend: f32,
}

impl Place {
    #[cfg(feature = "simd")]
    pub const NOWHERE: Self = Self { before: 0, after: 0, blend: 0.0 };

    /// Of an angle from the normal; `passed` views have one of at most that.
    #[inline(always)]
    pub fn after(material: MaterialRef<'_>, passed: usize, theta: f32) -> Self {
        Self::among_angles(material, material.header.views, passed, theta)
    }

    /// The same among a number of angles: views, or rings of views.
    #[inline(always)]
    pub fn among_angles(material: MaterialRef<'_>, angles: usize, passed: usize, theta: f32) -> Self {
        let (bytes, header) = (material.bytes, material.header);
        let after = passed.min(angles - 1);
        let before = after.saturating_sub(1);
        let (from, to) = (header.angle(bytes, before), header.angle(bytes, after));
        let blend = if to > from { ((theta - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
        Self { before, after, blend }
    }

    /// The same for numbers that are linear among four views.
    #[inline(always)]
    pub fn among(self) -> Among {
        let views = [[self.before as u16, self.after as u16]; 2];
        Among { views, onward: self.blend, outward: 0.0 }
    }

    /// The two views.
    #[inline(always)]
    pub fn views(self) -> [usize; 2] {
        [self.before, self.after]
    }

    /// Asks for the lobes of the two views, of which the second follows the first: those of twelve lobes are seven or eight cache lines.
    #[cfg(feature = "simd")]
    #[inline(always)]
    pub fn prefetch(self, material: MaterialRef<'_>) {
        if material.header.codes.is_none() {
            prefetch_lines::<8>(material.bytes, material.header.row(self.before, 0));
        }
    }

    /// The share of the second view.
    #[inline(always)]
    pub fn blend(self) -> f32 {
        self.blend
    }

    /// The two views, and the share of the second.
    #[inline(always)]
    pub fn between_views(self) -> Between {
        Between { views: self.views(), blend: self.blend }
    }

    /// Byte offsets of the rows of the two views.
    #[inline(always)]
    pub fn rows(self, header: &Header) -> [usize; 2] {
        [header.row(self.before, 0), header.row(self.after, 0)]
    }

    /// The angle of a stored lobe's axis from the normal, within the plane of incidence.
    pub fn lobe_angle(self, material: MaterialRef<'_>, lobe: usize) -> f32 {
        let (bytes, header) = (material.bytes, material.header);
        let [a, b] = self.views().map(|view| header.number(bytes, view, 0, lobe));
        (b - a).mul_add(self.blend, a)
    }

    /// Interpolates numbers from the `i`-th on; `a` and `b` are the bytes of the same rows of the two views.
    #[inline(always)]
    fn between<L: Lanes>(self, a: &[u8], b: &[u8], i: usize) -> L {
        let (a, b) = (L::load_bytes(&a[4 * i..]), L::load_bytes(&b[4 * i..]));
        (b - a).mul_add(L::splat(self.blend), a)
    }
}

/// How many views but the last have an angle of at most `theta`; the first always has. Lanes are views.
#[inline(always)]
pub(crate) fn views_passed<L: Lanes>(material: MaterialRef<'_>, theta: f32) -> usize {
    if L::COUNT == 1 {
        return one_lobe::views_passed(material, theta);
    }
    angles_of_views_passed::<L>(material, material.header.views - 1, theta)
}

/// How many of the angles before the `last` are at most `theta`; the first always is.
#[inline(always)]
pub(crate) fn angles_of_views_passed<L: Lanes>(material: MaterialRef<'_>, last: usize, theta: f32) -> usize {
    if material.header.codes.is_some() {
        return angles_passed(material.bytes, last, theta);
    }
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

/// The same for many angles: lanes are angles.
#[inline(always)]
pub(crate) fn views_passed_by_each<L: Lanes>(material: MaterialRef<'_>, theta: L) -> L {
    let mut passed = L::splat(0.0);
    for view in 0..material.header.views - 1 {
        let at_view = L::splat(material.header.angle(material.bytes, view));
        passed = passed + L::select(theta.ge(at_view), L::splat(1.0), L::splat(0.0));
    }
    passed
}

/// Interpolates the views round a place. The mixture has begun, and is to be summed up. `FEW`: it has one group of lobes.
#[cfg_attr(not(feature = "simd"), inline(never))]
#[cfg_attr(feature = "simd", inline(always))]
pub(crate) fn at_place<L: Lanes, const FEW: bool>(
    material: MaterialRef<'_>,
    azimuth: [f32; 2],
    place: Place,
    leave_out: LeaveOut,
    mixture: &mut AnyMixture<'_>,
) {
    let (squeeze, diffuse) = head_at::<L>(material, place);
    mixture.head.squeeze = Squeeze::new(azimuth, 1.0, 1.0 / squeeze);
    mixture.set_diffuse(diffuse);
    lobes::<L::Lobes, FEW>(material, place, leave_out, mixture);
}

/// The numbers of the head round a place, as they are stored.
#[cfg(feature = "simd")]
#[inline(always)]
#[allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices
pub(crate) fn head_numbers<L: Lanes>(material: MaterialRef<'_>, place: Place) -> [f32; HEAD] {
    let mut head = [0.0; HEAD];
    let copies;
    let (a, b): (&[u8], &[u8]) = if material.header.codes.is_some() {
        copies = decoded_heads(material, place);
        (&copies[0], &copies[1])
    } else {
        let [a, b] = place.views().map(|view| material.header.head(view));
        (&material.bytes[a..a + 4 * HEAD], &material.bytes[b..b + 4 * HEAD])
    };
    for i in 0..HEAD {
        let [a, b] = [L::splat(f32_at(a, 4 * i)), L::splat(f32_at(b, 4 * i))];
        head[i] = (b - a).mul_add(L::splat(place.blend), a).first();
    }
    head
}

/// The squeeze and the albedo of the diffuse term round a place.
#[inline(always)]
pub(crate) fn head_at<L: Lanes>(material: MaterialRef<'_>, place: Place) -> (f32, [f32; 3]) {
    if L::COUNT == 1 {
        return one_lobe::head(material, place.between_views());
    }
    let (copies, copy_a, copy_b);
    let (a, b) = if material.header.codes.is_some() {
        copies = decoded_heads(material, place);
        (&copies[0][..], &copies[1][..])
    } else {
        let (a, b) = (material.header.head(place.before), material.header.head(place.after));
        let a = from_offset!(material.bytes, a, 0, HEADS, copy_a, HEADS);
        let b = from_offset!(material.bytes, b, 0, HEADS, copy_b, HEADS);
        (a, b)
    };
    let (mut head, mut logarithms) = ([0.0; WIDEST_PAIR], [0.0; WIDEST_PAIR]);
    let mut i = 0;
    while i < HEAD {
        // The bytes behind the head are none of its numbers, and their power of two may be a subnormal, which
        // costs 150 cycles.
        let numbers = place.between::<L>(a, b, i).keep(L::first_lanes(HEAD - i));
        exp2(numbers).store(&mut head[i..]);
        if material.header.has_luminance {
            numbers.store(&mut logarithms[i..]);
        }
        i += L::COUNT;
    }
    let diffuse = if material.header.has_luminance {
        color::rgb(head[1], [logarithms[2], logarithms[3]])
    } else {
        [head[1], head[2], head[3]]
    };
    (head[0], diffuse)
}

/// The bytes of the heads of two views of a material in codes, and zeros.
#[inline(never)]
fn decoded_heads(material: MaterialRef<'_>, place: Place) -> [[u8; HEADS]; 2] {
    let heads = material.header.two_heads(material.bytes, place.views()).unwrap_or_default();
    let mut bytes = [[0; HEADS]; 2];
    for (bytes, head) in bytes.iter_mut().zip(heads) {
        bytes[..4 * HEAD].copy_from_slice(bytemuck::bytes_of(&head.map(|n| n.to_bits().to_le())));
    }
    bytes
}

/// Interpolates the lobes and completes the mixture but for its sums.
#[inline(always)]
fn lobes<L: Lanes, const FEW: bool>(
    material: MaterialRef<'_>,
    place: Place,
    leave_out: LeaveOut,
    mixture: &mut AnyMixture<'_>,
) {
    let header = material.header;
    mixture.head.in_plane = header.mirrored == 0;
    if L::COUNT == 1 {
        one_by_one(material, place.between_views(), mixture);
        mixture.finish_lobes::<L, FEW>(header.lobe_count(), header.squeezed, leave_out);
        return;
    }
    let (copy_a, copy_b);
    let (mut room, mut little) = (None, None);
    let rows = rows_at!(L, material, place, copy_a, copy_b, room_for!(FEW, little, room));
    row::for_lobes!(FEW, L, &mut mixture.groups, rows.total(), |group, at, k| {
        let lobes = rows.lobes::<L, false>(k);
        let ([x, y, z], [red, green, blue]) = (lobes.axis, lobes.rgb);
        red.store(&mut group[row::RED][at..]);
        green.store(&mut group[row::GREEN][at..]);
        blue.store(&mut group[row::BLUE][at..]);
        x.store(&mut group[row::AXIS_X][at..]);
        y.store(&mut group[row::AXIS_Y][at..]);
        z.store(&mut group[row::AXIS_Z][at..]);
        lobes.sharpness.store(&mut group[row::SHARPNESS][at..]);
    });
    mixture.finish_lobes::<L, FEW>(rows.total(), header.squeezed, leave_out);
}

/// Interpolates the lobes one after the other.
#[inline(always)]
fn one_by_one(material: MaterialRef<'_>, between: Between, mixture: &mut AnyMixture<'_>) {
    let from = OneRows::new(material, between);
    for stored in 0..material.header.lobes.min(mixture.capacity()) {
        let lobe = one_lobe::lobe::<false>(&from, stored);
        store_one(&lobe, stored, lobe.axis[1], mixture);
        if let Some(image) = lobe.image {
            store_one(&lobe, image, 0.0 - lobe.axis[1], mixture);
        }
    }
}

/// Stores a lobe as the `k`-th; `y` is that of its axis.
#[inline(always)]
fn store_one(lobe: &OneLobe, k: usize, y: f32, mixture: &mut AnyMixture<'_>) {
    if !mixture.has_room(k) {
        return;
    }
    let ([x, _, z], [red, green, blue]) = (lobe.axis, lobe.rgb);
    *mixture.number_mut(row::AXIS_X, k) = x;
    *mixture.number_mut(row::AXIS_Y, k) = y;
    *mixture.number_mut(row::AXIS_Z, k) = z;
    *mixture.number_mut(row::SHARPNESS, k) = lobe.sharpness;
    *mixture.number_mut(row::RED, k) = red;
    *mixture.number_mut(row::GREEN, k) = green;
    *mixture.number_mut(row::BLUE, k) = blue;
}

/// Lobes between two views, one a lane; behind the last ones of amplitude 0.
pub(crate) struct Lobes<L> {
    /// Unit vectors, which may point below the horizon.
    pub axis: [L; 3],
    pub sharpness: L,
    /// Amplitudes, and their luminance.
    pub rgb: [L; 3],
    #[cfg_attr(not(feature = "simd"), allow(dead_code))]
    pub luminance: L,
}

/// Amplitudes of lobes and their luminance, of the first number as a power of two and the logarithms or differences of the others; behind
/// the last lobe 0.
#[inline(always)]
pub(crate) fn colored<L: Lanes>(
    first: L,
    [second, third]: [L; 2],
    valid: L::Mask,
    has_luminance: bool,
) -> ([L; 3], L) {
    let nothing = L::splat(if has_luminance { 0.0 } else { -126.0 });
    let second = L::select(valid, second, nothing);
    let third = L::select(valid, third, nothing);
    if has_luminance {
        (color::rgb(first, [second, third]), first)
    } else {
        let rgb = [first, exp2(second), exp2(third)];
        (rgb, dot3(rgb, splat3(LUMINANCE)))
    }
}

/// The numbers of two views, and the share of the second.
pub(crate) struct Rows<'a> {
    pub views: TwoRows<'a>,
    pub blend: f32,
    /// Stored lobes, and those of them that stand for two.
    pub count: usize,
    pub mirrored: usize,
    /// Luminance and colour differences in place of red, green and blue.
    pub has_luminance: bool,
}

#[allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices
impl Rows<'_> {
    /// Lobes, the images of the mirrored ones included.
    #[inline(always)]
    pub fn total(&self) -> usize {
        self.count + self.mirrored
    }

    /// The lobes from the `k`-th on. `SOON`: by a shorter chain of more operations.
    #[inline(always)]
    pub fn lobes<L: Lanes, const SOON: bool>(&self, k: usize) -> Lobes<L> {
        let (zero, none) = (L::splat(0.0), L::splat(-126.0));
        let valid = L::iota().lt(L::splat((self.total() - k) as f32));
        // Lanes without a lobe hold bytes of the next view or of the text, whose powers of two may be
        // subnormals: 150 cycles each on Intel. A power of -126 is exactly 0.
        let [angle, log_sharpness, first, second, third] = self.numbers::<L>(k);
        let (angle, log_sharpness) = (angle.keep(valid), log_sharpness.keep(valid));
        let first = exp2(L::select(valid, first, none));
        let (rgb, luminance) = colored(first, [second, third], valid, self.has_luminance);
        let (x, z) = sin_cos(angle);
        let axis = self.turned(k, [x, zero, z]);
        let sharpness = if SOON { exp2_soon(log_sharpness) } else { exp2(log_sharpness) };
        Lobes { axis, sharpness, rgb, luminance }
    }

    /// The numbers of a vector of lobes, images being their mirrored lobes; behind the last lobe anything.
    #[inline(always)]
    fn numbers<L: Lanes>(&self, k: usize) -> [L; ROWS] {
        // Images are in the last vector: where two are taken together, one has none.
        if L::VECTORS > 1 {
            return of_halves([self.numbers(k), self.numbers(k + L::Half::COUNT)]);
        }
        let mut numbers = [L::splat(0.0); ROWS];
        for row in 0..ROWS {
            numbers[row] = self.between(row, 1, k);
        }
        if self.mirrored > 0 && k + L::COUNT > self.count {
            let stored = self.before::<L>(self.count, k);
            for row in 0..ROWS {
                numbers[row] = L::select(stored, numbers[row], self.between(row, 0, k));
            }
        }
        numbers
    }

    /// Turns axes out of the plane of incidence.
    #[inline(always)]
    fn turned<L: Lanes>(&self, k: usize, axis: [L; 3]) -> [L; 3] {
        if L::VECTORS > 1 {
            let [low, high] = halves(axis);
            return of_halves([self.turned(k, low), self.turned(k + L::Half::COUNT, high)]);
        }
        if self.mirrored == 0 || k + L::COUNT <= self.count - self.mirrored {
            return axis;
        }
        let (sin, cos) = sin_cos(self.off_plane::<L>(k));
        [axis[0] * cos, sin, axis[2] * cos]
    }

    /// Interpolates the numbers of a row; `ahead`: 1, or 0 for the images.
    #[inline(always)]
    fn between<L: Lanes>(&self, row: usize, ahead: usize, k: usize) -> L {
        let [a, b]: [L; 2] = self.views.load(row, ahead, k);
        (b - a).mul_add(L::splat(self.blend), a)
    }

    /// Angles out of the plane of incidence: 0, then those of the mirrored lobes, then their opposites, then
    /// 0.
    #[inline(always)]
    fn off_plane<L: Lanes>(&self, k: usize) -> L {
        let zero = L::splat(0.0);
        // They stand where the row behind the last would have its first numbers, so that from row 4 on a lobe's own is as many further
        // as there are mirrored lobes.
        let stored = self.between(4, 2, k);
        let image = zero - self.between::<L>(4, 1, k);
        let image = L::select(self.before::<L>(self.count + self.mirrored, k), image, zero);
        let mirrored = L::select(self.before::<L>(self.count, k), stored, image);
        let off_plane = L::select(self.before::<L>(self.count - self.mirrored, k), zero, mirrored);
        // The square of a number next to nothing is a subnormal.
        off_plane.keep(off_plane.abs().ge(L::splat(LEAST_OFF_PLANE)))
    }

    /// Which lobes of a vector come before one.
    #[inline(always)]
    fn before<L: Lanes>(&self, lobe: usize, k: usize) -> L::Mask {
        L::iota().lt(L::splat(lobe as f32 - k as f32))
    }
}

/// The numbers of two views, with room for those that a vector reaches.
pub(crate) type Decoded = [[f32; PADDED / 4]; 2];

/// Room for them.
pub(crate) const NOT_DECODED: Decoded = [[0.0; PADDED / 4]; 2];

/// The same for one group of lobes.
pub(crate) const FEW_DECODED: [[f32; 5 * WIDEST + WIDEST_PAIR]; 2] = [[0.0; 5 * WIDEST + WIDEST_PAIR]; 2];

/// The numbers that views of a material in codes have, little endian; as many go before them as there are mirrored lobes.
#[inline(always)]
pub(crate) fn decode(material: MaterialRef<'_>, place: Place, [a, b]: [&mut [f32]; 2]) {
    let header = material.header;
    let Some(views) = header.two_views(material.bytes, place.views()) else { return };
    let len = 5 * header.lobes + header.mirrored;
    let (a, b) = (&mut a[header.mirrored..][..len], &mut b[header.mirrored..][..len]);
    views.all(header.mirrored, [&mut *a, &mut *b]);
    if cfg!(target_endian = "big") {
        for number in [a, b].into_iter().flatten() {
            *number = f32::from_bits(number.to_bits().to_le());
        }
    }
}

/// Bytes of one vector: the angles of views, or the head of one.
const HEADS: usize = 4 * WIDEST_PAIR;

/// Room for a view of the most lobes, and a vector more.
pub(crate) const PADDED: usize = 4 * (5 * MAX_LOBES + WIDEST_PAIR);

/// At least `need` bytes from `ahead` before an offset on, with zeros before the file and after it.
#[cold]
#[inline(never)]
pub(crate) fn padded<const LEN: usize>(bytes: &[u8], offset: usize, ahead: usize, need: usize) -> [u8; LEN] {
    let mut copy = [0; LEN];
    let missing = ahead.saturating_sub(offset).min(LEN);
    let rest = &bytes[offset.saturating_sub(ahead)..];
    let len = rest.len().min(need.min(LEN).saturating_sub(missing));
    copy[missing..missing + len].copy_from_slice(&rest[..len]);
    copy
}
