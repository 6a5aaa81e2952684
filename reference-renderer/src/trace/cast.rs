//! The materials of a scene: one for each role that it has, and the lobes that sample the object's table.

use crate::shade::shader::{LoadedMaterial, Shader};
use crate::shade::{Sampler, SamplerName};
use crate::trace::scene::{Role, SceneName};
use crate::truth::Truth;
use crate::truth::sheets::StoredSheet;
use crate::truth::stored::{self, StoredMaterial};
use anyhow::{Context, ensure};
use srbf_core::FormatError;

/// Materials of the room's ball and coloured walls.
const BALL: &str = "krylon_blue";
const RED: [f32; 3] = [0.55, 0.06, 0.05];
const GREEN: [f32; 3] = [0.10, 0.40, 0.08];

/// Names of materials; a role without one has the scene's own.
#[derive(Clone, Copy, Debug, Default)]
pub struct Names<'a> {
    pub object: &'a str,
    pub ground: Option<&'a str>,
    pub ball: Option<&'a str>,
    /// Lobes that sample the object's table.
    pub lobes: Option<&'a str>,
}

/// The loaded materials: one for each role of the scene; the object's is the first.
pub struct Cast {
    pub roles: Vec<(Role, LoadedMaterial)>,
    pub lobes: Option<StoredMaterial>,
}

/// Loads the object of a scene.
fn object(scene: SceneName, name: &str) -> anyhow::Result<LoadedMaterial> {
    if scene.has_sheet() {
        let sheet =
            StoredSheet::load(name).with_context(|| format!("--scene {} shows a sheet", scene.text()));
        return Ok(LoadedMaterial::Sheet(Box::new(sheet?)));
    }
    LoadedMaterial::load(name).map_err(|error| match error.downcast_ref() {
        Some(FormatError::Kind { .. }) => error.context(format!(
            "--scene {} shows a material; lamp-shade and window show a sheet, and FILE:front-transmission is a material of it",
            scene.text()
        )),
        _ => error,
    })
}

impl Cast {
    /// Loads the materials of the roles that the scene has, and no others.
    ///
    /// # Errors
    /// As [`LoadedMaterial::load`]; lobes for a material that is no table; a sheet where the scene shows a material, or the other way round.
    pub fn load(scene: SceneName, names: Names<'_>) -> anyhow::Result<Self> {
        let object = object(scene, names.object)?;
        ensure!(
            names.lobes.is_none() || object.table().is_some(),
            "--lobes: they sample a table, and {} names lobes, which sample themselves",
            names.object
        );
        let lobes = names.lobes.map(StoredMaterial::load).transpose()?;
        Self::of(scene, object, lobes, names.ground, names.ball)
    }

    /// Sets a material that is there already, and the lobes that sample it, among the scene's own.
    ///
    /// # Errors
    /// As [`LoadedMaterial::load`].
    pub fn of(
        scene: SceneName,
        object: LoadedMaterial,
        lobes: Option<StoredMaterial>,
        ground: Option<&str>,
        ball: Option<&str>,
    ) -> anyhow::Result<Self> {
        let coloured = |name, albedo| StoredMaterial::matte(name, albedo).map(LoadedMaterial::Lobes);
        let load = |&role: &Role| {
            let material = match role {
                Role::Object => return Ok(None),
                Role::Ground => LoadedMaterial::load(ground.unwrap_or(stored::MATTE)),
                Role::Ball => LoadedMaterial::load(ball.unwrap_or(BALL)),
                Role::Left => coloured("red wall", RED),
                Role::Right => coloured("green wall", GREEN),
            };
            Ok(Some((role, material?)))
        };
        let others: Vec<_> = scene.roles().iter().map(load).collect::<anyhow::Result<_>>()?;
        let roles = std::iter::once((Role::Object, object)).chain(others.into_iter().flatten()).collect();
        Ok(Self { roles, lobes })
    }

    /// The material of the object.
    pub fn object(&self) -> &LoadedMaterial {
        &self.roles[0].1
    }

    /// Fits a sampler to each material. Materials beside the object that it cannot sample keep their own sampler.
    ///
    /// # Errors
    /// A sampler that cannot sample the object.
    pub fn fit(&self, name: SamplerName) -> anyhow::Result<Vec<Sampler<'_>>> {
        let lobes = self.lobes.as_ref().map(|stored| &stored.material);
        self.fit_with(name, self.object().truth(), lobes.filter(|_| self.object().table().is_some()))
    }

    /// Fits a sampler to each material where the lobes take the object's place and are rendered.
    ///
    /// # Errors
    /// A sampler that cannot sample them; a cast without lobes.
    pub fn fit_to_lobes(&self, name: SamplerName) -> anyhow::Result<Vec<Sampler<'_>>> {
        self.fit_with(name, self.lobes_as_material()?, None)
    }

    /// The lobes as the rendered material.
    ///
    /// # Errors
    /// A cast without lobes.
    pub fn lobes_as_material(&self) -> anyhow::Result<Truth<'_>> {
        let lobes = self.lobes.as_ref();
        let lobes = lobes.with_context(|| {
            format!(
                "material {}: fit:SAMPLER renders the lobes of a table, and --lobes names none",
                self.object().name()
            )
        })?;
        Ok(Truth::Lobes(&lobes.material))
    }

    fn fit_with<'a>(
        &'a self,
        name: SamplerName,
        object: Truth<'a>,
        lobes: Option<&'a srbf_core::Material<stored::Bytes>>,
    ) -> anyhow::Result<Vec<Sampler<'a>>> {
        let fit = |(role, material): &'a (Role, LoadedMaterial)| {
            if *role == Role::Object {
                return Sampler::fit(name, &object, lobes)
                    .with_context(|| format!("material {}", material.name()));
            }
            let fitted = Sampler::fit(name, &material.truth(), None);
            fitted.or_else(|_| Sampler::fit(SamplerName::Lobes, &material.truth(), None))
        };
        self.roles.iter().map(fit).collect()
    }

    /// The material of a role with its sampler; `object` is that of the object, `samplers` are those of all roles.
    pub fn shader<'a>(&'a self, role: Role, object: Truth<'a>, samplers: &'a [Sampler<'a>]) -> Shader<'a> {
        let n = self.roles.iter().position(|part| part.0 == role).unwrap_or(0);
        let truth = if n == 0 { object } else { self.roles[n].1.truth() };
        Shader { truth, sampler: &samplers[n] }
    }
}
