//! `srbf plot`.

use super::{argument, ball, fit_page, view_table};
use crate::out::output;
use crate::out::print::shown;
use crate::shade::shader::LoadedMaterial;
use crate::show::ball_sheet::Light;
use crate::show::fit_sheet::{self, Against, Subject};
use crate::truth::measured::MeasuredMaterial;
use crate::truth::stored::StoredMaterial;
use srbf_fit::complete::{Completion, complete};
use srbf_fit::judge::reciprocity::reciprocity;
use srbf_fit::judge::report::{Report, ViewReport};
use srbf_fit::judge::verdict::Verdict;
use srbf_fit::read::{Content, Source};
use srbf_fit::table::{Brdf, Symmetry, Table, evaluation_views};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The light of balls where none is named.
pub const LIGHT: &str = "sky";

/// Samples a pixel of the balls: they take 4 s on two cores.
pub const SAMPLES: u32 = 48;

/// Outgoing directions that the verdict is of, degrees from the normal.
const JUDGED: [f64; 5] = [0.0, 5.0, 30.0, 60.0, 75.0];

/// Draws a fitted material, and the table that it was fitted to if one is named.
///
/// One PNG: the sentence of the verdict, a ball under the light, `f cos` in the plane of incidence for some outgoing directions, beside the samples
/// in that plane, and discs of the hemisphere for three. Of a table with a value for every pair of directions there is a ball
/// too, and the difference of both.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The fitted material: a .srbf file or the name of a preset
    #[arg(value_name = "FILE|PRESET")]
    material: String,
    /// The data that it was fitted to: any file that `srbf fit` reads
    #[arg(long, value_name = "TABLE")]
    against: Option<PathBuf>,
    /// The light of the balls: sky, haze, constant:VALUE, or a latitude-longitude map in a .hdr or .exr file
    #[arg(long, default_value = LIGHT)]
    env: String,
    /// Stops to brighten the balls by, from the exposure of the light, as in `srbf ball`
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true, value_name = "STOPS")]
    exposure: f32,
    /// Also writes a page of HTML beside the picture, the one that `srbf view` shows; it needs no other file and no network
    #[arg(long)]
    html: bool,
    /// The picture to write, .png [default: out/NAME.png]
    #[arg(short, long, value_name = "OUT.png")]
    output: Option<PathBuf>,
}

/// The data beside a fit.
pub enum Beside {
    /// A BRDF.
    Table(Box<MeasuredMaterial>),
    /// Samples and their completion.
    Samples(Table, Box<Completion>),
}

impl Beside {
    /// From a file that was read.
    ///
    /// # Errors
    /// As the completion says them.
    pub fn new(source: Source) -> anyhow::Result<Self> {
        Ok(match source.content {
            Content::Samples(table) => {
                let completion = Box::new(complete(&table)?);
                Self::Samples(table, completion)
            }
            Content::Evaluable(_) => Self::Table(Box::new(MeasuredMaterial::new(source)?)),
        })
    }

    /// The BRDF.
    fn brdf(&self) -> &dyn Brdf {
        match self {
            Self::Table(table) => table.brdf(),
            Self::Samples(_, completion) => completion.as_ref(),
        }
    }
}

/// Runs the command.
pub fn run(args: Args) -> anyhow::Result<()> {
    let stored = StoredMaterial::load(&args.material)?;
    let output = args.output.unwrap_or_else(|| PathBuf::from(format!("out/{}.png", stored.name)));
    ball::check_output(&output)?;
    argument::check_stops(args.exposure)?;
    let page = args.html.then(|| output.with_extension("html"));
    page.as_deref().map(output::check_place).transpose()?;
    let environment = argument::environment(&args.env)?;
    let stops = args.exposure;
    let light = Light { name: &args.env, environment: &environment, samples: SAMPLES, stops, turn: 0.0 };
    let exposure = light.exposure();
    let source = args.against.as_deref().map(srbf_fit::read::read).transpose()?;
    let content = source.as_ref().map(|source| &source.content);
    let open = |path: PathBuf| -> anyhow::Result<_> {
        let opened = fit_page::opened(&stored.name, stored.material.bytes(), None, content)?;
        Ok((path, opened))
    };
    let page = page.map(open).transpose()?;
    let beside = source.map(Beside::new).transpose()?;
    let report = beside.as_ref().map(|beside| judge(&stored, beside)).transpose()?.flatten();
    let verdict = match &report {
        Some(report) => {
            let verdict = Verdict::of_material(report, &reciprocity(&stored.material)?);
            view_table::words(report, &verdict)
        }
        None => Vec::new(),
    };
    verdict.iter().for_each(|line| println!("{line}"));
    let files = output::together();
    let seconds = write(&output, stored, beside, light, &verdict)?;
    let page = match page {
        Some((path, opened)) => {
            fit_page::write(&path, opened, &verdict)?;
            Some(path)
        }
        None => None,
    };
    files.commit()?;
    println!("{} in {seconds:.2} s, exposure of the light {exposure:.3}", shown(&output));
    if let Some(path) = &page {
        println!("{}", shown(path));
    }
    Ok(())
}

/// The errors of a material beside a BRDF; none of an anisotropic one.
fn judge(stored: &StoredMaterial, beside: &Beside) -> anyhow::Result<Option<Report>> {
    let material = &stored.material;
    if !material.is_isotropic() || beside.brdf().symmetry() != Symmetry::Isotropic {
        return Ok(None);
    }
    let table = evaluation_views::judging_table(beside.brdf(), &JUDGED.map(f64::to_radians))?;
    let judged = table.views.iter().map(|view| ViewReport::judge(material, view));
    Ok(Some(Report { held_out: judged.collect::<Result<_, _>>()?, ..Report::default() }))
}

/// Draws and writes the picture of a material; gives the seconds that it took.
///
/// # Errors
/// As the material says them; names the file that cannot be written.
pub fn write(
    path: &Path,
    stored: StoredMaterial,
    beside: Option<Beside>,
    light: Light<'_>,
    verdict: &[String],
) -> anyhow::Result<f64> {
    let start = Instant::now();
    let (name, fit) = (stored.name.clone(), stored.material.clone());
    let ball = LoadedMaterial::Lobes(stored);
    let alone =
        Subject { name: &name, fit: &fit, against: None, ball: &ball, ball_beside: None, light, verdict };
    match beside {
        None => fit_sheet::write(path, &alone)?,
        Some(Beside::Samples(table, completion)) => {
            let brdf = completion.as_ref();
            let against = Some(Against { brdf, name: "completed samples", samples: Some(&table) });
            fit_sheet::write(path, &Subject { against, ..alone })?;
        }
        Some(Beside::Table(table)) => {
            let beside = LoadedMaterial::Table(table);
            let against =
                beside.table().map(|table| Against { brdf: table.brdf(), name: "table", samples: None });
            fit_sheet::write(path, &Subject { against, ball_beside: Some(&beside), ..alone })?;
        }
    }
    Ok(start.elapsed().as_secs_f64())
}
