//! `srbf fit`: settings of a fit on the command line.

use srbf_fit::{FactorNodes, Settings};

/// Lobes that `--error` may use.
const MOST_LOBES: usize = 32;

/// Settings of a fit on the command line.
#[derive(Debug, clap::Args)]
pub struct SettingArgs {
    /// Lobes of every view, 1 to 64 [default: 12; lafortune: 3]
    #[arg(long)]
    pub(super) lobes: Option<usize>,
    /// Mean relative L2 error in per cent that is asked for: the fewest lobes that reach it are used, at most --lobes, or 32
    /// [default: no such number, --lobes are used].
    #[arg(long, value_name = "PER_CENT")]
    pub(super) error: Option<f64>,
    /// How many of the lobes are squeezed across the plane of incidence [default: what fits best].
    #[arg(long)]
    pub(super) squeezed: Option<usize>,
    /// How many pairs of the lobes are mirrored in the plane of incidence [default: what fits best].
    #[arg(long, value_name = "PAIRS")]
    pub(super) mirrored: Option<usize>,
    /// Weight of the smoothness from view to view, 1e-12 to 1000 [default: 5e-5].
    #[arg(long)]
    pub(super) smoothness: Option<f64>,
    /// Starting points that are tried, 1 to 1000 [default: 12; lafortune: 100].
    #[arg(long)]
    pub(super) starts: Option<usize>,
    /// Most steps of the solver in the refinement, 1 to 100000 [default: 120].
    #[arg(long)]
    pub(super) steps: Option<usize>,
    /// Most times that a lobe is exchanged, in each of the stages that do so, 0 to 1000 [default: 15].
    #[arg(long)]
    pub(super) exchanges: Option<usize>,
    /// Views of the material, placed where it changes, 2 to 256 [default: 15; with 6 to 11 lobes, and with lobes in mirrored pairs, as
    /// many more as take the bytes of 12].
    #[arg(long)]
    pub(super) views: Option<usize>,
    /// Most bytes of the material: they are spent on factors where that shows [default: 8000].
    #[arg(long, value_name = "N")]
    pub(super) bytes: Option<usize>,
    /// The table of factors over half angle, difference angle and azimuth that the lobes are multiplied by, `24x6x3` for example, or
    /// `24x10` for the two angles alone; `24x6x5s` for factors that are others where light and viewer change places; `none`; `chosen`:
    /// the gain decides [default: chosen].
    #[arg(long, value_name = "NODES")]
    pub(super) factors: Option<FactorNodes>,
}

impl SettingArgs {
    /// The settings of our own fit.
    pub fn settings(&self) -> Settings {
        let default = Settings::default();
        let lobes = self.lobes.unwrap_or(if self.error.is_some() { MOST_LOBES } else { default.lobes });
        Settings {
            lobes,
            error: self.error.map(|per_cent| per_cent / 100.0),
            squeezed: self.squeezed,
            mirrored: self.mirrored,
            smoothness: self.smoothness.unwrap_or(default.smoothness),
            starts: self.starts.unwrap_or(default.starts),
            steps: self.steps.unwrap_or(default.steps),
            exchanges: self.exchanges.unwrap_or(default.exchanges),
            views: self.views,
            bytes: self.bytes.unwrap_or(default.bytes),
            factors: self.factors.unwrap_or(default.factors),
            ..default
        }
    }

    /// Whether the number of lobes is left open.
    pub fn has_free_lobes(&self) -> bool {
        self.lobes.is_none() && self.error.is_none()
    }
}

#[cfg(test)]
mod tests {
    use crate::command::Cli;
    use crate::command::fit::method::MethodName;
    use clap::{CommandFactory, ValueEnum};
    use srbf_fit::{FactorNodes, Settings};
    use srbf_thesis::lafortune;

    #[test]
    fn the_document_states_the_defaults_and_all_methods() {
        let document = include_str!("../../../../docs/command-line.md");
        let ours = Settings::default();
        for (option, default) in [
            ("`--lobes N`", ours.lobes.to_string()),
            ("`--smoothness W`", format!("{:e}", ours.smoothness)),
            ("`--starts N`", ours.starts.to_string()),
            ("`--steps N`", ours.steps.to_string()),
            ("`--exchanges N`", ours.exchanges.to_string()),
            ("`--bytes N`", ours.bytes.to_string()),
            ("`--views N`", ours.view_count().to_string()),
        ] {
            let row = format!("| {option} | {default} |");
            assert!(document.contains(&row), "docs/command-line.md has no {row}");
        }
        assert!(document.contains(&format!("may be used ({})", super::MOST_LOBES)));
        for method in MethodName::value_variants() {
            let name = method.to_possible_value().unwrap();
            assert!(document.contains(&format!("| `{}` | ", name.get_name())), "{name:?}");
        }
    }

    #[test]
    fn the_help_states_the_defaults_of_the_library() {
        let mut program = Cli::command();
        let text = program.find_subcommand_mut("fit").unwrap().render_long_help().to_string();
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        let (ours, lafortune) = (Settings::default(), lafortune::LafortuneSettings::default());
        assert_eq!(ours.factors, FactorNodes::Chosen);
        for default in [
            format!("[default: {}; lafortune: {}]", ours.lobes, lafortune.lobes),
            format!("[default: {}; lafortune: {}]", ours.starts, lafortune.starts),
            format!("[default: {:e}]", ours.smoothness),
            format!("[default: {}]", ours.steps),
            format!("[default: {}]", ours.exchanges),
            format!("[default: {};", ours.view_count()),
            format!("[default: {}]", ours.bytes),
        ] {
            assert!(text.contains(&default), "{default} is not in: {text}");
        }
    }
}
