//! `srbf-lab survey`: how good fits are over all materials that can be evaluated between the views, beside the thesis's.
//!
//! Both methods have the same number of views: ours where it places them, the thesis's even to 87 degrees; but six to eleven lobes, or
//! lobes in pairs, ours spends on more. Each is judged at its views and halfway between them. A row is written as soon as it is known.

mod goals;
mod row;
mod through;

use anyhow::{Context, ensure};
use row::SurveyRow;
use srbf_core::Material;
use srbf_fit::judge::method::Fitted;
use srbf_fit::judge::mirror_asymmetry::handedness;
use srbf_fit::judge::reciprocity::reciprocity;
use srbf_fit::judge::report::{ViewReport, factor_bytes, mean_error};
use srbf_fit::read::rgl::{self, Rgl};
use srbf_fit::read::{Content, neural, read};
use srbf_fit::table::Brdf;
use srbf_fit::table::Table;
use srbf_fit::table::evaluation_views;
use srbf_fit::{Settings, fit_content, view_angles};
use srbf_reference_renderer::command::argument;
use srbf_reference_renderer::command::fit::{SettingArgs, names};
use srbf_reference_renderer::out::output;
use srbf_reference_renderer::truth::networks::Networks;
use srbf_thesis::blend::{BlendedViews, Neighbours};
use srbf_thesis::evaluated::Evaluated;
use srbf_thesis::microfacets::Microfacets;
use srbf_thesis::thesis;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Fits many materials, and prints how good the fits are beside the thesis's, and which goals are met.
///
/// They are those of rgl/ and of the neural MERL set in the folder that SRBF_DATA_DIR names.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Only every N-th of them
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    every: u32,
    /// Only those whose names contain this
    #[arg(long, value_name = "NAME")]
    only: Option<String>,
    /// Leaves the thesis's method out, which takes about half of the time
    #[arg(long)]
    no_thesis: bool,
    /// The table to write [default: out/survey-LOBES-lobes-VIEWS-views.csv]
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// A folder into which every fitted material is written, as NAME.srbf
    #[arg(long, value_name = "DIR")]
    materials: Option<PathBuf>,
    /// Fits every material from its values at the pairs of directions that this file of samples has, alone, and judges it
    /// everywhere [default of --csv: out/survey-through.csv]
    #[arg(long, value_name = "FILE", conflicts_with = "materials")]
    through: Option<PathBuf>,
    #[command(flatten)]
    settings: SettingArgs,
}

/// Views up to this angle count for variance and weight, degrees: beyond, little light is reflected in a picture.
const JUDGED: f64 = 80.0;

/// Sides of the warps and of the pictures of a coarse RGL table, and bytes of a number of it, a half float.
const RGL_SIDES: (usize, usize) = (12, 9);
const RGL_BYTES: usize = 2;

/// Views to which two GGX lobes are fitted, the last of which is left out.
const GGX_VIEWS: usize = 12;

/// How names of measured tables end; the others are networks.
const MEASURED: &str = "_rgb";

/// Fits the materials, and judges the fits.
pub fn run(survey: Args) -> anyhow::Result<()> {
    let data = argument::data_folder()?;
    let settings = survey.settings.settings();
    settings.check()?;
    let default = || format!("out/survey-{}-lobes-{}-views.csv", settings.lobes, settings.view_count());
    let path = survey.csv.clone().unwrap_or_else(|| default().into());
    output::check_place(&path)?;
    println!("processor: {}", srbf_core::Processor::this());
    let material_path = |folder: &PathBuf, name: &str| folder.join(names::as_file_name(name) + ".srbf");
    if let Some(folder) = &survey.materials {
        output::check_place(&material_path(folder, "material"))?;
    }
    if let Some(file) = &survey.through {
        let path = survey.csv.clone().unwrap_or_else(|| "out/survey-through.csv".into());
        let chosen = chosen(&data, &survey)?.into_iter().step_by(survey.every as usize);
        return through::run(file, chosen, &settings, &path);
    }
    let thetas = evaluation_views::even_views(settings.view_count());
    let thesis = thesis::ThesisSettings { lobes: settings.lobes, ..thesis::ThesisSettings::default() };
    let thesis = (!survey.no_thesis).then_some(thesis);
    let chosen = chosen(&data, &survey)?;

    let mut csv = SurveyRow::csv_header() + "\n";
    println!("{} lobes, {} views; {}", settings.lobes, settings.view_count(), row::LEGEND);
    println!("{}", SurveyRow::header());
    let mut rows: Vec<SurveyRow> = Vec::new();
    for (name, content) in chosen.into_iter().step_by(survey.every as usize) {
        let coarse = coarse_table(&data, &name)?;
        let (mut row, bytes) = examine(&name, (&content?, coarse), &thetas, &settings, thesis.as_ref())
            .with_context(|| format!("material {name}"))?;
        row.is_measured = name.ends_with(MEASURED);
        if let Some(folder) = &survey.materials {
            output::write(&material_path(folder, &name), &bytes)?;
        }
        println!("{}", row.line());
        csv += &(row.csv() + "\n");
        // After every row, so that a run that is stopped leaves its results.
        output::write(&path, csv.as_bytes())?;
        rows.push(row);
    }
    for (of, is_measured) in [("measured tables", true), ("networks", false)] {
        let some = || rows.iter().filter(|row| row.is_measured == is_measured);
        if some().count() > 0 {
            println!("{of}, {}:", some().count());
            for (name, share) in [("median", 0.5), ("90 %", 0.9), ("worst", 1.0)] {
                println!("{}", SurveyRow::quantile_line(name, some(), share));
            }
        }
    }
    println!("{} materials; {}", rows.len(), path.display());
    goals::print(&rows, thesis.is_some());
    Ok(())
}

/// The materials whose names hold the word of the options.
fn chosen(data: &Path, survey: &Args) -> anyhow::Result<Vec<Named>> {
    let named = |name: &String| survey.only.as_ref().is_none_or(|only| name.contains(only));
    let chosen: Vec<Named> = materials(data)?.into_iter().filter(|m| named(&m.0)).collect();
    let only = survey.only.clone().unwrap_or_default();
    ensure!(!chosen.is_empty(), "no material whose name contains `{only}`");
    Ok(chosen)
}

/// RGL's own table of a measured material, with fewer numbers, and how many; none of a network.
fn coarse_table(data: &Path, name: &str) -> anyhow::Result<Option<(Rgl, usize)>> {
    if !name.ends_with(MEASURED) {
        return Ok(None);
    }
    let file = data.join("rgl").join(name).with_extension("bsdf");
    let bytes = std::fs::read(&file).with_context(|| file.display().to_string())?;
    Ok(rgl::parse(&bytes)?.coarser(RGL_SIDES.0, RGL_SIDES.1))
}

/// Fits one material, and judges the fit. Returns the bytes of the material too.
fn examine(
    name: &str,
    (content, coarse): (&Content, Option<(Rgl, usize)>),
    thetas: &[f64],
    settings: &Settings,
    thesis: Option<&thesis::ThesisSettings>,
) -> anyhow::Result<(SurveyRow, Vec<u8>)> {
    let Content::Evaluable(brdf) = content else {
        anyhow::bail!("scattered samples have no views in between")
    };
    let brdf: &(dyn Brdf + Send) = brdf.as_ref();
    let error =
        |fit: &dyn Fitted, table: &Table| Ok::<_, anyhow::Error>(100.0 * mean_error(&judge(fit, table)?));

    let fit = fit_content(content, settings, |_| {})?;
    let lobes = Material::from_bytes(fit.bytes.as_slice())?;
    let placed = view_angles(&lobes);
    let at_views = evaluation_views::judging_table(brdf, &placed)?;
    let halfway = evaluation_views::judging_table(brdf, &evaluation_views::halfway(&placed))?;
    let between = judge(&lobes, &halfway)?;
    let low: Vec<&ViewReport> = between.iter().filter(|v| v.theta.to_degrees() <= JUDGED).collect();
    let list = |f: fn(&ViewReport) -> f64| low.iter().map(|v| f(v)).collect::<Vec<f64>>();
    let fold = |list: Vec<f64>| list.into_iter().fold(0.0, f64::max);
    let seen_table = evaluation_views::judging_table(brdf, &evaluation_views::seen_views())?;
    let seen = judge(&lobes, &seen_table)?;
    let mean = |f: fn(&ViewReport) -> f64| seen.iter().map(f).sum::<f64>() / seen.len() as f64;
    let anywhere = between.iter().chain(&fit.report.views).map(|v| v.largest_weight);
    let mut row = SurveyRow {
        name: name.to_owned(),
        peak: 100.0 * mean(|v| v.regions.peak),
        off_peak: 100.0 * mean(|v| v.regions.off_peak),
        luminance: 100.0 * mean(|v| v.regions.luminance),
        chroma: mean(|v| v.regions.chroma),
        fit: error(&lobes, &at_views)?,
        halfway: 100.0 * mean_error(&between),
        blended: error(&BlendedViews::new(&lobes, Neighbours::ThreeOrFour), &halfway)?,
        blended_two: error(&BlendedViews::new(&lobes, Neighbours::Two), &halfway)?,
        variance_median: row::quantile(list(|v| v.variance), 0.5),
        variance_worst: fold(list(|v| v.variance)),
        weight: fold(list(|v| v.largest_weight)),
        energy: 100.0 * fold(list(ViewReport::energy_error)),
        reciprocity: reciprocity(&lobes)?.median,
        handedness: 100.0 * handedness(brdf, &halfway),
        weight_anywhere: anywhere.fold(0.0, f64::max),
        bytes: lobes.bytes().len() as f64,
        factor_bytes: factor_bytes(&lobes) as f64,
        largest_factor: lobes.largest_factor().into(),
        seconds: fit.report.seconds,
        ..SurveyRow::default()
    };
    if let Some(found) = &fit.report.appearance {
        row.visible = found.visible();
        row.ripple = found.ripple[0].chroma / found.ripple[1].chroma.max(1e-4);
        row.skirt = found.skirt.chroma;
        row.noise = 100.0 * found.noise().luminance;
    }
    let even =
        evaluation_views::judging_table(brdf, &evaluation_views::even_views(GGX_VIEWS)[..GGX_VIEWS - 1])?;
    let ggx = judge(&Microfacets::fit(&even)?, &seen_table)?;
    let mean = |f: fn(&ViewReport) -> f64| ggx.iter().map(f).sum::<f64>() / ggx.len() as f64;
    row.ggx_peak = 100.0 * mean(|v| v.regions.peak);
    row.ggx_luminance = 100.0 * mean(|v| v.regions.luminance);
    row.ggx_chroma = mean(|v| v.regions.chroma);
    if let Some((coarse, numbers)) = coarse {
        let found = judge(&Evaluated(coarse), &seen_table)?;
        let mean = |f: fn(&ViewReport) -> f64| found.iter().map(f).sum::<f64>() / found.len() as f64;
        row.rgl_peak = 100.0 * mean(|v| v.regions.peak);
        row.rgl_luminance = 100.0 * mean(|v| v.regions.luminance);
        row.rgl_chroma = mean(|v| v.regions.chroma);
        row.rgl_bytes = (RGL_BYTES * numbers) as f64;
    }
    let halfway = evaluation_views::judging_table(brdf, &evaluation_views::halfway(thetas))?;
    row.same_views = error(&lobes, &halfway)?;
    if let Some(settings) = thesis {
        let at_views = evaluation_views::judging_table(brdf, thetas)?;
        let start = Instant::now();
        let fit = thesis::fit_brdf(brdf, thetas, settings)?;
        row.thesis_seconds = start.elapsed().as_secs_f64();
        row.thesis_fit = error(&fit, &at_views)?;
        let between = judge(&fit, &halfway)?;
        row.eq9 = 100.0 * mean_error(&between);
        row.eq9_two = error(&fit.blended_over(Neighbours::Two), &halfway)?;
        let low = between.iter().filter(|v| v.theta.to_degrees() <= JUDGED);
        row.thesis_variance = row::quantile(low.map(|v| v.variance).collect(), 0.5);
    }
    Ok((row, fit.bytes))
}

fn judge(fit: &dyn Fitted, table: &Table) -> anyhow::Result<Vec<ViewReport>> {
    table.views.iter().map(|view| Ok(ViewReport::judge(fit, view)?)).collect()
}

type Named = (String, anyhow::Result<Content>);

/// The tables of RGL in a folder of data, by name.
///
/// # Errors
/// A folder that cannot be read.
pub fn rgl_files(data: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let folder = data.join("rgl");
    let entries = std::fs::read_dir(&folder).with_context(|| folder.display().to_string())?;
    let mut files: Vec<PathBuf> = entries.map(|e| Ok(e?.path())).collect::<std::io::Result<_>>()?;
    files.retain(|f| f.extension().is_some_and(|e| e == "bsdf"));
    files.sort();
    Ok(files)
}

fn materials(data: &Path) -> anyhow::Result<Vec<Named>> {
    let files = rgl_files(data)?;
    let name = |f: &PathBuf| f.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mut all: Vec<Named> =
        files.iter().map(|f| (name(f), read(f).map(|s| s.content).map_err(Into::into))).collect();

    let networks = Networks::read(&data.join("merl/nbrdf_merl80.f32le"))?;
    let evaluable = |n: neural::Neural| Ok(Content::Evaluable(Box::new(n)));
    all.extend(networks.all.into_iter().map(|(name, network)| (name, evaluable(network))));
    Ok(all)
}
