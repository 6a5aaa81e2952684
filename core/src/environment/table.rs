//! How an environment lies in memory.
//!
//! # Cells
//! A map has the radiance at the centres of its pixels. A *cell* lies between four centres, and in it the
//! radiance is bilinear in the azimuth and in the height z. So it is bilinear over the solid angle, `dz
//! dphi`, and so is its luminance, which over the [power](Environment::power) is the density: both are
//! continuous, and a cell's part of the power is the mean of its corners times its solid angle. Above the
//! first row of centres and below the last, a row of cells reaches to the pole, with the radiance of that
//! row.
//!
//! # Words
//! Chunks of sixteen u32, 64 bytes: a cache line, if the first is at a multiple of that.
//!
//! ```text
//! head     magic, width, height, bits of the power, checksum in two words
//! rows     from the pole to the equator, four words each: bits of the depth 1 - |z| at the upper edge, of
//!          how much deeper the lower one is, and of the inverse of that
//! cells    from the top row down, each from the left:
//!            own colours    bits of the scale, then red, green, blue of the corners, two in a word
//!            the other's    the same, of the cell that the alias table names
//!            its place      column, row
//!            threshold      bits of the share of draws that stay in the cell
//! ```
//!
//! A corner's channel is its scale times a whole number up to 65535: radiance over the power, 1/sr. A draw
//! hits a cell by a uniform number, and stays there or goes to the other (Walker 1977). As the colours of
//! both are at hand, it reads one cache line.

use crate::error::Error;
use crate::simd::prefetch;
use bytemuck::cast_ref;

/// Words of a cell.
pub(super) const WORDS: usize = 16;

/// One cell.
pub(super) type Cell = [u32; WORDS];

/// One row: upper edge, height, inverse of that, nothing; all as bits.
pub(super) type Row = [u32; 4];

/// What every table begins with; of other bytes on a processor of the other byte order.
pub(super) const MAGIC: u32 = u32::from_le_bytes(*b"srbE");

/// Words of the colours of a cell.
pub(super) const COLORS: usize = 7;

/// Where the place of the other cell stands, and the threshold.
pub(super) const PLACE: usize = 14;
pub(super) const THRESHOLD: usize = 15;

/// Largest code of a channel.
pub(super) const LARGEST_CODE: f32 = 65535.0;

/// Most pixels that a map may have, 8192 x 4096: its table takes 2 GB.
pub const MAX_ENVIRONMENT_PIXELS: usize = 1 << 25;

/// The checksum of the words behind the head, and of the numbers of the head: FNV-1a (Fowler, Noll and Vo 1991) of
/// whole words. Each step is one to one, so that a change of one word is always seen.
pub(super) fn checksum(shape: Shape, power: f32, words: &[u32]) -> [u32; 2] {
    let head = [shape.width as u32, shape.height as u32, power.to_bits()];
    let mut sum = 0xcbf2_9ce4_8422_2325_u64;
    for &word in head.iter().chain(words) {
        sum = (sum ^ u64::from(word)).wrapping_mul(0x0100_0000_01b3);
    }
    [sum as u32, (sum >> 32) as u32]
}

/// The size of a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shape {
    pub width: usize,
    pub height: usize,
}

impl Shape {
    pub const fn new(width: usize, height: usize) -> Result<Self, Error> {
        if width == 0 || height == 0 || width > 65535 || height > 65535 {
            return Err(Error::MapSize);
        }
        match width.checked_mul(height) {
            Some(pixels) if pixels <= MAX_ENVIRONMENT_PIXELS => Ok(Self { width, height }),
            _ => Err(Error::MapSize),
        }
    }

    /// Rows of cells of one hemisphere; a row on the equator counts for both.
    pub const fn rows(self) -> usize {
        self.height / 2 + 1
    }

    pub const fn row_chunks(self) -> usize {
        self.rows().div_ceil(4)
    }

    pub const fn cells(self) -> usize {
        (self.height + 1) * self.width
    }

    pub const fn words(self) -> usize {
        (1 + self.row_chunks() + self.cells()) * WORDS
    }
}

/// The number of u32 of the table of a map with a number of pixels: 64 bytes a pixel, those of one row more, and a
/// little. Up to 15 more than are used, for cells to begin at multiples of 64 bytes wherever the memory does.
///
/// # Errors
/// [`Error::MapSize`] for a size that no map may have: width or height 0 or above 65535, or more than
/// [`MAX_ENVIRONMENT_PIXELS`] pixels.
pub const fn environment_len(width: usize, height: usize) -> Result<usize, Error> {
    match Shape::new(width, height) {
        Ok(shape) => Ok(shape.words() + WORDS - 1),
        Err(error) => Err(error),
    }
}

/// Light from infinitely far away, a latitude-longitude map, read in place from memory that it borrows (`M` =
/// `&[u32]`) or owns (`Vec<u32>`, an array).
///
/// Row 0 of the map looks up, along +z. The centre of the map looks along +x. To the right in the map is to the right for an
/// observer inside, towards -y. [`turned`](Self::turned) turns the map.
///
/// Between the centres of pixels the radiance is interpolated, linearly in the azimuth and in the height z.
/// The density of [`sample`](Self::sample) is the luminance of that over its integral, the
/// [`power`](Self::power): a sample's `radiance / pdf` has constant luminance.
///
/// Radiance is held with an error of at most 8e-6 of the largest channel of the four pixels around a
/// direction. A direction is placed by polynomials; what f32 leaves of its digits moves it by up to 3e-7 of a
/// turn.
///
/// ```
/// use srbf_core::{Environment, Vec3, environment_len};
///
/// // A map of 4 x 2 pixels, the sky brighter than the ground. The top row comes first.
/// let map = [[2.0, 2.0, 3.0], [2.0; 3], [2.0; 3], [2.0; 3], [0.5; 3], [0.5; 3], [0.5; 3], [0.5; 3]];
/// let memory = vec![0; environment_len(4, 2)?];
/// let environment = Environment::new(4, &map, memory)?;
///
/// let sample = environment.sample([0.3, 0.6, 0.1]);
/// assert!((environment.pdf(sample.direction) / sample.pdf - 1.0).abs() < 1e-5);
/// assert!((environment.radiance(Vec3::NEG_Z).x - 0.5).abs() < 1e-4);
///
/// // The stored table is read back, and checked once.
/// let stored = environment.table().to_vec();
/// let again = Environment::from_table(stored)?;
/// assert_eq!(again.sample([0.3, 0.6, 0.1]), sample);
/// # Ok::<(), srbf_core::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Environment<M = &'static [u32]> {
    memory: M,
    /// The first word of the table.
    start: usize,
    shape: Shape,
    power: f32,
    /// The rotation of the map, in turns, in [0, 1).
    turn: f32,
}

impl<M: AsRef<[u32]>> Environment<M> {
    pub(super) fn of_table(memory: M, start: usize, shape: Shape, power: f32) -> Self {
        Self { memory, start, shape, power, turn: 0.0 }
    }

    /// Turns the map round +z, anticlockwise seen from above, from where it lay when it was made; radians.
    /// An angle that is not finite turns nothing.
    #[must_use]
    pub fn turned(self, radians: f32) -> Self {
        let turns = f64::from(radians) / core::f64::consts::TAU;
        let turn = (turns - libm::floor(turns)) as f32;
        // Just below 0 it rounds to 1.
        Self { turn: if turn < 1.0 { turn } else { 0.0 }, ..self }
    }

    /// The table, for the caller to store: what [`from_table`](Self::from_table) reads. It does not hold the
    /// turn.
    pub fn table(&self) -> &[u32] {
        &self.memory.as_ref()[self.start..][..self.shape.words()]
    }

    /// Columns of the map.
    pub fn width(&self) -> usize {
        self.shape.width
    }

    /// Rows of the map.
    pub fn height(&self) -> usize {
        self.shape.height
    }

    /// Integral of the luminance over the sphere: that of every sample's `radiance / pdf`.
    pub fn power(&self) -> f32 {
        self.power
    }

    /// The same, of memory that it borrows.
    #[inline(always)]
    pub(super) fn by_reference(&self) -> Environment<&[u32]> {
        let Self { memory, start, shape, power, turn } = self;
        Environment { memory: memory.as_ref(), start: *start, shape: *shape, power: *power, turn: *turn }
    }

    /// What kernels read.
    #[inline(always)]
    pub(super) fn borrowed(&self) -> Table<'_> {
        let (chunks, _) = self.table().as_chunks::<WORDS>();
        let (rows, cells) = chunks[1..].split_at(self.shape.row_chunks());
        let (rows, _) = rows.as_flattened().as_chunks::<4>();
        Table {
            rows: &rows[..self.shape.rows()],
            cells,
            shape: self.shape,
            power: self.power,
            turn: self.turn,
        }
    }
}

/// What kernels read of an environment, whoever owns its memory.
#[derive(Clone, Copy)]
pub(crate) struct Table<'a> {
    pub(super) rows: &'a [Row],
    pub(super) cells: &'a [Cell],
    pub(super) shape: Shape,
    pub(super) power: f32,
    pub(super) turn: f32,
}

impl Table<'_> {
    /// Asks for a cell that will be read soon.
    #[inline(always)]
    pub(super) fn prefetch(&self, cell: usize) {
        prefetch(&self.cells[cell]);
    }
}

/// The colours of a cell at its corners, as they are stored.
#[derive(Clone, Copy)]
pub(super) struct Colors<'a> {
    /// The unit of a code.
    pub scale: f32,
    /// Red, green and blue at upper left, upper right, lower left, lower right.
    pub codes: &'a [[u16; 4]; 3],
}

impl<'a> Colors<'a> {
    /// Of the cell itself, or of the other one.
    #[inline(always)]
    pub fn new(cell: &'a Cell, is_other: bool) -> Self {
        let from = if is_other { COLORS } else { 0 };
        let words: &[u32; 6] = cell[from + 1..].first_chunk().expect("colours within the cell");
        Self { scale: f32::from_bits(cell[from]), codes: cast_ref(words) }
    }
}
