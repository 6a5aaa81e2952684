//! The names of samplers, and whether the light is sampled beside them.

use std::fmt;
use std::str::FromStr;

/// What draws incident directions for a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SamplerName {
    /// The hemisphere evenly.
    Uniform,
    /// The cosine.
    Cosine,
    /// Modified Phong and a cosine.
    Phong,
    /// Ward's half vectors and a cosine.
    Ward,
    /// Visible normals of GGX and a cosine.
    Ggx,
    /// Lafortune's lobes.
    Lafortune,
    /// A tabulated inverse of the cumulative distribution.
    Tabulated,
    /// The factors of such a table.
    Factored,
    /// The warps of a `.bsdf` file.
    Rgl,
    /// GGX lobes of fixed roughness and a cosine.
    Guided,
    /// The thesis's lobes, by inversion.
    Thesis,
    /// The thesis's lobes, by its random walk.
    ThesisWalk,
    /// The thesis's lobes, several directions together.
    ThesisMulti,
    /// Our lobes.
    Lobes,
    /// Our lobes, several directions together.
    LobesMulti,
    /// Our lobes, and one direction in twenty from the cosine.
    Defensive,
}

/// All names, as they are written.
const NAMES: [(SamplerName, &str); 16] = [
    (SamplerName::Uniform, "uniform"),
    (SamplerName::Cosine, "cosine"),
    (SamplerName::Phong, "phong"),
    (SamplerName::Ward, "ward"),
    (SamplerName::Ggx, "ggx"),
    (SamplerName::Lafortune, "lafortune"),
    (SamplerName::Tabulated, "tabulated"),
    (SamplerName::Factored, "factored"),
    (SamplerName::Rgl, "rgl"),
    (SamplerName::Guided, "guided"),
    (SamplerName::Thesis, "thesis"),
    (SamplerName::ThesisWalk, "thesis-walk"),
    (SamplerName::ThesisMulti, "thesis-multi"),
    (SamplerName::Lobes, "lobes"),
    (SamplerName::LobesMulti, "lobes-multi"),
    (SamplerName::Defensive, "defensive"),
];

impl SamplerName {
    /// All of them.
    pub fn all() -> impl Iterator<Item = Self> {
        NAMES.iter().map(|entry| entry.0)
    }

    /// As it is written.
    pub fn text(self) -> &'static str {
        NAMES.iter().find(|entry| entry.0 == self).map_or("", |entry| entry.1)
    }

    /// Whether several directions of one outgoing direction are drawn together.
    pub fn is_multi(self) -> bool {
        matches!(self, Self::ThesisMulti | Self::LobesMulti)
    }
}

/// Whether the environment is sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Light {
    /// Beside the material, both weighted by the power heuristic.
    Mis,
    /// Not.
    Off,
    /// In place of the material; the material only leads the path on.
    Only,
    /// Together with what draws for the material, by sums of both without shadows, which two rays correct. Where a surface sees little
    /// of the light, as `Mis`.
    Even,
    /// Together with our lobes, by resampling candidates of both. Where a surface is sampled by something else, as `Mis`.
    Product,
}

/// How directions are chosen: a sampler of materials, and the use of the light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Strategy {
    pub sampler: SamplerName,
    pub light: Light,
}

impl Strategy {
    /// Lobes and the light.
    pub const MIS: Self = Self { sampler: SamplerName::Lobes, light: Light::Mis };

    /// Lobes and the light together.
    pub const PRODUCT: Self = Self { sampler: SamplerName::Lobes, light: Light::Product };

    /// Lobes and the light together, by even sums.
    pub const EVEN: Self = Self { sampler: SamplerName::Lobes, light: Light::Even };

    /// A sampler without the light.
    pub const fn alone(sampler: SamplerName) -> Self {
        Self { sampler, light: Light::Off }
    }
}

impl FromStr for Strategy {
    type Err = String;

    /// `SAMPLER`, `SAMPLER+mis`, `SAMPLER+even`, `mis` for `lobes+mis`, `even` for `lobes+even`, `product`, or `light`.
    fn from_str(text: &str) -> Result<Self, String> {
        if text == "light" {
            return Ok(Self { light: Light::Only, ..Self::MIS });
        }
        if text == "mis" {
            return Ok(Self::MIS);
        }
        if text == "even" {
            return Ok(Self::EVEN);
        }
        if text == "product" {
            return Ok(Self::PRODUCT);
        }
        let (name, light) = match text.rsplit_once('+') {
            Some((name, "mis")) => (name, Light::Mis),
            Some((name, "even")) => (name, Light::Even),
            _ => (text, Light::Off),
        };
        let found = NAMES.iter().find(|entry| entry.1 == name);
        found.map(|entry| Self { sampler: entry.0, light }).ok_or_else(|| {
            let names: Vec<&str> = NAMES.iter().map(|entry| entry.1).collect();
            format!(
                "expected even, mis, product, light, or one of {}, each with +mis, +even or without",
                names.join(", ")
            )
        })
    }
}

impl fmt::Display for Strategy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = match (self.sampler, self.light) {
            (_, Light::Only) => "light".to_owned(),
            (SamplerName::Lobes, Light::Even) => "even".to_owned(),
            (sampler, Light::Even) => format!("{}+even", sampler.text()),
            (_, Light::Product) => "product".to_owned(),
            (SamplerName::Lobes, Light::Mis) => "mis".to_owned(),
            (sampler, Light::Mis) => format!("{}+mis", sampler.text()),
            (sampler, Light::Off) => sampler.text().to_owned(),
        };
        f.pad(&text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_read_as_it_is_written() {
        for sampler in SamplerName::all() {
            for light in [Light::Off, Light::Mis, Light::Even] {
                let strategy = Strategy { sampler, light };
                assert_eq!(strategy.to_string().parse(), Ok(strategy));
            }
        }
        for text in ["mis", "even", "product", "light", "lobes", "defensive", "cosine", "uniform"] {
            assert_eq!(text.parse::<Strategy>().unwrap().to_string(), text);
        }
        for text in ["", "+mis", "ggx+", "GGX", "light+mis", "mis+mis"] {
            assert!(text.parse::<Strategy>().unwrap_err().contains("tabulated"), "{text}");
        }
    }
}
