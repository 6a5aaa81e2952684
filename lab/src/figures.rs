//! `srbf-lab figures`: table 5.1 and figures 5.1 to 5.7 of the thesis, and its claim as a table.
//!
//! The figures of Weng and Shih 2006, chapter 5, made again: the scenes, the measurement, and the sheet of pictures.
//!
//! The truth is one for all methods, the measurement: methods only draw directions for it. A second reading is that of the thesis,
//! where the lobes of a method are the material themselves.
//!
//! | file | holds |
//! |---|---|
//! | `materials` | the four materials, and all that samples them |
//! | `measure` | pictures and errors of methods at counts of samples |
//! | `claim` | the count at which another method has the error of 300 samples |
//! | `sheet` | labelled pictures side by side |

mod claim;
mod materials;
mod measure;
mod sheet;

use crate::{samples, thesis_table};
use anyhow::{Context, ensure};
use claim::SAMPLES;
use materials::{FittedPaint, Kind, Painted};
use measure::{Effort, Measured, Subject, Task};
use rayon::prelude::*;
use sheet::Tile;
use srbf_reference_renderer::command::argument;
use srbf_reference_renderer::out::output;
use srbf_reference_renderer::out::page::{Cell, Figure, Page, Table};
use srbf_reference_renderer::out::progress::Progress;
use srbf_reference_renderer::shade::{Light, SamplerName, Strategy};
use srbf_reference_renderer::study::comparison::plot;
use srbf_reference_renderer::study::comparison::{Estimate, Method, Reading};
use srbf_reference_renderer::trace::scene::SceneName;
use srbf_reference_renderer::world::environment::Environment;
use srbf_reference_renderer::world::environment::file::{self, Projection};
use srbf_reference_renderer::world::mesh;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Makes table 5.1 and figures 5.1 to 5.7 of the thesis, and its claim as a table.
///
/// SRBF_DATA_DIR names the folder of the data: Cornell's garnet red, krylon blue and cayman, blue paint by its published fit, the
/// light probes Funston Beach and Uffizi, and the Happy Buddha. Writes PNGs, `claim.csv`, and `index.html`, a page with all of
/// them and their captions. The measurement is the truth for every method. At most 20 minutes on two processors.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Small pictures of two materials, few repeats, and the table of one: a minute, for a look and for tests. The claim is not judged
    #[arg(long)]
    quick: bool,
    /// Side of the pictures of the sphere, pixels; scenes are twice as wide
    #[arg(long, default_value_t = 72, value_name = "N", value_parser = clap::value_parser!(u32).range(8..=1024))]
    side: u32,
    /// Seed of the random numbers
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Folder to write to
    #[arg(short, long, default_value = "out/figures", value_name = "DIR")]
    output: PathBuf,
}

/// Of the methods: the one that the thesis says is as good as Lafortune's, and the methods of this library.
const THESIS: usize = 0;
const LAFORTUNE: usize = 1;
const LOBES: usize = 2;
const PRODUCT: usize = 3;
const MIS: usize = 4;
const LAFORTUNE_MIS: usize = 5;
const EVEN: usize = 6;
/// Methods with the measurement as the truth; the others render lobes.
const OF_THE_TRUTH: usize = 7;

/// What Lafortune's samples alone are counted against: place, name in the CSV, head of the column.
const OTHERS: [(usize, &str, &str); 6] = [
    (THESIS, "thesis", "300 of the thesis's lobes"),
    (LOBES, "lobes", "300 of our lobes"),
    (LAFORTUNE_MIS, "lafortune+mis", "300 of Lafortune's and the light"),
    (MIS, "mis", "300 of our lobes and the light"),
    (PRODUCT, "product", "300 by product"),
    (EVEN, "even", "300 by even sums"),
];

/// The thesis's counts of samples.
const FEW: [u32; 2] = [100, SAMPLES];
const MANY: [u32; 4] = [100, SAMPLES, 600, 1200];

/// Methods with the measurement as the truth, then those whose lobes are the material.
const TASKS: [Task<'static>; 9] = [
    (alone(SamplerName::Thesis), &FEW),
    (alone(SamplerName::Lafortune), &MANY),
    (alone(SamplerName::Lobes), &FEW),
    (Method::of(Strategy::PRODUCT), &FEW),
    (Method::of(Strategy::MIS), &FEW),
    (Method::of(Strategy { sampler: SamplerName::Lafortune, light: Light::Mis }), &FEW),
    (Method::of(Strategy::EVEN), &FEW),
    (itself(SamplerName::Lafortune), &FEW),
    (itself(SamplerName::Lobes), &FEW),
];

const fn alone(name: SamplerName) -> Method {
    Method::of(Strategy::alone(name))
}

const fn itself(name: SamplerName) -> Method {
    Method { strategy: Strategy::alone(name), reading: Reading::Fit }
}

/// The light probes: name and file.
const PROBES: [(&str, &str); 2] =
    [("Funston Beach", "funston_beach_latlong.hdr"), ("Uffizi", "uffizi_latlong.hdr")];

/// How large, and how well measured.
struct Size {
    sphere: u32,
    scene: [u32; 2],
    sphere_effort: Effort,
    scene_effort: Effort,
}

impl Size {
    fn of(args: &Args) -> Self {
        let effort = |repeats, reference_samples| Effort { repeats, reference_samples, seed: args.seed };
        let side = if args.quick { args.side.min(6) } else { args.side };
        let [sphere_effort, scene_effort] =
            if args.quick { [effort(2, 256), effort(1, 64)] } else { [effort(4, 1024), effort(1, 512)] };
        Self { sphere: side, scene: [2 * side, 3 * side / 2], sphere_effort, scene_effort }
    }
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<()> {
    let data = argument::data_folder()?;
    let out = &args.output;
    ensure!(!out.exists() || out.is_dir(), "{}: a folder is expected", out.display());
    let index = out.join("index.html");
    output::check_places(&[&index])?;
    let start = Instant::now();
    println!("processor: {}", srbf_core::Processor::this());
    let size = Size::of(args);
    // All that is read, before the work.
    let probes: Vec<Environment> = PROBES
        .iter()
        .map(|(_, name)| file::read(&data.join("envmaps").join(name), Projection::LatLong))
        .collect::<anyhow::Result<_>>()?;
    let buddha =
        data.join("meshes").join(if args.quick { "happy_buddha_20k.ply" } else { "happy_buddha_100k.ply" });
    let mut statue = mesh::file::read(&buddha)?;
    if !args.quick {
        statue.turn_y_up();
    }
    let painted = Painted::load(&data, args.quick)?;
    let fitted = fit(&painted, Kind::Measurement)?;
    let of_lobes = fit(&painted, Kind::Lobes)?;

    let mut page = Page::new("The figures of the thesis, made again");
    page.paragraph(WORDS);
    page.heading("The claim");
    let mut claims = String::from("truth,material,light,method,samples_of_lafortune,standard_error,holds\n");
    let mut figures = Vec::new();
    let subjects = spheres(&fitted, &probes, &size);
    let readings = [
        ("the measurement", &subjects, &TASKS[..]),
        ("our lobes", &spheres(&of_lobes, &probes, &size), &TASKS[..OF_THE_TRUTH]),
    ];
    for (truth, subjects, tasks) in readings {
        println!("{truth} rendered:");
        let steps = subjects.iter().map(|s| s.steps(tasks, size.sphere_effort)).sum();
        let progress = Progress::new("spheres", steps);
        let mut rows = Vec::new();
        for subject in subjects {
            let measured = subject.measure(tasks, size.sphere_effort, &progress)?;
            rows.push(claim_row(truth, subject, &measured, !args.quick, &mut claims)?);
            if figures.len() < subjects.len() {
                figures.push(measured);
            }
        }
        page.table(&claim_table(truth, !args.quick, rows));
        // After every reading, so that a run that is stopped has printed its results so far.
        output::write(&out.join("claim.csv"), claims.as_bytes())?;
    }
    let figures: Vec<_> = subjects.iter().zip(figures).collect();
    page.paragraph(CLAIM_WORDS);
    table_5_1(out, args, &mut page)?;
    figure_5_1(out, &mut page)?;
    for material in &painted {
        let of: Vec<_> = figures.iter().filter(|(s, _)| std::ptr::eq(s.object.painted, material)).collect();
        sphere_figure(out, material, &of, &mut page)?;
    }
    scene_figures(out, &fitted, &probes, statue, &size, &mut page)?;
    page.write(&index)?;
    println!("{}: {:.0} s in all", index.display(), start.elapsed().as_secs_f64());
    Ok(())
}

/// The samplers of all materials.
fn fit(painted: &[Painted], kind: Kind) -> anyhow::Result<Vec<FittedPaint<'_>>> {
    painted.par_iter().map(|one| FittedPaint::new(one, kind)).collect()
}

/// The sphere with each material under each probe.
fn spheres<'a>(fitted: &'a [FittedPaint<'a>], probes: &'a [Environment], size: &Size) -> Vec<Subject<'a>> {
    let subject = |object: &'a FittedPaint<'a>, n: usize| Subject {
        scene: SceneName::Sphere,
        mesh: None,
        object,
        ground: object,
        light: PROBES[n].0,
        environment: &probes[n],
        size: [size.sphere; 2],
        max_bounces: 1,
    };
    fitted.iter().flat_map(|object| (0..PROBES.len()).map(move |n| subject(object, n))).collect()
}

/// The first paragraph of the page.
const WORDS: &str = "S.-C. Weng, An Efficient BRDF Importance Sampling Method for Global Illumination (2006), chapter 5. In all figures the \
    measurement is what is rendered, and a method only draws the directions: so all methods have the same truth, and what differs is noise. \
    \"fit:\" names the second reading, which is the thesis's own: the lobes of a method are the material, and the error of the fit stays however \
    many samples there are. Error: relative root mean square over the pixels, without the worst 0.1 % of them.";

const CLAIM_WORDS: &str = "The count of samples at which Lafortune's error is that of 300 samples of the others: the thesis claims at least 1200. \
    After ± stands the standard error over repeats. Samples are independent and the methods unbiased, so that the squared error falls as one over \
    the count; from the last count that was measured, 1200, the number follows. Blue paint is its published Lafortune fit, since the measurement \
    is not at hand: Lafortune's lobes fit it as nothing measured is fitted, and draw from it as well as lobes can.";

/// A row of the claim's table.
fn claim_row(
    truth: &str,
    subject: &Subject<'_>,
    measured: &Measured,
    is_judged: bool,
    csv: &mut String,
) -> anyhow::Result<Vec<Cell>> {
    let (material, light) = (subject.object.painted, subject.light);
    let mut row = vec![Cell::text(material.title), Cell::text(light)];
    let mut line = format!("{} under {light}: 300 samples are worth", material.title);
    for (other, name, _) in OTHERS {
        let count = claim::catches_up(&measured.comparison, LAFORTUNE, other);
        let text =
            count.map_or_else(|| "-".to_owned(), |c| format!("{} ± {}", rounded(c.mean), rounded(c.error)));
        let holds = count.map_or("-", if is_judged { claim::holds } else { |_| "-" });
        write!(line, " {text} of Lafortune's with {name},")?;
        let Estimate { mean, error } = count.unwrap_or_default();
        writeln!(csv, "{truth},{},{light},{name},{mean:.0},{error:.0},{holds}", material.name)?;
        row.push(Cell::number(text).bold_if(holds == "yes"));
    }
    println!("{}", line.trim_end_matches(','));
    Ok(row)
}

/// Three digits.
fn rounded(number: f64) -> String {
    let step = 10f64.powi(((number.abs().max(1.0)).log10().floor() as i32 - 2).max(0));
    format!("{:.0}", (number / step).round() * step)
}

fn claim_table(truth: &str, is_judged: bool, rows: Vec<Vec<Cell>>) -> Table {
    let columns = OTHERS.iter().map(|(_, _, title)| Cell::number(*title));
    let bold = if is_judged {
        "bold where the claim holds, 1200 or more, by two standard errors"
    } else {
        "the pictures have too few pixels to judge the claim by"
    };
    Table {
        caption: format!("Rendered is {truth}: samples at which Lafortune catches up with 300; {bold}"),
        head: [Cell::text("material"), Cell::text("light")].into_iter().chain(columns).collect(),
        rows,
    }
}

fn table_5_1(out: &Path, args: &Args, page: &mut Page) -> anyhow::Result<()> {
    let file = out.join("table-5-1.md");
    thesis_table::run(thesis_table::Args::new(args.quick.then(|| "cayman".to_owned()), file.clone()))?;
    page.heading("Table 5.1");
    page.paragraph("Relative L2 errors of fits in percent, beside those that the thesis states of its own.");
    page.table(&table_of(&std::fs::read_to_string(&file).with_context(|| file.display().to_string())?));
    Ok(())
}

/// A table of Markdown as one of a page: the first row is its head, the second a line.
fn table_of(markdown: &str) -> Table {
    let cells = |line: &str| -> Vec<Cell> {
        let inner = line.trim().trim_matches('|');
        let cell = |(column, text): (usize, &str)| match column {
            0 | 1 => Cell::text(text.trim()),
            _ => Cell::number(text.trim()),
        };
        inner.split('|').enumerate().map(cell).collect()
    };
    let mut rows = markdown.lines().filter(|line| line.starts_with('|'));
    let head = rows.next().map(cells).unwrap_or_default();
    Table { caption: String::new(), head, rows: rows.skip(1).map(cells).collect() }
}

fn figure_5_1(out: &Path, page: &mut Page) -> anyhow::Result<()> {
    let file = out.join("figure-5-1.png");
    samples::run(samples::Args::new(file.clone()))?;
    page.heading("Figure 5.1");
    let png = std::fs::read(&file).with_context(|| file.display().to_string())?;
    let caption = "Directions drawn by inversion (left) and by the Metropolis walk of five steps (right), seen from above";
    page.row(&[Figure::new(png, caption)]);
    Ok(())
}

/// Figure 5.2 and those that follow: pictures at the thesis's counts, and errors.
fn sphere_figure(
    out: &Path,
    material: &Painted,
    measured: &[&(&Subject<'_>, Measured)],
    page: &mut Page,
) -> anyhow::Result<()> {
    page.heading(&format!("Figure 5.{}: {}", material.figure, material.title));
    for (subject, measured) in measured {
        let under = subject.light.to_lowercase().replace(' ', "-");
        let reference = Tile { label: "reference".into(), picture: &measured.comparison.reference.picture };
        let of = |method: usize, title: &'static str| {
            let points = &measured.comparison.curves[method].points;
            measured.pictures[method].iter().zip(points).map(move |(picture, point)| Tile {
                label: format!("{title} {}: {:.1} %", point.samples, 100.0 * point.rmse()),
                picture,
            })
        };
        let mut tiles = vec![reference];
        for (method, title) in
            [(THESIS, "thesis"), (LAFORTUNE, "Laf."), (LOBES, "ours"), (PRODUCT, "product"), (EVEN, "even")]
        {
            tiles.extend(of(method, title));
        }
        let last = |method: usize| measured.pictures[method].last().map(Vec::as_slice).unwrap_or_default();
        tiles.push(Tile { label: format!("fit: Laf. {SAMPLES}"), picture: last(OF_THE_TRUTH) });
        let png = sheet::png(&tiles, subject.size, 4)?;
        output::write(&out.join(format!("figure-5-{}-{under}.png", material.figure)), &png)?;
        let plot = plot::png(&[&measured.comparison])?;
        output::write(&out.join(format!("figure-5-{}-{under}-error.png", material.figure)), &plot)?;
        page.subheading(&format!("Under {}", subject.light));
        let caption = format!(
            "{} under {}: a method, its samples a pixel, and its relative error; of the reference {:.2} %",
            material.title,
            subject.light,
            100.0 * measured.comparison.reference.own.trimmed.max(0.0).sqrt()
        );
        page.row(&[Figure::new(png, caption)]);
        page.row(&[Figure::new(plot, "Error against run time and samples; dashed, the square root")]);
    }
    Ok(())
}

/// Figures 5.6 and 5.7.
fn scene_figures(
    out: &Path,
    fitted: &[FittedPaint<'_>],
    probes: &[Environment],
    statue: mesh::Mesh,
    size: &Size,
    page: &mut Page,
) -> anyhow::Result<()> {
    let by_name = |name: &str| fitted.iter().find(|f| f.painted.name == name).unwrap_or(&fitted[0]);
    let subject = |scene, mesh, object, ground, n: usize| Subject {
        scene,
        mesh,
        object: by_name(object),
        ground: by_name(ground),
        light: PROBES[n].0,
        environment: &probes[n],
        size: size.scene,
        max_bounces: 4,
    };
    let subjects = [
        (subject(SceneName::Teapot, None, "krylon_blue", "blue_paint", 0), "teapot"),
        (subject(SceneName::Statue, Some(statue), "cayman", "garnet_red", 1), "Buddha"),
    ];
    let tasks: [Task<'_>; 4] = [
        (TASKS[THESIS].0, &[SAMPLES]),
        (TASKS[LAFORTUNE].0, &[SAMPLES, 1200]),
        (TASKS[LOBES].0, &[SAMPLES]),
        (TASKS[PRODUCT].0, &[SAMPLES]),
    ];
    let progress =
        Progress::new("scenes", subjects.iter().map(|s| s.0.steps(&tasks, size.scene_effort)).sum());
    for (n, (subject, what)) in subjects.iter().enumerate() {
        let measured = subject.measure(&tasks, size.scene_effort, &progress)?;
        let titles = ["thesis", "Lafortune", "our lobes", "product"];
        let mut tiles =
            vec![Tile { label: "reference".into(), picture: &measured.comparison.reference.picture }];
        for (method, title) in titles.iter().enumerate() {
            let points = &measured.comparison.curves[method].points;
            for (picture, point) in measured.pictures[method].iter().zip(points) {
                let error = 100.0 * point.rmse();
                tiles.push(Tile { label: format!("{title}, {}: {error:.1} %", point.samples), picture });
            }
        }
        let png = sheet::png(&tiles, subject.size, 3)?;
        output::write(&out.join(format!("figure-5-{}.png", n + 6)), &png)?;
        page.heading(&format!("Figure 5.{}", n + 6));
        let caption = format!(
            "{} {what} on a {} plane under {}, {} scatterings: method, samples a pixel, relative error",
            subject.object.painted.title, subject.ground.painted.title, subject.light, subject.max_bounces
        );
        println!(
            "{caption}: {}",
            tiles[1..].iter().map(|tile| tile.label.as_str()).collect::<Vec<_>>().join("; ")
        );
        page.row(&[Figure::new(png, caption)]);
    }
    Ok(())
}
