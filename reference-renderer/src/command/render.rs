//! `srbf render`.

use super::argument;
use crate::numbers::points::PointsName;
use crate::out::output;
use crate::out::picture_file;
use crate::out::print::{ending, shown};
use crate::out::progress::Progress;
use crate::shade::shader::{LoadedMaterial, Shader};
use crate::shade::{Light, Sampler, SamplerName, Strategy};
use crate::study::comparison::SPLIT;
use crate::study::furnace::{self, Furnace};
use crate::trace::camera::Camera;
use crate::trace::cast::{self, Cast};
use crate::trace::film::{self, Film};
use crate::trace::integrator::skeleton::skeleton;
use crate::trace::render::{add_samples, add_samples_by_waves, add_spectral_samples};
use crate::trace::scene::{Role, Scene, SceneName, Standpoint};
use crate::trace::settings::RenderSettings;
use crate::truth::Truth;
use crate::truth::sheets::GROUND_GLASS;
use crate::truth::stored;
use crate::world::environment::file::Projection;
use crate::world::illuminant::Illuminant;
use crate::world::mesh;
use crate::world::skin::{self, Skin};
use anyhow::{Context, bail, ensure};
use cpu_time::ThreadTime;
use glam::Vec3;
use srbf_core::SpectralMap;
use srbf_fit::read::Spectra;
use std::path::PathBuf;
use std::time::Instant;

/// Renders a scene with a material to EXR and PNG.
///
/// Writes linear radiance to OUT.exr, and a tone-mapped PNG beside it; to OUT.png that alone. The furnace, and the sphere under `--env constant:VALUE`, print the
/// mean that was rendered beside the closed form, or the quadrature of a table. The last lines name the rendered materials and their samplers.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The scene
    #[arg(long, value_enum, default_value = "sphere")]
    scene: SceneName,
    /// A .obj or .ply file: the statue, or what takes the place of the teapot. It is scaled and set on the ground
    #[arg(long, value_name = "FILE")]
    mesh: Option<PathBuf>,
    /// The axis that is up in the mesh file
    #[arg(long, value_enum, default_value = "y", requires = "mesh")]
    mesh_up: Up,
    /// Materials of the mesh, separated by commas, up to 256: .srbf files, presets, or tables as --material. The first takes the place of
    /// --material. A mesh without coordinates on maps is wrapped once round by them
    #[arg(
        long,
        value_delimiter = ',',
        requires = "mesh",
        conflicts_with = "material",
        value_name = "FILE|PRESET,..."
    )]
    palette: Vec<String>,
    /// Map of the palette's materials, numbers from 0, a .png of 8 bits: red a first, green a second; of a grey one each place has one
    #[arg(long, requires = "palette", value_name = "FILE.png")]
    index_map: Option<PathBuf>,
    /// Map of the share of the second material, .png or .exr; without --index-map those are the first two of the palette
    #[arg(long, requires = "palette", value_name = "FILE")]
    weight_map: Option<PathBuf>,
    /// Map of a colour that the light reflected by the mesh is multiplied by: .png in sRGB, or .exr, which is linear
    #[arg(long, requires = "mesh", value_name = "FILE")]
    tint_map: Option<PathBuf>,
    /// The material of the object: a .srbf file or the name of a preset, of which the lobes are the material; or a table or
    /// model that `fit` reads (.bsdf, .binary, .brdf, .astm, .csv, model:..., FILE.csv:NAME of published Lafortune fits), which is the
    /// truth, whatever samples it [default: garnet_red; of lamp-shade and window ground_glass]
    ///
    /// Of lamp-shade and window it is a sheet, a thin surface that lets light through: a .srbf file of `fit FILE.xml`, or ground_glass
    #[arg(long, value_name = "FILE|PRESET|MODEL")]
    material: Option<String>,
    /// Material of the ground, and of floors and walls without a colour [default: matte]
    #[arg(long, value_name = "FILE|PRESET|MODEL")]
    ground_material: Option<String>,
    /// Material of the ball in a room, and of the lamp's foot [default: krylon_blue]
    #[arg(long, value_name = "FILE|PRESET|MODEL")]
    ball_material: Option<String>,
    /// The light: sky, haze (the sun spread wide), constant:VALUE, or a map in a .hdr or .exr file [default: sky; of the
    /// furnace constant:1, of the lamp constant:0.03, of the window haze]
    #[arg(long)]
    env: Option<String>,
    /// How the map shows directions: by longitude and latitude, or as an angular map, a disc round the direction of its centre
    #[arg(long, value_enum, default_value = "lat-long")]
    env_map: Projection,
    /// Degrees to turn the light by, anticlockwise seen from above
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true, value_name = "DEGREES")]
    env_turn: f64,
    /// Where the camera stands, in place of the scene's own
    #[arg(long, value_parser = argument::point, allow_negative_numbers = true, value_name = "X,Y,Z")]
    eye: Option<Vec3>,
    /// The point that it looks at
    #[arg(long, value_parser = argument::point, allow_negative_numbers = true, value_name = "X,Y,Z")]
    look_at: Option<Vec3>,
    /// Degrees that the shorter side of the picture sees
    #[arg(long, value_name = "DEGREES")]
    fov: Option<f32>,
    /// Size of the picture in pixels [default: 512x512; of the teapot 640x400]
    #[arg(long, value_parser = argument::size, value_name = "WIDTHxHEIGHT")]
    size: Option<[u32; 2]>,
    /// Samples a pixel
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=1 << 24))]
    spp: u32,
    /// How directions are chosen: SAMPLER, or SAMPLER+mis to sample the light too; mis is lobes+mis, and light the light alone; even and
    /// product sample lobes and light together.
    ///
    /// uniform, cosine; phong, ward, ggx (one such lobe and a cosine, fitted); lafortune (three lobes a channel, fitted); tabulated (the
    /// inverse distribution of the table), factored (that table factored); rgl (the warps of a .bsdf file); guided (GGX lobes of fixed
    /// roughness); thesis, thesis-walk, thesis-multi (round lobes blended by equation 9: by inversion, by a random walk, which is biased,
    /// several directions together); lobes, lobes-multi (those of the material or of --lobes; of a table without either, guided),
    /// defensive (and one direction in twenty from the cosine)
    #[arg(long, default_value = "even", value_name = "SAMPLER")]
    sampler: Strategy,
    /// Whether the light is sampled: with the sampler (mis), not (off), or alone (only) [default: as --sampler says]
    #[arg(long, value_enum)]
    light: Option<Light>,
    /// The .srbf file or preset whose lobes sample the table that --material names
    #[arg(long, value_name = "FILE|PRESET")]
    lobes: Option<String>,
    /// Directions drawn together at the first hit; --spp counts directions [default: 16 for samplers of several, else 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    split: Option<u32>,
    /// The numbers of a path: Owen-scrambled Sobol points, each decision along it with four dimensions of its own, or random
    /// numbers; thesis-walk takes random ones beyond three [default: sobol; random where a standard error is printed, of the furnace]
    #[arg(long, value_enum)]
    points: Option<PointsName>,
    /// Seed of the points or random numbers
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Scatterings along a path; 1 is direct light only
    #[arg(long, default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=1000))]
    max_bounces: u32,
    /// Follows many paths together, and asks the hits of each material in one request: the same picture but for rounding. For lobes
    /// that sample themselves: --sampler mis or lobes is expected
    #[arg(long)]
    wavefront: bool,
    /// Paths carry values at four wavelengths, under a light whose colours are those of --env; the eye is used to the light, so that white
    /// stays white. The light is D65, A, F11, or a file of text with a wavelength and a power on each line
    #[arg(long, num_args = 0..=1, default_missing_value = "D65", value_name = "LIGHT|FILE", conflicts_with = "wavefront")]
    spectral: Option<String>,
    /// Threads; 0 is one a processor. The picture does not depend on it
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=1024))]
    threads: u16,
    /// Also prints parts that were not loaded or built, and why
    #[arg(long)]
    explain: bool,
    /// Stops to brighten the PNG by; the EXR stays as it is. They count from the exposure of the light, under which a matte surface that
    /// reflects half of it, and faces it, is shown as white: so pictures of several materials can be compared. Those of lamp-shade and window have
    /// one that fits the picture
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true, value_name = "STOPS")]
    exposure: f32,
    /// The picture to write: .exr, with a .png beside it, or .png alone
    #[arg(short, long, default_value = "out/render.exr", value_name = "OUT.exr|OUT.png")]
    output: PathBuf,
}

/// Which axis of a mesh file is up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Up {
    Y,
    Z,
}

/// Degrees that the camera may see.
const VIEW_ANGLES: std::ops::RangeInclusive<f32> = 0.01..=170.0;

/// Runs the command.
pub fn run(args: Args) -> anyhow::Result<()> {
    check(&args)?;
    argument::on_threads(args.threads.into(), || render(&args))
}

/// Refuses options that do not fit together, before the work.
fn check(args: &Args) -> anyhow::Result<()> {
    let files = written(args)?;
    output::check_places(&files.iter().map(PathBuf::as_path).collect::<Vec<_>>())?;
    argument::check_stops(args.exposure)?;
    ensure!(args.env_turn.is_finite(), "--env-turn {}: a number of degrees is expected", args.env_turn);
    let has = |role| args.scene.roles().contains(&role);
    ensure!(
        args.ground_material.is_none() || has(Role::Ground),
        "--ground-material: the scene has no ground, --scene teapot, statue, room, lamp-shade or window is expected"
    );
    ensure!(
        args.ball_material.is_none() || has(Role::Ball),
        "--ball-material: the scene has no ball, --scene room, lamp-shade or window is expected"
    );
    ensure!(
        args.palette.len() < 2 || args.index_map.is_some() || args.weight_map.is_some(),
        "--palette: --index-map or --weight-map is expected, which chooses among its materials"
    );
    match (args.scene, &args.mesh) {
        (SceneName::Statue, None) => bail!("--scene statue: --mesh FILE is expected, which is the statue"),
        (scene, Some(_)) if !scene.takes_mesh() => {
            bail!("--mesh: it takes the place of the teapot, --scene teapot, statue or room is expected")
        }
        _ => {}
    }
    let is_constant = args.env.as_ref().is_none_or(|env| env.starts_with("constant:"));
    ensure!(
        args.scene != SceneName::Furnace || is_constant,
        "--scene furnace: its light is the same from everywhere, --env constant:VALUE is expected"
    );
    let split = split(args);
    ensure!(
        args.spp.is_multiple_of(split),
        "--spp {}: a multiple of {split} is expected, the directions drawn together (--split)",
        args.spp
    );
    standpoint(args).map(|_| ())
}

/// The files to write: the one that is named, and a PNG beside an EXR.
fn written(args: &Args) -> anyhow::Result<Vec<PathBuf>> {
    let is_png = ending(&args.output) == "png";
    ensure!(
        is_png || ending(&args.output) == "exr",
        "output {}: a name that ends in .exr or .png is expected",
        shown(&args.output)
    );
    let png = (!is_png).then(|| args.output.with_extension("png"));
    Ok([args.output.clone()].into_iter().chain(png).collect())
}

/// Where the camera stands.
fn standpoint(args: &Args) -> anyhow::Result<Standpoint> {
    let own = args.scene.standpoint();
    let (eye, target) = (args.eye.unwrap_or(own.eye), args.look_at.unwrap_or(own.target));
    let view_angle = args.fov.unwrap_or(own.view_angle);
    ensure!(VIEW_ANGLES.contains(&view_angle), "--fov {view_angle}: 0.01 to 170 degrees are expected");
    let apart = (target - eye).length();
    ensure!(apart > 1e-6 * eye.length().max(1e-3), "--eye and --look-at: two different places are expected");
    Ok(Standpoint { eye, target, view_angle })
}

/// Directions drawn together at the first hit.
fn split(args: &Args) -> u32 {
    args.split.unwrap_or(if args.sampler.sampler.is_multi() { SPLIT } else { 1 })
}

fn render(args: &Args) -> anyhow::Result<()> {
    let illuminant = args.spectral.as_deref().map(Illuminant::load).transpose()?;
    // Even sums are of colours; where they are left out, the light is sampled once.
    let own_light = match args.sampler.light {
        Light::Even if illuminant.is_some() => Light::Mis,
        light => light,
    };
    let strategy = Strategy { light: args.light.unwrap_or(own_light), ..args.sampler };
    let first = args.palette.first().map(String::as_str);
    let names = cast::Names {
        object: first.or(args.material.as_deref()).unwrap_or(own_material(args.scene)),
        ground: args.ground_material.as_deref(),
        ball: args.ball_material.as_deref(),
        lobes: args.lobes.as_deref(),
    };
    let cast = Cast::load(args.scene, names)?;
    let environment =
        argument::projected_environment(env(args), args.env_map)?.turned(radians(args.env_turn));
    let mesh = args.mesh.as_deref().map(mesh::file::read).transpose()?.map(|mut mesh| {
        if args.mesh_up == Up::Y {
            mesh.turn_y_up();
        }
        mesh
    });
    let files = skin::Files {
        index: args.index_map.as_deref(),
        weight: args.weight_map.as_deref(),
        tint: args.tint_map.as_deref(),
    };
    let has_maps = files.index.or(files.weight).or(files.tint).is_some();
    let skin = has_maps.then(|| Skin::read(files, args.palette.len().max(1))).transpose()?;
    let mesh = mesh.map(|mut mesh| {
        if has_maps {
            mesh.wrap();
        }
        mesh
    });
    let others = args.palette.iter().skip(1).map(|name| LoadedMaterial::load(name));
    let others: Vec<LoadedMaterial> = others.collect::<anyhow::Result<_>>()?;
    let samplers = cast.fit(strategy.sampler)?;
    let fit = |material| Sampler::fit(strategy.sampler, &LoadedMaterial::truth(material), None);
    let of_others: Vec<Sampler<'_>> = others.iter().map(fit).collect::<anyhow::Result<_>>()?;
    let shader = |role: Role| cast.shader(role, cast.object().truth(), &samplers);
    let mut scene = Scene::build(args.scene.shapes(mesh), shader, &environment);
    if let Some(skin) = &skin {
        let rest = others
            .iter()
            .zip(&of_others)
            .map(|(material, sampler)| Shader { truth: material.truth(), sampler });
        scene = scene.with_skin(skin, std::iter::once(shader(Role::Object)).chain(rest).collect());
    }
    let size = args.size.unwrap_or(if args.scene == SceneName::Teapot { [640, 400] } else { [512, 512] });
    let camera = standpoint(args)?.camera(size);
    let split = split(args);
    // The closed form is of colours, as they are in daylight.
    let has_closed_form = illuminant.as_ref().is_none_or(Illuminant::is_daylight);
    let is_furnace = args.scene.is_sphere() && environment.constant_radiance().is_some() && has_closed_form;
    // A standard error is told there, which independent samples have.
    let own = if is_furnace { PointsName::Random } else { PointsName::Sobol };
    let settings = RenderSettings {
        light: strategy.light,
        split,
        max_bounces: args.max_bounces,
        points: args.points.unwrap_or(own),
        seed: args.seed,
    };

    film::check_memory(size)?;
    let mut film = Film::new(size);
    let progress = Progress::new("rendering", size[1].into());
    let start = Instant::now();
    let samples = args.spp / split;
    let added = match &illuminant {
        Some(illuminant) => {
            add_spectral_samples(&scene, &camera, &settings, illuminant, &mut film, samples, &progress)
        }
        None if args.wavefront => {
            add_samples_by_waves(&scene, &camera, &settings, &mut film, samples, &progress)
        }
        None => add_samples(&scene, &camera, &settings, &mut film, samples, &progress),
    };
    let spent = added.with_context(|| {
        let names: Vec<&str> = cast.roles.iter().map(|part| part.1.name()).collect();
        format!("material {}, light {}", names.join(", "), env(args))
    })?;
    let seconds = start.elapsed().as_secs_f64();
    drop(progress);
    if let Some(warning) = film.warning() {
        eprintln!("{warning}");
    }

    let picture = film.to_picture();
    let (own, of) = if args.scene.has_sheet() {
        (picture_file::automatic_exposure(&picture), "by the picture")
    } else {
        (environment.exposure(), "that of the light")
    };
    let exposure = own * args.exposure.exp2();
    let (paths, together) = (written(args)?, output::together());
    for path in &paths {
        match ending(path) == "png" {
            true => picture_file::write_tone_mapped_png(path, size, &picture, exposure)?,
            false => picture_file::write_exr(path, size, &picture)?,
        }
    }
    together.commit()?;
    println!(
        "{}: {} samples a pixel in {seconds:.2} s ({})",
        paths.iter().map(shown).collect::<Vec<_>>().join(" and "),
        args.spp,
        srbf_core::Processor::this()
    );
    let stops = if args.exposure == 0.0 { String::new() } else { format!(", {:+} stops", args.exposure) };
    println!("exposure of the PNG: {exposure:.3}, {of}{stops}");
    match environment.constant_radiance().filter(|_| is_furnace) {
        Some(_) if settings.points == PointsName::Sobol => {
            println!("white furnace: Sobol points have no standard error, --points random is expected");
        }
        Some(_) if film.samples < 2 => {
            println!("white furnace: no standard error, at least two samples a pixel are needed");
        }
        Some(radiance) => {
            let albedos = furnace::albedos(&scene, &camera, film.size());
            print_furnace(&furnace::compare(&albedos, radiance, &film));
        }
        None => {}
    }
    print_cast(&cast, &samplers, strategy);
    for (n, material) in others.iter().enumerate() {
        println!("palette {}: rendered is {}", n + 1, srbf_core::printable(&rendered(material)));
    }
    if let Some(illuminant) = &illuminant {
        let lacking = cast.roles.iter().filter(|(_, material)| material.truth().spectral_map().is_none());
        let lacking: Vec<&str> = lacking.map(|(_, material)| material.name()).collect();
        let smooth = if lacking.is_empty() {
            String::new()
        } else {
            format!("; colours are made smooth spectra of {}", srbf_core::printable(&lacking.join(", ")))
        };
        println!("spectra: four wavelengths a path, under {}{smooth}", shown(&illuminant.name));
    }
    if args.explain {
        let [paths, seconds] = around_lobes(&scene, &camera, size, &settings);
        println!(
            "around the lobes: rays, normals and the order of the light take {:.0} ns a path, {:.0} % of the picture's time",
            1e9 * seconds / paths,
            100.0 * seconds / paths * f64::from(film.samples) * film.pixels.len() as f64
                / spent.as_secs_f64()
        );
        explain(args, &cast, strategy);
    }
    Ok(())
}

/// The light, as it is named.
fn env(args: &Args) -> &str {
    args.env.as_deref().unwrap_or(args.scene.light())
}

/// The object's material where none is named.
fn own_material(scene: SceneName) -> &'static str {
    if scene.has_sheet() { GROUND_GLASS } else { stored::DEFAULT }
}

/// Prints every rendered material and its sampler.
fn print_cast(cast: &Cast, samplers: &[Sampler<'_>], strategy: Strategy) {
    for ((role, material), sampler) in cast.roles.iter().zip(samplers) {
        let truth = material.truth();
        let by = match (role, &cast.lobes) {
            (Role::Object, Some(lobes)) if sampler.is_of_lobes() => {
                format!("{} of {}", sampler.title(&truth), lobes.name)
            }
            _ => sampler.title(&truth),
        };
        println!(
            "{}: rendered is {}; sampled by {by}",
            role.text(),
            srbf_core::printable(&rendered(material))
        );
    }
    let light = match strategy.light {
        Light::Mis => "sampled too, both weighted by the power heuristic",
        Light::Off => "not sampled",
        Light::Only => "sampled alone; the samplers only lead paths on",
        Light::Even => "sampled together with the lobes, by even sums where they are seen to help",
        Light::Product => "sampled together with the lobes, by resampling candidates of both",
    };
    println!("light: {light}");
}

/// The rendered material, in words.
fn rendered(material: &LoadedMaterial) -> String {
    match (material.truth(), material.name()) {
        (Truth::Lobes(lobes), name) => {
            // Of other wavelengths than the eye's, colours are no colours.
            let map = lobes.spectral_map().filter(SpectralMap::is_grey);
            let spectrum = map.and_then(|map| Spectra::of_map(map, None).ok());
            let spectrum = spectrum.map_or_else(String::new, |map| format!(", {}", map.text()));
            format!("{name}, lobes: {}{spectrum}", lobes.lobe_count())
        }
        (Truth::Table(table), name) => match table.completed {
            Some(samples) => format!("{name}, {samples} samples completed"),
            None => format!("{name}, the table"),
        },
        (Truth::Sheet(stored), name) => format!("{name}, a sheet, lobes: {}", stored.sheet.lobe_count()),
    }
}

/// Follows paths of the picture that evaluate and sample no lobes: how many, and the seconds that a processor took. What their surfaces
/// reflect is a cosine.
fn around_lobes(scene: &Scene<'_>, camera: &Camera, size: [u32; 2], settings: &RenderSettings) -> [f64; 2] {
    let start = ThreadTime::now();
    let paths = 20_000;
    for i in 0..paths {
        skeleton(scene, camera, size, settings, i);
    }
    [paths as f64, start.elapsed().as_secs_f64()]
}

/// Prints parts that were not loaded or built.
fn explain(args: &Args, cast: &Cast, strategy: Strategy) {
    println!("left out:");
    let scene = args.scene.text();
    for role in Role::ALL {
        if !args.scene.roles().contains(&role) {
            println!("  material of the {}: the scene {scene} has none", role.text());
        }
    }
    if args.scene.is_sphere() {
        println!("  triangles and their tree: a sphere is met in closed form");
    } else if let Some(mesh) = &args.mesh {
        println!("  teapot: {} takes its place", shown(mesh));
    }
    let others: Vec<&str> =
        SamplerName::all().filter(|name| *name != strategy.sampler).map(SamplerName::text).collect();
    println!("  samplers {}: not asked for, not fitted", others.join(", "));
    for (role, material) in &cast.roles {
        if matches!(material, LoadedMaterial::Table(table) if !table.has_guide()) {
            println!("  guide of the {}'s table: another sampler draws", role.text());
        }
    }
    if strategy.light == Light::Off {
        println!("  samples of the light: --light off; the map is looked up alone");
    }
    if !(args.scene.is_sphere() && env(args).starts_with("constant:")) {
        println!("  albedo of the object: no furnace compares with it");
    }
}

/// The angle within one turn; the remainder is exact, and a large angle in f32 is not.
fn radians(degrees: f64) -> f32 {
    ((degrees % 360.0) as f32).to_radians()
}

fn print_furnace(furnace: &Furnace) {
    println!("white furnace, mean over the {} pixels that the sphere fills:", furnace.pixels);
    if furnace.pixels == 0 {
        println!("no standard error: at least one such pixel is needed");
        return;
    }
    println!(
        "{:8} {:>10} {:>14} {:>10} {:>12}",
        "channel", "rendered", "standard error", "expected", "deviation"
    );
    for (i, channel) in ["red", "green", "blue"].iter().enumerate() {
        let (rendered, error, expected) =
            (furnace.rendered[i], furnace.standard_error[i], furnace.expected[i]);
        let deviation = furnace.deviation(i).map_or_else(|| "-".to_owned(), |d| format!("{d:.2} se"));
        println!("{channel:8} {rendered:>10.6} {error:>14.6} {expected:>10.6} {deviation:>12}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_turns_of_the_light_are_as_one() {
        for (degrees, same) in [(1e9, 280.0), (-1e9, -280.0), (360.0 * 1e12 + 90.0, 90.0), (37.5, 37.5)] {
            assert_eq!(radians(degrees), (same as f32).to_radians(), "{degrees}");
        }
    }
}
