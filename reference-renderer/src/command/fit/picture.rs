//! `srbf fit --picture`: the fit and the table as balls side by side, with their difference.

use super::method::MethodName;
use crate::ball_sheet::{self, Light};
use crate::command::{argument, ball};
use crate::environment::Environment;
use crate::material::StoredMaterial;
use crate::measured::{self, MeasuredMaterial};
use crate::shader::LoadedMaterial;
use anyhow::{Context, ensure};
use srbf_fit::read::Source;
use std::path::{Path, PathBuf};

/// The picture of a fit.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Also draws a ball of the fit, one of the table, and their difference, into this PNG; for tables with a value for every pair of
    /// directions. `srbf ball` does so with a fit that is there already.
    #[arg(long, value_name = "OUT.png", conflicts_with_all = ["survey", "lobes_table"])]
    picture: Option<PathBuf>,
    /// The light of the picture: sky, haze, constant:VALUE, or a latitude-longitude map in a .hdr or .exr file
    #[arg(long, default_value = "sky", requires = "picture")]
    env: String,
}

/// A picture that can be drawn once there is a fit.
pub struct Picture {
    path: PathBuf,
    light: String,
    environment: Environment,
}

impl Args {
    /// Finds out, before the fit, whether the picture that is asked for can be drawn and written.
    ///
    /// # Errors
    /// Names what stands against it.
    pub fn check(&self, file: &Path, source: &Source, method: MethodName) -> anyhow::Result<Option<Picture>> {
        let Some(path) = &self.picture else { return Ok(None) };
        ensure!(method == MethodName::Tracked, "--picture: only fits of our own method can be rendered");
        measured::check_evaluable(&source.content)
            .with_context(|| format!("--picture, {}", file.display()))?;
        ball::check_output(path)?;
        let environment = argument::environment(&self.env)?;
        Ok(Some(Picture { path: path.clone(), light: self.env.clone(), environment }))
    }
}

impl Picture {
    /// Refuses a picture that would take the place of the material.
    ///
    /// # Errors
    /// Names the file.
    pub fn check_beside(&self, output: &Path) -> anyhow::Result<()> {
        ensure!(self.path != output, "--picture {}: -o names the same file", output.display());
        Ok(())
    }

    /// Draws and writes the picture of a fit that is written to `output`, beside the table.
    ///
    /// # Errors
    /// Names the file that cannot be written.
    pub fn write(&self, output: &Path, bytes: Vec<u8>, source: Source) -> anyhow::Result<()> {
        let stem = output.file_stem().unwrap_or_default().to_string_lossy();
        let fit = LoadedMaterial::Lobes(StoredMaterial::new(&stem, bytes.into())?);
        let table = LoadedMaterial::Table(Box::new(MeasuredMaterial::new(source)?));
        let light = Light {
            name: &self.light,
            environment: &self.environment,
            samples: ball_sheet::SAMPLES,
            stops: 0.0,
        };
        ball::write(&self.path, &fit, Some(&table), &light)
    }
}
