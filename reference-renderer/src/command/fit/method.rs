//! `srbf fit --method`: the ways of fitting, and those whose result is no `.srbf` file.

use super::SettingArgs;
use crate::out::print::shown;
use anyhow::{anyhow, bail};
use srbf_fit::judge::cross::CrossValidation;
use srbf_fit::judge::method::{Fitted, Method};
use srbf_fit::judge::report::{Input, Report, ViewReport};
use srbf_fit::read::{Content, Conventions, Source};
use srbf_fit::table::Density;
use srbf_fit::table::Table;
use srbf_fit::table::evaluation_views;
use srbf_fit::{FitError, Tracked};
use srbf_thesis::evaluated::{Completed, Microfacet, Nearest};
use srbf_thesis::lafortune::{self, Lafortune};
use srbf_thesis::thesis;
use std::path::Path;
use std::time::Instant;

/// A way of fitting, on the command line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum MethodName {
    /// Our lobes, followed over all views: a .srbf file.
    #[default]
    Tracked,
    /// The thesis's algorithm: lobes of each view, as JSON.
    Thesis,
    /// Lafortune's generalised cosine lobes, best of 100 starts: coefficients, as JSON.
    Lafortune,
    /// Of samples: their completion, which our lobes are fitted to; a report as JSON.
    Completion,
    /// Of samples: a microfacet lobe and a diffuse term; a report as JSON.
    Microfacet,
    /// Of samples: joined by triangles, linear between them and between views; a report as JSON.
    Nearest,
}

/// Views at which a BRDF that can be evaluated is fitted.
const VIEWS: usize = 16;

/// Directions of each, for Lafortune's 10 unknowns.
const FITTED: Density = Density { hemisphere: 150, cap: 40 };

impl MethodName {
    /// Calls with the method and its settings.
    pub fn with<T>(self, args: &SettingArgs, call: impl FnOnce(&dyn Method) -> T) -> anyhow::Result<T> {
        Ok(match self {
            Self::Tracked => call(&Tracked(&args.settings())),
            Self::Thesis => call(&args.thesis()?),
            Self::Lafortune => call(&args.lafortune()?),
            Self::Completion | Self::Microfacet | Self::Nearest => {
                args.only("no options", "without lobes", &args.of_lobes())?;
                call(self.without_lobes())
            }
        })
    }
}

impl MethodName {
    /// The method, of those that have no lobes.
    fn without_lobes(self) -> &'static dyn Method {
        match self {
            Self::Microfacet => &Microfacet,
            Self::Nearest => &Nearest,
            _ => &Completed,
        }
    }
}

impl SettingArgs {
    /// Options of every fit of lobes.
    fn of_lobes(&self) -> [(&'static str, bool); 3] {
        [
            ("--lobes", self.lobes.is_some()),
            ("--starts", self.starts.is_some()),
            ("--steps", self.steps.is_some()),
        ]
    }

    /// Settings of the thesis's algorithm.
    pub fn thesis(&self) -> anyhow::Result<thesis::ThesisSettings> {
        self.only(
            "--lobes",
            "thesis",
            &[("--starts", self.starts.is_some()), ("--steps", self.steps.is_some())],
        )?;
        let default = thesis::ThesisSettings::default();
        Ok(thesis::ThesisSettings { lobes: self.lobes.unwrap_or(default.lobes), ..default })
    }

    /// Settings of Lafortune's model.
    pub fn lafortune(&self) -> anyhow::Result<lafortune::LafortuneSettings> {
        self.only("--lobes and --starts", "lafortune", &[("--steps", self.steps.is_some())])?;
        let default = lafortune::LafortuneSettings::default();
        Ok(lafortune::LafortuneSettings {
            lobes: self.lobes.unwrap_or(default.lobes),
            starts: self.starts.unwrap_or(default.starts),
            ..default
        })
    }

    /// An option that a method does not have is an error, not ignored.
    fn only(&self, has: &str, method: &str, others: &[(&str, bool)]) -> anyhow::Result<()> {
        let ours = [
            ("--squeezed", self.squeezed.is_some()),
            ("--mirrored", self.mirrored.is_some()),
            ("--smoothness", self.smoothness.is_some()),
            ("--exchanges", self.exchanges.is_some()),
            ("--views", self.views.is_some()),
            ("--factors", self.factors.is_some()),
            ("--bytes", self.bytes.is_some()),
            ("--error", self.error.is_some()),
        ];
        match ours.iter().chain(others).find(|o| o.1) {
            Some((name, _)) => bail!("{name}: method {method} has only {has}"),
            None => Ok(()),
        }
    }
}

/// A fit by another method than ours, judged as ours is.
pub struct Baseline {
    /// How good it is.
    pub report: Report,
    /// Its values for any direction.
    pub fitted: Box<dyn Fitted>,
    /// The report, settings and lobes, as JSON.
    pub json: String,
}

/// Fits by another method than ours.
pub fn fit(
    source: &Source,
    input: &Input,
    name: MethodName,
    args: &SettingArgs,
    left_out: Option<CrossValidation>,
) -> anyhow::Result<Baseline> {
    let start = Instant::now();
    let (views, held_out) = tables(&source.content)?;
    let (fitted, key, settings, result, evaluations, ending): (Box<dyn Fitted>, _, _, _, _, _) = match name {
        MethodName::Tracked => bail!("our own fit makes a .srbf file"),
        MethodName::Thesis => {
            let settings = args.thesis()?;
            let fit = match &source.content {
                Content::Samples(table) => thesis::fit_table(table, &settings)?,
                Content::Evaluable(brdf) => {
                    thesis::fit_brdf(brdf.as_ref(), &evaluation_views::even_views(VIEWS), &settings)?
                }
            };
            let (json, evaluations) = (fit.to_json(), fit.evaluations);
            let ending = Some(fit.ending());
            (Box::new(fit), "thesis", format!("{settings:?}"), ("lobes", json), evaluations, ending)
        }
        MethodName::Lafortune => {
            let settings = args.lafortune()?;
            let fit = match &source.content {
                Content::Samples(table) => Lafortune::fit(table, &settings)?,
                Content::Evaluable(brdf) => {
                    let table =
                        Table::from_brdf(brdf.as_ref(), &evaluation_views::even_views(VIEWS), FITTED)?;
                    Lafortune::fit(&table, &settings)?
                }
            };
            let (json, evaluations) = (fit.to_json(), fit.evaluations);
            (Box::new(fit), "lafortune", format!("{settings:?}"), ("channels", json), evaluations, None)
        }
        MethodName::Completion | MethodName::Microfacet | MethodName::Nearest => {
            args.only("no options", "without lobes", &args.of_lobes())?;
            let Content::Samples(table) = &source.content else {
                bail!("this method is for samples: a BRDF needs no completion")
            };
            let fitted = name.without_lobes().fit(table)?;
            (fitted, "without_lobes", String::new(), ("of", format!("{name:?}").into()), 0, None)
        }
    };
    let judge = |table: &Table| -> Result<Vec<ViewReport>, FitError> {
        table.views.iter().map(|v| ViewReport::judge(fitted.as_ref(), v)).collect()
    };
    let report = Report {
        factor_sizes: Vec::new(),
        views: judge(&views)?,
        held_out: held_out.map(|t| judge(&t)).transpose()?.unwrap_or_default(),
        seconds: start.elapsed().as_secs_f64(),
        evaluations,
        ending,
        cross_validation: left_out,
        completion: None,
        appearance: None,
        gaps: None,
        look: None,
        spectra: None,
    };
    let mut json = report.to_json_of(fitted.as_ref(), key, input)?;
    json["settings"] = settings.into();
    json[result.0] = result.1;
    Ok(Baseline { report, fitted, json: format!("{json:#}\n") })
}

/// The views that are fitted, and those in between where there are any.
fn tables(content: &Content) -> anyhow::Result<(Table, Option<Table>)> {
    Ok(match content {
        Content::Samples(table) => (table.clone(), None),
        Content::Evaluable(brdf) => {
            let thetas = evaluation_views::even_views(VIEWS);
            let halfway =
                evaluation_views::judging_table(brdf.as_ref(), &evaluation_views::halfway(&thetas))?;
            (evaluation_views::judging_table(brdf.as_ref(), &thetas)?, Some(halfway))
        }
    })
}

/// Reads the input of a fit: a file, or one material of a file of published Lafortune fits.
pub fn read(file: &Path, material: Option<&str>, conventions: &Conventions) -> anyhow::Result<Source> {
    Ok(match material {
        Some(material) => lafortune::read(file, material)?,
        None => {
            srbf_fit::read::read_with(file, conventions).map_err(|error| match lafortune::names(file) {
                Ok(names) => anyhow!("{}: --material is needed, one of {names}", shown(file)),
                Err(_) => error.into(),
            })?
        }
    })
}
