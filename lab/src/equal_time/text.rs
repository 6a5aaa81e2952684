//! The page of `srbf-lab equal-time`, as Markdown and as HTML.

use super::ratio::{Certain, Ratio, Several, certain, seconds_per_sample, t_factor};
use super::{Args, Measured, OURS, Rendered, WAYS, Way, method_name, method_names, points_text};
use srbf_core::Processor;
use srbf_reference_renderer::numbers::points::PointsName;
use srbf_reference_renderer::out::page::{Cell, Page, Table};
use srbf_reference_renderer::study::comparison::report::short;
use srbf_reference_renderer::study::comparison::{Comparison, Curve, Estimate};
use std::process::Command;

/// The measurements, and their method.
pub struct Text<'a> {
    pub measured: &'a [Measured],
    pub args: &'a Args,
    /// How long all of it took.
    pub minutes: f64,
    /// Of the source, as git names it.
    pub commit: &'a str,
}

/// What git says of the folder that the command is run in.
pub fn commit() -> String {
    let output = Command::new("git").args(["rev-parse", "--short=7", "HEAD"]).output();
    let found = output.ok().filter(|output| output.status.success()).map(|output| output.stdout);
    found.map_or_else(|| "unknown".to_owned(), |text| String::from_utf8_lossy(&text).trim().to_owned())
}

/// A line for each method: time of a sample, and errors over those of the first.
pub fn summary(comparison: &Comparison) -> String {
    let base = comparison.curves.first().map(|curve| curve.method.to_string()).unwrap_or_default();
    let line = |curve: &Curve| {
        let name = curve.method.to_string();
        let ratio = Ratio::of(comparison, &name, &base);
        let of = |ratio: Option<Estimate>| {
            ratio.map_or_else(|| "-".to_owned(), |r| format!("{} +- {}", short(r.mean), short(r.error)))
        };
        let time = seconds_per_sample(curve).map_or_else(|| "-".to_owned(), |s| format!("{:.2}", 1e3 * s));
        format!(
            "{name:>16} {time:>8} ms a sample; same time {:>16}, same samples {:>16}",
            of(ratio.time),
            of(ratio.samples)
        )
    };
    comparison.curves.iter().map(line).collect::<Vec<_>>().join("\n")
}

/// The effort after which errors are compared.
#[derive(Clone, Copy)]
enum After {
    Time,
    Samples,
}

impl After {
    fn text(self) -> &'static str {
        match self {
            Self::Time => "after the same time",
            Self::Samples => "after the same samples",
        }
    }

    /// As the file of numbers says it.
    fn word(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Samples => "samples",
        }
    }

    fn of(self, ratio: Ratio) -> Option<Estimate> {
        match self {
            Self::Time => ratio.time,
            Self::Samples => ratio.samples,
        }
    }
}

/// A table of texts; certain ratios are bold.
struct Grid {
    title: String,
    head: Vec<String>,
    rows: Vec<Vec<(String, bool)>>,
    /// Ratios over several cases, by the names of row and column.
    several: Vec<(String, String, Several)>,
}

impl Grid {
    fn markdown(&self) -> String {
        let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        let bold =
            |(text, is_bold): &(String, bool)| if *is_bold { format!("**{text}**") } else { text.clone() };
        let rows: String = self.rows.iter().map(|row| line(row.iter().map(bold).collect())).collect();
        let rule = format!("|{}\n", "---|".repeat(self.head.len()));
        format!("{}\n\n{}{rule}{rows}", self.title, line(self.head.clone()))
    }

    fn table(&self) -> Table {
        let words = |text: &String| Cell::text(text.replace('`', ""));
        let row = |row: &Vec<(String, bool)>| {
            let cell =
                |(text, is_bold): &(String, bool)| Cell::number(text.replace('`', "")).bold_if(*is_bold);
            row.iter().map(cell).collect()
        };
        Table {
            caption: self.title.replace('`', ""),
            head: self.head.iter().map(words).collect(),
            rows: self.rows.iter().map(row).collect(),
        }
    }
}

impl Text<'_> {
    fn t(&self) -> f64 {
        t_factor(self.args.repeats)
    }

    /// The page as Markdown: several cases together. Each of them is in [`csv`](Self::csv).
    pub fn markdown(&self) -> String {
        let mut text = format!(
            "# Error against time\n\n{}\n\n    {}\n\nEvery ratio by itself is in the `.csv` file beside this page.\n",
            self.words().join("\n\n"),
            self.command()
        );
        for (heading, grids) in self.together() {
            text += &format!("\n## {heading}\n");
            for grid in grids {
                text += &format!("\n{}", grid.markdown());
            }
        }
        text
    }

    /// The same as a page of HTML.
    pub fn html(&self) -> Page {
        let mut page = Page::new("Error against time");
        self.words().iter().for_each(|words| page.paragraph(&words.replace('`', "")));
        page.lines(&self.command());
        for (heading, grids) in self.together().into_iter().chain(self.one_by_one()) {
            page.heading(&heading);
            grids.iter().for_each(|grid| page.table(&grid.table()));
        }
        page
    }

    fn command(&self) -> String {
        let words: Vec<String> = std::env::args().skip(1).collect();
        format!("SRBF_DATA_DIR=DATA cargo lab {}", words.join(" "))
    }

    fn words(&self) -> Vec<String> {
        let Args { spp, repeats, side, reference_spp, .. } = self.args;
        vec![
            "Relative mean squared error of one method over that of another. Below 1 the first one is better. A bold ratio \
             is certain nineteen times of twenty, wins and losses alike."
                .to_owned(),
            format!(
                "Commit {}, {}; {:.0} minutes. Pictures of {side} x {side} pixels with {} and {} samples a pixel,\n\
                 {repeats} for each method, against {reference_spp} Sobol points of `even` a pixel. Time is that of processors between both,\n\
                 so that the work that is done once for a picture does not count. Errors go along the line through both. A ratio is certain where it\n\
                 is off 1 by {} standard errors (Student's t), of the errors alone. The 0.1 % of the pixels that are worst are apart.",
                self.commit,
                Processor::this(),
                self.minutes,
                spp[0],
                spp[1],
                self.t()
            ),
            "`lobes` are 12 lobes; `ggx` is one fitted GGX lobe and a cosine, `lafortune` nine lobes and a cosine. `rgl` has the warps\n\
             of the file in f32, whose draws bring value and density along. Each is run alone, with one sample of the light (`mis`), and\n\
             by even sums (`even`). `docs/samplers.md` says more. Rendered are the lobes, or the table that they were fitted\n\
             to, the same for all samplers. On the sphere and in the furnace light scatters once, elsewhere six times."
                .to_owned(),
        ]
    }

    /// Every ratio to even sums: a line for each case, a column for each method, and the names of the methods whose ratio is not
    /// certain in the last one.
    ///
    /// # Errors
    /// Memory.
    pub fn csv(&self) -> anyhow::Result<Vec<u8>> {
        let names: Vec<String> = method_names(&self.args.samplers).into_iter().skip(1).collect();
        let mut lines = csv::Writer::from_writer(Vec::new());
        let head = ["material", "scene", "light", "rendered", "points", "after"];
        lines.write_record(head.into_iter().chain(names.iter().map(String::as_str)).chain(["open"]))?;
        for case in self.measured {
            let Measured { rendered, points, comparison } = case;
            for after in [After::Time, After::Samples] {
                let Comparison { scene, material, environment, .. } = comparison;
                let mut line =
                    vec![material.as_str(), scene, environment, rendered.text(), points_text(*points)];
                line.push(after.word());
                let of = |name: &String| after.of(Ratio::of(comparison, name, "even"));
                let ratios: Vec<String> =
                    names.iter().map(|name| of(name).map_or_else(String::new, |r| short(r.mean))).collect();
                let is_open =
                    |name: &&String| of(name).is_some_and(|r| certain(r, self.t()) == Certain::Open);
                let open: Vec<&str> = names.iter().filter(is_open).map(String::as_str).collect();
                let open = open.join(" ");
                lines.write_record(
                    line.into_iter().chain(ratios.iter().map(String::as_str)).chain([&*open]),
                )?;
            }
        }
        Ok(lines.into_inner()?)
    }

    /// The ratios over many cases, as docs/figures has them.
    ///
    /// # Errors
    /// Memory.
    pub fn summary_csv(&self) -> anyhow::Result<Vec<u8>> {
        let mut lines = csv::Writer::from_writer(Vec::new());
        let head = [
            "question",
            "after the same",
            "of",
            "case",
            "ratio",
            "least",
            "largest",
            "better",
            "worse",
            "cases",
        ];
        lines.write_record(head)?;
        for (question, grids) in self.together() {
            for (grid, after) in grids.iter().zip([After::Time, After::Samples]) {
                for (of, case, Several { count, mean, range, better, worse }) in &grid.several {
                    let words = [&question, after.word(), of, case].map(|word| word.replace('`', ""));
                    let ratios = [*mean, range[0], range[1]].map(short);
                    let counts = [better, worse, count].map(usize::to_string);
                    lines.write_record(words.iter().chain(&ratios).chain(&counts))?;
                }
            }
        }
        Ok(lines.into_inner()?)
    }

    /// Ratios over many cases.
    fn together(&self) -> Vec<(String, Vec<Grid>)> {
        vec![
            ("Another sampler, the same way with the light".to_owned(), self.samplers()),
            ("Another way with the light, the same lobes".to_owned(), self.ways()),
        ]
    }

    /// Ratios of each case, by material.
    fn one_by_one(&self) -> Vec<(String, Vec<Grid>)> {
        let mut parts = Vec::new();
        let mut materials: Vec<&str> = self.measured.iter().map(|m| m.comparison.material.as_str()).collect();
        materials.dedup();
        materials.dedup();
        let mut seen: Vec<&str> = Vec::new();
        for name in materials {
            if !seen.contains(&name) {
                seen.push(name);
                parts.push((format!("All of {name}"), self.all_of(name)));
            }
        }
        parts
    }

    /// Ratios of a pair of methods over the cases that are chosen.
    fn several(
        &self,
        after: After,
        pair: [&str; 2],
        is_chosen: impl Fn(&Measured) -> bool,
    ) -> Option<Several> {
        let cases = self.measured.iter().filter(|case| is_chosen(case));
        let ratios: Vec<Estimate> =
            cases.filter_map(|case| after.of(Ratio::of(&case.comparison, pair[0], pair[1]))).collect();
        Several::of(&ratios, self.t())
    }

    /// Other samplers over lobes.
    fn samplers(&self) -> Vec<Grid> {
        let columns = [Rendered::Lobes, Rendered::Table]
            .into_iter()
            .flat_map(|rendered| [PointsName::Sobol, PointsName::Random].map(|points| (rendered, points)));
        let columns: Vec<_> = columns.collect();
        let grid = |after: After| {
            let mut head = vec!["over".to_owned()];
            head.extend(columns.iter().map(|(r, p)| format!("{} rendered, {}", r.text(), points_text(*p))));
            let (mut rows, mut all) = (Vec::new(), Vec::new());
            for way in WAYS {
                let base = method_name(OURS, way);
                for sampler in &self.args.samplers {
                    let name = method_name(sampler, way);
                    let over = format!("`{name}` over `{base}`");
                    let mut row = vec![(over.clone(), false)];
                    row.extend(columns.iter().zip(&head[1..]).map(|(&(rendered, points), column)| {
                        let chosen = |case: &Measured| (case.rendered, case.points) == (rendered, points);
                        let found = self.several(after, [&name, &base], chosen);
                        let text = found.as_ref().map_or_else(|| "-".to_owned(), Several::text);
                        all.extend(found.map(|found| (over.clone(), column.clone(), found)));
                        (text, false)
                    }));
                    rows.push(row);
                }
            }
            Grid {
                title: format!(
                    "Errors {}: geometric mean, least and largest, and how many are certain.",
                    after.text()
                ),
                head,
                rows,
                several: all,
            }
        };
        [After::Time, After::Samples].map(grid).into()
    }

    /// Other ways with the light over even sums, by scene.
    fn ways(&self) -> Vec<Grid> {
        let mut scenes: Vec<&'static str> = Vec::new();
        for case in self.measured {
            if !scenes.contains(&case.comparison.scene) {
                scenes.push(case.comparison.scene);
            }
        }
        let grid = |after: After| {
            let others =
                [method_name("lobes", Way::Alone), method_name("lobes", Way::Mis), "product".to_owned()];
            let points = [PointsName::Sobol, PointsName::Random];
            let mut head = vec!["scene".to_owned()];
            head.extend(
                others.iter().flat_map(|o| points.map(|p| format!("`{o}` over `even`, {}", points_text(p)))),
            );
            let (mut rows, mut all) = (Vec::new(), Vec::new());
            for &scene in &scenes {
                let mut row = vec![(scene.to_owned(), false)];
                let cases = others.iter().flat_map(|other| points.map(|points| (other, points)));
                for ((other, points), column) in cases.zip(&head[1..]) {
                    let chosen = |case: &Measured| case.comparison.scene == scene && case.points == points;
                    let found = self.several(after, [other, "even"], chosen);
                    row.push((found.as_ref().map_or_else(|| "-".to_owned(), Several::text), false));
                    all.extend(found.map(|found| (scene.to_owned(), column.clone(), found)));
                }
                rows.push(row);
            }
            Grid {
                title: format!("Errors {}, lobes and tables together.", after.text()),
                head,
                rows,
                several: all,
            }
        };
        [After::Time, After::Samples].map(grid).into()
    }

    /// Every method over even sums, after the same time and after the same samples.
    fn all_of(&self, material: &str) -> Vec<Grid> {
        let cases: Vec<&Measured> =
            self.measured.iter().filter(|case| case.comparison.material == material).collect();
        let is_run =
            |name: &String| cases.iter().any(|case| Ratio::of(&case.comparison, name, "even").time.is_some());
        let names: Vec<String> =
            method_names(&self.args.samplers).into_iter().skip(1).filter(is_run).collect();
        let mut head = vec!["scene, light; rendered; points".to_owned()];
        head.extend(names.iter().map(|name| format!("`{name}`")));
        let cell = |ratio: Option<Estimate>| match ratio {
            None => ("-".to_owned(), false),
            Some(ratio) => (short(ratio.mean), certain(ratio, self.t()) != Certain::Open),
        };
        let grid = |after: After| {
            let rows = cases.iter().map(|case| {
                let Measured { rendered, points, comparison } = case;
                let Comparison { scene, environment, .. } = comparison;
                let what = format!("{scene}, {environment}; {}; {}", rendered.text(), points_text(*points));
                let mut row = vec![(what, false)];
                row.extend(names.iter().map(|name| cell(after.of(Ratio::of(comparison, name, "even")))));
                row
            });
            Grid {
                title: format!("Over `even`, {}.", after.text()),
                head: head.clone(),
                rows: rows.collect(),
                several: Vec::new(),
            }
        };
        [After::Time, After::Samples].map(grid).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::imagined::{curve as curve_of, point};
    use clap::Parser;
    use srbf_reference_renderer::study::comparison::ReferenceReport;

    #[derive(Parser)]
    struct Cli {
        #[command(flatten)]
        args: Args,
    }

    #[test]
    fn wins_and_losses_are_bold_and_what_was_not_run_is_a_dash() {
        let curve = |&(name, rmse): &(&str, f64)| Curve {
            method: name.parse().unwrap(),
            ..curve_of(vec![point(16, 1.0, 2.0 * rmse), point(64, 4.0, rmse)])
        };
        let errors = [("even", 0.1), ("mis", 0.2), ("ggx+even", 0.05), ("product", 0.1), ("ggx+mis", 0.4)];
        let comparison = Comparison {
            scene: "sphere",
            material: "paint".into(),
            environment: "forest".into(),
            size: [1, 1],
            curves: errors.iter().map(curve).collect(),
            reference: ReferenceReport::default(),
        };
        let measured = [Measured { rendered: Rendered::Lobes, points: PointsName::Sobol, comparison }];
        let args = Cli::parse_from(["x"]).args;
        let text = Text { measured: &measured, args: &args, minutes: 1.0, commit: "0fa598b" };
        let page = text.markdown();
        let lines = String::from_utf8(text.csv().unwrap()).unwrap();
        let lines: Vec<&str> = lines.lines().collect();
        let summary = String::from_utf8(text.summary_csv().unwrap()).unwrap();
        let samplers = "\n\"Another sampler, the same way with the light\"";
        let line =
            format!("{samplers},time,ggx+mis over mis,\"lobes rendered, Sobol\",4.00,4.00,4.00,0,1,1\n");
        assert!(summary.contains(&line), "{summary}");
        assert!(lines[0].starts_with("material,scene,light,rendered,points,after,lobes,ggx,"), "{lines:?}");
        assert_eq!(lines[1], "paint,sphere,forest,lobes,Sobol,time,,,,,4.00,16.0,,,0.25,,,1.00,product");
        assert!(
            page.contains("| `ggx+mis` over `mis` | 4.00 (4.00 to 4.00); 0 better, 1 worse of 1 | - |"),
            "{page}"
        );
        assert!(page.contains("| `lafortune` over `lobes` | - |") && !page.contains("NaN"), "{page}");
        assert!(
            text.html().to_html().contains("<td class=\"number\"><b>0.25</b>")
                || text.html().to_html().contains("0.25")
        );
    }
}
