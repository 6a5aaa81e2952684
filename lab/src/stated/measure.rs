//! The figures that the present code gives.

use super::figure::Figure;
use crate::stability::{self, solver};
use crate::{leave_out, thesis_table};
use anyhow::{Context, bail};
use srbf_core::Level;
use srbf_core::Material;
use srbf_fit::judge::report::{ViewReport, mean_error};
use srbf_fit::read::{Content, read};
use srbf_fit::{FactorNodes, Settings, fit_content};
use srbf_reference_renderer::command::argument;
use srbf_reference_renderer::numbers::points::PointsName;
use srbf_reference_renderer::out::progress::Progress;
use srbf_reference_renderer::shade::Strategy;
use srbf_reference_renderer::shade::shader::LoadedMaterial;
use srbf_reference_renderer::study::furnace;
use srbf_reference_renderer::trace::film::Film;
use srbf_reference_renderer::trace::render::add_samples;
use srbf_reference_renderer::trace::scene::{Scene, SceneName};
use srbf_reference_renderer::trace::settings::RenderSettings;
use srbf_reference_renderer::truth::stored::{PRESETS, StoredMaterial};
use srbf_reference_renderer::world::environment::Environment;
use std::path::Path;

/// Figures that are made together.
pub struct Group {
    /// The first word of the names of its figures.
    pub name: &'static str,
    /// The command that prints them.
    pub command: &'static str,
    pub needs: Needs,
    pub make: fn() -> anyhow::Result<Vec<Figure>>,
}

/// The time and the data that a group needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// Nothing but seconds.
    Nothing,
    /// Seconds and the measured data.
    Data,
    /// Minutes and the measured data.
    Minutes,
}

/// All groups.
pub const GROUPS: &[Group] = &[
    Group { name: "bytes", command: "srbf inspect presets/NAME.srbf", needs: Needs::Nothing, make: bytes },
    Group {
        name: "furnace",
        command: "srbf render --scene sphere --material garnet_red --env constant:1 --size 200x200 --spp 128 --seed 3",
        needs: Needs::Nothing,
        make: white_furnace,
    },
    Group { name: "left-out", command: "cargo lab leave-out", needs: Needs::Nothing, make: left_out },
    Group { name: "stability", command: "cargo lab stability", needs: Needs::Nothing, make: stable },
    Group {
        name: "models",
        command: "srbf fit MODEL --lobes 4 --factors none",
        needs: Needs::Nothing,
        make: models,
    },
    Group {
        name: "samples",
        command: "cargo lab presets --check",
        needs: Needs::Data,
        make: presets_at_their_samples,
    },
    Group {
        name: "table-5.1",
        command: "cargo lab thesis-table --no-held-out",
        needs: Needs::Minutes,
        make: table_5_1,
    },
    Group { name: "solver", command: "cargo lab stability", needs: Needs::Minutes, make: solver_of_the_fit },
];

/// The presets.
fn bytes() -> anyhow::Result<Vec<Figure>> {
    Ok(PRESETS.iter().map(|(name, bytes)| Figure::count(format!("bytes {name}"), bytes.len())).collect())
}

/// The white furnace of garnet red; the settings are those of the command.
fn white_furnace() -> anyhow::Result<Vec<Figure>> {
    const SIZE: [u32; 2] = [200, 200];
    let object = LoadedMaterial::load("garnet_red")?;
    let environment = Environment::constant(1.0)?;
    let scene = Scene::new(SceneName::Sphere, object.shader(), object.shader(), &environment);
    let camera = SceneName::Sphere.camera(SIZE);
    let settings = RenderSettings {
        light: Strategy::EVEN.light,
        split: 1,
        max_bounces: 8,
        points: PointsName::Random,
        seed: 3,
    };
    let mut film = Film::new(SIZE);
    add_samples(&scene, &camera, &settings, &mut film, 128, &Progress::hidden())?;
    let found = furnace::compare(&furnace::albedos(&scene, &camera, SIZE), glam::Vec3::ONE, &film);
    Ok(vec![
        Figure::rounded("furnace red", found.rendered.x, 6),
        Figure::rounded("furnace error", found.standard_error.x, 6),
        Figure::rounded("furnace closed", found.expected.x, 6),
    ])
}

/// What lobes and folds cost that are left out.
fn left_out() -> anyhow::Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for (name, lobes, folds) in
        [("garnet_red", 1e-2, 1e-7), ("cayman", 1e-2, 1e-7), ("krylon_blue", 0.0, 1e-3)]
    {
        let stored = StoredMaterial::load(name)?;
        let left = leave_out::left(&stored.material, lobes, folds).with_context(|| name.to_owned())?;
        figures.push(Figure::rounded(format!("left-out {name} lobes"), left.lobes, 1));
        let digits = if name == "krylon_blue" { 4 } else { 1 };
        figures.push(Figure::rounded(format!("left-out {name} error"), 100.0 * left.error, digits));
        figures.push(Figure::rounded(format!("left-out {name} albedo"), 100.0 * left.lost_albedo, 1));
    }
    Ok(figures)
}

/// Rounding errors.
fn stable() -> anyhow::Result<Vec<Figure>> {
    // At one level, as the last bit of a sum differs: AVX-512 has 1.2e-6 in a row where AVX2 has 1.4e-6.
    let best = Level::current();
    if Level::Avx2.is_available() {
        Level::Avx2.set()?;
    }
    let operations = stability::operations(20_000, 0);
    best.set()?;
    let plain = operations.first().and_then(|value| value.rows.iter().find(|row| row.at == 1e6)?.plain);
    let mut figures = vec![Figure::rounded("stability plain", 100.0 * plain.context("no row at 1e6")?, 0)];
    for operation in &operations {
        let worst = operation.worst().context("an operation without rows")?;
        figures.push(Figure::small(format!("stability {}", operation.name), worst.ours));
    }
    Ok(figures)
}

/// The solver of the fit on peaks that it finds and on such that it loses. Conditions near 1e16 are rounding, and no figure.
fn solver_of_the_fit() -> anyhow::Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for case in &solver::CASES {
        let solved = case.solve().with_context(|| case.name.to_owned())?;
        let name = |what: &str| format!("solver {} {what}", solved.name);
        figures.push(Figure::rounded(name("views"), 100.0 * solved.error[0], 2));
        figures.push(Figure::rounded(name("between"), 100.0 * solved.error[1], 2));
        figures.push(Figure::rounded(name("height"), solved.heights[0], 2));
        figures.push(Figure::rounded(name("second height"), solved.heights[1], 2));
        figures.push(Figure::count(name("evaluations"), solved.evaluations));
        if solved.condition < 1e15 {
            figures.push(Figure::small(name("condition"), solved.condition));
        }
    }
    Ok(figures)
}

/// Fits of models, which nothing but the code decides.
fn models() -> anyhow::Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for (name, model) in [
        ("ggx", "model:ggx:alpha=0.2,f0=0.9"),
        ("ward", "model:ward:alpha=0.3,specular=0.3"),
        ("phong", "model:phong:diffuse=0.3,specular=0.3,exponent=50"),
    ] {
        let settings = Settings { lobes: 4, factors: FactorNodes::None, ..Settings::default() };
        let fit = fit_content(&read(Path::new(model))?.content, &settings, |_| {})?;
        figures.push(Figure::rounded(
            format!("models {name} views"),
            100.0 * mean_error(&fit.report.views),
            1,
        ));
        let between = 100.0 * mean_error(&fit.report.held_out);
        figures.push(Figure::rounded(format!("models {name} between"), between, 1));
        figures.push(Figure::count(format!("models {name} bytes"), fit.bytes.len()));
    }
    Ok(figures)
}

/// Errors of the presets at the samples that they were fitted to.
fn presets_at_their_samples() -> anyhow::Result<Vec<Figure>> {
    let data = argument::data_folder()?;
    let mut figures = Vec::new();
    for (name, bytes) in PRESETS {
        let Content::Samples(table) = read(&data.join("cornell").join(name).with_extension("brdf"))?.content
        else {
            bail!("{name}: samples are expected")
        };
        let material = Material::from_bytes(*bytes)?;
        let views: Vec<ViewReport> =
            table.views.iter().map(|view| ViewReport::judge(&material, view)).collect::<Result<_, _>>()?;
        figures.push(Figure::rounded(format!("samples {name}"), 100.0 * mean_error(&views), 2));
    }
    Ok(figures)
}

/// Table 5.1 of the thesis, by the mean over the views and over all views as one.
fn table_5_1() -> anyhow::Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for (material, method, score) in thesis_table::scores(&argument::data_folder()?)? {
        let name = format!("table-5.1 {material} {method}");
        figures.push(Figure::rounded(name.clone(), 100.0 * score.mean, 2));
        figures.push(Figure::rounded(format!("{name} whole"), 100.0 * score.whole, 2));
    }
    Ok(figures)
}
