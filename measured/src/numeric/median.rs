//! The middle of numbers.

/// The middle of numbers; `None` of none.
pub fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// Weighted median; NaN of nothing.
pub fn weighted_median(mut values: Vec<(f64, f64)>) -> f64 {
    values.retain(|v| v.1 > 0.0);
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * values.iter().map(|v| v.1).sum::<f64>();
    let mut sum = 0.0;
    let middle = values.iter().find(|v| {
        sum += v.1;
        sum >= half
    });
    middle.map_or(f64::NAN, |v| v.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_is_by_weight() {
        assert_eq!(weighted_median(vec![(3.0, 1.0), (1.0, 1.0), (2.0, 5.0)]), 2.0);
        assert_eq!(weighted_median(vec![(3.0, 9.0), (1.0, 1.0), (2.0, 5.0)]), 3.0);
        assert!(weighted_median(vec![]).is_nan());
    }
}
