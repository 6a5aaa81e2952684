//! Writes a material in codes, and codes as plain numbers again.

use super::borrowed::Material;
use super::codes::{ANGLE_UNIT, Codes, Scale};
use super::encode::Writer;
use super::factor_table::FactorTable;
use super::format_error::FormatError;
use super::layout::{HEADER, Header, Kind, LOBE, PACK};
use super::spectral_map::SpectralMap;
use crate::color::{MOST_DIFFERENCE, luminance};
use core::f32::consts::{FRAC_PI_2, PI};

/// How small the numbers of a material become by [`Material::pack`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PackOptions {
    /// Bits of a number of a lobe, 8 or 16.
    pub bits: u8,
    /// Channels, 3; or 1 for the luminance alone.
    pub channels: u8,
}

impl Default for PackOptions {
    fn default() -> Self {
        Self { bits: 8, channels: 3 }
    }
}

/// In codes of 8 bits, luminances of a lobe that are this far below its largest one are all the same; base-2 logarithm.
const DARKEST: f32 = 24.0;

const COLOR: (f32, f32) = (-MOST_DIFFERENCE, MOST_DIFFERENCE);

/// The numbers of views, with the least and the largest that a reader takes.
struct Numbers {
    /// Of a head.
    head: &'static [(f32, f32)],
    /// Of each row: of lobes, and those of lobes that stand for two.
    rows: &'static [(f32, f32)],
    /// The row of luminances.
    luminance: usize,
    /// The first number of a head, and the rows, that are 0 in the first view.
    zero_head: usize,
    zero_rows: &'static [usize],
}

/// The row of angles in the plane of incidence, and of an isotropic material that of angles out of it.
const ANGLE: usize = 0;
const OFF_PLANE: usize = 5;

const ISOTROPIC: Numbers = Numbers {
    head: &[(-6.64, 1.0), (-126.0, 2.0), COLOR, COLOR],
    rows: &[(-PI, PI), (-100.0, 26.5), (-126.0, 60.0), COLOR, COLOR, (-FRAC_PI_2, FRAC_PI_2)],
    luminance: 2,
    zero_head: 1,
    zero_rows: &[ANGLE, OFF_PLANE],
};

const ANISOTROPIC: Numbers = Numbers {
    head: &[(-5.0, 6.64), (-6.0, 6.0), (-5.0, 6.64), (-126.0, 2.0), COLOR, COLOR],
    rows: &[(-PI, PI), (-PI, PI), (-100.0, 26.5), (-126.0, 60.0), COLOR, COLOR],
    luminance: 3,
    zero_head: 0,
    zero_rows: &[],
};

impl<B: AsRef<[u8]>> Material<B> {
    /// Bits of a number of a lobe, if they are codes: 8 or 16; `None` for f32.
    pub fn code_bits(&self) -> Option<u8> {
        self.header().codes.map(|codes| 8 * codes.bytes)
    }

    /// Bytes that [`pack`](Self::pack) writes.
    pub fn packed_len(&self, options: PackOptions, provenance: &str) -> usize {
        self.placed(codes_of(options), provenance).1
    }

    /// Writes a material with 8 or 16 bits a number, in a quarter or half of the bytes; such bytes are read in
    /// place too. A hit takes 1.35 to 1.5 times as long on a PC, where [`unpack`](Self::unpack) serves.
    ///
    /// A number is off by at most half of 1/255 or 1/65535 of its range over all views, and 1/256 of that. The angle of an
    /// axis takes the smaller range of itself and of its distance from the mirror direction. Shapes: `out`
    /// [[`packed_len`](Self::packed_len)], overwritten. Returns: the bytes written.
    ///
    /// # Errors
    /// [`FormatError::Buffer`] if `out` is too small; [`FormatError::Field`] for options that there are not, and for views less
    /// than 3e-5 radians apart. The same for a squeeze matrix, or an axis of an anisotropic material, at the very end of its range.
    pub fn pack(&self, options: PackOptions, provenance: &str, out: &mut [u8]) -> Result<usize, FormatError> {
        if ![8, 16].contains(&options.bits) {
            return Err(FormatError::Field { name: "bits of a code (8 or 16)", offset: HEADER });
        }
        if ![1, 3].contains(&options.channels) {
            return Err(FormatError::Field { name: "channels (1 or 3)", offset: HEADER + 1 });
        }
        self.write(codes_of(options), provenance, out)
    }

    /// Bytes that [`unpack`](Self::unpack) writes.
    pub fn unpacked_len(&self) -> usize {
        self.placed(None, self.provenance()).1
    }

    /// Writes a material with plain numbers, which hits on a PC are fastest with, whatever it is stored by.
    ///
    /// Shapes: `out` [[`unpacked_len`](Self::unpacked_len)], overwritten. Returns: the bytes written.
    ///
    /// # Errors
    /// [`FormatError::Buffer`] if `out` is too small.
    pub fn unpack(&self, out: &mut [u8]) -> Result<usize, FormatError> {
        self.write(None, self.provenance(), out)
    }

    /// The header that a way of writing has, and the length of the whole.
    fn placed(&self, codes: Option<Codes>, provenance: &str) -> (Header, usize) {
        let header = Header {
            codes,
            provenance: provenance.len() as u32,
            bits: 8,
            has_luminance: true,
            ..*self.header()
        };
        let (header, bytes) = header.placed();
        (header, bytes + self.spectral_map().map_or(0, SpectralMap::block_len))
    }

    fn write(&self, codes: Option<Codes>, provenance: &str, out: &mut [u8]) -> Result<usize, FormatError> {
        let (to, needed) = self.placed(codes, provenance);
        if out.len() < needed {
            return Err(FormatError::Buffer { needed, available: out.len() });
        }
        let tag = if codes.is_some() { PACK } else { LOBE };
        let (kind, counts) = match to.kind {
            Kind::Line => (0, [to.views, to.mirrored, 0]),
            Kind::Grid(shape) => (1, [shape.thetas, shape.azimuths, shape.turns_and_axis()]),
        };
        let fields = [counts[0], to.lobes, to.squeezed, counts[1], counts[2]];
        let mut writer = Writer::new(out, kind, fields, needed, tag);
        match codes {
            Some(codes) => self.put_codes(codes, &mut writer),
            None => self.put_numbers(&mut writer),
        }
        writer.end(HEADER);
        let is_grey = codes.is_some_and(|codes| codes.is_grey);
        if self.factor_nodes().is_some() {
            let start = writer.begin_factors(to.factors, to.has_signed_factors);
            let grey = |rgb: [f32; 3]| if is_grey { [luminance(rgb); 3] } else { rgb };
            let differences = (0..to.views).filter_map(|view| self.view_albedo_difference(view)).map(grey);
            differences.flatten().for_each(|n| writer.number(n));
            let nodes = || self.every_factor().map(grey);
            let largest = nodes().flatten().fold(0.0, f32::max);
            writer.number(largest);
            nodes().for_each(|factor| writer.put(&FactorTable::node(&factor, largest)));
            writer.end(start);
        }
        writer.finish(provenance, self.spectral_map())
    }

    /// The factors in the order of the file.
    fn every_factor(&self) -> impl Iterator<Item = [f32; 3]> {
        let [halves, differences, azimuths] = self.factor_nodes().unwrap_or_default();
        let planes = (0..azimuths).flat_map(move |k| (0..halves).map(move |i| (k, i)));
        planes.flat_map(move |(k, i)| (0..differences).filter_map(move |j| self.factor_node(i, j, k)))
    }

    /// The numbers of its views.
    fn numbers(&self) -> &'static Numbers {
        if self.is_isotropic() { &ISOTROPIC } else { &ANISOTROPIC }
    }

    /// How many angles its views have.
    fn angle_count(&self) -> usize {
        match self.header().kind {
            Kind::Line => self.view_count(),
            Kind::Grid(shape) => shape.thetas,
        }
    }

    /// A number of a head, of a colour by luminance and differences whatever the version of the bytes.
    fn head_number(&self, view: usize, number: usize) -> f32 {
        let of_squeeze = self.numbers().head.len() - 3;
        if let Some(of_color) = number.checked_sub(of_squeeze) {
            let [red, blue] = self.view_diffuse_color_differences(view).unwrap_or_default();
            return [self.view_log2_diffuse(view).unwrap_or_default(), red, blue][of_color];
        }
        match self.header().kind {
            Kind::Line => self.view_log2_squeeze(view).unwrap_or_default(),
            Kind::Grid(shape) => self.header().grid_head(shape, self.bytes(), view, number).0,
        }
    }

    /// A number of a lobe, of a colour as in a head; of row 5 of an isotropic material that of a mirrored lobe.
    fn lobe_number(&self, view: usize, row: usize, lobe: usize) -> f32 {
        let first = self.numbers().luminance;
        if (first..first + 3).contains(&row) {
            let plane = self.view_lobe(view, lobe).map(|l| (l.log2_luminance, l.color_differences));
            let tilted =
                || self.view_tilted_lobe(view, lobe).map(|l| (l.log2_luminance, l.color_differences));
            let (log2, [red, blue]) = plane.or_else(tilted).unwrap_or_default();
            return [log2, red, blue][row - first];
        }
        match self.header().kind {
            Kind::Line => self.header().number(self.bytes(), view, row, lobe),
            Kind::Grid(shape) => self.header().grid_number(shape, self.bytes(), view, row, lobe).0,
        }
    }

    /// Lobes of a row.
    fn row_len(&self, row: usize) -> usize {
        if self.is_isotropic() && row == OFF_PLANE { self.mirrored_count() } else { self.view_lobe_count() }
    }

    /// The angle of number `n` from the normal.
    fn angle(&self, n: usize) -> f32 {
        self.header().angle(self.bytes(), n)
    }

    fn put_numbers(&self, writer: &mut Writer<'_>) {
        let (views, numbers) = (self.view_count(), self.numbers());
        (0..self.angle_count()).for_each(|n| writer.number(self.angle(n)));
        for view in 0..views {
            (0..numbers.head.len()).for_each(|i| writer.number(self.head_number(view, i)));
        }
        for view in 0..views {
            for row in 0..numbers.rows.len() {
                (0..self.row_len(row)).for_each(|lobe| writer.number(self.lobe_number(view, row, lobe)));
            }
        }
    }

    fn put_codes(&self, codes: Codes, writer: &mut Writer<'_>) {
        let (views, numbers) = (self.view_count(), self.numbers());
        writer.put(&[8 * codes.bytes, if codes.is_grey { 1 } else { 3 }, 0, 0]);
        let angle_code = |angle: f32| (angle / ANGLE_UNIT + 0.5) as u16;
        let angle =
            |view: usize| f32::from(angle_code(self.view_theta(view).unwrap_or_default())) * ANGLE_UNIT;
        (0..self.angle_count()).for_each(|n| writer.put(&angle_code(self.angle(n)).to_le_bytes()));

        let grey = if codes.is_grey { 2 } else { 0 };
        let head_len = numbers.head.len() - grey;
        let head_scale = |i: usize| {
            let first = usize::from(i < numbers.zero_head);
            Scale::over(
                (first..views).map(|view| inside(self.head_number(view, i), numbers.head[i])),
                u16::MAX,
            )
        };
        (0..head_len).for_each(|i| writer.put(&head_scale(i).to_bytes()));
        for view in 0..views {
            for (i, limits) in numbers.head.iter().enumerate().take(head_len) {
                let number = inside(self.head_number(view, i), *limits);
                let code = head_scale(i).encode(number, 0.0, u16::MAX, *limits);
                writer.put(&code.to_le_bytes());
            }
        }

        let most = if codes.bytes == 1 { u16::from(u8::MAX) } else { u16::MAX };
        // Colour differences come behind the luminances.
        let colors = numbers.luminance + 1..numbers.luminance + 1 + grey;
        let rows = || (0..numbers.rows.len()).filter(|row| !colors.contains(row));
        let number = |view: usize, row: usize, lobe: usize| {
            inside(self.lobe_number(view, row, lobe), numbers.rows[row])
        };
        let lobe_scale = |row: usize, lobe: usize| {
            let first = usize::from(numbers.zero_rows.contains(&row));
            let of_views = (first..views).map(|view| number(view, row, lobe));
            if row == numbers.luminance && codes.bytes == 1 {
                let brightest = of_views.clone().fold(-126.0, f32::max);
                return Scale::over(of_views.map(|n| n.max(brightest - DARKEST)), most);
            }
            let scale = Scale::over(of_views, most);
            let onward = (first..views).map(|view| number(view, row, lobe) - angle(view));
            let relative = Scale { is_relative: true, ..Scale::over(onward, most) };
            if row == ANGLE && relative.step < scale.step { relative } else { scale }
        };
        let start = writer.at;
        for row in rows() {
            (0..self.row_len(row)).for_each(|lobe| writer.put(&lobe_scale(row, lobe).to_bytes()));
        }
        // Scales are known from the bytes: to look for them again at every view would take its square.
        for view in 0..views {
            let mut place = 0;
            for row in rows() {
                for lobe in 0..self.row_len(row) {
                    let scale = writer.scale_at(start, place);
                    let code = scale.encode(number(view, row, lobe), angle(view), most, numbers.rows[row]);
                    writer.put(&code.to_le_bytes()[..codes.bytes.into()]);
                    place += 1;
                }
            }
        }
    }
}

/// A number within its limits by some roundings, so that its code is within them too.
fn inside(number: f32, (least, largest): (f32, f32)) -> f32 {
    const WITHIN: f32 = 1.0 - 4.0 * f32::EPSILON;
    number.clamp(least * WITHIN, largest * WITHIN)
}

/// How codes are stored.
fn codes_of(options: PackOptions) -> Option<Codes> {
    Some(Codes { bytes: if options.bits == 8 { 1 } else { 2 }, is_grey: options.channels == 1 })
}

impl Scale {
    /// The finest one that has a code up to `most` for each of some numbers.
    pub(super) fn over(numbers: impl Iterator<Item = f32>, most: u16) -> Self {
        let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
        for n in numbers {
            (low, high) = (low.min(n), high.max(n));
        }
        if low > high {
            return Self { low: 0.0, step: 0.0, is_relative: false };
        }
        // The lower half of the bits goes: away from 0 for a negative low, towards it for a positive one.
        let up = |bits: u32| if bits & 0xffff == 0 { bits } else { (bits | 0xffff) + 1 };
        let bits = low.to_bits();
        let low = f32::from_bits(if low < 0.0 { up(bits) } else { bits & 0xffff_0000 });
        let step = f32::from_bits(up(((high - low).max(0.0) / f32::from(most)).to_bits()));
        Self { low, step, is_relative: false }
    }

    pub(super) fn to_bytes(self) -> [u8; 4] {
        let step = if self.is_relative { -self.step } else { self.step };
        let [low, step] = [self.low, step].map(|n| ((n.to_bits() >> 16) as u16).to_le_bytes());
        [low[0], low[1], step[0], step[1]]
    }

    /// The code that is nearest to a number, of those up to `most` within limits.
    pub(super) fn encode(self, number: f32, angle: f32, most: u16, (least, largest): (f32, f32)) -> u16 {
        let above = number - self.low - if self.is_relative { angle } else { 0.0 };
        let mut code = if self.step > 0.0 { (above / self.step + 0.5) as u16 } else { 0 }.min(most);
        while code > 0 && self.decode(code, angle) > largest {
            code -= 1;
        }
        while code < most && self.decode(code, angle) < least {
            code += 1;
        }
        code
    }
}
