//! Arrays that batches read and write, those written with guard zones round them.

use alloc::vec;
use alloc::vec::Vec;
use srbf_core::Vec3;

/// Counts that are tried: none, and up to twice what any level takes at a time, and one.
pub const COUNTS: usize = 2 * 2 * 16 + 2;

/// The number in a guard zone.
const GUARD: f32 = -7.25e33;
/// Its width, on either side of an output.
const ZONE: usize = 4;

/// A number of outputs with guard zones.
pub struct Guarded<const K: usize>([Vec<f32>; K], usize);

impl<const K: usize> Guarded<K> {
    /// Of `n` numbers each.
    pub fn new(n: usize) -> Self {
        Self([(); K].map(|()| vec![GUARD; n + 2 * ZONE]), n)
    }
    /// As the library writes them.
    pub fn slices(&mut self) -> [&mut [f32]; K] {
        let n = self.1;
        self.0.each_mut().map(|v| &mut v[ZONE..ZONE + n])
    }
    /// One number of an output.
    pub fn at(&self, which: usize, i: usize) -> f32 {
        self.0[which][ZONE + i]
    }
    /// Whether no guard zone was written.
    pub fn is_intact(&self) -> bool {
        let zones = |v: &Vec<f32>| v[..ZONE].iter().chain(&v[ZONE + self.1..]).all(|&x| x == GUARD);
        self.0.iter().all(zones)
    }
}

/// Vectors as three arrays.
pub fn structure_of_arrays(vectors: &[Vec3]) -> [Vec<f32>; 3] {
    [0, 1, 2].map(|i| vectors.iter().map(|v| v[i]).collect())
}

/// The first of three arrays.
pub fn slices(arrays: &[Vec<f32>; 3], n: usize) -> [&[f32]; 3] {
    [&arrays[0][..n], &arrays[1][..n], &arrays[2][..n]]
}
