//! `cargo lab made-tables`.

use anyhow::bail;
use srbf_fit::export;
use srbf_fit::read::{Content, read};
use srbf_fit::table::Brdf;
use srbf_reference_renderer::out::output;
use std::path::PathBuf;

/// Writes tables whose truth is known: sums of models, as RGL files.
///
/// No threshold or number of the fit was chosen by them. `made_flake` has a clear coat over flakes whose colour follows both the half
/// angle and the difference angle, and which are brighter in the plane of incidence. `made_coated` is a rough copper under two coats, one
/// of them hazy. `made_pearl` has a diffuse ground, a ring round the highlight, and a part about the back direction.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The folder to write into
    output: PathBuf,
}

/// A surface of several parts.
struct Made {
    models: Vec<Box<dyn Brdf + Send>>,
    pigment: Option<Pigment>,
    /// Height and width, radians, of a lobe about the back direction.
    retro: Option<[f64; 2]>,
    /// Factor on the sum, so that less than all light is reflected.
    scale: f64,
}

/// Flakes or plates that interfere: their colour is that of a thin film, whose order follows the difference angle.
struct Pigment {
    height: f64,
    /// Half angle of the ring where they are brightest, and its width, radians.
    ring: f64,
    width: f64,
    /// Order of the film for green light that falls straight in.
    order: f64,
    /// How much brighter they are in the plane of incidence than across it, as a share.
    along: f64,
}

/// Wavelengths of the channels over that of green.
const WAVELENGTHS: [f64; 3] = [1.11, 1.0, 0.85];
/// Index of refraction of a film.
const FILM: f64 = 1.6;

impl Pigment {
    fn value(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let sum = [0, 1, 2].map(|k| wi[k] + wo[k]);
        let apart = [0, 1, 2].map(|k| wi[k] - wo[k]);
        let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| a[k] * b[k]).sum::<f64>();
        let length = dot(sum, sum).sqrt().max(1e-12);
        let half = (sum[2] / length).min(1.0).acos();
        let cos_difference = (0.5 * length).min(1.0);
        // Squared cosine of the azimuth round the half vector, from the normal; smooth where there is none.
        let across = sum[0] * sum[0] + sum[1] * sum[1];
        let azimuth = apart[2].powi(2) * length * length / (dot(apart, apart) * across).max(1e-9);
        let smooth = (half / 0.3).min(1.0).powi(2) * (1.0 - cos_difference.powi(2));
        let along = 1.0 + self.along * (azimuth.min(1.0) - 0.5) * smooth;
        let bright = self.height * along * (-((half - self.ring) / self.width).powi(2)).exp();
        let inside = (1.0 - (1.0 - cos_difference.powi(2)) / (FILM * FILM)).sqrt();
        WAVELENGTHS.map(|length| {
            let phase = std::f64::consts::TAU * self.order * inside / length;
            bright * (0.55 - 0.45 * phase.cos())
        })
    }
}

impl Brdf for Made {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let mut sum = self.pigment.as_ref().map_or([0.0; 3], |pigment| pigment.value(wi, wo));
        for model in &self.models {
            let value = model.evaluate(wi, wo);
            (0..3).for_each(|c| sum[c] += value[c]);
        }
        if let Some([height, width]) = self.retro {
            let apart: f64 = (0..3).map(|k| (wi[k] - wo[k]).powi(2)).sum();
            sum.iter_mut().for_each(|v| *v += height * (-apart / (width * width)).exp());
        }
        sum.map(|v| self.scale * v)
    }
}

fn models(texts: &[&str]) -> anyhow::Result<Vec<Box<dyn Brdf + Send>>> {
    let model = |text: &&str| match read(format!("model:{text}").as_ref())?.content {
        Content::Evaluable(brdf) => Ok(brdf),
        Content::Samples(_) => bail!("{text}: no model"),
    };
    texts.iter().map(model).collect()
}

fn all() -> anyhow::Result<[(&'static str, Made); 3]> {
    Ok([
        (
            "made_flake",
            Made {
                models: models(&["ggx:alpha=0.05,ior=1.5", "ggx:alpha=0.45,f0=0.04/0.05/0.07"])?,
                pigment: Some(Pigment { height: 0.25, ring: 0.0, width: 0.3, order: 2.2, along: 0.5 }),
                retro: None,
                scale: 1.0,
            },
        ),
        (
            "made_coated",
            Made {
                models: models(&[
                    "ggx:alpha=0.3,f0=0.5/0.25/0.12",
                    "ggx:alpha=0.04,ior=1.5",
                    "ggx:alpha=0.16,ior=1.25",
                ])?,
                pigment: None,
                retro: None,
                scale: 0.85,
            },
        ),
        (
            "made_pearl",
            Made {
                models: models(&["ggx:alpha=0.12,ior=1.5,diffuse=0.35/0.3/0.28"])?,
                pigment: Some(Pigment { height: 0.12, ring: 0.35, width: 0.15, order: 1.4, along: 0.3 }),
                retro: Some([0.1, 0.25]),
                scale: 1.0,
            },
        ),
    ])
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    for (name, made) in all()? {
        let path = args.output.join(format!("{name}.bsdf"));
        output::write(&path, &export::rgl(&made, None)?)?;
        println!("wrote {}", path.display());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use srbf_fit::table::direction;

    #[test]
    fn made_surfaces_are_reciprocal_and_reflect_less_than_all() {
        for (name, made) in all().unwrap() {
            for i in 0..20 {
                let at = |n: usize| direction(0.07 * ((i * n) % 20) as f64, 0.9 * (i + n) as f64);
                let (wi, wo) = (at(3), at(7));
                let (there, back) = (made.evaluate(wi, wo), made.evaluate(wo, wi));
                assert!((0..3).all(|c| (there[c] - back[c]).abs() < 1e-9 * (1.0 + there[c])), "{name}");
            }
            let table =
                srbf_fit::table::evaluation_views::judging_table(&made, &[0.0, 0.7, 1.3, 1.45]).unwrap();
            let albedos: Vec<f64> = table.views.iter().flat_map(|view| view.albedo).collect();
            assert!(albedos.iter().all(|a| (0.02..1.0).contains(a)), "{name}: {albedos:?}");
        }
    }
}
