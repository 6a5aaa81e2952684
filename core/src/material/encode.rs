//! Writes the bytes of a material.

use super::checksum::crc32;
use super::codes::{SCALE, Scale};
use super::factor_table::FactorTable;
use super::format_error::{FORMAT_VERSION, FormatError};
use super::layout::{
    AXIS_UNIT, BLOCK_HEAD, FACT, HEADER, Header, Kind, LOBE, MAGIC, MIRRORED, SPEC, Shape, TEXT,
};
use super::spectral_map::SpectralMap;
use super::validate::validate;
use super::views::{Grid, Line};

/// Bytes that [`Line::encode`] writes without factors, for `views` views of `lobes` lobes, the last
/// `mirrored` of which stand for two; of 1024 views and 64 lobes at most.
pub const fn encoded_len(views: usize, lobes: usize, mirrored: usize, provenance: &str) -> usize {
    Header { views, lobes, mirrored, provenance: provenance.len() as u32, ..Header::EMPTY }.placed().1
}

impl Line<'_> {
    fn header(&self, provenance: &str) -> (Header, usize) {
        let header = Header {
            views: self.views.len(),
            lobes: self.views.first().map_or(0, |v| v.lobes.len()),
            squeezed: self.squeezed,
            mirrored: self.mirrored,
            provenance: provenance.len() as u32,
            factors: FactorTable::shape(self.factors.as_ref()),
            has_signed_factors: self.factors.is_some_and(|table| table.is_signed),
            ..Header::EMPTY
        };
        header.placed()
    }

    /// Bytes that [`encode`](Self::encode) writes.
    pub fn encoded_len(&self, provenance: &str) -> usize {
        self.header(provenance).1
    }

    /// Writes a material as `.srbf` bytes and checks them as a reader would.
    ///
    /// Of the lobes of every view the first `squeezed` see the squeezed direction. Each of the last `mirrored` stands for two, one
    /// on either side of the plane of incidence; none is both. Shapes: `out` [[`encoded_len`](Self::encoded_len)], overwritten.
    /// Returns: the bytes written.
    ///
    /// # Errors
    /// [`FormatError::Buffer`] if `out` is too small; [`FormatError::Field`] for a value that has no place in
    /// a material.
    pub fn encode(&self, provenance: &str, out: &mut [u8]) -> Result<usize, FormatError> {
        let Self { views, squeezed, mirrored, factors } = *self;
        let (header, needed) = self.header(provenance);
        let lobes = header.lobes;
        if mirrored > lobes {
            return Err(FormatError::Field { name: "number of mirrored lobes", offset: MIRRORED });
        }
        factors.map_or(Ok(()), |table| table.check(views.len(), header.table))?;
        if out.len() < needed {
            return Err(FormatError::Buffer { needed, available: out.len() });
        }
        for (v, view) in views.iter().enumerate() {
            let field = |name, row| Err(FormatError::Field { name, offset: header.row(v, row) });
            if view.lobes.len() != lobes {
                return field("number of lobes of a view", 0);
            }
            if view.lobes[..lobes - mirrored].iter().any(|l| l.off_plane != 0.0) {
                return field("angle out of the plane of incidence", 5);
            }
        }
        let mut writer = Writer::new(out, 0, [views.len(), lobes, squeezed, mirrored, 0], needed, LOBE);
        views.iter().for_each(|view| writer.number(view.theta));
        for view in views {
            writer.number(view.log2_squeeze);
            writer.number(view.log2_diffuse);
            view.diffuse_color_differences.iter().for_each(|n| writer.number(*n));
        }
        for view in views {
            view.lobes.iter().for_each(|l| writer.number(l.angle));
            view.lobes.iter().for_each(|l| writer.number(l.log2_sharpness));
            view.lobes.iter().for_each(|l| writer.number(l.log2_luminance));
            for i in 0..2 {
                view.lobes.iter().for_each(|l| writer.number(l.color_differences[i]));
            }
            view.lobes[lobes - mirrored..].iter().for_each(|l| writer.number(l.off_plane));
        }
        writer.end(HEADER);
        if let Some(table) = factors {
            writer.factors(&table);
        }
        writer.finish(provenance, None)
    }
}

/// Puts bytes one behind the other into a buffer that is long enough.
pub(crate) struct Writer<'a> {
    pub(crate) out: &'a mut [u8],
    /// Bytes that have been put.
    pub(crate) at: usize,
}

impl<'a> Writer<'a> {
    /// Begins with the header: kind, length of the whole, and the fields that follow it; and with the block of lobes.
    pub(super) fn new(
        out: &'a mut [u8],
        kind: usize,
        fields: [usize; 5],
        length: usize,
        tag: [u8; 4],
    ) -> Self {
        let mut writer = Self::of_kind(out, kind, fields, length);
        let start = writer.begin(tag);
        debug_assert!(start == HEADER);
        writer
    }

    /// Begins with the header alone.
    pub(crate) fn of_kind(out: &'a mut [u8], kind: usize, fields: [usize; 5], length: usize) -> Self {
        let mut writer = Self { out: &mut out[..length], at: 0 };
        writer.put(&MAGIC);
        for n in [FORMAT_VERSION as usize, kind, length].into_iter().chain(fields) {
            writer.put(&u32::try_from(n).unwrap_or(u32::MAX).to_le_bytes());
        }
        writer
    }

    pub(crate) fn put(&mut self, bytes: &[u8]) {
        self.out[self.at..self.at + bytes.len()].copy_from_slice(bytes);
        self.at += bytes.len();
    }

    pub(super) fn number(&mut self, n: f32) {
        self.put(&n.to_le_bytes());
    }

    /// Begins a block; returns where its content starts.
    pub(crate) fn begin(&mut self, tag: [u8; 4]) -> usize {
        self.put(&tag);
        self.put(&[0; BLOCK_HEAD - 4]);
        self.at
    }

    /// Ends a block whose content starts at an offset: its length is known, and zeros follow.
    pub(crate) fn end(&mut self, start: usize) {
        let length = u32::try_from(self.at - start).unwrap_or(u32::MAX);
        self.out[start - 4..start].copy_from_slice(&length.to_le_bytes());
        while !self.at.is_multiple_of(4) {
            self.put(&[0]);
        }
    }

    /// A scale that has been written; scales start at an offset.
    pub(super) fn scale_at(&self, scales: usize, place: usize) -> Scale {
        Scale::at(self.out, scales + SCALE * place)
    }

    /// Writes the block of factors.
    pub(super) fn factors(&mut self, table: &FactorTable<'_>) {
        let largest = table.largest();
        let start = self.begin_factors(FactorTable::shape(Some(table)), table.is_signed);
        table.albedo_differences.iter().flatten().for_each(|n| self.number(*n));
        self.number(largest);
        table.factors.iter().for_each(|f| self.put(&FactorTable::node(f, largest)));
        self.end(start);
    }

    /// Begins the block of factors; returns where its content starts.
    pub(super) fn begin_factors(&mut self, shape: [u8; 3], is_signed: bool) -> usize {
        let start = self.begin(FACT);
        self.put(&shape);
        self.put(&[u8::from(is_signed)]);
        start
    }

    /// Ends with provenance, the spectra of colours and checksum, and checks the whole; returns its length.
    pub(super) fn finish(
        mut self,
        provenance: &str,
        spectra: Option<SpectralMap<'_>>,
    ) -> Result<usize, FormatError> {
        self.seal(provenance, spectra);
        validate(self.out)?;
        Ok(self.at)
    }

    /// Writes provenance, the spectra of colours and checksum.
    pub(crate) fn seal(&mut self, provenance: &str, spectra: Option<SpectralMap<'_>>) {
        let contents = [(TEXT, provenance.as_bytes()), (SPEC, spectra.map_or(&[][..], |map| map.bytes()))];
        for (tag, content) in contents.into_iter().filter(|(_, content)| !content.is_empty()) {
            let start = self.begin(tag);
            self.put(content);
            self.end(start);
        }
        let checksum = crc32(&self.out[..self.at]);
        self.put(&checksum.to_le_bytes());
    }
}

impl Grid<'_> {
    fn header(&self, provenance: &str) -> (Header, usize) {
        let axis = (self.axis / AXIS_UNIT + 0.5) as u16;
        let turns = u16::try_from(self.turns).unwrap_or(u16::MAX);
        let shape = Shape { thetas: self.thetas.len(), azimuths: self.azimuths, turns, axis };
        let header = Header {
            kind: Kind::Grid(shape),
            views: self.views.len(),
            lobes: self.views.first().map_or(0, |v| v.lobes.len()),
            squeezed: self.squeezed,
            provenance: provenance.len() as u32,
            factors: FactorTable::shape(self.factors.as_ref()),
            has_signed_factors: self.factors.is_some_and(|table| table.is_signed),
            ..Header::EMPTY
        };
        header.placed()
    }

    /// Bytes that [`encode`](Self::encode) writes.
    pub fn encoded_len(&self, provenance: &str) -> usize {
        self.header(provenance).1
    }

    /// Writes an anisotropic material as `.srbf` bytes and checks them as a reader would.
    ///
    /// Shapes: `out` [[`encoded_len`](Self::encoded_len)], overwritten. Returns: the bytes written.
    ///
    /// # Errors
    /// [`FormatError::Buffer`] if `out` is too small; [`FormatError::Field`] for a value that has no place in
    /// a material.
    pub fn encode(&self, provenance: &str, out: &mut [u8]) -> Result<usize, FormatError> {
        let (header, needed) = self.header(provenance);
        let Kind::Grid(shape) = header.kind else { return Ok(0) };
        self.factors.map_or(Ok(()), |table| table.check(self.views.len(), header.table))?;
        if out.len() < needed {
            return Err(FormatError::Buffer { needed, available: out.len() });
        }
        let field = |name, offset| Err(FormatError::Field { name, offset });
        let (thetas, lobes) = (self.thetas.len(), header.lobes);
        if !(0.0..core::f32::consts::PI).contains(&self.axis) {
            return field("axis", MIRRORED + 4);
        }
        let expected = self.azimuths.checked_mul(thetas.saturating_sub(1)).and_then(|n| n.checked_add(1));
        if thetas == 0 || expected != Some(self.views.len()) {
            return field("number of views", 20);
        }
        if self.views.iter().any(|view| view.lobes.len() != lobes) {
            return field("number of lobes of a view", 24);
        }
        let fields = [thetas, lobes, self.squeezed, self.azimuths, shape.turns_and_axis()];
        let mut writer = Writer::new(out, 1, fields, needed, LOBE);
        self.thetas.iter().for_each(|theta| writer.number(*theta));
        for view in self.views {
            let diffuse = [view.log2_diffuse].into_iter().chain(view.diffuse_color_differences);
            view.log2_squeeze.into_iter().chain(diffuse).for_each(|n| writer.number(n));
        }
        for view in self.views {
            for i in 0..2 {
                view.lobes.iter().for_each(|l| writer.number(l.tilt[i]));
            }
            view.lobes.iter().for_each(|l| writer.number(l.log2_sharpness));
            view.lobes.iter().for_each(|l| writer.number(l.log2_luminance));
            for i in 0..2 {
                view.lobes.iter().for_each(|l| writer.number(l.color_differences[i]));
            }
        }
        writer.end(HEADER);
        if let Some(table) = self.factors {
            writer.factors(&table);
        }
        writer.finish(provenance, None)
    }
}
