//! Why a row of a file is no sample, and how that is said.

/// Why a row is no sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reason {
    /// A cell is empty, or a word that stands for nothing.
    NoNumber,
    /// This value stands for nothing measured.
    Sentinel(f64),
    /// The largest value of all, at which the detector was saturated.
    Saturated(f64),
    /// Exactly 0 where no other value is near 0: the shadow of the lamp, or of the horizon.
    DeadZero,
    /// A direction is at the horizon, 90 degrees from the normal.
    Horizon,
    /// One direction is behind the surface: transmission.
    Transmission,
    /// Both directions are behind the surface.
    Behind,
}

impl Reason {
    /// The reason in words, after a number of rows.
    pub fn text(&self) -> String {
        match self {
            Self::NoNumber => "without a number".into(),
            Self::Sentinel(value) => format!("with the value {value}, which stands for nothing measured"),
            Self::Saturated(value) => {
                format!("with the largest value, {value}, at which the detector was saturated")
            }
            Self::DeadZero => {
                "with exactly 0 where no other value is near 0, as in the shadow of a lamp or detector".into()
            }
            Self::Horizon => "with a direction at the horizon, 90 degrees from the normal".into(),
            Self::Transmission => {
                "with a direction behind the surface (transmission, theta above 90 degrees)".into()
            }
            Self::Behind => "with both directions behind the surface".into(),
        }
    }
}
