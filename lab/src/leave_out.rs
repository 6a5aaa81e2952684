//! `srbf-lab leave-out`.

use srbf_benches::harness::capped_and_best;
use srbf_core::{Draws, LeaveOut, Material, Mixture, Processor, Towards, Vec3};
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
/// evaluate a batch and to sample a batch, per direction, with AVX2 and at the best level of the processor.
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

/// Numbers of mixtures that parts are left out of; means over the views.
#[derive(Clone, Copy, Debug, Default)]
pub struct Left {
    pub lobes: f64,
    pub folds: f64,
    /// Relative L2 error of the value.
    pub error: f64,
    /// Largest share of the albedo that is lost at a view.
    pub lost_albedo: f64,
}

/// The rest of a material without lobes and folds below their bounds. The command prints the same, and times.
///
/// # Errors
/// Bounds that are out of range.
pub fn left(material: &Material<impl AsRef<[u8]>>, lobes: f32, folds: f32) -> anyhow::Result<Left> {
    Batch::new().left(material, LeaveOut::new(lobes, folds)?)
}

/// Runs the command.
pub fn run(args: Args) -> anyhow::Result<()> {
    output::check_place(&args.output)?;
    let mut csv = String::from(
        "level,material,lobe_bound,fold_bound,lobes,folds,relative_l2,largest_albedo_loss,prepare_ns,evaluate_ns,sample_ns\n",
    );
    let batch = Batch::new();
    println!("processor: {}", Processor::this());
    println!(
        "bounds: share of the albedo below which a lobe is left out, share of a lobe below the horizon below which its fold is"
    );
    let cases =
        capped_and_best().into_iter().flat_map(|level| args.materials.iter().map(move |name| (level, name)));
    for (level, name) in cases {
        level.set()?;
        let stored = StoredMaterial::load(name)?;
        let material = &stored.material;
        println!(
            "\n{name} with {}: {} lobes; ns per direction, (ratio to no bound)",
            level.name(),
            material.lobe_count()
        );
        println!(
            "   lobes    folds | lobes  folds | relative L2 % | albedo lost % | prepare        evaluate       sample         | pays from"
        );
        let mut whole = [0.0; 3];
        for (n, (lobes, folds)) in BOUNDS.into_iter().enumerate() {
            let bounds = LeaveOut::new(lobes, folds)?;
            let left = batch.left(material, bounds)?;
            let time = batch.times(material, bounds);
            if n == 0 {
                whole = time;
            }
            let ratio = |(t, w): (&f64, f64)| format!("{t:6.1} ({:.2})", t / w);
            let times: Vec<String> = time.iter().zip(whole).map(ratio).collect();
            let (kept, folded) = (left.lobes, left.folds);
            // Preparing takes longer, evaluating a direction less: as many directions as make up for it.
            let (longer, saved) = (time[0] - whole[0], whole[1] - time[1]);
            let pays = match n {
                0 => String::new(),
                _ if longer <= 0.0 => "the first".into(),
                _ if saved > 0.0 => format!("{:.0} directions", (longer / saved).ceil()),
                _ => "never".into(),
            };
            println!(
                "{lobes:8.0e} {folds:8.0e} | {kept:5.1} {folded:6.1} | {:13.4} | {:13.4} | {} | {pays}",
                100.0 * left.error,
                100.0 * left.lost_albedo,
                times.join("  ")
            );
            let ([prepare, evaluate, sample], error) = (time, left.error);
            let _ = writeln!(
                csv,
                "{},{name},{lobes:e},{folds:e},{kept:.2},{folded:.2},{error:.3e},{:.3e},{prepare:.2},{evaluate:.3},{sample:.3}",
                level.name(),
                left.lost_albedo
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

    fn left(&self, material: &Material<impl AsRef<[u8]>>, leave_out: LeaveOut) -> anyhow::Result<Left> {
        let wi = self.directions.each_ref().map(Vec::as_slice);
        let [mut values, mut whole] = [(); 2].map(|()| [(); 3].map(|()| vec![0.0f32; BATCH]));
        let (mut mixture, mut reference) = (Mixture::<64>::empty(), Mixture::<64>::empty());
        let (mut left, mut difference, mut norm) = (Left::default(), 0.0, 0.0);
        for wo in views() {
            material.prepare_with(wo, LeaveOut::new(0.0, 0.0)?.into(), &mut reference)?;
            material.prepare_with(wo, leave_out.into(), &mut mixture)?;
            for (mixture, values) in [(&reference, &mut whole), (&mixture, &mut values)] {
                let value = Some(values.each_mut().map(Vec::as_mut_slice));
                mixture.ask(Towards { wi, value, pdf: None }.into())?;
            }
            left.lobes += mixture.len() as f64 / VIEWS as f64;
            left.folds += (0..mixture.len()).filter(|&k| mixture.is_folded(k)).count() as f64 / VIEWS as f64;
            left.lost_albedo = left.lost_albedo.max(f64::from(1.0 - mixture.power() / reference.power()));
            for (value, whole) in values.iter().flatten().zip(whole.iter().flatten()) {
                difference += f64::from(value - whole).powi(2);
                norm += f64::from(*whole).powi(2);
            }
        }
        left.error = (difference / norm).sqrt();
        Ok(left)
    }

    /// Nanoseconds to prepare, and a direction to evaluate and to sample; means over the views.
    fn times(&self, material: &Material<impl AsRef<[u8]>>, leave_out: LeaveOut) -> [f64; 3] {
        let [x, y, z] = self.directions.each_ref().map(Vec::as_slice);
        let [u, v, w] = self.uniforms.each_ref().map(Vec::as_slice);
        let [mut dx, mut dy, mut dz, mut pdf, mut r, mut g, mut b] = [(); 7].map(|()| vec![0.0f32; BATCH]);
        let mut mixture = Mixture::<64>::empty();
        let mut times = [0.0; 3];
        for wo in views() {
            let prepare = fastest(64, || {
                for _ in 0..64 {
                    let _ = material.prepare_with(black_box(wo), leave_out.into(), &mut mixture);
                }
            });
            let evaluate = fastest(BATCH, || {
                let value = Some([&mut r[..], &mut g[..], &mut b[..]]);
                let _ = mixture.ask(Towards { wi: black_box([x, y, z]), value, pdf: None }.into());
            });
            let sample = fastest(BATCH, || {
                let direction = [&mut dx[..], &mut dy[..], &mut dz[..]];
                let weight = Some([&mut r[..], &mut g[..], &mut b[..]]);
                let draw = Draws { u: black_box([u, v, w]), direction, pdf: Some(&mut pdf), weight };
                let _ = mixture.ask(draw.into());
            });
            for (sum, time) in times.iter_mut().zip([prepare, evaluate, sample]) {
                *sum += time / VIEWS as f64;
            }
        }
        times
    }
}

/// Outgoing directions from the normal to 85 degrees.
fn views() -> impl Iterator<Item = Vec3> {
    (0..VIEWS).map(|view| {
        let (sin, cos) = (view as f32 * 85.0 / (VIEWS - 1) as f32).to_radians().sin_cos();
        Vec3::new(-sin, 0.0, cos)
    })
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
