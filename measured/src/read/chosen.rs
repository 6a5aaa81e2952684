//! Wavelengths of a file that a caller chooses.

/// Most ranges in a choice.
const MOST: usize = 16;

/// How near to one that is named a wavelength is the same, nm.
const NEAR: f64 = 0.5;

/// Wavelengths and ranges of them, nm.
///
/// ```
/// use srbf_measured::read::ChosenWavelengths;
///
/// let chosen = ChosenWavelengths::parse("400-700, 905")?;
/// assert!(chosen.has(550.0) && chosen.has(904.8) && !chosen.has(800.0));
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChosenWavelengths {
    ranges: [[f64; 2]; MOST],
    count: usize,
}

impl ChosenWavelengths {
    /// Of numbers and ranges in nm, separated by commas.
    ///
    /// # Errors
    /// The expected form.
    pub fn parse(text: &str) -> Result<Self, String> {
        let expected =
            || format!("up to {MOST} wavelengths or ranges in nm, such as 400-700,905, are expected");
        let mut chosen = Self { ranges: [[0.0; 2]; MOST], count: 0 };
        for part in text.split(',') {
            let number = |text: &str| text.trim().parse::<f64>().ok().filter(|nm| (1.0..=1e6).contains(nm));
            let (low, high) = part.split_once('-').unwrap_or((part, part));
            let (Some(low), Some(high)) = (number(low), number(high)) else { return Err(expected()) };
            if low > high || chosen.count == MOST {
                return Err(expected());
            }
            chosen.ranges[chosen.count] = [low, high];
            chosen.count += 1;
        }
        Ok(chosen)
    }

    /// Whether a wavelength in nm is chosen.
    pub fn has(&self, nm: f64) -> bool {
        self.ranges[..self.count].iter().any(|[low, high]| (low - NEAR..=high + NEAR).contains(&nm))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_choice_is_refused() {
        for odd in ["", "red", "400-", "700-400", "-5", "NaN", "400,,700", "inf", "1e9", &"500,".repeat(17)] {
            assert!(ChosenWavelengths::parse(odd).is_err(), "{odd}");
        }
        let lasers = ChosenWavelengths::parse("450, 532,633").unwrap();
        assert!([450.0, 532.4, 632.8].iter().all(|nm| lasers.has(*nm)));
        assert!([451.0, f64::NAN, 0.0].iter().all(|nm| !lasers.has(*nm)));
    }
}
