//! Statistical tests: Kolmogorov-Smirnov, and chi-square with pooling, odd bins and Sidak's correction.

use std::f64::consts::PI;

/// Kolmogorov-Smirnov distance of samples from a distribution function; sorts the samples.
pub fn ks_distance(samples: &mut [f64], cdf: impl Fn(f64) -> f64) -> f64 {
    samples.sort_by(f64::total_cmp);
    let n = samples.len() as f64;
    let mut worst = 0f64;
    for (i, &x) in samples.iter().enumerate() {
        let p = cdf(x);
        worst = worst.max(p - i as f64 / n).max((i + 1) as f64 / n - p);
    }
    worst
}

/// Critical distance of the Kolmogorov-Smirnov test for many samples: `sqrt(-ln(alpha / 2) / (2 n))`.
pub fn ks_critical(n: usize, alpha: f64) -> f64 {
    (-(0.5 * alpha).ln() / (2.0 * n as f64)).sqrt()
}

/// Level of each of `tests` tests so that all together have the level `alpha` (Sidak).
pub fn sidak(alpha: f64, tests: usize) -> f64 {
    1.0 - (1.0 - alpha).powf(1.0 / tests as f64)
}

/// Probability that a chi-square variable of `degrees` degrees of freedom exceeds `x`: regularised upper incomplete
/// gamma function of `degrees / 2` and `x / 2`, by its series or its continued fraction.
pub fn chi_square_tail(x: f64, degrees: usize) -> f64 {
    let (a, x) = (0.5 * degrees as f64, 0.5 * x);
    if x <= 0.0 {
        return 1.0;
    }
    let front = (a * x.ln() - x - ln_gamma(a)).exp();
    if x < a + 1.0 {
        let (mut term, mut sum, mut n) = (1.0 / a, 1.0 / a, a);
        while term > 1e-16 * sum {
            n += 1.0;
            term *= x / n;
            sum += term;
        }
        1.0 - front * sum
    } else {
        // Lentz.
        let mut b = x + 1.0 - a;
        let mut c = 1e300;
        let mut d = 1.0 / b;
        let mut h = d;
        for i in 1..10_000 {
            let i = f64::from(i);
            let an = -i * (i - a);
            b += 2.0;
            d = 1.0 / (an * d + b);
            c = b + an / c;
            h *= c * d;
            if (c * d - 1.0).abs() < 1e-14 {
                break;
            }
        }
        front * h
    }
}

/// Probabilities that a binomial variable of `n` trials of chance `p`, in (0, 1), is less than `x`, `x`, and more.
pub fn binomial(n: usize, p: f64, x: usize) -> [f64; 3] {
    let factorial = |k: usize| ln_gamma(k as f64 + 1.0);
    let (odds, up, down) = (p / (1.0 - p), x as f64, (n - x) as f64);
    let at = (factorial(n) - factorial(x) - factorial(n - x) + up * p.ln() + down * (-p).ln_1p()).exp();
    let (mut below, mut above, mut term) = (0.0, 0.0, at);
    for k in (1..=x).rev() {
        term *= k as f64 / ((n - k + 1) as f64 * odds);
        below += term;
    }
    term = at;
    for k in x..n {
        term *= (n - k) as f64 * odds / (k + 1) as f64;
        above += term;
    }
    [below, at, above]
}

/// Logarithm of the gamma function (Lanczos, g = 7).
fn ln_gamma(x: f64) -> f64 {
    const C: [f64; 9] = [
        0.999_999_999_999_809_9,
        676.520_368_121_885_1,
        -1_259.139_216_722_402_8,
        771.323_428_777_653_1,
        -176.615_029_162_140_6,
        12.507_343_278_686_905,
        -0.138_571_095_265_720_12,
        9.984_369_578_019_572e-6,
        1.505_632_735_149_311_6e-7,
    ];
    let x = x - 1.0;
    let t = x + 7.5;
    let sum = C.iter().enumerate().skip(1).fold(C[0], |s, (i, c)| s + c / (x + i as f64));
    0.5 * (2.0 * PI).ln() + (x + 0.5) * t.ln() - t + sum.ln()
}

/// Result of a chi-square test.
#[derive(Clone, Copy, Debug)]
pub struct ChiSquare {
    /// Sum of (observed - expected)^2 / expected.
    pub statistic: f64,
    /// Degrees of freedom: bins after pooling, less one.
    pub degrees: usize,
    /// Probability of a statistic as large by chance.
    pub p: f64,
}

/// Compares counts with expectations, which sum to the number of samples; bins that expect fewer than 5 are pooled.
///
/// A count in bins that expect nothing at all gives `p = 0`.
pub fn chi_square(observed: &[f64], expected: &[f64]) -> ChiSquare {
    let mut bins: Vec<(f64, f64)> = expected.iter().copied().zip(observed.iter().copied()).collect();
    bins.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut statistic, mut count) = (0.0, 0usize);
    let (mut pooled_expected, mut pooled_observed) = (0.0, 0.0);
    let mut add = |expected: f64, observed: f64| {
        statistic += (observed - expected) * (observed - expected) / expected;
        count += 1;
    };
    for (expected, observed) in bins {
        // Smallest first: rare ones are pooled.
        if expected < 5.0 || pooled_expected > 0.0 && pooled_expected < 5.0 {
            pooled_expected += expected;
            pooled_observed += observed;
        } else {
            add(expected, observed);
        }
    }
    if pooled_expected > 1e-6 {
        add(pooled_expected, pooled_observed);
    } else if pooled_observed > 0.0 {
        return ChiSquare { statistic: f64::INFINITY, degrees: 1, p: 0.0 };
    }
    let degrees = count.saturating_sub(1).max(1);
    ChiSquare { statistic, degrees, p: chi_square_tail(statistic, degrees) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chi_square_tail_of_tables() {
        // 95 % and 1 % points of common tables.
        for (x, degrees, p) in [(3.841, 1, 0.05), (18.307, 10, 0.05), (135.807, 100, 0.01), (9.542, 4, 0.049)]
        {
            assert!((chi_square_tail(x, degrees) - p).abs() < 2e-4, "{x} {degrees}");
        }
    }

    #[test]
    fn binomial_of_ten_and_of_many() {
        let [below, at, above] = binomial(10, 0.5, 3);
        assert!((below - 56.0 / 1024.0).abs() < 1e-12 && (at - 120.0 / 1024.0).abs() < 1e-12);
        assert!((above - 848.0 / 1024.0).abs() < 1e-12);
        for x in [700, 1000, 1500] {
            let sum: f64 = binomial(4096, 0.25, x).iter().sum();
            assert!((sum - 1.0).abs() < 1e-9, "{x}: {sum}");
        }
    }

    #[test]
    fn pooling_keeps_every_count() {
        let result = chi_square(&[10.0, 0.0, 3.0, 7.0], &[10.0, 2.0, 1.0, 7.0]);
        assert_eq!(result.degrees, 1, "{result:?}");
        assert_eq!(chi_square(&[10.0, 1.0], &[11.0, 0.0]).p, 0.0);
    }

    #[test]
    fn ks_of_a_shifted_uniform() {
        let mut samples: Vec<f64> = (0..1000).map(|i| (i as f64 + 0.5) / 1000.0).collect();
        assert!(ks_distance(&mut samples, |x| x) < 0.001);
        assert!(ks_distance(&mut samples, |x| (x + 0.1).min(1.0)) > 0.09);
        assert!((ks_critical(1_000_000, 0.01) - 0.001_628).abs() < 1e-6);
    }
}
