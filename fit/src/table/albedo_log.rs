//! Albedos, compared by their ratio.

/// Share of the brightest albedo that is added to both of a ratio.
const BLACK: f64 = 1e-4;

/// Logarithms of albedos over another: with a little added to each, so that black stays black without a logarithm of 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ratio {
    black: f64,
}

impl Ratio {
    /// For data with these albedos.
    pub fn new(data: impl Iterator<Item = [f64; 3]>) -> Self {
        Self { black: BLACK * data.flatten().fold(1e-12, f64::max) }
    }

    /// An albedo with what is added to it; one below 0, of a colour outside the gamut, counts as black.
    pub fn shifted(self, albedo: f64) -> f64 {
        albedo.max(0.0) + self.black
    }

    /// Logarithm of one over the other.
    pub fn ln(self, fitted: f64, data: f64) -> f64 {
        libm::log(self.shifted(fitted) / self.shifted(data))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_much_darker_than_the_brightest_is_black() {
        let ratio = Ratio::new([[0.0, 0.5, 0.2], [0.1, 0.0, 0.0]].into_iter());
        assert!((ratio.ln(0.22, 0.2) - libm::log(1.1)).abs() < 1e-4);
        assert!(ratio.ln(1e-7, 0.0).abs() < 3e-3 && ratio.ln(0.0, 0.0) == 0.0);
        assert!(Ratio::new([[0.0; 3]].into_iter()).ln(0.0, 0.0) == 0.0);
    }
}
