//! The picture of a fit, `srbf fit`: beside the material, a PNG of the fit and its data.

use super::method::MethodName;
use super::names::{self, Job};
use crate::command::plot::{self, Beside};
use crate::command::{argument, ball};
use crate::out::output;
use crate::out::print::shown;
use crate::show::ball_sheet::Light;
use crate::truth::stored::StoredMaterial;
use crate::world::environment::Environment;
use anyhow::ensure;
use srbf_fit::read::Source;
use std::path::{Path, PathBuf};

/// The picture of a fit.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The picture to write; by default the name of the material with .png. It shows the fit beside its data: the sentence of the verdict,
    /// balls, curves in the plane of incidence and discs, as `srbf plot` does of a fit that is there already.
    #[arg(long, value_name = "OUT.png")]
    picture: Option<PathBuf>,
    /// Draws no picture.
    #[arg(long, conflicts_with = "picture")]
    no_picture: bool,
    /// Also writes a page of HTML beside the picture, the one that `srbf view` shows; it needs no other file and no network.
    #[arg(long, conflicts_with = "no_picture")]
    html: bool,
    /// The light of the balls: sky, haze, constant:VALUE, or a latitude-longitude map in a .hdr or .exr file
    #[arg(long, conflicts_with = "no_picture", default_value = plot::LIGHT)]
    env: String,
    /// Stops to brighten the balls by, from the exposure of the light, as in `srbf ball`
    #[arg(
        long,
        conflicts_with = "no_picture",
        default_value_t = 0.0,
        allow_negative_numbers = true,
        value_name = "STOPS"
    )]
    exposure: f32,
}

impl Args {
    /// The pictures of fits that are written to these places, after it has been found that they can be drawn and written.
    ///
    /// # Errors
    /// Names what stands against it.
    pub fn paths(&self, places: &[Job], method: MethodName) -> anyhow::Result<Vec<Option<PathBuf>>> {
        ensure!(
            !self.html || method == MethodName::Tracked,
            "--html: only fits of our own method can be drawn"
        );
        argument::check_stops(self.exposure)?;
        if let Some(path) = &self.picture {
            ensure!(method == MethodName::Tracked, "--picture: only fits of our own method can be drawn");
            ensure!(places.len() == 1, "--picture {}: it is of one file", shown(path));
        }
        places.iter().map(|place| self.path(place, method)).collect()
    }

    fn path(&self, place: &Job, method: MethodName) -> anyhow::Result<Option<PathBuf>> {
        if self.no_picture || method != MethodName::Tracked {
            return Ok(None);
        }
        let path = self.picture.clone().unwrap_or_else(|| names::picture(&place.output));
        ball::check_output(&path)?;
        if let Some(page) = self.page(&path) {
            output::check_place(&page)?;
        }
        ensure!(path != place.output, "--picture {}: -o names the same file", shown(&path));
        Ok(Some(path))
    }

    /// The page beside a picture, if there is to be one.
    pub fn page(&self, picture: &Path) -> Option<PathBuf> {
        self.html.then(|| picture.with_extension("html"))
    }

    /// The light of the balls.
    ///
    /// # Errors
    /// Names the light.
    pub fn light(&self) -> anyhow::Result<Environment> {
        argument::environment(&self.env)
    }

    /// Draws and writes the picture of a fit that was written to `output`: of its bytes and of its data.
    ///
    /// # Errors
    /// Names the file that cannot be written.
    pub fn write(
        &self,
        path: &Path,
        output: &Path,
        light: &Environment,
        (bytes, source): (Vec<u8>, Source),
        words: &[String],
    ) -> anyhow::Result<()> {
        let name = output.file_stem().unwrap_or_default().to_string_lossy();
        let (samples, stops) = (plot::SAMPLES, self.exposure);
        let light = Light { name: &self.env, environment: light, samples, stops, turn: 0.0 };
        let stored = StoredMaterial::new(&name, bytes.into())?;
        plot::write(path, stored, Some(Beside::new(source)?), light, words)?;
        Ok(())
    }
}
