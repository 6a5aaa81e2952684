//! Models that people fit by hand: of soils and leaves, seas, polished and rough surfaces, cloth. A formula over a pair of directions each.

use super::parameters::Parameters;
use super::{dot, fresnel, half};
use crate::ReadError;
use crate::table::Brdf;
use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, FRAC_PI_4, PI};

/// A parameter: its name, default, and range.
type Parameter = (&'static str, f64, [f64; 2]);

/// A formula with its parameters.
struct Formula {
    name: &'static str,
    parameters: &'static [Parameter],
    value: fn(&[f64], &Angles) -> f64,
}

/// All of them.
const FORMULAS: [Formula; 9] = [
    // RossThick and LiSparseReciprocal, as MODIS has them: Lucht, Schaaf and Strahler 2000.
    Formula {
        name: "ross-li",
        parameters: &[("iso", 0.2, [0.0, 2.0]), ("vol", 0.1, [-2.0, 2.0]), ("geo", 0.03, [-2.0, 2.0])],
        value: ross_li,
    },
    // Rahman, Pinty and Verstraete 1993, "Coupled surface-atmosphere reflectance (CSAR) model 2".
    Formula {
        name: "rpv",
        parameters: &[("rho0", 0.1, [0.0, 1.0]), ("k", 0.7, [0.0, 2.0]), ("theta", -0.15, [-0.95, 0.95])],
        value: rpv,
    },
    // Hapke 1993, "Theory of Reflectance and Emittance Spectroscopy": isotropic multiple scattering, smooth.
    Formula {
        name: "hapke",
        parameters: &[
            ("w", 0.5, [0.0, 0.9999]),
            ("g", -0.2, [-0.95, 0.95]),
            ("b0", 1.0, [0.0, 10.0]),
            ("h", 0.06, [1e-4, 10.0]),
        ],
        value: hapke,
    },
    // Cox and Munk 1954, "Measurement of the Roughness of the Sea Surface": slopes by the wind in m/s, without shadows.
    Formula {
        name: "cox-munk",
        parameters: &[("wind", 5.0, [0.0, 40.0]), ("ior", 1.34, [1.01, 3.0])],
        value: cox_munk,
    },
    // Breault's fit of smooth scatterers over the distance of the sines: Pfisterer 2011, "Approximated scatter models".
    Formula {
        name: "abg",
        parameters: &[("a", 1e-3, [0.0, 1e3]), ("b", 1e-4, [1e-12, 1e3]), ("g", 2.0, [0.0, 10.0])],
        value: |p, at| p[0] / (p[1] + libm::pow(at.sines, p[2])),
    },
    // Harvey 1976, "Light-scattering characteristics of optical surfaces": height, shoulder and slope.
    Formula {
        name: "harvey-shack",
        parameters: &[("b0", 10.0, [0.0, 1e9]), ("l", 0.01, [1e-6, 10.0]), ("s", -2.0, [-10.0, 0.0])],
        value: |p, at| {
            let x = at.sines / p[1];
            p[0] * libm::pow(1.0 + x * x, 0.5 * p[2])
        },
    },
    // Oren and Nayar 1994, "Generalization of Lambert's reflectance model": without interreflections; sigma in radians.
    Formula {
        name: "oren-nayar",
        parameters: &[("albedo", 0.5, [0.0, 1.0]), ("sigma", 0.35, [0.0, FRAC_PI_2])],
        value: oren_nayar,
    },
    // Estevez and Kulla 2017, "Production Friendly Microfacet Sheen BRDF"; its visibility is Neubelt and Pettineo's of 2013.
    Formula {
        name: "sheen",
        parameters: &[("alpha", 0.5, [0.05, 1.0])],
        value: |p, at| {
            let inverse = 1.0 / p[0];
            let facets = (2.0 + inverse) * libm::pow(at.half_sine, inverse) * 0.5 * FRAC_1_PI;
            facets / (4.0 * (at.cos[0] + at.cos[1] - at.cos[0] * at.cos[1]))
        },
    },
    // Walter et al. 2007, "Microfacet Models for Refraction through Rough Surfaces": light through a plate that is rough in front and smooth
    // behind, without light that goes to and fro within. Both directions lie above the horizon; straight through is the mirror direction.
    Formula {
        name: "ground-glass",
        parameters: &[("alpha", 0.3, [0.01, 1.0]), ("ior", 1.5, [1.01, 3.0]), ("behind", 0.0, [0.0, 1.0])],
        value: ground_glass,
    },
];

/// The arguments of the formulas.
struct Angles {
    /// Both directions.
    pair: [[f64; 3]; 2],
    /// Cosines and tangents of both angles from the normal.
    cos: [f64; 2],
    tan: [f64; 2],
    /// Cosine of the difference of the azimuths, 1 on the side of the light.
    turn: f64,
    /// Cosine of the phase angle, between both directions: 1 where the light comes from.
    phase: f64,
    /// Distance of the sines from the mirror direction.
    sines: f64,
    /// Cosine of the half vector with the normal, its sine, and its cosine with either direction.
    half: f64,
    half_sine: f64,
    difference: f64,
}

impl Angles {
    fn of(wi: [f64; 3], wo: [f64; 3]) -> Self {
        let cos = [wi, wo].map(|d| d[2].max(1e-6));
        let across = [wi, wo].map(|d| libm::hypot(d[0], d[1]));
        let both = (across[0] * across[1]).max(f64::MIN_POSITIVE);
        let (h, difference) = half(wi, wo);
        Self {
            pair: [wi, wo],
            cos,
            tan: [0, 1].map(|k| across[k] / cos[k]),
            turn: ((wi[0] * wo[0] + wi[1] * wo[1]) / both).clamp(-1.0, 1.0),
            phase: dot(wi, wo).clamp(-1.0, 1.0),
            sines: libm::hypot(wi[0] + wo[0], wi[1] + wo[1]),
            half: h[2],
            half_sine: libm::hypot(h[0], h[1]),
            difference,
        }
    }

    /// Squared distance of the points in which both directions meet a plane above the surface.
    fn apart(&self) -> f64 {
        let [i, o] = self.tan;
        (i * i + o * o - 2.0 * i * o * self.turn).max(0.0)
    }
}

/// Henyey and Greenstein's phase function, over the cosine of the phase angle: `g` below 0 scatters back.
fn phase(g: f64, cos: f64) -> f64 {
    (1.0 - g * g) / libm::pow(1.0 + 2.0 * g * cos + g * g, 1.5)
}

fn ross_li(p: &[f64], at: &Angles) -> f64 {
    let [i, o] = at.cos;
    let (angle, sine) = (libm::acos(at.phase), libm::sqrt(1.0 - at.phase * at.phase));
    let volume = ((FRAC_PI_2 - angle) * at.phase + sine) / (i + o) - FRAC_PI_4;
    // Crowns as high as they are wide, whose centres are two of their radii above the ground.
    let secants = 1.0 / i + 1.0 / o;
    let across = at.tan[0] * at.tan[1];
    let square = at.apart() + across * across * (1.0 - at.turn * at.turn);
    let t = libm::acos((2.0 * libm::sqrt(square) / secants).min(1.0));
    let overlap = FRAC_1_PI * (t - libm::sin(t) * libm::cos(t)) * secants;
    let crowns = overlap - secants + 0.5 * (1.0 + at.phase) / (i * o);
    FRAC_1_PI * (p[0] + p[1] * volume + p[2] * crowns)
}

fn rpv(p: &[f64], at: &Angles) -> f64 {
    let [i, o] = at.cos;
    let bowl = libm::pow(i * o * (i + o), p[1] - 1.0);
    let spot = 1.0 + (1.0 - p[0]) / (1.0 + libm::sqrt(at.apart()));
    FRAC_1_PI * p[0] * bowl * phase(p[2], at.phase) * spot
}

fn hapke(p: &[f64], at: &Angles) -> f64 {
    let root = libm::sqrt(1.0 - p[0]);
    let multiple = |x: f64| (1.0 + 2.0 * x) / (1.0 + 2.0 * x * root);
    let tangent = libm::sqrt((1.0 - at.phase) / (1.0 + at.phase).max(1e-12));
    let opposition = 1.0 + p[2] / (1.0 + tangent / p[3]);
    let [i, o] = at.cos;
    p[0] / (4.0 * PI * (i + o)) * (opposition * phase(p[1], at.phase) + multiple(i) * multiple(o) - 1.0)
}

fn cox_munk(p: &[f64], at: &Angles) -> f64 {
    let squares = 0.003 + 0.00512 * p[0];
    let cosine = at.half * at.half;
    let slopes = libm::exp(-(1.0 - cosine) / (cosine * squares)) / (PI * squares);
    fresnel::dielectric(p[1], at.difference) * slopes / (4.0 * at.cos[0] * at.cos[1] * cosine * cosine)
}

fn oren_nayar(p: &[f64], at: &Angles) -> f64 {
    let squares = p[1] * p[1];
    let (a, b) = (1.0 - 0.5 * squares / (squares + 0.33), 0.45 * squares / (squares + 0.09));
    let sines = at.cos.map(|cos| libm::sqrt(1.0 - cos * cos));
    // The larger angle has the larger sine, the smaller one the smaller tangent.
    let lift = sines[0].max(sines[1]) * at.tan[0].min(at.tan[1]);
    FRAC_1_PI * p[0] * (a + b * at.turn.max(0.0) * lift)
}

/// `behind`: whether the viewer is on the smooth side.
fn ground_glass(p: &[f64], at: &Angles) -> f64 {
    let (alpha, ior) = (p[0], p[1]);
    let [wi, wo] = at.pair;
    // The direction on the rough side, and the other one in the glass, below.
    let (rough, smooth) = if p[2] >= 0.5 { (wi, wo) } else { (wo, wi) };
    let [x, y] = [smooth[0] / ior, smooth[1] / ior];
    let inside = [x, y, -libm::sqrt(1.0 - x * x - y * y)];
    let h = [0, 1, 2].map(|k| -(rough[k] + ior * inside[k]));
    let length = libm::sqrt(dot(h, h));
    // Of an index above 1 the half vector points into the glass.
    let h = h.map(|v| v / length);
    let (outer, inner) = (dot(rough, h), dot(inside, h));
    if h[2] <= 0.0 || outer <= 0.0 || inner >= 0.0 {
        return 0.0;
    }
    let squares = alpha * alpha;
    let facets = squares / (PI * libm::pow(h[2] * h[2] * (squares - 1.0) + 1.0, 2.0));
    let seen = |z: f64| 2.0 / (1.0 + libm::sqrt(1.0 + squares * (1.0 / (z * z) - 1.0)));
    let through = (1.0 - fresnel::dielectric(ior, outer)) * (1.0 - fresnel::dielectric(ior, smooth[2]));
    let spread = outer * -inner / (rough[2] * -inside[2] * libm::pow(outer + ior * inner, 2.0));
    spread * through * seen(rough[2]) * seen(-inside[2]) * facets
}

/// A model by one of the formulas.
pub struct ByHand {
    formula: &'static Formula,
    parameters: Vec<f64>,
    tint: [f64; 3],
}

impl ByHand {
    /// The model of a name, if there is one.
    pub(super) fn from_parameters(name: &str, p: &mut Parameters<'_>) -> Option<Result<Self, ReadError>> {
        let formula = FORMULAS.iter().find(|formula| formula.name == name)?;
        let mut make = || {
            let number = |(name, default, [low, high]): &Parameter| p.number(name, *default, *low..=*high);
            let parameters = formula.parameters.iter().map(number).collect::<Result<_, _>>()?;
            Ok(Self { formula, parameters, tint: p.colour("tint", 1.0)? })
        };
        Some(make())
    }
}

impl Brdf for ByHand {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let value = (self.formula.value)(&self.parameters, &Angles::of(wi, wo)).max(0.0);
        self.tint.map(|tint| tint * value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::direction;

    fn value(text: &str, theta_i: f64, theta_o: f64, turn: f64) -> f64 {
        let [i, o, turn] = [theta_i, theta_o, turn].map(f64::to_radians);
        let model = super::super::tests::parse(text).unwrap().brdf;
        model.evaluate(direction(i, 0.0), direction(o, turn))[0]
    }

    /// Values that were worked out by other hands, or follow from the formula on paper.
    #[test]
    fn values_are_those_of_the_sources() {
        for (text, [i, o, turn], expected) in [
            ("rpv", [35.0, 35.0, 0.0], 0.0936),
            ("rpv", [38.0, 38.0, 180.0], 0.0457),
            // Kernels at the normal are 0, so that it is Lambert's.
            ("ross-li:iso=0.3,vol=1,geo=1", [0.0, 0.0, 0.0], 0.3 / PI),
            // Ross's kernel at 45 degrees and the normal: (pi/4 cos 45 + sin 45) / (1 + cos 45) - pi/4.
            ("ross-li:iso=0.5,vol=1,geo=0", [45.0, 0.0, 0.0], (0.5 - 0.045_86) / PI),
            // Seeliger's law: single isotropic scattering of a dark ground.
            ("hapke:w=0.001,g=0,b0=0", [60.0, 0.0, 0.0], 0.001 / (4.0 * PI * 1.5)),
            ("cox-munk:wind=5", [0.0, 0.0, 0.0], (0.34 / 2.34f64).powi(2) / (4.0 * PI * 0.0286)),
            ("abg:a=1,b=2,g=1", [30.0, 0.0, 0.0], 1.0 / 2.5),
            ("harvey-shack:b0=8,l=0.5,s=-2", [30.0, 0.0, 0.0], 4.0),
            ("oren-nayar:albedo=1,sigma=0", [30.0, 60.0, 10.0], FRAC_1_PI),
            ("sheen:alpha=1", [0.0, 60.0, 0.0], 3.0 * 0.5 / (2.0 * PI) / 4.0),
        ] {
            let found = value(text, i, o, turn);
            assert!((found / expected - 1.0).abs() < 2e-3, "{text}: {found}, {expected}");
        }
    }

    /// Of a smooth plate all light that both faces let through goes straight on. Facets of a rough face reflect light beyond the critical
    /// angle back into the glass, up to a quarter of it here.
    #[test]
    fn ground_glass_transmits_what_its_faces_do() {
        for behind in [0, 1] {
            let sum = |alpha: f64, degrees: f64| {
                let model =
                    super::super::tests::parse(&format!("ground-glass:alpha={alpha},behind={behind}"))
                        .unwrap()
                        .brdf;
                super::super::tests::albedo(model.as_ref(), direction(degrees.to_radians(), 0.3), 0)
            };
            for degrees in [0.0f64, 40.0] {
                let faces = (1.0 - fresnel::dielectric(1.5, libm::cos(degrees.to_radians()))).powi(2);
                let smooth = sum(0.02, degrees);
                assert!((smooth / faces - 1.0).abs() < 0.01, "{behind} {degrees}: {smooth} {faces}");
                let rough = sum(0.3, degrees);
                assert!(rough < smooth && rough > 0.75 * smooth, "{behind} {degrees}: {rough} {smooth}");
            }
        }
        // Light the other way is the same, seen from behind.
        let pair = [direction(0.3, 0.2), direction(0.7, 2.9)];
        let value = |behind: usize, [wi, wo]: [[f64; 3]; 2]| {
            super::super::tests::parse(&format!("ground-glass:behind={behind}"))
                .unwrap()
                .brdf
                .evaluate(wi, wo)[0]
        };
        assert_eq!(value(0, pair), value(1, [pair[1], pair[0]]));
        assert!(value(0, pair) > 0.0 && value(0, pair) != value(1, pair));
    }

    #[test]
    fn soils_are_brightest_where_the_light_comes_from() {
        for text in ["ross-li", "rpv", "hapke", "oren-nayar"] {
            assert!(value(text, 45.0, 45.0, 0.0) > value(text, 45.0, 45.0, 180.0), "{text}");
        }
    }
}
