//! Slices that a batch reads and writes: structures of arrays, all of one length, a block of hits at a time.

use crate::error::Error;
use crate::simd::lanes::{Numbers, WIDEST};

/// The one length of all slices.
pub(crate) fn same_length(lengths: impl IntoIterator<Item = usize>) -> Result<usize, Error> {
    let mut lengths = lengths.into_iter();
    let first = lengths.next().unwrap_or(0);
    if lengths.all(|n| n == first) { Ok(first) } else { Err(Error::Length) }
}

/// The one length of three slices.
#[inline(always)]
pub(crate) fn one_length([x, y, z]: &[&[f32]; 3]) -> Result<usize, Error> {
    if (x.len() ^ y.len()) | (x.len() ^ z.len()) == 0 { Ok(x.len()) } else { Err(Error::Length) }
}

/// Hits that are taken together, at most [`WIDEST`].
#[derive(Clone, Copy)]
pub(crate) struct Block {
    pub from: usize,
    pub count: usize,
}

impl Block {
    /// The blocks of n hits.
    pub fn all(n: usize) -> impl Iterator<Item = Self> {
        (0..n).step_by(WIDEST).map(move |from| Self { from, count: WIDEST.min(n - from) })
    }

    /// Copies directions or uniform numbers in; numbers behind the last hit stay.
    #[inline(always)]
    pub fn copy_in(self, from: &[&[f32]; 3], block: &mut [Numbers; 3]) {
        for (block, from) in block.iter_mut().zip(from) {
            copy(&from[self.from..self.from + self.count], &mut block[..self.count]);
        }
    }

    /// Copies the numbers of a block out.
    #[inline(always)]
    pub fn copy_out<const C: usize>(self, block: &[Numbers; C], to: &mut [&mut [f32]; C]) {
        for (block, to) in block.iter().zip(to) {
            copy(&block[..self.count], &mut to[self.from..self.from + self.count]);
        }
    }
}

/// Copies at most [`WIDEST`] numbers by two moves of a known length, which may overlap: a call of `memcpy` for each array
/// of a request is a quarter of the time of a few hits.
#[inline(always)]
fn copy(from: &[f32], to: &mut [f32]) {
    let n = from.len().min(to.len());
    if n >= WIDEST / 2 {
        copy_ends::<{ WIDEST / 2 }>(from, to, n);
    } else if n >= WIDEST / 4 {
        copy_ends::<{ WIDEST / 4 }>(from, to, n);
    } else {
        for (to, from) in to.iter_mut().zip(from).take(WIDEST / 4) {
            *to = *from;
        }
    }
}

/// The first `K` and the last `K` of n.
#[inline(always)]
fn copy_ends<const K: usize>(from: &[f32], to: &mut [f32], n: usize) {
    for at in [0, n - K] {
        to[at..at + K].copy_from_slice(&from[at..at + K]);
    }
}
