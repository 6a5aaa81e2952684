//! The albedo of a table by quadrature, tabulated over the outgoing direction. It knows nothing of how the table is sampled, so
//! that one can be held against the other.

use super::MeasuredMaterial;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Angles of the outgoing direction, and azimuths of anisotropic materials.
const THETAS: usize = 256;
const COARSE_THETAS: usize = 64;
const AZIMUTHS: usize = 32;

/// Rings round the mirror direction and spokes of the quadrature, of isotropic and of anisotropic materials.
const RINGS: [usize; 2] = [256, 128];
const SPOKES: [usize; 2] = [128, 64];

/// Smallest cosine of a tabulated outgoing direction: the least that the renderer shades with.
const LEAST_COSINE: f64 = 1e-3;

/// The albedo over the outgoing direction.
pub struct AlbedoTable {
    thetas: usize,
    azimuths: usize,
    /// Theta fastest.
    albedo: Vec<DVec3>,
}

impl AlbedoTable {
    /// Integrates a table; a few seconds.
    pub fn new(material: &MeasuredMaterial) -> Self {
        let is_isotropic = material.is_isotropic();
        let (thetas, azimuths) = if is_isotropic { (THETAS, 1) } else { (COARSE_THETAS, AZIMUTHS) };
        let at = |n: usize| {
            let theta = FRAC_PI_2 * (n % thetas) as f64 / (thetas - 1) as f64;
            let theta = theta.min(LEAST_COSINE.acos());
            let azimuth = PI + TAU * (n / thetas) as f64 / azimuths as f64;
            let wo = DVec3::new(theta.sin() * azimuth.cos(), theta.sin() * azimuth.sin(), theta.cos());
            let fine = usize::from(!is_isotropic);
            albedo(material, wo, RINGS[fine], SPOKES[fine])
        };
        Self { thetas, azimuths, albedo: (0..thetas * azimuths).into_par_iter().map(at).collect() }
    }

    /// The albedo towards an outgoing direction, a unit vector in the shading frame; linear sRGB.
    pub fn at(&self, wo: Vec3) -> DVec3 {
        let wo = wo.as_dvec3();
        let place = wo.z.clamp(0.0, 1.0).acos() / FRAC_PI_2 * (self.thetas - 1) as f64;
        let theta = (place as usize).min(self.thetas - 2);
        let turns = (wo.y.atan2(wo.x) - PI) / TAU;
        let turned = (turns - turns.floor()) * self.azimuths as f64;
        let azimuth = (turned as usize).min(self.azimuths - 1);
        let row = |azimuth: usize| {
            let n = (azimuth % self.azimuths) * self.thetas + theta;
            self.albedo[n].lerp(self.albedo[n + 1], place - theta as f64)
        };
        row(azimuth).lerp(row(azimuth + 1), turned - azimuth as f64)
    }
}

/// The albedo, in polar coordinates about the mirror direction: the angle is a third power, so that a peak of any width has
/// rings, and every ring is turned by the golden section against the one before.
fn albedo(material: &MeasuredMaterial, wo: DVec3, rings: usize, spokes: usize) -> DVec3 {
    let mirror = DVec3::new(-wo.x, -wo.y, wo.z);
    let (tangent, bitangent) = mirror.any_orthonormal_pair();
    let mut sum = DVec3::ZERO;
    for ring in 0..rings {
        let u = (ring as f64 + 0.5) / rings as f64;
        let (sin, cos) = (PI * u * u * u).sin_cos();
        let share = sin * 3.0 * PI * u * u / rings as f64 * TAU / spokes as f64;
        let mut on_ring = DVec3::ZERO;
        for spoke in 0..spokes {
            let turn = TAU * (spoke as f64 + (0.618_033_988_75 * ring as f64).fract()) / spokes as f64;
            let (s, c) = turn.sin_cos();
            on_ring += material.f_cos(mirror * cos + (tangent * c + bitangent * s) * sin, wo);
        }
        sum += share * on_ring;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::random::Random;
    use crate::shade::shader::{Scattering, Shader};
    use crate::truth::measured::tests::{model, vivid};
    use std::f32::consts::TAU as TAU_F32;

    #[test]
    fn samples_and_quadrature_agree() {
        let lobe = "model:ggx:alpha_x=0.05,alpha_y=0.2,f0=0.9/0.5/0.1,diffuse=0.05";
        let materials = [
            model("model:lambert:albedo=0.6/0.2/0.1"),
            model("model:ggx:alpha=0.004,ior=1.5"),
            model(lobe),
            vivid(),
        ];
        for material in materials {
            let table = AlbedoTable::new(&material);
            for (degrees, azimuth) in
                [(0.0f32, 0.0), (30.0, 0.2 * TAU_F32), (65.0, -0.4 * TAU_F32), (83.0, 0.0)]
            {
                let (sin, cos) = degrees.to_radians().sin_cos();
                let wo = Vec3::new(sin * azimuth.cos(), sin * azimuth.sin(), cos);
                let (mut random, n) = (Random::new(5, 6, 7), 40_000);
                let mut scattering = Scattering::empty();
                Shader::from(&material).prepare(wo, &mut scattering).unwrap();
                let (mut mean, mut squares) = (DVec3::ZERO, DVec3::ZERO);
                for _ in 0..n {
                    let drawn = scattering.sample([random.unit(), random.unit(), random.unit()]);
                    let weight = drawn.map_or(DVec3::ZERO, |s| s.weight.as_dvec3());
                    mean += weight / f64::from(n);
                    squares += weight * weight / f64::from(n);
                }
                let error = ((squares - mean * mean) / f64::from(n)).max(DVec3::ZERO).map(f64::sqrt);
                let expected = table.at(wo);
                // Beside chance, the table is interpolated.
                let allowed = 4.5 * error + 2e-3 * expected.abs();
                let name = &material.name;
                assert!(
                    (mean - expected).abs().cmple(allowed).all(),
                    "{name} {degrees}: {mean} {expected} +- {error}"
                );
                // A sampler that finds the highlight: the standard deviation is about the mean.
                let spread = error.max_element() * f64::from(n).sqrt() / expected.abs().max_element();
                assert!(spread < 1.5, "{name} {degrees}: standard deviation {spread} of the mean");
            }
        }
    }

    #[test]
    fn the_matte_has_the_albedo_in_its_name() {
        let table = AlbedoTable::new(&model("model:lambert:albedo=0.6/0.2/0.1"));
        for z in [0.001, 0.3, 1.0] {
            let found = table.at(Vec3::new((1.0f32 - z * z).sqrt(), 0.0, z));
            assert!((found - DVec3::new(0.6, 0.2, 0.1)).abs().max_element() < 3e-5, "{found}");
        }
    }

    #[test]
    #[ignore = "needs SRBF_DATA_DIR"]
    fn measured_tables_have_the_albedo_that_another_renderer_finds() {
        // By mitsuba 3.9.1 (`measured`) at 5, 45 and 75 degrees, to the digits that are given. Mirror-like tables are not among
        // them: that grid was too coarse for theirs.
        let folder = std::env::var("SRBF_DATA_DIR").expect("SRBF_DATA_DIR names the folder of the data");
        for (name, digits, expected) in [
            ("aurora_white", 0.01, [[0.69, 0.76, 0.70], [0.68, 0.74, 0.70], [0.74, 0.76, 0.75]]),
            (
                "cm_military_green",
                1e-3,
                [[0.065, 0.084, 0.060], [0.076, 0.097, 0.070], [0.252, 0.268, 0.243]],
            ),
            ("vch_golden_yellow", 0.01, [[0.52, 0.31, 0.021], [0.50, 0.29, 0.034], [0.37, 0.28, 0.19]]),
        ] {
            let table = AlbedoTable::new(&model(&format!("{folder}/rgl/{name}_rgb.bsdf")));
            for (degrees, expected) in [5.0f32, 45.0, 75.0].into_iter().zip(expected.map(DVec3::from)) {
                let (sin, cos) = degrees.to_radians().sin_cos();
                let found = table.at(Vec3::new(-sin, 0.0, cos));
                // Half a digit, and a little for their integration.
                let deviation = (found - expected).abs().max_element();
                assert!(deviation < 0.55 * digits, "{name} {degrees}: {found} {expected}");
            }
        }
    }
}
