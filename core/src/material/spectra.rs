//! The spectra of a material: its map, the primaries at some wavelengths, and their writing.

use super::borrowed::Material;
use super::bytes::{part, u32_at};
use super::codes::Scale;
use super::encode::Writer;
use super::format_error::FormatError;
use super::layout::{BLOCK_HEAD, BLOCKS, CHECKSUM, padded};
use super::spectral_map::{
    GREY, HEAD, LONGEST, MAX_WAVELENGTHS, MOST, Primaries, SpectralColumns, SpectralMap, UNIT, channels,
};

impl SpectralMap<'static> {
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
        Primaries::from_columns(wavelengths.map(|nm| map.column_at(nm)))
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
    use super::super::codes::SCALE;
    use super::super::spectral_map::FIXED;
    use super::*;
    use crate::LUMINANCE;
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
