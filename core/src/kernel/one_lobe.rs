//! The lobes of an isotropic material between two views one at a time, where vectors are one number: nothing beside the numbers
//! themselves is read.

use crate::color::{self, LUMINANCE};
use crate::material::borrowed::MaterialRef;
use crate::material::codes::TwoViews;
use crate::material::layout::{HEAD, Header};
use crate::simd::elementary::{exp2, exp2_soon, rare_exp2, sin_cos};
use crate::simd::lanes::{dot3, splat3};

/// Two views, and the share of the second.
#[derive(Clone, Copy)]
pub(crate) struct Between {
    pub views: [usize; 2],
    pub blend: f32,
}

impl Between {
    #[inline(always)]
    fn of(self, [a, b]: [f32; 2]) -> f32 {
        (b - a) * self.blend + a
    }
}

/// The numbers of the lobes at two views.
#[derive(Clone, Copy)]
pub(crate) struct OneRows<'a> {
    header: &'a Header,
    between: Between,
    numbers: Numbers<'a>,
}

/// The bytes of either view, or their codes.
#[derive(Clone, Copy)]
enum Numbers<'a> {
    Plain([&'a [[u8; 4]]; 2]),
    Codes(TwoViews<'a>),
}

impl<'a> OneRows<'a> {
    #[inline(always)]
    pub fn new(material: MaterialRef<'a>, between: Between) -> Self {
        let header = material.header;
        if let Some(codes) = header.two_views(material.bytes, between.views) {
            return Self { header, between, numbers: Numbers::Codes(codes) };
        }
        let rows = between.views.map(|view| {
            let from = header.row(view, 0);
            let to = from + 4 * (HELD_ROWS * header.lobes + header.mirrored);
            material.bytes.get(from..to).unwrap_or_default().as_chunks().0
        });
        Self { header, between, numbers: Numbers::Plain(rows) }
    }
}

/// A lobe between two views.
pub(crate) struct OneLobe {
    /// A unit vector, which may point below the horizon.
    pub axis: [f32; 3],
    pub sharpness: f32,
    /// Amplitudes, and their luminance.
    pub rgb: [f32; 3],
    pub luminance: f32,
    /// The place of the lobe that differs by the sign across the plane of incidence alone, if there is one.
    pub image: Option<usize>,
}

/// How many views but the last have an angle of at most `theta`: angles rise.
#[inline(always)]
pub(crate) fn views_passed(material: MaterialRef<'_>, theta: f32) -> usize {
    let (mut low, mut high) = (0, material.header.views - 1);
    while low < high {
        let middle = (low + high) / 2;
        if theta >= material.header.angle(material.bytes, middle) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    low
}

/// The squeeze and the albedo of the diffuse term.
#[inline(always)]
pub(crate) fn head(material: MaterialRef<'_>, between: Between) -> (f32, [f32; 3]) {
    let (bytes, header) = (material.bytes, material.header);
    let mut numbers = [0.0; HEAD];
    for (i, number) in numbers.iter_mut().enumerate() {
        *number = between.of(between.views.map(|view| header.head_number(bytes, view, i)));
    }
    let [squeeze, first, second, third] = numbers;
    let first = rare_exp2(first);
    let diffuse = if header.has_luminance {
        color::rgb(first, [second, third])
    } else {
        [first, rare_exp2(second), rare_exp2(third)]
    };
    (rare_exp2(squeeze), diffuse)
}

/// Rows of numbers of a lobe: angle, sharpness, colour, angle out of the plane.
const ROWS: usize = 6;

/// Rows that every lobe has.
const HELD_ROWS: usize = 5;

/// The numbers of a stored lobe; `mirrored` counts the mirrored ones.
#[inline(always)]
fn numbers(from: &OneRows<'_>, stored: usize, mirrored: Option<usize>) -> [f32; ROWS] {
    let header = from.header;
    let mut numbers = [0.0; ROWS];
    let rows = match &from.numbers {
        Numbers::Plain(rows) => rows,
        Numbers::Codes(codes) => {
            of_codes(codes, from.between, stored, mirrored, &mut numbers);
            return numbers;
        }
    };
    let at = |place: usize| {
        let pair = rows.map(|row| row.get(place).map_or(0.0, |bytes| f32::from_le_bytes(*bytes)));
        from.between.of(pair)
    };
    let mut place = stored;
    for number in &mut numbers[..HELD_ROWS] {
        *number = at(place);
        place += header.lobes;
    }
    if let Some(m) = mirrored {
        numbers[HELD_ROWS] = at(HELD_ROWS * header.lobes + m);
    }
    numbers
}

/// The same from codes.
#[inline(never)]
fn of_codes(
    codes: &TwoViews<'_>,
    between: Between,
    stored: usize,
    mirrored: Option<usize>,
    numbers: &mut [f32; ROWS],
) {
    for (row, number) in numbers.iter_mut().enumerate() {
        let lobe = if row < HELD_ROWS { Some(stored) } else { mirrored };
        if let Some(lobe) = lobe {
            *number = between.of(codes.numbers(row, lobe));
        }
    }
}

/// Least angle out of the plane of incidence that is not taken for 0, radians: the square of a number next to nothing is a
/// subnormal.
pub(crate) const LEAST_OFF_PLANE: f32 = 1e-9;

/// A stored lobe. `SOON`: by a shorter chain of more operations.
#[inline(always)]
pub(crate) fn lobe<const SOON: bool>(from: &OneRows<'_>, stored: usize) -> OneLobe {
    let header: &Header = from.header;
    let mirrored = stored.checked_sub(header.lobes - header.mirrored);
    let [angle, log_sharpness, first, second, third, off_plane] = numbers(from, stored, mirrored);
    let first = exp2(first);
    let (rgb, luminance) = if header.has_luminance {
        (color::rgb(first, [second, third]), first)
    } else {
        let rgb = [first, exp2(second), exp2(third)];
        (rgb, dot3(rgb, splat3(LUMINANCE)))
    };
    let (mut x, mut z) = sin_cos(angle);
    let mut y = 0.0;
    if off_plane.abs() >= LEAST_OFF_PLANE {
        let (sin, cos) = sin_cos(off_plane);
        (x, y, z) = (x * cos, sin, z * cos);
    }
    let sharpness = if SOON { exp2_soon(log_sharpness) } else { exp2(log_sharpness) };
    let image = mirrored.map(|_| stored + header.mirrored);
    OneLobe { axis: [x, y, z], sharpness, rgb, luminance, image }
}
