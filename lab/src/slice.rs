//! `srbf-lab slice`: the lobes of a material over a slice of its BRDF, as docs/start.md shows them.

use anyhow::{anyhow, ensure};
use plotters::prelude::*;
use srbf_core::{Domain, Lobe, MAX_LOBES, Mixture, Vec3, luminance};
use srbf_reference_renderer::out::output;
use srbf_reference_renderer::out::panel;
use srbf_reference_renderer::out::picture_file;
use srbf_reference_renderer::truth::stored::StoredMaterial;
use std::path::PathBuf;

/// Draws the lobes of a material over the plane of incidence: each by itself, the diffuse term, and their sum.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// A .srbf file without factors, or the name of a preset
    #[arg(value_name = "FILE|PRESET")]
    material: String,
    /// Angle of the outgoing direction from the normal, degrees
    #[arg(long, default_value_t = 40.0)]
    view: f32,
    /// The picture to write, .png
    #[arg(short, long, default_value = "out/slice.png", value_name = "FILE")]
    output: PathBuf,
}

const SIZE: [u32; 2] = [900, 420];

/// Points of a curve, from -90 to 90 degrees.
const POINTS: usize = 720;

/// Luminance of f cos over the angle of the incident direction in degrees; the mirror side is positive.
type Curve = Vec<(f32, f32)>;

/// The subject of a slice.
struct Slice {
    sum: Curve,
    lobes: Vec<Curve>,
    diffuse: Curve,
}

/// Runs the command.
pub fn run(args: Args) -> anyhow::Result<()> {
    output::check_extension(&args.output, "png")?;
    output::check_place(&args.output)?;
    ensure!((0.0..90.0).contains(&args.view), "--view {}: from 0 to less than 90 degrees", args.view);
    let stored = StoredMaterial::load(&args.material)?;
    ensure!(stored.material.factor_nodes().is_none(), "{}: factors are no lobes", args.material);
    let slice = Slice::of(&stored, args.view.to_radians())?;
    let title = format!("{}, seen from {} degrees", stored.name, args.view);
    let mut pixels = vec![255; 3 * (SIZE[0] * SIZE[1]) as usize];
    draw(&mut pixels, &slice, &title)
        .map_err(|error| anyhow!("cannot plot {}: {error}", args.output.display()))?;
    picture_file::write_png(&args.output, SIZE, &pixels)?;
    println!("{}: {} lobes", args.output.display(), slice.lobes.len());
    Ok(())
}

impl Slice {
    fn of(stored: &StoredMaterial, view: f32) -> anyhow::Result<Self> {
        let mut mixture = Mixture::<MAX_LOBES>::empty();
        stored.material.prepare([-view.sin(), 0.0, view.cos()], &mut mixture)?;
        let lobe = |k: usize| -> anyhow::Result<Curve> {
            let lobes = [mixture.lobe(k).expect("k is below the number of lobes")];
            let (squeezed, round): (&[Lobe], &[Lobe]) =
                if k < mixture.squeezed_len() { (&lobes, &[]) } else { (&[], &lobes) };
            let alone = Mixture::<16>::new(Domain::Hemisphere, mixture.squeeze(), squeezed, round)?;
            Ok(curve(|wi| alone.evaluate(wi)))
        };
        Ok(Self {
            sum: curve(|wi| mixture.evaluate(wi)),
            lobes: (0..mixture.len()).map(lobe).collect::<Result<_, _>>()?,
            diffuse: curve(|wi| mixture.diffuse() * wi.z / std::f32::consts::PI),
        })
    }
}

fn curve(value: impl Fn(Vec3) -> Vec3) -> Curve {
    let at = |n: usize| {
        let degrees = 180.0 * n as f32 / POINTS as f32 - 90.0;
        let (sin, cos) = degrees.to_radians().sin_cos();
        (degrees, luminance(value(Vec3::new(sin, 0.0, cos.max(0.0)))))
    };
    (0..=POINTS).map(at).collect()
}

fn draw(pixels: &mut [u8], slice: &Slice, title: &str) -> Result<(), panel::Failure> {
    panel::register_font()?;
    let root = BitMapBackend::with_buffer(pixels, (SIZE[0], SIZE[1])).into_drawing_area();
    let most = slice.sum.iter().map(|p| p.1).fold(0.0, f32::max);
    let mut chart = ChartBuilder::on(&root)
        .margin(10)
        .margin_right(panel::RIGHT_MARGIN)
        .x_label_area_size(40)
        .y_label_area_size(60)
        .caption(title, (panel::FONT, 18))
        .build_cartesian_2d(-90.0f32..90.0, 0.0..1.05 * most)?;
    chart
        .configure_mesh()
        .x_desc("wi, degrees from the normal; mirror side right")
        .y_desc("f cos, 1/sr")
        .x_labels(13)
        .x_label_formatter(&|degrees| format!("{degrees:.0}"))
        .y_labels(6)
        .label_style((panel::FONT, 14))
        .axis_desc_style((panel::FONT, 15))
        .light_line_style(WHITE)
        .draw()?;
    let colours = panel::COLOURS;
    let named = [
        ("a lobe", slice.lobes.as_slice(), colours[5].stroke_width(2)),
        ("the diffuse term", std::slice::from_ref(&slice.diffuse), colours[2].stroke_width(2)),
        ("the mixture: their sum", std::slice::from_ref(&slice.sum), colours[1].stroke_width(3)),
    ];
    for (name, curves, style) in named {
        for (n, curve) in curves.iter().enumerate() {
            let series = chart.draw_series(LineSeries::new(curve.iter().copied(), style))?;
            if n == 0 {
                series.label(name).legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], style));
            }
        }
    }
    panel::draw_legend(&mut chart, SeriesLabelPosition::UpperLeft, 15)?;
    root.present()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lobes_and_diffuse_term_make_the_sum() {
        let stored = StoredMaterial::load("garnet_red").unwrap();
        let slice = Slice::of(&stored, 0.7).unwrap();
        for (n, (degrees, sum)) in slice.sum.iter().enumerate() {
            let parts = slice.lobes.iter().map(|lobe| lobe[n].1).sum::<f32>() + slice.diffuse[n].1;
            assert!((parts - sum).abs() < 1e-4 * (sum + 0.1), "{degrees}: {parts} {sum}");
        }
        let mut pixels = vec![255; 3 * (SIZE[0] * SIZE[1]) as usize];
        draw(&mut pixels, &slice, "test").unwrap();
        assert!(pixels.iter().filter(|&&p| p < 128).count() > 3000, "no curves");
    }
}
