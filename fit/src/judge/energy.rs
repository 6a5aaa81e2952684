//! Errors of albedos.

use crate::table::luminance;

/// Errors of the channels of albedos, relative to the luminance of the data, or to the channel if that is more: the error of a channel
/// that is nearly 0, or below, in a bright colour is not seen. A little is added, so that black stays black.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EnergyError {
    black: f64,
}

impl EnergyError {
    /// Beside `black`, errors of an albedo hardly matter.
    pub const fn beside(black: f64) -> Self {
        Self { black }
    }

    /// For data with these albedos: a ten thousandth of the brightest is black.
    pub fn new(data: impl Iterator<Item = [f64; 3]>) -> Self {
        Self::beside(1e-4 * data.flatten().fold(1e-12, f64::max))
    }

    /// The albedo of a channel that errors are relative to.
    pub fn scale(self, data: [f64; 3], channel: usize) -> f64 {
        data[channel].abs().max(luminance(data)) + self.black
    }

    /// Errors of the channels.
    pub fn errors(self, fitted: [f64; 3], data: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|c| (fitted[c] - data[c]) / self.scale(data, c))
    }

    /// Their derivatives by the fitted albedo.
    pub fn slopes(self, data: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|c| 1.0 / self.scale(data, c))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_much_darker_than_the_brightest_is_black() {
        let energy = EnergyError::new([[0.0, 0.5, 0.2], [0.1, 0.0, 0.0]].into_iter());
        let [red, green, blue] = energy.errors([0.22, 0.0, 1e-7], [0.2, 0.0, 0.0]);
        assert!((red - 0.1).abs() < 1e-3 && green == 0.0 && blue.abs() < 1e-3);
        // Of a channel below 0 beside bright ones.
        let [red, ..] = energy.errors([-0.003, 0.6, 0.4], [-0.004, 0.6, 0.4]);
        assert!((0.001..0.003).contains(&red), "{red}");
        assert!(EnergyError::new([[0.0; 3]].into_iter()).errors([0.0; 3], [0.0; 3]) == [0.0; 3]);
    }
}
