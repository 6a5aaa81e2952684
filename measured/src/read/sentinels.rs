//! Values that stand for nothing measured: -1, -999, the 0 of a shadow.

use super::reason::Reason;
use std::collections::BTreeMap;

/// Negative numbers that programs write where nothing was measured.
const NEGATIVE: [f64; 8] = [-1.0, -9.0, -99.0, -999.0, -9999.0, -99999.0, -999_999.0, -32768.0];

/// Large ones.
const LARGE: [f64; 6] = [999.0, 9999.0, 99999.0, 999_999.0, 65535.0, 32767.0];

/// Distance from 0 of a value that stands for "not measured", over that of noise or of measured values.
const FARTHER: f64 = 10.0;

/// A negative number that no list has stands for nothing if it is repeated so often, and is the only one.
const REPEATED: usize = 3;

/// Exact zeros are dead where this share of the least of the other values is above this share of their median.
const LOW: f64 = 0.02;
const NEAR_ZERO: f64 = 0.1;

/// More zeros than this share of all are no shadow.
const MOST_ZEROS: f64 = 0.4;

/// Least, largest and mean of the numbers of a row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cells {
    least: f64,
    largest: f64,
    mean: f64,
}

impl Cells {
    pub fn of(cells: &[f64]) -> Self {
        let fold = |start, pick: fn(f64, f64) -> f64| cells.iter().copied().fold(start, pick);
        Self {
            least: fold(f64::INFINITY, f64::min),
            largest: fold(f64::NEG_INFINITY, f64::max),
            mean: cells.iter().sum::<f64>() / cells.len().max(1) as f64,
        }
    }

    pub fn largest(&self) -> f64 {
        self.largest
    }

    pub fn is_negative(&self) -> bool {
        self.mean < 0.0
    }

    fn is_zero(&self) -> bool {
        self.least == 0.0 && self.largest == 0.0
    }
}

/// The values that stand for nothing in one file.
#[derive(Debug, Default)]
pub(super) struct Sentinels {
    values: Vec<f64>,
    has_dead_zeros: bool,
}

impl Sentinels {
    /// Finds them among the rows of a file.
    pub fn of(rows: &[Cells]) -> Self {
        let mut positive: Vec<f64> = rows.iter().map(|row| row.mean).filter(|v| *v > 0.0).collect();
        positive.sort_by(f64::total_cmp);
        let Some(&median) = positive.get(positive.len() / 2) else { return Self::default() };
        let mut values = negative(rows, median);
        values.extend(large(rows));
        let zeros = rows.iter().filter(|row| row.is_zero()).count();
        let low = positive[(LOW * positive.len() as f64) as usize];
        // Noise about 0 has zeros among it.
        let is_noise = rows.iter().any(|row| row.least < 0.0 && !values.contains(&row.least));
        let is_shadow =
            !is_noise && zeros as f64 <= MOST_ZEROS * rows.len() as f64 && low > NEAR_ZERO * median;
        Self { values, has_dead_zeros: zeros > 0 && is_shadow }
    }

    /// Why a row is no sample, if it is none.
    pub fn reason(&self, row: &Cells) -> Option<Reason> {
        let sentinel = self.values.iter().find(|&&v| row.least == v || row.largest == v);
        let dead = (self.has_dead_zeros && row.is_zero()).then_some(Reason::DeadZero);
        sentinel.map(|&v| Reason::Sentinel(v)).or(dead)
    }
}

/// Negative numbers that are no noise.
fn negative(rows: &[Cells], median: f64) -> Vec<f64> {
    let mut counts: BTreeMap<u64, usize> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.least < 0.0) {
        *counts.entry(row.least.to_bits()).or_default() += 1;
    }
    let found: Vec<(f64, usize)> = counts.into_iter().map(|(bits, n)| (f64::from_bits(bits), n)).collect();
    let is_listed = |v: f64| NEGATIVE.contains(&v);
    let noise = found.iter().filter(|f| !is_listed(f.0)).map(|f| -f.0).fold(0.0, f64::max);
    let listed: Vec<f64> =
        found.iter().map(|f| f.0).filter(|&v| is_listed(v) && -v >= FARTHER * noise).collect();
    match found.as_slice() {
        [(only, count)] if listed.is_empty() && *count >= REPEATED && -only > NEAR_ZERO * median => {
            vec![*only]
        }
        _ => listed,
    }
}

/// Numbers of the list that are far above all others.
fn large(rows: &[Cells]) -> Vec<f64> {
    let others = rows.iter().map(|row| row.largest).filter(|v| !LARGE.contains(v)).fold(0.0, f64::max);
    let is_there = |v: &f64| rows.iter().any(|row| row.largest == *v);
    if others == 0.0 {
        return Vec::new();
    }
    LARGE.into_iter().filter(|v| *v >= FARTHER * others && is_there(v)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn left_out(values: &[f64]) -> Vec<f64> {
        let rows: Vec<Cells> = values.iter().map(|v| Cells::of(&[*v])).collect();
        let sentinels = Sentinels::of(&rows);
        values.iter().zip(&rows).filter(|(_, row)| sentinels.reason(row).is_some()).map(|(v, _)| *v).collect()
    }

    #[test]
    fn what_stands_for_nothing_is_told_from_noise() {
        assert_eq!(left_out(&[0.1, 0.2, -1.0, 0.3]), [-1.0]);
        assert_eq!(left_out(&[0.1, 0.2, -999.0, 0.3, -0.001]), [-999.0]);
        assert_eq!(left_out(&[0.1, 0.2, -0.5, -0.5, -0.5, 0.3]), [-0.5; 3]);
        assert_eq!(left_out(&[0.1, 0.2, 9999.0, 0.3]), [9999.0]);
        assert_eq!(left_out(&[0.1, 0.2, 0.0, 0.3, 0.15]), [0.0]);
        // Whole per cents with noise of one or two; dark samples that fade to 0; a highlight.
        assert!(left_out(&[3.0, 5.0, -1.0, -2.0, 0.0, 7.0]).is_empty());
        assert!(left_out(&[1e-4, 0.2, 0.0, 0.3, 0.003, 0.02]).is_empty());
        assert!(left_out(&[0.1, 0.2, 900.0, 1e5]).is_empty());
        assert!(left_out(&[0.0, 0.0, 0.0, 5.0]).is_empty());
        assert!(left_out(&[0.0, -1.0]).is_empty());
    }
}
