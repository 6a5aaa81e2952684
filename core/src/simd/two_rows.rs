//! The numbers of two tables of the same shape in bytes, as vectors. The shape is checked once, so that no vector has to be: a
//! kernel that reads ten vectors of a table would take as many instructions for their bounds as for their numbers.
#![allow(unsafe_code)]

use super::lanes::Lanes;

/// Rows of a table.
pub(crate) const ROWS: usize = 5;

/// Most numbers that are left out before a number of a row, in units of those ahead of it.
const AHEADS: usize = 2;

/// Where the numbers of a table stand.
#[derive(Clone, Copy)]
pub(crate) struct Shape {
    /// Numbers before the first row.
    pub ahead: usize,
    /// Numbers from one row to the next.
    pub stride: usize,
    /// Numbers of a row that vectors reach.
    pub width: usize,
}

impl Shape {
    /// Bytes that vectors reach.
    #[inline(always)]
    pub fn bytes(self) -> usize {
        4 * ((ROWS - 1) * self.stride + AHEADS * self.ahead + self.width)
    }
}

/// Two tables.
#[derive(Clone, Copy)]
pub(crate) struct TwoRows<'a> {
    tables: [&'a [u8]; 2],
    shape: Shape,
}

impl<'a> TwoRows<'a> {
    /// Panics if a table is too short for its shape.
    #[inline(always)]
    pub fn new(tables: [&'a [u8]; 2], shape: Shape) -> Self {
        let is_small = (shape.ahead | shape.stride | shape.width) <= 0xffff;
        let bytes = shape.bytes();
        assert!(is_small && bytes <= tables[0].len() && bytes <= tables[1].len(), "tables of this shape");
        Self { tables, shape }
    }

    /// Numbers of a row of both tables, `aheads` times those before the first row on, from the `k`-th on. Panics where that is
    /// no place of the shape.
    #[inline(always)]
    pub fn load<L: Lanes>(&self, row: usize, aheads: usize, k: usize) -> [L; 2] {
        assert!(row < ROWS && aheads <= AHEADS && k + L::COUNT <= self.shape.width, "a vector of the table");
        let from = 4 * (row * self.shape.stride + aheads * self.shape.ahead + k);
        let (range, [a, b]) = (from..from + 4 * L::COUNT, self.tables);
        // SAFETY: by the first line the range ends at `shape.bytes()` at most. No table is shorter, and that number is small, as `new`
        // has seen.
        let (a, b) = unsafe { (a.get_unchecked(range.clone()), b.get_unchecked(range)) };
        [L::load_bytes(a), L::load_bytes(b)]
    }
}
