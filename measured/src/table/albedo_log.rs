//! Albedos, compared by their logarithms.

/// Share of the brightest albedo that is added.
const BLACK: f64 = 1e-4;

/// What logarithms of albedos are taken of: with a little added to each, so that black stays black without a logarithm of 0.
#[derive(Clone, Copy, Debug)]
pub struct Ratio {
    black: f64,
}

impl Ratio {
    /// For data with these albedos.
    pub fn new(data: impl Iterator<Item = [f64; 3]>) -> Self {
        Self { black: BLACK * data.flatten().fold(1e-12, f64::max) }
    }

    /// An albedo with its shift; one below 0, of a colour outside the gamut, counts as black.
    pub fn shifted(self, albedo: f64) -> f64 {
        albedo.max(0.0) + self.black
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_much_darker_than_the_brightest_is_black() {
        let ratio = Ratio::new([[0.0, 0.5, 0.2], [0.1, 0.0, 0.0]].into_iter());
        let ln = |ratio: Ratio, a, b| libm::log(ratio.shifted(a) / ratio.shifted(b));
        assert!((ln(ratio, 0.22, 0.2) - libm::log(1.1)).abs() < 1e-4);
        assert!(ln(ratio, 1e-7, 0.0).abs() < 3e-3 && ln(ratio, 0.0, 0.0) == 0.0);
        assert!(ln(Ratio::new([[0.0; 3]].into_iter()), 0.0, -0.1) == 0.0);
    }
}
