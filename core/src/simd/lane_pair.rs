//! A pair of vectors as one: twice the lanes, for kernels whose loop broadcasts numbers that all lanes share.
//! Or a pair of pairs.
//!
//! A broadcast then serves both halves, and the two chains of dependent operations run side by side.

use super::lanes::{Lanes, NodeCodes, Parts};
use core::ops::{Add, Div, Mul, Sub};

/// Two vectors; the first holds the lower lanes.
#[derive(Clone, Copy)]
pub(crate) struct LanePair<L>(L, L);

macro_rules! operators {
    ($($name:ident $method:ident)*) => { $(
        impl<L: Lanes> $name for LanePair<L> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0), self.1.$method(other.1))
            }
        }
    )* };
}
operators!(Add add Sub sub Mul mul Div div);

impl<L: Lanes> Lanes for LanePair<L> {
    const COUNT: usize = 2 * L::COUNT;
    const FUSED: bool = L::FUSED;
    type Batch = Self;
    const VECTORS: usize = 2 * L::VECTORS;
    type Half = L;
    #[inline(always)]
    fn halves(self) -> [L; 2] {
        [self.0, self.1]
    }
    #[inline(always)]
    fn of_halves([low, high]: [L; 2]) -> Self {
        Self(low, high)
    }
    type Lobes = Self;
    type Mask = [L::Mask; 2];
    type Index = [L::Index; 2];
    type One = L::One;
    const EXP2: [f32; 5] = L::EXP2;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        let both = L::splat(value);
        Self(both, both)
    }
    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        Self(L::load(from), L::load(&from[L::COUNT..]))
    }
    #[inline(always)]
    fn load_bytes(from: &[u8]) -> Self {
        Self(L::load_bytes(from), L::load_bytes(&from[4 * L::COUNT..]))
    }
    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        self.0.store(to);
        self.1.store(&mut to[L::COUNT..]);
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        Self(self.0.mul_add(a.0, b.0), self.1.mul_add(a.1, b.1))
    }
    #[inline(always)]
    fn neg_mul_add(self, a: Self, b: Self) -> Self {
        Self(self.0.neg_mul_add(a.0, b.0), self.1.neg_mul_add(a.1, b.1))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0), self.1.min(other.1))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0), self.1.max(other.1))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt(), self.1.sqrt())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs(), self.1.abs())
    }
    #[inline(always)]
    fn copy_sign(self, sign: Self) -> Self {
        Self(self.0.copy_sign(sign.0), self.1.copy_sign(sign.1))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> [L::Mask; 2] {
        [self.0.lt(other.0), self.1.lt(other.1)]
    }
    #[inline(always)]
    fn both(a: [L::Mask; 2], b: [L::Mask; 2]) -> [L::Mask; 2] {
        [L::both(a[0], b[0]), L::both(a[1], b[1])]
    }
    #[inline(always)]
    fn ge(self, other: Self) -> [L::Mask; 2] {
        [self.0.ge(other.0), self.1.ge(other.1)]
    }
    #[inline(always)]
    fn select(mask: [L::Mask; 2], yes: Self, no: Self) -> Self {
        Self(L::select(mask[0], yes.0, no.0), L::select(mask[1], yes.1, no.1))
    }
    #[inline(always)]
    fn either(mask: [L::Mask; 2], numbers: &[f32; 2]) -> Self {
        Self(L::either(mask[0], numbers), L::either(mask[1], numbers))
    }
    #[inline(always)]
    fn keep(self, mask: [L::Mask; 2]) -> Self {
        Self(self.0.keep(mask[0]), self.1.keep(mask[1]))
    }
    #[inline(always)]
    fn add_exponent(self, n: Self) -> Self {
        Self(self.0.add_exponent(n.0), self.1.add_exponent(n.1))
    }
    #[inline(always)]
    fn split_whole(self) -> (Self, Self) {
        let ((f0, n0), (f1, n1)) = (self.0.split_whole(), self.1.split_whole());
        (Self(f0, f1), Self(n0, n1))
    }
    #[inline(always)]
    fn times_exp2(self, whole: Self, least: f32) -> Self {
        Self(self.0.times_exp2(whole.0, least), self.1.times_exp2(whole.1, least))
    }
    #[inline(always)]
    fn quarter_turns(n: Self, sin: Self, cos: Self) -> (Self, Self) {
        let (s0, c0) = L::quarter_turns(n.0, sin.0, cos.0);
        let (s1, c1) = L::quarter_turns(n.1, sin.1, cos.1);
        (Self(s0, s1), Self(c0, c1))
    }
    #[inline(always)]
    fn split_exponent(self) -> (Self, Self) {
        let ((m0, e0), (m1, e1)) = (self.0.split_exponent(), self.1.split_exponent());
        (Self(m0, m1), Self(e0, e1))
    }
    #[inline(always)]
    fn search(self, row: &Parts<'_>, len: usize) -> [L::Index; 2] {
        [self.0.search(row, len), self.1.search(row, len)]
    }
    #[inline(always)]
    fn bits(mask: [L::Mask; 2]) -> u64 {
        L::bits(mask[0]) | L::bits(mask[1]) << L::COUNT
    }
    #[inline(always)]
    fn index_below(index: [L::Index; 2], limit: usize) -> [L::Mask; 2] {
        [L::index_below(index[0], limit), L::index_below(index[1], limit)]
    }
    #[inline(always)]
    fn lookup(row: &Parts<'_>, len: usize, index: [L::Index; 2]) -> Self {
        Self(L::lookup(row, len, index[0]), L::lookup(row, len, index[1]))
    }
    #[inline(always)]
    fn node_pairs(nodes: NodeCodes<'_>, index: Self) -> [[Self; 3]; 2] {
        let (low, high) = (L::node_pairs(nodes, index.0), L::node_pairs(nodes, index.1));
        let mut pairs = [[index; 3]; 2];
        for node in 0..2 {
            for channel in 0..3 {
                pairs[node][channel] = Self(low[node][channel], high[node][channel]);
            }
        }
        pairs
    }
    #[inline(always)]
    fn first(self) -> f32 {
        self.0.first()
    }
    #[inline(always)]
    fn sum(self) -> f32 {
        (self.0 + self.1).sum()
    }
    #[inline(always)]
    fn running_sum(self) -> Self {
        let low = self.0.running_sum();
        Self(low, self.1.running_sum() + low.last())
    }
    #[inline(always)]
    fn last(self) -> Self {
        let last = self.1.last();
        Self(last, last)
    }
    #[inline(always)]
    fn three_sums([a, b, c]: [Self; 3]) -> [f32; 3] {
        L::three_sums([a.0 + a.1, b.0 + b.1, c.0 + c.1])
    }
    #[inline(always)]
    fn iota() -> Self {
        Self(L::iota(), L::iota() + L::splat(L::COUNT as f32))
    }
}
