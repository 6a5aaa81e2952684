//! From colours to spectra: the map that the block `spec` stores, and the fixed one of materials without it.

use super::bytes::{f32_at, part, u16_at, u32_at};
use super::codes::{SCALE, Scale};
use super::format_error::FormatError;
use super::layout::{BLOCK_HEAD, padded};
use crate::color::LUMINANCE;
use glam::Vec3;

/// Most wavelengths that a map has.
pub const MAX_WAVELENGTHS: usize = 1024;

/// Bytes before the wavelengths: kind, bits, their number, the error.
pub(super) const HEAD: usize = 8;

/// The unit of wavelengths, nm.
pub(super) const UNIT: f32 = 0.1;

/// The longest wavelength, nm.
pub(super) const LONGEST: f32 = 6553.5;

/// Largest magnitude of a number of a column, and largest error.
pub(super) const MOST: f32 = 1e6;

/// Kinds: columns for red, green and blue, or one for the luminance.
const RGB: u8 = 0;
pub(super) const GREY: u8 = 1;

/// The map of a material that has none, 400 to 700 nm: the three smoothest spectra that are the primaries of sRGB under D65, within
/// 0 and 1, and 1 together at each wavelength. They minimise the squares of differences between wavelengths. A code is over 2^15.
#[rustfmt::skip]
const FIXED_CODES: [[u16; 3]; 16] = [
    [1519, 0, 31249], [1443, 0, 31325], [859, 0, 31909], [409, 0, 32359],
    [0, 9313, 23455], [0, 23707, 9061], [0, 32768, 0], [0, 32768, 0],
    [0, 32768, 0], [5064, 25283, 2421], [25438, 7330, 0], [32768, 0, 0],
    [32768, 0, 0], [32768, 0, 0], [32768, 0, 0], [32768, 0, 0],
];

/// The same as the content of a block.
pub(super) const FIXED: [u8; HEAD + SCALE + 8 * FIXED_CODES.len()] = {
    let mut bytes = [0; HEAD + SCALE + 8 * FIXED_CODES.len()];
    bytes[1] = 16;
    bytes[2] = FIXED_CODES.len() as u8;
    let (mut n, mut code) = (0, HEAD + SCALE + 2 * FIXED_CODES.len());
    while n < FIXED_CODES.len() {
        [bytes[HEAD + 2 * n], bytes[HEAD + 2 * n + 1]] = (4000 + 200 * n as u16).to_le_bytes();
        let mut channel = 0;
        while channel < 3 {
            [bytes[code], bytes[code + 1]] = FIXED_CODES[n][channel].to_le_bytes();
            (code, channel) = (code + 2, channel + 1);
        }
        n += 1;
    }
    // The upper half of 2^-15.
    let [_, _, low, high] = (1.0f32 / 32_768.0).to_le_bytes();
    let scale = HEAD + 2 * FIXED_CODES.len();
    [bytes[scale + 2], bytes[scale + 3]] = [low, high];
    bytes
};

/// A linear map from linear sRGB to a spectrum: for each of its wavelengths a *column*, three numbers whose product with the colour
/// is the value there. It is linear between wavelengths and constant beyond. A map of one column takes the luminance alone.
///
/// It borrows its bytes, which are the content of the block `spec` of a `.srbf` file.
///
/// ```
/// use srbf_core::{SpectralColumns, SpectralMap};
///
/// // A laser: one wavelength, whose value is the luminance.
/// let mut bytes = [0; 16];
/// let length = SpectralMap::encode(&[905.0], SpectralColumns::Luminance(&[1.0]), 0.0, &mut bytes)?;
/// let map = SpectralMap::from_bytes(&bytes[..length])?;
/// assert_eq!((map.len(), map.wavelength(0), map.is_grey()), (1, Some(905.0), true));
/// # Ok::<(), srbf_core::FormatError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct SpectralMap<'a> {
    pub(super) content: &'a [u8],
}

/// Columns of a map, one for each wavelength.
#[derive(Clone, Copy, Debug)]
pub enum SpectralColumns<'a> {
    /// For linear sRGB; [-1e6, 1e6].
    Rgb(&'a [[f32; 3]]),
    /// For the luminance.
    Luminance(&'a [f32]),
}

impl SpectralColumns<'_> {
    pub(super) fn kind(&self) -> u8 {
        if let Self::Rgb(_) = self { RGB } else { GREY }
    }
    pub(super) fn numbers(&self) -> &[f32] {
        match self {
            Self::Rgb(columns) => columns.as_flattened(),
            Self::Luminance(columns) => columns,
        }
    }
}

/// Whether a number is at most [`MOST`] in size, and without `signs` 1 not below 0; false for NaN. Bits are compared, which takes less code.
fn is_within(number: f32, signs: u32) -> bool {
    (number.to_bits() & !(signs << 31)) <= MOST.to_bits()
}

/// Numbers of a column that are stored.
pub(super) const fn channels(kind: u8) -> usize {
    if kind == RGB { 3 } else { 1 }
}

impl SpectralMap<'static> {
    /// The map of materials that have none: the smoothest spectra that are the primaries of sRGB under D65, 400 to 700 nm. Colours of
    /// lights become spectra by it too. Its columns are 1 together at each wavelength.
    pub const FIXED: Self = Self { content: &FIXED };

    /// Bytes that [`encode`](Self::encode) writes for a number of wavelengths; `is_grey`: with one number a column.
    pub const fn encoded_len(wavelengths: usize, is_grey: bool) -> usize {
        HEAD + SCALE + 2 * wavelengths * (1 + channels(is_grey as u8))
    }
}

impl<'a> SpectralMap<'a> {
    /// Reads the content of a block, after checking every field once.
    ///
    /// # Errors
    /// [`FormatError::Field`], with the place in the content.
    pub fn from_bytes(content: &'a [u8]) -> Result<Self, FormatError> {
        let field = |name, offset| Err(FormatError::Field { name, offset });
        if content.len() < HEAD {
            return field("head of the spectra (cut off)", 0);
        }
        let [kind, bits, ..] = u32_at(content, 0).to_le_bytes();
        if kind > GREY {
            return field("kind of the spectra (0 or 1)", 0);
        }
        if ![8, 16].contains(&bits) {
            return field("bits of a code (8 or 16)", 1);
        }
        let count = usize::from(u16_at(content, 2));
        if !(1..=MAX_WAVELENGTHS).contains(&count) {
            return field("number of wavelengths", 2);
        }
        if !is_within(f32_at(content, 4), 0) {
            return field("error of the spectra", 4);
        }
        let scales = HEAD + 2 * count;
        if content.len() != scales + SCALE + usize::from(bits / 8) * channels(kind) * count {
            return field("length of the block of spectra", 2);
        }
        let mut previous = 0;
        for offset in (HEAD..scales).step_by(2) {
            let tenths = u16_at(content, offset);
            if tenths <= previous {
                return field("wavelength (must rise)", offset);
            }
            previous = tenths;
        }
        let scale = Scale::at(content, scales);
        let most = if bits == 8 { u16::from(u8::MAX) } else { u16::MAX };
        if scale.is_relative || ![0, most].iter().all(|code| is_within(scale.decode(*code, 0.0), 1)) {
            return field("scale of the spectra", scales);
        }
        Ok(Self { content })
    }

    /// The bytes that it was made from.
    pub fn bytes(&self) -> &'a [u8] {
        self.content
    }

    /// Number of its wavelengths, at least 1.
    #[expect(clippy::len_without_is_empty, reason = "no map is empty")]
    pub fn len(&self) -> usize {
        usize::from(u16_at(self.content, 2))
    }

    /// Whether it takes the luminance alone.
    pub fn is_grey(&self) -> bool {
        self.kind() == GREY
    }

    /// Relative L2 distance of the measured spectra from those of their colours.
    pub fn error(&self) -> f32 {
        f32_at(self.content, 4)
    }

    /// A wavelength in nm; `None` past the end.
    pub fn wavelength(&self, n: usize) -> Option<f32> {
        (n < self.len()).then(|| self.nm(n))
    }

    /// The column of a wavelength, for linear sRGB; `None` past the end.
    pub fn column(&self, n: usize) -> Option<[f32; 3]> {
        (n < self.len()).then(|| self.numbers(n))
    }

    /// The column at any wavelength in nm.
    pub fn column_at(&self, nm: f32) -> [f32; 3] {
        let (mut low, mut high) = (0, self.len() - 1);
        while low + 1 < high {
            let middle = low.midpoint(high);
            if self.nm(middle) <= nm { low = middle } else { high = middle }
        }
        let (from, to) = (self.nm(low), self.nm(high));
        // One wavelength alone makes it infinite, no number stays at the first.
        let share = if nm > from { ((nm - from) / (to - from)).min(1.0) } else { 0.0 };
        let [a, b] = [low, high].map(|n| self.numbers(n));
        [0, 1, 2].map(|c| a[c] + share * (b[c] - a[c]))
    }

    /// Bytes of the block that it is the content of.
    pub(super) fn block_len(self) -> usize {
        padded(BLOCK_HEAD + self.content.len())
    }

    fn kind(&self) -> u8 {
        u32_at(self.content, 0) as u8
    }

    /// A wavelength that is there.
    fn nm(&self, n: usize) -> f32 {
        f32::from(u16_at(self.content, HEAD + 2 * n)) * UNIT
    }

    /// The column of a wavelength that is there.
    fn numbers(&self, n: usize) -> [f32; 3] {
        let scales = HEAD + 2 * self.len();
        let (scale, codes) = (Scale::at(self.content, scales), scales + SCALE);
        let is_short = u32_at(self.content, 0) >> 8 & 0xff == 8;
        let number = |place: usize| {
            let code = if is_short {
                u16::from(part(self.content, codes + place..codes + place + 1).first().copied().unwrap_or(0))
            } else {
                u16_at(self.content, codes + 2 * place)
            };
            scale.decode(code, 0.0)
        };
        if self.kind() == RGB {
            [0, 1, 2].map(|channel| number(3 * n + channel))
        } else {
            LUMINANCE.map(|share| share * number(n))
        }
    }
}

/// The columns of a material at N wavelengths, which take its colours to values there.
///
/// [`Material::primaries`](crate::Material::primaries) has an example.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Primaries<const N: usize> {
    columns: [[f32; 3]; N],
}

impl<const N: usize> Primaries<N> {
    /// Of columns as [`columns`](Self::columns) gives them.
    pub const fn from_columns(columns: [[f32; 3]; N]) -> Self {
        Self { columns }
    }

    /// The values of a colour at the wavelengths: of a value, a weight or an albedo of the material. None is below 0.
    #[inline]
    pub fn of(&self, rgb: impl Into<Vec3>) -> [f32; N] {
        let rgb = rgb.into();
        self.columns.map(|column| Vec3::from_array(column).dot(rgb).max(0.0))
    }

    /// The three numbers of each wavelength whose product with a colour is the value.
    pub fn columns(&self) -> &[[f32; 3]; N] {
        &self.columns
    }
}
