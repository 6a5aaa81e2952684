//! `srbf-lab leave-out`.

use srbf_core::{LeaveOut, Material, Mixture, Processor, Vec3};
use srbf_reference_renderer::out::output;
use srbf_reference_renderer::truth::stored::StoredMaterial;
use std::fmt::Write;
use std::hint::black_box;
use std::path::PathBuf;
use std::time::Instant;

/// Measures what leaving out lobes and folds costs in error and saves in time, for bounds from none to 10 %.
///
/// For each material and bound, over outgoing directions from the normal to 85 degrees: lobes and folds that are left, the
/// relative L2 error of the value against that of the whole mixture, the albedo that is lost, and nanoseconds to prepare a mixture, to
/// evaluate a batch and to sample a batch, per direction.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Materials: presets or .srbf files
    #[arg(long, value_delimiter = ',', default_value = "garnet_red,krylon_blue,cayman")]
    materials: Vec<String>,
    /// The table to write
    #[arg(short, long, default_value = "out/leave-out.csv", value_name = "FILE")]
    output: PathBuf,
}

/// Shares that may be left out: of lobes, of folds.
const BOUNDS: [(f32, f32); 9] = [
    (0.0, 0.0),
    (0.0, 1e-7),
    (0.0, 1e-3),
    (0.0, 1e-1),
    (1e-4, 1e-7),
    (1e-3, 1e-7),
    (1e-2, 1e-7),
    (3e-2, 1e-2),
    (1e-1, 1e-1),
];

/// Outgoing directions, and directions in a batch.
const VIEWS: usize = 18;
const BATCH: usize = 1024;
/// Least of this many repetitions is the time.
const REPETITIONS: usize = 40;

/// The effect of one bound, summed over the views.
#[derive(Default)]
struct Sums {
    lobes: usize,
    folds: usize,
    difference: f64,
    norm: f64,
    lost_albedo: f64,
    /// Nanoseconds: prepare, evaluate, sample.
    time: [f64; 3],
}

/// Runs the command.
pub fn run(args: Args) -> anyhow::Result<()> {
    output::check_place(&args.output)?;
    let mut csv = String::from(
        "material,lobe_bound,fold_bound,lobes,folds,relative_l2,largest_albedo_loss,prepare_ns,evaluate_ns,sample_ns\n",
    );
    let batch = Batch::new();
    println!("processor: {}", Processor::this());
    println!(
        "bounds: share of the albedo below which a lobe is left out, share of a lobe below the horizon below which its fold is"
    );
    for name in &args.materials {
        let stored = StoredMaterial::load(name)?;
        let material = &stored.material;
        println!("\n{name}: {} lobes; ns per direction, (ratio to no bound)", material.lobe_count());
        println!(
            "   lobes    folds | lobes  folds | relative L2 % | albedo lost % | prepare        evaluate       sample"
        );
        let mut whole = [0.0; 3];
        for (n, (lobes, folds)) in BOUNDS.into_iter().enumerate() {
            let sums = batch.measure(material, LeaveOut::new(lobes, folds)?)?;
            if n == 0 {
                whole = sums.time;
            }
            let views = VIEWS as f64;
            let error = (sums.difference / sums.norm).sqrt();
            let (kept, folded) = (sums.lobes as f64 / views, sums.folds as f64 / views);
            let times: Vec<String> = sums
                .time
                .iter()
                .zip(whole)
                .map(|(t, w)| format!("{:6.1} ({:.2})", t / views, t / w))
                .collect();
            println!(
                "{lobes:8.0e} {folds:8.0e} | {kept:5.1} {folded:6.1} | {:13.4} | {:13.4} | {}",
                100.0 * error,
                100.0 * sums.lost_albedo,
                times.join("  ")
            );
            let [prepare, evaluate, sample] = sums.time.map(|t| t / views);
            let _ = writeln!(
                csv,
                "{name},{lobes:e},{folds:e},{kept:.2},{folded:.2},{error:.3e},{:.3e},{prepare:.2},{evaluate:.3},{sample:.3}",
                sums.lost_albedo
            );
        }
    }
    output::write(&args.output, csv.as_bytes())?;
    println!("\n{}", args.output.display());
    Ok(())
}

/// Directions spread over the hemisphere, and uniform numbers, as structure of arrays.
struct Batch {
    directions: [Vec<f32>; 3],
    uniforms: [Vec<f32>; 3],
}

impl Batch {
    fn new() -> Self {
        // Fractions of multiples of irrational numbers fill the cube evenly.
        let fraction = |i: usize, step: f64| ((i as f64 + 0.5) * step).fract() as f32;
        let uniforms = [0.754_877_666_2, 0.569_840_290_9, 0.618_033_988_7]
            .map(|step| (0..BATCH).map(|i| fraction(i, step)).collect());
        let direction = |i: usize| {
            let z = (i as f32 + 0.5) / BATCH as f32;
            let (sin, cos) = (core::f32::consts::TAU * fraction(i, 0.618_033_988_7)).sin_cos();
            let across = (1.0 - z * z).sqrt();
            [across * cos, across * sin, z]
        };
        Self { directions: [0, 1, 2].map(|c| (0..BATCH).map(|i| direction(i)[c]).collect()), uniforms }
    }

    fn measure(&self, material: &Material<impl AsRef<[u8]>>, leave_out: LeaveOut) -> anyhow::Result<Sums> {
        let [x, y, z] = self.directions.each_ref().map(Vec::as_slice);
        let [u, v, w] = self.uniforms.each_ref().map(Vec::as_slice);
        let mut out = [(); 7].map(|()| vec![0.0f32; BATCH]);
        let mut whole = [(); 3].map(|()| vec![0.0f32; BATCH]);
        let (mut mixture, mut reference) = (Mixture::<64>::empty(), Mixture::<64>::empty());
        let mut sums = Sums::default();
        for view in 0..VIEWS {
            let (sin, cos) = (view as f32 * 85.0 / (VIEWS - 1) as f32).to_radians().sin_cos();
            let wo = Vec3::new(-sin, 0.0, cos);
            material.prepare_with(wo, LeaveOut::new(0.0, 0.0)?.into(), &mut reference)?;
            let [r, g, b] = &mut whole;
            reference.evaluate_into([x, y, z], [r, g, b])?;

            sums.time[0] += fastest(64, || {
                for _ in 0..64 {
                    let _ = material.prepare_with(black_box(wo), leave_out.into(), &mut mixture);
                }
            });
            sums.lobes += mixture.len();
            sums.folds += (0..mixture.len()).filter(|&k| mixture.is_folded(k)).count();
            let lost = 1.0 - mixture.power() / reference.power();
            sums.lost_albedo = sums.lost_albedo.max(f64::from(lost));
            let [dx, dy, dz, pdf, r, g, b] = &mut out;
            sums.time[2] += fastest(BATCH, || {
                let samples = srbf_core::SamplesMut { direction: [dx, dy, dz], pdf, weight: [r, g, b] };
                let _ = mixture.sample_into(black_box([u, v, w]), samples);
            });
            sums.time[1] += fastest(BATCH, || {
                let _ = mixture.evaluate_into(black_box([x, y, z]), [r, g, b]);
            });
            for (value, whole) in [r, g, b].into_iter().zip(&whole) {
                for (value, whole) in value.iter().zip(whole) {
                    sums.difference += f64::from(value - whole).powi(2);
                    sums.norm += f64::from(*whole).powi(2);
                }
            }
        }
        Ok(sums)
    }
}

/// Nanoseconds an element that the fastest of many repetitions takes.
fn fastest(elements: usize, mut run: impl FnMut()) -> f64 {
    let mut least = f64::INFINITY;
    for _ in 0..REPETITIONS {
        let start = Instant::now();
        run();
        least = least.min(start.elapsed().as_secs_f64());
    }
    least * 1e9 / elements as f64
}
