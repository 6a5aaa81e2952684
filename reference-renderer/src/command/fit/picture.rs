//! `srbf fit --picture`: of a table, the fit and the table as balls side by side, with their difference; of samples, curves of the fit
//! with the samples as points.

mod curves;

use super::method::MethodName;
use crate::ball_sheet::{self, Light};
use crate::command::{argument, ball};
use crate::environment::Environment;
use crate::material::StoredMaterial;
use crate::measured::MeasuredMaterial;
use crate::shader::LoadedMaterial;
use anyhow::ensure;
use srbf_core::Material;
use srbf_fit::complete::complete;
use srbf_fit::read::{Content, Source};
use std::path::{Path, PathBuf};

/// The picture of a fit.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Also draws the fit into this PNG. Of a table with a value for every pair of directions: a ball of the fit, one of the table,
    /// and their difference, as `srbf ball` does of a fit that is there already. Of samples: curves of the lobes and of the completed
    /// samples in the plane of incidence of every view, with the samples near it as points.
    #[arg(long, value_name = "OUT.png", conflicts_with_all = ["survey", "lobes_table"])]
    picture: Option<PathBuf>,
    /// The light of balls: sky (the default), haze, constant:VALUE, or a latitude-longitude map in a .hdr or .exr file
    #[arg(long, requires = "picture")]
    env: Option<String>,
}

/// The light of balls where none is named.
const LIGHT: &str = "sky";

/// A picture that can be drawn once there is a fit.
pub struct Picture {
    path: PathBuf,
    /// Name of the light of balls, and the light; curves have none.
    light: Option<(String, Environment)>,
}

impl Args {
    /// Finds out, before the fit, whether the picture that is asked for can be drawn and written.
    ///
    /// # Errors
    /// Names what stands against it.
    pub fn check(&self, source: &Source, method: MethodName) -> anyhow::Result<Option<Picture>> {
        let Some(path) = &self.picture else { return Ok(None) };
        ensure!(method == MethodName::Tracked, "--picture: only fits of our own method can be drawn");
        ball::check_output(path)?;
        let light = match source.content {
            Content::Samples(_) => {
                ensure!(self.env.is_none(), "--env: the picture of samples has curves, which need no light");
                None
            }
            Content::Evaluable(_) => {
                let name = self.env.as_deref().unwrap_or(LIGHT);
                Some((name.to_owned(), argument::environment(name)?))
            }
        };
        Ok(Some(Picture { path: path.clone(), light }))
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

    /// Draws and writes the picture of a fit that is written to `output`.
    ///
    /// # Errors
    /// Names the file that cannot be written.
    pub fn write(&self, output: &Path, bytes: Vec<u8>, source: Source) -> anyhow::Result<()> {
        let Some((name, environment)) = &self.light else {
            return self.write_curves(bytes, &source);
        };
        let stem = output.file_stem().unwrap_or_default().to_string_lossy();
        let fit = LoadedMaterial::Lobes(StoredMaterial::new(&stem, bytes.into())?);
        let table = LoadedMaterial::Table(Box::new(MeasuredMaterial::new(source)?));
        let light = Light { name, environment, samples: ball_sheet::SAMPLES, stops: 0.0 };
        ball::write(&self.path, &fit, Some(&table), &light)
    }

    fn write_curves(&self, bytes: Vec<u8>, source: &Source) -> anyhow::Result<()> {
        let Content::Samples(table) = &source.content else { return Ok(()) };
        curves::write(&self.path, &source.name, table, &complete(table)?, &Material::from_bytes(bytes)?)?;
        println!("{}", self.path.display());
        Ok(())
    }
}
