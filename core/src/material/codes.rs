//! The numbers of lobes as codes of 8 or 16 bits, read in place; `layout.rs` has the bytes.

use super::bytes::{GRID_HEAD, GRID_ROWS, HEAD, HEADER, part, u16_at};
use core::f32::consts::FRAC_PI_2;

/// Rows of numbers of a view before the angles out of the plane: angle, sharpness, luminance, two colour differences.
const ROWS: usize = 5;

/// Colour differences, which a grey material does not have in its rows and in its head.
const COLORS: usize = 2;

/// Bytes of the block before the angles of views.
pub(crate) const PACK_HEAD: usize = 4;

/// Bytes of a scale.
pub(crate) const SCALE: usize = 4;

/// The unit of the angles of views, radians.
pub(crate) const ANGLE_UNIT: f32 = FRAC_PI_2 / 65_535.0;

/// How codes are stored; `GRID`: of views over the hemisphere, which have other numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Codes<const GRID: bool = false> {
    /// Bytes of a code: 1 or 2.
    pub bytes: u8,
    /// Whether there are no colour differences.
    pub is_grey: bool,
}

/// How many of everything a material has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Counts {
    /// Angles of views from the normal, and views at each of them but the normal.
    pub angles: usize,
    pub azimuths: usize,
    pub views: usize,
    /// Lobes that are stored at a view, and how many of them stand for two.
    pub lobes: usize,
    pub mirrored: usize,
}

/// The step between codes, and the number of code 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    pub low: f32,
    pub step: f32,
    /// Whether the angle of the view is added too.
    pub is_relative: bool,
}

/// The angle of a view from the normal, radians.
#[inline(always)]
pub(crate) fn angle(bytes: &[u8], view: usize) -> f32 {
    f32::from(u16_at(bytes, angle_offset(view))) * ANGLE_UNIT
}

/// How many of the first views have an angle of at most `theta`: all are compared, so that nothing is a branch.
pub(crate) fn angles_passed(bytes: &[u8], views: usize, theta: f32) -> usize {
    let from = angle_offset(0);
    let angles = part(bytes, from..from + 2 * views).as_chunks().0;
    let passed: u32 =
        angles.iter().map(|a| u32::from(theta >= f32::from(u16::from_le_bytes(*a)) * ANGLE_UNIT)).sum();
    passed as usize
}

/// Byte offset of the angle of a view.
#[inline(always)]
pub(crate) const fn angle_offset(view: usize) -> usize {
    HEADER + PACK_HEAD + 2 * view
}

impl Scale {
    const NONE: Self = Self { low: 0.0, step: 0.0, is_relative: false };

    #[inline(always)]
    pub fn at(bytes: &[u8], offset: usize) -> Self {
        Self::of_halves([u16_at(bytes, offset), u16_at(bytes, offset + 2)])
    }

    #[inline(always)]
    fn from_bytes([a, b, c, d]: [u8; SCALE]) -> Self {
        Self::of_halves([u16::from_le_bytes([a, b]), u16::from_le_bytes([c, d])])
    }

    /// Of the upper halves of low and step.
    #[inline(always)]
    fn of_halves(halves: [u16; 2]) -> Self {
        let [low, step] = halves.map(|half| f32::from_bits(u32::from(half) << 16));
        Self { low, step: step.abs(), is_relative: step.is_sign_negative() }
    }

    /// The number of a code; `angle` is that of the view.
    #[inline(always)]
    pub fn decode(self, code: u16, angle: f32) -> f32 {
        let number = self.low + f32::from(code) * self.step;
        if self.is_relative { number + angle } else { number }
    }
}

impl Codes {
    /// The same of views over the hemisphere.
    #[inline(always)]
    pub const fn of_grid(self) -> Codes<true> {
        Codes { bytes: self.bytes, is_grey: self.is_grey }
    }
}

impl<const GRID: bool> Codes<GRID> {
    /// Rows of a view, but for angles out of the plane.
    const ROWS: usize = if GRID { GRID_ROWS } else { ROWS };

    /// Numbers of the head of a view that are stored.
    #[inline(always)]
    pub const fn head_len(self) -> usize {
        let all = if GRID { GRID_HEAD } else { HEAD };
        if self.is_grey { all - COLORS } else { all }
    }

    /// Rows of K numbers of a view that are stored.
    #[inline(always)]
    pub const fn rows(self) -> usize {
        if self.is_grey { Self::ROWS - COLORS } else { Self::ROWS }
    }

    /// The number of the angle of a view.
    #[inline(always)]
    fn ring(counts: Counts, view: usize) -> usize {
        if GRID && view > 0 { 1 + (view - 1) / counts.azimuths.max(1) } else { view }
    }

    /// Numbers of a view that are stored.
    #[inline(always)]
    pub const fn view_len(self, counts: Counts) -> usize {
        self.rows() * counts.lobes + counts.mirrored
    }

    /// Byte offset of the scales of heads.
    #[inline(always)]
    pub const fn head_scales(self, counts: Counts) -> usize {
        HEADER + PACK_HEAD + 2 * counts.angles
    }

    /// Byte offset of the heads.
    #[inline(always)]
    pub const fn heads(self, counts: Counts) -> usize {
        self.head_scales(counts) + SCALE * self.head_len()
    }

    /// Byte offset of the scales of views.
    #[inline(always)]
    pub const fn scales(self, counts: Counts) -> usize {
        self.heads(counts) + 2 * self.head_len() * counts.views
    }

    /// Byte offset of the codes of views.
    #[inline(always)]
    pub const fn views(self, counts: Counts) -> usize {
        self.scales(counts) + SCALE * self.view_len(counts)
    }

    /// Byte offset behind the codes of views.
    pub const fn end(self, counts: Counts) -> usize {
        self.views(counts) + self.bytes as usize * self.view_len(counts) * counts.views
    }

    /// A number of the head of a view: squeeze, diffuse albedo in three numbers.
    pub fn head_number(self, counts: Counts, bytes: &[u8], view: usize, number: usize) -> f32 {
        if number >= self.head_len() || (!GRID && number == 0 && view == 0) {
            return 0.0;
        }
        let scale = Scale::at(bytes, self.head_scales(counts) + SCALE * number);
        let code = u16_at(bytes, self.head_offset(counts, view) + 2 * number);
        scale.decode(code, angle(bytes, Self::ring(counts, view)))
    }

    /// Byte offset of the head of a view.
    pub const fn head_offset(self, counts: Counts, view: usize) -> usize {
        self.heads(counts) + 2 * self.head_len() * view
    }

    /// Byte offset of the code of a number of a lobe at a view; of a number that is always 0 that of the scales.
    pub const fn number_offset(self, counts: Counts, view: usize, row: usize, lobe: usize) -> usize {
        match self.place(counts.lobes, row, lobe) {
            None => self.scales(counts),
            Some(place) => self.code_offset(counts, view, place),
        }
    }

    /// Byte offset of the code at a place among the numbers of a view.
    #[inline(always)]
    const fn code_offset(self, counts: Counts, view: usize, place: usize) -> usize {
        self.views(counts) + self.bytes as usize * (self.view_len(counts) * view + place)
    }

    /// Where a number of a lobe stands among those of a view; `None` for the colours of grey materials, which are 0.
    #[inline(always)]
    pub const fn place(self, lobes: usize, row: usize, lobe: usize) -> Option<usize> {
        if row < self.rows() {
            Some(row * lobes + lobe)
        } else if row < Self::ROWS {
            None
        } else {
            Some(self.rows() * lobes + lobe)
        }
    }

    /// Two views, for the numbers of their lobes.
    #[inline(always)]
    pub fn two_views<'a>(self, counts: Counts, bytes: &'a [u8], views: [usize; 2]) -> TwoViews<'a, GRID> {
        let len = self.view_len(counts);
        let scales = self.scales(counts);
        let rows = views.map(|view| {
            let from = self.code_offset(counts, view, 0);
            part(bytes, from..from + self.bytes as usize * len)
        });
        TwoViews {
            codes: self,
            lobes: counts.lobes,
            scales: part(bytes, scales..scales + SCALE * len).as_chunks().0,
            rows,
            angles: views.map(|view| angle(bytes, Self::ring(counts, view))),
        }
    }

    /// The numbers of the heads of two views.
    pub fn two_heads<const N: usize>(self, counts: Counts, bytes: &[u8], views: [usize; 2]) -> [[f32; N]; 2] {
        let (scales, len) = (self.head_scales(counts), self.head_len());
        let scales = part(bytes, scales..scales + SCALE * len).as_chunks().0;
        let mut heads = [[0.0; N]; 2];
        for (head, view) in heads.iter_mut().zip(views) {
            let (at, angle) = (self.head_offset(counts, view), angle(bytes, Self::ring(counts, view)));
            let codes = part(bytes, at..at + 2 * len).as_chunks().0;
            for ((number, scale), code) in head.iter_mut().zip(scales).zip(codes) {
                *number = Scale::from_bytes(*scale).decode(u16::from_le_bytes(*code), angle);
            }
            if !GRID && view == 0 {
                head[0] = 0.0;
            }
        }
        heads
    }

    /// A number of a lobe at a view; of row 5 that of a mirrored lobe.
    pub fn number(self, counts: Counts, bytes: &[u8], view: usize, row: usize, lobe: usize) -> f32 {
        let [number, _] = self.two_views(counts, bytes, [view, view]).numbers(row, lobe);
        number
    }
}

/// The codes of two views.
#[derive(Clone, Copy)]
pub(crate) struct TwoViews<'a, const GRID: bool = false> {
    codes: Codes<GRID>,
    /// Lobes that are stored at a view.
    lobes: usize,
    scales: &'a [[u8; SCALE]],
    rows: [&'a [u8]; 2],
    /// 0 is the first view, as angles rise.
    angles: [f32; 2],
}

impl<const GRID: bool> TwoViews<'_, GRID> {
    /// A number of a lobe at the two views; of row 5 that of a mirrored lobe.
    #[inline(always)]
    pub fn numbers(&self, row: usize, lobe: usize) -> [f32; 2] {
        let Some(place) = self.codes.place(self.lobes, row, lobe) else { return [0.0; 2] };
        // Places are checked when a material is loaded.
        let scale = self.scales.get(place).map_or(Scale::NONE, |scale| Scale::from_bytes(*scale));
        let at_normal_is_0 = !GRID && (row == 0 || row == ROWS);
        let mut numbers = [0.0; 2];
        for (i, number) in numbers.iter_mut().enumerate() {
            if at_normal_is_0 && self.angles[i] == 0.0 {
                continue;
            }
            let code = if self.codes.bytes == 1 {
                self.rows[i].get(place).map_or(0, |code| u16::from(*code))
            } else {
                self.rows[i].as_chunks().0.get(place).map_or(0, |code| u16::from_le_bytes(*code))
            };
            *number = scale.decode(code, self.angles[i]);
        }
        numbers
    }

    /// All numbers of the lobes at the two views, in the order of `LOBE`: for vectors, which have no branch for a number.
    ///
    /// Pairs are written out: a closure over an array becomes a call.
    #[inline(always)]
    pub fn all(&self, mirrored: usize, [a, b]: [&mut [f32]; 2]) {
        let (stored, all) = (self.codes.rows() * self.lobes, Codes::<GRID>::ROWS * self.lobes);
        let together = if self.codes.is_grey { stored } else { all + mirrored };
        self.decode(0, [&mut a[..together], &mut b[..together]]);
        if self.codes.is_grey {
            a[stored..all].fill(0.0);
            b[stored..all].fill(0.0);
            if !GRID {
                self.decode(stored, [&mut a[all..all + mirrored], &mut b[all..all + mirrored]]);
            }
        }
        for (to, angle) in [a, b].into_iter().zip(self.angles) {
            if !GRID && angle == 0.0 {
                to[..self.lobes].fill(0.0);
                to[all..all + mirrored].fill(0.0);
            }
        }
    }

    /// The numbers of codes from a place on.
    #[inline(always)]
    fn decode(&self, from: usize, to: [&mut [f32]; 2]) {
        let [a, b] = self.rows;
        if self.codes.bytes == 1 {
            let of = |code: &u8| u16::from(*code);
            self.decode_each(from, to, [a[from..].iter().map(of), b[from..].iter().map(of)]);
        } else {
            let of = |code: &[u8; 2]| u16::from_le_bytes(*code);
            let [a, b] = [a.as_chunks().0, b.as_chunks().0];
            self.decode_each(from, to, [a[from..].iter().map(of), b[from..].iter().map(of)]);
        }
    }

    /// The compiler makes vectors of this loop.
    #[inline(always)]
    fn decode_each(
        &self,
        from: usize,
        [a, b]: [&mut [f32]; 2],
        [of_a, of_b]: [impl Iterator<Item = u16>; 2],
    ) {
        let scales = self.scales[from..].iter();
        for ((scale, (a, b)), (of_a, of_b)) in scales.zip(a.iter_mut().zip(b)).zip(of_a.zip(of_b)) {
            let scale = Scale::from_bytes(*scale);
            (*a, *b) = (scale.decode(of_a, self.angles[0]), scale.decode(of_b, self.angles[1]));
        }
    }
}
