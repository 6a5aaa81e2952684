//! The picture of a fit, `srbf fit`: beside the material, a PNG of the fit and what it was fitted to.

use super::method::MethodName;
use crate::ball_sheet::Light;
use crate::command::plot::{self, Beside};
use crate::command::{argument, ball};
use crate::environment::Environment;
use crate::material::StoredMaterial;
use anyhow::ensure;
use srbf_fit::read::Source;
use std::path::{Path, PathBuf};

/// The picture of a fit.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The picture to write; by default the name of the material with .png. It shows the fit beside what it was fitted to: curves in the
    /// plane of incidence, discs, balls and the verdict, as `srbf plot` does of a fit that is there already.
    #[arg(long, value_name = "OUT.png", conflicts_with_all = ["survey", "lobes_table"])]
    picture: Option<PathBuf>,
    /// Draws no picture.
    #[arg(long, conflicts_with = "picture")]
    no_picture: bool,
    /// The light of the balls: sky, haze, constant:VALUE, or a latitude-longitude map in a .hdr or .exr file
    #[arg(long, conflicts_with_all = ["survey", "lobes_table", "no_picture"], default_value = plot::LIGHT)]
    env: String,
}

/// A picture that can be drawn once there is a fit.
pub struct Picture {
    path: PathBuf,
    /// Name of the light, and the light.
    light: (String, Environment),
}

impl Args {
    /// Finds out, before the fit, whether the picture of a fit that is written to `output` can be drawn and written.
    ///
    /// # Errors
    /// Names what stands against it.
    pub fn check(&self, output: &Path, method: MethodName) -> anyhow::Result<Option<Picture>> {
        if method != MethodName::Tracked {
            ensure!(self.picture.is_none(), "--picture: only fits of our own method can be drawn");
            return Ok(None);
        }
        if self.no_picture {
            return Ok(None);
        }
        let path = self.picture.clone().unwrap_or_else(|| super::names::picture(output));
        ball::check_output(&path)?;
        ensure!(path != output, "--picture {}: -o names the same file", output.display());
        Ok(Some(Picture { path, light: (self.env.clone(), argument::environment(&self.env)?) }))
    }
}

impl Picture {
    /// Draws and writes the picture of a fit that is written to `output`.
    ///
    /// # Errors
    /// Names the file that cannot be written.
    pub fn write(
        &self,
        output: &Path,
        bytes: Vec<u8>,
        source: Source,
        verdict: &[String],
    ) -> anyhow::Result<()> {
        let name = output.file_stem().unwrap_or_default().to_string_lossy();
        let (light, environment) = &self.light;
        let light = Light { name: light, environment, samples: plot::SAMPLES, stops: 0.0 };
        let stored = StoredMaterial::new(&name, bytes.into())?;
        plot::write(&self.path, stored, Some(Beside::new(source)?), light, verdict)
    }
}
