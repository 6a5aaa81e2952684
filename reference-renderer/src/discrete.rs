//! Choice of one of many items with given weights, in constant time.

/// An alias table.
///
/// Source: Walker 1977; Vose 1991, "A linear algorithm for generating random numbers with a given distribution".
#[derive(Clone, Debug)]
pub struct AliasTable {
    /// Chance to keep the item that was hit, and the item to take instead.
    entries: Vec<(f32, u32)>,
}

impl AliasTable {
    /// Makes a table for weights that are finite, not negative and not all 0; `None` otherwise.
    pub fn new(weights: &[f64]) -> Option<Self> {
        let n = weights.len();
        let total: f64 = weights.iter().sum();
        if n > u32::MAX as usize || !(total > 0.0 && total.is_finite()) || weights.iter().any(|w| *w < 0.0) {
            return None;
        }
        let mut share: Vec<f64> = weights.iter().map(|w| w / total * n as f64).collect();
        let mut entries = vec![(1.0, 0); n];
        let (mut small, mut large): (Vec<u32>, Vec<u32>) =
            (0..n as u32).partition(|&i| share[i as usize] < 1.0);
        while let (Some(&low), Some(&high)) = (small.last(), large.last()) {
            small.pop();
            let (low, high) = (low as usize, high as usize);
            entries[low] = (share[low] as f32, high as u32);
            share[high] -= 1.0 - share[low];
            if share[high] < 1.0 {
                large.pop();
                small.push(high as u32);
            }
        }
        // What is left on either side is 1 up to rounding, except where the weight is 0.
        let heaviest = (0..n).max_by(|&a, &b| weights[a].total_cmp(&weights[b]))? as u32;
        for i in small.into_iter().chain(large) {
            let kept = if weights[i as usize] > 0.0 { 1.0 } else { 0.0 };
            entries[i as usize] = (kept, heaviest);
        }
        Some(Self { entries })
    }

    /// Number of items.
    pub fn len(&self) -> u32 {
        self.entries.len() as u32
    }

    /// The chosen item, for one that was hit uniformly and a uniform number in [0, 1).
    #[inline]
    pub fn choose(&self, hit: u32, u: f32) -> usize {
        let (keep, alias) = self.entries[hit as usize];
        if u < keep { hit as usize } else { alias as usize }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_those_of_the_weights() {
        let weights = [0.0, 3.0, 1e-3, 2.5, 0.0, 90.0, 1.0];
        let table = AliasTable::new(&weights).unwrap();
        let total: f64 = weights.iter().sum();
        // The chance of an item, summed over the entries that lead to it.
        let mut chance = [0.0; 7];
        for (i, &(keep, alias)) in table.entries.iter().enumerate() {
            chance[i] += f64::from(keep) / 7.0;
            chance[alias as usize] += (1.0 - f64::from(keep)) / 7.0;
        }
        for (i, weight) in weights.iter().enumerate() {
            assert!((chance[i] - weight / total).abs() < 1e-7, "item {i}: {} for {weight}", chance[i]);
        }
        assert_eq!((chance[0], chance[4]), (0.0, 0.0));
    }

    #[test]
    fn weights_without_meaning_are_refused() {
        for weights in [&[][..], &[0.0, 0.0], &[1.0, -1.0], &[1.0, f64::NAN], &[f64::INFINITY]] {
            assert!(AliasTable::new(weights).is_none(), "{weights:?}");
        }
    }
}
