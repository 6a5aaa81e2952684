//! `cargo lab residuals`.

use anyhow::{Context, bail};
use srbf_core::Material;
use srbf_fit::judge::method::Fitted;
use srbf_fit::judge::report::ViewReport;
use srbf_fit::read::{Content, read};
use srbf_fit::table::{Brdf, evaluation_views};
use srbf_fit::{Settings, fit_content};
use srbf_reference_renderer::command::argument;
use std::f64::consts::PI;
use std::path::PathBuf;
use std::sync::Arc;

/// Prints how much of the residual of fits is odd in the cosine of the azimuth of the difference vector, and how much is noise.
///
/// That part changes its sign when the two directions change places. Factors without a sign are the same both ways, so they cannot make it. For the
/// measured tables of the folder that SRBF_DATA_DIR names, the residual is the logarithm of the luminance of table over fit,
/// farther than 15 degrees from the mirror direction. Columns: the share of its square that is odd; the share of the odd part
/// that a signed table of 12 x 6 x 3 nodes explains, made of one half of the pairs and judged on the other; and their product.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Only tables whose names contain this
    #[arg(long, value_name = "NAME", default_value = "")]
    only: String,
    /// A folder of fits that `survey --materials` wrote; else the tables are fitted
    #[arg(long, value_name = "DIR")]
    materials: Option<PathBuf>,
    /// Also fits each table without its noise, and prints the errors of both fits beside the table with its noise
    #[arg(long)]
    without_noise: bool,
}

/// Pairs of directions, and the largest angle from the normal, radians.
const PAIRS: usize = 6000;
const LARGEST: f64 = 75.0 * PI / 180.0;
/// Angle from the mirror direction where the peak ends, radians.
const PEAK: f64 = 15.0 * PI / 180.0;
/// Least luminance over the mean.
const FLOOR: f64 = 0.01;
/// Nodes over half angle, difference angle and the size of the cosine of the azimuth.
const NODES: [usize; 3] = [12, 6, 3];

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<()> {
    println!("processor: {}", srbf_core::Processor::this());
    let more = if args.without_noise { " luminance, colour | of a fit without noise |" } else { "" };
    println!(
        "| material | odd, % of the squared residual | explained by a signed table, % of it | gain, % |{more}"
    );
    println!("|---|---|---|---|{}", if args.without_noise { "---|---|" } else { "" });
    for file in crate::survey::rgl_files(&argument::data_folder()?)? {
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if !name.contains(&args.only) {
            continue;
        }
        let Content::Evaluable(brdf) = read(&file)?.content else { bail!("{name}: samples") };
        let brdf: Arc<dyn Brdf + Send> = Arc::from(brdf);
        let fitted = |table: Smoothed| -> anyhow::Result<Vec<u8>> {
            let content = Content::Evaluable(Box::new(table));
            Ok(fit_content(&content, &Settings::default(), |_| {}).with_context(|| name.clone())?.bytes)
        };
        let bytes = match &args.materials {
            Some(folder) => {
                let path = folder.join(&name).with_extension("srbf");
                std::fs::read(&path).with_context(|| path.display().to_string())?
            }
            None => fitted(Smoothed { brdf: brdf.clone(), is_smooth: false })?,
        };
        let fit = Material::from_bytes(bytes.as_slice())?;
        let found = OddPart::new(brdf.as_ref(), &fit)?;
        let [odd, explained] = [found.share, found.explained].map(|share| 100.0 * share);
        let mut line = format!("| {name} | {odd:.0} | {explained:.0} | {:.1} |", odd * explained / 100.0);
        if args.without_noise {
            let smooth = fitted(Smoothed { brdf: brdf.clone(), is_smooth: true })?;
            for fit in [&fit, &Material::from_bytes(smooth.as_slice())?] {
                let [luminance, colour] = errors(brdf.as_ref(), fit)?;
                line += &format!(" {:.1} %, {colour:.3} |", 100.0 * luminance);
            }
        }
        println!("{line}");
    }
    Ok(())
}

/// Means of the errors of luminance and colour off the peak, at 5, 30 and 60 degrees.
fn errors(brdf: &dyn Brdf, fit: &dyn Fitted) -> anyhow::Result<[f64; 2]> {
    let table = evaluation_views::judging_table(brdf, &[5.0, 30.0, 60.0].map(f64::to_radians))?;
    let mut sums = [0.0; 2];
    for view in &table.views {
        let found = ViewReport::judge(fit, view)?.regions;
        sums[0] += found.luminance / table.views.len() as f64;
        sums[1] += found.chroma / table.views.len() as f64;
    }
    Ok(sums)
}

/// A table, as it is or averaged over cones away from the peak.
struct Smoothed {
    brdf: Arc<dyn Brdf + Send>,
    is_smooth: bool,
}

/// Directions of a cone, its half angle, radians, and the angles from the mirror direction, radians, between which it opens.
const CONE: usize = 12;
const CONE_ANGLE: f64 = 3.0 * PI / 180.0;
const OPENS: (f64, f64) = (PEAK, 1.4 * PEAK);

impl Brdf for Smoothed {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let from_mirror = (-wo[0] * wi[0] - wo[1] * wi[1] + wo[2] * wi[2]).clamp(-1.0, 1.0).acos();
        let open = ((from_mirror - OPENS.0) / (OPENS.1 - OPENS.0)).clamp(0.0, 1.0);
        if !self.is_smooth || open == 0.0 {
            return self.brdf.evaluate(wi, wo);
        }
        let across = if wi[1].abs() < 0.9 { [0.0, 1.0, 0.0] } else { [1.0, 0.0, 0.0] };
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let unit = |v: [f64; 3]| {
            let length = v.iter().map(|v| v * v).sum::<f64>().sqrt();
            v.map(|v| v / length)
        };
        let u = unit(cross(across, wi));
        let v = cross(wi, u);
        let mut sum = [0.0; 3];
        for n in 0..CONE {
            let angle = open * CONE_ANGLE * ((n as f64 + 0.5) / CONE as f64).sqrt();
            let (st, ct) = (2.399_963_229_728_653 * n as f64).sin_cos();
            let mut d = [0, 1, 2].map(|k| wi[k] * angle.cos() + angle.sin() * (u[k] * ct + v[k] * st));
            d[2] = d[2].abs().max(0.02);
            let value = self.brdf.evaluate(unit(d), wo);
            (0..3).for_each(|c| sum[c] += value[c] / CONE as f64);
        }
        sum
    }
}

/// The odd part of a residual.
#[derive(Clone, Copy, Debug)]
struct OddPart {
    /// Its share of the squared residual.
    share: f64,
    /// The share of its square that a signed table takes away, on pairs that the table was not made of.
    explained: f64,
}

/// A pair of directions: its node, and the odd part of the residual.
type Odd = (usize, f64);

impl OddPart {
    fn new(brdf: &dyn Brdf, fit: &dyn Fitted) -> anyhow::Result<Self> {
        let spread = |n: usize, step: f64| (0.5 + step * n as f64).fract();
        let mut pairs = Vec::with_capacity(PAIRS);
        for n in 0..PAIRS {
            // Evenly over the projected solid angle.
            let theta = |u: f64| (LARGEST.sin() * u.sqrt()).asin();
            let (a, b) = (theta(spread(n, 0.819_172_513_4)), theta(spread(n, 0.671_043_606_7)));
            let azimuth = PI * spread(n, 0.549_700_477_9);
            pairs.push((a, b, azimuth));
        }
        // Fits see the half of each view with such azimuths, and take the other for its mirror image.
        let table =
            |a: f64, b: f64, azimuth: f64| luminance(brdf.evaluate(direction(b, azimuth), direction(a, PI)));
        let values = pairs.iter().map(|&(a, b, azimuth)| -> anyhow::Result<[[f64; 2]; 2]> {
            let fitted = |a: f64, b: f64| -> anyhow::Result<f64> {
                let wi = direction(b, azimuth);
                Ok(luminance(fit.view(a)?.f_cos(wi)) / wi[2])
            };
            Ok([[table(a, b, azimuth), table(b, a, azimuth)], [fitted(a, b)?, fitted(b, a)?]])
        });
        let values = values.collect::<anyhow::Result<Vec<_>>>()?;
        let mean = values.iter().map(|v| v[0][0]).sum::<f64>() / PAIRS as f64;
        let floor = FLOOR * mean;
        let (mut squares, mut odd_square, mut odds) = (0.0, 0.0, Vec::<Odd>::new());
        for (&(a, b, azimuth), [table, fitted]) in pairs.iter().zip(&values) {
            let (wo, wi) = (direction(a, PI), direction(b, azimuth));
            let from_mirror = -wo[0] * wi[0] - wo[1] * wi[1] + wo[2] * wi[2];
            if from_mirror > PEAK.cos() {
                continue;
            }
            let residual = |n: usize| ((table[n].max(0.0) + floor) / (fitted[n].max(0.0) + floor)).ln();
            let (one, other) = (residual(0), residual(1));
            let odd = 0.5 * (one - other);
            squares += 0.5 * (one * one + other * other);
            odd_square += odd * odd;
            // A pair with a positive cosine of the azimuth, or its swap with the sign changed.
            let (node, sign) = node(wi, wo);
            odds.push((node, sign * odd));
        }
        let (made, judged): (Vec<_>, Vec<_>) = odds.iter().enumerate().partition(|(n, _)| n % 2 == 0);
        let mut sums = vec![(0.0, 0.0); NODES.iter().product()];
        for (_, (node, odd)) in made {
            sums[*node].0 += odd;
            sums[*node].1 += 1.0;
        }
        let (mut before, mut after) = (0.0, 0.0);
        for (_, (node, odd)) in judged {
            // As if one more pair had said that there is none.
            let said = sums[*node].0 / (sums[*node].1 + 1.0);
            before += odd * odd;
            after += (odd - said) * (odd - said);
        }
        Ok(Self { share: odd_square / squares, explained: (1.0 - after / before).max(0.0) })
    }
}

/// The node of a pair of directions, and the sign of the cosine of its azimuth.
fn node(wi: [f64; 3], wo: [f64; 3]) -> (usize, f64) {
    let sum = [0, 1, 2].map(|k| wi[k] + wo[k]);
    let length = sum.iter().map(|v| v * v).sum::<f64>().sqrt();
    let h = sum.map(|v| v / length);
    let cos = (0.5 * length).min(1.0);
    // The parts of wi and of the normal that are perpendicular to h, and the cosine of the angle between them.
    let aside = [0, 1, 2].map(|k| wi[k] - h[k] * cos);
    let normal = [-h[0] * h[2], -h[1] * h[2], 1.0 - h[2] * h[2]];
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let azimuth = dot(aside, normal) / (dot(aside, aside) * dot(normal, normal)).sqrt().max(1e-12);
    let at = |v: f64, nodes: usize| ((v * nodes as f64) as usize).min(nodes - 1);
    let half = at((h[2].min(1.0).acos() / (0.5 * PI)).sqrt(), NODES[0]);
    let difference = at(cos.acos() / (0.5 * PI), NODES[1]);
    let plane = at(azimuth.abs(), NODES[2]);
    ((plane * NODES[0] + half) * NODES[1] + difference, azimuth.signum())
}

fn luminance(rgb: [f64; 3]) -> f64 {
    0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]
}

fn direction(theta: f64, azimuth: f64) -> [f64; 3] {
    let ((st, ct), (sp, cp)) = (theta.sin_cos(), azimuth.sin_cos());
    [st * cp, st * sp, ct]
}

#[cfg(test)]
mod tests {
    use super::*;
    use srbf_fit::FitError;
    use srbf_fit::judge::method::FittedView;

    /// A grey surface, brighter the more the light is on one side.
    struct Tilted(f64);

    impl Brdf for Tilted {
        fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
            let wavy = 0.3 * (7.0 * (wi[0] * wo[0] + wi[1] * wo[1])).sin();
            [0.1 * (wavy + self.0 * (wi[2] - wo[2])).exp(); 3]
        }
    }

    struct Grey;
    struct GreyView;

    impl Fitted for Grey {
        fn view(&self, _: f64) -> Result<Box<dyn FittedView + '_>, FitError> {
            Ok(Box::new(GreyView))
        }
    }

    impl FittedView for GreyView {
        fn f_cos(&self, wi: [f64; 3]) -> [f64; 3] {
            [0.1 * wi[2]; 3]
        }
    }

    #[test]
    fn the_part_that_changes_its_sign_is_told_from_the_rest() {
        let even = OddPart::new(&Tilted(0.0), &Grey).unwrap();
        assert!(even.share < 1e-12, "{even:?}");
        let both = OddPart::new(&Tilted(0.6), &Grey).unwrap();
        assert!(both.share > 0.2 && both.share < 0.95 && both.explained > 0.5, "{both:?}");
    }

    #[test]
    fn a_swapped_pair_has_the_same_node_and_the_other_sign() {
        for n in 0..50 {
            let (a, b) = (direction(0.03 * f64::from(n), 2.0), direction(0.7, f64::from(n)));
            let (one, other) = (node(a, b), node(b, a));
            assert!(one.0 == other.0 && one.1 == -other.1, "{n}: {one:?} {other:?}");
        }
    }
}
