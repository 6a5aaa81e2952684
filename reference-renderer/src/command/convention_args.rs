//! Options for the conventions that a file of samples leaves open.

use crate::truth::stored::QUARTERS;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use srbf_core::Quarter;
use srbf_fit::read::window::Band;
use srbf_fit::read::{Angles, ChosenWavelengths, Conventions, Mirror, Values};
use std::f64::consts::PI;

/// Knowledge of a file of samples beyond its content.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Conventions that the file leaves open")]
pub struct ConventionArgs {
    /// Unit of angles [default: as the file says or shows]
    #[arg(long, value_name = "UNIT")]
    angles: Option<AngleName>,
    /// Mirror directions are at opposite azimuths (angles of opposite signs, in a plane), or at equal ones
    #[arg(long, value_name = "WHERE")]
    mirror: Option<MirrorName>,
    /// What values are: the BRDF, or the BRDF times the cosine of the outgoing or incident direction
    #[arg(long, value_name = "WHAT")]
    values: Option<ValuesName>,
    /// Where incident directions point: towards the light, or along it, into the surface
    #[arg(long, value_name = "WHERE")]
    incident: Option<IncidentName>,
    /// Samples of the largest value, at which the detector may have been saturated: kept, or left out
    #[arg(long, value_name = "WHAT")]
    saturated: Option<SaturatedName>,
    /// What values are divided by to be in 1/sr: a number, or one with pi at its end, such as 100pi
    #[arg(long, value_name = "NUMBER", value_parser = factor, default_value = "1", hide_default_value = true)]
    divide: f64,
    /// Of a file of spectra, the wavelengths that are read, in nm: numbers and ranges, such as 905 or 400-700,905 [default: all]
    #[arg(long, value_name = "NM", value_parser = ChosenWavelengths::parse)]
    wavelengths: Option<ChosenWavelengths>,
    /// The part of a sheet that is read: reflection or transmission, as a viewer in front or behind sees it
    /// [default: the reflection of the front; `fit` of a file of a window: all]
    #[arg(long, value_name = "WHICH", value_parser = PossibleValuesParser::new(QUARTERS).map(quarter))]
    quarter: Option<Quarter>,
    /// Of a file of a window, the part of the spectrum: visible (in colour where the file has some), solar, infrared, or a name in the file
    #[arg(long, value_name = "NAME", value_parser = Band::parse, default_value = "visible", hide_default_value = true)]
    band: Band,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum AngleName {
    Degrees,
    Radians,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum MirrorName {
    Opposite,
    Equal,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum ValuesName {
    Brdf,
    CosineOutgoing,
    CosineIncident,
}

#[derive(Clone, Copy, Debug, PartialEq, clap::ValueEnum)]
enum IncidentName {
    TowardsLight,
    AlongLight,
}

#[derive(Clone, Copy, Debug, PartialEq, clap::ValueEnum)]
enum SaturatedName {
    Keep,
    LeaveOut,
}

/// The quarter of one of the names.
fn quarter(name: String) -> Quarter {
    let place = QUARTERS.iter().position(|own| *own == name);
    Quarter::ALL[place.unwrap_or_default()]
}

fn factor(text: &str) -> Result<f64, String> {
    let (number, unit) = text.strip_suffix("pi").map_or((text, 1.0), |number| (number, PI));
    let number = if number.is_empty() { Ok(1.0) } else { number.parse::<f64>() };
    let fits = |v: &f64| v.is_finite() && (1e-12..=1e12).contains(v);
    number
        .ok()
        .map(|v| v * unit)
        .filter(fits)
        .ok_or_else(|| "a number from 1e-12 to 1e12, or such as 100pi".to_owned())
}

impl ConventionArgs {
    /// Whether no quarter of a sheet is named.
    pub fn is_of_all_quarters(&self) -> bool {
        self.quarter.is_none()
    }

    /// As the reader takes it.
    pub fn conventions(&self) -> Conventions {
        Conventions {
            angles: self.angles.map(|name| match name {
                AngleName::Degrees => Angles::Degrees,
                AngleName::Radians => Angles::Radians,
            }),
            mirror: self.mirror.map(|name| match name {
                MirrorName::Opposite => Mirror::Opposite,
                MirrorName::Equal => Mirror::Equal,
            }),
            values: self.values.map(|name| match name {
                ValuesName::Brdf => Values::Brdf,
                ValuesName::CosineOutgoing => Values::CosineOutgoing,
                ValuesName::CosineIncident => Values::CosineIncident,
            }),
            is_along_light: self.incident == Some(IncidentName::AlongLight),
            is_saturated: self.saturated == Some(SaturatedName::LeaveOut),
            divide: self.divide,
            wavelengths: self.wavelengths,
            quarter: self.quarter.unwrap_or(Quarter::FrontReflection),
            band: self.band,
        }
    }
}
