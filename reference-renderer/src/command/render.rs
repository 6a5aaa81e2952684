//! `srbf render`.

use super::argument;
use crate::film::{self, Film};
use crate::furnace::{self, Furnace};
use crate::integrator::Sampler;
use crate::material;
use crate::mesh;
use crate::output;
use crate::picture_file;
use crate::progress::Progress;
use crate::render::{Settings, add_samples};
use crate::scene::{Scene, SceneName};
use crate::shader::LoadedMaterial;
use anyhow::{Context, ensure};
use std::path::PathBuf;
use std::time::Instant;

/// Renders a scene with a material to EXR and PNG.
///
/// Writes linear radiance to OUT, and a tone-mapped PNG beside it. The sphere under `--env constant:VALUE` is a white
/// furnace: the mean that was rendered is printed beside the closed form, or the quadrature of a table.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The scene
    #[arg(long, value_enum, default_value = "sphere")]
    scene: SceneName,
    /// A .obj or .ply file that takes the place of the teapot
    #[arg(long, value_name = "FILE")]
    mesh: Option<PathBuf>,
    /// The axis that is up in the mesh file
    #[arg(long, value_enum, default_value = "y", requires = "mesh")]
    mesh_up: Up,
    /// Material of the object: a .srbf file, the name of a preset, or what `fit` reads and has a value for every pair of
    /// directions (.bsdf, .binary, model:..., FILE.csv:NAME of published Lafortune fits), which is then rendered as it is
    #[arg(long, default_value = material::DEFAULT, value_name = "FILE|PRESET|MODEL")]
    material: String,
    /// Material of the ground below the teapot [default: matte]
    #[arg(long, value_name = "FILE|PRESET|MODEL")]
    ground_material: Option<String>,
    /// The light: sky, haze (the sun spread wide), constant:VALUE, or a latitude-longitude map in a .hdr or .exr file
    #[arg(long, default_value = "sky")]
    env: String,
    /// Degrees to turn the light by, anticlockwise seen from above
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true, value_name = "DEGREES")]
    env_turn: f64,
    /// Size of the picture in pixels
    #[arg(long, default_value = "512x512", value_parser = argument::size, value_name = "WIDTHxHEIGHT")]
    size: [u32; 2],
    /// Samples a pixel
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=1 << 24))]
    spp: u32,
    /// How directions are chosen
    #[arg(long, value_enum, default_value = "mis")]
    sampler: Sampler,
    /// Seed of the random numbers
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Scatterings along a path; 1 is direct light only
    #[arg(long, default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=1000))]
    max_bounces: u32,
    /// Threads; 0 is one a processor. The picture does not depend on it
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=1024))]
    threads: u16,
    /// Stops to brighten the PNG by, from an exposure that fits the picture; the EXR stays as it is
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true, value_name = "STOPS")]
    exposure: f32,
    /// The picture to write, .exr
    #[arg(short, long, default_value = "out/render.exr", value_name = "OUT.exr")]
    output: PathBuf,
}

/// Which axis of a mesh file is up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Up {
    Y,
    Z,
}

/// Largest side of a mesh that takes the place of the teapot: about the teapot's height, so that it fills the picture.
const MESH_SIZE: f32 = 3.4;

/// Runs the command.
pub fn run(args: Args) -> anyhow::Result<()> {
    output::check_extension(&args.output, "exr")?;
    output::check_places(&[&args.output, &args.output.with_extension("png")])?;
    ensure!(args.exposure.abs() <= 64.0, "--exposure {}: within -64 to 64 is expected", args.exposure);
    ensure!(args.env_turn.is_finite(), "--env-turn {}: a number of degrees is expected", args.env_turn);

    let load = |name: &str| argument::on_threads(args.threads.into(), || LoadedMaterial::load(name));
    let object = load(&args.material)?;
    ensure!(
        args.ground_material.is_none() || args.scene == SceneName::Teapot,
        "--ground-material: only the teapot stands on a ground, add --scene teapot"
    );
    let ground = load(args.ground_material.as_deref().unwrap_or(material::MATTE))?;
    let environment = argument::environment(&args.env)?.turned(radians(args.env_turn));
    let scene = match &args.mesh {
        None => Scene::new(args.scene, object.shader(), ground.shader(), &environment),
        Some(path) => {
            ensure!(
                args.scene == SceneName::Teapot,
                "--mesh: it takes the place of the teapot, add --scene teapot"
            );
            let mut mesh = mesh::file::read(path)?;
            if args.mesh_up == Up::Y {
                mesh.turn_y_up();
            }
            mesh.stand(MESH_SIZE);
            Scene::with_mesh(args.scene, mesh, object.shader(), ground.shader(), &environment)
        }
    };
    let camera = args.scene.camera(args.size);
    let settings = Settings { sampler: args.sampler, max_bounces: args.max_bounces, seed: args.seed };

    film::check_memory(args.size)?;
    let mut film = Film::new(args.size);
    let progress = Progress::new("rendering", args.size[1].into());
    let start = Instant::now();
    argument::on_threads(args.threads.into(), || {
        add_samples(&scene, &camera, &settings, &mut film, args.spp, &progress)
    })
    .with_context(|| format!("material {}, ground {}, light {}", object.name(), ground.name(), args.env))?;
    let seconds = start.elapsed().as_secs_f64();
    drop(progress);

    let picture = film.to_picture();
    picture_file::write_exr(&args.output, args.size, &picture)?;
    let png = args.output.with_extension("png");
    let exposure = picture_file::automatic_exposure(&picture) * args.exposure.exp2();
    picture_file::write_tone_mapped_png(&png, args.size, &picture, exposure)?;
    println!(
        "{} and {}: {} samples a pixel in {seconds:.2} s",
        args.output.display(),
        png.display(),
        args.spp
    );

    if let (SceneName::Sphere, Some(radiance)) = (args.scene, environment.constant_radiance()) {
        if args.spp < 2 {
            println!("white furnace: no standard error, at least two samples a pixel are needed");
            return Ok(());
        }
        let furnace = argument::on_threads(args.threads.into(), || {
            Ok(furnace::compare(&scene, &camera, radiance, &film))
        })?;
        print_furnace(&furnace);
    }
    Ok(())
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
