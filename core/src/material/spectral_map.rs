//! From colours to spectra: the map that the block `spec` stores, and the fixed one of materials without it.

use super::borrowed::Material;
use super::bytes::{f32_at, part, u16_at, u32_at};
use super::codes::{SCALE, Scale};
use super::encode::Writer;
use super::format_error::FormatError;
use super::layout::{BLOCK_HEAD, BLOCKS, CHECKSUM, padded};
use crate::color::LUMINANCE;
use glam::Vec3;

/// Most wavelengths that a map has.
pub const MAX_WAVELENGTHS: usize = 1024;

/// Bytes before the wavelengths: kind, bits, their number, the error.
const HEAD: usize = 8;

/// The unit of wavelengths, nm.
const UNIT: f32 = 0.1;

/// The longest wavelength, nm.
const LONGEST: f32 = 6553.5;

/// Largest magnitude of a number of a column, and largest error.
const MOST: f32 = 1e6;

/// Kinds: columns for red, green and blue, or one for the luminance.
const RGB: u8 = 0;
const GREY: u8 = 1;

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
const FIXED: [u8; HEAD + SCALE + 8 * FIXED_CODES.len()] = {
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
    content: &'a [u8],
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
    fn kind(&self) -> u8 {
        if let Self::Rgb(_) = self { RGB } else { GREY }
    }
    fn numbers(&self) -> &[f32] {
        match self {
            Self::Rgb(columns) => columns.as_flattened(),
            Self::Luminance(columns) => columns,
        }
    }
}

/// Numbers of a column that are stored.
const fn channels(kind: u8) -> usize {
    if kind == RGB { 3 } else { 1 }
}

impl SpectralMap<'static> {
    const FIXED: Self = Self { content: &FIXED };

    /// Bytes that [`encode`](Self::encode) writes for so many wavelengths; `is_grey`: with one number a column.
    pub const fn encoded_len(wavelengths: usize, is_grey: bool) -> usize {
        HEAD + SCALE + 2 * wavelengths * (1 + channels(is_grey as u8))
    }

    /// Writes a map, with 16 bits a number. Wavelengths are in nm, rising, rounded to tenths; `error` is the relative L2 distance of the
    /// measured spectra from those of their colours.
    ///
    /// Shapes: `out` [[`encoded_len`](Self::encoded_len)], overwritten. Returns: the bytes written.
    ///
    /// # Errors
    /// [`FormatError::Buffer`] if `out` is too small; [`FormatError::Field`] for a number that has no place in a map, with its
    /// place in the block.
    pub fn encode(
        wavelengths: &[f32],
        columns: SpectralColumns<'_>,
        error: f32,
        out: &mut [u8],
    ) -> Result<usize, FormatError> {
        let (kind, numbers) = (columns.kind(), columns.numbers());
        let needed = Self::encoded_len(wavelengths.len(), kind == GREY);
        if numbers.len() != channels(kind) * wavelengths.len() || wavelengths.len() > MAX_WAVELENGTHS {
            return Err(FormatError::Field { name: "number of wavelengths", offset: 2 });
        }
        if out.len() < needed {
            return Err(FormatError::Buffer { needed, available: out.len() });
        }
        let scales = HEAD + 2 * wavelengths.len();
        // False for NaN too, which a code would hide.
        if !wavelengths.iter().all(|nm| (UNIT..=LONGEST).contains(nm)) {
            return Err(FormatError::Field { name: "wavelength (0.1 to 6553.5 nm)", offset: HEAD });
        }
        if !numbers.iter().all(|n| n.abs() <= 0.9 * MOST) {
            return Err(FormatError::Field { name: "column of a wavelength", offset: scales });
        }
        let mut bytes = Writer { out: &mut out[..needed], at: 0 };
        bytes.put(&[kind, 16]);
        bytes.put(&(wavelengths.len() as u16).to_le_bytes());
        bytes.number(error);
        wavelengths.iter().for_each(|nm| bytes.put(&((nm / UNIT + 0.5) as u16).to_le_bytes()));
        let scale = Scale::over(numbers.iter().copied(), u16::MAX);
        bytes.put(&scale.to_bytes());
        for number in numbers {
            bytes.put(&scale.encode(*number, 0.0, u16::MAX, (-MOST, MOST)).to_le_bytes());
        }
        SpectralMap::from_bytes(&out[..needed])?;
        Ok(needed)
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
        // False for NaN too.
        if !(0.0..=MOST).contains(&f32_at(content, 4)) {
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
        // False for NaN too.
        if scale.is_relative || ![0, most].iter().all(|code| scale.decode(*code, 0.0).abs() <= MOST) {
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
/// [`Material::primaries`] has an example.
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

impl<B: AsRef<[u8]>> Material<B> {
    /// Whether the material has a map from its colours to spectra, as fits of measured wavelengths have.
    pub fn has_spectrum(&self) -> bool {
        self.header().spectrum > 0
    }

    /// The map from its colours to spectra, as it is stored; `None` without one.
    pub fn spectral_map(&self) -> Option<SpectralMap<'_>> {
        let start = self.header().spectrum as usize;
        let content = || part(self.bytes(), start..start + u32_at(self.bytes(), start - 4) as usize);
        self.has_spectrum().then(|| SpectralMap { content: content() })
    }

    /// The columns at some wavelengths in nm, of any number and order, once for a path: then [`Primaries::of`] for each value on it.
    ///
    /// Densities and draws are those of the colours. A material without a map has fixed smooth columns, which are 1 together:
    /// those of the primaries of sRGB.
    ///
    /// ```
    /// # use srbf_core::{Line, Material, Mixture, PlaneLobe, View};
    /// # let grey = [0.0; 2];
    /// # let lobe = PlaneLobe { angle: 0.0, off_plane: 0.0, log2_sharpness: 5.0, log2_luminance: -1.0, color_differences: grey };
    /// # let view = View { theta: 0.0, log2_squeeze: 0.0, log2_diffuse: -3.0, diffuse_color_differences: grey, lobes: &[lobe] };
    /// # let line = Line { views: &[view], squeezed: 0, mirrored: 0, factors: None };
    /// # let mut bytes = [0; 256];
    /// # let length = line.encode("an example", &mut bytes)?;
    /// # let material = Material::from_bytes(&bytes[..length])?;
    /// # let mut mixture = Mixture::<16>::empty();
    /// // Once for a path, which carries four wavelengths.
    /// let primaries = material.primaries(&[420.0, 500.0, 580.0, 660.0]);
    /// // At every hit.
    /// material.prepare([0.6, 0.0, 0.8], &mut mixture)?;
    /// let value = mixture.evaluate([0.0, 0.6, 0.8]);
    /// let spectrum = primaries.of(value);
    /// // The material is grey.
    /// assert!(!material.has_spectrum() && spectrum.iter().all(|v| (v / value.x - 1.0).abs() < 1e-5));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn primaries<const N: usize>(&self, wavelengths: &[f32; N]) -> Primaries<N> {
        let map = self.spectral_map().unwrap_or(SpectralMap::FIXED);
        Primaries { columns: wavelengths.map(|nm| map.column_at(nm)) }
    }

    /// Bytes that [`with_spectral_map`](Self::with_spectral_map) writes.
    pub fn with_spectral_map_len(&self, map: SpectralMap<'_>) -> usize {
        self.bytes().len() - self.spectral_map().map_or(0, SpectralMap::block_len) + map.block_len()
    }

    /// Writes the material with a map in place of the one that it may have; all else keeps its bytes.
    ///
    /// Shapes: `out` [[`with_spectral_map_len`](Self::with_spectral_map_len)], overwritten. Returns: the bytes written.
    ///
    /// # Errors
    /// [`FormatError::Buffer`] if `out` is too small; [`FormatError::Field`] for bytes of version 1 or 2, which have no blocks.
    pub fn with_spectral_map(&self, map: SpectralMap<'_>, out: &mut [u8]) -> Result<usize, FormatError> {
        let (bytes, needed) = (self.bytes(), self.with_spectral_map_len(map));
        if u32_at(bytes, 8) < 3 {
            return Err(FormatError::Field { name: "version (3 has room for spectra)", offset: 8 });
        }
        if out.len() < needed {
            return Err(FormatError::Buffer { needed, available: out.len() });
        }
        let mut to = Writer { out: &mut out[..needed], at: 0 };
        to.put(&bytes[..16]);
        to.put(&u32::try_from(needed).unwrap_or(u32::MAX).to_le_bytes());
        to.put(&bytes[20..BLOCKS]);
        let mut at = BLOCKS;
        while at < bytes.len() - CHECKSUM {
            let next = padded(at + BLOCK_HEAD + u32_at(bytes, at + 4) as usize);
            if at + BLOCK_HEAD != self.header().spectrum as usize {
                to.put(&bytes[at..next]);
            }
            at = next;
        }
        to.finish("", Some(map))
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::{Line, PackOptions, PlaneLobe, View};
    use std::vec;
    use std::vec::Vec;

    fn map(wavelengths: &[f32], columns: SpectralColumns<'_>) -> Result<Vec<u8>, FormatError> {
        let mut bytes = vec![0; SpectralMap::encoded_len(wavelengths.len(), columns.kind() == GREY)];
        SpectralMap::encode(wavelengths, columns, 0.02, &mut bytes).map(|_| bytes)
    }

    fn material(provenance: &str) -> Vec<u8> {
        let lobe = PlaneLobe {
            angle: 0.0,
            off_plane: 0.0,
            log2_sharpness: 3.0,
            log2_luminance: -1.0,
            color_differences: [0.5, -0.5],
        };
        let view = View {
            theta: 0.0,
            log2_squeeze: 0.0,
            log2_diffuse: -3.0,
            diffuse_color_differences: [0.0; 2],
            lobes: &[lobe; 3],
        };
        let line = Line { views: &[view], squeezed: 0, mirrored: 0, factors: None };
        let mut bytes = vec![0; line.encoded_len(provenance)];
        line.encode(provenance, &mut bytes).unwrap();
        bytes
    }

    fn with(bytes: &[u8], map: &[u8]) -> Vec<u8> {
        let (material, map) = (Material::from_bytes(bytes).unwrap(), SpectralMap::from_bytes(map).unwrap());
        let mut out = vec![0; material.with_spectral_map_len(map)];
        assert_eq!(material.with_spectral_map(map, &mut out), Ok(out.len()));
        assert!(material.with_spectral_map(map, &mut out[1..]).is_err());
        out
    }

    const THREE: [f32; 3] = [450.0, 532.1, 2500.0];
    const COLUMNS: [[f32; 3]; 3] = [[0.1, -0.2, 1.1], [0.0, 0.9, 0.3], [2.0, 0.5, 0.25]];

    #[test]
    fn a_map_comes_back_within_its_codes() {
        let bytes = map(&THREE, SpectralColumns::Rgb(&COLUMNS)).unwrap();
        let found = SpectralMap::from_bytes(&bytes).unwrap();
        assert_eq!((found.len(), found.is_grey(), found.error()), (3, false, 0.02));
        for (n, (nm, column)) in THREE.iter().zip(COLUMNS).enumerate() {
            assert!((found.wavelength(n).unwrap() - nm).abs() < 1e-3);
            let apart = (0..3).map(|c| (found.column(n).unwrap()[c] - column[c]).abs());
            assert!(apart.fold(0.0, f32::max) < 2.0 * 2.2 / 65_535.0);
        }
        assert_eq!((found.wavelength(3), found.column(3)), (None, None));
        // Between wavelengths and beyond them; no number is the first.
        let [a, b] = [found.column(0).unwrap()[1], found.column(1).unwrap()[1]];
        assert!((found.column_at(450.0 + 0.25 * 82.1)[1] - (0.75 * a + 0.25 * b)).abs() < 1e-6);
        for (nm, n) in
            [(0.0, 0), (450.0, 0), (f32::NAN, 0), (-1.0, 0), (9e9, 2), (f32::INFINITY, 2), (2500.0, 2)]
        {
            assert_eq!(found.column_at(nm), found.column(n).unwrap(), "{nm}");
        }
        let laser = map(&[905.0], SpectralColumns::Luminance(&[1.0])).unwrap();
        let laser = SpectralMap::from_bytes(&laser).unwrap();
        assert_eq!((laser.len(), laser.wavelength(0), laser.column(0)), (1, Some(905.0), Some(LUMINANCE)));
        for nm in [f32::NAN, 400.0, 905.0, 1e9, f32::INFINITY] {
            assert_eq!(laser.column_at(nm), LUMINANCE);
        }
        // As other writers may have it: codes of 8 bits.
        let mut short = map(&THREE, SpectralColumns::Luminance(&[0.5; 3])).unwrap();
        short[1] = 8;
        short.truncate(HEAD + 6 + SCALE);
        short.extend([0, 128, 255]);
        short[HEAD + 8..HEAD + 10].copy_from_slice(&[0x80, 0x3b]);
        let short = SpectralMap::from_bytes(&short).unwrap();
        let red = [0, 1, 2].map(|n| short.column(n).unwrap()[0] / LUMINANCE[0]);
        let expected = [0.5, 0.5 + 128.0 / 256.0, 0.5 + 255.0 / 256.0];
        assert!(red.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{red:?}");
    }

    #[test]
    fn numbers_that_no_map_has_are_refused_with_their_place() {
        let bytes = map(&THREE, SpectralColumns::Rgb(&COLUMNS)).unwrap();
        let scales = HEAD + 6;
        for (offset, put, place) in [
            (0, &[2][..], 0),
            (0, &[1], 2),
            (1, &[9], 1),
            (1, &[8], 2),
            (2, &[0, 0], 2),
            (2, &[4, 0], 2),
            (2, &[1, 4], 2),
            (4, &f32::NAN.to_le_bytes(), 4),
            (4, &f32::INFINITY.to_le_bytes(), 4),
            (4, &(-0.1f32).to_le_bytes(), 4),
            (8, &[0, 0], 8),
            (10, &[0x94, 0x11], 10),
            (12, &[1, 0], 12),
            (scales, &[0xc0, 0x7f], scales),
            (scales, &[0x80, 0xff], scales),
            (scales + 2, &[0xc0, 0x7f], scales),
            (scales + 2, &[0, 0x60], scales),
            (scales + 2, &[0, 0xb8], scales),
        ] {
            let mut damaged = bytes.clone();
            damaged[offset..offset + put.len()].copy_from_slice(put);
            let refused = SpectralMap::from_bytes(&damaged).err();
            let is_there = matches!(refused, Some(FormatError::Field { offset, .. }) if offset == place);
            assert!(is_there, "{offset}: {put:?} {refused:?}");
        }
        for length in 0..bytes.len() {
            assert!(SpectralMap::from_bytes(&bytes[..length]).is_err(), "{length}");
        }
        let grey = SpectralColumns::Luminance(&[1.0; 3]);
        for odd in
            [&[450.0, 450.01, 500.0][..], &[500.0, 450.0, 600.0], &[500.0, f32::NAN, 600.0], &[0.0, 1.0, 2.0]]
        {
            assert!(map(odd, grey).is_err(), "{odd:?}");
        }
        for odd in [&[500.0][..], &[500.0, 600.0, 6554.0], &[-1.0, 500.0, 600.0]] {
            assert!(map(odd, grey).is_err(), "{odd:?}");
        }
        for odd in [f32::NAN, f32::INFINITY, -1e7] {
            assert!(map(&THREE, SpectralColumns::Luminance(&[1.0, odd, 1.0])).is_err(), "{odd}");
        }
        assert!(map(&[], SpectralColumns::Luminance(&[])).is_err());
        let many: Vec<f32> = (0..=MAX_WAVELENGTHS).map(|n| 400.0 + n as f32).collect();
        let ones = vec![1.0; many.len()];
        assert!(map(&many, SpectralColumns::Luminance(&ones)).is_err());
        assert!(map(&many[1..], SpectralColumns::Luminance(&ones[1..])).is_ok());
        assert!(SpectralMap::encode(&THREE, grey, 0.0, &mut [0; 8]).is_err());
    }

    /// Whoever skips the block reads the same material; packed and unpacked ones have it too.
    #[test]
    fn a_material_keeps_its_bytes_and_its_map() {
        let bytes = map(&THREE, SpectralColumns::Rgb(&COLUMNS)).unwrap();
        let laser = map(&[905.0], SpectralColumns::Luminance(&[1.0])).unwrap();
        for provenance in ["", "made here"] {
            let plain = material(provenance);
            let spectral = with(&plain, &bytes);
            assert_eq!(spectral.len(), plain.len() + BLOCK_HEAD + padded(bytes.len()));
            let kept = plain.len() - CHECKSUM;
            assert_eq!((&plain[..16], &plain[20..kept]), (&spectral[..16], &spectral[20..kept]));
            assert_eq!(with(&with(&plain, &laser), &bytes), spectral);

            let found = Material::from_bytes(&spectral[..]).unwrap();
            assert!(found.has_spectrum() && !Material::from_bytes(&plain[..]).unwrap().has_spectrum());
            assert_eq!(found.spectral_map().unwrap().bytes(), bytes);
            assert_eq!(found.provenance(), provenance);
            for bits in [8, 16] {
                let options = PackOptions { bits, channels: 3 };
                let mut packed = vec![0; found.packed_len(options, "packed")];
                assert_eq!(found.pack(options, "packed", &mut packed), Ok(packed.len()));
                let packed = Material::from_bytes(packed).unwrap();
                assert_eq!(packed.spectral_map().unwrap().bytes(), bytes);
                let mut unpacked = vec![0; packed.unpacked_len()];
                assert_eq!(packed.unpack(&mut unpacked), Ok(unpacked.len()));
                assert_eq!(Material::from_bytes(unpacked).unwrap().spectral_map().unwrap().bytes(), bytes);
            }
            // A reader that does not know the tag skips the block; a second one of it is refused.
            let mut renamed = spectral.clone();
            renamed[kept..kept + 4].copy_from_slice(b"sqec");
            let unknown = resealed(&renamed);
            assert!(!Material::from_bytes(&unknown[..]).unwrap().has_spectrum());
            let twice = [&spectral[..spectral.len() - CHECKSUM], &spectral[kept..]].concat();
            assert!(matches!(
                Material::from_bytes(resealed(&twice)),
                Err(FormatError::Field { offset, .. }) if offset == spectral.len() - CHECKSUM
            ));
            // Places of errors are those of the file.
            let mut damaged = spectral.clone();
            damaged[kept + BLOCK_HEAD + 4..kept + BLOCK_HEAD + 8].copy_from_slice(&f32::NAN.to_le_bytes());
            assert!(matches!(
                Material::from_bytes(resealed(&damaged)),
                Err(FormatError::Field { offset, .. }) if offset == kept + BLOCK_HEAD + 4
            ));
        }
    }

    /// Bytes with the length and the checksum that fit.
    fn resealed(bytes: &[u8]) -> Vec<u8> {
        let mut bytes = bytes.to_vec();
        let (length, end) = (bytes.len() as u32, bytes.len() - CHECKSUM);
        bytes[16..20].copy_from_slice(&length.to_le_bytes());
        let sum = super::super::checksum::crc32(&bytes[..end]);
        bytes[end..].copy_from_slice(&sum.to_le_bytes());
        bytes
    }

    #[test]
    fn fixed_primaries_are_one_together_and_no_value_is_negative() {
        let plain = Material::from_bytes(material("")).unwrap();
        for step in 0..70 {
            let nm = 300.0 + 10.0 * step as f32;
            let primaries = plain.primaries(&[nm]);
            let [column] = *primaries.columns();
            assert!((column.iter().sum::<f32>() - 1.0).abs() < 1e-6, "{nm}: {column:?}");
            assert!(column.iter().all(|v| (0.0..=1.0).contains(v)));
            let [white] = primaries.of([0.5; 3]);
            assert!((white - 0.5).abs() < 1e-6, "{nm}: {white}");
        }
        assert!(SpectralMap::from_bytes(&FIXED).is_ok());
        let [blue, green, red] = plain.primaries(&[440.0, 540.0, 640.0]).of([0.2, 0.4, 0.6]);
        assert!((blue - 0.6).abs() < 0.02 && (green, red) == (0.4, 0.2), "{blue} {green} {red}");

        let bytes = map(&THREE, SpectralColumns::Rgb(&COLUMNS)).unwrap();
        let spectral = Material::from_bytes(with(&material(""), &bytes)).unwrap();
        let values = spectral.primaries(&[450.0, 2500.0, 9000.0]).of([0.0, 1.0, 0.0]);
        assert!(values[0] == 0.0 && (values[1] - 0.5).abs() < 1e-4 && values[2] == values[1], "{values:?}");
    }
}
