//! The methods of a comparison: how directions are chosen, and which material is rendered with them.

use crate::shade::Strategy;
use std::fmt;
use std::str::FromStr;

/// The material of the object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// The material itself: its table, or its lobes.
    Itself,
    /// The lobes of its table: where they differ from the table, the picture has a bias.
    Fit,
}

/// A way to render a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Method {
    pub strategy: Strategy,
    pub reading: Reading,
}

/// Prefix of the name of a method that renders the lobes of a table.
const FIT: &str = "fit:";

impl Method {
    /// A way to sample the material itself.
    pub const fn of(strategy: Strategy) -> Self {
        Self { strategy, reading: Reading::Itself }
    }
}

impl FromStr for Method {
    type Err = String;

    /// A strategy, or `fit:` and a strategy.
    fn from_str(text: &str) -> Result<Self, String> {
        let (reading, strategy) = match text.strip_prefix(FIT) {
            Some(rest) => (Reading::Fit, rest),
            None => (Reading::Itself, text),
        };
        Ok(Self { strategy: strategy.parse()?, reading })
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.reading {
            Reading::Itself => self.strategy.fmt(f),
            Reading::Fit => f.pad(&format!("{FIT}{}", self.strategy)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_as_they_are_written() {
        for text in ["lobes", "product", "ggx+mis", "fit:product", "fit:lobes", "light"] {
            assert_eq!(text.parse::<Method>().unwrap().to_string(), text);
        }
        for text in ["", "fit:", "fit:fit:lobes", "fit"] {
            assert!(text.parse::<Method>().unwrap_err().contains("tabulated"), "{text}");
        }
        assert_eq!(format!("{:>12}|", "fit:lobes".parse::<Method>().unwrap()), "   fit:lobes|");
    }
}
