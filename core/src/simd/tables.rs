//! The numbers of tables of the same shape in bytes, as vectors. The shape is checked once, so that no vector has to be: a
//! kernel that reads ten vectors of a table would take as many instructions for their bounds as for their numbers.
#![allow(unsafe_code)]
#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use super::lanes::Lanes;

/// Two views of an isotropic material, four of an anisotropic one.
pub(crate) type TwoRows<'a> = Tables<'a, 2, ROWS>;
#[cfg(feature = "simd")]
pub(crate) type FourRows<'a> = Tables<'a, 4, GRID_ROWS>;

/// Rows of a view of an isotropic material.
pub(crate) const ROWS: usize = 5;

/// Rows of a view of an anisotropic material.
#[cfg(feature = "simd")]
const GRID_ROWS: usize = 6;

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
    /// Bytes that vectors reach of a table of a number of rows.
    #[inline(always)]
    pub fn bytes(self, rows: usize) -> usize {
        4 * ((rows - 1) * self.stride + AHEADS * self.ahead + self.width)
    }
}

/// Tables of `ROWS` rows.
#[derive(Clone, Copy)]
pub(crate) struct Tables<'a, const TABLES: usize, const ROWS: usize> {
    tables: [&'a [u8]; TABLES],
    shape: Shape,
}

impl<'a, const TABLES: usize, const ROWS: usize> Tables<'a, TABLES, ROWS> {
    /// Panics if a table is too short for its shape.
    #[inline(always)]
    pub fn new(tables: [&'a [u8]; TABLES], shape: Shape) -> Self {
        let mut is_fit = (shape.ahead | shape.stride | shape.width) <= 0xffff;
        let bytes = shape.bytes(ROWS);
        for i in 0..TABLES {
            is_fit &= bytes <= tables[i].len();
        }
        assert!(is_fit, "tables of this shape");
        Self { tables, shape }
    }

    /// Numbers of a row of all tables, `aheads` times those before the first row on, from the `k`-th on. Panics where that is
    /// no place of the shape.
    #[inline(always)]
    pub fn load<L: Lanes>(&self, row: usize, aheads: usize, k: usize) -> [L; TABLES] {
        assert!(row < ROWS && aheads <= AHEADS && k + L::COUNT <= self.shape.width, "a vector of the table");
        let from = 4 * (row * self.shape.stride + aheads * self.shape.ahead + k);
        let mut numbers = [L::splat(0.0); TABLES];
        for i in 0..TABLES {
            // SAFETY: by the first line the range ends at `shape.bytes()` at most. No table is shorter, and that number is small, as
            // `new` has seen.
            numbers[i] = L::load_bytes(unsafe { self.tables[i].get_unchecked(from..from + 4 * L::COUNT) });
        }
        numbers
    }
}
