//! Conventions of the numbers of a file, where the file itself does not state them.

use super::chosen::ChosenWavelengths;
use super::window::Band;
pub use crate::row::Values;
use srbf_core::Quarter;

/// Units of angles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Angles {
    /// 90 is the horizon.
    Degrees,
    /// pi / 2 is the horizon.
    Radians,
}

/// Where the mirror direction is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mirror {
    /// Azimuths 180 degrees apart, as both directions point away from the surface; in a plane, angles of opposite signs.
    Opposite,
    /// Equal azimuths; in a plane, equal angles.
    Equal,
}

/// A caller's knowledge of a file beyond its content. The default lets the file speak.
///
/// # Examples
/// ```
/// use srbf_measured::read::{Conventions, Mirror};
///
/// let conventions = Conventions { mirror: Some(Mirror::Equal), divide: std::f64::consts::PI, ..Conventions::default() };
/// assert!(conventions.check().is_ok());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conventions {
    /// Units of angles; `None`: as the file says, or as its numbers show.
    pub angles: Option<Angles>,
    /// Where the mirror direction is; `None`: as the format has it.
    pub mirror: Option<Mirror>,
    /// The kind of the values; `None`: as the format has it.
    pub values: Option<Values>,
    /// Whether incident directions are those in which light travels, and are turned about.
    pub is_along_light: bool,
    /// Whether samples of the largest value are left out, at which the detector was saturated.
    pub is_saturated: bool,
    /// What values are divided by to be in 1/sr; above 0.
    pub divide: f64,
    /// The wavelengths that are read, of a file that has some; `None`: all.
    pub wavelengths: Option<ChosenWavelengths>,
    /// The quarter of a sheet that is read: by default the reflection seen from the front. Directions behind the sheet change the sign of
    /// their height, so that straight through is the mirror direction.
    pub quarter: Quarter,
    /// The part of the spectrum that is read, of a file of a window.
    pub band: Band,
}

impl Default for Conventions {
    fn default() -> Self {
        Self {
            angles: None,
            mirror: None,
            values: None,
            is_along_light: false,
            is_saturated: false,
            divide: 1.0,
            wavelengths: None,
            quarter: Quarter::FrontReflection,
            band: Band::default(),
        }
    }
}

impl Conventions {
    /// Refuses a factor that is no finite number above 0.
    ///
    /// # Errors
    /// The expected form.
    pub fn check(&self) -> Result<(), String> {
        let fits = self.divide.is_finite() && (1e-12..=1e12).contains(&self.divide);
        if fits {
            Ok(())
        } else {
            Err(format!("values are divided by {}; 1e-12 to 1e12 is expected", self.divide))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_divided_by_a_number_in_its_range() {
        let of = |divide: f64| Conventions { divide, ..Conventions::default() }.check();
        assert!([1e-12, 0.5, 1e12].into_iter().all(|divide| of(divide).is_ok()));
        for divide in [0.0, -1.0, 1e-13, 1e13, f64::INFINITY, f64::NAN] {
            assert!(of(divide).unwrap_err().contains("1e-12 to 1e12"), "{divide}");
        }
    }
}
